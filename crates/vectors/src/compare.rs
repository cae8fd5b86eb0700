//! The answers of a device under test, and where they are wrong first.

use crate::{Field, Recorder, Unit, Vectors, bits_of};
use std::fmt::Write;

/// A field of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// As it was written.
    pub text: String,
    /// Its bits; none where a digit is unknown (x or z).
    pub bits: Option<u128>,
}

/// What a device answered: a line of output fields for each line of the vectors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Responses {
    /// The lines.
    pub lines: Vec<Vec<Answer>>,
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

impl Responses {
    /// Reads answers to vectors.
    ///
    /// # Errors
    /// What is no answer.
    pub fn parse(text: &str, vectors: &Vectors) -> Result<Responses, ResponsesError> {
        let fields = &vectors.fields[1];
        let mut lines = Vec::new();
        for (number, text) in text.lines().enumerate() {
            let line = number + 1;
            let text = text.split("//").next().unwrap_or_default();
            let answer = |text: &str| {
                let known = u128::from_str_radix(text, 16).ok();
                let unknown = text.chars().all(|c| c.is_ascii_hexdigit() || matches!(c, 'x' | 'X' | 'z' | 'Z'));
                match known {
                    None if !unknown => Err(ResponsesError::Word { line, text: text.into() }),
                    bits => Ok(Answer { text: text.into(), bits }),
                }
            };
            let words: Vec<Answer> = text.split_whitespace().map(answer).collect::<Result<_, _>>()?;
            if words.is_empty() {
                continue;
            }
            if words.len() != fields.len() {
                let names = fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join(" ");
                return Err(ResponsesError::Fields { line, found: words.len(), expected: fields.len(), names });
            }
            lines.push(words);
        }
        if lines.len() != vectors.inputs.len() {
            return Err(ResponsesError::Lines { found: lines.len(), expected: vectors.inputs.len() });
        }
        Ok(Responses { lines })
    }

    /// Answers from values.
    pub fn from_values(vectors: &Vectors, lines: &[Vec<i128>]) -> Responses {
        let answer = |(field, value): (&Field, &i128)| {
            let text = field.text(*value);
            let bits = u128::from_str_radix(&text, 16).ok();
            Answer { text, bits }
        };
        let fields = &vectors.fields[1];
        Responses { lines: lines.iter().map(|line| fields.iter().zip(line).map(answer).collect()).collect() }
    }
}

/// Where answers differ from the definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// First line that differs, from 0.
    pub line: usize,
    /// Output fields of that line that differ.
    pub fields: Vec<usize>,
    /// How many lines differ.
    pub lines: usize,
}

fn differs(field: &Field, expected: i128, answer: &Answer) -> bool {
    answer.bits != Some(expected as u128 & (u128::MAX >> (128 - field.bits)))
}

/// The first mismatch, if there is one.
pub fn first_mismatch(vectors: &Vectors, responses: &Responses) -> Option<Mismatch> {
    let fields = &vectors.fields[1];
    let wrong = |line: usize| -> Vec<usize> {
        let (expected, got) = (&vectors.outputs[line], &responses.lines[line]);
        (0..fields.len()).filter(|&i| differs(&fields[i], expected[i], &got[i])).collect()
    };
    let count = vectors.outputs.len().min(responses.lines.len());
    let mut lines = (0..count).filter_map(|line| Some((line, wrong(line))).filter(|(_, fields)| !fields.is_empty()));
    let (line, fields) = lines.next()?;
    Some(Mismatch { line, fields, lines: 1 + lines.count() })
}

fn binary(bits: u128, width: u32) -> String {
    format!("{:0width$b}", bits & (u128::MAX >> (128 - width)), width = width as usize)
}

/// The mismatch as an engineer wants it: line number, inputs, every wire of the definition, expected and got in hexadecimal and
/// decimal, with the differing bits marked.
pub fn explain(unit: &dyn Unit, vectors: &Vectors, responses: &Responses, mismatch: &Mismatch) -> String {
    let Mismatch { line, lines, .. } = *mismatch;
    let counted = if vectors.sheet.clocked { "cycle" } else { "transaction" };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {counted} {line} is the first of {lines} that differ, of {} ({counted}s are counted from 0)",
        vectors.sheet.name,
        vectors.inputs.len()
    );
    let mut row = |name: &str, value: i128, bits: u32| {
        let hex = Field { name: String::new(), port: 0, bits, signed: false, range: [0, 0] }.text(value);
        let _ = writeln!(text, "  {name:<28} 0x{hex:<16} {value}");
    };
    let inputs = vectors.fields[0].iter().zip(&vectors.inputs[line]);
    for (field, value) in inputs {
        row(&field.name, *value, field.bits);
    }
    if !vectors.sheet.clocked {
        let mut recorder = Recorder::default();
        unit.evaluate(&vectors.format, &vectors.tables, &vectors.inputs[line], &mut recorder);
        let _ = writeln!(text, "wires of the definition");
        for seen in recorder.seen() {
            let Some(wire) = vectors.sheet.wire(seen.part, seen.name).map(|wire| &vectors.sheet.wires[wire]) else {
                continue;
            };
            let ends = [0, 1].map(|end| vectors.format.evaluate(wire.range[end]).unwrap_or(seen.value));
            let row_of = if wire.count == "1" { String::new() } else { format!("[{}]", seen.place) };
            let hex = Field { name: String::new(), port: 0, bits: bits_of(ends), signed: false, range: [0, 0] };
            let name = wire.path() + &row_of;
            let _ = writeln!(text, "  {name:<28} 0x{:<16} {:<14} {}", hex.text(seen.value), seen.value, wire.formula);
        }
    }
    let _ = writeln!(text, "outputs                         expected                   got");
    for (i, field) in vectors.fields[1].iter().enumerate() {
        let (expected, got) = (vectors.outputs[line][i], &responses.lines[line][i]);
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
                let _ = writeln!(text, "    got      {} (x and z are unknown)", got.text);
            }
        }
    }
    text
}
