//! A device under test against the vectors of a unit.

use cube3_vectors::compare::Compared;
use cube3_vectors::{
    AnswerReader, Comparison, ExpressionError, FileError, Mismatch, ResponsesError, Set, Tables, Unit, UnitDefinition,
    VectorReader, units,
};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Lines that are kept before and behind the first that differs.
pub const AROUND: usize = 16;

/// Why there is no verdict.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// A vector file, or a table beside it, that cannot be opened.
    #[error("{}: {error}; give a file that `cube3 vectors` wrote", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// What is in a vector file.
    #[error("{}: {error}", path.display())]
    Vectors {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: FileError,
    },
    /// A file of answers that cannot be opened.
    #[error("{}: {error}; give a text file with a line of output fields for each line of the vectors", path.display())]
    NoAnswers {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// What is in a file of answers.
    #[error("{}: {error}", path.display())]
    Answers {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: ResponsesError,
    },
    /// A unit that is not there.
    #[error("there is no unit \"{name}\"; the units are {known}")]
    Unit {
        /// The name that was given.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A sheet whose expressions have no value in a format.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

/// What the comparison of a device's answers with the definition gave.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The unit.
    pub unit: &'static str,
    /// Lines that were compared.
    pub lines: usize,
    /// Where the answers differ first; nothing where all are equal, bit for bit.
    pub mismatch: Option<Mismatch>,
}

/// The unit of a name.
///
/// # Errors
/// No such unit; the message has the names that there are.
pub fn unit(name: &str) -> Result<Box<dyn Unit>, VerifyError> {
    let mut all = units();
    match all.iter().position(|unit| unit.sheet().name == name) {
        Some(place) => Ok(all.swap_remove(place)),
        None => {
            let known: Vec<&str> = all.iter().map(|unit| unit.sheet().name).collect();
            Err(VerifyError::Unit { name: name.into(), known: known.join(", ") })
        }
    }
}

/// Opens a vector file at its first line.
///
/// # Errors
/// A file that cannot be read, and what is wrong in its header.
pub fn open_vectors(path: &Path) -> Result<VectorReader<BufReader<File>>, VerifyError> {
    let file = File::open(path).map_err(|error| VerifyError::Open { path: path.into(), error })?;
    VectorReader::new(BufReader::new(file)).map_err(|error| VerifyError::Vectors { path: path.into(), error })
}

/// The unit of a vector file, and what its lines have in common; the tables are in files beside it, with the table's name before the
/// extension.
///
/// # Errors
/// A file that cannot be read, and what is wrong in it.
pub fn set_of(path: &Path) -> Result<(Box<dyn Unit>, Set), VerifyError> {
    let header = open_vectors(path)?.header().clone();
    let unit = unit(&header.unit)?;
    let mut tables = Tables::new();
    for of in unit.sheet().tables {
        let path = path.with_extension(format!("{}.hex", of.name));
        let file = File::open(&path).map_err(|error| VerifyError::Open { path: path.clone(), error })?;
        let table = header.table(&of, BufReader::new(file));
        tables.push(table.map_err(|error| VerifyError::Vectors { path, error })?);
    }
    let set = Set::with_tables(unit.as_ref(), header.format, header.seed, tables)?;
    Ok((unit, set))
}

/// Compares a file of answers, a line of output fields for each line of a vector file, with what the unit's definition gives.
///
/// # Errors
/// Files that cannot be read, lines that are missing, vectors that were changed.
///
/// ```
/// use cube3::verify::{unit, verify};
/// use cube3_vectors::{UnitFormat, Lines, Set, SetFiles, WriteError};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// // Ten lines for the unit `lerp`, as `cube3 vectors` writes them.
/// let unit = unit("lerp")?;
/// let set = Set::new(unit.as_ref(), UnitFormat::default(), 1)?;
/// let lines = Lines::new(unit.as_ref(), &set)?.take(10).collect::<Vec<_>>();
/// let files = SetFiles::write::<WriteError>(folder.path(), unit.as_ref(), &set, None, |take| lines.into_iter().try_for_each(take))?;
/// let vectors = files.keep()?;
/// // A device that answers 0 to everything.
/// let answers = folder.path().join("answers.hex");
/// std::fs::write(&answers, "0\n".repeat(10))?;
/// let verdict = verify(&vectors, &answers)?;
/// let mismatch = verdict.mismatch.expect("0 is not always right");
/// println!("{} of {} lines differ, first line {}", mismatch.differ, verdict.lines, mismatch.line);
/// # assert_eq!(verdict.lines, 10);
/// # Ok(())
/// # }
/// ```
pub fn verify(vectors: &Path, answers: &Path) -> Result<Verdict, VerifyError> {
    let (unit, set) = set_of(vectors)?;
    let digest = open_vectors(vectors)?.header().digest.clone();
    verify_set(unit.as_ref(), &set, vectors, answers, digest.as_deref())
}

/// As [`verify`], of a unit and a set that are there already, and vectors with this digest, where it is known.
///
/// # Errors
/// As [`verify`].
pub fn verify_set(
    unit: &dyn Unit,
    set: &Set,
    vectors: &Path,
    answers: &Path,
    digest: Option<&str>,
) -> Result<Verdict, VerifyError> {
    let wrong = |error: ResponsesError| VerifyError::Answers { path: answers.into(), error };
    let in_vectors = |error: FileError| VerifyError::Vectors { path: vectors.into(), error };
    let file = File::open(answers).map_err(|error| VerifyError::NoAnswers { path: answers.into(), error })?;
    let mut responses = AnswerReader::new(set, BufReader::new(file));
    let (mut reader, mut definition) = (open_vectors(vectors)?, UnitDefinition::new(unit, set));
    let mut comparison = Comparison::new(set, AROUND);
    let (mut expected, mut found) = (0, 0);
    loop {
        let inputs = reader.inputs(set).map_err(in_vectors)?;
        let answers = responses.answers().map_err(wrong)?;
        expected += usize::from(inputs.is_some());
        found += usize::from(answers.is_some());
        match (inputs, answers) {
            (None, None) => break,
            (Some(inputs), Some(answers)) => {
                let outputs = definition.answer(&inputs);
                comparison.push(Compared { inputs, outputs, answers });
            }
            _ => {}
        }
    }
    if found != expected {
        return Err(wrong(ResponsesError::Lines { found, expected }));
    }
    // A device could have changed what it was given.
    if digest.is_some_and(|digest| digest != reader.digest(set)) {
        return Err(in_vectors(FileError::Digest));
    }
    Ok(Verdict { unit: set.sheet.name, lines: expected, mismatch: comparison.finish() })
}
