//! What is said of a method, and those that need scene and volume alone.

use crate::{Feature, MethodError, MethodOption, Settings};
use cube3_picture::{Picture, Rendering, Watch};
use cube3_scene::Scene;
use cube3_volume::Volume;

/// What is said of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct About {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it does, in half a sentence.
    pub what: &'static str,
    /// Where it is from.
    pub source: &'static str,
    /// What of a scene it can show.
    pub supports: &'static [Feature],
    /// What can be chosen.
    pub options: &'static [MethodOption],
}

impl About {
    /// What a scene asks for and the method cannot show.
    pub fn lacks(&self, scene: &Scene) -> Vec<Feature> {
        Feature::needed_by(scene).filter(|feature| !self.supports.contains(feature)).collect()
    }
}

/// A scene and the volume that it shows, in its own values.
#[derive(Clone, Copy, Debug)]
pub struct SceneSubject<'a> {
    /// What to show, in the grid of `volume`.
    pub scene: &'a Scene,
    /// The volume, of at least two voxels along each axis unless they are labels.
    pub volume: &'a Volume,
    /// The value beyond the volume's border.
    pub border: f64,
}

/// Makes a picture of a scene and a volume.
pub type RenderScene = fn(&SceneSubject<'_>, &Settings, Watch<'_>) -> Result<Rendering, MethodError>;

/// Makes the same picture again with less error, where that can be done, on each `every`th pixel of a row and each `every`th row; and tells the
/// settings of it.
pub type RenderFiner = fn(&SceneSubject<'_>, &Settings, every: usize) -> Result<(Picture, Settings), MethodError>;

/// A method that needs scene and volume alone.
#[derive(Clone, Copy, Debug)]
pub struct SceneMethod {
    /// What is said of it.
    pub about: About,
    /// How it makes a picture.
    pub render: RenderScene,
    /// How its own error is looked at, where it can be.
    pub finer: Option<RenderFiner>,
}
