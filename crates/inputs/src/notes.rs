//! What a volume's file leaves to be said, in sentences.

use cube3_scene::Scene;
use cube3_volume::World;
use std::path::Path;

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
