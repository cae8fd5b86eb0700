//! Voxel numbers from a stream of bytes into typed memory, never two copies at once.
//!
//! Memory follows the bytes that have really come: where the file's length is known (raw encoding)
//! the header is compared with it first and the whole is reserved at once; from a compressed stream
//! or text the vector grows as numbers come out.

use std::io::{BufRead, ErrorKind, Read, SeekFrom};

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use crate::limits::{reserve, sample_count};
use crate::place::{Place, Source};
use crate::samples::Stored;
use crate::text::{Numbers, clip};
use crate::{ReadOptions, Sample, SampleType, Samples, VolumeError};

/// Bytes read in one go.
const CHUNK_BYTES: usize = 1 << 20;

/// The number type in a file: one of the eight, or a 64-bit integer, which is kept in 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StoredType {
    Plain(SampleType),
    I64,
    U64,
}

impl StoredType {
    pub fn bytes(self) -> usize {
        match self {
            StoredType::Plain(t) => t.bytes(),
            StoredType::I64 | StoredType::U64 => 8,
        }
    }
}

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw,
    Gzip,
    Zlib,
    Text,
}

/// What lies before the first number, in bytes of the decoded stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Skip {
    Bytes(u64),
    /// The numbers are the last bytes of the file (raw encoding only).
    ToEnd,
}

/// Where the voxel numbers lie and how they are written.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub dims: [usize; 3],
    pub stored: StoredType,
    pub big_endian: bool,
    pub encoding: Encoding,
    pub skip: Skip,
    /// How many volumes lie one after another.
    pub frames: u64,
    /// value = number·slope + intercept.
    pub scale: Option<[f64; 2]>,
}

impl Layout {
    /// The type in memory.
    pub fn kept(&self) -> SampleType {
        use SampleType::*;
        match (self.stored, self.scale) {
            (StoredType::Plain(t), None) => t,
            (StoredType::I64, None) => I32,
            (StoredType::U64, None) => U32,
            (StoredType::Plain(U8 | I8 | U16 | I16 | F32), Some(_)) => F32,
            (_, Some(_)) => F64,
        }
    }

    /// Reads the numbers of one volume from `source`, which stands where the data begin.
    pub fn read(&self, source: &mut dyn Source, options: &ReadOptions, place: &Place) -> Result<Samples, VolumeError> {
        let frame = options.frame as u64;
        if frame >= self.frames {
            return Err(VolumeError::Parameter {
                name: "frame",
                reason: format!("frame {frame} of a file of {} volumes", self.frames),
                remedy: "frames count from 0",
            });
        }
        let count = sample_count(self.dims, self.kept(), options.limit(), &place.file)?;
        let frame_bytes = (count as u64).saturating_mul(self.stored.bytes() as u64);
        let before = frame_bytes.saturating_mul(frame);
        let job = Job { layout: self, count, place, length_known: self.encoding == Encoding::Raw };
        match self.encoding {
            Encoding::Raw => {
                let skip = self.find_start(source, frame_bytes, place)?;
                let start = skip.saturating_add(before);
                source.seek(SeekFrom::Start(start)).map_err(|e| place.io("read", e))?;
                job.decode(source)
            }
            Encoding::Gzip => job.inflate(MultiGzDecoder::new(source), self.skip_then(before)),
            Encoding::Zlib => job.inflate(ZlibDecoder::new(source), self.skip_then(before)),
            Encoding::Text => {
                if let Skip::Bytes(skip) = self.skip {
                    job.pass_over(source, skip)?;
                }
                job.parse(source, frame.saturating_mul(count as u64))
            }
        }
    }

    fn skip_then(&self, before: u64) -> u64 {
        match self.skip {
            Skip::Bytes(skip) => skip.saturating_add(before),
            Skip::ToEnd => before,
        }
    }

    /// Where in the file the first volume begins; an error if the file is too short for all.
    fn find_start(&self, source: &mut dyn Source, frame_bytes: u64, place: &Place) -> Result<u64, VolumeError> {
        let here = source.stream_position().map_err(|e| place.io("read", e))?;
        let end = source.seek(SeekFrom::End(0)).map_err(|e| place.io("read", e))?;
        let promised = frame_bytes.saturating_mul(self.frames);
        let start = match self.skip {
            Skip::Bytes(skip) => here.saturating_add(skip),
            Skip::ToEnd => end.saturating_sub(promised).max(here),
        };
        let found = end.saturating_sub(start);
        if found < promised {
            return Err(truncated(place, promised, found));
        }
        Ok(start)
    }
}

fn truncated(place: &Place, promised: u64, found: u64) -> VolumeError {
    VolumeError::Truncated { file: place.file.clone(), promised, found, unit: "bytes" }
}

/// The reading of one volume.
struct Job<'a> {
    layout: &'a Layout,
    count: usize,
    place: &'a Place,
    length_known: bool,
}

