//! The machine's pictures without its clock: the units' lanes over whole planes, on all cores.
//!
//! [`render`] makes the base plane of a [`FrameSetup`](cube3_frame::FrameSetup) and a [`CanonicalVolume`]; bit for bit what the machine makes cycle by cycle.

#![warn(missing_docs)]

mod canonical_volume;
mod function;
mod parallel;
mod perspective;
mod plane;

pub use canonical_volume::CanonicalVolume;
pub use function::{FunctionRun, render};
