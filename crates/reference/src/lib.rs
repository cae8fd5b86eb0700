//! The reference: ray casting in f64, from scene and volume alone.
//!
//! [`image_order`] is VolRen of Pfister et al. 1995, section 6: rays from the pixels of the picture, steps of one length, exact
//! 8-neighbourhood. It knows no machine: no registers, no base plane, no estimator.
//!
//! ```text
//!   scene, volume ─► check ─► a ray for each pixel ─► span in what is drawn ─► samples ─► integrate ─► pixel
//! ```
//!
//! It runs on every core and gives the same bits whatever the number of threads. Transparent samples are not shaded, and a ray stops where
//! no later sample can change a bit of its pixel.
//!
//! What a scene means in reals is here once, for every caster that stands on it (the twin of the machine does):
//!
//! - [`check_volume`], [`thickened`]: what may be drawn, and as what.
//! - [`Line`]: the ray of a pixel. [`Drawn`]: the stretch of a line inside of box, crop and cuts. [`LinearCue`]: depth along it.
//! - [`Grid`], [`lerp`], [`cell`]: interpolation between voxels.
//! - [`Integrator`]: from the samples of a [`Ray`] to its pixel: opacity, light, depth cue and the six modes; it asks a [`SamplePoint`].
//! - [`Progress`], [`RowCount`]: how far a caster is.

#![warn(missing_docs)]

mod check;
mod cue;
mod error;
mod grid;
mod image_order;
mod integrate;
mod interpolate;
mod line;
mod method;
mod progress;
mod span;

pub use check::{check_volume, thickened};
pub use cue::LinearCue;
pub use error::RaycastError;
pub use grid::Grid;
pub use image_order::{ImageOrderOptions, ImageRendering, image_order};
pub use integrate::{Integrator, Ray, SamplePoint, StepWeights};
pub use interpolate::{cell, lerp};
pub use line::{Line, nearest_axis};
pub use method::{IMAGE_ORDER, STEP};
pub use progress::{Progress, RowCount};
pub use span::{Drawn, ON_FACE, margin};
