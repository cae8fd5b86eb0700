//! Data sheets of the machine's units, golden vectors made from them, and the comparison of a device under test.
//!
//! A [`Unit`] is a block of the machine: a [`Sheet`] (ports, tables, every wire with its range) and a way to evaluate its definition
//! in the unit crates' `golden`. From the sheet come the lines of vectors ([`Lines`]), what they cover ([`Coverage`]), proofs of
//! range ([`ranges`]), test benches and the pages of the book. A device under test answers each line, and [`Comparison`] says where
//! it is wrong first. Lines stream: none of these holds more than a few.

#![warn(missing_docs)]

pub mod compare;
mod coverage;
mod expression;
mod file;
mod format;
mod generate;
mod held;
mod markdown;
mod mismatch_waveform;
pub mod pages;
pub mod ranges;
pub mod record;
pub mod rtl_frame;
mod set;
mod set_files;
mod sheet;
pub mod testbench;
mod text;
mod unit;
mod units;

pub use compare::{Answer, AnswerReader, Comparison, Mismatch, ResponsesError};
pub use coverage::{Coverage, Point};
pub use expression::{ExpressionError, evaluate};
pub use file::{FileError, LineWriter, VectorHeader, VectorReader, Written};
pub use format::{UnitFormat, UnitFormatError};
pub use generate::Lines;
pub use held::Vectors;
pub use mismatch_waveform::around_mismatch;
pub use set::{Set, UnitDefinition};
pub use set_files::{SetFiles, WriteError};
pub use sheet::{LineField, Port, Sheet, Table, Wire, WireKind, bits_of};
pub use unit::{Device, Reader, Seen, Tables, Unit, WireRecorder, word_formats};
pub use units::units;
