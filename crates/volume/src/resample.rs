//! A volume on another grid: other distances between voxels, or axes along the world's.
//!
//! What is drawn is the box of the voxel centres. Where the axes stay, so does the box: the first and the last centre of an axis
//! keep their places. An axis of one voxel stays as it is.
//!
//! ```text
//!   axes stay   x, y within each slice, then z          separable.rs
//!   straight    each new voxel by its place in the old   straight.rs
//!   both        weights and coefficients of an axis      spline.rs
//! ```

mod filter;
mod separable;
mod spline;
mod straight;

use bytemuck::allocation::try_zeroed_vec;

use crate::error::show_dims;
use crate::samples::with_type;
use crate::{FileInfo, ReadOptions, Sample, SampleType, Samples, Space, Volume, VolumeError, World, thick_dims};

pub use filter::Filter;
use spline::Taps;

/// The distances of the new voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NewGrid {
    /// The shortest distance of the volume along every axis.
    #[default]
    Cubes,
    /// Distances along x, y and z. The last voxel of an axis is the last one within the old box.
    Spacing([f64; 3]),
    /// Voxels along x, y and z, the first and the last where they were.
    Size([usize; 3]),
}

/// How a volume is resampled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resampling {
    /// The distances of the new voxels.
    pub grid: NewGrid,
    /// Whether the new axes are the world's. The grid is the box around all old centres then.
    pub straight: bool,
    /// What lies between voxels.
    pub filter: Filter,
    /// The value outside of the data, where `straight` has such places; the least value of the volume without it.
    pub outside: Option<f64>,
    /// The most memory to take, as in [`ReadOptions`].
    pub memory_limit_bytes: Option<u64>,
}

/// What a resampling did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResampleReport {
    /// Voxels whose value was beyond the range of their type; they are held at its end.
    pub clipped: u64,
    /// Voxels outside of the data.
    pub outside: u64,
    /// Whether new voxels are farther apart than old ones along some axis: finer detail is not smoothed away, it aliases.
    pub coarser: bool,
}

/// The volume on another grid, with samples of the same type: integers are rounded, a half away from zero, and saturated.
///
/// The same volume gives the same bits on any number of threads.
///
/// # Errors
///
/// [`VolumeError::Parameter`] for distances and sizes that make no grid, for `straight` in a world that is not known, for an
/// `outside` that the type does not have, and for NaN or infinities before a cubic filter, which would spread them over all;
/// [`VolumeError::TooLarge`] before memory beyond the limit is taken.
pub fn resample(volume: &Volume, how: &Resampling) -> Result<(Volume, ResampleReport), VolumeError> {
    if how.straight && volume.world.space == Space::Unknown {
        return Err(VolumeError::Parameter {
            name: "straight",
            reason: "the file does not say how its axes run in the world".to_owned(),
            remedy: "leave it out",
        });
    }
    check_new(how.grid)?;
    if how.filter == Filter::Cubic
        && let Some(bad) = volume.first_non_finite()
    {
        let [x, y, z] = bad.position;
        return Err(VolumeError::Parameter {
            name: "filter",
            reason: format!("voxel ({x}, {y}, {z}) is {}, which a cubic filter spreads over its lines", bad.value),
            remedy: "take the filter linear, or repair the data",
        });
    }
    let limit = ReadOptions { memory_limit_bytes: how.memory_limit_bytes, ..ReadOptions::default() }.limit();
    let old = Old::of(volume);
    if how.straight && !old.is_straight() {
        return straight::resample(volume, how, limit);
    }
    let axes = plan(&old, how.grid)?;
    let dims = [0, 1, 2].map(|a| axes[a].size);
    let spacing = [0, 1, 2].map(|a| axes[a].spacing);
    let (samples, clipped) = separable::resample(volume, &axes, how.filter, limit)?;
    let coarser = (0..3).any(|a| spacing[a] > volume.spacing[a] * (1.0 + 1e-9));
    let resampled = Volume::new(dims, spacing, samples)?.with_world(volume.origin, volume.world)?;
    Ok((resampled, ResampleReport { clipped, outside: 0, coarser }))
}

