//! MetaImage, the format of ITK: `.mha` with the voxels behind the header, `.mhd` with a data file.
//!
//! <https://itk.org/Wiki/ITK/MetaIO/Documentation>. Spacing is `ElementSpacing`; the directions of the
//! axes are not kept. A fourth axis is a series of volumes.

use crate::place::{Place, Source};
use crate::stream::{Encoding, Layout, Skip, StoredType};
use crate::text::{Field, HeaderLines, clip};
use crate::volume::check_grid;
use crate::{ReadOptions, SampleType, Volume, VolumeError};

/// Each key's names: the first is the usual one, the others are synonyms.
const KEYS: [&[&str]; 13] = [
    &["ObjectType"],
    &["NDims"],
    &["DimSize"],
    &["ElementType"],
    &["ElementSpacing"],
    &["ElementSize"],
    &["Offset", "Position", "Origin"],
    &["BinaryData"],
    &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"],
    &["CompressedData"],
    &["ElementNumberOfChannels"],
    &["HeaderSize"],
    &["ElementDataFile"],
];

struct Header {
    keys: Vec<(&'static str, usize, String)>,
    lines: usize,
}

impl Header {
    /// Reads up to and with `ElementDataFile`, the last line of the header.
    fn parse(source: &mut dyn Source, place: &Place) -> Result<Header, VolumeError> {
        let mut lines = HeaderLines::new(source, place);
        let mut header = Header { keys: Vec::new(), lines: 0 };
        while let Some(line) = lines.next()? {
            if line.trim().is_empty() {
                continue;
            }
            let Some((key, value)) = line.split_once('=') else {
                return Err(place.wrong(
                    format!("line {}", lines.line),
                    format!("'{}' is no entry", clip(&line)),
                    "a header line is 'Key = value', the last one 'ElementDataFile = …'",
                ));
            };
            let Some(names) = KEYS.iter().find(|names| names.contains(&key.trim())) else {
                continue;
            };
            if header.keys.iter().all(|k| k.0 != names[0]) {
                header.keys.push((names[0], lines.line, value.trim().to_owned()));
            }
            if names[0] == "ElementDataFile" {
                break;
            }
        }
        header.lines = lines.line;
        Ok(header)
    }

    fn find<'a>(&'a self, name: &str, place: &'a Place) -> Option<Field<'a>> {
        let (name, line, value) = self.keys.iter().find(|k| k.0 == name)?;
        Some(Field { place, name, line: *line, value })
    }

    fn need<'a>(&'a self, name: &str, place: &'a Place) -> Result<Field<'a>, VolumeError> {
        self.find(name, place).ok_or_else(|| {
            place.wrong(
                format!("header, lines 1 to {}", self.lines),
                format!("the key '{name}' is missing"),
                format!("add a line '{name} = …' before 'ElementDataFile'"),
            )
        })
    }

    fn flag(&self, name: &str, default: bool, place: &Place) -> Result<bool, VolumeError> {
        let Some(field) = self.find(name, place) else { return Ok(default) };
        match field.value.to_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            other => Err(field.wrong(format!("'{}' is no flag", clip(other)), "write True or False")),
        }
    }
}

/// Reads a MetaImage from its first byte.
pub(crate) fn read(source: &mut dyn Source, options: &ReadOptions, place: &Place) -> Result<Volume, VolumeError> {
    let header = Header::parse(source, place)?;
    if let Some(field) = header.find("ObjectType", place)
        && !field.value.eq_ignore_ascii_case("image")
    {
        return Err(field.unsupported(format!("a '{}'", clip(field.value)), "give an image"));
    }
    let axes = header.need("NDims", place)?;
    let count: usize = axes.number("give the number of axes")?;
    if !(1..=4).contains(&count) {
        return Err(axes.unsupported(
            format!("a grid of {count} axes"),
            "give a volume of 1 to 3 axes, or a series of volumes with 4",
        ));
    }
    let sizes = header.need("DimSize", place)?.sizes(count)?;
    let dims = [0, 1, 2].map(|a| sizes.get(a).copied().unwrap_or(1));
    let frames = sizes.get(3).copied().unwrap_or(1) as u64;
    if let Some(field) = header.find("ElementNumberOfChannels", place) {
        let channels: u64 = field.number("give the numbers of a voxel")?;
        if channels != 1 {
            return Err(
                field.unsupported(format!("{channels} numbers for each voxel"), "store one number for each voxel")
            );
        }
    }
    let spacing_field = header.find("ElementSpacing", place).or(header.find("ElementSize", place));
    let spacing = numbers(spacing_field, count, 1.0)?;
    let origin = numbers(header.find("Offset", place), count, 0.0)?;
    check_grid(dims, spacing, origin).map_err(|e| place.grid(e))?;

    let data_file = header.need("ElementDataFile", place)?;
    let local = data_file.value.eq_ignore_ascii_case("local");
    check_data_file(&data_file)?;
    let mut beside = if local { None } else { Some(place.open_beside(data_file.value)?) };
    let (data, data_place): (&mut dyn Source, &Place) = match &mut beside {
        Some((file, data_place)) => (file, data_place),
        None => (source, place),
    };
    let layout = Layout {
        dims,
        stored: stored_type(&header.need("ElementType", place)?)?,
        big_endian: header.flag("BinaryDataByteOrderMSB", false, place)?,
        encoding: encoding(&header, data, place)?,
        skip: skip(&header, place)?,
        frames,
        scale: None,
    };
    let samples = layout.read(data, options, data_place)?;
    Volume::new(dims, spacing, samples)?.with_origin(origin)
}

