//! What the host knows of a volume.

/// What the host needs to know of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeInfo {
    /// Voxels along x, y, z: 1 to [`LARGEST_SIDE`](cube3_frame::LARGEST_SIDE) each.
    pub dims: [usize; 3],
    /// Size of a voxel along x, y, z.
    pub spacing: [f64; 3],
    /// Data values of voxel word 0 and of the largest word.
    pub window: [f64; 2],
}
