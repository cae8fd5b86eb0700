//! What several tests need: the machine's geometries, and what the reference's tests need too.

#[path = "../../../../reference/tests/all/common/mod.rs"]
mod shared;

pub mod passes;

pub use shared::*;

use cube3_frame::{Geometry, largest_offset, slope_register};
use cube3_host::canonical;
use cube3_machine::{RaySlots, TemplateRule};
use cube3_scene::Scene;
use cube3_volume::{Volume, thick_dims};
use glam::DVec3;

/// Fraction bits of weights and offset: the default machine's.
pub const WEIGHT_BITS: u32 = 8;

/// The machine's geometry for a view direction, with the largest legal offset up to `offset`.
pub fn geometry_along(volume: &Volume, direction: DVec3, rule: TemplateRule, offset: f64) -> Geometry {
    let view = canonical(direction, volume.spacing);
    let slopes = view.slopes.map(slope_register);
    let wanted = (offset * f64::from(1 << WEIGHT_BITS)) as u32;
    let offset = wanted.min(largest_offset(rule, slopes, WEIGHT_BITS));
    let size = view.axes.permute(thick_dims(volume.dims));
    Geometry::new(size, view.axes, slopes, offset, WEIGHT_BITS, rule, RaySlots::Wrapped)
}

/// The same for a scene's view, by the paper's rule and o = ½ where it may be.
pub fn geometry(volume: &Volume, scene: &Scene) -> Geometry {
    geometry_along(volume, scene.view.frame().unwrap().direction, TemplateRule::SampleFloor, 0.5)
}

/// The paper's error: mean Euclidean distance in RGB over √3, in percent.
pub fn mean_relative_percent(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| DVec3::from(*a).distance(DVec3::from(*b));
    100.0 * a.iter().zip(b).map(distance).sum::<f64>() / a.len() as f64 / 3_f64.sqrt()
}
