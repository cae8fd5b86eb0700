//! Numbers of one or several data files, one after another, decoded.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use crate::VolumeError;
use crate::layout::{Encoding, Layout, Skip};
use crate::place::{Place, open};
use crate::samples::swap_bytes;
use crate::source::{GZIP_MAGIC, Left, Source, read_full};
use crate::text::{HexBytes, Numbers, clip};

/// Where the voxel numbers are.
pub(crate) enum Data<'a> {
    /// Behind the header.
    Here(Source<'a>),
    /// In files of their own, each with the same number of them.
    Beside { files: Vec<PathBuf>, unpack: bool },
}

/// The numbers of all data files, as one stream.
pub(crate) struct Parts<'a> {
    layout: &'a Layout,
    data: VecDeque<Part<'a>>,
    /// Numbers of each file.
    each: u64,
    stream: Option<Stream<'a>>,
    /// Numbers that the open file has still to give.
    left: u64,
    /// Numbers that it has given.
    given: u64,
    /// Numbers given by all.
    all: u64,
    /// Whether bytes are unpacked on the way.
    packed: bool,
    place: Place,
}

enum Part<'a> {
    Open(Source<'a>),
    File(PathBuf, bool),
}

enum Stream<'a> {
    Plain(Source<'a>),
    Packed(Box<dyn Read + Send + 'a>),
    Text(Numbers<Source<'a>>),
}

impl<'a> Parts<'a> {
    /// `total` numbers in all.
    pub fn new(layout: &'a Layout, data: Data<'a>, total: u64, place: &Place) -> Result<Self, VolumeError> {
        let packed = match &data {
            Data::Here(source) => source.is_packed(),
            Data::Beside { unpack, .. } => *unpack,
        };
        let data: VecDeque<Part> = match data {
            Data::Here(source) => VecDeque::from([Part::Open(source)]),
            Data::Beside { files, unpack } => files.into_iter().map(|file| Part::File(file, unpack)).collect(),
        };
        let files = data.len() as u64;
        if files == 0 || !total.is_multiple_of(files) {
            return Err(place.wrong(
                "data files",
                format!("{total} numbers in {files} files"),
                "name one file for each slice, or for as many axes as the header says",
            ));
        }
        let place = place.clone();
        let each = total / files;
        Ok(Self { layout, data, each, stream: None, left: 0, given: 0, all: 0, packed, place })
    }

    /// Whether the numbers stand in the files as they are.
    pub fn is_plain(&self) -> bool {
        self.layout.encoding == Encoding::Raw && !self.packed
    }

    /// Passes over numbers; whole files are not opened for it.
    pub fn pass_over(&mut self, mut count: u64) -> Result<(), VolumeError> {
        while count > 0 {
            if self.left == 0 {
                if count >= self.each && self.data.len() > 1 {
                    self.data.pop_front();
                    self.all += self.each;
                    count -= self.each;
                    continue;
                }
                self.open_next()?;
            }
            let some = count.min(self.left);
            let size = self.layout.stored.bytes() as u64;
            match self.stream.as_mut() {
                Some(Stream::Text(numbers)) => {
                    for passed in 0..some {
                        if numbers.next().map_err(|e| self.place.io("read", e))?.is_none() {
                            return Err(self.short(passed));
                        }
                    }
                }
                Some(Stream::Plain(source)) => {
                    let passed = source.pass_over(some * size).map_err(|e| self.place.io("read", e))?;
                    if passed < some * size {
                        return Err(self.short(passed));
                    }
                }
                Some(Stream::Packed(stream)) => {
                    let mut some = stream.take(some * size);
                    let passed = std::io::copy(&mut some, &mut std::io::sink());
                    let passed = passed.map_err(|e| self.place.io("read", e))?;
                    if some.limit() > 0 {
                        return Err(self.short(passed));
                    }
                }
                None => {}
            }
            self.count(some);
            count -= some;
        }
        Ok(())
    }

    /// Fills `bytes`, which are those of whole numbers of the stored type, in this machine's byte order.
    pub fn fill(&mut self, bytes: &mut [u8]) -> Result<(), VolumeError> {
        let size = self.layout.stored.bytes();
        debug_assert!(bytes.len().is_multiple_of(size), "whole numbers");
        let mut filled = 0;
        while filled < bytes.len() {
            if self.left == 0 {
                self.open_next()?;
            }
            let some = (((bytes.len() - filled) / size) as u64).min(self.left) as usize;
            let out = &mut bytes[filled..filled + some * size];
            match self.stream.as_mut() {
                Some(Stream::Text(text)) => {
                    for (i, number) in out.chunks_exact_mut(size).enumerate() {
                        let Some(word) = text.next().map_err(|e| self.place.io("read", e))? else {
                            return Err(self.short(i as u64));
                        };
                        self.layout.stored.parse(word, number).ok_or_else(|| {
                            let word = clip(word);
                            self.layout.does_not_fit(&word, self.all + i as u64, &self.place)
                        })?;
                    }
                }
                Some(Stream::Plain(stream)) => {
                    let got = read_full(stream, out);
                    self.given_bytes(got, out)?;
                }
                Some(Stream::Packed(stream)) => {
                    let got = read_full(stream, out);
                    self.given_bytes(got, out)?;
                }
                None => {}
            }
            self.count(some as u64);
            filled += out.len();
        }
        Ok(())
    }

    /// At the end of a compressed stream its checksum is compared.
    pub fn finish(&mut self) -> Result<(), VolumeError> {
        if self.left > 0 {
            return Ok(());
        }
        let more = match self.stream.take() {
            Some(Stream::Packed(mut stream)) => read_full(&mut stream, &mut [0]),
            Some(Stream::Plain(mut source)) if source.is_packed() => read_full(&mut source, &mut [0]),
            _ => Ok(0),
        };
        let more = match more {
            // What follows a whole member and is no other is passed over, as gzip does: padding.
            Err(error) if error.to_string() == "invalid gzip header" => 0,
            more => more.map_err(|e| self.place.io("read", e))?,
        };
        if more > 0 && self.layout.last {
            let given = self.given * self.layout.stored.bytes() as u64;
            return Err(self.place.wrong(
                "voxel data",
                format!("more than the {given} bytes of the layout"),
                "correct the dimensions, the type or the bytes to skip",
            ));
        }
        Ok(())
    }

    /// What `read_full` gave for `out`.
    fn given_bytes(&self, got: std::io::Result<usize>, out: &mut [u8]) -> Result<(), VolumeError> {
        let got = got.map_err(|e| self.place.io("read", e))?;
        if got < out.len() {
            return Err(self.short(got as u64));
        }
        if self.layout.big_endian != cfg!(target_endian = "big") {
            swap_bytes(out, self.layout.stored.bytes());
        }
        Ok(())
    }

    fn count(&mut self, numbers: u64) {
        self.left -= numbers;
        self.given += numbers;
        self.all += numbers;
    }

    /// The open file ends `more` bytes (or numbers of text) behind what it has given.
    fn short(&self, more: u64) -> VolumeError {
        let (size, unit) = match self.layout.encoding {
            Encoding::Text => (1, "numbers"),
            _ => (self.layout.stored.bytes() as u64, "bytes"),
        };
        let (promised, found) = (self.each.saturating_mul(size), self.given * size + more);
        VolumeError::Truncated { file: self.place.file.clone(), promised, found, unit }
    }

    /// Opens the next file up to its first number, and holds its length against what is promised.
    fn open_next(&mut self) -> Result<(), VolumeError> {
        self.finish()?;
        let mut source = match self.data.pop_front() {
            Some(Part::Open(source)) => source,
            Some(Part::File(path, unpack)) => {
                let (source, place) = open(&path, unpack)?;
                self.place = place;
                source
            }
            None => return Err(self.short(0)),
        };
        (self.left, self.given) = (self.each, 0);
        let place = &self.place;
        for passed in 0..self.layout.lines {
            if !source.pass_line().map_err(|e| place.io("read", e))? {
                return Err(VolumeError::Truncated {
                    file: place.file.clone(),
                    promised: self.layout.lines,
                    found: passed,
                    unit: "lines to skip",
                });
            }
        }
        let promised = self.each.saturating_mul(self.layout.stored.bytes() as u64);
        let left = source.left().map_err(|e| place.io("read", e))?;
        self.stream = Some(match self.layout.encoding {
            Encoding::Raw => {
                match (self.layout.skip, left) {
                    (Skip::Bytes(skip), _) => skip_bytes(skip, source.pass_over(skip), place)?,
                    (Skip::ToEnd, Left::Exactly(left)) if left >= promised => {
                        source.pass_over(left - promised).map(|_| ()).map_err(|e| place.io("read", e))?;
                    }
                    (Skip::ToEnd, Left::Exactly(_)) => {}
                    (Skip::ToEnd, Left::AtMost(_)) => {
                        return Err(place.unsupported(
                            "voxel data",
                            "counting from the end of a file that is gzipped as a whole",
                            "unpack it, or give the bytes to skip",
                        ));
                    }
                }
                check_length(promised, source.left().map_err(|e| place.io("read", e))?, place)?;
                Stream::Plain(source)
            }
            Encoding::Gzip | Encoding::Zlib => {
                check_length(promised, left.inflated(), place)?;
                // MetaImage says "compressed" of both.
                let head = source.fill_buf().map_err(|e| place.io("read", e))?;
                let gzip = self.layout.encoding == Encoding::Gzip || head.starts_with(&GZIP_MAGIC);
                let mut stream: Box<dyn Read + Send> = match gzip {
                    true => Box::new(MultiGzDecoder::new(source)),
                    false => Box::new(ZlibDecoder::new(source)),
                };
                if let Skip::Bytes(skip @ 1..) = self.layout.skip {
                    skip_bytes(skip, std::io::copy(&mut (&mut stream).take(skip), &mut std::io::sink()), place)?;
                }
                Stream::Packed(stream)
            }
            Encoding::Hex => Stream::Packed(Box::new(BufReader::new(HexBytes::new(source)))),
            Encoding::Text => {
                if let Skip::Bytes(skip) = self.layout.skip {
                    skip_bytes(skip, source.pass_over(skip), place)?;
                }
                Stream::Text(Numbers::new(source))
            }
        });
        Ok(())
    }
}

fn skip_bytes(skip: u64, passed: std::io::Result<u64>, place: &Place) -> Result<(), VolumeError> {
    let found = passed.map_err(|e| place.io("read", e))?;
    if found < skip {
        return Err(VolumeError::Truncated { file: place.file.clone(), promised: skip, found, unit: "bytes to skip" });
    }
    Ok(())
}

/// Refuses a file that cannot hold what is promised, whatever it unpacks to.
fn check_length(promised: u64, left: Left, place: &Place) -> Result<(), VolumeError> {
    match left {
        Left::Exactly(found) if found < promised => {
            Err(VolumeError::Truncated { file: place.file.clone(), promised, found, unit: "bytes" })
        }
        Left::AtMost(most) if most < promised => {
            Err(VolumeError::CannotHold { file: place.file.clone(), promised, most })
        }
        _ => Ok(()),
    }
}
