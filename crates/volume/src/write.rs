//! Writing volumes: to a new file beside the old one, which is replaced only when all is written.

use std::io::{BufWriter, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use tempfile::{Builder, NamedTempFile};

use crate::place::Place;
use crate::samples::Stored;
use crate::{Endian, Format, SampleType, Volume, VolumeError, with_samples};

/// How an NRRD's voxels are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NrrdEncoding {
    /// As they are.
    Raw,
    /// Compressed.
    #[default]
    Gzip,
}

/// Writes a volume in the format that the file's name stands for: `.nrrd` (compressed) or `.raw`
/// (little-endian numbers alone, the dimensions are not kept).
///
/// # Errors
///
/// [`VolumeError::Unsupported`] for another format, [`VolumeError::Io`] from the system. On any error
/// a file that was there before is as it was.
pub fn write(path: impl AsRef<Path>, volume: &Volume) -> Result<(), VolumeError> {
    let path = path.as_ref();
    let name = path.to_string_lossy().to_lowercase();
    match Format::of_path(path) {
        Some(Format::Nrrd) if name.ends_with(".nrrd") => write_nrrd(path, volume, NrrdEncoding::Gzip),
        Some(Format::Raw) => write_raw(path, volume, Endian::Little),
        _ => Err(Place::of_path(path).unsupported(
            "file name",
            "writing this format",
            "give a name that ends in .nrrd or .raw",
        )),
    }
}

/// Writes a volume as an NRRD0005 with an attached header; numbers are little-endian.
///
/// # Errors
///
/// As [`write()`].
pub fn write_nrrd(path: impl AsRef<Path>, volume: &Volume, encoding: NrrdEncoding) -> Result<(), VolumeError> {
    replace(path.as_ref(), |out| {
        out.write_all(nrrd_header(volume, encoding).as_bytes())?;
        match encoding {
            NrrdEncoding::Raw => write_numbers(out, volume, Endian::Little),
            NrrdEncoding::Gzip => {
                let mut packed = GzEncoder::new(out, Compression::default());
                write_numbers(&mut packed, volume, Endian::Little)?;
                packed.finish().map(|_| ())
            }
        }
    })
}

/// Writes the numbers alone.
///
/// # Errors
///
/// As [`write()`].
pub fn write_raw(path: impl AsRef<Path>, volume: &Volume, endian: Endian) -> Result<(), VolumeError> {
    replace(path.as_ref(), |out| write_numbers(out, volume, endian))
}

/// Puts what `fill` writes at `path`, all or nothing.
fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<(), VolumeError> {
    let place = Place::of_path(path);
    let failed = |e| place.io("write", e);
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let file = beside(folder).map_err(failed)?;
    let mut out = BufWriter::with_capacity(1 << 18, file);
    fill(&mut out).map_err(failed)?;
    let file = out.into_inner().map_err(|e| failed(e.into_error()))?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|e| failed(e.error))?;
    Ok(())
}

/// A new file in `folder`, gone again unless it is persisted, with the permissions of any new file.
fn beside(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".cube3-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn nrrd_header(volume: &Volume, encoding: NrrdEncoding) -> String {
    let [nx, ny, nz] = volume.dims;
    let [sx, sy, sz] = volume.spacing;
    let [ox, oy, oz] = volume.origin;
    let sample_type = match volume.sample_type() {
        SampleType::U8 => "uint8",
        SampleType::I8 => "int8",
        SampleType::U16 => "uint16",
        SampleType::I16 => "int16",
        SampleType::U32 => "uint32",
        SampleType::I32 => "int32",
        SampleType::F32 => "float",
        SampleType::F64 => "double",
    };
    let encoding = match encoding {
        NrrdEncoding::Raw => "raw",
        NrrdEncoding::Gzip => "gzip",
    };
    // "{}" writes the shortest decimal that reads back as the same number.
    format!(
        "NRRD0005\ntype: {sample_type}\ndimension: 3\nspace dimension: 3\nsizes: {nx} {ny} {nz}\n\
         space directions: ({sx},0,0) (0,{sy},0) (0,0,{sz})\nspace origin: ({ox},{oy},{oz})\n\
         kinds: domain domain domain\nendian: little\nencoding: {encoding}\n\n"
    )
}

fn write_numbers(out: &mut (impl Write + ?Sized), volume: &Volume, endian: Endian) -> std::io::Result<()> {
    fn numbers<T: Stored>(out: &mut (impl Write + ?Sized), samples: &[T], endian: Endian) -> std::io::Result<()> {
        if (endian == Endian::Big) == cfg!(target_endian = "big") {
            return out.write_all(bytemuck::cast_slice(samples));
        }
        let mut turned = Vec::new();
        for chunk in samples.chunks(1 << 16) {
            turned.clear();
            turned.extend(chunk.iter().map(|n| n.swapped()));
            out.write_all(bytemuck::cast_slice(&turned))?;
        }
        Ok(())
    }
    with_samples!(&volume.samples, v => numbers(out, v, endian))
}
