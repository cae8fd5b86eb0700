//! What of scene and machine a frame goes by.

use cube3_frame::Geometry;
use cube3_machine::{Abc, GradientMethod, MachineSpec};
use cube3_scene::{Mode, Scene};
use std::borrow::Cow;

/// Whether opacities are corrected to the length of a step.
pub(crate) fn corrects_opacity(scene: &Scene) -> bool {
    scene.mode == Mode::Composite && scene.transfer.opacity_correction
}

/// Rays that are no farther apart than this anywhere, in voxels, are near throughout.
const NEAR_SPACING: f64 = 2.0;

/// The machine as a frame uses it: where rays share columns, a ray moves by more than a ray from plane to plane, and the four samples of
/// estimator 12 are too near. Two multiplications do it: of 26d, whose nine differences for each component bear near samples best, or of
/// 6d where rays are also far apart, and sums over them would smooth too much.
pub(crate) fn in_frame<'a>(machine: &'a MachineSpec, geometry: &Geometry) -> Cow<'a, MachineSpec> {
    let Some(pass) = &geometry.perspective else {
        return Cow::Borrowed(machine);
    };
    let back = pass.spacing_at(geometry.size[2] as i64 - 1, geometry.offset, geometry.weight_bits);
    let gradient = match machine.abc.gradient {
        GradientMethod::Twelve if pass.doubled && back <= NEAR_SPACING => GradientMethod::TwentySixSheared,
        GradientMethod::Twelve if pass.doubled => GradientMethod::SixSheared,
        // Nothing reads the gradient, or it would have been refused.
        method if method.row().needs_parallel_rays() => GradientMethod::SixSheared,
        method => method,
    };
    Cow::Owned(MachineSpec { abc: Abc { gradient, ..machine.abc }, ..machine.clone() })
}
