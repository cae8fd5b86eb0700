//! All six modes, with everything that a scene can say, against brute force: samples gathered into a list, and the
//! definitions of the modes written down once more over that list.

mod common;

use common::{geometry, hash, largest_difference, noise, one_voxel_a_pixel, stretch};
use cube3_frame::{DiscreteRay, Geometry};
use cube3_host::{Basis, step_length};
use cube3_machine::GradientMethod;
use cube3_raycast::{
    BaseRendering, DiscreteOptions, ImageOrderOptions, Interpolation, RaySamples, discrete, image_order,
};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, ImagePlane, Layer, Light, Mode, Perspective, ResolvedLight, Scene, Threshold,
    Transfer, View, ViewFrame, corrected_opacity, depth_range, over, phong, resolve_lights,
};
use cube3_volume::Volume;
use glam::DVec3;

/// One sample as brute force sees it.
struct Gathered {
    value: f64,
    /// x, y, z in voxels.
    position: [f64; 3],
    /// In the frame of the lights.
    gradient: DVec3,
    /// The part of a step that it stands for.
    part: f64,
}

/// The pixel of a list of samples, front to back.
fn brute_force(
    scene: &Scene,
    volume: &Volume,
    lights: &[ResolvedLight],
    samples: &[Gathered],
    length: f64,
    sum: f64,
) -> [f64; 4] {
    let view = scene.view.frame().unwrap();
    let shown: Vec<&Gathered> =
        samples.iter().filter(|s| !scene.threshold.as_ref().is_some_and(|t| t.removes(s.value))).collect();
    let opacity = |s: &Gathered| scene.transfer.opacity_at(s.value, s.gradient.length());
    let cue = |s: &Gathered, rgb: [f64; 3]| {
        let Some(cue) = &scene.depth_cue else { return rgb };
        let [near, far] = depth_range(&view, volume.dims, volume.spacing);
        let world = DVec3::from([0, 1, 2].map(|i| s.position[i] * volume.spacing[i]));
        let factor = cue.factor_at((view.direction.dot(world) - near) / (far - near));
        rgb.map(|c| c * factor)
    };
    let plain = |s: &Gathered| cue(s, scene.transfer.colour_at(s.value));
    let lit = |s: &Gathered| {
        let normal = (s.gradient != DVec3::ZERO).then(|| -s.gradient.normalize());
        cue(s, phong(&scene.material, lights, normal, scene.transfer.colour_at(s.value)))
    };
    let weighted = |[r, g, b]: [f64; 3], a: f64| [r * a, g * a, b * a, a];
    let opaque = |s: &&&Gathered| opacity(s) >= scene.transfer.opaque_alpha;
    match scene.mode {
        Mode::Composite => shown.iter().rev().fold([0.0; 4], |behind, s| {
            let correction = if scene.transfer.opacity_correction { length } else { 1.0 };
            let alpha = corrected_opacity(opacity(s), correction * s.part);
            let front = weighted(lit(s), alpha);
            [0, 1, 2, 3].map(|i| front[i] + (1.0 - alpha) * behind[i])
        }),
        Mode::FirstOpaque => shown.iter().find(opaque).map_or([0.0; 4], |s| weighted(lit(s), 1.0)),
        Mode::LastOpaque => shown.iter().rev().find(opaque).map_or([0.0; 4], |s| weighted(lit(s), 1.0)),
        Mode::Maximum | Mode::Minimum => {
            let sign = if scene.mode == Mode::Maximum { 1.0 } else { -1.0 };
            let best = shown.iter().map(|s| sign * s.value).fold(f64::NEG_INFINITY, f64::max);
            let front = shown.iter().find(|s| sign * s.value == best);
            front.map_or([0.0; 4], |s| weighted(plain(s), opacity(s)))
        }
        Mode::WeightedSum => shown.iter().fold([0.0; 4], |total, s| {
            let sample = weighted(plain(s), opacity(s));
            [0, 1, 2, 3].map(|i| total[i] + sample[i] * s.part * sum)
        }),
    }
}

