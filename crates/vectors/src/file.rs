//! The text form of vectors: a header of `//` comments, then a line of hexadecimal fields for each transaction or cycle.
//!
//! `$readmemh`, `$fscanf`, a spreadsheet and three lines of any script can read it.

use crate::text::TextLines;
use crate::{ExpressionError, LineField, Set, Sheet, Table, UnitFormat, UnitFormatError, Vectors, bits_of};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::io::{self, BufRead};

/// First line of every file: name and version of the form.
const MAGIC: &str = "cube3 vectors 1";

fn ports(fields: &[LineField]) -> String {
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
pub(crate) fn format_line(sheet: &Sheet, format: &UnitFormat) -> String {
    let settings = format.settings().into_iter().filter(|(name, _)| sheet.parameters.contains(name));
    let settings: String = settings.map(|(name, value)| format!(" {name}={value}")).collect();
    format!("// format{settings}")
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Set {
    /// The header of `<unit>.hex`.
    fn header(&self, lines: usize, digest: &str) -> String {
        let tables = self.sheet.tables.iter().zip(&self.tables);
        let tables: String = tables.map(|(of, table)| format!(" {}:{}", of.name, table.len())).collect();
        let counted = if self.sheet.clocked { "cycles" } else { "transactions" };
        format!(
            "// {MAGIC}\n{}\n{}\n// seed {}\n// generator cube3 {}\n// {counted} {lines}\n// inputs{}\n\
             // outputs{}\n// tables{tables}\n// sha256 {digest}\n",
            unit_line(&self.sheet),
            format_line(&self.sheet, &self.format),
            self.seed,
            env!("CARGO_PKG_VERSION"),
            ports(&self.fields[0]),
            ports(&self.fields[1]),
        )
    }

    /// Gives the contents of `<unit>.<table>.hex` to `take`, an entry and its line's end at a time.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn table_lines<E>(&self, table: usize, mut take: impl FnMut(&str) -> Result<(), E>) -> Result<(), E> {
        let bits = self.format.evaluate(self.sheet.tables[table].bits).unwrap_or(1) as u32;
        let field = LineField { name: String::new(), port: 0, bits, signed: false, range: [0, 0] };
        let mut text = String::new();
        self.tables[table].iter().try_for_each(|&entry| {
            text.clear();
            field.write(entry, &mut text);
            text.push('\n');
            take(&text)
        })
    }

    /// The digest of a file: of the lines below the header, and then of the tables.
    fn digest(&self, mut lines: Sha256) -> String {
        for table in 0..self.tables.len() {
            let _ = self.table_lines(table, |entry| {
                lines.update(entry);
                Ok::<(), std::convert::Infallible>(())
            });
        }
        hexadecimal(lines)
    }
}

/// Writes the lines of `<unit>.hex` that stand below its header, which counts them and has their digest and so comes last.
pub struct LineWriter<'a, W> {
    set: &'a Set,
    out: W,
    hash: Sha256,
    text: String,
    lines: usize,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The header that belongs before the lines.
    pub header: String,
    /// How many lines.
    pub lines: usize,
    /// The digest in the header.
    pub digest: String,
}

