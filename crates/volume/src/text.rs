//! Text in volume files: header lines, lists of numbers, voxels written as text.

use std::io::{BufRead, Read};
use std::str::FromStr;

use crate::VolumeError;
use crate::place::Place;

/// The longest header line, in bytes.
const LINE_LIMIT: usize = 1 << 16;
/// The longest header, in lines.
const LINES_LIMIT: usize = 1 << 14;
/// The longest number, in bytes.
const NUMBER_LIMIT: usize = 128;

/// The lines of a header, counted from 1, each without its line end.
pub(crate) struct HeaderLines<'a> {
    source: &'a mut dyn BufRead,
    place: &'a Place,
    /// The number of the last line given, from 1.
    pub line: usize,
}

impl<'a> HeaderLines<'a> {
    pub fn new(source: &'a mut dyn BufRead, place: &'a Place) -> Self {
        Self { source, place, line: 0 }
    }

    /// The next line, or `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<String>, VolumeError> {
        self.line += 1;
        let too_long = |what: &str| {
            self.place.wrong(
                format!("line {}", self.line),
                format!("the header is too long ({what})"),
                "this is no volume header; give the file's real format",
            )
        };
        if self.line > LINES_LIMIT {
            return Err(too_long("more than 16384 lines"));
        }
        let mut bytes = Vec::new();
        let mut limited = std::io::Read::take(&mut *self.source, LINE_LIMIT as u64);
        let count = limited.read_until(b'\n', &mut bytes).map_err(|e| self.place.io("read", e))?;
        if count == 0 {
            return Ok(None);
        }
        if count == LINE_LIMIT && bytes.last() != Some(&b'\n') {
            return Err(too_long("a line of more than 65536 bytes"));
        }
        if bytes.last() == Some(&b'\n') {
            bytes.pop();
        }
        if bytes.last() == Some(&b'\r') {
            bytes.pop();
        }
        Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
    }
}

/// One header field with its place, whose value is to be understood.
pub(crate) struct Field<'a> {
    pub place: &'a Place,
    pub name: &'a str,
    pub line: usize,
    pub value: &'a str,
}

impl Field<'_> {
    /// An error in this field.
    pub fn wrong(&self, reason: impl Into<String>, remedy: impl Into<String>) -> VolumeError {
        self.place.wrong(self.at(), reason, remedy)
    }

    /// What this field asks for and does not get.
    pub fn unsupported(&self, what: impl Into<String>, remedy: impl Into<String>) -> VolumeError {
        self.place.unsupported(self.at(), what, remedy)
    }

    fn at(&self) -> String {
        format!("line {}, '{}'", self.line, self.name)
    }

    /// The value as one number.
    pub fn number<T: FromStr>(&self, remedy: &str) -> Result<T, VolumeError> {
        self.one(self.value, remedy)
    }

    fn one<T: FromStr>(&self, word: &str, remedy: &str) -> Result<T, VolumeError> {
        let word = word.trim();
        word.parse().map_err(|_| self.wrong(format!("cannot use '{}'", clip(word)), remedy))
    }

    /// The value as numbers with blanks between, `count` of them if given.
    pub fn numbers<T: FromStr>(&self, count: Option<usize>, remedy: &str) -> Result<Vec<T>, VolumeError> {
        let numbers: Vec<T> = self.value.split_whitespace().map(|w| self.one(w, remedy)).collect::<Result<_, _>>()?;
        match count {
            Some(c) if c != numbers.len() => Err(self.wrong(format!("{} values for {c} axes", numbers.len()), remedy)),
            _ => Ok(numbers),
        }
    }

    /// The dimensions of a grid: whole numbers, at least 1.
    pub fn sizes(&self, count: usize) -> Result<Vec<usize>, VolumeError> {
        let remedy = "give one whole number, at least 1, for each axis";
        let sizes: Vec<usize> = self.numbers(Some(count), remedy)?;
        if sizes.contains(&0) {
            return Err(self.wrong("a size of 0", remedy));
        }
        Ok(sizes)
    }

    /// One vector `(a,b,c)` from the front of `text`, and the rest.
    pub fn vector<'t>(&self, text: &'t str) -> Result<(Vec<f64>, &'t str), VolumeError> {
        let remedy = "write vectors as (x,y,z)";
        let body = text.trim_start().strip_prefix('(').and_then(|t| t.split_once(')'));
        let Some((inside, rest)) = body else {
            return Err(self.wrong(format!("'{}' is no vector", clip(text)), remedy));
        };
        let vector = inside.split(',').map(|w| self.one(w, remedy)).collect::<Result<Vec<f64>, _>>()?;
        if vector.len() > 16 {
            return Err(self.wrong("a vector of more than 16 numbers", remedy));
        }
        Ok((vector, rest))
    }
}

/// The first characters of foreign text, for a message.
pub(crate) fn clip(text: &str) -> String {
    let mut short: String = text.chars().take(60).map(|c| if c.is_control() { '?' } else { c }).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// Numbers written as text, with blanks or commas between.
pub(crate) struct Numbers<R> {
    source: R,
    word: Vec<u8>,
}

impl<R: BufRead> Numbers<R> {
    pub fn new(source: R) -> Self {
        Self { source, word: Vec::new() }
    }

    /// The next number as text; `None` at the end. A word that is too long for a number is cut.
    pub fn next(&mut self) -> std::io::Result<Option<&str>> {
        self.word.clear();
        loop {
            let bytes = match self.source.fill_buf() {
                Ok(bytes) => bytes,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(e) => return Err(e),
            };
            if bytes.is_empty() {
                break;
            }
            let separates = |b: &u8| b.is_ascii_whitespace() || *b == b',';
            let mut used = 0;
            let mut ended = false;
            if self.word.is_empty() {
                used = bytes.iter().position(|b| !separates(b)).unwrap_or(bytes.len());
            }
            let rest = &bytes[used..];
            let length = rest.iter().position(separates).unwrap_or(rest.len());
            let room = NUMBER_LIMIT.saturating_sub(self.word.len());
            self.word.extend_from_slice(&rest[..length.min(room)]);
            if length < rest.len() {
                ended = !self.word.is_empty();
            }
            used += length;
            self.source.consume(used);
            if ended {
                break;
            }
        }
        if self.word.is_empty() {
            return Ok(None);
        }
        Ok(Some(std::str::from_utf8(&self.word).unwrap_or("(not text)")))
    }
}

/// Bytes written as two hexadecimal digits each, with blanks anywhere between.
pub(crate) struct HexBytes<R> {
    source: R,
}

impl<R: BufRead> HexBytes<R> {
    pub fn new(source: R) -> Self {
        Self { source }
    }

    /// The value of the next digit; `None` at the end.
    fn digit(&mut self) -> std::io::Result<Option<u8>> {
        loop {
            let Some(&byte) = self.source.fill_buf()?.first() else { return Ok(None) };
            self.source.consume(1);
            if let Some(digit) = char::from(byte).to_digit(16) {
                return Ok(Some(digit as u8));
            }
            if !byte.is_ascii_whitespace() {
                let reason = format!("'{}' is no hexadecimal digit", byte.escape_ascii());
                return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, reason));
            }
        }
    }
}

impl<R: BufRead> Read for HexBytes<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        for (i, byte) in bytes.iter_mut().enumerate() {
            let Some(high) = self.digit()? else { return Ok(i) };
            let Some(low) = self.digit()? else { return Ok(i) };
            *byte = high << 4 | low;
        }
        Ok(bytes.len())
    }
}