/// Scenes that use everything, in every mode.
fn scenes() -> Vec<Scene> {
    let ramp = Transfer {
        opacity: vec![[60.0, 0.0], [200.0, 0.9]],
        colour: vec![
            ColourPoint { value: 0.0, rgb: [1.0, 0.2, 0.1] },
            ColourPoint { value: 255.0, rgb: [0.1, 0.8, 1.0] },
        ],
        ..Transfer::default()
    };
    let base = Scene {
        view: View::from_angles(25.0, 14.0),
        image: one_voxel_a_pixel(13, 12),
        transfer: ramp.clone(),
        background: [0.1, 0.2, 0.3],
        ..Scene::default()
    };
    let layers = vec![
        Layer { gradient: 5.0, opacity: vec![[80.0, 0.0], [160.0, 0.1]] },
        Layer { gradient: 50.0, opacity: vec![[40.0, 0.0], [160.0, 0.7]] },
    ];
    let lights = vec![
        Light { direction: Some([1.0, -0.5, 2.0]), colour: [1.0, 0.9, 0.5] },
        Light { direction: None, colour: [0.2, 0.3, 0.4] },
    ];
    let mut one_sided = base.material.clone();
    one_sided.two_sided = false;
    let everything = Scene {
        transfer: Transfer { layers, opacity: vec![], opaque_alpha: 0.3, ..ramp.clone() },
        lights,
        material: one_sided,
        depth_cue: Some(DepthCue { front: 0.9, back: 0.2 }),
        cuts: vec![Cut { normal: [1.0, 0.3, -0.2], through_voxel: [3.1, 2.0, 2.0] }],
        crop: Some(Crop { min_voxel: [0.3, 0.0, 0.9], max_voxel: [4.5, 3.2, 9.0] }),
        threshold: Some(Threshold { low: Some(50.0), high: Some(230.0) }),
        ..base.clone()
    };
    let flat = Scene {
        material: cube3_scene::Material { shaded: false, ..base.material.clone() },
        transfer: Transfer { opacity_correction: false, ..ramp },
        depth_cue: Some(DepthCue::default()),
        ..base.clone()
    };
    [base, everything, flat]
        .into_iter()
        .flat_map(|scene| Mode::ALL.map(|mode| Scene { mode, ..scene.clone() }))
        .collect()
}

fn base_plane_by_force(
    volume: &Volume,
    scene: &Scene,
    geometry: &Geometry,
    interpolation: Interpolation,
    options: &DiscreteOptions,
) -> BaseRendering {
    let rays = RaySamples::new(volume, geometry, interpolation, options.border).unwrap();
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
            for interpolation in [Interpolation::Exact, Interpolation::Sheared] {
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
            let machine = geometry(&volume, &scene);
            let major = machine.axes.axis[2];
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
                    let mut sum = step_voxel / step_length(&machine, spacing) / (machine.size[2] - 1) as f64;
                    if in_perspective {
                        sum = step_voxel * direction[major].abs() / last[major];
                    }
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
            let error = largest_difference(&got.pixels, &expected);
            assert!(error < 1e-9, "{}, step {step_voxel}, {:?}: {error}", scene.mode, scene.view.perspective);
            assert!(got.pixels.iter().any(|pixel| *pixel != scene.background), "{} shows nothing", scene.mode);
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
        assert!((picture.pixels[0][0] - expected).abs() < 1e-15, "{mode} {yaw_deg}");
        let geometry = common::geometry_along(
            &volume,
            scene.view.frame().unwrap().direction,
            cube3_machine::TemplateRule::SampleFloor,
            0.0,
        );
        let base = discrete(&volume, &scene, &geometry, Interpolation::Sheared, &DiscreteOptions::default(), None);
        assert!((base.unwrap().pixels[0][0] - expected).abs() < 1e-15, "{mode} {yaw_deg}");
    }
}

#[test]
fn early_termination_is_within_its_bound_and_saves_samples() {
    let volume = Volume::from_fn([24; 3], [1.0; 3], |x, y, z| 70.0 + 60.0 * hash(2, [x, y, z])).unwrap();
    let scene = Scene { view: View::from_angles(30.0, 20.0), ..Scene::default() };
    let all = ImageOrderOptions { step_voxel: 0.5, ..ImageOrderOptions::default() };
    let early = ImageOrderOptions { early_termination: true, ..all };
    let [all, early] = [all, early].map(|options| image_order(&volume, &scene, &options, None).unwrap());
    assert!(largest_difference(&all.pixels, &early.pixels) < 2_f64.powi(-20));
    assert!(early.samples < all.samples, "{} of {}", early.samples, all.samples);
    assert_ne!(all.pixels, early.pixels);
}
