//! Sheared trilinear interpolation: the samples of a continuous ray from four discrete rays.
//!
//! ```text
//!   [rays] ──► four lerps along w ──► two along u ──► one along v ──► [samples]
//!              (the ray before and the plane before may be kept)
//! ```
//! Pfister et al. 1995, section 3.

mod datapath;
pub mod golden;
pub mod lanes;
mod ray_samples;
mod unit;

pub use datapath::Interpolator;
pub use ray_samples::{RaySamples, SampleBlock};
pub use unit::{Interpolate, NoSamples, SampleRay, TrilinUnit};
