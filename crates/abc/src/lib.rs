//! ABC units: gradient estimation from the rays above, below and around; classification; shading.
//!
//! ```text
//!               above, current, below planes of samples
//!   [samples] ──► gradient ──► normalise ──► light ──┐
//!             └─► classify ──────────────────────────┴─► [shaded]
//! ```
//! Pfister et al. 1995, section 4.

mod datapath;
pub mod ends;
pub mod golden;
pub mod lanes;
mod perspective;
mod unit;

pub use datapath::{ShadedSamples, Shader};
pub use unit::{AbcSpec, AbcUnit, NoShading, Shade, ShadedRay, frame_reach, reach};
