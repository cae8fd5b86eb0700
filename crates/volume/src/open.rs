//! Reading a volume of any known format.

use std::io::Cursor;
use std::path::Path;

use crate::place::{Place, Source, open};
use crate::stream::read_full;
use crate::{Format, ReadOptions, Volume, VolumeError, metaimage, nifti1, nrrd, raw};

/// Reads a volume from a file. The format is the one that the file's name stands for, or, where the
/// name says nothing, the one that its first bytes stand for, or raw where a layout is given.
///
/// # Errors
///
/// Any [`VolumeError`] but those of writing; the message names file, place, reason and remedy.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Volume, VolumeError> {
    let path = path.as_ref();
    let place = Place::of_path(path);
    let mut source = open(path)?;
    let format = match Format::of_path(path) {
        Some(format) => format,
        None => sniff(&mut source, options, &place)?,
    };
    read_source(&mut source, format, options, &place)
}

/// Reads a volume from bytes in memory that hold header and voxels; `name` stands in messages.
///
/// # Errors
///
/// As [`read`]; a header whose voxels are in another file is refused.
pub fn read_bytes(
    bytes: &[u8],
    format: Option<Format>,
    name: &str,
    options: &ReadOptions,
) -> Result<Volume, VolumeError> {
    let place = Place::of_bytes(name);
    let mut source = Cursor::new(bytes);
    let format = match format {
        Some(format) => format,
        None => sniff(&mut source, options, &place)?,
    };
    read_source(&mut source, format, options, &place)
}

fn sniff(source: &mut dyn Source, options: &ReadOptions, place: &Place) -> Result<Format, VolumeError> {
    let mut head = [0; 512];
    let length = read_full(source, &mut head).map_err(|e| place.io("read", e))?;
    source.rewind().map_err(|e| place.io("read", e))?;
    Format::of_content(&head[..length])
        .or(options.raw.is_some().then_some(Format::Raw))
        .ok_or_else(|| VolumeError::UnknownFormat { file: place.file.clone() })
}

fn read_source(
    source: &mut dyn Source,
    format: Format,
    options: &ReadOptions,
    place: &Place,
) -> Result<Volume, VolumeError> {
    match format {
        Format::Nrrd => nrrd::read(source, options, place),
        Format::Nifti => nifti1::read(source, options, place),
        Format::MetaImage => metaimage::read(source, options, place),
        Format::Raw => raw::read(source, options, place),
    }
}
