//! What is cut away from the volume: by planes, by a box, by value.

use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::check::{self, Checked};

/// The most cut planes in a scene.
pub const MOST_CUTS: usize = 6;

/// A plane that removes everything on one side of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cut {
    /// Points at what is removed, in voxel coordinates; of any length but 0.
    pub normal: [f64; 3],
    /// A point on the plane, in voxel coordinates.
    pub through_voxel: [f64; 3],
}

/// A box with faces along the axes: samples whose position is outside are removed, those on a face
/// are kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crop {
    /// The corner of the smallest coordinates, in voxel coordinates.
    pub min_voxel: [f64; 3],
    /// The corner of the largest coordinates, in voxel coordinates, nowhere below `min_voxel`.
    pub max_voxel: [f64; 3],
}

/// Samples whose value is outside are transparent; a value equal to a bound is inside.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Threshold {
    /// The smallest value that is shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest value that is shown, not below `low`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
}

impl Cut {
    /// Whether the plane removes the sample at `position_voxel`; one on the plane is kept.
    pub fn removes(&self, position_voxel: [f64; 3]) -> bool {
        (0..3).map(|i| self.normal[i] * (position_voxel[i] - self.through_voxel[i])).sum::<f64>() > 0.0
    }

    pub(crate) fn validate(&self, index: usize) -> Checked {
        check::direction(&format!("cut[{index}].normal"), self.normal)
    }
}

impl Crop {
    /// Whether the box removes the sample at `position_voxel`.
    pub fn removes(&self, position_voxel: [f64; 3]) -> bool {
        !(0..3).all(|i| (self.min_voxel[i]..=self.max_voxel[i]).contains(&position_voxel[i]))
    }

    pub(crate) fn validate(&self) -> Checked {
        for i in 0..3 {
            let (min, max) = (self.min_voxel[i], self.max_voxel[i]);
            if min > max {
                return Err(SceneError::at(
                    format!("crop.max_voxel[{i}]"),
                    format!("the box ends at {max}, before it begins at {min}"),
                    format!("give a number from {min} up"),
                ));
            }
        }
        Ok(())
    }
}

impl Threshold {
    /// Whether a sample of `value` is made transparent; NaN is.
    pub fn removes(&self, value: f64) -> bool {
        !(self.low.unwrap_or(f64::NEG_INFINITY)..=self.high.unwrap_or(f64::INFINITY)).contains(&value)
    }

    pub(crate) fn validate(&self) -> Checked {
        if let (Some(low), Some(high)) = (self.low, self.high)
            && low > high
        {
            return Err(SceneError::at(
                "threshold.high",
                format!("no value is from {low} to {high}"),
                format!("give a number from {low} up"),
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_removes_the_side_its_normal_points_at_and_keeps_the_plane() {
        let cut = Cut { normal: [0.0, 0.0, 2.0], through_voxel: [9.0, 9.0, 5.0] };
        assert!(cut.removes([0.0, 0.0, 5.5]));
        assert!(!cut.removes([0.0, 0.0, 5.0]) && !cut.removes([0.0, 0.0, 4.0]));
    }

    #[test]
    fn a_crop_keeps_its_faces() {
        let crop = Crop { min_voxel: [1.0; 3], max_voxel: [2.0; 3] };
        assert!(!crop.removes([1.0, 2.0, 1.5]));
        assert!(crop.removes([1.0, 2.1, 1.5]) && crop.removes([0.9, 1.5, 1.5]));
    }

    #[test]
    fn a_threshold_keeps_its_bounds_and_an_open_side() {
        let band = Threshold { low: Some(3.0), high: Some(4.0) };
        assert!(!band.removes(3.0) && !band.removes(4.0));
        assert!(band.removes(2.9) && band.removes(4.1) && band.removes(f64::NAN));
        assert!(!Threshold::default().removes(1e300));
    }
}
