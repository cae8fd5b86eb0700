//! Ray projection cone: the samples of a ray to a pixel, by a folded binary tree.
//!
//! ```text
//!   [shaded] ──► leaves ──► log₂ n levels of nodes, segmented, from any leaf in a circle ──► [pixels]
//! ```
//! Pfister et al. 1995, sections 2 and 5, equation (1).

pub mod golden;
pub mod lanes;
mod unit;

pub use unit::{ConeSpec, ConeUnit, NoPixels, Pixel, PixelGroup, Pixels, Reduce, Reducer};
