//! The machine's rays and samples in reals.

use crate::{RenderError, Subject};
use cube3_frame::Geometry;
use cube3_picture::{Phase, Picture, Rendering, Watch};
use cube3_rendering::{About, Feature, MethodError, MethodOption, OptionKind, Settings};
use cube3_scene::Mode;
use cube3_twin::{DiscreteOptions, SampleCell, discrete};

/// The place of what ends stand for among the options.
const ENDS: usize = 0;

const OPTIONS: &[MethodOption] = &[MethodOption {
    name: "ends",
    about: "what the samples at the ends of rays stand for: their part of a step, or a whole one as in the published machine",
    kind: OptionKind::Word(&["exact", "published"]),
}];

/// All but perspective.
const SUPPORTS: &[Feature] = &[
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

/// The machine's rays, samples in its sheared cells.
pub(crate) const SHEARED: About = About {
    name: "sheared",
    what: "the machine's rays, samples in its sheared cells, in 64-bit reals",
    source: "Pfister et al. 1995, section 6 (Sheared3D)",
    supports: SUPPORTS,
    options: OPTIONS,
};

/// The machine's rays, samples in their exact 8-neighbourhood.
pub(crate) const TRUE: About = About {
    name: "true",
    what: "the machine's rays, samples in their exact 8-neighbourhood, in 64-bit reals",
    source: "Pfister et al. 1995, section 6 (True3D)",
    supports: SUPPORTS,
    options: OPTIONS,
};

pub(crate) fn sheared(subject: &Subject<'_>, settings: &Settings, watch: Watch<'_>) -> Result<Rendering, RenderError> {
    along_rays(subject, settings, SampleCell::Sheared, watch)
}

pub(crate) fn true_3d(subject: &Subject<'_>, settings: &Settings, watch: Watch<'_>) -> Result<Rendering, RenderError> {
    along_rays(subject, settings, SampleCell::Exact, watch)
}

fn along_rays(
    subject: &Subject<'_>,
    settings: &Settings,
    interpolation: SampleCell,
    watch: Watch<'_>,
) -> Result<Rendering, RenderError> {
    let &Subject { scene, machine, volume, .. } = subject;
    let frames = subject.frames()?;
    let geometry: &Geometry = frames.setups.first().map(|setup| &setup.geometry).ok_or(RenderError::NoFrame)?;
    let rows = geometry.base_plane_size()[1] as u64;
    let report = |done| watch("rays", done, rows);
    let options = DiscreteOptions {
        gradient: machine.abc.gradient,
        border: volume.words.window[0],
        whole_steps: settings.value(ENDS) > 0.0,
    };
    let cast = || discrete(&volume.data, scene, geometry, interpolation, &options, Some(&report));
    let (base, rays) = Phase::of("rays", cast);
    let base = base.map_err(MethodError::refused)?;
    let plane = &frames.plane;
    let (pixels, warp) = Phase::of("warp", || base.warp(geometry, plane, volume.data.spacing, scene.background));
    Ok(Rendering {
        picture: Picture::new(plane.width, plane.height, pixels)?,
        phases: vec![rays, warp],
        samples: base.samples,
        bytes: volume.data.bytes(),
        bound: None,
    })
}
