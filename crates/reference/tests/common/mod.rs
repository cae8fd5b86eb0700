//! What several tests need: geometries, volumes without structure, and distances.
#![allow(dead_code)]

use cube3_frame::{Geometry, largest_offset, slope_register};

use cube3_host::canonical;

use cube3_machine::{RaySlots, TemplateRule};
use cube3_scene::{Image, Scene, View};
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

/// A number 0 to 1 that looks random, from coordinates and a seed.
pub fn hash(seed: u64, at: [usize; 3]) -> f64 {
    let mut state = seed ^ 0x9e37_79b9_7f4a_7c15;
    for coordinate in at {
        state = (state ^ coordinate as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state ^= state >> 29;
    }
    state = state.wrapping_mul(0x94d0_49bb_1331_11eb);
    (state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Noise from 0 to 255.
pub fn noise(dims: [usize; 3], spacing: [f64; 3], seed: u64) -> Volume {
    Volume::from_fn(dims, spacing, |x, y, z| (hash(seed, [x, y, z]) * 255.0) as u8).unwrap()
}

/// `constant + slope · voxel`.
pub fn affine(dims: [usize; 3], spacing: [f64; 3], slope: [f64; 3], constant: f64) -> Volume {
    Volume::from_fn(dims, spacing, |x, y, z| constant + slope[0] * x as f64 + slope[1] * y as f64 + slope[2] * z as f64)
        .unwrap()
}

/// A scene along a direction.
pub fn scene_along(direction: [f64; 3]) -> Scene {
    Scene { view: View::from_direction(direction, None), ..Scene::default() }
}

/// A picture of one voxel a pixel.
pub fn one_voxel_a_pixel(width_px: u32, height_px: u32) -> Image {
    Image { width_px, height_px, pixel_size_voxel: Some(1.0) }
}

/// Where the line `origin + t·direction`, in voxels, is in the box of voxel centres, the crop box and the cuts, for t in `range`: what is
/// least inside is concave along a line, so that its top is found by thirds, and the two ends by halves.
pub fn stretch(scene: &Scene, dims: [usize; 3], origin: DVec3, direction: DVec3, range: [f64; 2]) -> Option<[f64; 2]> {
    let mut faces: Vec<(DVec3, DVec3)> = Vec::new();
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        faces.push((-axis, DVec3::ZERO));
        faces.push((axis, DVec3::from(dims.map(|n| (n - 1) as f64))));
        if let Some(crop) = &scene.crop {
            faces.push((-axis, crop.min_voxel.into()));
            faces.push((axis, crop.max_voxel.into()));
        }
    }
    faces.extend(scene.cuts.iter().map(|cut| (DVec3::from(cut.normal), DVec3::from(cut.through_voxel))));
    let inside = |t: f64| {
        let at = origin + direction * t;
        faces.iter().map(|(out, on)| out.dot(*on - at)).fold(f64::INFINITY, f64::min)
    };
    let [mut from, mut to] = range;
    for _ in 0..200 {
        let third = (to - from) / 3.0;
        if inside(from + third) < inside(to - third) { from += third } else { to -= third }
    }
    let top = f64::midpoint(from, to);
    let end = |mut beyond: f64| {
        let mut there = top;
        for _ in 0..200 {
            let middle = f64::midpoint(there, beyond);
            if inside(middle) >= 0.0 { there = middle } else { beyond = middle }
        }
        there
    };
    (inside(top) >= -1e-12).then(|| range.map(end))
}

/// The paper's error: mean Euclidean distance in RGB over √3, in percent.
pub fn mean_relative_percent(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| DVec3::from(*a).distance(DVec3::from(*b));
    100.0 * a.iter().zip(b).map(distance).sum::<f64>() / a.len() as f64 / 3_f64.sqrt()
}

/// The largest difference between two rows of numbers.
pub fn largest_difference<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let of_pixel = |(a, b): (&[f64; N], &[f64; N])| (0..N).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(of_pixel).fold(0.0, f64::max)
}
