//! Which voxel axis plays u, v and w, and in which order.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The voxel axes behind u, v and w, and which of them run backwards.
///
/// Every parallel view becomes one with rays towards +w and slopes 1 ≥ du ≥ dv ≥ 0. The frame buffer
/// serves beams along any axis in either order, so this costs the machine nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axes {
    /// For u, v, w: the voxel axis, 0 = x, 1 = y, 2 = z.
    pub axis: [usize; 3],
    /// For u, v, w: whether the coordinate runs against the voxel index.
    pub reversed: [bool; 3],
}

impl Axes {
    /// Something given for x, y, z, in the order u, v, w.
    pub fn permute<T: Copy>(&self, xyz: [T; 3]) -> [T; 3] {
        self.axis.map(|a| xyz[a])
    }

    /// A world vector in canonical components.
    pub fn to_canonical(&self, vector: DVec3) -> [f64; 3] {
        let world = vector.to_array();
        [0, 1, 2].map(|i| if self.reversed[i] { -world[self.axis[i]] } else { world[self.axis[i]] })
    }

    /// A canonical vector in world components.
    pub fn to_world(&self, canonical: [f64; 3]) -> DVec3 {
        let mut world = [0.0; 3];
        for i in 0..3 {
            world[self.axis[i]] = if self.reversed[i] { -canonical[i] } else { canonical[i] };
        }
        DVec3::from_array(world)
    }

    /// The voxel index x, y, z of the canonical position `uvw` in a volume of `size` (u, v, w); also for
    /// positions between voxels.
    pub fn voxel_position(&self, size: [usize; 3], uvw: [f64; 3]) -> [f64; 3] {
        let mut xyz = [0.0; 3];
        for i in 0..3 {
            xyz[self.axis[i]] = if self.reversed[i] { (size[i] - 1) as f64 - uvw[i] } else { uvw[i] };
        }
        xyz
    }

    /// The canonical position of voxel coordinates x, y, z in a volume of `size` (u, v, w).
    pub fn canonical_position(&self, size: [usize; 3], xyz: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let along = xyz[self.axis[i]];
            if self.reversed[i] { (size[i] - 1) as f64 - along } else { along }
        })
    }

    /// The voxel index x, y, z of the canonical voxel `uvw` in a volume of `size` (u, v, w).
    pub fn voxel(&self, size: [usize; 3], uvw: [usize; 3]) -> [usize; 3] {
        let mut xyz = [0; 3];
        for i in 0..3 {
            xyz[self.axis[i]] = if self.reversed[i] { size[i] - 1 - uvw[i] } else { uvw[i] };
        }
        xyz
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_vectors_go_there_and_back() {
        let axes = Axes { axis: [0, 1, 2], reversed: [true, false, true] };
        let size = axes.permute([5, 6, 7]);
        assert_eq!(size, [5, 6, 7]);
        assert_eq!(axes.voxel(size, [0, 0, 0]), [4, 0, 6]);
        assert_eq!(axes.voxel_position(size, [0.5, 0.0, 1.0]), [3.5, 0.0, 5.0]);
        assert_eq!(axes.canonical_position(size, [3.5, 0.0, 5.0]), [0.5, 0.0, 1.0]);
        let canonical = axes.to_canonical(DVec3::new(-0.3, 0.2, -0.9));
        assert_eq!(canonical, [0.3, 0.2, 0.9]);
        assert_eq!(axes.to_world(canonical), DVec3::new(-0.3, 0.2, -0.9));
    }
}
