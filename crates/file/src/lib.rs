//! Files that appear whole or not at all.
//!
//! What is written goes into a file beside its place, is synced, and takes its place at once: a reader never sees half of it, and where something
//! fails the file that was there stays, and nothing else does.

#![warn(missing_docs)]

use std::fs::Permissions;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Bytes that are put together before they are written.
const BUFFER_BYTES: usize = 1 << 18;

/// Writes a file, whole or not at all.
///
/// # Errors
/// A path without a name, a folder that is not there or cannot be written, a full disk.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::new(path)?;
    file.write_all(bytes)?;
    file.keep()
}

/// A file that comes in pieces: it is in its place once it is kept, and nowhere before.
#[derive(Debug)]
pub struct WholeFile {
    path: PathBuf,
    part: BufWriter<NamedTempFile>,
}

impl WholeFile {
    /// An empty file beside its place.
    ///
    /// # Errors
    /// As [`write_whole`].
    pub fn new(path: &Path) -> io::Result<WholeFile> {
        if path.file_name().is_none() {
            return Err(io::Error::other("this is no name for a file"));
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut beside = Builder::new();
        beside.prefix(".").suffix(".part");
        let permissions = as_any_file();
        if let Some(permissions) = &permissions {
            beside.permissions(permissions.clone());
        }
        Ok(WholeFile {
            path: path.to_owned(),
            part: BufWriter::with_capacity(BUFFER_BYTES, beside.tempfile_in(folder)?),
        })
    }

    /// Adds all of another file, which is not kept.
    ///
    /// # Errors
    /// A full disk.
    pub fn append(&mut self, other: WholeFile) -> io::Result<()> {
        let mut other = other.part.into_inner().map_err(io::IntoInnerError::into_error)?;
        other.rewind()?;
        io::copy(&mut other, &mut self.part).map(drop)
    }

    /// Puts the file into its place.
    ///
    /// # Errors
    /// A full disk, a place that cannot be taken.
    pub fn keep(self) -> io::Result<()> {
        let part = self.part.into_inner().map_err(io::IntoInnerError::into_error)?;
        part.as_file().sync_all()?;
        part.persist(&self.path).map(drop).map_err(|error| error.error)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.part.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.part.flush()
    }
}

/// What any new file may be, before the user's mask: a temporary one is for its owner alone.
#[cfg(unix)]
fn as_any_file() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn as_any_file() -> Option<Permissions> {
    None
}
