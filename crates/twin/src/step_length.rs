//! How far a ray gets from a sample to the next.

use cube3_frame::Geometry;
use cube3_scene::smallest_spacing;
use glam::DVec3;

/// From a sample of a parallel ray to the next, along u, v, w, in the unit of the `spacing` (x, y, z): a voxel along w, and du and dv of one
/// along u and v. Pfister et al. 1995, section 2.
pub(crate) fn step(geometry: &Geometry, spacing: [f64; 3]) -> DVec3 {
    let [du, dv] = geometry.real_slopes();
    DVec3::new(du, dv, 1.0) * DVec3::from(geometry.axes.permute(spacing))
}

/// The length of a parallel ray's step, in the smallest voxel spacing: ℓ = |(s_u·du, s_v·dv, s_w)| / min s, what opacity is corrected to.
/// `spacing` is along x, y, z.
///
/// The slopes are exactly the geometry's, which are multiples of 2⁻³⁰.
pub fn step_length(geometry: &Geometry, spacing: [f64; 3]) -> f64 {
    step(geometry, spacing).length() / smallest_spacing(spacing)
}
