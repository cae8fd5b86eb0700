//! A volume-sampled sphere, and concentric shells: fields of the distance from a centre.

use super::PhantomParams;
use super::solid::smooth_coverage;
use crate::{Volume, VolumeError};

/// The ramp's width of a sphere where none is given, in voxels.
const RAMP_VOXELS: f64 = 2.2;

/// value = 65535·(3t² − 2t³), t = clamp(½ + (R − r)/w, 0, 1), r the distance from the centre in voxels. The mass
/// (sum of value/65535) tends to 4/3·π·R³ + π/5·R·w². With R = 26 and w = 2.2 on 64 voxels a side the
/// gradient estimators have the errors of the design's table.
pub(super) fn sphere(size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
    let centre = centre(size, params)?;
    let radius = params.radius.unwrap_or(size as f64 * 26.0 / 64.0);
    let ramp = params.ramp.unwrap_or(RAMP_VOXELS);
    let positive = |v: f64| v.is_finite() && v > 0.0;
    if !positive(radius) || !positive(ramp) {
        return Err(VolumeError::Parameter {
            name: "sphere",
            reason: format!("radius {radius}, ramp {ramp}"),
            remedy: "both must be positive and finite, in voxels",
        });
    }
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let inside = smooth_coverage(distance(centre, x, y, z) - radius, ramp);
        (inside * f64::from(u16::MAX)).round() as u16
    })
}

/// Thickness of each shell in voxels, from the inside out.
pub(super) const SHELLS_VOXELS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 0.25];

/// Shells of [`SHELLS_VOXELS`], their middles at 1/8, 2/8 … 6/8 of the half side. Each voxel is the
/// mean over a length of one voxel along the radius, so a shell thinner than a voxel keeps its mass:
/// value = 65535·Σ |[r − ½, r + ½] ∩ [middle − t/2, middle + t/2]|. In small cubes, where shells
/// touch, the sum is clipped.
pub(super) fn shells(size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
    let centre = centre(size, params)?;
    Volume::from_fn([size; 3], [1.0; 3], |x, y, z| {
        let r = distance(centre, x, y, z);
        let share = |(i, &thickness): (usize, &f64)| {
            let middle = (i + 1) as f64 / 8.0 * size as f64 / 2.0;
            let (low, high) = (middle - thickness / 2.0, middle + thickness / 2.0);
            ((r + 0.5).min(high) - (r - 0.5).max(low)).max(0.0)
        };
        let inside: f64 = SHELLS_VOXELS.iter().enumerate().map(share).sum();
        (inside.min(1.0) * f64::from(u16::MAX)).round() as u16
    })
}

fn centre(size: usize, params: &PhantomParams) -> Result<[f64; 3], VolumeError> {
    let centre = params.centre.unwrap_or([(size as f64 - 1.0) / 2.0; 3]);
    if centre.iter().all(|c| c.is_finite()) {
        return Ok(centre);
    }
    Err(VolumeError::Parameter {
        name: "centre",
        reason: format!("{centre:?} is no position"),
        remedy: "give three finite coordinates in voxels",
    })
}

/// Distance of voxel (x, y, z) from a centre. The squares are added in order of size, so that the
/// cube's symmetries hold to the bit.
fn distance(centre: [f64; 3], x: usize, y: usize, z: usize) -> f64 {
    let mut squares = [x as f64 - centre[0], y as f64 - centre[1], z as f64 - centre[2]].map(|d| d * d);
    squares.sort_by(f64::total_cmp);
    (squares[0] + squares[1] + squares[2]).sqrt()
}
