//! What bare numbers are.

use strum::{Display, EnumString};

use crate::{SampleType, VolumeError};

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Display, EnumString)]
#[strum(serialize_all = "lowercase", parse_err_ty = VolumeError, parse_err_fn = unknown)]
pub enum Endian {
    /// The least significant byte comes first.
    #[default]
    Little,
    /// The most significant byte comes first.
    Big,
}

fn unknown(name: &str) -> VolumeError {
    VolumeError::unknown("endian", name, "write little or big")
}

/// What a raw file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLayout {
    /// Voxels along x, y and z.
    pub dims: [usize; 3],
    /// The type of the numbers.
    pub sample_type: SampleType,
    /// The order of their bytes.
    pub endian: Endian,
    /// Distance between voxel centres along x, y and z.
    pub spacing: [f64; 3],
    /// Position of voxel (0, 0, 0).
    pub origin: [f64; 3],
    /// Bytes before the first number.
    pub skip_bytes: u64,
}

impl RawLayout {
    /// Little-endian numbers from the first byte, at unit spacing.
    pub fn new(dims: [usize; 3], sample_type: SampleType) -> Self {
        Self { dims, sample_type, endian: Endian::Little, spacing: [1.0; 3], origin: [0.0; 3], skip_bytes: 0 }
    }
}
