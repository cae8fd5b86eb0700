//! Depth cueing: what is farther away is darker.

use serde::{Deserialize, Serialize};

use crate::ViewFrame;

/// A factor on the colour of each sample, linear in the sample's depth along the view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DepthCue {
    /// The factor at the corner of the volume nearest to the eye, 0 to 1.
    pub front: f64,
    /// The factor at the farthest corner, 0 to 1.
    pub back: f64,
}

impl Default for DepthCue {
    /// Full colour in front, half of it at the back.
    fn default() -> Self {
        DepthCue { front: 1.0, back: 0.5 }
    }
}

impl DepthCue {
    /// The factor at `depth`, 0 at the nearest corner of the volume and 1 at the farthest; clamped.
    pub fn factor_at(&self, depth: f64) -> f64 {
        let depth = depth.clamp(0.0, 1.0);
        self.front * (1.0 - depth) + self.back * depth
    }
}

/// Distance along the view of the nearest and of the farthest corner voxel's centre, from voxel (0, 0, 0).
pub fn depth_range(view: &ViewFrame, dims: [usize; 3], spacing: [f64; 3]) -> [f64; 2] {
    let mut range = [0.0; 2];
    for i in 0..3 {
        let reach = view.direction[i] * (dims[i] - 1) as f64 * spacing[i];
        range[0] += reach.min(0.0);
        range[1] += reach.max(0.0);
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_is_linear_between_exact_ends() {
        let cue = DepthCue { front: 0.9, back: 0.3 };
        assert_eq!((cue.factor_at(0.0), cue.factor_at(1.0)), (0.9, 0.3));
        assert_eq!((cue.factor_at(-5.0), cue.factor_at(7.0)), (0.9, 0.3));
        assert!((cue.factor_at(0.25) - 0.75).abs() < 1e-15);
    }
}
