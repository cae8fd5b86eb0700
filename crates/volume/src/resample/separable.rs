//! Another grid along the same axes: one axis after the other.

use rayon::prelude::*;

use super::spline::{Taps, interpolate, to_coefficients};
use super::{Filter, NewAxis, Places, check_memory, reals, samples, store};
use crate::{Samples, Volume, VolumeError, with_samples};

/// The samples at the places of the new axes, and how many were clipped.
pub(super) fn resample(
    volume: &Volume,
    axes: &[NewAxis; 3],
    filter: Filter,
    limit: u64,
) -> Result<(Samples, u64), VolumeError> {
    let old = volume.dims;
    let count = check_memory(axes.map(|axis| axis.size), volume.sample_type(), numbers_on_the_way(old, axes), limit)?;
    let taps = [0, 1, 2].map(|a| axes[a].taps(old[a], filter));
    Passes { old: volume, dims: axes.map(|axis| axis.size), taps, filter }.run(count)
}

/// Numbers of 8 bytes on the way: slices between the passes, and weights; `None` where they overflow.
pub(super) fn numbers_on_the_way(old: [usize; 3], axes: &[NewAxis; 3]) -> Option<u64> {
    let between = match axes[2].places {
        Places::Same => 0,
        _ => (axes[0].size as u64).checked_mul(axes[1].size as u64)?.checked_mul(old[2] as u64)?,
    };
    let new_axes = axes.iter().filter(|axis| axis.places != Places::Same);
    let weights = new_axes.map(|axis| axis.size as u64).fold(0, u64::saturating_add);
    weights.checked_mul((size_of::<Taps>() / size_of::<f64>()) as u64)?.checked_add(between)
}

struct Passes<'a> {
    old: &'a Volume,
    dims: [usize; 3],
    /// Of each axis; one without stays.
    taps: [Option<Vec<Taps>>; 3],
    filter: Filter,
}

impl Passes<'_> {
    fn run(&self, count: usize) -> Result<(Samples, u64), VolumeError> {
        let [nx, ny, _] = self.dims;
        let sample_type = self.old.sample_type();
        let mut new = samples(count, self.dims, sample_type)?;
        let Some(along_z) = &self.taps[2] else {
            let slices = new.bytes_mut().par_chunks_exact_mut(nx * ny * sample_type.bytes()).enumerate();
            let clipped = slices.map(|(z, new)| store(&self.slice(z), new, sample_type)).sum();
            return Ok((new, clipped));
        };
        let slices = self.old.dims[2];
        let mut between = reals(nx * ny * slices, [nx, ny, slices])?;
        between.par_chunks_exact_mut(nx * ny).enumerate().for_each(|(z, new)| new.copy_from_slice(&self.slice(z)));
        if self.filter == Filter::Cubic {
            to_coefficients(&mut between, nx * ny);
        }
        let row = |values: &mut Vec<f64>, (row, new): (usize, &mut [u8])| {
            let (y, z) = (row % ny, row / ny);
            values.clear();
            values.resize(nx, 0.0);
            for (slice, weight) in along_z[z].iter() {
                let old = &between[(slice * ny + y) * nx..][..nx];
                values.iter_mut().zip(old).for_each(|(sum, number)| *sum += weight * number);
            }
            store(values, new, sample_type)
        };
        let rows = new.bytes_mut().par_chunks_exact_mut(nx * sample_type.bytes()).enumerate();
        let clipped = rows.map_init(Vec::new, row).sum();
        Ok((new, clipped))
    }

    /// An old slice on the new grid of x and y.
    fn slice(&self, z: usize) -> Vec<f64> {
        let [old_nx, old_ny, _] = self.old.dims;
        let slice = z * old_nx * old_ny..(z + 1) * old_nx * old_ny;
        let mut values: Vec<f64> =
            with_samples!(&self.old.samples, v => v[slice].iter().map(|&s| f64::from(s)).collect());
        let [nx, ny, _] = self.dims;
        if let Some(taps) = &self.taps[0] {
            let mut new = vec![0.0; nx * old_ny];
            for (new, old) in new.chunks_exact_mut(nx).zip(values.chunks_exact_mut(old_nx)) {
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
