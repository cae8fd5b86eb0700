//! What to show: the volume, the view of it, its transfer function, material and lights, and what is
//! cut away.
//!
//! A [`Scene`] is data, read from a TOML file or taken from [`Scene::default`], which is the scene of
//! the paper's comparison (Pfister et al. 1995, section 6, figure 14) with a phantom for the CT head. It
//! says nothing about how the picture is made: the machine and every reference renderer show the same
//! scene. What they must agree on to the letter is defined here once, in real numbers:
//!
//! - [`View::frame`]: the axes of the picture;
//! - [`Transfer::opacity_at`] and [`Transfer::colour_at`]: classification;
//! - [`phong`]: the colour of a lit sample;
//! - [`corrected_opacity`]: the opacity of a step that is not of unit length;
//! - [`ImagePlane`]: where the pixels are, and [`depth_range`] of the volume before it.
//!
//! World space is voxel space times voxel spacing: right-handed, +z up.

mod angle;
mod check;
mod clip;
mod depth_cue;
mod error;
mod file;
mod image;
mod image_plane;
mod light;
mod material;
mod mode;
mod opacity;
mod parameters;
mod path;
mod perspective;
mod phong;
mod piecewise;
mod resolved_light;
mod scene;
mod thickness;
mod transfer;
mod unit_vector;
mod validate;
mod view;
mod volume_source;

pub use angle::sin_cos_degrees;
pub use clip::{Crop, Cut, MOST_CUTS, Threshold};
pub use depth_cue::{DepthCue, depth_range};
pub use error::{SceneError, ScenePlace};
pub use image::{Image, LARGEST_IMAGE_PX};
pub use image_plane::{ImagePlane, eye, smallest_spacing};
pub use light::{Light, MOST_LIGHTS};
pub use material::Material;
pub use mode::Mode;
pub use opacity::{corrected_opacity, over};
pub use parameters::SCENE_PARAMETERS;
pub use path::{Interpolation, MOST_KEYS, Path, PathKey};
pub use perspective::{FARTHEST_EYE_VOXEL, FIELD_OF_VIEW_DEG, Perspective};
pub use phong::phong;
pub use resolved_light::{ResolvedLight, resolve_lights, turn_lights};
pub use scene::{SCHEMA, Scene};
pub use transfer::{ColourPoint, Layer, Transfer};
pub use unit_vector::unit_vector;
pub use view::{View, ViewFrame};
pub use volume_source::{FileAxes, LARGEST_PHANTOM_VOXELS, VolumeSource};
