//! MetaImage, the format of ITK: `.mha` with the voxels behind the header, `.mhd` with a data file.
//!
//! <https://itk.org/Wiki/ITK/MetaIO/Documentation>. World coordinates run to the left, back and up; `TransformMatrix` has the
//! direction of the first axis, then of the second, then of the third. Where it is missing nothing is known: the document's
//! meaning of `AnatomicalOrientation` is the opposite of what its writers mean, and its readers pass over it. A fourth axis is a series of volumes.

use crate::described::Described;
use crate::files::{listed, several};
use crate::layout::{Encoding, Layout, Series, Skip, StoredType};
use crate::parts::Data;
use crate::place::Place;
use crate::source::Source;
use crate::text::{Field, HeaderLines, clip};
use crate::world::{Placed, Space};
use crate::{SampleType, VolumeError};

/// Each key's names: the first is the usual one, the others are synonyms.
const KEYS: [&[&str]; 14] = [
    &["ObjectType"],
    &["NDims"],
    &["DimSize"],
    &["ElementType"],
    &["ElementSpacing"],
    &["ElementSize"],
    &["Offset", "Position", "Origin"],
    &["TransformMatrix", "Rotation", "Orientation"],
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
    /// The data files of a list.
    list: Vec<String>,
}

impl Header {
    /// Reads up to and with `ElementDataFile`, the last line of the header.
    fn parse(source: &mut Source, place: &Place) -> Result<Header, VolumeError> {
        let mut lines = HeaderLines::new(source, place);
        let mut header = Header { keys: Vec::new(), lines: 0, list: Vec::new() };
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
                header.lines = lines.line;
                if value.split_whitespace().next() == Some("LIST") {
                    header.list = listed(&mut lines)?;
                }
                return Ok(header);
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

/// Reads the header from its first byte.
pub(crate) fn describe<'a>(mut source: Source<'a>, place: &Place) -> Result<Described<'a>, VolumeError> {
    let header = Header::parse(&mut source, place)?;
    if let Some(field) = header.find("ObjectType", place)
        && !field.value.eq_ignore_ascii_case("image")
    {
        return Err(field.unsupported(format!("a '{}'", clip(field.value)), "give an image"));
    }
    let axes = header.need("NDims", place)?;
    let count: usize = axes.number("give the number of axes")?;
    if !(1..=10).contains(&count) {
        return Err(axes.unsupported(format!("a grid of {count} axes"), "give a volume of 1 to 10 axes"));
    }
    let sizes = header.need("DimSize", place)?.sizes(count)?;
    if sizes.iter().skip(4).any(|&size| size > 1) {
        return Err(axes.unsupported(
            format!("a grid of {count} axes"),
            "give a volume of 1 to 3 axes, or a series of volumes with 4",
        ));
    }
    let dims = [0, 1, 2].map(|a| sizes.get(a).copied().unwrap_or(1));
    let volumes = sizes.get(3).copied().unwrap_or(1) as u64;
    if let Some(field) = header.find("ElementNumberOfChannels", place) {
        let channels: u64 = field.number("give the numbers of a voxel")?;
        if channels != 1 {
            let place_of = format!("line {}, 'ElementNumberOfChannels'", field.line);
            return Err(place.several(place_of, Some(channels), "vector or colour"));
        }
    }
    let mut remarks = Vec::new();
    let placed = placed(&header, dims, count, place, &mut remarks)?;
    let stored = stored_type(&header.need("ElementType", place)?, place)?;
    let data_file = header.need("ElementDataFile", place)?;
    if data_file.value.is_empty() {
        return Err(data_file.wrong("no name", "give LOCAL or the data file's name"));
    }
    let data = if data_file.value.eq_ignore_ascii_case("local") {
        Data::Here(source)
    } else {
        let files = match several(&data_file, &header.list, &sizes, place)? {
            Some(files) => files,
            None => vec![place.beside(data_file.value)?],
        };
        Data::Beside { files, unpack: false }
    };
    let layout = Layout {
        dims,
        stored,
        big_endian: header.flag("BinaryDataByteOrderMSB", false, place)?,
        encoding: encoding(&header, place)?,
        lines: 0,
        skip: skip(&header, place)?,
        series: Series::After(volumes),
        scale: None,
        last: false,
    };
    Ok(Described { layout, placed, data, remarks })
}

/// Where the grid lies: in ITK's world, or not known.
fn placed(
    header: &Header,
    dims: [usize; 3],
    count: usize,
    place: &Place,
    remarks: &mut Vec<String>,
) -> Result<Placed, VolumeError> {
    let spacing = header.find("ElementSpacing", place).or(header.find("ElementSize", place));
    let mut spacing = numbers(spacing, count, 1.0)?;
    for (axis, s) in spacing.iter_mut().enumerate() {
        if s.is_nan() || (*s == 0.0 && dims[axis] == 1) {
            remarks.push(format!("the spacing of axis {axis} is {s}: it is taken as 1"));
            *s = 1.0;
        }
    }
    let origin = numbers(header.find("Offset", place), count, 0.0)?;
    let Some(field) = header.find("TransformMatrix", place) else {
        return Ok(Placed::unknown(spacing, origin));
    };
    let matrix: Vec<f64> = field.numbers(None, "give one number for each pair of axes")?;
    if matrix.len() != count * count {
        let reason = format!("{} numbers for {count} axes", matrix.len());
        return Err(field.wrong(reason, "give one number for each pair of axes"));
    }
    // To the left and back, which is against the right and the front.
    let ras = |[x, y, z]: [f64; 3]| [-x, -y, z];
    let steps = [0, 1, 2].map(|axis| {
        let sign = 1f64.copysign(spacing[axis]);
        let row = [0, 1, 2].map(|c| if c < count && axis < count { sign * matrix[axis * count + c] } else { 0.0 });
        (axis < count).then(|| ras(row))
    });
    Placed::steps(Space::Patient, steps, spacing.map(f64::abs), ras(origin))
        .map_err(|reason| field.wrong(reason, "give the directions of the axes, one after another"))
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

fn stored_type(field: &Field, place: &Place) -> Result<StoredType, VolumeError> {
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
        other if other.ends_with("_ARRAY") || other.ends_with("_MATRIX") => {
            return Err(place.several(format!("line {}, 'ElementType'", field.line), None, &clip(other)));
        }
        other => {
            return Err(
                field.unsupported(format!("the type '{}'", clip(other)), "write MET_UCHAR, MET_SHORT, … MET_DOUBLE")
            );
        }
    })
}

/// How the voxels are written. Compressed voxels are zlib, or gzip where the data say so.
fn encoding(header: &Header, place: &Place) -> Result<Encoding, VolumeError> {
    Ok(match (header.flag("BinaryData", true, place)?, header.flag("CompressedData", false, place)?) {
        (false, _) => Encoding::Text,
        (true, false) => Encoding::Raw,
        (true, true) => Encoding::Zlib,
    })
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
