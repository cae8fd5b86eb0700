//! Voxel numbers from a stream of bytes into typed memory, in the order of the grid.
//!
//! ```text
//!   data files ──► Parts: skip, unpack, numbers ──► blocks of a few MB ──► convert, turn axes ──► samples
//!                  (a thread of its own)
//! ```
//!
//! Before anything is taken the header is held against the file's length, or what a compressed file of that length can unpack to
//! at most. Beside the samples there are two blocks, so that unpacking never waits for the axes to be turned.

use std::sync::mpsc::{channel, sync_channel};

use bytemuck::allocation::try_zeroed_vec;

use crate::limits::{no_room, sample_count};
use crate::parts::{Data, Parts};
use crate::place::Place;
use crate::samples::Stored;
use crate::world::AxisOrder;
use crate::{ReadOptions, Sample, SampleType, Samples, VolumeError};

/// Bytes of a block: what one core unpacks is still in its cache when the other takes it.
const BLOCK_BYTES: usize = 1 << 19;
/// Bytes of a block whose slices become columns: the more slices, the longer the runs that are written.
const WIDE_BLOCK_BYTES: usize = 6 << 20;
/// Side of the tiles in which axes are turned: what is read and written for one stays in the first cache.
const TILE: usize = 64;

/// The number type in a file: one of the eight, or a 64-bit integer, which is kept in 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StoredType {
    Plain(SampleType),
    I64,
    U64,
}

impl StoredType {
    pub fn bytes(self) -> usize {
        match self {
            StoredType::Plain(t) => t.bytes(),
            StoredType::I64 | StoredType::U64 => 8,
        }
    }
}

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw,
    Gzip,
    Zlib,
    /// Decimal numbers.
    Text,
    /// Bytes as two hexadecimal digits each.
    Hex,
}

/// What lies before the first number of a file, in bytes of the decoded stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Skip {
    Bytes(u64),
    /// The numbers are the last bytes of the file (raw encoding only).
    ToEnd,
}

/// How the volumes of a series lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Series {
    /// So many, one after another; 1 is no series.
    After(u64),
    /// So many, voxel by voxel: the series is the fastest axis.
    Within(u64),
}

impl Series {
    pub fn count(self) -> u64 {
        match self {
            Series::After(count) | Series::Within(count) => count,
        }
    }
}

/// Where the voxel numbers lie and how they are written.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Voxels along the stored axes, fastest first.
    pub dims: [usize; 3],
    pub stored: StoredType,
    pub big_endian: bool,
    pub encoding: Encoding,
    /// Lines before the bytes to skip, of each file.
    pub lines: u64,
    pub skip: Skip,
    pub series: Series,
    /// value = number·slope + intercept.
    pub scale: Option<[f64; 2]>,
    /// Whether the voxels must end the file: there is no header to say how many they are.
    pub last: bool,
}

impl Layout {
    /// The type in memory.
    pub fn kept(&self) -> SampleType {
        use SampleType::*;
        match (self.stored, self.scale) {
            (StoredType::Plain(t), None) => t,
            (StoredType::I64, None) => I32,
            (StoredType::U64, None) => U32,
            (StoredType::Plain(U8 | I8 | U16 | I16 | F32), Some(_)) => F32,
            (_, Some(_)) => F64,
        }
    }

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

