//! The twin of the machine in f64: its rays and its samples, in reals where the machine has words.
//!
//! Two programs of Pfister et al. 1995, section 6, on one scene, one volume and the geometry of a frame:
//!
//! | here | in the paper | rays | samples |
//! | --- | --- | --- | --- |
//! | [`true_3d`] | True3D | from the base plane, as the machine | the machine's positions, exact 8-neighbourhood |
//! | [`sheared`] | Sheared3D | from the base plane, as the machine | the machine's positions, sheared cell |
//!
//! So the reference against true shows what the machine's rays cost, true against sheared what its interpolation costs, and sheared
//! against the machine what its words cost.
//!
//! ```text
//!   geometry ─► rays, steps ─┐
//!   volume ─► voxels ────────┴─► sample_plane ─► gradient ─► cast ─► base plane ─► warp ─► picture
//!   scene ─► parts                               basis       (integrate of the reference)
//! ```
//!
//! A parallel view has one frame. That of an eye has one for each of its passes, and each is cast by itself; [`warp_passes`] joins them.
//!
//! Of the machine it knows where the rays and samples are: [`Geometry`](cube3_frame::Geometry), and the name of an estimator. The rest is
//! its own: [`Basis`] and [`step_length`] from the geometry's slopes and the voxels' spacing, clips, depth cue and the place of an eye from the
//! scene, as in [`cube3_reference`]. Nothing is read from a register that the host has written for them, so the host's arithmetic cannot hide in both.
//!
//! Both run on every core and give the same bits whatever the number of threads.

#![warn(missing_docs)]

mod base_rendering;
mod basis;
mod cast;
mod check;
mod discrete;
mod error;
mod gradient;
mod parts;
mod rays;
mod real_samples;
mod sample_plane;
mod step_length;
mod steps;
mod surface;
mod voxels;
mod warp;

pub use base_rendering::BaseRendering;
pub use basis::Basis;
pub use cube3_reference::Progress;
pub use discrete::{DiscreteOptions, discrete, sheared, true_3d};
pub use error::TwinError;
pub use real_samples::RealSamples;
pub use step_length::step_length;
pub use steps::SampleCell;
pub use surface::{SurfacePoint, surface_gradients};
pub use warp::warp_passes;