impl<'a, W: io::Write> LineWriter<'a, W> {
    /// No line yet.
    pub fn new(set: &'a Set, out: W) -> LineWriter<'a, W> {
        LineWriter { set, out, hash: Sha256::new(), text: String::new(), lines: 0 }
    }

    /// How many lines there are so far.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// Writes the next line.
    ///
    /// # Errors
    /// Those of what is written to.
    pub fn push(&mut self, inputs: &[i128], outputs: &[i128]) -> io::Result<()> {
        self.text.clear();
        let [of_inputs, of_outputs] = &self.set.fields;
        for (field, value) in of_inputs.iter().zip(inputs).chain(of_outputs.iter().zip(outputs)) {
            if !self.text.is_empty() {
                self.text.push(' ');
            }
            field.write(*value, &mut self.text);
        }
        self.text.push('\n');
        self.hash.update(&self.text);
        self.lines += 1;
        self.out.write_all(self.text.as_bytes())
    }

    /// The header, and what was written to.
    pub fn finish(self) -> (Written, W) {
        let digest = self.set.digest(self.hash);
        (Written { header: self.set.header(self.lines, &digest), lines: self.lines, digest }, self.out)
    }
}

impl Vectors {
    /// The contents of `<unit>.hex`.
    pub fn text(&self) -> String {
        let mut lines = LineWriter::new(&self.set, Vec::new());
        for (inputs, outputs) in self.inputs.iter().zip(&self.outputs) {
            // Memory takes all.
            let _ = lines.push(inputs, outputs);
        }
        let (written, body) = lines.finish();
        written.header + &String::from_utf8_lossy(&body)
    }

