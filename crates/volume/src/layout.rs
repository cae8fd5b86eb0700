//! Where the voxel numbers of a file lie, and how they are written.

use std::str::FromStr;

use crate::place::Place;
use crate::samples::{Stored, with_type};
use crate::{SampleType, VolumeError};

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

    /// The number that a word says, in this machine's byte order; `None` where it says none of this type.
    pub fn parse(self, word: &str, number: &mut [u8]) -> Option<()> {
        fn of<T: Stored + FromStr>(word: &str, number: &mut [u8]) -> Option<()> {
            number.copy_from_slice(bytemuck::bytes_of(&word.parse::<T>().ok()?));
            Some(())
        }
        match self {
            StoredType::Plain(plain) => with_type!(plain, S => of::<S>(word, number)),
            StoredType::I64 => of::<i64>(word, number),
            StoredType::U64 => of::<u64>(word, number),
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
