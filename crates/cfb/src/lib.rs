//! Cubic frame buffer: n memory modules, skewed so that a beam along any axis meets each module once.
//!
//! ```text
//!   registers ──► scan ──► module 0 … module n−1 ──► beam, a voxel a lane ──► fast bus
//! ```
//! Pfister et al. 1995, section 5.

pub mod golden;
mod lanes;
pub mod memory;
mod port;
mod scan;
mod unit;

pub use lanes::{FrameBuffer, FrameBufferError};
pub use port::{AcquisitionPort, PortSpec};
pub use scan::{CfbSpec, Piece, scan};
pub use unit::{Beam, CfbUnit, Fetch, NoVoxels, VoxelBeam};
