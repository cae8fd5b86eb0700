//! NRRD ("nearly raw raster data"), versions 1 to 5.
//!
//! <https://teem.sourceforge.net/nrrd/format.html>. Header and voxels in one file, or the header alone with the names of data
//! files; encodings raw, gzip, ascii and hex. The world is known where a `space` is named and `space directions` are given.
//! Axes beyond three are a series of volumes, or a voxel's single component.

use crate::described::Described;
use crate::files::several;
use crate::layout::{Encoding, Layout, Skip, StoredType};
use crate::nrrd_axes::Axes;
use crate::nrrd_header::Header;
use crate::parts::Data;
use crate::place::Place;
use crate::source::Source;
use crate::text::{Field, clip};
use crate::{SampleType, VolumeError};

/// Reads the header from its first byte.
pub(crate) fn describe<'a>(mut source: Source<'a>, place: &Place) -> Result<Described<'a>, VolumeError> {
    let header = Header::parse(&mut source, place)?;
    let axes = Axes::of(&header, place)?;
    let mut remarks = Vec::new();
    let placed = axes.placed(&header, place, &mut remarks)?;
    let stored = stored_type(&header.need("type", place)?)?;
    let encoding = encoding(&header.need("encoding", place)?)?;
    let big_endian = match header.find("endian", place) {
        Some(field) => match field.value.to_lowercase().as_str() {
            "little" => false,
            "big" => true,
            other => {
                return Err(field.wrong(format!("'{}' is no endian", clip(other)), "write little or big"));
            }
        },
        None if stored.bytes() == 1 || encoding == Encoding::Text => false,
        None => header.need("endian", place).map(|_| false)?,
    };
    let lines: u64 = match header.find("line skip", place) {
        Some(field) => field.number("give how many lines to skip, at least 0")?,
        None => 0,
    };
    let skip = byte_skip(&header, place, encoding)?;
    let data = match header.find("data file", place) {
        None => Data::Here(source),
        Some(field) if field.value.is_empty() => return Err(field.wrong("no name", "give the data file's name")),
        Some(field) => {
            let files = match several(&field, &header.list, &axes.sizes, place)? {
                Some(files) => files,
                None => vec![place.beside(field.value)?],
            };
            Data::Beside { files, unpack: false }
        }
    };
    let (dims, series) = (axes.dims(), axes.series);
    let layout = Layout { dims, stored, big_endian, encoding, lines, skip, series, scale: None, last: false };
    Ok(Described { layout, placed, data, remarks })
}

fn stored_type(field: &Field) -> Result<StoredType, VolumeError> {
    use SampleType::*;
    let name = field.value.to_lowercase();
    Ok(match name.as_str() {
        "signed char" | "int8" | "int8_t" => StoredType::Plain(I8),
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => StoredType::Plain(U8),
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => StoredType::Plain(I16),
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => StoredType::Plain(U16),
        "int" | "signed int" | "int32" | "int32_t" => StoredType::Plain(I32),
        "uint" | "unsigned int" | "uint32" | "uint32_t" => StoredType::Plain(U32),
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => StoredType::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => StoredType::U64,
        "float" => StoredType::Plain(F32),
        "double" => StoredType::Plain(F64),
        _ => {
            return Err(field.unsupported(
                format!("the type '{}'", clip(field.value)),
                "write an integer type of 8 to 64 bits, float or double",
            ));
        }
    })
}

fn encoding(field: &Field) -> Result<Encoding, VolumeError> {
    match field.value.to_lowercase().as_str() {
        "raw" => Ok(Encoding::Raw),
        "gzip" | "gz" => Ok(Encoding::Gzip),
        "ascii" | "text" | "txt" => Ok(Encoding::Text),
        "hex" => Ok(Encoding::Hex),
        _ => Err(field.unsupported(format!("the encoding '{}'", clip(field.value)), "write it as raw, gzip or ascii")),
    }
}

fn byte_skip(header: &Header, place: &Place, encoding: Encoding) -> Result<Skip, VolumeError> {
    let Some(field) = header.find("byte skip", place) else { return Ok(Skip::Bytes(0)) };
    let remedy = "give how many bytes to skip, or -1 with the encoding raw for the file's last bytes";
    let skip: i64 = field.number(remedy)?;
    match skip {
        -1 if encoding == Encoding::Raw => Ok(Skip::ToEnd),
        0.. => Ok(Skip::Bytes(skip as u64)),
        _ => Err(field.wrong(format!("cannot skip {skip} bytes"), remedy)),
    }
}
