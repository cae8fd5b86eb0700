//! What true and sheared interpolation must be: exact on affine fields, apart by a closed form on x·z, equal where
//! the ray's columns do not move between planes.

use crate::common;
use crate::common::{affine, geometry_along, hash, mean_relative_percent, noise, scene_along};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::TemplateRule;
use cube3_scene::{Mode, Scene, View};
use cube3_twin::{DiscreteOptions, RealSamples, SampleCell, sheared, true_3d};
use cube3_volume::Volume;
use glam::DVec3;

const DIRECTIONS: [[f64; 3]; 6] =
    [[0.0, 1.0, 0.0], [0.3, 0.1, 1.0], [-0.9, 0.7, 1.0], [-1.0, 0.4, -0.2], [0.5, -1.0, 0.5], [1.0, 1.0, -1.0]];

/// Every sample of every ray, with its canonical position; those that lie beyond the last voxel by less than a weight
/// register can tell are left out.
fn samples(geometry: &Geometry) -> Vec<(DiscreteRay, usize, [f64; 3])> {
    let [width, height] = geometry.base_plane_size();
    let mut all = Vec::new();
    for row in 0..height {
        for column in 0..width {
            let ray =
                DiscreteRay { u: column as i64 - geometry.shear_u() as i64, v: row as i64 - geometry.shear_v() as i64 };
            for k in 0..geometry.size[2] {
                let position = geometry.sample_position(ray, k);
                let inside = (0..3).all(|i| position[i] <= (geometry.size[i] - 1) as f64);
                if inside && geometry.has_sample(ray, k as i64) {
                    all.push((ray, k, position));
                }
            }
        }
    }
    all
}

#[test]
fn affine_fields_come_out_exact() {
    let (slope, constant) = ([1.25, -3.5, 0.7], 40.0);
    let volume = affine([9, 7, 8], [1.0; 3], slope, constant);
    for direction in DIRECTIONS {
        for rule in [TemplateRule::SampleFloor, TemplateRule::PlaneFloor] {
            let geometry = geometry_along(&volume, DVec3::from(direction), rule, 0.5);
            for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
                let rays = RealSamples::new(&volume, &geometry, interpolation, 0.0).unwrap();
                let all = samples(&geometry);
                assert!(all.len() > 100);
                for (ray, k, position) in all {
                    let at = geometry.axes.voxel_position(geometry.size, position);
                    let expected: f64 = constant + (0..3).map(|i| slope[i] * at[i]).sum::<f64>();
                    let got = rays.sample(ray, k as i64).unwrap();
                    assert!((got - expected).abs() < 1e-11, "{got}, not {expected} at {at:?} along {direction:?}");
                }
            }
        }
    }
}

#[test]
fn on_x_times_z_the_two_differ_by_the_closed_form() {
    // Rays mainly along z, so u = x and w = z: f = 3·u·w, f_xz = 3.
    let volume = Volume::from_fn([9, 8, 10], [1.0; 3], |x, _, z| 3.0 * (x * z) as f64).unwrap();
    for (slope, rule, offset) in [
        (0.3, TemplateRule::SampleFloor, 0.5),
        (0.7, TemplateRule::SampleFloor, 0.5),
        (0.7, TemplateRule::PlaneFloor, 0.25),
        (1.0, TemplateRule::PlaneFloor, 0.5),
    ] {
        let geometry = geometry_along(&volume, DVec3::new(slope, 0.1, 1.0), rule, offset);
        assert_eq!((geometry.axes.axis, geometry.axes.reversed), ([0, 1, 2], [false; 3]));
        let by_shear = RealSamples::new(&volume, &geometry, SampleCell::Sheared, 0.0).unwrap();
        let exact = RealSamples::new(&volume, &geometry, SampleCell::Exact, 0.0).unwrap();
        let o = geometry.real_offset();
        let mut moved = 0;
        for (ray, k, _) in samples(&geometry) {
            let step = f64::from(geometry.u.columns[k + 1] - geometry.u.columns[k]);
            let difference = by_shear.sample(ray, k as i64).unwrap() - exact.sample(ray, k as i64).unwrap();
            assert!((difference - step * o * (1.0 - o) * 3.0).abs() < 1e-11, "{difference} at step {step}, o = {o}");
            moved += usize::from(step > 0.0);
        }
        assert!(moved > 50 && o > 0.0, "the field tells nothing where no column moves");
    }
}

