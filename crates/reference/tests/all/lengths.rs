//! Lengths from geometry: what the samples of a ray stand for adds up to the ray's length in the box of voxel centres, inside of the crop
//! box and the cut planes, at every step.

use crate::common;
use crate::common::{ball, ball_scene, constant, fog, largest_difference, one_voxel_a_pixel, stretch};
use cube3_cases::cases;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{Crop, Cut, ImagePlane, Mode, Perspective, Scene, View};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;

fn middle(volume: &Volume, scene: &Scene, step_voxel: f64) -> f64 {
    let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
    image_order(volume, scene, &options, None).unwrap().picture.pixels[0][0]
}

#[test]
fn fog_is_as_thick_as_its_box() {
    for step in [0.25, 0.4, 1.0, 3.7, 15.0, 100.0] {
        let got = 255.0 * middle(&constant([16; 3]), &fog(0.05), step);
        assert!((got - 255.0 * (1.0 - 0.95_f64.powi(15))).abs() < 1e-10, "{got} at steps of {step}");
    }
}

#[test]
fn a_homogeneous_slab_has_its_closed_form_whatever_the_step() {
    for alpha in [1e-12, 0.01, 0.3, 0.999] {
        let (volume, scene) = (constant([9, 33, 9]), fog(alpha));
        let density = -(-alpha).ln_1p();
        // Steps that divide the 32 voxels from the first centre to the last, and some that do not.
        for (step_voxel, samples) in
            [(1.0, 33), (0.5, 65), (0.25, 129), (2.0, 17), (0.3, 108), (5.0, 8), (31.0, 3), (32.0, 2), (33.0, 2)]
        {
            let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
            let picture = image_order(&volume, &scene, &options, None).unwrap();
            // Dense slabs end before their back.
            assert!(picture.samples == samples || alpha > 0.5 && picture.samples < samples);
            // The length is that of the box of voxel centres: 1 − e^(−τ), τ = density · 32.
            let expected = -(-density * 32.0).exp_m1();
            let got = picture.picture.pixels[0][0];
            assert!(
                (got - expected).abs() < 1e-12 * expected,
                "alpha {alpha}, step {step_voxel}: {got}, not {expected}"
            );
        }
    }
}

#[test]
fn without_correction_every_step_has_the_opacity_of_a_unit_length() {
    let (volume, mut scene) = (constant([3, 9, 3]), fog(0.25));
    scene.transfer.opacity_correction = false;
    let options = ImageOrderOptions { step_voxel: 0.5, ..ImageOrderOptions::default() };
    let got = image_order(&volume, &scene, &options, None).unwrap().picture.pixels[0][0];
    assert!((got - (1.0 - 0.75_f64.powi(16))).abs() < 1e-14);
}

