//! Lines of a text, one after another.

use std::io::{self, BufRead, Read};

/// Bytes of the longest line that is read: the widest line of vectors has half a million.
const LONGEST: u64 = 16 << 20;

/// Lines of a text, numbered from 1.
pub(crate) struct TextLines<R> {
    reader: R,
    number: usize,
    text: String,
}

impl<R: BufRead> TextLines<R> {
    /// From the first line on.
    pub(crate) fn new(reader: R) -> TextLines<R> {
        TextLines { reader, number: 0, text: String::new() }
    }

    /// The next line and its number, without what ends it; none behind the last.
    pub(crate) fn next(&mut self) -> io::Result<Option<(usize, &str)>> {
        self.text.clear();
        self.number += 1;
        let read = self.reader.by_ref().take(LONGEST).read_line(&mut self.text)?;
        if read as u64 == LONGEST && !self.text.ends_with('\n') {
            return Err(io::Error::other(format!("line {}: it is longer than {LONGEST} bytes", self.number)));
        }
        let text = self.text.strip_suffix('\n').unwrap_or(&self.text);
        Ok((read > 0).then_some((self.number, text.strip_suffix('\r').unwrap_or(text))))
    }
}
