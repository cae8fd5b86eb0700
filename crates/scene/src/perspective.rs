//! Where the eye of a perspective view is.

use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::check::Checked;

/// The smallest and the largest field of view, in degrees: within them, the rays through a picture spread and
/// do not run along it.
pub const FIELD_OF_VIEW_DEG: [f64; 2] = [0.001, 179.0];

/// The farthest that an eye may be, in voxels.
pub const FARTHEST_EYE_VOXEL: f64 = 1e12;

/// Rays from an eye instead of parallel ones.
///
/// The view's direction is the one through the centre of the picture, wherever the eye is. Without a place for
/// the eye, it is where the sphere around the volume's voxels just fits the narrower of the picture's two fields of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Perspective {
    /// The angle between the picture's lower and upper edge, in degrees, within [`FIELD_OF_VIEW_DEG`].
    pub field_of_view_deg: f64,
    /// The eye, in voxel coordinates, each within ±[`FARTHEST_EYE_VOXEL`]; it may be in the volume.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eye_voxel: Option<[f64; 3]>,
    /// How far before the volume's centre the eye is, along the view, in units of the smallest voxel spacing, 0
    /// to [`FARTHEST_EYE_VOXEL`]; instead of `eye_voxel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_voxel: Option<f64>,
}

impl Perspective {
    /// The perspective of this field of view from where the volume fits the picture.
    pub fn new(field_of_view_deg: f64) -> Self {
        Perspective { field_of_view_deg, eye_voxel: None, distance_voxel: None }
    }

    pub(crate) fn validate(&self) -> Checked {
        if self.distance_voxel.is_some() && self.eye_voxel.is_some() {
            return Err(SceneError::at(
                "view.perspective.distance_voxel",
                "the eye and its distance are both given",
                "give only one of `eye_voxel` and `distance_voxel`",
            ));
        }
        Ok(())
    }
}
