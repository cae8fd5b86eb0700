//! Reference ray casters in f64: what the machine's picture is measured against.
//!
//! The three programs of Pfister et al. 1995, section 6, on one scene and one volume:
//!
//! | here | in the paper | rays | samples |
//! | --- | --- | --- | --- |
//! | [`image_order`] | VolRen | from the pixels of the picture | uniform steps, exact 8-neighbourhood |
//! | [`true_3d`] | True3D | from the base plane, as the machine | the machine's positions, exact 8-neighbourhood |
//! | [`sheared`] | Sheared3D | from the base plane, as the machine | the machine's positions, sheared cell |
//!
//! So image order against true shows what the machine's rays cost, true against sheared what its
//! interpolation costs, and sheared against the machine what its words cost.
//!
//! ```text
//!   volume ─► voxels ─► sample_plane ─┐                        (discrete: true_3d, sheared)
//!                                     ├─► gradient ─► integrate ─► pixel
//!   volume ─► image_order ────────────┘
//! ```
//!
//! All run on every core and give the same bits whatever the number of threads. Transparent samples are
//! not shaded, and a ray stops where no later sample can change a bit of its pixel.

#![warn(missing_docs)]

mod base_rendering;
mod check;
mod discrete;
mod error;
mod gradient;
mod image_order;
mod integrate;
mod interpolate;
mod progress;
mod ray_samples;
mod sample_plane;
mod span;
mod steps;
mod surface;
mod voxels;

pub use base_rendering::BaseRendering;
pub use discrete::{DiscreteOptions, discrete, sheared, true_3d};
pub use error::RaycastError;
pub use image_order::{ImageOrderOptions, Rendering, image_order};
pub use progress::Progress;
pub use ray_samples::RaySamples;
pub use steps::Interpolation;
pub use surface::{SurfacePoint, surface_gradients};
