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
    /// Whether its arithmetic is that of the machine's words.
    pub in_words: bool,
    /// How far a sample may be from a place on a parallel pixel's ray that it stands for, in voxels along each axis, without options given; the
    /// voxels of the cell around it are in reach with it. What a bound of its error goes by.
    pub reach_voxel: f64,
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

/// Every so many pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse {
    /// The pixels.
    pub picture: Picture,
    /// As [`Rendering::bound`].
    pub bound: Option<Vec<f64>>,
}

/// Makes each `every`th pixel of a row and each `every`th row, from the top left one on.
pub type RenderSparse = fn(&SceneSubject<'_>, &Settings, every: usize) -> Result<Sparse, MethodError>;

/// A method that needs scene and volume alone.
#[derive(Clone, Copy, Debug)]
pub struct SceneMethod {
    /// What is said of it.
    pub about: About,
    /// How it makes a picture.
    pub render: RenderScene,
    /// How some of the pixels are made, where they can be made alone.
    pub sparse: Option<RenderSparse>,
    /// The number of the method's arithmetic, where its pictures are worth keeping: it rises when a picture would come out otherwise.
    pub kept: Option<u32>,
    /// The settings with less error, where the method has steps of its own and so an error of its own.
    pub finer: Option<fn(&Settings) -> Settings>,
}
