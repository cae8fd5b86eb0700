//! The text form of vectors: a header of `//` comments, then a line of hexadecimal fields for each transaction or cycle.
//!
//! `$readmemh`, `$fscanf`, a spreadsheet and three lines of any script can read it.

use crate::{ExpressionError, Field, Format, FormatError, Sheet, Table, Tables, Unit, Vectors, bits_of};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// First line of every file: name and version of the form.
const MAGIC: &str = "cube3 vectors 1";

fn ports(fields: &[Field]) -> String {
    let mut text = String::new();
    for (i, field) in fields.iter().enumerate() {
        if i > 0 && fields[i - 1].port == field.port {
            continue;
        }
        let count = fields.iter().filter(|other| other.port == field.port).count();
        let name = field.name.split('[').next().unwrap_or_default();
        let sign = if field.signed { "s" } else { "" };
        let row = if count > 1 { format!("[{count}]") } else { String::new() };
        let _ = write!(text, " {name}{row}:{sign}{}", field.bits);
    }
    text
}

/// The header's line that names the unit.
pub(crate) fn unit_line(sheet: &Sheet) -> String {
    format!("// unit {}", sheet.name)
}

/// The header's line of the settings that the unit has.
pub(crate) fn format_line(sheet: &Sheet, format: &Format) -> String {
    let settings = format.settings().into_iter().filter(|(name, _)| sheet.parameters.contains(name));
    let settings: String = settings.map(|(name, value)| format!(" {name}={value}")).collect();
    format!("// format{settings}")
}

/// The text of fields' values.
pub(crate) fn line(fields: &[Field], values: &[i128]) -> String {
    let words: Vec<String> = fields.iter().zip(values).map(|(field, value)| field.text(*value)).collect();
    words.join(" ")
}

impl Vectors {
    /// The lines of `<unit>.hex` below its header.
    fn body(&self) -> String {
        let mut body = String::new();
        for (inputs, outputs) in self.inputs.iter().zip(&self.outputs) {
            let _ = writeln!(body, "{} {}", line(&self.fields[0], inputs), line(&self.fields[1], outputs));
        }
        body
    }

    /// SHA-256 of the lines below the header, and then of the tables.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new_with_prefix(self.body());
        for (_, text) in self.table_texts() {
            hash.update(&text);
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// The contents of `<unit>.hex`.
    pub fn text(&self) -> String {
        let tables: Vec<String> =
            self.table_texts().iter().map(|(name, text)| format!(" {name}:{}", text.lines().count())).collect();
        let counted = if self.sheet.clocked { "cycles" } else { "transactions" };
        format!(
            "// {MAGIC}\n{}\n{}\n// seed {}\n// generator cube3 {}\n// {counted} {}\n// inputs{}\n\
             // outputs{}\n// tables{}\n// sha256 {}\n{}",
            unit_line(&self.sheet),
            format_line(&self.sheet, &self.format),
            self.seed,
            env!("CARGO_PKG_VERSION"),
            self.inputs.len(),
            ports(&self.fields[0]),
            ports(&self.fields[1]),
            tables.concat(),
            self.digest(),
            self.body(),
        )
    }

    /// The contents of `<unit>.<table>.hex` for each table: its name, and an entry a line.
    pub fn table_texts(&self) -> Vec<(&'static str, String)> {
        let text = |bits: i128, entries: &[i128]| {
            let field = Field { name: String::new(), port: 0, bits: bits as u32, signed: false, range: [0, 0] };
            entries.iter().map(|entry| field.text(*entry) + "\n").collect::<String>()
        };
        let tables = self.sheet.tables.iter().zip(&self.tables);
        tables.filter_map(|(of, table)| Some((of.name, text(self.format.evaluate(of.bits).ok()?, table)))).collect()
    }
}

/// A vector file that was read: what drives the unit. What it answers is evaluated anew.
#[derive(Clone, Debug, PartialEq)]
pub struct VectorFile {
    /// The unit.
    pub unit: String,
    /// The format, where the file says nothing the default.
    pub format: Format,
    /// The seed.
    pub seed: u64,
    /// The words of each line.
    pub lines: Vec<Vec<u128>>,
    /// The digest that the header gives.
    pub digest: Option<String>,
}

/// Why a text is no vector file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// No header.
    #[error("no cube3 vector file: the first line is not \"// {MAGIC}\"; `cube3 vectors` writes such files")]
    Magic,
    /// A header line.
    #[error("line {line}: \"{text}\" is not understood; `cube3 vectors` writes such files")]
    Header {
        /// Line, from 1.
        line: usize,
        /// Its text.
        text: String,
    },
    /// The format.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The sheet.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// A table with too few, too many or too large entries.
    #[error("the table {name} has {found} entries; it holds {expected} of at most {bits} bits in this format")]
    Table {
        /// Its name.
        name: &'static str,
        /// Entries there.
        found: usize,
        /// Entries of the table.
        expected: i128,
        /// Bits of an entry.
        bits: u32,
    },
    /// Contents that are not those that were written.
    #[error(
        "the lines or tables are not those of the digest in the header: they were changed, or the definition was; make the file \
         again, or take out its line \"// sha256\" to use its inputs as they are"
    )]
    Digest,
    /// A line with too few or too many words.
    #[error("transaction {line} has {found} words; the unit has {expected} fields in this format")]
    Fields {
        /// Transaction or cycle, from 0.
        line: usize,
        /// Words there.
        found: usize,
        /// Fields.
        expected: usize,
    },
    /// A value that the unit cannot be given.
    #[error("transaction {line}: {field} = {value} is outside {low} to {high}")]
    Value {
        /// Transaction or cycle, from 0.
        line: usize,
        /// The field.
        field: String,
        /// Its value.
        value: i128,
        /// The lowest.
        low: i128,
        /// The highest.
        high: i128,
    },
    /// A word.
    #[error("line {line}: \"{text}\" is no hexadecimal number")]
    Word {
        /// Line, from 1.
        line: usize,
        /// The word.
        text: String,
    },
}

