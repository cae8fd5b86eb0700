//! The one way in which a scene reports what is wrong with it.

use std::fmt;
use std::path::PathBuf;

use cube3_parameter::Fault;
use thiserror::Error;

/// Why there is no scene: one message with the place, the reason and what would be right.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The scene file could not be read at all.
    #[error("{}: cannot read the scene: {source}; give the path of a scene file (TOML)", path.display())]
    Unreadable {
        /// The path as it was given.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Something in the scene is wrong.
    #[error("{place}: {reason}; {right}")]
    Invalid {
        /// Where it is.
        place: ScenePlace,
        /// What is wrong.
        reason: String,
        /// What would be right, as an instruction.
        right: String,
    },
}

impl SceneError {
    /// The dotted path of the key at fault, such as `transfer.opacity[2]`; empty if there is none.
    pub fn key(&self) -> &str {
        match self {
            SceneError::Unreadable { .. } => "",
            SceneError::Invalid { place, .. } => &place.key,
        }
    }

    /// An error at `key`, of a scene that may not come from a file.
    pub(crate) fn at(key: impl Into<String>, reason: impl Into<String>, right: impl Into<String>) -> Self {
        SceneError::Invalid {
            place: ScenePlace { key: key.into(), ..ScenePlace::default() },
            reason: reason.into(),
            right: right.into(),
        }
    }

    /// A value of a scene out of its range.
    pub(crate) fn out_of_range(fault: &Fault) -> Self {
        SceneError::at(&fault.key, fault.reason(), fault.remedy())
    }

    /// The same error, in `line` of the text called `file`.
    pub(crate) fn in_file(mut self, file: &str, line: Option<usize>) -> Self {
        if let SceneError::Invalid { place, .. } = &mut self {
            place.file = Some(file.to_owned());
            place.line = line;
        }
        self
    }
}

/// Where in a scene something is: file and line where it has been read from one, and the key.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ScenePlace {
    /// The name of the text that the scene was read from.
    pub file: Option<String>,
    /// The line in that text, from 1.
    pub line: Option<usize>,
    /// The dotted path of the key, list elements from 0; empty where no key is concerned.
    pub key: String,
}

impl fmt::Display for ScenePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.file.as_deref().unwrap_or("scene"))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        Ok(())
    }
}
