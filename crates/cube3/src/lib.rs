//! A cycle-approximate simulator of Cube-3, a real-time volume-rendering machine, as a library.
//!
//! ```text
//!   Scene, Machine ──load──► Volume ──run────► RunResult: report (cycles, stalls, limits, error), pictures, notes
//!                                  ├─render──► Rendering: a picture by any method, and what it took
//!                                  └─compare─► each method's error and time against a reference
//!   vectors, answers ──verify──► Verdict: the first line in which a device differs
//! ```
//! Nothing is printed, nothing is global: progress goes to a function of the caller's, threads are a pool of its own
//! ([`on_threads`]), and every problem is a value of [`Error`] that can be matched: a machine that cannot move is not a file that cannot be
//! read.
//!
//! ```
//! use cube3::{Error, Machine, RunOptions, Runs, Scene, load, run};
//! use cube3_scene::VolumeSource;
//!
//! # fn main() -> Result<(), Error> {
//! let scene = Scene { volume: VolumeSource::from_phantom("head", 24), ..Scene::default() };
//! let machine = Machine { lanes: 24, ..Machine::default() };
//! let volume = load(&scene, &machine)?;
//! let result = run(&scene, &machine, &volume, &RunOptions { runs: Runs::Timing, ..RunOptions::default() })?;
//! let timing = result.report.timing.expect("a timing run");
//! println!("{} cycles, {:.1} frames a second", timing.cycles, timing.fps);
//! # assert!(timing.fps > 0.0 && result.pictures.image.is_none());
//! # Ok(())
//! # }
//! ```

#![warn(missing_docs)]

pub mod clocked;
mod crowded_words;
mod ends_note;
mod error;
pub mod gradient_error;
pub mod limits;
mod load;
mod machine_run;
pub mod memory;
mod notes;
pub mod opacity_check;
mod options;
mod pictures;
mod ray_spacing;
mod reference;
mod render;
mod reporting;
mod run;
pub mod sequence;
mod sequence_clock;
mod threads;
pub mod verify;
mod waveform_files;

pub use cube3_inputs::LoadedVolume as Volume;
pub use cube3_machine::MachineSpec as Machine;
pub use cube3_method::{Choice, METHODS};
pub use cube3_picture::{Picture, Rendering, Watch};
pub use cube3_scene::Scene;
pub use error::{Error, Outcome};
pub use load::load;
pub use options::{RunOptions, Runs};
pub use pictures::Pictures;
pub use render::{Compared, compare, render};
pub use reporting::conversion;
pub use run::{RunResult, run, run_frame};
pub use threads::on_threads;
pub use verify::verify;
pub use waveform_files::write_waveform;