impl VectorFile {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// The first line that is not understood.
    pub fn parse(text: &str) -> Result<VectorFile, FileError> {
        let mut file =
            VectorFile { unit: String::new(), format: Format::default(), seed: 0, lines: Vec::new(), digest: None };
        if text.lines().next().map(str::trim) != Some(&format!("// {MAGIC}")) {
            return Err(FileError::Magic);
        }
        for (number, text) in text.lines().enumerate() {
            let line = number + 1;
            let header = || FileError::Header { line, text: text.to_owned() };
            let Some(comment) = text.trim().strip_prefix("//") else {
                let word = |word: &str| {
                    u128::from_str_radix(word, 16).map_err(|_| FileError::Word { line, text: word.to_owned() })
                };
                let words: Vec<u128> = text.split_whitespace().map(word).collect::<Result<_, _>>()?;
                if !words.is_empty() {
                    file.lines.push(words);
                }
                continue;
            };
            match comment.trim().split_once(' ') {
                Some(("unit", name)) => file.unit = name.trim().into(),
                Some(("sha256", digest)) => file.digest = Some(digest.trim().into()),
                Some(("seed", seed)) => file.seed = seed.trim().parse().map_err(|_| header())?,
                Some(("format", settings)) => {
                    let mut names = Vec::new();
                    for setting in settings.split_whitespace() {
                        let (name, value) = setting.split_once('=').ok_or_else(header)?;
                        let value = value.parse().map_err(|_| header())?;
                        if !file.format.set(name, value) {
                            return Err(header());
                        }
                        names.push(name);
                    }
                    file.format.fit(&names);
                    // A unit that does not depend on samples does not name their width.
                    let words = &mut file.format.words;
                    if !names.contains(&"sample_fraction_bits") {
                        let wanted = words.gradient_bits.saturating_sub(words.voxel_bits.saturating_add(1));
                        words.sample_fraction_bits = words.sample_fraction_bits.max(wanted.min(8));
                    }
                    file.format.check()?;
                }
                _ => {}
            }
        }
        Ok(file)
    }

    /// The contents of a table from its text, an entry a line.
    ///
    /// # Errors
    /// What is no entry, and entries that do not fit the table.
    pub fn table(&self, of: &Table, text: &str) -> Result<Vec<i128>, FileError> {
        let mut entries = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let word = line.split("//").next().unwrap_or_default().trim();
            if !word.is_empty() {
                let entry = i128::from_str_radix(word, 16);
                entries.push(entry.map_err(|_| FileError::Word { line: number + 1, text: word.to_owned() })?);
            }
        }
        let (expected, bits) = (self.format.evaluate(of.entries)?, self.format.evaluate(of.bits)? as u32);
        let fit = entries.iter().all(|&entry| entry >= 0 && bits_of([0, entry]) <= bits);
        if entries.len() as i128 != expected || !fit {
            return Err(FileError::Table { name: of.name, found: entries.len(), expected, bits });
        }
        Ok(entries)
    }

    /// The file's lines with what the definition says to them, with these contents of the tables.
    ///
    /// # Errors
    /// Lines that do not fit the unit.
    pub fn vectors(&self, unit: &dyn Unit, tables: Tables) -> Result<Vectors, FileError> {
        let sheet = unit.sheet();
        let fields = Sheet::fields(&sheet.inputs, &self.format)?;
        let expected = fields.len() + Sheet::fields(&sheet.outputs, &self.format)?.len();
        let inputs = self.lines.iter().enumerate().map(|(line, words)| {
            if words.len() != expected {
                return Err(FileError::Fields { line, found: words.len(), expected });
            }
            let value = |(field, bits): (&Field, &u128)| {
                let (value, [low, high]) = (field.value(*bits), field.range);
                if (low..=high).contains(&value) {
                    Ok(value)
                } else {
                    Err(FileError::Value { line, field: field.name.clone(), value, low, high })
                }
            };
            fields.iter().zip(words).map(value).collect()
        });
        let inputs: Vec<Vec<i128>> = inputs.collect::<Result<_, _>>()?;
        let vectors = Vectors::with_tables(unit, self.format, self.seed, tables, inputs)?;
        // What was written is the definition's: inputs, outputs and tables that were changed, or lines that are missing, show here.
        match &self.digest {
            Some(digest) if *digest != vectors.digest() => Err(FileError::Digest),
            _ => Ok(vectors),
        }
    }
}
