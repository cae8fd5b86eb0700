//! Whether a `FrameSetup` is one that the machine can take: what a file says is not trusted.
//!
//! ```text
//!   text ──► form (serde) ──► words ──► geometry, fans ──► tables ──► rays, ends ──► FrameSetup
//! ```
//! Every field has a range, or follows from others and is made again and compared. What passes keeps the units within their tables and
//! their arithmetic within its words; [`SetupError`] names the first field that does not.

mod fans;
mod geometry;
mod rays;
mod tables;

use crate::{FrameSetup, HalfSpace, Linear};
use cube3_word::WordError;

/// A field of a setup that no machine can take, or that does not follow from the others.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SetupError {
    /// A word length.
    #[error(transparent)]
    Word(#[from] WordError),
    /// A number out of range.
    #[error("{field} = {value} is outside {low} to {high}")]
    Range {
        /// Path of the field.
        field: String,
        /// What it has.
        value: i128,
        /// The least it can have.
        low: i128,
        /// The most.
        high: i128,
    },
    /// A value that follows from others, and is another.
    #[error("{field} = {value} is not {expected}, which follows from {from}")]
    Differs {
        /// Path of the field.
        field: String,
        /// What it has.
        value: String,
        /// What it should have.
        expected: String,
        /// What decides it.
        from: &'static str,
    },
    /// A list of another length.
    #[error("{field} has {length} entries and not {expected}, which follows from {from}")]
    Length {
        /// Path of the list.
        field: String,
        /// Its entries.
        length: usize,
        /// The entries that it should have.
        expected: usize,
        /// What decides that.
        from: &'static str,
    },
    /// A choice that others leave no room for.
    #[error("{field} = {value} cannot be: {reason}")]
    Choice {
        /// Path of the field.
        field: String,
        /// What it has.
        value: String,
        /// Why not.
        reason: &'static str,
    },
    /// Registers that something reads.
    #[error("{field} is absent, and {reader} reads it")]
    Absent {
        /// Path of the registers.
        field: String,
        /// What reads them.
        reader: &'static str,
    },
    /// Registers that have no place in this frame.
    #[error("{field} is given, and {reason}")]
    Given {
        /// Path of the registers.
        field: String,
        /// Why they should not be there.
        reason: &'static str,
    },
}

impl SetupError {
    /// Path of the field at fault, as in `classification.opacity[12]`.
    pub fn field(&self) -> String {
        match self {
            SetupError::Word(error) => format!("words.{}", error.name),
            SetupError::Range { field, .. }
            | SetupError::Differs { field, .. }
            | SetupError::Length { field, .. }
            | SetupError::Choice { field, .. }
            | SetupError::Absent { field, .. }
            | SetupError::Given { field, .. } => field.clone(),
        }
    }
}

/// Why a setup cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SetupFileError {
    /// Text of another form: no JSON, a key that is unknown or missing, a value of another kind.
    #[error("{place}: {field}: {source}")]
    Form {
        /// Where the text is from.
        place: String,
        /// Path of the field, `the setup` where it is the whole.
        field: String,
        /// What the reader met.
        source: serde_json::Error,
    },
    /// A field that cannot be.
    #[error("{place}: {source}; write the setup again with the program that made it")]
    Field {
        /// Where the text is from.
        place: String,
        /// What is wrong.
        source: SetupError,
    },
}

impl SetupFileError {
    /// Path of the field at fault.
    pub fn field(&self) -> String {
        match self {
            SetupFileError::Form { field, .. } => field.clone(),
            SetupFileError::Field { source, .. } => source.field(),
        }
    }
}

impl FrameSetup {
    /// Version of the form.
    pub const SCHEMA: u32 = 1;

