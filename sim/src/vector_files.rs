//! Vector files, written as their lines are made: the memory that they take does not grow with the count.

use crate::output::{WholeFile, unwritten};
use crate::problem::Outcome;
use cube3_vectors::{Coverage, LineWriter, Set, Unit, UnitDefinition, Written};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A unit's files beside their places.
pub struct SetFiles {
    path: PathBuf,
    written: Written,
    body: WholeFile,
    tables: Vec<WholeFile>,
}

impl SetFiles {
    /// Writes the lines that `lines` gives one after another to what it is given, and the tables; adds each line to what is covered.
    ///
    /// # Errors
    /// A file that cannot be written, and those of `lines`.
    pub fn write(
        folder: &Path,
        unit: &dyn Unit,
        set: &Set,
        mut coverage: Option<&mut Coverage>,
        lines: impl FnOnce(&mut dyn FnMut(Vec<i128>) -> Outcome<()>) -> Outcome<()>,
    ) -> Outcome<SetFiles> {
        let name = set.sheet.name;
        let path = folder.join(format!("{name}.hex"));
        let mut tables = Vec::new();
        for (i, of) in set.sheet.tables.iter().enumerate() {
            let path = folder.join(format!("{name}.{}.hex", of.name));
            let mut file = WholeFile::new(&path, "part")?;
            set.table_lines(i, |entry| file.write_all(entry.as_bytes())).map_err(|error| unwritten(&path, error))?;
            tables.push(file);
        }
        // The header has the count and the digest of the lines, so that they come first.
        let mut writer = LineWriter::new(set, WholeFile::new(&path, "lines.part")?);
        let mut definition = UnitDefinition::new(unit, set);
        lines(&mut |inputs| {
            let outputs = definition.answer(&inputs);
            if let Some(coverage) = &mut coverage {
                coverage.see(&inputs, definition.seen(), &outputs);
            }
            writer.push(&inputs, &outputs).map_err(|error| unwritten(&path, error))
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
    pub fn keep(self) -> Outcome<PathBuf> {
        let SetFiles { path, written, body, tables } = self;
        let mut file = WholeFile::new(&path, "part")?;
        file.write_all(written.header.as_bytes()).map_err(|error| unwritten(&path, error))?;
        file.append(body)?;
        tables.into_iter().try_for_each(WholeFile::keep)?;
        file.keep()?;
        Ok(path)
    }
}
