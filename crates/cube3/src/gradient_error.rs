//! How far the machine's gradients are from the true ones, where the scene shows a surface.

use cube3_abc::golden::{classify_in, in_place, normalise};
use cube3_definition::Definition;
use cube3_frame::{DiscreteRay, FrameSetup, PerspectivePass, SLOPE_FRACTION_BITS};
use cube3_host::{Basis, whole_step_opacity};
use cube3_volume::VoxelWords;
use glam::DVec3;
use std::borrow::Borrow;

/// Most rays that are looked at: a grid of them, if there are more.
const MOST_RAYS: usize = 16_384;

/// Mean angle in degrees between the machine's gradient words and central differences of the exactly interpolated volume,
/// at the first sample of each ray that the classification makes at least half opaque, over all frames of a picture. None where
/// no ray has one, or no frame has a gradient.
pub fn mean_angle_deg(setups: &[impl Borrow<FrameSetup>], volume: &VoxelWords) -> Option<f64> {
    let pairs = setups.iter().flat_map(|setup| gradient_pairs(setup.borrow(), volume));
    let error = cube3_metrics::mean_angle_deg(pairs).ok()?;
    error.mean_deg.filter(|_| error.count > error.degenerate)
}

/// The machine's gradients and the true ones.
fn gradient_pairs(setup: &FrameSetup, volume: &VoxelWords) -> Vec<([f64; 3], [f64; 3])> {
    let Some(registers) = &setup.gradient else {
        return Vec::new();
    };
    let geometry = &setup.geometry;
    let basis = Basis::new(geometry, volume.spacing, registers.method);
    let [width, height] = geometry.base_plane_size();
    let fits = |stride: &usize| width.div_ceil(*stride) * height.div_ceil(*stride) <= MOST_RAYS;
    let stride = (1..).find(fits).unwrap_or(1);
    let defined = Definition::new(setup, &volume.words);
    let whole = match &setup.ends {
        Some(_) => whole_step_opacity(setup.cone.mode, &setup.words, geometry.bounding_planes()),
        None => cube3_word::unit_full(setup.words.opacity_bits),
    };
    let half = whole.div_ceil(2);
    let mut pairs = Vec::new();
    for row in (0..height).step_by(stride) {
        for column in (0..width).step_by(stride) {
            // Rays beyond slopes of 1 serve the warp of their neighbours; pictures show those of another pass.
            let steep = |slopes: &[i64], i: usize| slopes[i].abs() > 1 << SLOPE_FRACTION_BITS;
            let other = |pass: &PerspectivePass| steep(&pass.u.slopes, column) || steep(&pass.v.slopes, row);
            if geometry.perspective.as_ref().is_some_and(other) {
                continue;
            }
            let first = geometry.first_ray();
            let ray = DiscreteRay { u: first.u + column as i64, v: first.v + row as i64 };
            let class = setup.rays.as_ref().map_or(0, |rays| rays.length_class(row, column));
            let gradient = |k: i64| defined.gradient(ray, k).unwrap_or_default();
            let opaque = |k: &usize| {
                let (k, table) = (*k as i64, &setup.classification);
                let Some(sample) = defined.sample(ray, k).filter(|_| in_place(ray, k, setup)) else {
                    return false;
                };
                let magnitude = match (&table.gradient_rows, &setup.normaliser) {
                    (Some(_), Some(normaliser)) => normalise(gradient(k), normaliser, &setup.words).magnitude,
                    _ => 0,
                };
                classify_in(class, sample, magnitude, table).is_some_and(|(opacity, _)| opacity >= half)
            };
            if let Some(k) = (0..geometry.size[2]).find(opaque) {
                let world = basis.world(&geometry.axes, gradient(k as i64).map(f64::from));
                let at = geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k));
                pairs.push((world.to_array(), true_gradient(volume, at).to_array()));
            }
        }
    }
    pairs
}

/// Central differences, a voxel to either side, of the trilinear interpolation; in the world. Beyond the volume is word 0.
fn true_gradient(volume: &VoxelWords, at: [f64; 3]) -> DVec3 {
    let difference = |axis: usize| {
        let moved = |by: f64| {
            let mut place = at;
            place[axis] += by;
            trilinear(volume, place)
        };
        (moved(1.0) - moved(-1.0)) / (2.0 * volume.spacing[axis])
    };
    DVec3::new(difference(0), difference(1), difference(2))
}

fn trilinear(volume: &VoxelWords, at: [f64; 3]) -> f64 {
    let corner = at.map(f64::floor);
    let mut sum = 0.0;
    for bits in 0..8 {
        let mut weight = 1.0;
        let mut place = [0; 3];
        let mut inside = true;
        for axis in 0..3 {
            let far = bits >> axis & 1;
            let part = at[axis] - corner[axis];
            weight *= if far == 1 { part } else { 1.0 - part };
            let index = corner[axis] as i64 + far;
            inside &= (0..volume.dims[axis] as i64).contains(&index);
            place[axis] = index as usize;
        }
        if inside && weight > 0.0 {
            sum += weight * f64::from(volume.word(place[0], place[1], place[2]));
        }
    }
    sum
}
