//! Sampling a formula in small blocks, so that each looks only at what is near it.

use rayon::prelude::*;

use crate::limits::{reserve, sample_count};
use crate::volume::check_grid;
use crate::{Sample, Volume, VolumeError};

/// Voxels along the side of a block.
const BLOCK_VOXELS: usize = 8;

/// Half the diagonal of a block, from centre to centre of its corners, in voxels.
pub(super) fn half_diagonal() -> f64 {
    (BLOCK_VOXELS as f64 - 1.0) * 3f64.sqrt() / 2.0
}

/// A cube of `size` voxels a side. For each block `prepare` gets the block's centre in voxels and
/// gives the function of the voxel (x, y, z) that is sampled in it.
pub(super) fn sample_in_blocks<S: Sample, F: Fn([f64; 3]) -> S>(
    size: usize,
    prepare: impl Fn([f64; 3]) -> F + Sync,
) -> Result<Volume, VolumeError> {
    check_grid([size; 3], [1.0; 3], [0.0; 3])?;
    let count = sample_count([size; 3], S::TYPE, u64::MAX, "phantom")?;
    let mut samples = reserve::<S>(count, [size; 3], S::TYPE, "phantom")?;
    samples.resize(count, S::default());
    samples.par_chunks_mut(BLOCK_VOXELS * size * size).enumerate().for_each(|(slab, samples)| {
        let z0 = slab * BLOCK_VOXELS;
        let depth = samples.len() / (size * size);
        for y0 in (0..size).step_by(BLOCK_VOXELS) {
            for x0 in (0..size).step_by(BLOCK_VOXELS) {
                let middle = |first: usize| first as f64 + (BLOCK_VOXELS as f64 - 1.0) / 2.0;
                let sample = prepare([middle(x0), middle(y0), middle(z0)]);
                for z in 0..depth {
                    for y in y0..(y0 + BLOCK_VOXELS).min(size) {
                        for x in x0..(x0 + BLOCK_VOXELS).min(size) {
                            samples[(z * size + y) * size + x] = sample([x as f64, y as f64, (z0 + z) as f64]);
                        }
                    }
                }
            }
        }
    });
    Volume::new([size; 3], [1.0; 3], S::wrap(samples))
}
