//! Says where a picture depends on what the samples at the ends of rays stand for.

use crate::Outcome;
use crate::machine_run::function;
use crate::pictures::show;
use cube3_frame::FrameSetup;
use cube3_host::{PictureFrames, picture_setup};
use cube3_inputs::LoadedVolume;
use cube3_machine::{MachineSpec, RayEnds};
use cube3_metrics::{compare, footprint};
use cube3_picture::Picture;
use cube3_scene::Scene;

/// From how many levels of 255 on average over the object a note is given.
const LEVELS: f64 = 1.0;

/// A note where the picture with exact ends of rays is more than a level away on average over the object. The picture is rendered once more
/// only where an end of a ray can be visible.
pub(crate) fn note(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    frames: &PictureFrames,
    image: &Picture,
    plan: bool,
) -> Outcome<Option<String>> {
    if machine.rays.ends == RayEnds::Exact || !scene.mode.adds_up() || !ends_show(scene, volume, frames) {
        return Ok(None);
    }
    let mut exact = machine.clone();
    exact.rays.ends = RayEnds::Exact;
    // Where its tables are too large, exact ends cannot be had.
    let Ok(exact_frames) = picture_setup(scene, &exact, &volume.info(), plan) else {
        return Ok(None);
    };
    let (runs, _) = function(&exact_frames.setups, volume.words.dims, &volume.words.words, plan, &|_, _, _| {});
    let bases: Vec<_> = runs.into_iter().map(|run| run.base).collect();
    let (pictures, _) = show(&bases, &exact_frames, scene, volume)?;
    let Some(exact) = pictures.image else {
        return Ok(None);
    };
    let object = footprint(image, &exact, scene.background)?;
    let comparison = compare(image, &exact, Some(&object))?;
    let levels = comparison.footprint.map(|error| 255.0 * error.mean_relative);
    Ok(levels.filter(|levels| *levels > LEVELS).map(|levels| {
        format!(
            "each sample stands for a whole step, also at the ends of rays: with rays.ends = \"exact\" the picture differs by {levels:.1} of \
             255 levels on average over the object"
        )
    }))
}

/// Whether the first or last sample of a ray can be seen: crop and cuts have ends in the volume, an eye has them before it, and else they lie
/// in the outermost cells.
fn ends_show(scene: &Scene, volume: &LoadedVolume, frames: &PictureFrames) -> bool {
    let dims = volume.words.dims;
    let eye_inside = frames.eye_voxel.is_some_and(|eye| (0..3).all(|i| (0.0..=(dims[i] - 1) as f64).contains(&eye[i])));
    if scene.crop.is_some() || !scene.cuts.is_empty() || eye_inside {
        return true;
    }
    let Some(setup) = frames.setups.first() else {
        return false;
    };
    let shown = shown(setup);
    let [nx, ny, nz] = dims;
    let outer = |i: usize, n: usize| i < 2 || i + 2 >= n;
    (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))).any(|(y, z)| {
        let row = &volume.words.words[(z * ny + y) * nx..][..nx];
        let visible = |word: &u16| shown[usize::from(*word)];
        if outer(y, ny) || outer(z, nz) {
            return row.iter().any(visible);
        }
        row[..2].iter().chain(&row[nx - 2..]).any(visible)
    })
}

/// By voxel word: whether a sample of that word has an opacity at any gradient.
fn shown(setup: &FrameSetup) -> Vec<bool> {
    let (words, table) = (&setup.words, &setup.classification);
    let entries = table.colour.len();
    let opaque: Vec<bool> =
        (0..entries).map(|entry| table.opacity.iter().skip(entry).step_by(entries).any(|&alpha| alpha > 0)).collect();
    (0..1_usize << words.voxel_bits)
        .map(|word| opaque[(word << words.sample_fraction_bits >> table.index_shift).min(entries - 1)])
        .collect()
}
