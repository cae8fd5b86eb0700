//! The answers of a device under test, and where they are wrong first.

use crate::text::TextLines;
use crate::{LineField, Set, Unit, WireRecorder, bits_of};
use std::collections::VecDeque;
use std::fmt::Write;
use std::io::{self, BufRead};

/// A field of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// As it was written, without a prefix.
    pub text: String,
    /// Its bits; none where a digit is unknown (x or z).
    pub bits: Option<u128>,
}

impl Answer {
    /// The answer of a device that gives a field this value.
    pub fn of(field: &LineField, value: i128) -> Answer {
        Answer { text: field.text(value), bits: Some(field.bits_of(value)) }
    }

    /// Reads a word of a line. The prefix 0x stands before as many digits as the field has; else its x is an unknown nibble of a word
    /// that is as long as the field.
    fn read(word: &str, field: &LineField, line: usize) -> Result<Answer, ResponsesError> {
        let digits = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X"));
        let text = match digits {
            Some(digits) if digits.len() == field.digits() => digits,
            Some(_) if word.len() != field.digits() => {
                let (name, digits) = (field.name.clone(), field.digits());
                return Err(ResponsesError::Prefix { line, text: word.into(), name, digits });
            }
            _ => word,
        };
        if !text.chars().all(|c| c.is_ascii_hexdigit() || matches!(c, 'x' | 'X' | 'z' | 'Z')) {
            return Err(ResponsesError::Word { line, text: word.into() });
        }
        let known = text.chars().all(|c| c.is_ascii_hexdigit());
        let bits = u128::from_str_radix(text, 16).ok();
        match (known, bits) {
            (true, None) => Err(ResponsesError::Word { line, text: word.into() }),
            _ => Ok(Answer { text: text.into(), bits }),
        }
    }
}

/// Why a text is no answer to vectors.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResponsesError {
    /// Something else than a number.
    #[error("line {line}: \"{text}\" is no hexadecimal number (digits 0 to f, x and z for unknown)")]
    Word {
        /// Line of the text, from 1.
        line: usize,
        /// The word.
        text: String,
    },
    /// A prefix before another number of digits than the field has.
    #[error(
        "line {line}: `{text}`: 0x is no digit; {name} has {digits} hexadecimal digits, with or without 0x before them"
    )]
    Prefix {
        /// Line of the text, from 1.
        line: usize,
        /// The word.
        text: String,
        /// The field.
        name: String,
        /// Its digits.
        digits: usize,
    },
    /// A text that cannot be read.
    #[error("{0}")]
    Read(String),
    /// Too few or too many fields.
    #[error("line {line}: {found} fields; a line holds the {expected} output fields: {names}")]
    Fields {
        /// Line of the text, from 1.
        line: usize,
        /// Fields there.
        found: usize,
        /// Fields of a line.
        expected: usize,
        /// Their names.
        names: String,
    },
    /// Too few or too many lines.
    #[error("{found} lines for {expected} lines of vectors: the device answers each line with one, in order")]
    Lines {
        /// Lines there.
        found: usize,
        /// Lines of the vectors.
        expected: usize,
    },
}

impl From<io::Error> for ResponsesError {
    fn from(error: io::Error) -> ResponsesError {
        ResponsesError::Read(error.to_string())
    }
}

/// Reads what a device answered: a line of output fields for each line of the vectors.
pub struct AnswerReader<'a, R> {
    fields: &'a [LineField],
    lines: TextLines<R>,
}

impl<'a, R: BufRead> AnswerReader<'a, R> {
    /// From the first line on.
    pub fn new(set: &'a Set, reader: R) -> AnswerReader<'a, R> {
        AnswerReader { fields: &set.fields[1], lines: TextLines::new(reader) }
    }

    /// The next line of answers; none behind the last.
    ///
    /// # Errors
    /// What is no answer.
    pub fn answers(&mut self) -> Result<Option<Vec<Answer>>, ResponsesError> {
        while let Some((line, text)) = self.lines.next()? {
            let text = text.split("//").next().unwrap_or_default();
            let found = text.split_whitespace().count();
            if found == 0 {
                continue;
            }
            if found != self.fields.len() {
                let names = self.fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join(" ");
                return Err(ResponsesError::Fields { line, found, expected: self.fields.len(), names });
            }
            let words = text.split_whitespace().zip(self.fields);
            return words.map(|(word, field)| Answer::read(word, field, line)).collect::<Result<_, _>>().map(Some);
        }
        Ok(None)
    }
}

/// A line with what it should give and what it gave.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Input fields.
    pub inputs: Vec<i128>,
    /// Output fields of the definition.
    pub outputs: Vec<i128>,
    /// Those of the device.
    pub answers: Vec<Answer>,
}

/// Where answers differ from the definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// First line that differs, from 0.
    pub line: usize,
    /// Output fields of that line that differ.
    pub fields: Vec<usize>,
    /// How many lines differ.
    pub differ: usize,
    /// Lines that were compared.
    pub of: usize,
    /// The number of the first line of `around`.
    pub from: usize,
    /// Lines before and behind the first that differs, and that one.
    pub around: Vec<Compared>,
}

