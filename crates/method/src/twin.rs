//! The machine's rays and samples in reals.

use crate::machine::REACH_VOXEL;
use crate::{RenderError, Subject};
use cube3_frame::Geometry;
use cube3_picture::{Phase, Picture, Rendering, Watch};
use cube3_rendering::{About, Feature, MethodError, MethodOption, OptionKind, Settings};
use cube3_twin::{BaseRendering, DiscreteOptions, SampleCell, discrete, warp_passes};

/// The place of what ends stand for among the options.
const ENDS: usize = 0;

const OPTIONS: &[MethodOption] = &[MethodOption {
    name: "ends",
    about: "what the samples at the ends of rays stand for: their part of a step, or a whole one as in the published machine",
    kind: OptionKind::Word(&["exact", "published"]),
}];

/// The machine's rays, samples in its sheared cells.
pub(crate) const SHEARED: About = About {
    name: "sheared",
    what: "the machine's rays, samples in its sheared cells, in 64-bit reals",
    source: "Pfister et al. 1995, section 6 (Sheared3D)",
    supports: &Feature::ALL,
    options: OPTIONS,
    in_words: false,
    reach_voxel: REACH_VOXEL,
};

/// The machine's rays, samples in their exact 8-neighbourhood.
pub(crate) const TRUE: About = About {
    name: "true",
    what: "the machine's rays, samples in their exact 8-neighbourhood, in 64-bit reals",
    source: "Pfister et al. 1995, section 6 (True3D)",
    supports: &Feature::ALL,
    options: OPTIONS,
    in_words: false,
    reach_voxel: REACH_VOXEL,
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
    if frames.setups.is_empty() {
        return Err(RenderError::NoFrame);
    }
    let all: u64 = frames.setups.iter().map(|setup| setup.geometry.base_plane_size()[1] as u64).sum();
    let (mut bases, mut seconds, mut before) = (Vec::new(), 0.0, 0);
    for setup in &frames.setups {
        let geometry = &setup.geometry;
        let report = |done| watch("rays", before + done, all);
        let options = DiscreteOptions {
            // Which estimator a pass has is the host's choice; what it comes to is not.
            gradient: setup.gradient.as_ref().map_or(machine.abc.gradient, |gradient| gradient.method),
            border: volume.words.window[0],
            whole_steps: settings.value(ENDS) > 0.0,
        };
        let cast = || discrete(&volume.data, scene, geometry, interpolation, &options, Some(&report));
        let (base, rays) = Phase::of("rays", cast);
        bases.push(base.map_err(MethodError::refused)?);
        seconds += rays.seconds;
        before += geometry.base_plane_size()[1] as u64;
    }
    let (plane, spacing) = (&frames.plane, volume.data.spacing);
    let passes: Vec<(&BaseRendering, &Geometry)> =
        bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
    let (pixels, warp) = Phase::of("warp", || match (plane.eye, &passes[..]) {
        (None, [(base, geometry)]) => base.warp(geometry, plane, spacing, scene.background),
        _ => warp_passes(&passes, plane, spacing, scene.background),
    });
    Ok(Rendering {
        picture: Picture::new(plane.width, plane.height, pixels)?,
        phases: vec![Phase { name: "rays", seconds }, warp],
        samples: bases.iter().map(|base| base.samples).sum(),
        bytes: volume.data.bytes(),
        bound: None,
    })
}
