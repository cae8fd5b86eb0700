//! Reading a volume of any known format.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use crate::parts::Data;
use crate::place::{Place, open};
use crate::source::Source;
use crate::stream::Layout;
use crate::volume::check_grid;
use crate::world::Placed;
use crate::{FileFormat, ReadOptions, SampleType, Volume, VolumeError, World, metaimage, nifti, nrrd, raw};

/// What a header says, all formats alike.
pub(crate) struct Described<'a> {
    pub layout: Layout,
    pub placed: Placed,
    pub data: Data<'a>,
    pub remarks: Vec<String>,
}

/// What a file holds, by its header alone.
#[derive(Clone, Debug, PartialEq)]
pub struct FileInfo {
    /// The file's format.
    pub format: FileFormat,
    /// Voxels along x, y and z of the grid.
    pub dims: [usize; 3],
    /// Voxels along the stored axes, fastest first.
    pub stored_dims: [usize; 3],
    /// Distance between voxel centres along x, y and z of the grid.
    pub spacing: [f64; 3],
    /// World position of voxel (0, 0, 0) of the grid.
    pub origin: [f64; 3],
    /// How the grid lies in the world.
    pub world: World,
    /// The type of the samples in memory.
    pub sample_type: SampleType,
    /// Volumes of a series, at least 1.
    pub volumes: usize,
    /// What the header left open, and what was taken.
    pub remarks: Vec<String>,
}

impl FileInfo {
    /// Bytes of one volume's samples in memory.
    pub fn bytes(&self) -> u64 {
        self.dims.iter().fold(self.sample_type.bytes() as u64, |p, &d| p.saturating_mul(d as u64))
    }
}

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

/// Whether a file's name says that it is gzipped as a whole.
pub(crate) fn is_gz(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"))
}

/// A path with the `.gz` at its end taken away, and the extension before it.
pub(crate) fn without_gz(path: &Path) -> PathBuf {
    if is_gz(path) { path.with_extension("") } else { path.to_owned() }
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

impl Described<'_> {
    fn info(self, format: FileFormat, options: &ReadOptions, place: &Place) -> Result<FileInfo, VolumeError> {
        let Described { layout, placed, remarks, .. } = self;
        check_grid(layout.dims, placed.spacing, placed.origin).map_err(|e| place.grid(e))?;
        let order = placed.order(options.ordering);
        let (spacing, origin, world) = placed.grid(layout.dims, order);
        Ok(FileInfo {
            format,
            dims: order.turn(layout.dims),
            stored_dims: layout.dims,
            spacing,
            origin,
            world,
            sample_type: layout.kept(),
            volumes: usize::try_from(layout.series.count()).unwrap_or(usize::MAX),
            remarks,
        })
    }

    fn read(self, options: &ReadOptions, place: &Place) -> Result<Volume, VolumeError> {
        let Described { layout, placed, data, .. } = self;
        check_grid(layout.dims, placed.spacing, placed.origin).map_err(|e| place.grid(e))?;
        let order = placed.order(options.ordering);
        let (spacing, origin, world) = placed.grid(layout.dims, order);
        let samples = layout.read(data, order, options, place)?;
        Volume::new(order.turn(layout.dims), spacing, samples)?.with_world(origin, world)
    }
}
