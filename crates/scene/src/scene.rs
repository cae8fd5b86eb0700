//! The scene as a whole.

use serde::{Deserialize, Serialize};

use crate::{Crop, Cut, DepthCue, Image, Light, Material, Mode, Path, Threshold, Transfer, View, VolumeSource};

/// The number of the scene's format: a file that names a later one was written for another version. In format 1 a volume file was
/// drawn as it is stored; since 2 its directions count ([`crate::FileAxes`]).
pub const SCHEMA: u32 = 2;

/// What to show. [`Scene::default`] is the paper's scene on the phantom `head`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// The number of the format that the scene was written for, 1 to [`SCHEMA`].
    pub schema: u32,
    /// How the samples along a ray become a pixel.
    pub mode: Mode,
    /// What is seen where the volume is clear: red, green and blue, 0 to 1.
    pub background: [f64; 3],
    /// Which volume is shown.
    pub volume: VolumeSource,
    /// From where.
    pub view: View,
    /// How the view moves from frame to frame of a sequence; it stands still without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Path>,
    /// The raster of the picture.
    pub image: Image,
    /// Which opacity and colour a value has.
    pub transfer: Transfer,
    /// How the material answers to light.
    pub material: Material,
    /// The lights, at most [`MOST_LIGHTS`](crate::MOST_LIGHTS); a file with none has one white light at the eye, and
    /// `light = []` means darkness but for ambient light.
    #[serde(rename = "light")]
    pub lights: Vec<Light>,
    /// Darkening with depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_cue: Option<DepthCue>,
    /// Planes that cut something away, at most [`MOST_CUTS`](crate::MOST_CUTS).
    #[serde(rename = "cut", skip_serializing_if = "Vec::is_empty")]
    pub cuts: Vec<Cut>,
    /// A box outside of which nothing is shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<Crop>,
    /// Values outside of which nothing is shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<Threshold>,
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            schema: SCHEMA,
            mode: Mode::default(),
            background: [0.0; 3],
            volume: VolumeSource::default(),
            view: View::default(),
            path: None,
            image: Image::default(),
            transfer: Transfer::default(),
            material: Material::default(),
            lights: vec![Light::default()],
            depth_cue: None,
            cuts: Vec::new(),
            crop: None,
            threshold: None,
        }
    }
}