/// The first three of the numbers that a key gives, one for each axis.
fn numbers(field: Option<Field>, count: usize, default: f64) -> Result<[f64; 3], VolumeError> {
    let mut first = [default; 3];
    if let Some(field) = field {
        let numbers: Vec<f64> = field.numbers(Some(count), "give one number for each axis")?;
        for (f, n) in first.iter_mut().zip(numbers) {
            *f = n;
        }
    }
    Ok(first)
}

/// Refuses voxels that lie in several files.
fn check_data_file(field: &Field) -> Result<(), VolumeError> {
    let first = field.value.split_whitespace().next().unwrap_or_default();
    if first.is_empty() {
        return Err(field.wrong("no name", "give LOCAL or the data file's name"));
    }
    if first == "LIST" || first.contains('%') {
        return Err(field.unsupported("a volume in several data files", "join them to one file"));
    }
    Ok(())
}

fn stored_type(field: &Field) -> Result<StoredType, VolumeError> {
    use SampleType::*;
    Ok(match field.value {
        "MET_CHAR" => StoredType::Plain(I8),
        "MET_UCHAR" => StoredType::Plain(U8),
        "MET_SHORT" => StoredType::Plain(I16),
        "MET_USHORT" => StoredType::Plain(U16),
        // MetaIO's "long" has four bytes on every system.
        "MET_INT" | "MET_LONG" => StoredType::Plain(I32),
        "MET_UINT" | "MET_ULONG" => StoredType::Plain(U32),
        "MET_LONG_LONG" => StoredType::I64,
        "MET_ULONG_LONG" => StoredType::U64,
        "MET_FLOAT" => StoredType::Plain(F32),
        "MET_DOUBLE" => StoredType::Plain(F64),
        other => {
            return Err(
                field.unsupported(format!("the type '{}'", clip(other)), "write MET_UCHAR, MET_SHORT, … MET_DOUBLE")
            );
        }
    })
}

/// How the voxels are written. Compressed voxels are zlib, or gzip where the data say so.
fn encoding(header: &Header, data: &mut dyn Source, place: &Place) -> Result<Encoding, VolumeError> {
    let compressed = header.flag("CompressedData", false, place)?;
    if !header.flag("BinaryData", true, place)? {
        return Ok(Encoding::Text);
    }
    if !compressed {
        return Ok(Encoding::Raw);
    }
    let head = data.fill_buf().map_err(|e| place.io("read", e))?;
    Ok(if head.starts_with(&[0x1f, 0x8b]) { Encoding::Gzip } else { Encoding::Zlib })
}

fn skip(header: &Header, place: &Place) -> Result<Skip, VolumeError> {
    let Some(field) = header.find("HeaderSize", place) else { return Ok(Skip::Bytes(0)) };
    let remedy = "give the bytes before the voxels, or -1 for the file's last bytes";
    let size: i64 = field.number(remedy)?;
    let compressed = header.flag("CompressedData", false, place)?;
    match size {
        0 => Ok(Skip::Bytes(0)),
        -1 if !compressed => Ok(Skip::ToEnd),
        1.. if !compressed => Ok(Skip::Bytes(size as u64)),
        _ => Err(field.wrong(format!("a header of {size} bytes"), remedy)),
    }
}
