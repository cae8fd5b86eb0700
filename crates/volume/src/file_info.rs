//! What a file holds.

use crate::{FileFormat, SampleType, World};

/// What a file holds, by its header alone.
#[derive(Clone, Debug, PartialEq)]
pub struct FileInfo {
    /// The file's format.
    pub format: FileFormat,
    /// Voxels along x, y and z of the grid.
    pub dims: [usize; 3],
    /// Voxels along the stored axes, fastest first.
    pub stored_dims: [usize; 3],
    /// Distance between voxel centres along x, y and z of the grid.
    pub spacing: [f64; 3],
    /// World position of voxel (0, 0, 0) of the grid.
    pub origin: [f64; 3],
    /// How the grid lies in the world.
    pub world: World,
    /// The type of the samples in memory.
    pub sample_type: SampleType,
    /// Volumes of a series, at least 1.
    pub volumes: usize,
    /// What the header left open, and what was taken.
    pub remarks: Vec<String>,
}

impl FileInfo {
    /// Bytes of one volume's samples in memory.
    pub fn bytes(&self) -> u64 {
        self.dims.iter().fold(self.sample_type.bytes() as u64, |p, &d| p.saturating_mul(d as u64))
    }
}
