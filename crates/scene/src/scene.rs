//! The scene as a whole.

use serde::{Deserialize, Serialize};

use crate::check;
use crate::{
    Crop, Cut, DepthCue, Image, Light, MOST_CUTS, MOST_LIGHTS, Material, Mode, Path, SCENE_PARAMETERS, SceneError,
    Threshold, Transfer, View, VolumeSource,
};
use cube3_parameter::check as check_rows;

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
    /// The lights, at most [`MOST_LIGHTS`]; a file with none has one white light at the eye, and
    /// `light = []` means darkness but for ambient light.
    #[serde(rename = "light")]
    pub lights: Vec<Light>,
    /// Darkening with depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_cue: Option<DepthCue>,
    /// Planes that cut something away, at most [`MOST_CUTS`].
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

impl Scene {
    /// Checks every value of the scene, so that no renderer has to: its range first, by [`SCENE_PARAMETERS`], then what must hold
    /// between values.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong: a format of another version, a number that is not finite or out
    /// of its range, points out of order, a vector without direction, a pixel size in a perspective view,
    /// too many cuts or lights.
    pub fn validate(&self) -> Result<(), SceneError> {
        check_rows(SCENE_PARAMETERS, self).map_err(|fault| SceneError::out_of_range(&fault))?;
        self.volume.validate()?;
        self.view.validate()?;
        self.path.as_ref().map_or(Ok(()), |path| path.validate(&self.view))?;
        if self.view.perspective.is_some() && self.image.pixel_size_voxel.is_some() {
            return Err(SceneError::at(
                "image.pixel_size_voxel",
                "a pixel has no one size in a perspective view",
                "leave it out: `view.perspective.field_of_view_deg` sets what the picture shows",
            ));
        }
        self.transfer.validate()?;
        check::at_most("light", self.lights.len(), MOST_LIGHTS)?;
        self.lights.iter().enumerate().try_for_each(|(i, light)| light.validate(i))?;
        check::at_most("cut", self.cuts.len(), MOST_CUTS)?;
        self.cuts.iter().enumerate().try_for_each(|(i, cut)| cut.validate(i))?;
        self.crop.as_ref().map_or(Ok(()), Crop::validate)?;
        self.threshold.as_ref().map_or(Ok(()), Threshold::validate)
    }
}
