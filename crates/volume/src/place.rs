//! Which file is being read, so that every error can say so.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::VolumeError;
use crate::source::Source;

/// A file's name for messages, and where it is: names in its header are relative to its folder.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub file: String,
    path: Option<PathBuf>,
}

impl Place {
    /// The place of a file.
    pub fn of_path(path: &Path) -> Self {
        Self { file: path.display().to_string(), path: Some(path.to_owned()) }
    }

    /// The place of bytes in memory; there are no files beside them.
    pub fn of_bytes(name: &str) -> Self {
        Self { file: name.to_owned(), path: None }
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

    /// An error of the operating system here, or of a decoder: what cannot be unpacked is damaged.
    pub fn io(&self, action: &'static str, source: std::io::Error) -> VolumeError {
        use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
        if action == "read" && matches!(source.kind(), InvalidData | InvalidInput | UnexpectedEof) {
            return VolumeError::Inflate { file: self.file.clone(), reason: source.to_string() };
        }
        VolumeError::Io { file: self.file.clone(), action, source }
    }

    /// A grid error, said of this file's header.
    pub fn grid(&self, error: VolumeError) -> VolumeError {
        match error {
            VolumeError::Grid { what, reason, remedy } => self.wrong(what, reason, remedy),
            other => other,
        }
    }

    /// What a voxel of more than one number is told, in every format.
    pub fn several(&self, place: impl Into<String>, numbers: Option<u64>, kind: &str) -> VolumeError {
        let what = match numbers {
            Some(numbers) => format!("a voxel of {numbers} numbers ({kind})"),
            None => format!("a voxel of several numbers ({kind})"),
        };
        self.unsupported(place, what, "store one number for each voxel, such as one of the components")
    }

    /// The path of the file itself; bytes in memory have none.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The path of a file that the header names.
    pub fn beside(&self, name: &str) -> Result<PathBuf, VolumeError> {
        self.path.as_ref().map(|path| path.with_file_name(name)).ok_or_else(|| {
            self.unsupported(
                "data file",
                format!("a data file ('{name}') beside bytes in memory"),
                "read the header from a file",
            )
        })
    }
}

/// Opens a file for reading; a folder is an error here already. With `unpack` a file that is gzipped as a whole is unpacked.
pub(crate) fn open(path: &Path, unpack: bool) -> Result<(Source<'static>, Place), VolumeError> {
    let place = Place::of_path(path);
    let file = File::open(path).map_err(|e| place.io("open", e))?;
    let about = file.metadata().map_err(|e| place.io("open", e))?;
    if !about.is_file() {
        let reason = std::io::Error::other("it is not a file");
        return Err(place.io("open", reason));
    }
    let source = Source::of_file(file, unpack).map_err(|e| place.io("read", e))?;
    Ok((source, place))
}

/// Whether a file's name says that it is gzipped as a whole.
pub(crate) fn is_gz(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"))
}

/// A path with the `.gz` at its end taken away, and the extension before it.
pub(crate) fn without_gz(path: &Path) -> PathBuf {
    if is_gz(path) { path.with_extension("") } else { path.to_owned() }
}
