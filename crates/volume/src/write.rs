//! Writing volumes: to a new file beside the old one, which is replaced only when all is written.
//!
//! Each format has a file for its header; what a format cannot keep is said in remarks.

mod metaimage;
mod nifti1;
mod nrrd;

use cube3_file::WholeFile;
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};

use crate::place::Place;
use crate::samples::swap_bytes;
use crate::{AxisOrder, Endian, Space, Volume, VolumeError, World};

/// How voxels are written where the format leaves a choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Packing {
    /// Compressed.
    #[default]
    Compressed,
    /// As they are.
    Plain,
}

/// A format by the end of a file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Nrrd,
    Nifti { compressed: bool },
    MetaImage,
    Raw,
}

impl Target {
    fn of_path(path: &Path) -> Result<Self, VolumeError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let ends = |end: &str| name.ends_with(end);
        let refused = |what: &str, remedy: &str| Err(Place::of_path(path).unsupported("file name", what, remedy));
        match () {
            _ if ends(".nrrd") => Ok(Target::Nrrd),
            _ if ends(".nii") => Ok(Target::Nifti { compressed: false }),
            _ if ends(".nii.gz") => Ok(Target::Nifti { compressed: true }),
            _ if ends(".mha") => Ok(Target::MetaImage),
            _ if ends(".raw") => Ok(Target::Raw),
            _ if ends(".nhdr") => refused("writing a header beside its voxels", "give a name that ends in .nrrd"),
            _ if ends(".mhd") => refused("writing a header beside its voxels", "give a name that ends in .mha"),
            _ if ends(".hdr") || ends(".img") => {
                refused("writing a header beside its voxels", "give a name that ends in .nii or .nii.gz")
            }
            _ => refused("writing this format", "give a name that ends in .nrrd, .nii, .nii.gz, .mha or .raw"),
        }
    }
}

/// Whether [`write()`] knows the format that a file's name stands for, before there is anything to write.
///
/// # Errors
///
/// [`VolumeError::Unsupported`] with a name that it knows.
pub fn check_name(path: impl AsRef<Path>) -> Result<(), VolumeError> {
    Target::of_path(path.as_ref()).map(|_| ())
}

/// Writes a volume in the format that the file's name stands for: `.nrrd`, `.nii`, `.nii.gz`, `.mha`, compressed where the
/// format can be, or `.raw` (numbers alone). Numbers are little-endian.
///
/// Gives a remark for each thing of the volume's place in the world that the format cannot keep.
///
/// # Errors
///
/// [`VolumeError::Unsupported`] for another name and for a grid that the format cannot hold, [`VolumeError::Io`] from the system.
/// On any error a file that was there before is as it was.
pub fn write(path: impl AsRef<Path>, volume: &Volume) -> Result<Vec<String>, VolumeError> {
    write_packed(path, volume, Packing::Compressed)
}

/// As [`write()`], with a choice for `.nrrd` and `.mha`; `.nii` and `.raw` are never compressed, `.nii.gz` is always.
///
/// # Errors
///
/// As [`write()`], and [`VolumeError::Unsupported`] for a plain `.nii.gz`.
pub fn write_packed(path: impl AsRef<Path>, volume: &Volume, packing: Packing) -> Result<Vec<String>, VolumeError> {
    let path = path.as_ref();
    let place = Place::of_path(path);
    match Target::of_path(path)? {
        Target::Nrrd => {
            replace(path, |out| {
                out.write_all(nrrd::header(volume, packing).as_bytes())?;
                match packing {
                    Packing::Plain => write_numbers(out, volume, Endian::Little),
                    Packing::Compressed => gzip(out, &[], volume),
                }
            })?;
            Ok(Vec::new())
        }
        Target::Nifti { compressed: true } if packing == Packing::Plain => {
            Err(place.unsupported("file name", "a .nii.gz without compression", "give a name that ends in .nii"))
        }
        Target::Nifti { compressed } => {
            let header = nifti1::header(volume, &place)?;
            replace(path, |out| {
                if compressed {
                    return gzip(out, &header, volume);
                }
                out.write_all(&header)?;
                write_numbers(out, volume, Endian::Little)
            })?;
            Ok(nifti1::remarks(volume))
        }
        Target::MetaImage => {
            replace(path, |out| match packing {
                Packing::Plain => {
                    out.write_all(metaimage::header(volume, None).as_bytes())?;
                    write_numbers(out, volume, Endian::Little)
                }
                // The header has the compressed length, which is known when all is packed.
                Packing::Compressed => {
                    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
                    write_numbers(&mut packed, volume, Endian::Little)?;
                    let packed = packed.finish()?;
                    out.write_all(metaimage::header(volume, Some(packed.len())).as_bytes())?;
                    out.write_all(&packed)
                }
            })?;
            Ok(metaimage::remarks(volume))
        }
        Target::Raw => {
            write_raw(path, volume, Endian::Little)?;
            let turned =
                volume.world.space != Space::Unknown && !AxisOrder::closest(volume.world.directions).is_stored();
            let remark = "keeps no directions: it would be drawn as stored";
            Ok(turned.then(|| format!("{} {remark}", path.display())).into_iter().collect())
        }
    }
}

/// Writes the numbers alone.
///
/// # Errors
///
/// [`VolumeError::Io`], as [`write()`].
pub fn write_raw(path: impl AsRef<Path>, volume: &Volume, endian: Endian) -> Result<(), VolumeError> {
    replace(path.as_ref(), |out| write_numbers(out, volume, endian))
}

/// Fills a new file beside the old one, and puts it into its place once it is whole.
fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<(), VolumeError> {
    let failed = |e| Place::of_path(path).io("write", e);
    let mut file = WholeFile::new(path).map_err(failed)?;
    fill(&mut file).map_err(failed)?;
    file.keep().map_err(failed)
}

/// Bytes and the numbers behind them, as one gzip stream.
fn gzip(out: &mut dyn Write, before: &[u8], volume: &Volume) -> std::io::Result<()> {
    let mut packed = GzEncoder::new(out, Compression::default());
    packed.write_all(before)?;
    write_numbers(&mut packed, volume, Endian::Little)?;
    packed.finish().map(|_| ())
}

fn write_numbers(out: &mut (impl Write + ?Sized), volume: &Volume, endian: Endian) -> std::io::Result<()> {
    let numbers = volume.samples.bytes();
    if (endian == Endian::Big) == cfg!(target_endian = "big") {
        return out.write_all(numbers);
    }
    let mut turned = Vec::new();
    for chunk in numbers.chunks(1 << 16) {
        turned.clear();
        turned.extend_from_slice(chunk);
        swap_bytes(&mut turned, volume.sample_type().bytes());
        out.write_all(&turned)?;
    }
    Ok(())
}

/// Whether the grid's axes are the world's, to the bit.
fn is_identity(world: &World) -> bool {
    world.directions == World::default().directions
}
