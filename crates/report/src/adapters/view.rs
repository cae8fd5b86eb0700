//! The view as a frame of the machine has it.

use super::directions::sides_report;
use crate::{PassReport, PerspectiveReport, ViewReport};
use cube3_frame::{FrameSetup, Geometry};
use cube3_host::{PictureFrames, canonical};
use cube3_machine::{RaySlots, TemplateRule};
use cube3_scene::{Scene, SceneError};
use cube3_volume::World;

/// The view's part of the report, for a volume of this `spacing` whose file's axes lie so in the world.
///
/// # Errors
/// A view without a direction.
pub fn view_report(
    scene: &Scene,
    spacing: [f64; 3],
    world: &World,
    frames: &PictureFrames,
) -> Result<ViewReport, SceneError> {
    let central = canonical(frames.view.direction, spacing);
    let geometry = frames.setups.first().map(|setup| &setup.geometry);
    let axes = geometry.map_or(central.axes, |geometry| geometry.axes);
    let mut flips = [false; 3];
    for i in 0..3 {
        flips[axes.axis[i]] = axes.reversed[i];
    }
    let (rule, slots) = geometry.map_or(("no frame", ""), |geometry| {
        let rule = match geometry.rule {
            TemplateRule::SampleFloor => "sample-floor",
            TemplateRule::PlaneFloor => "plane-floor",
            TemplateRule::Nearest => "nearest voxel",
        };
        let slots = match geometry.slots {
            _ if geometry.perspective.is_some() => ", a slot for each ray",
            RaySlots::Wrapped => ", wrapped",
            RaySlots::Padded => ", padded",
        };
        (rule, slots)
    });
    let parallel = geometry.filter(|geometry| geometry.perspective.is_none());
    Ok(ViewReport {
        sides: sides_report(&scene.view, world)?,
        major_axis: AXES[axes.axis[2]].into(),
        flips,
        slopes: parallel.map_or(central.slopes, Geometry::real_slopes),
        offset: geometry.map_or(0.0, Geometry::real_offset),
        template_rule: format!("{rule}{slots}"),
        base_plane_size: geometry.map_or([0; 2], Geometry::base_plane_size),
        perspective: frames.eye_voxel.map(|eye_voxel| PerspectiveReport {
            eye_voxel,
            field_of_view_deg: scene.view.perspective.map_or(0.0, |perspective| perspective.field_of_view_deg),
            passes: frames.setups.iter().filter_map(|setup| pass_report(setup)).collect(),
        }),
    })
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn pass_report(setup: &FrameSetup) -> Option<PassReport> {
    let geometry = &setup.geometry;
    let coverage = geometry.coverage()?;
    let sign = if geometry.axes.reversed[2] { "−" } else { "+" };
    Some(PassReport {
        axis: format!("{sign}{}", AXES[geometry.axes.axis[2]]),
        base_plane_size: geometry.base_plane_size(),
        offset: geometry.real_offset(),
        own_cells: geometry.doubled(),
        gradient: setup.gradient.map(|registers| registers.method.name().into()),
        back_spacing_voxel: coverage.back_spacing,
        unused_voxel_fraction: coverage.unused,
        widest_cell_voxel: coverage.widest_cell,
    })
}
