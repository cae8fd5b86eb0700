//! Traces of a window of cycles of a machine.
//!
//! One stream of events, in which a cycle takes 16 bytes, and several ways to write it down:
//!
//! ```text
//!   Machine::run_until ──see──► Recorder ──► Recording ──replay──► fst | kanata | perfetto
//! ```

#![warn(missing_docs)]

mod formats;
mod fst;
mod kanata;
mod perfetto;
mod recording;

pub use recording::{CycleWindow, Events, Recorder, Recording, TraceError, TraceFormat, Track};
