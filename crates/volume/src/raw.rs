//! Bare numbers without a header: the reader must be told what they are.

use strum::{Display, EnumString};

use crate::error::show_dims;
use crate::open::Described;
use crate::parts::Data;
use crate::place::Place;
use crate::source::{Left, Source};
use crate::stream::{Encoding, Layout, Series, Skip, StoredType};
use crate::volume::check_grid;
use crate::world::Placed;
use crate::{ReadOptions, SampleType, VolumeError};

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

/// What the layout says of a raw file. The file's length must be that of the layout, to the byte: with nothing else to go by,
/// that is the one check of the dimensions.
pub(crate) fn describe<'a>(
    mut source: Source<'a>,
    options: &ReadOptions,
    place: &Place,
) -> Result<Described<'a>, VolumeError> {
    let raw = options.raw.as_ref().ok_or_else(|| VolumeError::RawLayoutMissing { file: place.file.clone() })?;
    check_grid(raw.dims, raw.spacing, raw.origin).map_err(|e| place.grid(e))?;
    let size = raw.sample_type.bytes() as u64;
    let needed = raw.dims.iter().fold(size, |p, &d| p.saturating_mul(d as u64)).saturating_add(raw.skip_bytes);
    if let Left::Exactly(found) = source.left().map_err(|e| place.io("read", e))?
        && needed != found
    {
        return Err(VolumeError::RawLength {
            file: place.file.clone(),
            layout: format!("{} of {}, {} bytes skipped", show_dims(&raw.dims), raw.sample_type, raw.skip_bytes),
            needed,
            found,
        });
    }
    let layout = Layout {
        dims: raw.dims,
        stored: StoredType::Plain(raw.sample_type),
        big_endian: raw.endian == Endian::Big,
        encoding: Encoding::Raw,
        lines: 0,
        skip: Skip::Bytes(raw.skip_bytes),
        series: Series::After(1),
        scale: None,
        last: true,
    };
    let placed = Placed::unknown(raw.spacing, raw.origin);
    Ok(Described { layout, placed, data: Data::Here(source), remarks: Vec::new() })
}
