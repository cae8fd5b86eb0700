//! Reading a volume of any known format.

use std::io::BufRead;
use std::path::Path;

use crate::described::Described;
use crate::place::{Place, is_gz, open};
use crate::source::Source;
use crate::{FileFormat, FileInfo, ReadOptions, Volume, VolumeError, metaimage, nifti, nrrd, raw};

/// Reads a volume from a file. The format is the one that the file's name stands for, or, where the name says nothing, the one
/// that its first bytes stand for, or raw where a layout is given. A file that is gzipped as a whole is unpacked.
///
/// # Errors
///
/// Any [`VolumeError`] but those of writing; the message names file, place, reason and remedy.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Volume, VolumeError> {
    let (_, described, place) = open_path(path.as_ref(), options)?;
    described.read(options, &place)
}

/// What a file holds, without reading its voxels.
///
/// # Errors
///
/// As [`read`], but for those of the voxels.
pub fn inspect(path: impl AsRef<Path>, options: &ReadOptions) -> Result<FileInfo, VolumeError> {
    let (format, described, place) = open_path(path.as_ref(), options)?;
    described.info(format, options, &place)
}

/// Reads a volume from bytes in memory that hold header and voxels; `name` stands in messages.
///
/// # Errors
///
/// As [`read`]; a header whose voxels are in another file is refused.
pub fn read_bytes(
    bytes: &[u8],
    format: Option<FileFormat>,
    name: &str,
    options: &ReadOptions,
) -> Result<Volume, VolumeError> {
    let place = Place::of_bytes(name);
    let source = |unpack| Source::of_bytes(bytes, unpack).map_err(|e| place.io("read", e));
    let format = match format {
        Some(format) => format,
        None => sniff(&mut source(true)?, options, &place)?,
    };
    let unpack = format != FileFormat::Raw || name.ends_with(".gz");
    describe(source(unpack)?, format, options, &place)?.read(options, &place)
}

fn open_path(path: &Path, options: &ReadOptions) -> Result<(FileFormat, Described<'static>, Place), VolumeError> {
    let format = match FileFormat::of_path(path) {
        Some(format) => format,
        None => {
            let (mut source, place) = open(path, true)?;
            sniff(&mut source, options, &place)?
        }
    };
    let path = match format {
        FileFormat::Nifti => nifti::header_path(path)?,
        _ => path.to_owned(),
    };
    // Raw numbers may begin as a gzip stream does.
    let (source, place) = open(&path, format != FileFormat::Raw || is_gz(&path))?;
    let described = describe(source, format, options, &place)?;
    Ok((format, described, place))
}

fn sniff(source: &mut Source, options: &ReadOptions, place: &Place) -> Result<FileFormat, VolumeError> {
    let head = source.fill_buf().map_err(|e| place.io("read", e))?;
    FileFormat::of_content(head)
        .or(options.raw.is_some().then_some(FileFormat::Raw))
        .ok_or_else(|| VolumeError::UnknownFormat { file: place.file.clone() })
}

fn describe<'a>(
    source: Source<'a>,
    format: FileFormat,
    options: &ReadOptions,
    place: &Place,
) -> Result<Described<'a>, VolumeError> {
    match format {
        FileFormat::Nrrd => nrrd::describe(source, place),
        FileFormat::Nifti => nifti::describe(source, place),
        FileFormat::MetaImage => metaimage::describe(source, place),
        FileFormat::Raw => raw::describe(source, options, place),
    }
}