#[test]
fn a_ramp_is_integrated_with_an_error_of_the_second_order() {
    let volume = Volume::from_fn([3, 65, 3], [1.0; 3], |_, y, _| y as u8).unwrap();
    let mut scene = fog(0.0);
    scene.transfer.opacity = vec![[0.0, 0.0], [64.0, 0.1]];
    // 1 − exp ∫ ln(1 − v/640) dv from 0 to 64, whose integral is −640·((1 − x)·ln(1 − x) − (1 − x)) at x = v/640.
    let integral = |x: f64| -640.0 * ((1.0 - x) * (1.0 - x).ln() - (1.0 - x));
    let right = -(integral(0.1) - integral(0.0)).exp_m1();
    assert!((right - 0.963_569).abs() < 5e-7);
    let errors = [2.0, 1.0, 0.5, 0.25].map(|step| (middle(&volume, &scene, step) - right).abs());
    assert!((4e-7..6e-7).contains(&errors[1]), "{errors:e}", errors = errors[1]);
    for pair in errors.windows(2) {
        assert!((3.9..4.1).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn finer_steps_of_image_order_converge() {
    let (volume, scene) = (ball(24), ball_scene(24, Mode::Composite));
    let picture = |step_voxel: f64| {
        let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
        image_order(&volume, &scene, &options, None).unwrap()
    };
    let finest = picture(1.0 / 64.0);
    let errors =
        [2.0, 1.0, 0.5, 0.25].map(|step| largest_difference(&picture(step).picture.pixels, &finest.picture.pixels));
    println!("{errors:.6?}");
    assert!(errors.windows(2).all(|pair| pair[0] > 2.0 * pair[1]), "{errors:?}");
    assert!(errors[2] > 3.5 * errors[3], "of the second order: {errors:?}");
}

#[test]
fn an_axis_of_one_voxel_is_one_thick_from_every_side() {
    for (dims, direction) in
        [([16, 16, 1], [0.0, 0.0, 1.0]), ([1, 16, 16], [1.0, 0.0, 0.0]), ([9, 1, 4], [0.0, -1.0, 0.0])]
    {
        let volume = constant(dims);
        let turned = |by: f64| DVec3::from(direction) + DVec3::from(direction).any_orthonormal_vector() * by;
        for slope in [0.0, 0.3, 0.9] {
            let along = turned(slope);
            let scene = Scene { view: View::from_direction(along.to_array(), None), ..fog(0.5) };
            let expected = 1.0 - 0.5_f64.powf(along.length());
            for step in [0.3, 1.0, 4.0] {
                let got = middle(&volume, &scene, step);
                assert!((got - expected).abs() < 1e-12, "{got}, not {expected} through {dims:?} along {along}");
            }
        }
    }
}

#[test]
fn a_crop_box_is_as_thick_as_it_is_at_every_angle() {
    let volume = constant([33; 3]);
    for yaw in [0.0, 44.0, 44.7, 44.8, 44.9, 45.0, 45.1, 46.0] {
        let crop = Crop { min_voxel: [0.0, 16.0, 0.0], max_voxel: [32.0, 18.0, 32.0] };
        let scene = Scene { view: View::from_angles(yaw, 0.0), crop: Some(crop), ..fog(0.1) };
        let expected = 1.0 - 0.9_f64.powf(2.0 / yaw.to_radians().cos());
        let got = middle(&volume, &scene, 1.0);
        assert!((got - expected).abs() < 1e-12, "{got}, not {expected} at {yaw}°");
    }
}

#[test]
fn the_mean_over_all_planes_is_what_is_in_them() {
    for n in [2, 5, 9, 33] {
        let volume = constant([9, n, 9]);
        let scene = Scene { mode: Mode::WeightedSum, ..fog(1.0) };
        for step in [0.3, 1.0, 2.0] {
            assert!((middle(&volume, &scene, step) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn some_of_the_pixels_are_those_of_the_whole_picture() {
    let volume = Volume::from_fn([9, 8, 7], [1.0; 3], |x, y, z| (common::hash(3, [x, y, z]) * 255.0) as u8).unwrap();
    let image = one_voxel_a_pixel(14, 11);
    let scene = Scene { view: View::from_angles(30.0, 20.0), image, ..Scene::default() };
    let whole = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
    let some = image_order(&volume, &scene, &ImageOrderOptions { every: 4, ..Default::default() }, None).unwrap();
    assert_eq!((some.picture.width, some.picture.height), (4, 3));
    let expected: Vec<_> = (0..3).flat_map(|row| (0..4).map(move |column| row * 4 * 14 + column * 4)).collect();
    assert!(expected.iter().zip(&some.picture.pixels).all(|(&at, pixel)| whole.picture.pixels[at] == *pixel));
    assert!(some.picture.pixels.iter().any(|pixel| *pixel != scene.background));
}

proptest! {
    #![proptest_config(cases(256))]

    /// Fog inside random cuts and a random crop box, seen along random rays: 1 − e^(−density · length) on every ray.
    #[test]
    fn every_ray_has_its_length(
        dims in prop::array::uniform3(1_usize..9), direction in prop::array::uniform3(-1.0..1.0_f64),
        low in prop::array::uniform3(-1.0..3.0_f64), size in prop::array::uniform3(0.0..7.0_f64),
        normal in prop::array::uniform3(-1.0..1.0_f64), through in prop::array::uniform3(0.0..6.0_f64),
        eye: bool, step in 0.1..3.0_f64,
    ) {
        prop_assume!(DVec3::from(direction).length() > 0.1 && DVec3::from(normal).length() > 0.1);
        let volume = constant(dims);
        let mut scene = fog(0.3);
        scene.view = View::from_direction(direction, None);
        scene.image = one_voxel_a_pixel(7, 7);
        scene.crop = Some(Crop { min_voxel: low, max_voxel: [0, 1, 2].map(|i| low[i] + size[i]) });
        scene.cuts = vec![Cut { normal, through_voxel: through }];
        if eye {
            scene.view.perspective = Some(Perspective { eye_voxel: Some([2.0, 1.0, 3.0]), ..Perspective::new(80.0) });
            scene.image.pixel_size_voxel = None;
        }
        let density = -(0.7_f64).ln();
        let opacity = |length: f64| -(-density * length).exp_m1();
        let options = ImageOrderOptions { step_voxel: step, ..ImageOrderOptions::default() };
        let got = image_order(&volume, &scene, &options, None).unwrap();
        let thick = scene.thickened(dims.map(|n| n == 1));
        let drawn = volume.thickened();
        let view = thick.view.frame().unwrap();
        let plane = ImagePlane::new(&thick, &view, drawn.dims, drawn.spacing);
        let expected: Vec<[f64; 1]> = (0..49).map(|pixel| {
            let (origin, along) = plane.ray(f64::from(pixel % 7), f64::from(pixel / 7));
            let range = if eye { [0.0, 40.0] } else { [-40.0, 40.0] };
            let span = stretch(&thick, drawn.dims, origin, along.normalize(), range);
            [opacity(span.map_or(0.0, |[enter, leave]| leave - enter))]
        }).collect();
        let got: Vec<[f64; 1]> = got.picture.pixels.iter().map(|pixel| [pixel[0]]).collect();
        prop_assert!(largest_difference(&got, &expected) < 1e-7, "{got:?}, not {expected:?}");
    }
}