#[test]
fn without_tilt_the_two_are_equal_at_0_and_45_degrees_and_apart_between() {
    let volume = noise([16; 3], [1.0; 3], 7);
    let options = DiscreteOptions::default();
    let angles = [0.0, 8.0, 16.0, 24.0, 33.0, 39.0, 43.0, 45.0];
    let error = |yaw_deg: f64, mode: Mode| {
        let scene = Scene { view: View::from_angles(yaw_deg, 0.0), mode, ..Scene::default() };
        let direction = scene.view.frame().unwrap().direction;
        let geometry = geometry_along(&volume, direction, TemplateRule::SampleFloor, 0.5);
        let by_shear = sheared(&volume, &scene, &geometry, &options, None).unwrap();
        let exact = true_3d(&volume, &scene, &geometry, &options, None).unwrap();
        assert_eq!(by_shear.samples, exact.samples);
        if yaw_deg % 45.0 == 0.0 {
            assert_eq!(by_shear, exact, "yaw {yaw_deg}");
            assert!(exact.pixels.iter().any(|pixel| pixel[3] > 0.0));
        }
        mean_relative_percent(&by_shear.over([0.0; 3]), &exact.over([0.0; 3]))
    };
    for yaw_deg in [-45.0, 90.0, 135.0, 180.0] {
        assert_eq!(error(yaw_deg, Mode::Composite), 0.0);
    }
    let errors = angles.map(|yaw_deg| error(yaw_deg, Mode::WeightedSum));
    println!("{errors:.4?}");
    assert_eq!((errors[0], errors[7]), (0.0, 0.0));
    // The error goes with du·o·(1−o), o = min(½, 1−du): a broad maximum from 24° to 37°.
    let peak = (0..8).max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap();
    assert!(peak == 3 || peak == 4, "{errors:?}");
    assert!(errors[..=peak].windows(2).all(|pair| pair[0] < pair[1]), "rises: {errors:?}");
    assert!(errors[peak..].windows(2).all(|pair| pair[0] > pair[1]), "falls: {errors:?}");
}

#[test]
fn the_border_has_no_samples() {
    let volume = noise([4, 5, 6], [1.0; 3], 1);
    let geometry = geometry_along(&volume, DVec3::new(0.4, 0.2, 1.0), TemplateRule::SampleFloor, 0.5);
    let rays = RealSamples::new(&volume, &geometry, SampleCell::Sheared, 0.0).unwrap();
    let ray = DiscreteRay { u: 0, v: 0 };
    assert!(rays.sample(ray, 0).is_some());
    for k in [-1, 5, 6, i64::MAX, i64::MIN] {
        assert_eq!(rays.sample(ray, k), None, "{k}");
    }
    assert_eq!(rays.sample(DiscreteRay { u: -1000, v: 0 }, 0), None);
    assert_eq!(rays.sample(DiscreteRay { u: i64::MIN / 2, v: i64::MAX / 2 }, 0), None);
}

#[test]
fn every_sample_type_gives_the_same_picture() {
    let of = |x: usize, y: usize, z: usize| (hash(5, [x, y, z]) * 120.0).floor();
    let scene = scene_along([0.3, 1.0, -0.2]);
    let dims = [7, 8, 6];
    let render = |volume: Volume| {
        let geometry = common::geometry(&volume, &scene);
        sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap()
    };
    let wide = render(Volume::from_fn(dims, [1.0; 3], of).unwrap());
    assert!(wide.pixels.iter().any(|pixel| pixel[3] > 0.0));
    assert_eq!(render(Volume::from_fn(dims, [1.0; 3], |x, y, z| of(x, y, z) as u8).unwrap()), wide);
    assert_eq!(render(Volume::from_fn(dims, [1.0; 3], |x, y, z| of(x, y, z) as i16).unwrap()), wide);
    assert_eq!(render(Volume::from_fn(dims, [1.0; 3], |x, y, z| of(x, y, z) as u32).unwrap()), wide);
    assert_eq!(render(Volume::from_fn(dims, [1.0; 3], |x, y, z| of(x, y, z) as f32).unwrap()), wide);
}