/// Compares lines one after another, and keeps those around the first that differs.
#[derive(Debug)]
pub struct Comparison<'a> {
    fields: &'a [LineField],
    /// Lines to keep before and behind.
    around: usize,
    before: VecDeque<Compared>,
    first: Option<Mismatch>,
    lines: usize,
}

impl<'a> Comparison<'a> {
    /// Nothing compared; so many lines are kept before and behind the first that differs.
    pub fn new(set: &'a Set, around: usize) -> Comparison<'a> {
        Comparison { fields: &set.fields[1], around, before: VecDeque::new(), first: None, lines: 0 }
    }

    /// Lines so far.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// Compares the next line.
    pub fn push(&mut self, compared: Compared) {
        let line = self.lines;
        self.lines += 1;
        let wrong = |i: &usize| differs(&self.fields[*i], compared.outputs[*i], &compared.answers[*i]);
        let fields: Vec<usize> = (0..self.fields.len()).filter(wrong).collect();
        if let Some(first) = &mut self.first {
            first.differ += usize::from(!fields.is_empty());
            if line <= first.line + self.around {
                first.around.push(compared);
            }
        } else if fields.is_empty() {
            self.before.push_back(compared);
            if self.before.len() > self.around {
                self.before.pop_front();
            }
        } else {
            let from = line - self.before.len();
            let around = self.before.drain(..).chain([compared]).collect();
            self.first = Some(Mismatch { line, fields, differ: 1, of: 0, from, around });
        }
    }

    /// The first mismatch, if there is one.
    pub fn finish(self) -> Option<Mismatch> {
        self.first.map(|first| Mismatch { of: self.lines, ..first })
    }
}

fn differs(field: &LineField, expected: i128, answer: &Answer) -> bool {
    answer.bits != Some(field.bits_of(expected))
}

fn binary(bits: u128, width: u32) -> String {
    format!("{:0width$b}", bits & (u128::MAX >> (128 - width)), width = width as usize)
}

/// The mismatch as an engineer wants it: line number, inputs, every wire of the definition, expected and got in hexadecimal and
/// decimal, with the differing bits marked.
pub fn explain(unit: &dyn Unit, set: &Set, mismatch: &Mismatch) -> String {
    let Mismatch { line, differ, of, .. } = *mismatch;
    let Compared { inputs, outputs, answers } = &mismatch.around[line - mismatch.from];
    let counted = if set.sheet.clocked { "cycle" } else { "transaction" };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {counted} {line} is the first of {differ} that differ, of {of} ({counted}s are counted from 0)",
        set.sheet.name,
    );
    let mut row = |name: &str, value: i128, bits: u32| {
        let hex = LineField { name: String::new(), port: 0, bits, signed: false, range: [0, 0] }.text(value);
        let _ = writeln!(text, "  {name:<28} 0x{hex:<16} {value}");
    };
    for (field, value) in set.fields[0].iter().zip(inputs) {
        row(&field.name, *value, field.bits);
    }
    if !set.sheet.clocked {
        let mut recorder = WireRecorder::default();
        unit.evaluate(&set.format, &set.tables, inputs, &mut recorder);
        let _ = writeln!(text, "wires of the definition");
        for seen in recorder.seen() {
            let Some(wire) = set.sheet.wire(seen.part, seen.name).map(|wire| &set.sheet.wires[wire]) else {
                continue;
            };
            let ends = [0, 1].map(|end| set.format.evaluate(wire.range[end]).unwrap_or(seen.value));
            let row_of = if wire.count == "1" { String::new() } else { format!("[{}]", seen.place) };
            let hex = LineField { name: String::new(), port: 0, bits: bits_of(ends), signed: false, range: [0, 0] };
            let name = wire.path() + &row_of;
            let _ = writeln!(text, "  {name:<28} 0x{:<16} {:<14} {}", hex.text(seen.value), seen.value, wire.formula);
        }
    }
    let _ = writeln!(text, "outputs                         expected                   got");
    for (i, field) in set.fields[1].iter().enumerate() {
        let (expected, got) = (outputs[i], &answers[i]);
        let decimal = got.bits.map_or("unknown".into(), |bits| field.value(bits).to_string());
        let mark = if differs(field, expected, got) { "*" } else { " " };
        let _ = writeln!(
            text,
            "{mark} {:<28} 0x{:<10} {:<12} 0x{:<10} {decimal}",
            field.name,
            field.text(expected),
            expected,
            got.text
        );
        if mark == "*" {
            let expected = expected as u128;
            let _ = writeln!(text, "    expected {}", binary(expected, field.bits));
            if let Some(bits) = got.bits {
                let width = field.bits.max(128 - bits.leading_zeros()) as usize;
                let marks: String = binary(expected ^ bits, field.bits)
                    .chars()
                    .map(|digit| if digit == '1' { '^' } else { ' ' })
                    .collect();
                let _ = writeln!(text, "    got      {bits:0width$b}", width = field.bits as usize);
                let _ = writeln!(text, "             {:>width$}", marks);
            } else {
                let _ = writeln!(text, "    got      {} (x and z are unknown nibbles)", got.text);
            }
        }
    }
    text
}
