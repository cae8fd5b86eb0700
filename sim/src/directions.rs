//! What a file's directions mean for a run: which side of the picture is which, and what is to be said of them.

use crate::problem::Outcome;
use cube3_report::{AxesReport, SidesReport};
use cube3_scene::{Scene, View};
use cube3_volume::{Space, World};
use std::path::Path;

/// How the file's axes became those of the frame buffer; `None` where the file says nothing of them.
pub(crate) fn axes_report(world: &World) -> Option<AxesReport> {
    if world.space == Space::Unknown && world.taken.is_stored() {
        return None;
    }
    let left = world.left_over();
    Some(AxesReport {
        stored: world.stored_letters(),
        drawn: world.letters(),
        turned_deg: left.turned_deg,
        slanted_deg: left.slanted_deg,
    })
}

/// Which side of the picture is which side of the patient; `None` where the volume is of none.
///
/// # Errors
/// A view without a direction.
pub(crate) fn sides_report(view: &View, world: &World) -> Outcome<Option<SidesReport>> {
    if world.space != Space::Patient {
        return Ok(None);
    }
    let frame = view.frame()?;
    let side = |direction: glam::DVec3| world.side(direction.to_array());
    Ok(Some(SidesReport {
        left: side(-frame.right),
        right: side(frame.right),
        top: side(frame.up),
        bottom: side(-frame.up),
        front: side(-frame.direction),
    }))
}

/// What no turn of axes takes away.
pub(crate) fn left_over_note(file: &Path, world: &World, labels: bool) -> Option<String> {
    let (file, filter) = (file.display(), if labels { " --filter nearest" } else { "" });
    world.left_over().in_words().map(|left| {
        format!(
            "{file}: {left}; it is drawn along its own axes, and `cube3 volume resample {file} straight.nrrd --straight{filter}` makes one that lies straight"
        )
    })
}

/// Scenes of format 1 counted the voxels of a file as they are stored.
pub(crate) fn old_format_note(scene: &Scene, world: &World) -> Option<String> {
    let turned = scene.schema == 1 && !world.taken.is_stored();
    turned.then(|| {
        format!(
            "the scene is of format 1, in which files were drawn as they are stored, here {}; it is now drawn {}, and cuts, crop and eye count \
             in these voxels: look at it and write schema = 2, or volume.axes = \"stored\" for the picture as it was",
            world.stored_letters(),
            world.letters()
        )
    })
}
