//! The fields of an NRRD's header.

use crate::VolumeError;
use crate::files::listed;
use crate::place::Place;
use crate::source::Source;
use crate::text::{Field, HeaderLines, clip};

/// The fields that matter here, as text with their line numbers.
#[derive(Default)]
pub(crate) struct Header {
    fields: Vec<(&'static str, usize, String)>,
    lines: usize,
    /// The data files of a list.
    pub list: Vec<String>,
}

/// Each field's names: the first is the format's, the others are its synonyms.
const FIELDS: [&[&str]; 17] = [
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
    &["space"],
    &["space dimension"],
    &["axis mins", "axismins"],
    &["axis maxs", "axismaxs"],
    &["centers", "centerings"],
];

impl Header {
    pub fn parse(source: &mut Source, place: &Place) -> Result<Header, VolumeError> {
        let mut lines = HeaderLines::new(source, place);
        let magic = lines.next()?.unwrap_or_default();
        let version = match magic.trim_end() {
            "NRRD00.01" => Some(1),
            magic => magic.strip_prefix("NRRD000").and_then(|v| v.parse::<u32>().ok()),
        };
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
            // What follows a list are names.
            if names[0] == "data file" && value.split_whitespace().next() == Some("LIST") {
                header.lines = lines.line;
                header.list = listed(&mut lines)?;
                return Ok(header);
            }
        }
        header.lines = lines.line;
        Ok(header)
    }

    pub fn find<'a>(&'a self, name: &str, place: &'a Place) -> Option<Field<'a>> {
        let (name, line, value) = self.fields.iter().find(|f| f.0 == name)?;
        Some(Field { place, name, line: *line, value })
    }

    pub fn need<'a>(&'a self, name: &str, place: &'a Place) -> Result<Field<'a>, VolumeError> {
        self.find(name, place).ok_or_else(|| {
            place.wrong(
                format!("header, lines 1 to {}", self.lines),
                format!("the field '{name}' is missing"),
                format!("add a line '{name}: …'"),
            )
        })
    }
}