fn check_new(grid: NewGrid) -> Result<(), VolumeError> {
    match grid {
        NewGrid::Spacing(spacing) if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) => {
            Err(VolumeError::Parameter {
                name: "spacing",
                reason: format!("{spacing:?} is no distance between voxels"),
                remedy: "give a positive number for each axis",
            })
        }
        NewGrid::Size(size) if size.contains(&0) => Err(VolumeError::Parameter {
            name: "size",
            reason: format!("{} holds no voxel", show_dims(&size)),
            remedy: "give at least 2 for each axis, 1 for one that has a single voxel",
        }),
        _ => Ok(()),
    }
}

/// An axis of the new grid, along the old one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NewAxis {
    size: usize,
    spacing: f64,
    places: Places,
}

/// Where the new centres of an axis lie.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Places {
    /// Where the old ones do.
    Same,
    /// From the first to the last.
    EndToEnd,
    /// So many old steps apart.
    Apart(f64),
}

impl NewAxis {
    /// The weights of each new centre, for an axis of `old` voxels; `None` where nothing changes.
    fn taps(&self, old: usize, filter: Filter) -> Option<Vec<Taps>> {
        let (last, new_last) = (old - 1, self.size - 1);
        let at = |i: usize| match self.places {
            // Quotients of whole numbers, so that the grid is the same from either end.
            Places::EndToEnd => {
                let (cell, rest) = (i * last / new_last, i * last % new_last);
                let part = |rest: usize| rest as f64 / new_last as f64;
                Taps::new(filter, old, cell, part(new_last - rest), part(rest))
            }
            Places::Apart(steps) => Taps::at(filter, old, i as f64 * steps),
            Places::Same => Taps::at(filter, old, i as f64),
        };
        (self.places != Places::Same).then(|| (0..self.size).map(at).collect())
    }
}

/// The grid that is left, without its samples.
#[derive(Clone, Copy)]
struct Old {
    dims: [usize; 3],
    spacing: [f64; 3],
    origin: [f64; 3],
    world: World,
}

impl Old {
    fn of(volume: &Volume) -> Self {
        Self { dims: volume.dims, spacing: volume.spacing, origin: volume.origin, world: volume.world }
    }

    /// Whether its axes are those of the world already.
    fn is_straight(&self) -> bool {
        let along = World { space: self.world.space, ..World::default() };
        self.world.left_over().is_straight() && self.world.letters() == along.letters()
    }
}

/// Bytes that a resampling takes beside the volume: the new samples, and reals on the way.
///
/// # Errors
///
/// As [`resample`], but for those of the samples.
pub fn resample_bytes(about: &FileInfo, how: &Resampling) -> Result<u64, VolumeError> {
    check_new(how.grid)?;
    let FileInfo { dims, spacing, origin, world, sample_type, .. } = *about;
    let old = Old { dims, spacing, origin, world };
    let of = |dims: [usize; 3], bytes: usize| dims.iter().fold(bytes as u64, |p, &n| p.saturating_mul(n as u64));
    if how.straight && !old.is_straight() {
        let thick = Old { dims: thick_dims(dims), ..old };
        let new = straight::dims(&thick, how.grid)?;
        let reals = if how.filter == Filter::Cubic { of(thick.dims, size_of::<f64>()) } else { 0 };
        return Ok(of(new, sample_type.bytes()).saturating_add(reals));
    }
    let axes = plan(&old, how.grid)?;
    let reals = separable::numbers_on_the_way(dims, &axes).unwrap_or(u64::MAX).saturating_mul(size_of::<f64>() as u64);
    Ok(of([0, 1, 2].map(|a| axes[a].size), sample_type.bytes()).saturating_add(reals))
}

