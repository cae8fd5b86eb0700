//! A grid along the world's axes, from one that is turned or slanted.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::spline::{Taps, to_coefficients};
use super::{
    Filter, NewGrid, Old, ROUNDING, ResampleReport, Resampling, check_memory, reals, samples, shortest, steps, store,
};
use crate::samples::with_type;
use crate::{Sample, Samples, Volume, VolumeError, World, with_samples};

/// The volume in the box around all its voxel centres; an axis of one voxel is one thick.
pub(super) fn resample(volume: &Volume, how: &Resampling, limit: u64) -> Result<(Volume, ResampleReport), VolumeError> {
    let source = volume.thickened();
    let grid = Straight::around(&Old::of(&source), how.grid)?;
    let least = source.finite_range().0.0;
    let outside = how.outside.unwrap_or(least);
    let (samples, clipped, outside) = grid.run(&source, how.filter, outside, limit)?;
    let world = World { space: volume.world.space, ..World::default() };
    let resampled = Volume::new(grid.dims, grid.spacing, samples)?.with_world(grid.origin.to_array(), world)?;
    let coarsest = grid.spacing.into_iter().fold(0.0, f64::max);
    let coarser = coarsest > shortest(&Old::of(&source)) * (1.0 + 1e-9);
    Ok((resampled, ResampleReport { clipped, outside, coarser }))
}

/// Voxels of the new grid.
pub(super) fn dims(old: &Old, grid: NewGrid) -> Result<[usize; 3], VolumeError> {
    Ok(Straight::around(old, grid)?.dims)
}

struct Straight {
    old: [usize; 3],
    dims: [usize; 3],
    spacing: [f64; 3],
    origin: DVec3,
    /// Where the new voxel (0, 0, 0) lies in the old grid, and how far each new step goes there, in old voxels.
    first: DVec3,
    step: [DVec3; 3],
}

impl Straight {
    fn around(volume: &Old, grid: NewGrid) -> Result<Self, VolumeError> {
        let old = volume.dims;
        let steps_in_world = [0, 1, 2].map(|a| DVec3::from(volume.world.directions[a]) * volume.spacing[a]);
        let matrix = DMat3::from_cols_array_2d(&steps_in_world.map(|s| s.to_array()));
        let corner = |c: usize| {
            let at = [0, 1, 2].map(|a| if c >> a & 1 == 1 { (old[a] - 1) as f64 } else { 0.0 });
            DVec3::from(volume.origin) + matrix * DVec3::from(at)
        };
        let least = (1..8).fold(corner(0), |least, c| least.min(corner(c)));
        let extent = ((1..8).fold(corner(0), |most, c| most.max(corner(c))) - least).to_array();
        let cells = |spacing: [f64; 3]| [0, 1, 2].map(|a| steps((extent[a] / spacing[a] - ROUNDING).ceil()));
        let (dims, spacing) = match grid {
            NewGrid::Cubes => (cells([shortest(volume); 3]), [shortest(volume); 3]),
            NewGrid::Spacing(spacing) => (cells(spacing), spacing),
            NewGrid::Size(size) if size.contains(&1) => {
                return Err(VolumeError::Parameter {
                    name: "size",
                    reason: format!("a single voxel has no distance to others ({size:?})"),
                    remedy: "give at least 2 for each axis",
                });
            }
            NewGrid::Size(size) => (size, [0, 1, 2].map(|a| extent[a] / (size[a] - 1) as f64)),
        };
        let inverse = matrix.inverse();
        if !inverse.is_finite() {
            return Err(VolumeError::Grid {
                what: "directions",
                reason: "the axes lie in one plane".to_owned(),
                remedy: "give three that do not",
            });
        }
        let first = inverse * (least - DVec3::from(volume.origin));
        let step = [0, 1, 2].map(|a| inverse.col(a) * spacing[a]);
        Ok(Self { old, dims, spacing, origin: least, first, step })
    }

