//! Bare numbers without a header: the reader must be told what they are.

use crate::described::Described;
use crate::error::show_dims;
use crate::layout::{Encoding, Layout, Series, Skip, StoredType};
use crate::parts::Data;
use crate::place::Place;
use crate::source::{Left, Source};
use crate::volume::check_grid;
use crate::world::Placed;
use crate::{Endian, ReadOptions, VolumeError};

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
