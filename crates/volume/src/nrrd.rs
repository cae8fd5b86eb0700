//! NRRD ("nearly raw raster data"), versions 1 to 5.
//!
//! <https://teem.sourceforge.net/nrrd/format.html>. Header and voxels in one file, or the header
//! alone with the name of a data file; encodings raw, gzip and ascii. Spacing is the length of each
//! axis's direction; the directions themselves are not kept, so the grid stays as it is stored. A
//! fourth axis is a series of volumes.

use std::io::BufRead;

use crate::place::{Place, Source};
use crate::stream::{Encoding, Layout, Skip, StoredType};
use crate::text::{Field, HeaderLines, clip};
use crate::volume::check_grid;
use crate::{ReadOptions, SampleType, Volume, VolumeError};

/// The fields that matter here, as text with their line numbers.
#[derive(Default)]
struct Header {
    fields: Vec<(&'static str, usize, String)>,
    lines: usize,
}

/// Each field's names: the first is the format's, the others are its synonyms.
const FIELDS: [&[&str]; 12] = [
    &["dimension"],
    &["type"],
    &["encoding"],
    &["endian"],
    &["sizes"],
    &["spacings"],
    &["space directions"],
    &["space origin"],
    &["line skip", "lineskip"],
    &["byte skip", "byteskip"],
    &["data file", "datafile"],
    &["kinds"],
];

impl Header {
    fn parse(source: &mut dyn Source, place: &Place) -> Result<Header, VolumeError> {
        let mut lines = HeaderLines::new(source, place);
        let magic = lines.next()?.unwrap_or_default();
        let version = magic.strip_prefix("NRRD000").and_then(|v| v.trim_end().parse::<u32>().ok());
        match version {
            Some(1..=5) => {}
            Some(v) => {
                let what = format!("NRRD version {v}");
                return Err(place.unsupported("line 1", what, "write it as NRRD0005 or older"));
            }
            None => {
                let reason = format!("'{}' is not an NRRD's first line", clip(&magic));
                return Err(place.wrong("line 1", reason, "it must be NRRD0001 to NRRD0005"));
            }
        }
        let mut header = Header::default();
        while let Some(line) = lines.next()? {
            if line.is_empty() {
                break;
            }
            if line.starts_with('#') {
                continue;
            }
            // "field: value" or "key:=value"; whichever separator comes first decides.
            let (field, value) = match line.split_once(':') {
                Some((_, value)) if value.starts_with('=') => continue,
                Some((field, value)) => (field.trim().to_lowercase(), value.trim()),
                None => {
                    return Err(place.wrong(
                        format!("line {}", lines.line),
                        format!("'{}' is no field", clip(&line)),
                        "a header line is 'field: value', 'key:=value' or '# comment', and an \
                         empty line ends the header",
                    ));
                }
            };
            let Some(names) = FIELDS.iter().find(|names| names.contains(&field.as_str())) else {
                continue;
            };
            if let Some((name, first, _)) = header.fields.iter().find(|f| f.0 == names[0]) {
                return Err(place.wrong(
                    format!("line {}, '{name}'", lines.line),
                    format!("the field stands on line {first} already"),
                    "give each field once",
                ));
            }
            header.fields.push((names[0], lines.line, value.to_owned()));
        }
        header.lines = lines.line;
        Ok(header)
    }

    fn find<'a>(&'a self, name: &str, place: &'a Place) -> Option<Field<'a>> {
        let (name, line, value) = self.fields.iter().find(|f| f.0 == name)?;
        Some(Field { place, name, line: *line, value })
    }

