//! What every caster asks of its input before the first ray.

use crate::RaycastError;
use cube3_scene::Scene;
use cube3_volume::Volume;
use std::borrow::Cow;

/// Volume and scene as they are drawn: an axis of one voxel is one thick ([`Volume::thickened`]). A voxel of labels is so already.
pub fn thickened<'a>(volume: &'a Volume, scene: &'a Scene) -> (Cow<'a, Volume>, Cow<'a, Scene>) {
    if scene.volume.labels {
        return (Cow::Borrowed(volume), Cow::Borrowed(scene));
    }
    (volume.thickened(), scene.thickened(volume.dims.map(|n| n == 1)))
}

/// A gradient adds up to this many times the range of the values: 26 neighbours with weights that add to 4 on
/// each side, doubled by the difference, and again for the shear.
const RANGES_IN_A_GRADIENT: f64 = 16.0;

/// The volume is a grid of finite values that can be subtracted from each other and from `border`, the data value beyond its voxels.
///
/// # Errors
/// Parts that do not fit together, a spacing that is none, a value or a border that is not finite, values too far apart.
pub fn check_volume(volume: &Volume, border: f64) -> Result<(), RaycastError> {
    let wrong = |reason, right| Err(RaycastError::Volume { reason, right });
    let [x, y, z] = volume.dims;
    let voxels = x.checked_mul(y).and_then(|xy| xy.checked_mul(z));
    if voxels != Some(volume.samples.len()) || voxels == Some(0) {
        let reason = format!("{} samples for {x}×{y}×{z} voxels", volume.samples.len());
        return wrong(reason, "give one sample for each voxel, at least one");
    }
    if !volume.spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        return wrong(format!("{:?} is no voxel spacing", volume.spacing), "give three positive numbers");
    }
    if !border.is_finite() {
        return Err(RaycastError::Option {
            name: "border",
            value: border,
            reason: "not a value",
            right: "give the data value beyond the volume's border, a finite number",
        });
    }
    if volume.sample_type().is_float() {
        let (low, high) = volume.range()?;
        let widest = high.max(border) - low.min(border);
        if !(widest * RANGES_IN_A_GRADIENT).is_finite() {
            return wrong(
                format!("values from {low:e} to {high:e} are too far apart to be subtracted"),
                "scale them to below 10^300",
            );
        }
    }
    Ok(())
}
