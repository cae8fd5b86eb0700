//! Bytes of a file, plain or gzipped as a whole.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};

use flate2::bufread::MultiGzDecoder;

/// The first bytes of a gzip stream.
pub(crate) const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// No byte of a deflate stream gives more than this many: a match of 258 takes two bits.
const MOST_INFLATED: u64 = 1032;

/// Bytes that can be read line by line and searched.
trait Plain: BufRead + Seek + Send {}

impl Plain for BufReader<File> {}
impl Plain for Cursor<&[u8]> {}

/// A file, or bytes in memory; unpacked on the way where it is gzipped as a whole.
pub(crate) struct Source<'a>(Kind<'a>);

enum Kind<'a> {
    Plain(Box<dyn Plain + 'a>),
    Packed { stream: Box<BufReader<MultiGzDecoder<Box<dyn Plain + 'a>>>>, most: u64 },
}

/// How many bytes a source still has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Left {
    Exactly(u64),
    AtMost(u64),
}

impl Left {
    /// The most that can come.
    pub fn most(self) -> u64 {
        match self {
            Left::Exactly(bytes) | Left::AtMost(bytes) => bytes,
        }
    }

    /// The same, unpacked by a decoder.
    pub fn inflated(self) -> Left {
        Left::AtMost(self.most().saturating_mul(MOST_INFLATED))
    }
}

impl<'a> Source<'a> {
    /// A file; with `unpack` one that begins as a gzip stream does is unpacked.
    pub fn of_file(file: File, unpack: bool) -> std::io::Result<Source<'static>> {
        Source::new(BufReader::with_capacity(1 << 18, file), unpack)
    }

    /// Bytes in memory, likewise.
    pub fn of_bytes(bytes: &'a [u8], unpack: bool) -> std::io::Result<Source<'a>> {
        Source::new(Cursor::new(bytes), unpack)
    }

    fn new(mut plain: impl Plain + 'a, unpack: bool) -> std::io::Result<Source<'a>> {
        // A short file's first bytes are all there is in the buffer.
        if unpack && plain.fill_buf()?.starts_with(&GZIP_MAGIC) {
            let mut plain: Box<dyn Plain + 'a> = Box::new(plain);
            let most = Left::Exactly(length(&mut plain)?).inflated().most();
            let stream = Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(plain)));
            return Ok(Source(Kind::Packed { stream, most }));
        }
        Ok(Source(Kind::Plain(Box::new(plain))))
    }

    /// Whether the file is gzipped as a whole.
    pub fn is_packed(&self) -> bool {
        matches!(self.0, Kind::Packed { .. })
    }

    /// The bytes from here to the end.
    pub fn left(&mut self) -> std::io::Result<Left> {
        match &mut self.0 {
            Kind::Plain(plain) => {
                let here = plain.stream_position()?;
                let end = length(plain)?;
                Ok(Left::Exactly(end.saturating_sub(here)))
            }
            Kind::Packed { most, .. } => Ok(Left::AtMost(*most)),
        }
    }

    /// Passes over `count` bytes; how many there were.
    pub fn pass_over(&mut self, count: u64) -> std::io::Result<u64> {
        match &mut self.0 {
            Kind::Plain(plain) => {
                let here = plain.stream_position()?;
                let passed = count.min(length(plain)?.saturating_sub(here));
                plain.seek(SeekFrom::Start(here + passed))?;
                Ok(passed)
            }
            Kind::Packed { stream, .. } => std::io::copy(&mut stream.take(count), &mut std::io::sink()),
        }
    }

    /// Passes over one line; false at the end of the file.
    pub fn pass_line(&mut self) -> std::io::Result<bool> {
        let mut any = false;
        loop {
            let bytes = self.fill_buf()?;
            if bytes.is_empty() {
                return Ok(any);
            }
            any = true;
            let end = bytes.iter().position(|&b| b == b'\n');
            let used = end.map_or(bytes.len(), |e| e + 1);
            self.consume(used);
            if end.is_some() {
                return Ok(true);
            }
        }
    }
}

/// The length of the whole; the place stays.
fn length(plain: &mut (impl Seek + ?Sized)) -> std::io::Result<u64> {
    let here = plain.stream_position()?;
    let end = plain.seek(SeekFrom::End(0))?;
    if here != end {
        plain.seek(SeekFrom::Start(here))?;
    }
    Ok(end)
}

impl Read for Source<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        match &mut self.0 {
            Kind::Plain(plain) => plain.read(bytes),
            Kind::Packed { stream, .. } => stream.read(bytes),
        }
    }
}

impl BufRead for Source<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        match &mut self.0 {
            Kind::Plain(plain) => plain.fill_buf(),
            Kind::Packed { stream, .. } => stream.fill_buf(),
        }
    }

    fn consume(&mut self, amount: usize) {
        match &mut self.0 {
            Kind::Plain(plain) => plain.consume(amount),
            Kind::Packed { stream, .. } => stream.consume(amount),
        }
    }
}

/// Reads until `bytes` is full or the stream ends; how many bytes came.
pub(crate) fn read_full(stream: &mut (impl Read + ?Sized), bytes: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < bytes.len() {
        match stream.read(&mut bytes[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(filled)
}