    /// The contents of `<unit>.<table>.hex` for each table: its name, and an entry a line.
    pub fn table_texts(&self) -> Vec<(&'static str, String)> {
        let table = |(i, of): (usize, &Table)| {
            let mut text = String::new();
            let _ = self.set.table_lines(i, |entry| {
                text += entry;
                Ok::<(), std::convert::Infallible>(())
            });
            (of.name, text)
        };
        self.set.sheet.tables.iter().enumerate().map(table).collect()
    }
}

/// What a vector file says of its lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VectorHeader {
    /// The unit.
    pub unit: String,
    /// The format, where the file says nothing the default.
    pub format: UnitFormat,
    /// The seed.
    pub seed: u64,
    /// The digest of lines and tables.
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
    Format(#[from] UnitFormatError),
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
    /// A text that cannot be read.
    #[error("{0}")]
    Read(String),
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

impl From<io::Error> for FileError {
    fn from(error: io::Error) -> FileError {
        FileError::Read(error.to_string())
    }
}

impl VectorHeader {
    /// Takes a comment of the header in: line of the text, its text, and what stands behind the slashes.
    fn take(&mut self, line: usize, text: &str, comment: &str) -> Result<(), FileError> {
        let wrong = || FileError::Header { line, text: text.to_owned() };
        match comment.trim().split_once(' ') {
            Some(("unit", name)) => self.unit = name.trim().into(),
            Some(("sha256", digest)) => self.digest = Some(digest.trim().into()),
            Some(("seed", seed)) => self.seed = seed.trim().parse().map_err(|_| wrong())?,
            Some(("format", settings)) => {
                let mut names = Vec::new();
                for setting in settings.split_whitespace() {
                    let (name, value) = setting.split_once('=').ok_or_else(wrong)?;
                    let value = value.parse().map_err(|_| wrong())?;
                    if !self.format.set(name, value) {
                        return Err(wrong());
                    }
                    names.push(name);
                }
                self.format.fit(&names);
                // A unit that does not depend on samples does not name their width.
                let words = &mut self.format.words;
                if !names.contains(&"sample_fraction_bits") {
                    let wanted = words.gradient_bits.saturating_sub(words.voxel_bits.saturating_add(1));
                    words.sample_fraction_bits = words.sample_fraction_bits.max(wanted.min(8));
                }
                self.format.check()?;
            }
            _ => {}
        }
        Ok(())
    }

    /// The contents of a table from its text, an entry a line.
    ///
    /// # Errors
    /// What is no entry, and entries that do not fit the table.
    pub fn table(&self, of: &Table, text: impl BufRead) -> Result<Vec<i128>, FileError> {
        let (expected, bits) = (self.format.evaluate(of.entries)?, self.format.evaluate(of.bits)? as u32);
        let (mut entries, mut found, mut fit) = (Vec::new(), 0, true);
        let mut lines = TextLines::new(text);
        while let Some((line, text)) = lines.next()? {
            let word = text.split("//").next().unwrap_or_default().trim();
            if word.is_empty() {
                continue;
            }
            let entry = i128::from_str_radix(word, 16);
            let entry = entry.map_err(|_| FileError::Word { line, text: word.to_owned() })?;
            fit &= entry >= 0 && bits_of([0, entry]) <= bits;
            found += 1;
            if found as i128 <= expected {
                entries.push(entry);
            }
        }
        if found as i128 != expected || !fit {
            return Err(FileError::Table { name: of.name, found, expected, bits });
        }
        Ok(entries)
    }
}

/// Reads the inputs of a vector file line by line; what the unit answers is evaluated anew.
pub struct VectorReader<R> {
    header: VectorHeader,
    lines: TextLines<R>,
    /// The first line of words, where the header ended there.
    pending: Option<(usize, String)>,
    /// Lines of words so far.
    read: usize,
    /// Of their texts.
    hash: Sha256,
}

impl<R: BufRead> VectorReader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// The first line that is not understood.
    pub fn new(reader: R) -> Result<VectorReader<R>, FileError> {
        let mut lines = TextLines::new(reader);
        if lines.next()?.map(|(_, text)| text.trim()) != Some(&format!("// {MAGIC}")) {
            return Err(FileError::Magic);
        }
        let mut header = VectorHeader { unit: String::new(), format: UnitFormat::default(), seed: 0, digest: None };
        let mut pending = None;
        while let Some((line, text)) = lines.next()? {
            if let Some(comment) = text.trim().strip_prefix("//") {
                header.take(line, text, comment)?;
            } else if !text.trim().is_empty() {
                pending = Some((line, text.to_owned()));
                break;
            }
        }
        Ok(VectorReader { header, lines, pending, read: 0, hash: Sha256::new() })
    }

    /// What the file says of its lines.
    pub fn header(&self) -> &VectorHeader {
        &self.header
    }

    /// The input fields of the next line; none behind the last.
    ///
    /// # Errors
    /// A line that does not fit the unit, and one that cannot be read.
    pub fn inputs(&mut self, set: &Set) -> Result<Option<Vec<i128>>, FileError> {
        loop {
            let pending = self.pending.take();
            let next = match &pending {
                Some((line, text)) => Some((*line, text.as_str())),
                None => self.lines.next()?,
            };
            let Some((number, text)) = next else { return Ok(None) };
            if let Some(comment) = text.trim().strip_prefix("//") {
                let name = comment.trim().split(' ').next().unwrap_or_default();
                if matches!(name, "unit" | "sha256" | "seed" | "format") {
                    return Err(FileError::Header { line: number, text: text.to_owned() });
                }
                continue;
            }
            if text.trim().is_empty() {
                continue;
            }
            self.hash.update(text);
            self.hash.update("\n");
            let inputs = line_inputs(set, number, self.read, text)?;
            self.read += 1;
            return Ok(Some(inputs));
        }
    }

    /// The digest of the lines so far as they stand in the file, and of a set's tables.
    pub fn digest(self, set: &Set) -> String {
        set.digest(self.hash)
    }
}

/// The input fields of a transaction or cycle from its text.
fn line_inputs(set: &Set, number: usize, line: usize, text: &str) -> Result<Vec<i128>, FileError> {
    let fields = &set.fields[0];
    let mut inputs = Vec::with_capacity(fields.len());
    let mut found = 0;
    for word in text.split_whitespace() {
        let bits = u128::from_str_radix(word, 16);
        let bits = bits.map_err(|_| FileError::Word { line: number, text: word.to_owned() })?;
        if let Some(field) = fields.get(found) {
            let (value, [low, high]) = (field.value(bits), field.range);
            if !(low..=high).contains(&value) {
                return Err(FileError::Value { line, field: field.name.clone(), value, low, high });
            }
            inputs.push(value);
        }
        found += 1;
    }
    if found != set.width() {
        return Err(FileError::Fields { line, found, expected: set.width() });
    }
    Ok(inputs)
}