    fn need<'a>(&'a self, name: &str, place: &'a Place) -> Result<Field<'a>, VolumeError> {
        self.find(name, place).ok_or_else(|| {
            place.wrong(
                format!("header, lines 1 to {}", self.lines),
                format!("the field '{name}' is missing"),
                format!("add a line '{name}: …'"),
            )
        })
    }
}

/// Reads an NRRD from its first byte.
pub(crate) fn read(source: &mut dyn Source, options: &ReadOptions, place: &Place) -> Result<Volume, VolumeError> {
    let header = Header::parse(source, place)?;
    let axes = header.need("dimension", place)?;
    let count: usize = axes.number("give the number of axes")?;
    if !(1..=4).contains(&count) {
        return Err(axes.unsupported(
            format!("a grid of {count} axes"),
            "give a volume of 1 to 3 axes, or a series of volumes with 4",
        ));
    }
    let sizes_field = header.need("sizes", place)?;
    let sizes = sizes_field.sizes(count)?;
    check_kinds(&header, place, &sizes)?;
    let dims = [0, 1, 2].map(|a| sizes.get(a).copied().unwrap_or(1));
    let frames = sizes.get(3).copied().unwrap_or(1) as u64;
    let spacing = spacing(&header, place, count)?;
    let origin = origin(&header, place)?;
    check_grid(dims, spacing, origin).map_err(|e| place.grid(e))?;

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
    let line_skip: u64 = match header.find("line skip", place) {
        Some(field) => field.number("give how many lines to skip, at least 0")?,
        None => 0,
    };
    let skip = byte_skip(&header, place, encoding)?;
    let layout = Layout { dims, stored, big_endian, encoding, skip, frames, scale: None };

    let samples = match header.find("data file", place) {
        None => {
            skip_lines(source, line_skip, place)?;
            layout.read(source, options, place)?
        }
        Some(field) => {
            check_data_file(&field)?;
            let (mut data, data_place) = place.open_beside(field.value)?;
            skip_lines(&mut data, line_skip, &data_place)?;
            layout.read(&mut data, options, &data_place)?
        }
    };
    Volume::new(dims, spacing, samples)?.with_origin(origin)
}

/// Refuses axes that hold the components of one voxel, such as colours: the first axis of such a
/// file is no axis of the grid.
fn check_kinds(header: &Header, place: &Place, sizes: &[usize]) -> Result<(), VolumeError> {
    let Some(field) = header.find("kinds", place) else { return Ok(()) };
    let grid = ["domain", "space", "none", "???", "list", "time"];
    for (axis, kind) in field.value.split_whitespace().enumerate() {
        let last_of_four = axis == 3;
        let component = !grid.contains(&kind.to_lowercase().as_str());
        let series_first = axis < 3 && matches!(kind.to_lowercase().as_str(), "list" | "time");
        let several = sizes.get(axis).is_some_and(|&s| s > 1);
        if (component && several) || (series_first && several && !last_of_four && sizes.len() == 4) {
            return Err(field.unsupported(
                format!("axis {axis} of kind '{}'", clip(kind)),
                "store one number for each voxel, with the grid's axes first",
            ));
        }
    }
    Ok(())
}

fn spacing(header: &Header, place: &Place, count: usize) -> Result<[f64; 3], VolumeError> {
    let mut spacing = [1.0; 3];
    if let Some(field) = header.find("space directions", place) {
        let mut rest = field.value.trim();
        for axis in 0..count {
            if let Some(after) = rest.strip_prefix("none") {
                if axis < 3 && count == 4 {
                    return Err(field.unsupported(
                        format!("a series along axis {axis}"),
                        "store the volumes one after another, with the series as axis 3",
                    ));
                }
                rest = after.trim_start();
                continue;
            }
            let (vector, after) = field.vector(rest)?;
            if let Some(s) = spacing.get_mut(axis) {
                *s = vector.iter().fold(0.0, |length: f64, &c| length.hypot(c));
            }
            rest = after.trim_start();
        }
        if !rest.is_empty() {
            return Err(field.wrong(format!("more than {count} vectors"), "give one vector, or 'none', for each axis"));
        }
    } else if let Some(field) = header.find("spacings", place) {
        let remedy = "give one number for each axis";
        let numbers: Vec<f64> = field.numbers(Some(count), remedy)?;
        for (s, n) in spacing.iter_mut().zip(numbers) {
            *s = n;
        }
    }
    Ok(spacing)
}

fn origin(header: &Header, place: &Place) -> Result<[f64; 3], VolumeError> {
    let mut origin = [0.0; 3];
    if let Some(field) = header.find("space origin", place) {
        let (vector, _) = field.vector(field.value)?;
        for (o, v) in origin.iter_mut().zip(vector) {
            *o = v;
        }
    }
    Ok(origin)
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

/// Refuses voxels that lie in several files.
fn check_data_file(field: &Field) -> Result<(), VolumeError> {
    let mut words = field.value.split_whitespace();
    let first = words.next().unwrap_or_default();
    let pattern = first.contains('%') && words.clone().count() >= 3;
    let list = first == "LIST" && words.all(|w| w.parse::<u32>().is_ok());
    if list || pattern {
        return Err(
            field.unsupported("a volume in several data files", "join them to one file, such as with 'unu save'")
        );
    }
    if first.is_empty() {
        return Err(field.wrong("no name", "give the data file's name"));
    }
    Ok(())
}

fn skip_lines(source: &mut dyn Source, lines: u64, place: &Place) -> Result<(), VolumeError> {
    for passed in 0..lines {
        if !skip_line(source).map_err(|e| place.io("read", e))? {
            return Err(VolumeError::Truncated {
                file: place.file.clone(),
                promised: lines,
                found: passed,
                unit: "lines to skip",
            });
        }
    }
    Ok(())
}

/// Passes over one line; false at the end of the file.
fn skip_line(source: &mut dyn BufRead) -> std::io::Result<bool> {
    let mut any = false;
    loop {
        let bytes = source.fill_buf()?;
        if bytes.is_empty() {
            return Ok(any);
        }
        any = true;
        let end = bytes.iter().position(|&b| b == b'\n');
        let used = end.map_or(bytes.len(), |e| e + 1);
        source.consume(used);
        if end.is_some() {
            return Ok(true);
        }
    }
}
