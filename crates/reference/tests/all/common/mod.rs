//! What several tests need: volumes and scenes, the symmetries of the cube, lengths and distances by other methods.

pub mod brute_force;
pub mod labels;
pub mod order;
pub mod turn;

use cube3_scene::{Image, Material, Mode, Scene, Transfer, View, corrected_opacity};
use cube3_volume::Volume;
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// A number 0 to 1 that looks random, from coordinates and a seed.
pub fn hash(seed: u64, at: [usize; 3]) -> f64 {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(at.iter().rev().fold(0, |place, &coordinate| place << 20 | coordinate as u64));
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
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

/// A volume of one value.
pub fn constant(dims: [usize; 3]) -> Volume {
    Volume::from_fn(dims, [1.0; 3], |_, _, _| 100_u8).unwrap()
}

/// Fog of so much opacity a voxel, not lit.
pub fn fog(opacity: f64) -> Scene {
    Scene {
        transfer: Transfer { opacity: vec![[0.0, opacity]], ..Transfer::default() },
        material: Material { shaded: false, ..Material::default() },
        view: View::from_angles(0.0, 0.0),
        image: one_voxel_a_pixel(1, 1),
        ..Scene::default()
    }
}

/// A soft ball that vanishes before the border, on n³ voxels: a cube of the world of side 1.
pub fn ball(n: usize) -> Volume {
    let spacing = 1.0 / n as f64;
    Volume::from_fn([n; 3], [spacing; 3], |x, y, z| {
        let square: f64 = [x, y, z].map(|i| ((i as f64 + 0.5) * spacing - 0.5) / 0.42).map(|c| c * c).iter().sum();
        200.0 * (1.0 - square).max(0.0).powi(3)
    })
    .unwrap()
}

/// The ball's scene on n³ voxels: opacity is per voxel, so that finer voxels are clearer.
pub fn ball_scene(n: usize, mode: Mode) -> Scene {
    let per_voxel = |alpha: f64| corrected_opacity(alpha, 32.0 / n as f64);
    Scene {
        mode,
        view: View::from_angles(24.0, 11.0),
        image: Image { width_px: 24, height_px: 24, pixel_size_voxel: Some(n as f64 / 24.0) },
        transfer: Transfer {
            opacity: (0..=40).map(|i| [5.0 * f64::from(i), per_voxel(0.005 * f64::from(i))]).collect(),
            ..Transfer::default()
        },
        ..Scene::default()
    }
}

/// A scene along a direction.
pub fn scene_along(direction: [f64; 3]) -> Scene {
    Scene { view: View::from_direction(direction, None), ..Scene::default() }
}

/// A picture of one voxel a pixel.
pub fn one_voxel_a_pixel(width_px: u32, height_px: u32) -> Image {
    Image { width_px, height_px, pixel_size_voxel: Some(1.0) }
}

/// Along axes, between them, and with slopes of 1 and a hair less.
pub const VIEWS: [[f64; 3]; 5] =
    [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.4, 0.3, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0_f64.next_down(), 0.0]];

/// Numbers of pictures, 0 to 1.
pub fn assert_sane(pixels: impl IntoIterator<Item = f64>) {
    assert!(pixels.into_iter().all(|c| (0.0..=1.0 + 1e-12).contains(&c)));
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

/// The largest difference between two rows of numbers.
pub fn largest_difference<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let of_pixel = |(a, b): (&[f64; N], &[f64; N])| (0..N).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(of_pixel).fold(0.0, f64::max)
}
