//! The converged integral as a row of the table of methods.

use crate::{ConvergedOptions, TOLERANCES, converged};
use cube3_picture::{Phase, Rendering, Watch};
use cube3_rendering::{
    About, Feature, MethodError, MethodOption, OptionKind, SceneMethod, SceneSubject, Settings, Sparse,
};
use cube3_scene::Mode;

/// The place of the tolerance among the options.
pub const TOLERANCE: usize = 0;

/// The number of the arithmetic: pictures are kept under it.
const ARITHMETIC: u32 = 1;

/// All but the modes that choose one sample.
const SUPPORTS: &[Feature] = &[
    Feature::Perspective,
    Feature::Mode(Mode::Composite),
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

/// The ray integral itself.
pub const CONVERGED: SceneMethod = SceneMethod {
    about: About {
        name: "converged",
        what: "the integral of emission and absorption along each pixel's ray, with a proven bound",
        source: "quadrature between all bends, bounded in Bernstein's ellipses; after Novins & Arvo 1992",
        supports: SUPPORTS,
        options: &[MethodOption {
            name: "tolerance",
            about: "the most that a channel may be off by",
            kind: OptionKind::Number { range: TOLERANCES, default: 1e-6, unit: "of full scale" },
        }],
        in_words: false,
        reach_voxel: 0.0,
    },
    render,
    sparse: Some(sparse),
    kept: Some(ARITHMETIC),
    finer: None,
};

fn options(subject: &SceneSubject<'_>, settings: &Settings, every: usize) -> ConvergedOptions {
    ConvergedOptions { tolerance: settings.value(TOLERANCE), border: subject.border, every }
}

fn render(subject: &SceneSubject<'_>, settings: &Settings, watch: Watch<'_>) -> Result<Rendering, MethodError> {
    let rows = u64::from(subject.scene.image.height_px);
    let report = |done| watch("rays", done, rows);
    let options = options(subject, settings, 1);
    let (made, phase) = Phase::of("rays", || converged(subject.volume, subject.scene, &options, Some(&report)));
    let made = made.map_err(MethodError::refused)?;
    Ok(Rendering {
        picture: made.picture,
        phases: vec![phase],
        samples: made.evaluations,
        bytes: subject.volume.bytes(),
        bound: Some(made.bounds),
    })
}

fn sparse(subject: &SceneSubject<'_>, settings: &Settings, every: usize) -> Result<Sparse, MethodError> {
    let options = options(subject, settings, every);
    let made = converged(subject.volume, subject.scene, &options, None).map_err(MethodError::refused)?;
    Ok(Sparse { picture: made.picture, bound: Some(made.bounds) })
}
