//! All six modes, with everything that a scene can say, against brute force: samples gathered into a list, and the
//! definitions of the modes written down once more over that list.

use crate::common::brute_force::{Gathered, brute_force, scenes};
use crate::common::{geometry, geometry_along, largest_difference, noise, stretch};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_host::{Basis, step_length};
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{DepthCue, Mode, ResolvedLight, Scene, Transfer, View, resolve_lights};
use cube3_twin::{BaseRendering, DiscreteOptions, RealSamples, SampleCell, discrete};
use cube3_volume::Volume;
use glam::DVec3;

fn base_plane_by_force(
    volume: &Volume,
    scene: &Scene,
    geometry: &Geometry,
    interpolation: SampleCell,
    options: &DiscreteOptions,
) -> BaseRendering {
    let rays = RealSamples::new(volume, geometry, interpolation, options.border).unwrap();
    let basis = Basis::new(geometry, volume.spacing, options.gradient);
    let in_frame = |vector: DVec3| DVec3::from(basis.components(&geometry.axes, vector));
    let lights: Vec<ResolvedLight> = resolve_lights(scene, &scene.view.frame().unwrap())
        .into_iter()
        .map(|l| ResolvedLight { direction: in_frame(l.direction), halfway: in_frame(l.halfway), ..l })
        .collect();
    let [width, height] = geometry.base_plane_size();
    let mut count = 0;
    let mut pixels = Vec::new();
    for row in 0..height {
        for column in 0..width {
            let ray =
                DiscreteRay { u: column as i64 - geometry.shear_u() as i64, v: row as i64 - geometry.shear_v() as i64 };
            let depth = |k: usize| k as f64 + geometry.real_offset();
            let place = |w: f64| {
                let [du, dv] = geometry.real_slopes();
                let at = [ray.u as f64 + w * du, ray.v as f64 + w * dv, w];
                DVec3::from(geometry.axes.voxel_position(geometry.size, at))
            };
            let last_plane = (geometry.size[2] - 1) as f64;
            let drawn = stretch(scene, volume.dims, place(0.0), place(1.0) - place(0.0), [0.0, last_plane]);
            let gather = |k: usize| {
                Some(Gathered {
                    value: rays.sample(ray, k as i64)?,
                    position: geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k)),
                    gradient: DVec3::from(rays.gradient(ray, k as i64, options.gradient)),
                    part: depth(k),
                })
            };
            let mut samples: Vec<Gathered> = (0..geometry.size[2]).filter_map(gather).collect();
            count += samples.len() as u64;
            let [enter, leave] = drawn.unwrap_or([0.0, -1.0]);
            samples.retain(|s| enter - 1e-10 <= s.part && s.part <= leave + 1e-10);
            let depths: Vec<f64> = samples.iter().map(|s| s.part).collect();
            for (i, sample) in samples.iter_mut().enumerate() {
                let from = if i == 0 { enter } else { f64::midpoint(depths[i - 1], depths[i]) };
                let to = depths.get(i + 1).map_or(leave, |next| f64::midpoint(depths[i], *next));
                sample.part = to - from;
            }
            let length = step_length(geometry, volume.spacing);
            pixels.push(brute_force(scene, volume, &lights, &samples, length, 1.0 / last_plane));
        }
    }
    BaseRendering { width, height, pixels, samples: count }
}

#[test]
fn every_mode_on_the_base_plane_is_its_definition() {
    for spacing in [[1.0; 3], [1.0, 0.7, 1.9]] {
        let volume = noise([6, 5, 7], spacing, 11);
        for scene in scenes() {
            let geometry = geometry(&volume, &scene);
            for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
                for gradient in [GradientMethod::Twelve, GradientMethod::TenNormalised, GradientMethod::Six] {
                    let options = DiscreteOptions { gradient, border: 3.0, ..DiscreteOptions::default() };
                    let got = discrete(&volume, &scene, &geometry, interpolation, &options, None).unwrap();
                    let expected = base_plane_by_force(&volume, &scene, &geometry, interpolation, &options);
                    assert_eq!(
                        (got.width, got.height, got.samples),
                        (expected.width, expected.height, expected.samples)
                    );
                    let error = largest_difference(&got.pixels, &expected.pixels);
                    assert!(error < 1e-11, "{} {interpolation:?}: {error}", scene.mode);
                    let seen = got.pixels.iter().filter(|pixel| pixel[3] > 0.0).count();
                    assert!(seen > 4, "{} shows nothing", scene.mode);
                }
            }
        }
    }
}

#[test]
fn the_front_sample_wins_a_tie() {
    // Two equal maxima along y in different slices; the depth cue tells which was taken.
    let volume = Volume::from_fn([1, 8, 1], [1.0; 3], |_, y, _| if y == 2 || y == 5 { 200_u8 } else { 100 }).unwrap();
    for (mode, yaw_deg, depth) in [(Mode::Maximum, 0.0, 2.0), (Mode::Maximum, 180.0, 2.0), (Mode::Minimum, 0.0, 0.0)] {
        let scene = Scene {
            mode,
            view: View::from_angles(yaw_deg, 0.0),
            depth_cue: Some(DepthCue { front: 1.0, back: 0.0 }),
            transfer: Transfer { opacity: vec![[0.0, 1.0]], ..Transfer::default() },
            ..Scene::default()
        };
        let expected = 1.0 - depth / 7.0;
        let geometry = geometry_along(&volume, scene.view.frame().unwrap().direction, TemplateRule::SampleFloor, 0.0);
        let base = discrete(&volume, &scene, &geometry, SampleCell::Sheared, &DiscreteOptions::default(), None);
        assert!((base.unwrap().pixels[0][0] - expected).abs() < 1e-15, "{mode} {yaw_deg}");
    }
}
