//! The host computer of Cube-3: it picks the base plane, makes templates and tables, and warps the picture.
//!
//! [`frame_setup`] and [`picture_setup`] make a `FrameSetup` from a scene, a machine and what is known of the volume; [`warp`] brings the
//! base plane that the machine answers with to the picture. Pfister et al. 1995, sections 2, 3.

mod canonical;
mod classification;
mod ends;
mod golden;
mod in_frame;
mod picture;
mod setup;
mod shading;
mod volume_info;
mod warp;

pub use canonical::{CanonicalView, canonical};
pub use classification::OpacityEntries;
pub use golden::{Basis, step_length, whole_step_opacity};
pub use picture::{PictureFrames, picture_setup};
pub use setup::{HostError, LARGEST_RATIO, ParallelFrame, SPACING_RANGE, check_bus, frame_setup};
pub use volume_info::VolumeInfo;
pub use warp::{warp, warp_passes, warp_reals};
