//! The host computer of Cube-3: it picks the base plane, makes templates and tables, and warps the picture.
//!
//! [`frame_setup`] and [`picture_setup`] make a `FrameSetup` from a scene, a machine and what is known of the volume; [`warp`] brings the
//! base plane that the machine answers with to the picture. Pfister et al. 1995, sections 2, 3.

mod canonical;
mod classification;
mod ends;
mod picture;
mod setup;
mod shading;
mod warp;

pub use canonical::{CanonicalView, canonical};
pub use classification::OpacityEntries;
pub use ends::whole_step_opacity;
pub use picture::{PictureFrames, picture_setup};
pub(crate) use setup::gradient_scale;
pub use setup::{
    Basis, Frame, HostError, LARGEST_RATIO, LeftOut, SPACING_RANGE, VolumeInfo, check_bus, frame_setup, step_length,
};
pub use warp::{warp, warp_passes, warp_reals};
