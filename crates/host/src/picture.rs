//! All that a picture needs: one frame for a parallel view, up to three and more for an eye.
//!
//! A ray of the picture belongs to the *pass* of its major axis, the voxel axis and sign along which it is longest in voxels; ties go
//! to z before y before x. Each pass is a frame of its own with its own base plane, and the warp joins them.

use crate::setup::{check_perspective, checked_view, registers, template_rule, wanted_offset};
use crate::{HostError, VolumeInfo, canonical, frame_setup};
use cube3_frame::{Axes, FrameSetup, Geometry, PassShape};
use cube3_machine::MachineSpec;
use cube3_plan::{Item, Plan, Rules};
use cube3_scene::{ImagePlane, Scene, ViewFrame};
use std::sync::Arc;

/// The frames of a picture as the host has set them up.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFrames {
    /// Registers and tables: one frame for a parallel view; for an eye one for each pass, that of the view's direction first. None
    /// where no ray of the picture comes near the volume.
    pub setups: Vec<Arc<FrameSetup>>,
    /// The picture's axes.
    pub view: ViewFrame,
    /// The picture's pixels.
    pub plane: ImagePlane,
    /// The eye in voxel coordinates.
    pub eye_voxel: Option<[f64; 3]>,
    /// What the plan left out of the setups.
    pub left_out: Vec<Item>,
}

/// Sets up the frames of a picture; see [`frame_setup`] for `rules`.
///
/// # Errors
/// A view without a direction, volumes too large for the registers, and in perspective a gradient or shading unit that needs parallel
/// rays.
pub fn picture_setup(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    rules: impl Into<Rules>,
) -> Result<PictureFrames, HostError> {
    let rules = rules.into();
    let view = checked_view(scene, volume)?;
    let plane = ImagePlane::new(scene, &view, volume.dims, volume.spacing);
    let Some(eye_world) = plane.eye else {
        let frame = frame_setup(scene, machine, volume, rules)?;
        return Ok(PictureFrames {
            setups: vec![Arc::new(frame.setup)],
            view,
            plane,
            eye_voxel: None,
            left_out: frame.left_out,
        });
    };
    check_perspective(scene, machine)?;
    let given = scene.view.perspective.and_then(|perspective| perspective.eye_voxel);
    let eye = given.unwrap_or([0, 1, 2].map(|i| eye_world[i] / volume.spacing[i]));
    let offset = wanted_offset(scene, machine);
    let plan = Plan::new(scene, machine, rules);
    let mut frames = PictureFrames { setups: Vec::new(), view, plane, eye_voxel: Some(eye), left_out: Vec::new() };
    let shape = |axes: Axes| {
        let size = axes.permute(volume.dims);
        PassShape {
            size,
            axes,
            eye: axes.canonical_position(size, eye),
            offset,
            weight_bits: machine.words.weight_bits,
            rule: template_rule(scene, machine),
            grid: machine.rays.grid,
            reach: if plan.needs.gradient { machine.abc.reach } else { 1 },
            joins: false,
        }
    };
    let shapes: Vec<PassShape> = passes(&plane, &view, volume).into_iter().map(shape).collect();
    let joins = shapes.iter().filter(|shape| shape.is_near()).count() > 1;
    for shape in shapes {
        let geometry = Geometry::perspective(&PassShape { joins, ..shape });
        let Some(geometry) = geometry else {
            continue;
        };
        frames.setups.push(Arc::new(registers(scene, machine, volume, &plan, &view, geometry)));
    }
    frames.left_out = plan.items(machine, scene.lights.len(), &frames.setups);
    Ok(frames)
}

/// The major axis of a direction in voxels, and whether it runs against it; ties go to z before y before x.
pub(crate) fn major(direction: [f64; 3]) -> (usize, bool) {
    let axis = [2, 1, 0].into_iter().fold(
        2,
        |best, axis| {
            if direction[axis].abs() > direction[best].abs() { axis } else { best }
        },
    );
    (axis, direction[axis] < 0.0)
}

/// How far beyond the volume a ray of the picture may pass for its neighbours on the base plane to meet a voxel still: rays are 3
/// voxels apart at most. Not a whole number, or an eye on a voxel would be on its edge, where rounding decides.
const REACH: f64 = 4.000_001;

/// The axes of each pass that the picture needs: the one of the view's direction first, then the one with the most pixels.
fn passes(plane: &ImagePlane, view: &ViewFrame, volume: &VolumeInfo) -> Vec<Axes> {
    let mut sums = [[0.0; 3]; 6];
    let mut counts = [0_u64; 6];
    for row in 0..plane.height {
        for column in 0..plane.width {
            let (_, direction) = plane.ray(column as f64, row as f64);
            let direction = [0, 1, 2].map(|i| direction[i] / volume.spacing[i]);
            let through = plane.crossing(column as f64, row as f64);
            let through = [0, 1, 2].map(|i| through[i] / volume.spacing[i]);
            if !meets(through, direction, -plane.depth, volume.dims) {
                continue;
            }
            let (axis, reversed) = major(direction);
            let pass = 2 * axis + usize::from(reversed);
            counts[pass] += 1;
            for i in 0..3 {
                sums[pass][i] += direction[i] / direction[axis].abs();
            }
        }
    }
    let central = canonical(view.direction, volume.spacing).axes;
    let of_view = 2 * central.axis[2] + usize::from(central.reversed[2]);
    let mut order: Vec<usize> = (0..6).rev().filter(|&pass| counts[pass] > 0).collect();
    order.sort_by_key(|&pass| (pass != of_view, std::cmp::Reverse(counts[pass])));
    order
        .into_iter()
        .map(|pass| if pass == of_view { central } else { around(pass / 2, pass % 2 == 1, sums[pass]) })
        .collect()
}

/// Axes with a given w, u and v by a mean direction as [`canonical`] takes them.
fn around(w: usize, reversed: bool, mean: [f64; 3]) -> Axes {
    let mut others = [2, 1, 0].into_iter().filter(|&axis| axis != w);
    let (Some(a), Some(b)) = (others.next(), others.next()) else {
        unreachable!("three axes without one are two");
    };
    let [u, v] = if mean[b].abs() > mean[a].abs() { [b, a] } else { [a, b] };
    Axes { axis: [u, v, w], reversed: [mean[u] < 0.0, mean[v] < 0.0, reversed] }
}

/// Whether a ray from parameter `from` on passes through the volume or near it.
fn meets(origin: [f64; 3], direction: [f64; 3], from: f64, dims: [usize; 3]) -> bool {
    let mut range = [from, f64::INFINITY];
    for i in 0..3 {
        let [low, high] = [-REACH - origin[i], (dims[i] - 1) as f64 + REACH - origin[i]];
        if direction[i] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / direction[i], high / direction[i]);
        range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    }
    range[0] <= range[1]
}
