//! The mean angle of gradients in a report: known in closed form on ramps, and summed by other code on surfaces of several steepnesses.

use cube3::{RunOptions, Runs, run};
use cube3_frame::DiscreteRay;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs::LoadedVolume;
use cube3_machine::{Abc, GradientMethod, MachineSpec};
use cube3_scene::{ColourPoint, Crop, Cut, Image, Scene, View};
use cube3_twin::{RealSamples, SampleCell};
use cube3_volume::{Samples, Volume, WordConversion};
use cube3_word::Words;
use glam::DVec3;

const DIMS: [usize; 3] = [30, 28, 26];
const SPACING: [f64; 3] = [1.0, 1.5, 0.8];

/// A volume of values 0 to 65535 by voxel, x fastest.
fn volume(value: impl Fn(DVec3) -> f64) -> LoadedVolume {
    let [nx, ny, nz] = DIMS;
    let place = |i: usize| DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
    let values = (0..nx * ny * nz).map(|i| value(place(i)).round() as u16).collect();
    let data = Volume::new(DIMS, SPACING, Samples::U16(values)).unwrap();
    let (words, conversion) = data.to_words(16, &WordConversion::identity(16)).unwrap();
    LoadedVolume { source: "made".into(), single: [false; 3], data, words, conversion, notes: Vec::new(), made_s: None }
}

/// Opaque from a value on.
fn scene(from: f64) -> Scene {
    let mut scene = Scene { view: View::from_angles(25.0, 10.0), ..Scene::default() };
    scene.image = Image { width_px: 64, height_px: 64, ..Image::default() };
    scene.transfer.opacity = vec![[from, 0.0], [from, 1.0]];
    scene.transfer.opacity_correction = false;
    scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    scene
}

fn machine(gradient: GradientMethod) -> MachineSpec {
    let words =
        Words { weight_bits: 12, sample_fraction_bits: 4, gradient_bits: 21, table_bits: 16, ..Words::default() };
    MachineSpec { words, abc: Abc { gradient, ..Abc::default() }, ..MachineSpec::default() }
}

/// The mean angle that the report of a run has, in degrees.
fn reported(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume) -> f64 {
    let options = RunOptions { runs: Runs::Function, ..RunOptions::default() };
    run(scene, machine, volume, &options).unwrap().report.error.unwrap().gradient_mean_deg.unwrap()
}

fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.angle_between(b).to_degrees()
}

/// Values of a slope along x, y and z, a voxel.
const SLOPE: DVec3 = DVec3::new(500.0, 700.0, -300.0);

/// A ramp, two voxels and more from the volume's border, beyond which there is nothing.
fn ramp() -> (Scene, LoadedVolume) {
    let inside = Crop { min_voxel: [3.0; 3], max_voxel: DIMS.map(|n| n as f64 - 4.0) };
    (Scene { crop: Some(inside), ..scene(0.0) }, volume(|place| 20_000.0 + SLOPE.dot(place)))
}

#[test]
fn a_ramp_has_no_angle_where_the_estimator_is_exact() {
    let (scene, volume) = ramp();
    for gradient in [GradientMethod::Twelve, GradientMethod::SixSheared, GradientMethod::TwentySixSheared] {
        let got = reported(&scene, &machine(gradient), &volume);
        assert!(got < 0.01, "{}: {got}°", gradient.name());
    }
}

/// Six neighbours take the difference along the ray for that along w: it has du·Gu and dv·Gv too much, on every ray alike.
#[test]
fn a_ramp_has_the_angle_of_the_shear_that_six_neighbours_leave() {
    let (scene, volume) = ramp();
    for gradient in [GradientMethod::Six, GradientMethod::TwentySix] {
        let machine = machine(gradient);
        let direction = scene.view.frame().unwrap().direction / DVec3::from(SPACING);
        let along = direction / direction.abs().max_element();
        let w = [along.x, along.y, along.z].iter().position(|step| step.abs() == 1.0).unwrap();
        let mut sheared = SLOPE;
        sheared[w] = along.dot(SLOPE) * along[w];
        let expected = angle_deg(sheared / DVec3::from(SPACING), SLOPE / DVec3::from(SPACING));
        let got = reported(&scene, &machine, &volume);
        assert!(expected > 10.0 && (got - expected).abs() < 0.01, "{}: {got}°, not {expected}°", gradient.name());
    }
}

/// The value of a surface.
const SURFACE: f64 = 30_000.0;

