//! Samples of the eight numeric types that a voxel can have: their bytes, and their places in chunks.

use std::ops::Range;
use std::str::FromStr;

use bytemuck::allocation::try_zeroed_vec;
use rayon::prelude::*;

use crate::{SampleType, VolumeError};

// Not beside the type: errors have types in them.
impl FromStr for SampleType {
    type Err = VolumeError;

    fn from_str(name: &str) -> Result<Self, VolumeError> {
        let known = SampleType::ALL.into_iter().find(|known| known.name() == name);
        let remedy = "write u8, i8, u16, i16, u32, i32, f32 or f64";
        known.ok_or_else(|| VolumeError::unknown("sample type", name, remedy))
    }
}

/// A number as a file stores it.
pub(crate) trait Stored: bytemuck::Pod {
    /// The number rounded to double precision.
    fn double(self) -> f64;
}

macro_rules! stored {
    ($($number:ident),*) => {$(
        impl Stored for $number {
            fn double(self) -> f64 {
                self as f64
            }
        }
    )*};
}
stored!(u8, i8, u16, i16, u32, i32, i64, u64, f32, f64);

/// Turns the bytes of each number round, of `size` bytes each.
pub(crate) fn swap_bytes(numbers: &mut [u8], size: usize) {
    fn each<const SIZE: usize>(numbers: &mut [u8]) {
        numbers.as_chunks_mut::<SIZE>().0.iter_mut().for_each(|number| number.reverse());
    }
    match size {
        2 => each::<2>(numbers),
        4 => each::<4>(numbers),
        8 => each::<8>(numbers),
        _ => {}
    }
}

/// A numeric type that a voxel can have; implemented for the eight of [`SampleType`] only.
pub trait Sample: Copy + PartialOrd + Send + Sync + Into<f64> + Default + 'static + sealed::Sealed {
    /// The type's name as a value.
    const TYPE: SampleType;

    /// The nearest value of this type: integers round half away from zero and saturate, NaN
    /// becomes 0; floats round to nearest even.
    fn nearest(value: f64) -> Self;

    /// Wraps a vector of this type.
    fn wrap(samples: Vec<Self>) -> Samples;
}

mod sealed {
    pub trait Sealed: bytemuck::Pod {}
}

macro_rules! sample {
    ($($number:ident $name:ident $round:expr;)*) => {$(
        impl sealed::Sealed for $number {}
        impl Sample for $number {
            const TYPE: SampleType = SampleType::$name;
            fn nearest(value: f64) -> Self {
                ($round)(value) as $number
            }
            fn wrap(samples: Vec<Self>) -> Samples {
                Samples::$name(samples)
            }
        }
    )*};
}
sample! {
    u8 U8 f64::round;
    i8 I8 f64::round;
    u16 U16 f64::round;
    i16 I16 f64::round;
    u32 U32 f64::round;
    i32 I32 f64::round;
    f32 F32 std::convert::identity::<f64>;
    f64 F64 std::convert::identity::<f64>;
}

/// The samples of a volume, x fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Unsigned, 8 bits.
    U8(Vec<u8>),
    /// Signed, 8 bits.
    I8(Vec<i8>),
    /// Unsigned, 16 bits.
    U16(Vec<u16>),
    /// Signed, 16 bits.
    I16(Vec<i16>),
    /// Unsigned, 32 bits.
    U32(Vec<u32>),
    /// Signed, 32 bits.
    I32(Vec<i32>),
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
}

/// Runs one expression for whichever vector a [`Samples`] holds: the expression is compiled once
/// for each of the eight types, so loops inside it are loops over plain numbers.
///
/// ```
/// use cube3_volume::{Samples, with_samples};
/// let samples = Samples::U16(vec![3, 4, 5]);
/// let sum: f64 = with_samples!(&samples, v => v.iter().map(|&s| f64::from(s)).sum());
/// assert_eq!(sum, 12.0);
/// ```
#[macro_export]
macro_rules! with_samples {
    ($samples:expr, $vector:ident => $body:expr) => {{
        // Of the eight types, one is f64 already.
        #[allow(clippy::useless_conversion, clippy::let_and_return)]
        let outcome = match $samples {
            $crate::Samples::U8($vector) => $body,
            $crate::Samples::I8($vector) => $body,
            $crate::Samples::U16($vector) => $body,
            $crate::Samples::I16($vector) => $body,
            $crate::Samples::U32($vector) => $body,
            $crate::Samples::I32($vector) => $body,
            $crate::Samples::F32($vector) => $body,
            $crate::Samples::F64($vector) => $body,
        };
        outcome
    }};
}

/// As [`with_samples!`], by the type alone.
macro_rules! with_type {
    ($sample_type:expr, $number:ident => $body:expr) => {{
        macro_rules! of {
            ($concrete:ty) => {{
                type $number = $concrete;
                $body
            }};
        }
        match $sample_type {
            $crate::SampleType::U8 => of!(u8),
            $crate::SampleType::I8 => of!(i8),
            $crate::SampleType::U16 => of!(u16),
            $crate::SampleType::I16 => of!(i16),
            $crate::SampleType::U32 => of!(u32),
            $crate::SampleType::I32 => of!(i32),
            $crate::SampleType::F32 => of!(f32),
            $crate::SampleType::F64 => of!(f64),
        }
    }};
}
pub(crate) use with_type;

/// Samples that a core takes at a time.
pub(crate) const CHUNK: usize = 1 << 16;

/// The places of so many samples in chunks, on all cores. Loops over samples of a type lie inside a chunk, so that what spreads the chunks
/// is compiled once and not for each type.
pub(crate) fn chunks(count: usize) -> impl IndexedParallelIterator<Item = Range<usize>> {
    (0..count.div_ceil(CHUNK)).into_par_iter().map(move |i| i * CHUNK..((i + 1) * CHUNK).min(count))
}

impl Samples {
    /// So many zeros; `None` where the system has no memory for them. It gives the memory when it is written to.
    pub(crate) fn zeros(sample_type: SampleType, count: usize) -> Option<Self> {
        with_type!(sample_type, S => try_zeroed_vec::<S>(count).ok().map(S::wrap))
    }

    /// The samples in this machine's byte order.
    pub(crate) fn bytes(&self) -> &[u8] {
        with_samples!(self, v => bytemuck::cast_slice(v))
    }

    /// As [`Samples::bytes`], to be written.
    pub(crate) fn bytes_mut(&mut self) -> &mut [u8] {
        with_samples!(self, v => bytemuck::cast_slice_mut(v))
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        with_samples!(self, v => v.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type of the samples.
    pub fn sample_type(&self) -> SampleType {
        fn of<S: Sample>(_: &[S]) -> SampleType {
            S::TYPE
        }
        with_samples!(self, v => of(v))
    }

    /// The sample at `index`, in storage order. Every sample fits an `f64` exactly.
    ///
    /// # Panics
    ///
    /// When `index` is not below [`Samples::len`].
    #[inline]
    pub fn value(&self, index: usize) -> f64 {
        with_samples!(self, v => f64::from(v[index]))
    }
}
