//! Casters against closed forms and against each other in the limit.

mod common;

use common::{geometry_along, largest_difference, one_voxel_a_pixel, stretch};
use cube3_frame::DiscreteRay;
use cube3_host::step_length;
use cube3_machine::TemplateRule;
use cube3_raycast::{DiscreteOptions, ImageOrderOptions, image_order, sheared, true_3d};
use cube3_scene::{Image, ImagePlane, Material, Mode, Scene, Transfer, View, corrected_opacity};
use cube3_volume::Volume;
use glam::DVec3;

/// A volume of one value, not lit, of opacity `alpha` per voxel.
fn slab(dims: [usize; 3], alpha: f64) -> (Volume, Scene) {
    let volume = Volume::from_fn(dims, [1.0; 3], |_, _, _| 100_u8).unwrap();
    let scene = Scene {
        transfer: Transfer { opacity: vec![[0.0, alpha]], ..Transfer::default() },
        material: Material { shaded: false, ..Material::default() },
        view: View::from_angles(0.0, 0.0),
        image: one_voxel_a_pixel(1, 1),
        ..Scene::default()
    };
    (volume, scene)
}

#[test]
fn a_homogeneous_slab_has_its_closed_form_whatever_the_step() {
    for alpha in [1e-12, 0.01, 0.3, 0.999] {
        let (volume, scene) = slab([9, 33, 9], alpha);
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
            let got = picture.pixels[0][0];
            assert!(
                (got - expected).abs() < 1e-12 * expected,
                "alpha {alpha}, step {step_voxel}: {got}, not {expected}"
            );
        }
        for yaw_deg in [0.0, 20.0, 45.0, 60.0] {
            let scene = Scene { view: View::from_angles(yaw_deg, 5.0), ..scene.clone() };
            let direction = scene.view.frame().unwrap().direction;
            let geometry = geometry_along(&volume, direction, TemplateRule::SampleFloor, 0.5);
            let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
            for row in 0..base.height {
                for column in 0..base.width {
                    let ray = DiscreteRay {
                        u: column as i64 - geometry.shear_u() as i64,
                        v: row as i64 - geometry.shear_v() as i64,
                    };
                    let place = |w: f64| {
                        let [du, dv] = geometry.real_slopes();
                        let at = [ray.u as f64 + w * du, ray.v as f64 + w * dv, w];
                        DVec3::from(geometry.axes.voxel_position(geometry.size, at))
                    };
                    let planes = [0.0, (geometry.size[2] - 1) as f64];
                    let drawn = stretch(&scene, volume.dims, place(0.0), place(1.0) - place(0.0), planes);
                    // A ray that cuts off a corner between two planes has no sample there.
                    let samples = (0..geometry.size[2] as i64).filter(|&k| geometry.has_sample(ray, k)).count();
                    let steps = drawn.filter(|_| samples > 0).map_or(0.0, |[enter, leave]| leave - enter);
                    let expected = -(-density * steps * step_length(&geometry, volume.spacing)).exp_m1();
                    let got = base.pixel(column as i64, row as i64)[3];
                    assert!((got - expected).abs() <= 1e-9 * density, "{got}, not {expected} at yaw {yaw_deg}");
                }
            }
        }
    }
}

#[test]
fn without_correction_every_step_has_the_opacity_of_a_unit_length() {
    let (volume, mut scene) = slab([3, 9, 3], 0.25);
    scene.transfer.opacity_correction = false;
    let options = ImageOrderOptions { step_voxel: 0.5, ..ImageOrderOptions::default() };
    let got = image_order(&volume, &scene, &options, None).unwrap().pixels[0][0];
    assert!((got - (1.0 - 0.75_f64.powi(16))).abs() < 1e-14);
    let geometry = geometry_along(&volume, glam::DVec3::Y, TemplateRule::SampleFloor, 0.5);
    let base = true_3d(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
    assert!((base.pixel(1, 1)[3] - (1.0 - 0.75_f64.powi(8))).abs() < 1e-14);
}

/// A soft ball that vanishes before the border, on n³ voxels: a cube of the world of side 1.
fn ball(n: usize) -> Volume {
    let spacing = 1.0 / n as f64;
    Volume::from_fn([n; 3], [spacing; 3], |x, y, z| {
        let square: f64 = [x, y, z].map(|i| ((i as f64 + 0.5) * spacing - 0.5) / 0.42).map(|c| c * c).iter().sum();
        200.0 * (1.0 - square).max(0.0).powi(3)
    })
    .unwrap()
}

/// The ball's scene on n³ voxels: opacity is per voxel, so that finer voxels are clearer.
fn ball_scene(n: usize, mode: Mode) -> Scene {
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

/// The largest difference of the pictures of true and of image order.
fn disagreement(n: usize, mode: Mode, step_voxel: f64) -> f64 {
    let (volume, scene) = (ball(n), ball_scene(n, mode));
    let view = scene.view.frame().unwrap();
    let geometry = geometry_along(&volume, view.direction, TemplateRule::SampleFloor, 0.5);
    let plane = ImagePlane::new(&scene, &view, volume.dims, volume.spacing);
    let base = true_3d(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
    let warped = base.warp(&geometry, &plane, volume.spacing, scene.background);
    let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
    let reference = image_order(&volume, &scene, &options, None).unwrap();
    assert!(reference.pixels.iter().any(|pixel| pixel[0] > 0.03), "{mode}: the picture shows something");
    largest_difference(&warped, &reference.pixels)
}

#[test]
fn true_and_image_order_agree_in_the_limit() {
    for mode in [Mode::Composite, Mode::WeightedSum, Mode::Maximum] {
        let errors = [16, 32, 64].map(|n| disagreement(n, mode, 0.25));
        println!("{mode}: {errors:.5?}");
        assert!(errors[0] > 2.0 * errors[1] && errors[1] > 2.0 * errors[2], "{mode}: {errors:?}");
        assert!(errors[2] < 0.004, "{mode}: {errors:?}");
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
    let errors = [2.0, 1.0, 0.5, 0.25].map(|step| largest_difference(&picture(step).pixels, &finest.pixels));
    println!("{errors:.6?}");
    assert!(errors.windows(2).all(|pair| pair[0] > 2.0 * pair[1]), "{errors:?}");
    assert!(errors[2] > 3.5 * errors[3], "of the second order: {errors:?}");
}
