//! Voxel numbers from a stream of bytes into typed memory, in the order of the grid.
//!
//! ```text
//!   data files ──► Parts: skip, unpack, numbers ──► blocks of a few MB ──► convert, turn axes ──► samples
//!                  (a thread of its own)
//! ```
//!
//! Before anything is taken the header is held against the file's length, or what a compressed file of that length can unpack to
//! at most. Beside the samples there are two blocks, so that unpacking never waits for the axes to be turned.

use bytemuck::{cast_slice, cast_slice_mut};

use crate::blocks::{Block, Blocks};
use crate::layout::{Layout, Series, StoredType};
use crate::limits::{no_room, sample_count};
use crate::parts::{Data, Parts};
use crate::place::Place;
use crate::samples::Stored;
use crate::world::AxisOrder;
use crate::{ReadOptions, SampleType, Samples, VolumeError};

/// Bytes of a block: what one core unpacks is still in its cache when the other takes it.
const BLOCK_BYTES: usize = 1 << 19;
/// Bytes of a block whose slices become columns: the more slices, the longer the runs that are written.
const WIDE_BLOCK_BYTES: usize = 6 << 20;
/// Side of the tiles in which axes are turned: what is read and written for one stays in the first cache.
const TILE: usize = 64;

impl Layout {
    /// Reads the numbers of one volume, its axes turned by `order`.
    pub fn read(
        &self,
        data: Data,
        order: AxisOrder,
        options: &ReadOptions,
        place: &Place,
    ) -> Result<Samples, VolumeError> {
        let (frame, volumes) = (options.frame as u64, self.series.count());
        if frame >= volumes {
            return Err(place.wrong("time", format!("volume {frame} of a file of {volumes}"), "volumes count from 0"));
        }
        let count = sample_count(self.dims, self.kept(), options.limit(), &place.file)?;
        let total = (count as u64).checked_mul(volumes);
        let total = total.filter(|total| total.checked_mul(self.stored.bytes() as u64).is_some());
        let total = total.ok_or_else(|| place.wrong("sizes", "more than 2^64 bytes", "correct the sizes"))?;
        let mut parts = Parts::new(self, data, total, place)?;
        if let Series::After(_) = self.series {
            parts.pass_over(frame * count as u64)?;
        }
        Job { layout: self, order, frame: options.frame, count, place }.read(parts)
    }
}

/// The reading of one volume.
struct Job<'a> {
    layout: &'a Layout,
    order: AxisOrder,
    frame: usize,
    count: usize,
    place: &'a Place,
}

