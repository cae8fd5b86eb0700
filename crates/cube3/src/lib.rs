//! A cycle-approximate simulator of Cube-3, a real-time volume-rendering machine.

#![warn(missing_docs)]

pub mod clocked;
mod crowded_words;
mod ends_note;
mod error;
pub mod gradient_error;
pub mod limits;
mod machine_run;
pub mod memory;
mod notes;
pub mod opacity_check;
mod options;
mod pictures;
mod ray_spacing;
mod reference;
mod reporting;
mod run;
pub mod sequence;
mod sequence_clock;
mod waveform_files;

pub use error::{Error, Outcome};
pub use options::{RunOptions, Runs};
pub use pictures::Pictures;
pub use reporting::conversion;
pub use run::{RunResult, run, run_frame};
pub use waveform_files::write_waveform;
