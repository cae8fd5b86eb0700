//! The volume's voxels in canonical coordinates.

use cube3_frame::Geometry;
use cube3_volume::Sample;

/// A volume read along u, v, w: voxel axes in the geometry's order and direction.
#[derive(Clone, Copy)]
pub(crate) struct Voxels<'a, S> {
    samples: &'a [S],
    /// Index of voxel (0, 0, 0).
    first: isize,
    /// From a voxel to the next along u, v, w.
    strides: [isize; 3],
    /// n_u, n_v, n_w.
    size: [usize; 3],
}

impl<'a, S: Sample> Voxels<'a, S> {
    /// `dims` are the volume's, and those of the geometry.
    pub fn new(samples: &'a [S], dims: [usize; 3], geometry: &Geometry) -> Self {
        let along = [1, dims[0] as isize, (dims[0] * dims[1]) as isize];
        let mut first = 0;
        let mut strides = [0; 3];
        for i in 0..3 {
            let stride = along[geometry.axes.axis[i]];
            if geometry.axes.reversed[i] {
                first += stride * (geometry.size[i] as isize - 1);
                strides[i] = -stride;
            } else {
                strides[i] = stride;
            }
        }
        Voxels { samples, first, strides, size: geometry.size }
    }

    /// The voxel at canonical (u, v, w).
    #[inline]
    pub fn at(&self, uvw: [usize; 3]) -> f64 {
        let [u, v, w] = uvw.map(|x| x as isize);
        let index = self.first + u * self.strides[0] + v * self.strides[1] + w * self.strides[2];
        self.samples[index as usize].into()
    }

    /// Reads the beam along u at (v, w) into `beam`, n_u + 1 long: its last voxel stands there twice, as the far
    /// operand of samples at the last column, which have no weight for it.
    pub fn read_beam(&self, v: usize, w: usize, beam: &mut [f64]) {
        let from = self.first + v as isize * self.strides[1] + w as isize * self.strides[2];
        let n = self.size[0];
        if self.strides[0] == 1 {
            let row = &self.samples[from as usize..from as usize + n];
            for (to, voxel) in beam.iter_mut().zip(row) {
                *to = (*voxel).into();
            }
        } else {
            let mut index = from;
            for to in &mut beam[..n] {
                *to = self.samples[index as usize].into();
                index += self.strides[0];
            }
        }
        beam[n] = beam[n - 1];
    }
}
