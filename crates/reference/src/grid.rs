//! A volume as rays see it.

use cube3_volume::Sample;

/// Voxels, and what is beyond them.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a, S> {
    /// x fastest, then y, then z.
    pub samples: &'a [S],
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// The value beyond them.
    pub border: f64,
    /// The spacing along x, y, z in units of the smallest.
    pub per_voxel: [f64; 3],
    /// How far the box reaches beyond the voxel centres, in voxels; above 0 a value is the nearest voxel's.
    pub margin: f64,
}

impl<S: Sample> Grid<'_, S> {
    /// Whether a value is the nearest voxel's.
    #[inline(always)]
    pub fn nearest(&self) -> bool {
        self.margin > 0.0
    }

    /// The value of a voxel, or beyond them.
    pub fn voxel(&self, at: [isize; 3]) -> f64 {
        if (0..3).any(|i| at[i] < 0 || at[i] as usize >= self.dims[i]) {
            return self.border;
        }
        let [x, y, z] = at.map(|i| i as usize);
        self.samples[(z * self.dims[1] + y) * self.dims[0] + x].into()
    }
}
