//! Fast bus and 2-D skewed buffers: beams in, discrete rays out.
//!
//! ```text
//!   [beams] ──► fast bus (rotation) ──► [aligned] ──► buffer i, i+1 │ i+2 being filled ──► [rays]
//! ```
//! The bus shears: it turns a beam so that each discrete ray stays in its slot. The buffers transpose:
//! beams are written, rays are read, both without conflicts. Where lanes are on several boards, words of beams and rays queue at the
//! links between them. Pfister et al. 1995, sections 2 and 5.

mod board_spec;
mod boards;
pub mod bus;
pub mod golden;
mod lanes;
mod links;
mod unit;

pub use board_spec::BoardSpec;
pub use boards::LinkWords;
pub use lanes::{PlaneStore, Rotator};
pub use links::{LinkReading, Links};
pub use unit::{DsbSpec, DsbUnit, NoPlanes, RayPair, RayVoxels, Store};
