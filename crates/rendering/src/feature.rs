//! What a scene can ask of a method.

use cube3_scene::{Mode, Scene};

/// Something that a scene can ask for and that not every method can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// Rays from an eye.
    Perspective,
    /// A way from the samples of a ray to its pixel.
    Mode(Mode),
    /// Lit samples.
    Shading,
    /// Several lights, or one that is not at the eye.
    Lights,
    /// Colours that depend on the value.
    Colour,
    /// Opacity that depends on the gradient.
    GradientOpacity,
    /// Values that are labels, and not interpolated.
    Labels,
    /// A crop box.
    Crop,
    /// Cut planes.
    Cuts,
    /// A threshold.
    Threshold,
    /// Samples that darken with their depth.
    DepthCue,
}

impl Feature {
    /// Every feature, in the order of tables.
    pub const ALL: [Feature; 16] = [
        Feature::Perspective,
        Feature::Mode(Mode::Composite),
        Feature::Mode(Mode::FirstOpaque),
        Feature::Mode(Mode::LastOpaque),
        Feature::Mode(Mode::Maximum),
        Feature::Mode(Mode::Minimum),
        Feature::Mode(Mode::WeightedSum),
        Feature::Shading,
        Feature::Lights,
        Feature::Colour,
        Feature::GradientOpacity,
        Feature::Labels,
        Feature::Crop,
        Feature::Cuts,
        Feature::Threshold,
        Feature::DepthCue,
    ];

    /// Its name in tables and messages.
    pub fn name(self) -> &'static str {
        match self {
            Feature::Perspective => "perspective",
            Feature::Mode(mode) => mode.name(),
            Feature::Shading => "shading",
            Feature::Lights => "lights",
            Feature::Colour => "colour",
            Feature::GradientOpacity => "gradient opacity",
            Feature::Labels => "labels",
            Feature::Crop => "crop",
            Feature::Cuts => "cuts",
            Feature::Threshold => "threshold",
            Feature::DepthCue => "depth cue",
        }
    }

    /// Whether a scene asks for it.
    pub fn is_needed_by(self, scene: &Scene) -> bool {
        match self {
            Feature::Perspective => scene.view.perspective.is_some(),
            Feature::Mode(mode) => scene.mode == mode,
            Feature::Shading => scene.material.shaded,
            Feature::Lights => {
                scene.material.shaded
                    && (scene.lights.len() > 1 || scene.lights.iter().any(|light| light.direction.is_some()))
            }
            Feature::Colour => scene.transfer.colour.windows(2).any(|pair| pair[0].rgb != pair[1].rgb),
            Feature::GradientOpacity => scene.transfer.is_two_dimensional(),
            Feature::Labels => scene.volume.labels,
            Feature::Crop => scene.crop.is_some(),
            Feature::Cuts => !scene.cuts.is_empty(),
            Feature::Threshold => scene.threshold.is_some(),
            Feature::DepthCue => scene.depth_cue.is_some(),
        }
    }

    /// What a scene asks for.
    pub fn needed_by(scene: &Scene) -> impl Iterator<Item = Feature> + '_ {
        Feature::ALL.into_iter().filter(move |feature| feature.is_needed_by(scene))
    }
}
