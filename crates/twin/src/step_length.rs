//! How far a ray gets from a sample to the next.

use crate::rays::Line;
use cube3_frame::Geometry;
use cube3_scene::smallest_spacing;

/// The length of a parallel ray's step, in the smallest voxel spacing: ℓ = |(s_u·du, s_v·dv, s_w)| / min s, what opacity is corrected to.
/// `spacing` is along x, y, z.
///
/// The slopes are exactly the geometry's, which are multiples of 2⁻³⁰.
pub fn step_length(geometry: &Geometry, spacing: [f64; 3]) -> f64 {
    line_step_length(&Line::parallel(geometry), geometry, spacing)
}

/// The same of any ray of a frame.
pub(crate) fn line_step_length(line: &Line, geometry: &Geometry, spacing: [f64; 3]) -> f64 {
    line.step(geometry, spacing).length() / smallest_spacing(spacing)
}
