//! Image order as a row of the table of methods.

use crate::{ImageOrderOptions, image_order};
use cube3_picture::{Phase, Rendering, Watch};
use cube3_rendering::{
    About, Feature, MethodError, MethodOption, OptionKind, SceneMethod, SceneSubject, Settings, Sparse,
};

/// Steps that can be asked for, in units of the smallest voxel spacing: shorter ones take minutes, and longer ones skip what they are to
/// measure, also at half the step.
const STEPS: [f64; 2] = [0.002, 8.0];

/// Half a voxel: on the default head the reference's own error is then a tenth of the distance that it measures; at a voxel it is a third.
const STEP_VOXEL: f64 = 0.5;

/// The place of the step among the options.
pub const STEP: usize = 0;

/// Rays from the pixels of the picture.
pub const IMAGE_ORDER: SceneMethod = SceneMethod {
    about: About {
        name: "image-order",
        what: "rays from pixels in steps of one length, exact interpolation, in 64-bit reals",
        source: "Pfister et al. 1995, section 6 (VolRen)",
        supports: &Feature::ALL,
        options: &[MethodOption {
            name: "step",
            about: "length of a step, in units of the smallest voxel spacing",
            kind: OptionKind::Number { range: STEPS, default: STEP_VOXEL, unit: "voxels" },
        }],
        in_words: false,
        // Half of a step to the sample, and its cell.
        reach_voxel: STEP_VOXEL / 2.0,
    },
    render,
    sparse: Some(sparse),
    kept: None,
    finer: Some(half_the_step),
};

fn options(subject: &SceneSubject<'_>, settings: &Settings) -> ImageOrderOptions {
    ImageOrderOptions { step_voxel: settings.value(STEP), border: subject.border, ..ImageOrderOptions::default() }
}

fn render(subject: &SceneSubject<'_>, settings: &Settings, watch: Watch<'_>) -> Result<Rendering, MethodError> {
    let rows = u64::from(subject.scene.image.height_px);
    let report = |done| watch("rays", done, rows);
    let cast = || image_order(subject.volume, subject.scene, &options(subject, settings), Some(&report));
    let (made, phase) = Phase::of("rays", cast);
    let made = made.map_err(MethodError::refused)?;
    Ok(Rendering {
        picture: made.picture,
        phases: vec![phase],
        samples: made.samples,
        bytes: subject.volume.bytes(),
        bound: None,
    })
}

fn sparse(subject: &SceneSubject<'_>, settings: &Settings, every: usize) -> Result<Sparse, MethodError> {
    let options = ImageOrderOptions { every, ..options(subject, settings) };
    let made = image_order(subject.volume, subject.scene, &options, None).map_err(MethodError::refused)?;
    Ok(Sparse { picture: made.picture, bound: None })
}

fn half_the_step(settings: &Settings) -> Settings {
    settings.clone().with(STEP, settings.value(STEP) / 2.0)
}
