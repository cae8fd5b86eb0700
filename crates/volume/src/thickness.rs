//! An axis of one voxel is one thick.

use crate::{Sample, Volume, with_samples};
use std::borrow::Cow;

/// Voxels along x, y, z of [`Volume::thickened`].
pub fn thick_dims(dims: [usize; 3]) -> [usize; 3] {
    dims.map(|n| n.max(2))
}

impl Volume {
    /// The volume as it is drawn: along an axis with a single voxel there are two of the same value, half a voxel before it and half a
    /// voxel behind.
    ///
    /// What is drawn is the box of the voxel centres. A single slice has none along its normal; two equal ones make it as thick as a
    /// voxel, with the same value throughout. `origin` moves with the first voxel.
    pub fn thickened(&self) -> Cow<'_, Volume> {
        let dims = thick_dims(self.dims);
        if dims == self.dims {
            return Cow::Borrowed(self);
        }
        let from = |at: usize, axis: usize| if self.dims[axis] == 1 { 0 } else { at };
        let samples = with_samples!(&self.samples, v => {
            let voxel = |index: usize| {
                let (x, y, z) = (index % dims[0], index / dims[0] % dims[1], index / dims[0] / dims[1]);
                v[self.index(from(x, 0), from(y, 1), from(z, 2))]
            };
            Sample::wrap((0..dims.iter().product()).map(voxel).collect())
        });
        let half = [0, 1, 2].map(|i| if self.dims[i] == 1 { -self.spacing[i] / 2.0 } else { 0.0 });
        let moved = self.world.direction_of(half);
        let origin = [0, 1, 2].map(|i| self.origin[i] + moved[i]);
        Cow::Owned(Volume { dims, origin, samples, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slice_becomes_two_equal_ones_around_it() {
        let slice = Volume::from_fn([3, 1, 2], [1.0, 4.0, 2.0], |x, _, z| (10 * z + x) as u8).unwrap();
        let slice = slice.with_origin([1.0, 2.0, 3.0]).unwrap();
        let thick = slice.thickened();
        assert_eq!((thick.dims, thick.spacing, thick.origin), ([3, 2, 2], [1.0, 4.0, 2.0], [1.0, 0.0, 3.0]));
        for (x, y, z) in (0..3).flat_map(|x| (0..2).flat_map(move |y| (0..2).map(move |z| (x, y, z)))) {
            assert_eq!(thick.value(x, y, z), slice.value(x, 0, z));
        }
        assert_eq!(thick.sample_type(), slice.sample_type());
        assert!(matches!(thick.thickened(), Cow::Borrowed(_)));
    }
}
