//! A bound of what words cost: for each pixel of a frame all values that it may have.
//!
//! The frame's rays and samples are walked in reals, as the twin does, and each quantity is an interval that holds the real and the
//! word: see the book, *A bound of the error*. With [`Grains::none`] the intervals are points, the twin's pictures.
//!
//! ```text
//!   samples ─► gradient ─► shade ─► ray
//!   ends ───────────────────────────┘
//! ```

#![warn(missing_docs)]

mod ends;
mod grains;
mod interval;
mod ray;
mod samples;
mod shade;

pub use grains::Grains;
pub use interval::Interval;
pub use ray::{Pixel, Walk};
