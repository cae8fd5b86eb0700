//! Ray projection cone: the samples of a ray to a pixel, by a folded binary tree, or by one of the other ways to join nodes.
//!
//! ```text
//!   [shaded] ──► leaves ──► log₂ n levels of nodes, segmented, from any leaf in a circle ──► [pixels]
//! ```
//! Pfister et al. 1995, sections 2 and 5, equation (1).

pub mod golden;
pub mod lanes;
mod segments;
mod spec;
mod unit;

pub use segments::PixelCounts;
pub use spec::ConeSpec;
pub use unit::{ConeUnit, NoPixels, Pixel, PixelGroup, Pixels, Reduce, Reducer, place_of_circle, segments};