/// A steep ball and a soft one, and a wall behind a cut, inside which there is no gradient; many rays meet
/// none of them.
fn surfaces() -> (Scene, LoadedVolume) {
    let ball = |place: DVec3, middle: [f64; 3], radius: f64, soft: f64| {
        let off = ((place - DVec3::from(middle)) * DVec3::from(SPACING)).length();
        (0.5 - (off - radius) / soft).clamp(0.0, 1.0) * 2.0 * SURFACE
    };
    let value = move |place: DVec3| {
        let steep = ball(place, [7.0, 16.0, 10.0], 6.0, 1.5);
        let soft = ball(place, [18.0, 16.0, 14.0], 4.0, 7.0);
        let wall = if place.x >= 26.0 && place.z <= 12.0 { 50_000.0 } else { 0.0 };
        steep.max(soft).max(wall)
    };
    let cut = Cut { normal: [0.0, -1.0, 0.0], through_voxel: [0.0, 6.0, 0.0] };
    (Scene { cuts: vec![cut], ..scene(SURFACE) }, volume(value))
}

/// Trilinear interpolation, axis by axis; nothing beyond the border.
fn interpolated(volume: &Volume, at: DVec3) -> f64 {
    let beside = |axis: usize, far: bool| if far { at[axis].floor() + 1.0 } else { at[axis].floor() };
    let share = |axis: usize, far: bool| 1.0 - (at[axis] - beside(axis, far)).abs();
    let mut sum = 0.0;
    for far in 0..8 {
        let far = [far & 1 > 0, far & 2 > 0, far & 4 > 0];
        let place = [0, 1, 2].map(|axis| beside(axis, far[axis]));
        if (0..3).all(|axis| place[axis] >= 0.0 && place[axis] < DIMS[axis] as f64) {
            let [x, y, z] = place.map(|x| x as usize);
            sum += (0..3).map(|axis| share(axis, far[axis])).product::<f64>() * volume.value(x, y, z);
        }
    }
    sum
}

#[test]
fn surfaces_have_the_mean_over_the_rays_that_meet_one_with_a_gradient() {
    let (scene, volume) = surfaces();
    for gradient in [GradientMethod::Twelve, GradientMethod::Six, GradientMethod::TenNormalised] {
        let machine = machine(gradient);
        let info = VolumeInfo { dims: DIMS, spacing: SPACING, window: volume.words.window };
        let geometry = frame_setup(&scene, &machine, &info, true).unwrap().setup.geometry;
        let samples = RealSamples::new(&volume.data, &geometry, SampleCell::Sheared, 0.0).unwrap();
        let (first, [width, height]) = (geometry.first_ray(), geometry.base_plane_size());
        let (mut angles, mut lengths) = (Vec::new(), Vec::new());
        let (mut clear, mut flat) = (0, 0);
        for pixel in 0..(width * height) as i64 {
            let ray = DiscreteRay { u: first.u + pixel % width as i64, v: first.v + pixel / width as i64 };
            let place = |k: i64| {
                DVec3::from(geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k as usize)))
            };
            let opaque = |k: &i64| {
                samples.sample(ray, *k).is_some_and(|value| value >= SURFACE)
                    && place(*k).y >= scene.cuts[0].through_voxel[1]
            };
            let Some(k) = (0..geometry.size[2] as i64).find(opaque) else {
                clear += 1;
                continue;
            };
            let side =
                |axis: DVec3| interpolated(&volume.data, place(k) + axis) - interpolated(&volume.data, place(k) - axis);
            let exact = DVec3::new(side(DVec3::X), side(DVec3::Y), side(DVec3::Z)) / DVec3::from(SPACING);
            let estimate = samples.world_gradient(ray, k, gradient);
            if exact == DVec3::ZERO || estimate == DVec3::ZERO {
                flat += 1;
                continue;
            }
            angles.push(angle_deg(estimate, exact));
            lengths.push(exact.length());
        }
        let (count, sum) = (angles.len() as f64, angles.iter().sum::<f64>());
        let mean = sum / count;
        let got = reported(&scene, &machine, &volume);
        let slack = 0.001 * mean;
        assert!((got - mean).abs() < slack, "{}: {got}°, not {mean}°", gradient.name());
        // What a mean could be mistaken for is elsewhere.
        let weighted = angles.iter().zip(&lengths).map(|(angle, length)| angle * length).sum::<f64>()
            / lengths.iter().sum::<f64>();
        let square = (angles.iter().map(|angle| angle * angle).sum::<f64>() / count).sqrt();
        let mistakes = [
            sum,
            mean.to_radians(),
            weighted,
            square,
            sum / (count + f64::from(flat)),
            sum / (count + f64::from(clear)),
        ];
        assert!(mistakes.iter().all(|mistake| (mistake - mean).abs() > 4.0 * slack), "{mean}: {mistakes:?}");
    }
}
