//! All six modes, with everything that a scene can say, against brute force: samples gathered into a list, and the
//! definitions of the modes written down once more over that list.

use crate::common::brute_force::{Gathered, brute_force, scenes};
use crate::common::{hash, largest_difference, noise, one_voxel_a_pixel, stretch};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{DepthCue, ImagePlane, Mode, Perspective, Scene, Transfer, View, ViewFrame, over, resolve_lights};
use cube3_volume::Volume;
use glam::DVec3;

/// Trilinear interpolation as a sum over eight voxels, `border` beyond the volume.
fn trilinear(volume: &Volume, border: f64, position: DVec3) -> f64 {
    let corner = position.floor();
    let part = position - corner;
    let mut sum = 0.0;
    for by in 0..8 {
        let by = [by & 1, by >> 1 & 1, by >> 2];
        let weight: f64 = (0..3).map(|i| if by[i] == 1 { part[i] } else { 1.0 - part[i] }).product();
        let at = [0, 1, 2].map(|i| corner[i] as i64 + by[i]);
        let inside = (0..3).all(|i| at[i] >= 0 && at[i] < volume.dims[i] as i64);
        let [x, y, z] = at.map(|i| i as usize);
        sum += weight * if inside { volume.value(x, y, z) } else { border };
    }
    sum
}

/// The scenes in parallel and from eyes before the volume and in it.
fn scenes_and_eyes() -> Vec<Scene> {
    let eyes = [Some([1.0, -9.0, 4.0]), Some([2.2, 0.4, 3.1]), None].map(|eye_voxel| {
        let perspective = Perspective { eye_voxel, ..Perspective::new(75.0) };
        move |scene: &Scene| {
            let mut seen = scene.clone();
            seen.view.perspective = Some(perspective);
            seen.image.pixel_size_voxel = None;
            seen
        }
    });
    scenes()
        .into_iter()
        .flat_map(|scene| {
            let mut all = eyes.each_ref().map(|from| from(&scene)).to_vec();
            all.push(scene);
            all
        })
        .collect()
}

#[test]
fn every_mode_in_image_order_is_its_definition() {
    for (spacing, step_voxel) in [([1.0; 3], 1.0), ([1.0, 0.7, 1.9], 0.37)] {
        let volume = noise([6, 5, 7], spacing, 12);
        let smallest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let per_voxel = DVec3::from(spacing) / smallest;
        let last = DVec3::from(volume.dims.map(|n| (n - 1) as f64));
        for scene in scenes_and_eyes() {
            let in_perspective = scene.view.perspective.is_some();
            let view = scene.view.frame().unwrap();
            let plane = ImagePlane::new(&scene, &view, volume.dims, spacing);
            // z before y before x, where two are as near to the view.
            let along = view.direction / per_voxel;
            let major = (0..3).max_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap();
            let options = ImageOrderOptions { step_voxel, border: 3.0, ..ImageOrderOptions::default() };
            let got = image_order(&volume, &scene, &options, None).unwrap();
            let mut expected = Vec::new();
            for row in 0..plane.height {
                for column in 0..plane.width {
                    let (origin, along) = plane.ray(column as f64, row as f64);
                    let (origin, along) = (origin / DVec3::from(spacing), along.normalize());
                    let direction = along / per_voxel;
                    let range = if in_perspective { [0.0, 60.0] } else { [-30.0, 30.0] };
                    // What a ray of this direction sees in a parallel view, and what its steps weigh there.
                    let lights = resolve_lights(&scene, &ViewFrame { direction: along, ..view });
                    let sum = step_voxel * direction[major].abs() / last[major];
                    let mut samples = Vec::new();
                    let mut places = Vec::new();
                    if let Some([enter, leave]) = stretch(&scene, volume.dims, origin, direction, range) {
                        let steps = (leave - enter) / step_voxel;
                        places = (0..)
                            .map(f64::from)
                            .take_while(|&i| i < steps - 1e-9)
                            .map(|i| i * step_voxel + enter)
                            .collect();
                        places.push(leave);
                    }
                    for (i, &t) in places.iter().enumerate() {
                        let before = if i == 0 { 0.0 } else { t - places[i - 1] };
                        let behind = places.get(i + 1).map_or(0.0, |next| next - t);
                        let at = (origin + direction * t).clamp(DVec3::ZERO, last);
                        let beside =
                            |axis: DVec3| trilinear(&volume, 3.0, at + axis) - trilinear(&volume, 3.0, at - axis);
                        samples.push(Gathered {
                            value: trilinear(&volume, 3.0, at),
                            position: at.to_array(),
                            gradient: DVec3::new(beside(DVec3::X), beside(DVec3::Y), beside(DVec3::Z)) * 0.5
                                / per_voxel,
                            part: (before + behind) / 2.0 / step_voxel,
                        });
                    }
                    let pixel = brute_force(&scene, &volume, &lights, &samples, step_voxel, sum);
                    expected.push(over(pixel, scene.background));
                }
            }
            let error = largest_difference(&got.picture.pixels, &expected);
            assert!(error < 1e-9, "{}, step {step_voxel}, {:?}: {error}", scene.mode, scene.view.perspective);
            assert!(got.picture.pixels.iter().any(|pixel| *pixel != scene.background), "{} shows nothing", scene.mode);
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
            image: one_voxel_a_pixel(1, 1),
            depth_cue: Some(DepthCue { front: 1.0, back: 0.0 }),
            transfer: Transfer { opacity: vec![[0.0, 1.0]], ..Transfer::default() },
            ..Scene::default()
        };
        let expected = 1.0 - depth / 7.0;
        let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
        assert!((picture.picture.pixels[0][0] - expected).abs() < 1e-15, "{mode} {yaw_deg}");
    }
}

#[test]
fn early_termination_is_within_its_bound_and_saves_samples() {
    let volume = Volume::from_fn([24; 3], [1.0; 3], |x, y, z| 70.0 + 60.0 * hash(2, [x, y, z])).unwrap();
    let scene = Scene { view: View::from_angles(30.0, 20.0), ..Scene::default() };
    let all = ImageOrderOptions { step_voxel: 0.5, ..ImageOrderOptions::default() };
    let early = ImageOrderOptions { early_termination: true, ..all };
    let [all, early] = [all, early].map(|options| image_order(&volume, &scene, &options, None).unwrap());
    assert!(largest_difference(&all.picture.pixels, &early.picture.pixels) < 2_f64.powi(-20));
    assert!(early.samples < all.samples, "{} of {}", early.samples, all.samples);
    assert_ne!(all.picture.pixels, early.picture.pixels);
}
