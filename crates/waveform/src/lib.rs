//! Waveforms as FST files, and the files with which GTKWave and Surfer show them.
//!
//! ```text
//!   WaveformHeader ──scopes, variables──► Body ──times, changes──► Waveform ──► fst
//!                 └──────────── the list of variables ─────────┴─────► gtkwave, surfer
//! ```

#![warn(missing_docs)]

mod viewers;

pub use fst_writer::{FstSignalId as Signal, FstWriteError as WaveformError};

use fst_writer::{
    FstBodyWriter, FstFileType, FstHeaderWriter, FstInfo, FstScopeType, FstSignalType, FstVarDirection, FstVarType,
};
use std::io::Cursor;

/// Value changes are compressed and put away when they take this many bytes.
const FLUSH_BYTES: usize = 1 << 20;
/// Blocks of the file by their first byte. After it come the length of the rest and, in these two, the time of the start.
const HEADER_BLOCK: u8 = 0;
const CHANGES_BLOCK: u8 = 8;

/// How viewers show a variable of more than one bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Radix {
    /// A word without sign.
    Hexadecimal,
    /// A number without sign.
    Unsigned,
    /// A number in two's complement.
    Signed,
    /// Letters of eight bits, the first on top.
    Text,
    /// A number without sign, as a curve of steps.
    Level,
}

/// A variable of a waveform.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Scopes from the outermost, and its own name.
    pub path: Vec<String>,
    /// Width.
    pub bits: u32,
    /// How viewers show it.
    pub radix: Radix,
}

/// Scopes and variables of a waveform, before its first time.
pub struct WaveformHeader {
    writer: FstHeaderWriter<Cursor<Vec<u8>>>,
    start: u64,
    timescale_exponent: i8,
    scopes: Vec<String>,
    variables: Vec<Variable>,
}

/// A name that viewers do not take apart: `voxel_3` for `voxel[3]`, `along_v_value` for `along_v.value`, `gradient_6` for
/// `gradient-6`.
fn plain(name: &str) -> String {
    name.replace(['[', '.', '-'], "_").replace(']', "")
}

impl WaveformHeader {
    /// A waveform that begins `start` time units after time 0; a unit is a second by ten to the power of `timescale_exponent`.
    ///
    /// # Errors
    /// What the writer of the format says, here as below.
    pub fn new(start: u64, timescale_exponent: i8) -> Result<WaveformHeader, WaveformError> {
        let info = FstInfo {
            // Viewers add this one to every time.
            start_time: 0,
            timescale_exponent,
            version: format!("cube3 {}", env!("CARGO_PKG_VERSION")),
            date: String::new(),
            file_type: FstFileType::Verilog,
        };
        let writer = FstHeaderWriter::write_to_mem(&info)?;
        Ok(WaveformHeader { writer, start, timescale_exponent, scopes: Vec::new(), variables: Vec::new() })
    }

    /// Opens a scope within the one that is open.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn scope(&mut self, name: &str) -> Result<(), WaveformError> {
        self.scopes.push(plain(name));
        self.writer.scope(plain(name), "", FstScopeType::Module)
    }

    /// Closes the scope that is open.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn up_scope(&mut self) -> Result<(), WaveformError> {
        self.scopes.pop();
        self.writer.up_scope()
    }

    /// A variable of the scope that is open.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn variable(&mut self, name: &str, bits: u32, radix: Radix) -> Result<Signal, WaveformError> {
        let path = self.scopes.iter().cloned().chain([plain(name)]).collect();
        self.variables.push(Variable { path, bits, radix });
        let kind = FstSignalType::bit_vec(bits);
        self.writer.var(plain(name), kind, FstVarType::Wire, FstVarDirection::Implicit, None)
    }

    /// A variable of one bit.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn flag(&mut self, name: &str) -> Result<Signal, WaveformError> {
        self.variable(name, 1, Radix::Unsigned)
    }

    /// Ends the list of variables; the first time is that of the start.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn finish(self) -> Result<Body, WaveformError> {
        let mut writer = self.writer.finish()?;
        writer.time_change(self.start)?;
        let (start, timescale_exponent) = (self.start, self.timescale_exponent);
        Ok(Body { writer, start, timescale_exponent, variables: self.variables })
    }
}

/// Value changes of a waveform.
pub struct Body {
    writer: FstBodyWriter<Cursor<Vec<u8>>>,
    start: u64,
    timescale_exponent: i8,
    variables: Vec<Variable>,
}

impl Body {
    /// Goes on to a time, in time units after time 0.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`], and a time before the last.
    pub fn time(&mut self, time: u64) -> Result<(), WaveformError> {
        if self.writer.size() > FLUSH_BYTES {
            self.writer.flush()?;
        }
        self.writer.time_change(time)
    }

    /// A variable's value from now on: a letter for each bit, the highest first, 0, 1 or X.
    ///
    /// # Errors
    /// As [`WaveformHeader::new`].
    pub fn change(&mut self, signal: Signal, value: &[u8]) -> Result<(), WaveformError> {
        self.writer.signal_change(signal, value)
    }

    /// Ends the waveform at a time behind that of the last change.
    ///
    /// # Errors
    /// As [`Body::time`].
    pub fn finish(mut self, end: u64) -> Result<Waveform, WaveformError> {
        self.time(end)?;
        let mut fst = self.writer.finish()?.into_inner();
        set_start(&mut fst, self.start);
        let (start, timescale_exponent) = (self.start, self.timescale_exponent);
        Ok(Waveform { fst, start, end, timescale_exponent, variables: self.variables })
    }
}

/// Writes when the waveform starts into its header and its first block of changes; the writer of the format leaves 0 there.
fn set_start(fst: &mut [u8], start: u64) {
    let mut rest = fst;
    while let Some((head, _)) = rest.split_first_chunk_mut::<17>() {
        let kind = head[0];
        let length = head[1..9].iter().fold(0, |length, &byte| length << 8 | usize::from(byte));
        if [HEADER_BLOCK, CHANGES_BLOCK].contains(&kind) {
            head[9..].copy_from_slice(&start.to_be_bytes());
        }
        if kind == CHANGES_BLOCK {
            break;
        }
        rest = rest.get_mut(1 + length..).unwrap_or_default();
    }
}

/// A waveform.
pub struct Waveform {
    /// The file.
    pub fst: Vec<u8>,
    /// When it starts, in time units after time 0.
    pub start: u64,
    /// When it ends.
    pub end: u64,
    /// A time unit is a second by ten to this power.
    pub timescale_exponent: i8,
    /// Its variables, in the order of the file.
    pub variables: Vec<Variable>,
}
