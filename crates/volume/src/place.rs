//! Which file is being read, so that every error can say so.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::{Path, PathBuf};

use crate::VolumeError;

/// Bytes that can be read line by line and searched: a file, or bytes in memory.
pub(crate) trait Source: BufRead + Seek {}

impl<R: BufRead + Seek> Source for R {}

/// A file's name for messages, and the folder that the names in its header are relative to.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub file: String,
    folder: Option<PathBuf>,
}

impl Place {
    /// The place of a file.
    pub fn of_path(path: &Path) -> Self {
        Self { file: path.display().to_string(), folder: Some(path.parent().unwrap_or(Path::new("")).to_owned()) }
    }

    /// The place of bytes in memory; there are no files beside them.
    pub fn of_bytes(name: &str) -> Self {
        Self { file: name.to_owned(), folder: None }
    }

    /// A header error here.
    pub fn wrong(&self, place: impl Into<String>, reason: impl Into<String>, remedy: impl Into<String>) -> VolumeError {
        VolumeError::Header {
            file: self.file.clone(),
            place: place.into(),
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }

    /// An error for what a correct file asks for and does not get here.
    pub fn unsupported(
        &self,
        place: impl Into<String>,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> VolumeError {
        VolumeError::Unsupported {
            file: self.file.clone(),
            place: place.into(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// An error of the operating system here.
    pub fn io(&self, action: &'static str, source: std::io::Error) -> VolumeError {
        VolumeError::Io { file: self.file.clone(), action, source }
    }

    /// A grid error, said of this file's header.
    pub fn grid(&self, error: VolumeError) -> VolumeError {
        match error {
            VolumeError::Grid { what, reason, remedy } => self.wrong(what, reason, remedy),
            other => other,
        }
    }

    /// Opens the file that holds the voxels of this header.
    pub fn open_beside(&self, name: &str) -> Result<(BufReader<File>, Place), VolumeError> {
        let Some(folder) = &self.folder else {
            return Err(self.unsupported(
                "data file",
                format!("a data file ('{name}') beside bytes in memory"),
                "read the header from a file",
            ));
        };
        let path = folder.join(name);
        let place = Place::of_path(&path);
        Ok((open(&path)?, place))
    }
}

/// Opens a file for reading; a folder is an error here already.
pub(crate) fn open(path: &Path) -> Result<BufReader<File>, VolumeError> {
    let place = Place::of_path(path);
    let file = File::open(path).map_err(|e| place.io("open", e))?;
    let about = file.metadata().map_err(|e| place.io("open", e))?;
    if !about.is_file() {
        let reason = std::io::Error::other("it is not a file");
        return Err(place.io("open", reason));
    }
    Ok(BufReader::with_capacity(1 << 18, file))
}