/// Runs one call for the Rust types of a stored and a kept number.
macro_rules! for_stored {
    ($stored:expr, $number:ident => $body:expr) => {
        match $stored {
            StoredType::Plain(SampleType::U8) => {
                type $number = u8;
                $body
            }
            StoredType::Plain(SampleType::I8) => {
                type $number = i8;
                $body
            }
            StoredType::Plain(SampleType::U16) => {
                type $number = u16;
                $body
            }
            StoredType::Plain(SampleType::I16) => {
                type $number = i16;
                $body
            }
            StoredType::Plain(SampleType::U32) => {
                type $number = u32;
                $body
            }
            StoredType::Plain(SampleType::I32) => {
                type $number = i32;
                $body
            }
            StoredType::Plain(SampleType::F32) => {
                type $number = f32;
                $body
            }
            StoredType::Plain(SampleType::F64) => {
                type $number = f64;
                $body
            }
            StoredType::I64 => {
                type $number = i64;
                $body
            }
            StoredType::U64 => {
                type $number = u64;
                $body
            }
        }
    };
}

/// A stored number that is kept as it is.
trait Kept: Stored + Sample {}
impl<T: Stored + Sample> Kept for T {}

impl Job<'_> {
    /// Numbers from a decompressed stream, which must then end well.
    fn inflate(&self, mut stream: impl Read, skip: u64) -> Result<Samples, VolumeError> {
        self.pass_over(&mut stream, skip)?;
        let samples = self.decode(&mut stream)?;
        // At the end of the stream the decoder compares its checksum.
        read_full(&mut stream, &mut [0]).map_err(|e| self.failed(e))?;
        Ok(samples)
    }

    fn pass_over(&self, stream: &mut (impl Read + ?Sized), skip: u64) -> Result<(), VolumeError> {
        let passed = std::io::copy(&mut stream.take(skip), &mut std::io::sink()).map_err(|e| self.failed(e))?;
        if passed < skip {
            return Err(truncated(self.place, skip, passed));
        }
        Ok(())
    }

    /// Numbers from plain bytes.
    fn decode(&self, stream: &mut (impl Read + ?Sized)) -> Result<Samples, VolumeError> {
        fn kept<T: Kept>(job: &Job, stream: &mut (impl Read + ?Sized)) -> Result<Samples, VolumeError> {
            Ok(T::wrap(job.decode_in_place::<T>(stream)?))
        }
        use SampleType::*;
        let Some([slope, intercept]) = self.layout.scale else {
            return match self.layout.stored {
                StoredType::Plain(U8) => kept::<u8>(self, stream),
                StoredType::Plain(I8) => kept::<i8>(self, stream),
                StoredType::Plain(U16) => kept::<u16>(self, stream),
                StoredType::Plain(I16) => kept::<i16>(self, stream),
                StoredType::Plain(U32) => kept::<u32>(self, stream),
                StoredType::Plain(I32) => kept::<i32>(self, stream),
                StoredType::Plain(F32) => kept::<f32>(self, stream),
                StoredType::Plain(F64) => kept::<f64>(self, stream),
                StoredType::I64 => self.decode_converted(stream, |n: i64| i32::try_from(n).ok()).map(Samples::I32),
                StoredType::U64 => self.decode_converted(stream, |n: u64| u32::try_from(n).ok()).map(Samples::U32),
            };
        };
        for_stored!(self.layout.stored, Number => {
            if self.layout.kept() == F32 {
                let scaled = |n: Number| Some((n.double() * slope + intercept) as f32);
                self.decode_converted(stream, scaled).map(Samples::F32)
            } else {
                let scaled = |n: Number| Some(n.double() * slope + intercept);
                self.decode_converted(stream, scaled).map(Samples::F64)
            }
        })
    }

    /// Bytes go straight into the vector and are turned round there.
    fn decode_in_place<T: Kept>(&self, stream: &mut (impl Read + ?Sized)) -> Result<Vec<T>, VolumeError> {
        let mut samples: Vec<T> = self.room()?;
        while samples.len() < self.count {
            let start = samples.len();
            let chunk = self.chunk::<T>(start);
            self.grow(&mut samples, chunk)?;
            samples.resize(start + chunk, T::zeroed());
            self.fill(stream, &mut samples[start..], start)?;
        }
        Ok(samples)
    }

    /// Bytes go through a small buffer and are changed into another type.
    fn decode_converted<T: Stored, S: Sample>(
        &self,
        stream: &mut (impl Read + ?Sized),
        convert: impl Fn(T) -> Option<S>,
    ) -> Result<Vec<S>, VolumeError> {
        let mut samples: Vec<S> = self.room()?;
        let mut buffer: Vec<T> = vec![T::zeroed(); self.chunk::<T>(0)];
        while samples.len() < self.count {
            let start = samples.len();
            let chunk = self.chunk::<T>(start);
            self.grow(&mut samples, chunk)?;
            self.fill(stream, &mut buffer[..chunk], start)?;
            for (i, &number) in buffer[..chunk].iter().enumerate() {
                let sample =
                    convert(number).ok_or_else(|| self.does_not_fit(&number.double().to_string(), start + i))?;
                samples.push(sample);
            }
        }
        Ok(samples)
    }

    /// Numbers from text, after passing over `skip` of them.
    fn parse(&self, source: &mut dyn BufRead, skip: u64) -> Result<Samples, VolumeError> {
        let mut numbers = Numbers::new(source);
        for passed in 0..skip {
            if numbers.next().map_err(|e| self.place.io("read", e))?.is_none() {
                return Err(self.too_few_numbers(skip, passed));
            }
        }
        fn kept<S: Sample, T: Stored>(
            job: &Job,
            numbers: &mut Numbers,
            convert: impl Fn(T) -> Option<S>,
        ) -> Result<Samples, VolumeError> {
            let mut samples: Vec<S> = Vec::new();
            while samples.len() < job.count {
                if samples.len() == samples.capacity() {
                    job.grow(&mut samples, CHUNK_BYTES / size_of::<S>())?;
                }
                let at = samples.len();
                let word = numbers.next().map_err(|e| job.place.io("read", e))?;
                let word = word.ok_or_else(|| job.too_few_numbers(job.count as u64, at as u64))?;
                let sample = word.parse().ok().and_then(&convert);
                samples.push(sample.ok_or_else(|| job.does_not_fit(word, at))?);
            }
            Ok(S::wrap(samples))
        }
        use SampleType::*;
        match self.layout.stored {
            StoredType::Plain(U8) => kept(self, &mut numbers, Some::<u8>),
            StoredType::Plain(I8) => kept(self, &mut numbers, Some::<i8>),
            StoredType::Plain(U16) => kept(self, &mut numbers, Some::<u16>),
            StoredType::Plain(I16) => kept(self, &mut numbers, Some::<i16>),
            StoredType::Plain(U32) => kept(self, &mut numbers, Some::<u32>),
            StoredType::Plain(I32) => kept(self, &mut numbers, Some::<i32>),
            StoredType::Plain(F32) => kept(self, &mut numbers, Some::<f32>),
            StoredType::Plain(F64) => kept(self, &mut numbers, Some::<f64>),
            StoredType::I64 => kept(self, &mut numbers, |n: i64| i32::try_from(n).ok()),
            StoredType::U64 => kept(self, &mut numbers, |n: u64| u32::try_from(n).ok()),
        }
    }

    /// An empty vector: with room for all where the length is known, else without.
    fn room<S: Sample>(&self) -> Result<Vec<S>, VolumeError> {
        if self.length_known {
            reserve(self.count, self.layout.dims, S::TYPE, &self.place.file)
        } else {
            Ok(Vec::new())
        }
    }

    /// Room for `more` samples; the vector doubles, so memory stays within twice what has come.
    fn grow<S: Sample>(&self, samples: &mut Vec<S>, more: usize) -> Result<(), VolumeError> {
        let short = samples.len() + more > samples.capacity();
        let step = more.max(samples.len()).min(self.count - samples.len());
        if short && samples.try_reserve_exact(step).is_err() {
            reserve::<S>(usize::MAX, self.layout.dims, S::TYPE, &self.place.file)?;
        }
        Ok(())
    }

    fn chunk<T>(&self, start: usize) -> usize {
        (CHUNK_BYTES / size_of::<T>()).min(self.count - start)
    }

    /// Fills `numbers` from the stream and brings them into the machine's byte order.
    fn fill<T: Stored>(
        &self,
        stream: &mut (impl Read + ?Sized),
        numbers: &mut [T],
        start: usize,
    ) -> Result<(), VolumeError> {
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(numbers);
        let wanted = bytes.len();
        let got = read_full(stream, bytes).map_err(|e| self.failed(e))?;
        if got < wanted {
            let size = size_of::<T>() as u64;
            let found = start as u64 * size + got as u64;
            return Err(truncated(self.place, self.count as u64 * size, found));
        }
        if self.layout.big_endian != cfg!(target_endian = "big") {
            for n in numbers {
                *n = n.swapped();
            }
        }
        Ok(())
    }

    fn failed(&self, error: std::io::Error) -> VolumeError {
        let damaged =
            matches!(error.kind(), ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof);
        if damaged && self.layout.encoding != Encoding::Raw {
            VolumeError::Inflate { file: self.place.file.clone(), reason: error.to_string() }
        } else {
            self.place.io("read", error)
        }
    }

    fn does_not_fit(&self, value: &str, index: usize) -> VolumeError {
        VolumeError::DoesNotFit {
            file: self.place.file.clone(),
            value: clip(value),
            index: index as u64,
            sample_type: self.layout.kept(),
            remedy: match self.layout.stored {
                StoredType::Plain(_) => "correct the number or the header's type".to_owned(),
                _ => "64-bit integers are kept in 32 bits; store the data as f64".to_owned(),
            },
        }
    }

    fn too_few_numbers(&self, promised: u64, found: u64) -> VolumeError {
        VolumeError::Truncated { file: self.place.file.clone(), promised, found, unit: "numbers" }
    }
}

/// Reads until `bytes` is full or the stream ends; how many bytes came.
pub(crate) fn read_full(stream: &mut (impl Read + ?Sized), bytes: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < bytes.len() {
        match stream.read(&mut bytes[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(filled)
}