    pub fn does_not_fit(&self, value: &str, index: u64, place: &Place) -> VolumeError {
        VolumeError::DoesNotFit {
            file: place.file.clone(),
            value: value.to_owned(),
            index,
            sample_type: self.kept(),
            remedy: match self.stored {
                StoredType::Plain(_) => "correct the number or the header's type".to_owned(),
                _ => "64-bit integers are kept in 32 bits; store the data as f64".to_owned(),
            },
        }
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

/// A stored number that is kept as it is.
trait Kept: Stored + Sample {}
impl<T: Stored + Sample> Kept for T {}

/// Consecutive numbers of the file that are a box of the stored grid.
#[derive(Clone, Copy, Debug)]
struct Block {
    from: [usize; 3],
    size: [usize; 3],
}

impl Block {
    fn len(&self) -> usize {
        self.size.iter().product()
    }
}

/// The stored grid in blocks of at most `most` numbers (at least one): parts of a row, rows of a slice, or slices.
fn blocks([nx, ny, nz]: [usize; 3], most: usize) -> impl Iterator<Item = Block> + Send {
    let i = most.clamp(1, nx);
    let j = if i == nx { (most / nx).clamp(1, ny) } else { 1 };
    let k = if j == ny { (most / (nx * ny)).clamp(1, nz) } else { 1 };
    let starts = |n: usize, step: usize| (0..n).step_by(step);
    starts(nz, k).flat_map(move |z| {
        starts(ny, j).flat_map(move |y| {
            starts(nx, i).map(move |x| Block { from: [x, y, z], size: [i.min(nx - x), j.min(ny - y), k.min(nz - z)] })
        })
    })
}

impl Job<'_> {
    fn read(&self, parts: Parts) -> Result<Samples, VolumeError> {
        fn kept<T: Kept>(job: &Job, parts: Parts) -> Result<Samples, VolumeError> {
            Ok(T::wrap(job.read_as::<T>(parts)?))
        }
        fn scaled<T: Stored>(job: &Job, parts: Parts, [slope, intercept]: [f64; 2]) -> Result<Samples, VolumeError> {
            if job.layout.kept() == SampleType::F32 {
                let scaled = |n: T| Some((n.double() * slope + intercept) as f32);
                job.convert(parts, scaled).map(Samples::F32)
            } else {
                job.convert(parts, |n: T| Some(n.double() * slope + intercept)).map(Samples::F64)
            }
        }
        macro_rules! for_stored {
            ($($name:ident $number:ident),*) => {
                match (self.layout.stored, self.layout.scale) {
                    $((StoredType::Plain(SampleType::$name), None) => kept::<$number>(self, parts),
                    (StoredType::Plain(SampleType::$name), Some(scale)) => scaled::<$number>(self, parts, scale),)*
                    (StoredType::I64, None) => self.convert(parts, |n: i64| i32::try_from(n).ok()).map(Samples::I32),
                    (StoredType::U64, None) => self.convert(parts, |n: u64| u32::try_from(n).ok()).map(Samples::U32),
                    (StoredType::I64, Some(scale)) => scaled::<i64>(self, parts, scale),
                    (StoredType::U64, Some(scale)) => scaled::<u64>(self, parts, scale),
                }
            };
        }
        for_stored!(U8 u8, I8 i8, U16 u16, I16 i16, U32 u32, I32 i32, F32 f32, F64 f64)
    }

    /// Numbers that stay what they are: where nothing is unpacked or turned they go straight to their place.
    fn read_as<T: Kept>(&self, mut parts: Parts) -> Result<Vec<T>, VolumeError> {
        let straight = self.order.is_stored() && matches!(self.layout.series, Series::After(_));
        if straight && parts.is_plain() {
            let mut samples = self.room()?;
            parts.fill::<T>(&mut samples)?;
            parts.finish()?;
            return Ok(samples);
        }
        self.convert(parts, Some)
    }

    /// Numbers that are converted and turned on the way.
    fn convert<T: Stored, S: Sample + bytemuck::Zeroable>(
        &self,
        mut parts: Parts,
        convert: impl Fn(T) -> Option<S>,
    ) -> Result<Vec<S>, VolumeError> {
        let dims = self.layout.dims;
        let within = match self.layout.series {
            Series::Within(volumes) => volumes as usize,
            Series::After(_) => 1,
        };
        let (first, strides) = self.order.strides(dims);
        let bytes = if strides[2].abs() == 1 { WIDE_BLOCK_BYTES } else { BLOCK_BYTES };
        let most = bytes / size_of::<T>() / within;
        let largest = blocks(dims, most).next().map_or(0, |block| block.len()) * within;
        let mut samples: Vec<S> = self.room()?;
        let mut put = |block: &Block, numbers: &[T]| self.put(block, numbers, &mut samples, (first, strides), &convert);
        let fill = |parts: &mut Parts, block: &Block, buffer: &mut [T]| {
            let numbers = &mut buffer[..block.len() * within];
            parts.fill(numbers)?;
            if within > 1 {
                for i in 0..block.len() {
                    numbers[i] = numbers[i * within + self.frame];
                }
            }
            Ok::<(), VolumeError>(())
        };
        let room = || try_zeroed_vec::<T>(largest).map_err(|_| self.no_room(largest * size_of::<T>()));
        if blocks(dims, most).nth(1).is_none() {
            let mut buffer = room()?;
            for block in blocks(dims, most) {
                fill(&mut parts, &block, &mut buffer)?;
                put(&block, &buffer[..block.len()])?;
            }
            parts.finish()?;
            return Ok(samples);
        }
        let (filled, full) = sync_channel::<(Block, Vec<T>)>(1);
        let (emptied, empty) = channel();
        for buffer in [room()?, room()?] {
            let _ = emptied.send(buffer);
        }
        std::thread::scope(|scope| {
            let filler = scope.spawn(move || {
                for block in blocks(dims, most) {
                    // Both ends go away only where the other has failed.
                    let Ok(mut buffer) = empty.recv() else { return Ok(()) };
                    fill(&mut parts, &block, &mut buffer)?;
                    if filled.send((block, buffer)).is_err() {
                        return Ok(());
                    }
                }
                parts.finish()
            });
            let placed = full.into_iter().try_for_each(|(block, buffer)| {
                put(&block, &buffer[..block.len()])?;
                let _ = emptied.send(buffer);
                Ok(())
            });
            drop(emptied);
            let filled = filler.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            placed.and(filled)
        })?;
        Ok(samples)
    }

    /// Puts a block of the stored grid where it belongs in the grid: the voxel (0, 0, 0) at `first`, steps of `strides`.
    fn put<T: Stored, S: Sample>(
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

    /// Room for all samples, of zeros that the system has not given yet.
    fn room<S: Sample + bytemuck::Zeroable>(&self) -> Result<Vec<S>, VolumeError> {
        try_zeroed_vec(self.count).map_err(|_| self.no_room(self.count * size_of::<S>()))
    }

    fn no_room(&self, bytes: usize) -> VolumeError {
        no_room(&self.place.file, self.layout.dims, self.layout.kept(), bytes as u64)
    }
}

/// Puts every `step`-th number into a run of samples, from its end where it is not `forward`; the error is the place in the run of the
/// first that cannot be converted.
#[inline]
fn put_run<T: Stored, S: Sample>(
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