fn plan(volume: &Old, grid: NewGrid) -> Result<[NewAxis; 3], VolumeError> {
    let shortest = shortest(volume);
    let mut axes =
        [0, 1, 2].map(|a| NewAxis { size: volume.dims[a], spacing: volume.spacing[a], places: Places::Same });
    for (a, axis) in axes.iter_mut().enumerate() {
        let (old, spacing) = (volume.dims[a], volume.spacing[a]);
        let extent = (old - 1) as f64 * spacing;
        match grid {
            NewGrid::Size(size) if (old == 1) != (size[a] == 1) => {
                return Err(VolumeError::Parameter {
                    name: "size",
                    reason: format!("{} for an axis of {old}, {}", size[a], ["x", "y", "z"][a]),
                    remedy: "a single voxel stays single, and others keep their first and last: at least 2",
                });
            }
            NewGrid::Size(size) if size[a] != old => {
                let spacing = extent / (size[a] - 1) as f64;
                *axis = NewAxis { size: size[a], spacing, places: Places::EndToEnd };
            }
            NewGrid::Size(_) => {}
            _ if old == 1 => {}
            NewGrid::Cubes | NewGrid::Spacing(_) => {
                let new = if let NewGrid::Spacing(new) = grid { new[a] } else { shortest };
                let size = steps((extent / new + ROUNDING).floor());
                if size < 2 {
                    return Err(VolumeError::Parameter {
                        name: "spacing",
                        reason: format!("{new} leaves a single voxel along {}", ["x", "y", "z"][a]),
                        remedy: "the axis is (voxels − 1)·spacing long; give at most that",
                    });
                }
                if new != spacing {
                    *axis = NewAxis { size, spacing: new, places: Places::Apart(new / spacing) };
                }
            }
        }
    }
    Ok(axes)
}

/// What messages about memory call it.
const WHAT: &str = "resampled volume";
/// Of a voxel: what a quotient of distances may be off.
const ROUNDING: f64 = 1e-6;

/// Voxels of an axis of so many steps.
fn steps(steps: f64) -> usize {
    (steps as usize).saturating_add(1)
}

/// The shortest distance of neighbours; of the spacing where there are none.
fn shortest(volume: &Old) -> f64 {
    let neighbours = (0..3).filter(|&a| volume.dims[a] > 1).map(|a| volume.spacing[a]);
    let shortest = neighbours.fold(f64::INFINITY, f64::min);
    if shortest.is_finite() { shortest } else { volume.spacing[0] }
}

/// Checks what a resampling takes: the new samples, and `reals` of double precision on the way. Gives the number of samples.
fn check_memory(
    dims: [usize; 3],
    sample_type: SampleType,
    reals: Option<u64>,
    limit: u64,
) -> Result<usize, VolumeError> {
    let on_the_way = reals.and_then(|reals| reals.checked_mul(size_of::<f64>() as u64));
    let left = on_the_way.map_or(0, |bytes| limit.saturating_sub(bytes));
    crate::limits::sample_count(dims, sample_type, left, WHAT).map_err(|error| match error {
        VolumeError::TooLarge { file, dims, sample_type, needed, .. } => {
            let sum = needed.parse().ok().zip(on_the_way).and_then(|(a, b): (u64, u64)| a.checked_add(b));
            let needed = sum.map_or("more than 2^64".to_owned(), |bytes| bytes.to_string());
            VolumeError::TooLarge { file, dims, sample_type, needed, limit }
        }
        other => other,
    })
}

/// Room for so many samples.
fn samples(count: usize, dims: [usize; 3], sample_type: SampleType) -> Result<Samples, VolumeError> {
    let needed = (count as u64).saturating_mul(sample_type.bytes() as u64);
    Samples::zeros(sample_type, count).ok_or_else(|| crate::limits::no_room(WHAT, dims, sample_type, needed))
}

/// Room for so many numbers of double precision.
fn reals(count: usize, dims: [usize; 3]) -> Result<Vec<f64>, VolumeError> {
    let needed = (count as u64).saturating_mul(size_of::<f64>() as u64);
    try_zeroed_vec(count).map_err(|_| crate::limits::no_room(WHAT, dims, SampleType::F64, needed))
}

/// Values as samples of a type, whose bytes they become; how many were beyond its range.
fn store(values: &[f64], samples: &mut [u8], sample_type: SampleType) -> u64 {
    fn of<S: Sample>(values: &[f64], samples: &mut [S]) -> u64 {
        let mut clipped = 0;
        for (&value, sample) in values.iter().zip(samples) {
            *sample = S::nearest(value);
            // Rounding moves a value by half at most.
            clipped += u64::from(!S::TYPE.is_float() && (Into::<f64>::into(*sample) - value).abs() > 0.5);
        }
        clipped
    }
    with_type!(sample_type, S => of::<S>(values, bytemuck::cast_slice_mut(samples)))
}
