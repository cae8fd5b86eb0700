//! Data sheets of the machine's units, golden vectors made from them, and the comparison of a device under test.
//!
//! A [`Unit`] is a block of the machine: a [`Sheet`] (ports, tables, every wire with its range) and a way to evaluate its definition
//! in the unit crates' `golden.rs`. From the sheet come the lines of vectors ([`Lines`]), what they cover ([`Coverage`]), proofs of
//! range ([`ranges`]), test benches and the pages of the book. A device under test answers each line, and [`Comparison`] says where
//! it is wrong first. Lines stream: none of these holds more than a few.

#![warn(missing_docs)]

pub mod compare;
mod coverage;
mod expression;
mod file;
mod format;
mod generate;
mod markdown;
pub mod pages;
pub mod ranges;
mod set;
mod sheet;
pub mod testbench;
mod text;
mod unit;
mod units;
pub mod waveform;

pub use compare::{Answer, AnswerReader, Comparison, Mismatch, ResponsesError};
pub use coverage::{Coverage, Point};
pub use expression::{ExpressionError, evaluate};
pub use file::{FileError, LineWriter, VectorHeader, VectorReader, Written};
pub use format::{UnitFormat, UnitFormatError};
pub use generate::Lines;
pub use set::{Device, Set, UnitDefinition, Vectors};
pub use sheet::{LineField, Port, Sheet, Table, Wire, WireKind, bits_of};
pub use unit::{Reader, Seen, Tables, Unit, WireRecorder, word_formats};
pub use units::units;
