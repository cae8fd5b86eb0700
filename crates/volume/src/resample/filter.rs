//! What lies between voxels.

use strum::{Display, EnumString};

use crate::VolumeError;

/// What lies between voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Display, EnumString)]
#[strum(serialize_all = "lowercase", parse_err_ty = VolumeError, parse_err_fn = unknown)]
pub enum Filter {
    /// The nearest voxel, a half forward: for labels.
    Nearest,
    /// Straight lines along each axis: within the range of the neighbours.
    Linear,
    /// The cubic B-spline that goes through the samples, mirrored at the first and the last: smooth, may overshoot at edges.
    #[default]
    Cubic,
}

fn unknown(name: &str) -> VolumeError {
    VolumeError::unknown("filter", name, "write nearest, linear or cubic")
}
