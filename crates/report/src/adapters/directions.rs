//! What a file's directions mean for a picture: which of its sides is which.

use crate::{AxesReport, SidesReport};
use cube3_scene::{SceneError, View};
use cube3_volume::{Space, World};

/// How the file's axes became those of the frame buffer; `None` where the file says nothing of them.
pub fn axes_report(world: &World) -> Option<AxesReport> {
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
pub(crate) fn sides_report(view: &View, world: &World) -> Result<Option<SidesReport>, SceneError> {
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
