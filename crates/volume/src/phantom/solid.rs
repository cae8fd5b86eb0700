use crate::{PhantomParams, Volume, VolumeError};
pub(super) fn sphere(size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
    let c = params.centre.unwrap_or([(size as f64 - 1.0) / 2.0; 3]);
    let r0 = params.radius.unwrap_or(size as f64 * 26.0 / 64.0);
    let w = params.ramp.unwrap_or(2.2);
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let r = (x as f64 - c[0]).hypot(y as f64 - c[1]).hypot(z as f64 - c[2]);
        (((r0 - r) / w + 0.5).clamp(0.0, 1.0) * 65535.0).round() as u16
    })
}