impl Job<'_> {
    fn read(&self, mut parts: Parts) -> Result<Samples, VolumeError> {
        let kept = self.layout.kept();
        let no_room = |bytes: usize| no_room(&self.place.file, self.layout.dims, kept, bytes as u64);
        let mut samples = Samples::zeros(kept, self.count).ok_or_else(|| no_room(self.count * kept.bytes()))?;
        let unchanged = self.layout.stored == StoredType::Plain(kept) && self.layout.scale.is_none();
        let together = matches!(self.layout.series, Series::After(_));
        // Where nothing is unpacked, converted or turned the numbers go straight to their place.
        if unchanged && together && self.order.is_stored() && parts.is_plain() {
            parts.fill(samples.bytes_mut())?;
            parts.finish()?;
            return Ok(samples);
        }
        let places = self.order.strides(self.layout.dims);
        let (_, strides) = places;
        let blocks = Blocks {
            dims: self.layout.dims,
            size: self.layout.stored.bytes(),
            bytes: if strides[2].abs() == 1 { WIDE_BLOCK_BYTES } else { BLOCK_BYTES },
            volumes: match self.layout.series {
                Series::Within(volumes) => volumes as usize,
                Series::After(_) => 1,
            },
            frame: self.frame,
        };
        let samples_bytes = samples.bytes_mut();
        blocks.read(parts, &no_room, &mut |block, numbers| self.convert(block, numbers, samples_bytes, places))?;
        Ok(samples)
    }

    /// Puts a block of stored numbers among the samples, converted. Numbers that stay what they are differ in size alone.
    fn convert(
        &self,
        block: &Block,
        numbers: &[u8],
        samples: &mut [u8],
        places: (usize, [isize; 3]),
    ) -> Result<(), VolumeError> {
        macro_rules! put {
            ($from:ident, $to:ident, $convert:expr) => {
                self.put::<$from, $to>(block, cast_slice(numbers), cast_slice_mut(samples), places, &$convert)
            };
        }
        macro_rules! for_stored {
            ($($name:ident $number:ident $float:ident),*) => {
                match (self.layout.stored, self.layout.scale) {
                    $((StoredType::Plain(SampleType::$name), Some([slope, intercept])) => {
                        put!($number, $float, |n: $number| Some((n.double() * slope + intercept) as $float))
                    })*
                    (StoredType::I64, Some([slope, intercept])) => {
                        put!(i64, f64, |n: i64| Some(n.double() * slope + intercept))
                    }
                    (StoredType::U64, Some([slope, intercept])) => {
                        put!(u64, f64, |n: u64| Some(n.double() * slope + intercept))
                    }
                    (StoredType::I64, None) => put!(i64, i32, |n: i64| i32::try_from(n).ok()),
                    (StoredType::U64, None) => put!(u64, u32, |n: u64| u32::try_from(n).ok()),
                    (StoredType::Plain(kept), None) => match kept.bytes() {
                        1 => put!(u8, u8, Some),
                        2 => put!(u16, u16, Some),
                        4 => put!(u32, u32, Some),
                        _ => put!(u64, u64, Some),
                    },
                }
            };
        }
        for_stored!(U8 u8 f32, I8 i8 f32, U16 u16 f32, I16 i16 f32, U32 u32 f64, I32 i32 f64, F32 f32 f32, F64 f64 f64)
    }

    /// Puts a block of the stored grid where it belongs in the grid: the voxel (0, 0, 0) at `first`, steps of `strides`.
    fn put<T: Stored, S: Copy>(
        &self,
        block: &Block,
        numbers: &[T],
        samples: &mut [S],
        (first, strides): (usize, [isize; 3]),
        convert: &impl Fn(T) -> Option<S>,
    ) -> Result<(), VolumeError> {
        let [nx, ny, _] = block.size;
        let sources = [1, nx, nx * ny];
        let from = (0..3).map(|a| block.from[a] as isize * strides[a]).sum::<isize>() + first as isize;
        let bad = |source: usize| {
            let at = [source % nx, source / nx % ny, source / nx / ny];
            let [dx, dy, _] = self.layout.dims;
            let [i, j, k] = [0, 1, 2].map(|a| block.from[a] + at[a]);
            let index = (k * dy + j) * dx + i;
            self.layout.does_not_fit(&numbers[source].double().to_string(), index as u64, self.place)
        };
        // The innermost loop goes along the axis whose samples lie side by side.
        let fast = strides.iter().position(|s| s.abs() == 1).unwrap_or(0);
        let [a, b] = [[1, 2], [0, 2], [0, 1]][fast];
        let tile = if fast == 0 { nx } else { TILE };
        let from_to = |b_at: usize, a_at: usize, fast_at: usize| {
            let along = [(b, b_at), (a, a_at), (fast, fast_at)];
            let source: usize = along.iter().map(|&(axis, at)| at * sources[axis]).sum();
            let to = from + along.iter().map(|&(axis, at)| at as isize * strides[axis]).sum::<isize>();
            (source, to as usize)
        };
        for b_at in 0..block.size[b] {
            for a_from in (0..block.size[a]).step_by(TILE) {
                for fast_from in (0..block.size[fast]).step_by(tile) {
                    let length = tile.min(block.size[fast] - fast_from);
                    for a_at in a_from..block.size[a].min(a_from + TILE) {
                        let (source, to) = from_to(b_at, a_at, fast_from);
                        let forward = strides[fast] > 0;
                        let to = if forward { to } else { to + 1 - length };
                        let run = &mut samples[to..][..length];
                        put_run(&numbers[source..], sources[fast], run, forward, convert)
                            .map_err(|stopped| bad(source + stopped * sources[fast]))?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Puts every `step`-th number into a run of samples, from its end where it is not `forward`; the error is the place in the run of the
/// first that cannot be converted.
#[inline]
fn put_run<T: Stored, S: Copy>(
    numbers: &[T],
    step: usize,
    run: &mut [S],
    forward: bool,
    convert: &impl Fn(T) -> Option<S>,
) -> Result<(), usize> {
    let length = run.len();
    // The loops have nothing to decide: a run that cannot be converted is searched afterwards.
    let mut good = true;
    let mut put = |number: &T, sample: &mut S| match convert(*number) {
        Some(converted) => *sample = converted,
        None => good = false,
    };
    match (step, forward) {
        (1, true) => numbers[..length].iter().zip(run).for_each(|(n, s)| put(n, s)),
        (1, false) => numbers[..length].iter().zip(run.iter_mut().rev()).for_each(|(n, s)| put(n, s)),
        (_, true) => run.iter_mut().enumerate().for_each(|(i, s)| put(&numbers[i * step], s)),
        (_, false) => run.iter_mut().rev().enumerate().for_each(|(i, s)| put(&numbers[i * step], s)),
    }
    let stopped = if good { None } else { (0..length).find(|i| convert(numbers[i * step]).is_none()) };
    stopped.map_or(Ok(()), Err)
}
