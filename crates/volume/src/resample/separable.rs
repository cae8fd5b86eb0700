//! Another grid along the same axes: one axis after the other.

use rayon::prelude::*;

use super::spline::{Taps, interpolate, to_coefficients};
use super::{Filter, NewAxis, Places, check_memory, reserve, store};
use crate::{Sample, Samples, Volume, VolumeError, with_samples};

/// The samples at the places of the new axes, and how many were clipped.
pub(super) fn resample(
    volume: &Volume,
    axes: &[NewAxis; 3],
    filter: Filter,
    limit: u64,
) -> Result<(Samples, u64), VolumeError> {
    with_samples!(&volume.samples, samples => checked(samples, volume.dims, axes, filter, limit))
}

fn checked<S: Sample>(
    samples: &[S],
    old: [usize; 3],
    axes: &[NewAxis; 3],
    filter: Filter,
    limit: u64,
) -> Result<(Samples, u64), VolumeError> {
    let dims = axes.map(|axis| axis.size);
    let count = check_memory::<S>(dims, reals(old, axes), limit)?;
    let taps = [0, 1, 2].map(|a| axes[a].taps(old[a], filter));
    Passes { old, dims, taps, filter }.run(samples, count)
}

/// Numbers of 8 bytes on the way: slices between the passes, and weights; `None` where they overflow.
pub(super) fn reals(old: [usize; 3], axes: &[NewAxis; 3]) -> Option<u64> {
    let between = match axes[2].places {
        Places::Same => 0,
        _ => (axes[0].size as u64).checked_mul(axes[1].size as u64)?.checked_mul(old[2] as u64)?,
    };
    let new_axes = axes.iter().filter(|axis| axis.places != Places::Same);
    let weights = new_axes.map(|axis| axis.size as u64).fold(0, u64::saturating_add);
    weights.checked_mul((size_of::<Taps>() / size_of::<f64>()) as u64)?.checked_add(between)
}

struct Passes {
    old: [usize; 3],
    dims: [usize; 3],
    /// Of each axis; one without stays.
    taps: [Option<Vec<Taps>>; 3],
    filter: Filter,
}

impl Passes {
    fn run<S: Sample>(&self, samples: &[S], count: usize) -> Result<(Samples, u64), VolumeError> {
        let [nx, ny, _] = self.dims;
        let slices = self.old[2];
        let mut new = reserve::<S>(count, self.dims)?;
        new.resize(count, S::default());
        let old_slices = samples.par_chunks_exact(self.old[0] * self.old[1]);
        let Some(along_z) = &self.taps[2] else {
            let pairs = new.par_chunks_exact_mut(nx * ny).zip(old_slices);
            let clipped = pairs.map(|(new, old)| store(&self.slice(old), new)).sum();
            return Ok((S::wrap(new), clipped));
        };
        let mut between = reserve::<f64>(nx * ny * slices, [nx, ny, slices])?;
        between.resize(nx * ny * slices, 0.0);
        between
            .par_chunks_exact_mut(nx * ny)
            .zip(old_slices)
            .for_each(|(new, old)| new.copy_from_slice(&self.slice(old)));
        if self.filter == Filter::Cubic {
            to_coefficients(&mut between, nx * ny);
        }
        let row = |values: &mut Vec<f64>, (row, new): (usize, &mut [S])| {
            let (y, z) = (row % ny, row / ny);
            values.clear();
            values.resize(nx, 0.0);
            for (slice, weight) in along_z[z].iter() {
                let old = &between[(slice * ny + y) * nx..][..nx];
                values.iter_mut().zip(old).for_each(|(sum, number)| *sum += weight * number);
            }
            store(values, new)
        };
        let clipped = new.par_chunks_exact_mut(nx).enumerate().map_init(Vec::new, row).sum();
        Ok((S::wrap(new), clipped))
    }

    /// A slice on the new grid of x and y.
    fn slice<S: Sample>(&self, samples: &[S]) -> Vec<f64> {
        let mut values: Vec<f64> = samples.iter().map(|&s| s.into()).collect();
        let [nx, ny, _] = self.dims;
        if let Some(taps) = &self.taps[0] {
            let mut new = vec![0.0; nx * self.old[1]];
            for (new, old) in new.chunks_exact_mut(nx).zip(values.chunks_exact_mut(self.old[0])) {
                if self.filter == Filter::Cubic {
                    to_coefficients(old, 1);
                }
                interpolate(old, 1, taps, new);
            }
            values = new;
        }
        if let Some(taps) = &self.taps[1] {
            if self.filter == Filter::Cubic {
                to_coefficients(&mut values, nx);
            }
            let mut new = vec![0.0; nx * ny];
            interpolate(&values, nx, taps, &mut new);
            values = new;
        }
        values
    }
}