    fn run(
        &self,
        source: &Volume,
        filter: Filter,
        outside: f64,
        limit: u64,
    ) -> Result<(Samples, u64, u64), VolumeError> {
        let sample_type = source.sample_type();
        let kept: f64 = with_type!(sample_type, S => S::nearest(outside).into());
        if !sample_type.is_float() && kept != outside {
            return Err(VolumeError::Parameter {
                name: "outside",
                reason: format!("{outside} is no value of {sample_type}"),
                remedy: "give one that the volume's type has",
            });
        }
        let on_the_way = if filter == Filter::Cubic { source.len() as u64 } else { 0 };
        let count = check_memory(self.dims, sample_type, Some(on_the_way), limit)?;
        let mut new = samples(count, self.dims, sample_type)?;
        let [clipped, outside] = match filter {
            Filter::Nearest | Filter::Linear => self.fill(&mut new, outside, |start, values| {
                with_samples!(&source.samples, v => self.row(filter, start, |index| f64::from(v[index]), values))
            }),
            Filter::Cubic => {
                let coefficients = self.coefficients(source)?;
                self.fill(&mut new, outside, |start, values| {
                    self.row(filter, start, |index| coefficients[index], values)
                })
            }
        };
        Ok((new, clipped, outside))
    }

    fn coefficients(&self, source: &Volume) -> Result<Vec<f64>, VolumeError> {
        let [nx, ny, _] = self.old;
        let mut values = reals(source.len(), self.old)?;
        values.par_chunks_exact_mut(nx * ny).enumerate().for_each(|(z, slice)| {
            with_samples!(&source.samples, v => {
                slice.iter_mut().zip(&v[z * nx * ny..]).for_each(|(value, &s)| *value = f64::from(s));
            });
            slice.chunks_exact_mut(nx).for_each(|row| to_coefficients(row, 1));
            to_coefficients(slice, nx);
        });
        to_coefficients(&mut values, nx * ny);
        Ok(values)
    }

    /// Fills the new samples, each row from its place in the old grid; what does not lie in the data is `outside`. How many were clipped,
    /// and how many lie outside.
    fn fill(&self, new: &mut Samples, outside: f64, row: impl Fn(DVec3, &mut [f64]) -> u64 + Sync) -> [u64; 2] {
        let [nx, ny, _] = self.dims;
        let sample_type = new.sample_type();
        let fill = |values: &mut Vec<f64>, (at, samples): (usize, &mut [u8])| {
            let start = self.first + self.step[1] * (at % ny) as f64 + self.step[2] * (at / ny) as f64;
            values.clear();
            values.resize(nx, outside);
            let outside = row(start, values);
            [store(values, samples, sample_type), outside]
        };
        let rows = new.bytes_mut().par_chunks_exact_mut(nx * sample_type.bytes()).enumerate();
        rows.map_init(Vec::new, fill).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    }

    /// The values of a row that lie in the data; how many do not.
    fn row(&self, filter: Filter, start: DVec3, number: impl Fn(usize) -> f64, values: &mut [f64]) -> u64 {
        let mut outside = 0;
        for (x, value) in values.iter_mut().enumerate() {
            match self.value(filter, start + self.step[0] * x as f64, &number) {
                Some(inside) => *value = inside,
                None => outside += 1,
            }
        }
        outside
    }

    /// The value at a place of the old grid; `None` outside of the box of voxel centres.
    fn value(&self, filter: Filter, place: DVec3, number: impl Fn(usize) -> f64) -> Option<f64> {
        let place = place.to_array();
        let within = |a: usize| (-ROUNDING..=(self.old[a] - 1) as f64 + ROUNDING).contains(&place[a]);
        if !(0..3).all(within) {
            return None;
        }
        let [x, y, z] = [0, 1, 2].map(|a| Taps::at(filter, self.old[a], place[a]));
        let along_x = |row: usize| x.iter().map(|(i, w)| w * number(row * self.old[0] + i)).sum::<f64>();
        let along_y = |slice: usize| y.iter().map(|(j, w)| w * along_x(slice * self.old[1] + j)).sum::<f64>();
        Some(z.iter().map(|(k, w)| w * along_y(k)).sum())
    }
}
