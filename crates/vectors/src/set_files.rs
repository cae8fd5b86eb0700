//! Vector files, written as their lines are made: the memory that they take does not grow with the count.

use crate::{Coverage, LineWriter, Set, Unit, UnitDefinition, Written};
use cube3_file::WholeFile;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {error}; give a file in a folder that can be written", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// Why not.
    pub error: io::Error,
}

impl WriteError {
    fn at(path: &Path) -> impl Fn(io::Error) -> WriteError + '_ {
        move |error| WriteError { path: path.to_owned(), error }
    }
}

/// A unit's files beside their places.
pub struct SetFiles {
    path: PathBuf,
    written: Written,
    body: WholeFile,
    tables: Vec<(PathBuf, WholeFile)>,
}

impl SetFiles {
    /// Writes the lines that `lines` gives one after another to what it is given, and the tables; adds each line to what is covered.
    ///
    /// # Errors
    /// A file that cannot be written, and those of `lines`.
    pub fn write<E: From<WriteError>>(
        folder: &Path,
        unit: &dyn Unit,
        set: &Set,
        mut coverage: Option<&mut Coverage>,
        lines: impl FnOnce(&mut dyn FnMut(Vec<i128>) -> Result<(), E>) -> Result<(), E>,
    ) -> Result<SetFiles, E> {
        let name = set.sheet.name;
        let path = folder.join(format!("{name}.hex"));
        let mut tables = Vec::new();
        for (i, of) in set.sheet.tables.iter().enumerate() {
            let path = folder.join(format!("{name}.{}.hex", of.name));
            let mut file = WholeFile::new(&path).map_err(WriteError::at(&path))?;
            set.table_lines(i, |entry| file.write_all(entry.as_bytes())).map_err(WriteError::at(&path))?;
            tables.push((path, file));
        }
        // The header has the count and the digest of the lines, so that they come first.
        let mut writer = LineWriter::new(set, WholeFile::new(&path).map_err(WriteError::at(&path))?);
        let mut definition = UnitDefinition::new(unit, set);
        lines(&mut |inputs| {
            let outputs = definition.answer(&inputs);
            if let Some(coverage) = &mut coverage {
                coverage.see(&inputs, definition.seen(), &outputs);
            }
            Ok(writer.push(&inputs, &outputs).map_err(WriteError::at(&path))?)
        })?;
        let (written, body) = writer.finish();
        Ok(SetFiles { path, written, body, tables })
    }

    /// What was written: lines and digest.
    pub fn written(&self) -> &Written {
        &self.written
    }

    /// Puts the files into their places; where the vectors are.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(self) -> Result<PathBuf, WriteError> {
        let SetFiles { path, written, body, tables } = self;
        let keep = || {
            let mut file = WholeFile::new(&path)?;
            file.write_all(written.header.as_bytes())?;
            file.append(body)?;
            Ok(file)
        };
        let file: WholeFile = keep().map_err(WriteError::at(&path))?;
        for (path, table) in tables {
            table.keep().map_err(WriteError::at(&path))?;
        }
        file.keep().map_err(WriteError::at(&path))?;
        Ok(path)
    }
}