    /// Reads a setup and checks it whole. `place` says in errors where the text is from.
    ///
    /// # Errors
    /// Text that is no setup, or the first field that [`FrameSetup::check`] refuses.
    pub fn from_json(text: &str, place: &str) -> Result<FrameSetup, SetupFileError> {
        let place = || place.to_owned();
        let form = |path: String, source| {
            let field = if path == "." { "the setup".to_owned() } else { path };
            SetupFileError::Form { place: place(), field, source }
        };
        let mut reader = serde_json::Deserializer::from_str(text);
        let setup: FrameSetup = serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| form(error.path().to_string(), error.into_inner()))?;
        reader.end().map_err(|error| form(".".to_owned(), error))?;
        setup.check().map_err(|source| SetupFileError::Field { place: place(), source })?;
        Ok(setup)
    }

    /// Whether every field is within its range and agrees with the others.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<(), SetupError> {
        range("schema", self.schema, Self::SCHEMA, Self::SCHEMA)?;
        self.words.check()?;
        geometry::check(self)?;
        if self.clips.len() > HalfSpace::MOST {
            return Err(SetupError::Range {
                field: format!("clips[{}]", HalfSpace::MOST),
                value: self.clips.len() as i128,
                low: 0,
                high: HalfSpace::MOST as i128,
            });
        }
        for (i, clip) in self.clips.iter().enumerate() {
            self.linear(&format!("clips[{i}].distance"), &clip.distance)?;
        }
        tables::check(self)?;
        rays::check(self)
    }

    /// Coefficients of which sums over any volume stay within 64 bits.
    fn linear(&self, path: &str, linear: &Linear) -> Checked {
        let steepest = if self.rays.is_some() { Linear::STEEPEST_BY_PLACE } else { Linear::STEEPEST };
        for (name, step) in [("u", linear.u), ("v", linear.v), ("k", linear.k)] {
            range(&format!("{path}.{name}"), step, -steepest, steepest)?;
        }
        range(&format!("{path}.constant"), linear.constant, -Linear::FARTHEST, Linear::FARTHEST)
    }
}

/// Nothing, or the first field that is wrong.
type Checked = Result<(), SetupError>;

/// `value` is from `low` to `high`, both included.
fn range(field: &str, value: impl Into<i128>, low: impl Into<i128>, high: impl Into<i128>) -> Checked {
    ranges_at(|_| field.to_owned(), [value], low, high)
}

/// Each entry of a list is.
fn ranges<T: Copy + Into<i128>>(path: &str, list: &[T], low: impl Into<i128>, high: impl Into<i128>) -> Checked {
    ranges_at(|i| format!("{path}[{i}]"), list.iter().copied(), low, high)
}

/// Each of three components of each entry is from 0 to `high`.
fn triples(path: &str, list: &[[u32; 3]], high: impl Into<i128>) -> Checked {
    ranges_at(|i| format!("{path}[{}][{}]", i / 3, i % 3), list.iter().flatten().copied(), 0, high)
}

fn ranges_at<T: Into<i128>>(
    field: impl Fn(usize) -> String,
    values: impl IntoIterator<Item = T>,
    low: impl Into<i128>,
    high: impl Into<i128>,
) -> Checked {
    let (low, high) = (low.into(), high.into());
    let mut values = values.into_iter().map(Into::into).enumerate();
    match values.find(|(_, value)| !(low..=high).contains(value)) {
        Some((i, value)) => Err(SetupError::Range { field: field(i), value, low, high }),
        None => Ok(()),
    }
}

/// `value` is what `from` decides.
fn follows<T: PartialEq + std::fmt::Debug>(field: &str, value: T, expected: T, from: &'static str) -> Checked {
    if value == expected {
        return Ok(());
    }
    Err(differs(field.to_owned(), value, expected, from))
}

fn differs<T: std::fmt::Debug>(field: String, value: T, expected: T, from: &'static str) -> SetupError {
    SetupError::Differs { field, value: format!("{value:?}"), expected: format!("{expected:?}"), from }
}

/// A list has the entries that `from` decides.
fn list_follows<T: PartialEq + std::fmt::Debug>(
    path: &str,
    list: &[T],
    expected: impl ExactSizeIterator<Item = T>,
    from: &'static str,
) -> Checked {
    length(path, list.len(), expected.len(), from)?;
    match list.iter().zip(expected).enumerate().find(|(_, (value, expected))| *value != expected) {
        Some((i, (value, expected))) => Err(differs(format!("{path}[{i}]"), value, &expected, from)),
        None => Ok(()),
    }
}

/// A list has as many entries as `from` decides.
fn length(path: &str, length: usize, expected: usize, from: &'static str) -> Checked {
    if length == expected { Ok(()) } else { Err(SetupError::Length { field: path.to_owned(), length, expected, from }) }
}

/// A choice that is `free` to be made.
fn choice(field: &str, value: impl std::fmt::Debug, free: bool, reason: &'static str) -> Checked {
    if free {
        return Ok(());
    }
    Err(SetupError::Choice { field: field.to_owned(), value: format!("{value:?}"), reason })
}

/// Registers are there where `reader` reads them.
fn present(field: &str, there: bool, reader: &'static str) -> Checked {
    if there { Ok(()) } else { Err(SetupError::Absent { field: field.to_owned(), reader }) }
}

/// Registers are not there, for a reason.
fn absent(field: &str, there: bool, reason: &'static str) -> Checked {
    if there { Err(SetupError::Given { field: field.to_owned(), reason }) } else { Ok(()) }
}
