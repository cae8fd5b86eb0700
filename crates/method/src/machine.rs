//! The machine itself: with its clock, and without.

use crate::{RenderError, Subject};
use cube3_frame::{BasePlane, FrameSetup, Geometry};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{PictureFrames, warp_passes};
use cube3_picture::{Phase, Picture, Rendering, Watch};
use cube3_pipeline::{Machine, RunError};
use cube3_rendering::{About, Feature, Settings};

/// One voxel from the pixel to the rays beside it, one along the ray to the sample that stands for a place, one to the next discrete ray where the
/// cell is sheared, and the cell itself.
pub(crate) const REACH_VOXEL: f64 = 4.0;

/// Without the clock.
pub(crate) const FUNCTION: About = About {
    name: "function",
    what: "the machine without its clock: the units' arithmetic over whole planes, on all cores",
    source: "Pfister et al. 1995, in words",
    supports: &Feature::ALL,
    options: &[],
    in_words: true,
    reach_voxel: REACH_VOXEL,
};

/// Cycle by cycle.
pub(crate) const CYCLE: About = About {
    name: "cycle",
    what: "the machine cycle by cycle, with data in every token",
    source: "Pfister et al. 1995, in words",
    supports: &Feature::ALL,
    options: &[],
    in_words: true,
    reach_voxel: REACH_VOXEL,
};

pub(crate) fn function(subject: &Subject<'_>, _: &Settings, watch: Watch<'_>) -> Result<Rendering, RenderError> {
    let frames = subject.frames()?;
    let words = &subject.volume.words;
    let (mut turning, mut planes) = (0.0, 0.0);
    let mut bases = Vec::new();
    for setup in &frames.setups {
        let (turned, turn) = Phase::of("turn", || CanonicalVolume::new(&setup.geometry.axes, words.dims, &words.words));
        let (run, rays) =
            Phase::of("rays", || render(setup, &turned, subject.plan, &|done, all| watch("rays", done, all)));
        turning += turn.seconds;
        planes += rays.seconds;
        bases.push(run.base);
    }
    let phases = vec![Phase { name: "turn", seconds: turning }, Phase { name: "rays", seconds: planes }];
    shown(subject, &frames, &bases, phases)
}

pub(crate) fn cycle(subject: &Subject<'_>, _: &Settings, watch: Watch<'_>) -> Result<Rendering, RenderError> {
    let frames = subject.frames()?;
    let words = &subject.volume.words;
    let mut phases = Vec::new();
    let mut bases = Vec::new();
    if !frames.setups.is_empty() {
        let build = || Machine::cycle(subject.machine, frames.setups.clone(), words.dims, &words.words);
        let (machine, load) = Phase::of("load", build);
        let mut machine = machine?;
        let (done, cycles) = Phase::of("cycles", || machine.run(&|done, all| watch("cycles", done, all)));
        done.map_err(RunError::from)?;
        phases.extend([load, cycles]);
        bases = machine.into_base_planes();
    }
    shown(subject, &frames, &bases, phases)
}

/// The picture of base planes, of the phases that made them.
fn shown(
    subject: &Subject<'_>,
    frames: &PictureFrames,
    bases: &[BasePlane],
    mut phases: Vec<Phase>,
) -> Result<Rendering, RenderError> {
    let geometries = frames.setups.iter().map(|setup| &setup.geometry);
    let passes: Vec<(&BasePlane, &Geometry)> = bases.iter().zip(geometries.clone()).collect();
    let (plane, words) = (&frames.plane, &subject.volume.words);
    let (pixels, warp) = Phase::of("warp", || warp_passes(&passes, plane, words.spacing, subject.scene.background));
    phases.push(warp);
    Ok(Rendering {
        picture: Picture::new(plane.width, plane.height, pixels)?,
        phases,
        samples: geometries.map(Geometry::sample_count).sum(),
        bytes: 2 * words.words.len() as u64 + frames.setups.iter().map(|setup| table_bytes(setup)).sum::<u64>(),
        bound: None,
    })
}

/// Bytes of a frame's tables of classification: words of 32 bits.
fn table_bytes(setup: &FrameSetup) -> u64 {
    let tables = &setup.classification;
    4 * (tables.opacity.len() + 3 * tables.colour.len()) as u64
}
