//! The stiff and the extreme: smallest volumes, no opacity and full opacity, values and spacings at their limits, bad
//! input.

use crate::common::{VIEWS, assert_sane, geometry, geometry_along, noise, one_voxel_a_pixel, scene_along};
use cube3_frame::DiscreteRay;
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_reference::{ImageOrderOptions, RaycastError as Refused, image_order};
use cube3_scene::{Mode, Scene, Transfer, View};
use cube3_twin::{DiscreteOptions, SampleCell, TwinError, discrete, sheared, surface_gradients, true_3d};
use cube3_volume::{Samples, Volume};
use glam::DVec3;

#[test]
fn the_smallest_volumes_are_rendered() {
    for dims in [[1; 3], [1, 1, 9], [9, 1, 1], [1, 9, 1], [2; 3], [3, 1, 2], [1, 6, 6]] {
        let volume = Volume::from_fn(dims, [1.0; 3], |_, _, _| 200_u8).unwrap();
        for direction in VIEWS {
            for mode in Mode::ALL {
                let scene = Scene { mode, image: one_voxel_a_pixel(21, 21), ..scene_along(direction) };
                for rule in [TemplateRule::SampleFloor, TemplateRule::PlaneFloor] {
                    for offset in [0.0, 0.5] {
                        let along = scene.view.frame().unwrap().direction;
                        let geometry = geometry_along(&volume, along, rule, offset);
                        for (gradient, _) in GradientMethod::ALL {
                            let options = DiscreteOptions { gradient, border: 0.0, ..DiscreteOptions::default() };
                            for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
                                let base = discrete(&volume, &scene, &geometry, interpolation, &options, None).unwrap();
                                assert_sane(base.pixels.into_iter().flatten());
                            }
                        }
                    }
                }
            }
        }
    }
    // A single voxel is one thick: two samples straight ahead, half a voxel before its centre and half a voxel behind.
    let volume = Volume::from_fn([1; 3], [1.0; 3], |_, _, _| 200_u8).unwrap();
    let ahead = View::from_angles(0.0, 0.0);
    let scene = Scene { view: ahead, image: one_voxel_a_pixel(3, 3), ..Scene::default() };
    let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::SampleFloor, 0.0);
    let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
    assert_eq!((base.width, base.height, base.samples, base.pixels[0][3]), (2, 2, 8, 0.75));
}

#[test]
fn nothing_is_nothing_and_full_is_full() {
    let volume = noise([8; 3], [1.0; 3], 9);
    let opacity = |alpha: f64| Transfer { opacity: vec![[0.0, alpha]], ..Transfer::default() };
    for direction in VIEWS {
        for mode in Mode::ALL {
            let clear = Scene { mode, transfer: opacity(0.0), background: [0.2, 0.4, 0.6], ..scene_along(direction) };
            let geometry = geometry(&volume, &clear);
            let base = true_3d(&volume, &clear, &geometry, &DiscreteOptions::default(), None).unwrap();
            assert!(base.pixels.iter().all(|pixel| *pixel == [0.0; 4]), "{mode}");
        }
        // Opacity 1 at the first sample: exactly the first one's colour.
        let full = Scene { transfer: opacity(1.0), ..scene_along(direction) };
        let first = Scene { mode: Mode::FirstOpaque, ..full.clone() };
        let geometry = geometry(&volume, &full);
        let [base_width, _] = geometry.base_plane_size();
        let options = DiscreteOptions::default();
        let [full, first] = [&full, &first].map(|scene| sheared(&volume, scene, &geometry, &options, None).unwrap());
        // A ray that only touches an edge of the volume has a sample there, and no length.
        for (i, (full, first)) in full.pixels.iter().zip(&first.pixels).enumerate() {
            let [column, row] = [i % base_width, i / base_width].map(|x| x as i64);
            let ray = DiscreteRay { u: column - geometry.shear_u() as i64, v: row - geometry.shear_v() as i64 };
            let samples = (0..geometry.size[2] as i64).filter(|&k| geometry.has_sample(ray, k)).count();
            assert!(full == first || samples == 1 && *full == [0.0; 4], "pixel {i} along {direction:?}");
        }
    }
}

#[test]
fn optical_depth_from_nothing_to_infinite() {
    let volume = Volume::from_fn([3, 64, 3], [1.0; 3], |_, _, _| 100_u8).unwrap();
    for alpha in [1e-300, 1e-15, 1e-6, 0.5, 1.0 - f64::EPSILON, 1.0] {
        let transfer = Transfer { opacity: vec![[0.0, alpha]], ..Transfer::default() };
        let scene = Scene { transfer, ..scene_along([0.0, 1.0, 0.0]) };
        let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::SampleFloor, 0.0);
        let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
        let expected = -(63.0 * (-alpha).ln_1p()).exp_m1();
        let got = base.pixel(1, 1)[3];
        assert!((got - expected).abs() <= 1e-13 * expected, "alpha {alpha}: {got:e}, not {expected:e}");
        assert!(got > 0.0 && got <= 1.0);
    }
}

#[test]
fn spacings_of_one_to_a_thousand_are_rendered() {
    for spacing in [[1.0, 1.0, 1000.0], [1000.0, 1.0, 1000.0], [1e-3, 1.0, 0.03], [1e-9, 1e-6, 1e-9]] {
        let volume = noise([6; 3], spacing, 4);
        for direction in VIEWS {
            let scene = scene_along(direction);
            let geometry = geometry(&volume, &scene);
            for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
                for (gradient, name) in GradientMethod::ALL {
                    let options = DiscreteOptions { gradient, border: 0.0, ..DiscreteOptions::default() };
                    let base = discrete(&volume, &scene, &geometry, interpolation, &options, None).unwrap();
                    assert!(base.pixels.iter().any(|pixel| pixel[3] > 0.0), "{name} {spacing:?}");
                    assert_sane(base.pixels.into_iter().flatten());
                }
            }
        }
    }
}

#[test]
fn values_at_the_limits_of_their_type_are_rendered() {
    let scene = scene_along([0.3, 0.2, 1.0]);
    let checker = |x: usize, y: usize, z: usize| (x + y + z).is_multiple_of(2);
    let extremes = [
        Volume::from_fn([5; 3], [1.0; 3], |x, y, z| if checker(x, y, z) { i32::MIN } else { i32::MAX }),
        Volume::from_fn([5; 3], [1.0; 3], |x, y, z| if checker(x, y, z) { f32::MIN } else { f32::MAX }),
        Volume::from_fn([5; 3], [1.0; 3], |x, y, z| if checker(x, y, z) { 1e300 } else { -1e300 }),
        Volume::from_fn([5; 3], [1.0; 3], |x, y, z| if checker(x, y, z) { 1e-310 } else { -1e-310 }),
    ];
    for volume in extremes {
        let volume = volume.unwrap();
        for transfer in [Transfer::default(), Transfer { opacity: vec![[0.0, 0.5]], ..Transfer::default() }] {
            let scene = Scene { transfer, ..scene.clone() };
            let geometry = geometry(&volume, &scene);
            let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
            assert_sane(base.pixels.into_iter().flatten());
        }
    }
}

#[test]
fn what_is_not_a_number_is_refused_with_its_place() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let volume =
            Volume::from_fn([4; 3], [1.0; 3], |x, y, z| if [x, y, z] == [1, 2, 3] { bad } else { 0.0 }).unwrap();
        let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::SampleFloor, 0.5);
        let surface = surface_gradients(&volume, &geometry, SampleCell::Exact, 0.5, &DiscreteOptions::default());
        assert!(matches!(surface, Err(TwinError::Input(Refused::NonFinite(at))) if at.position == [1, 2, 3]));
    }
}

#[test]
fn what_the_reference_refuses_is_refused_in_the_same_words() {
    let volume = noise([4; 3], [1.0; 3], 1);
    let scene = Scene::default();
    let mut short = volume.clone();
    short.samples = Samples::U8(vec![0; 7]);
    let wide = Volume::from_fn([4; 3], [1.0; 3], |x, _, _| if x == 0 { f64::MAX } else { f64::MIN }).unwrap();
    let hole = Volume::from_fn([4; 3], [1.0; 3], |x, _, _| if x == 1 { f64::NAN } else { 0.0 }).unwrap();
    let tilted = Scene { view: View::from_angles(f64::NAN, 0.0), ..Scene::default() };
    let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::SampleFloor, 0.5);
    for (volume, scene, border) in [
        (&short, &scene, 0.0),
        (&wide, &scene, 0.0),
        (&hole, &scene, 0.0),
        (&volume, &tilted, 0.0),
        (&volume, &scene, f64::NAN),
    ] {
        let by_image = image_order(volume, scene, &ImageOrderOptions { border, ..Default::default() }, None);
        let options = DiscreteOptions { border, ..DiscreteOptions::default() };
        let on_base = sheared(volume, scene, &geometry, &options, None);
        assert_eq!(on_base.unwrap_err().to_string(), by_image.unwrap_err().to_string());
    }
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let volume = noise([4, 5, 6], [1.0; 3], 1);
    let other = noise([4, 5, 7], [1.0; 3], 1);
    let geometry = geometry_along(&other, DVec3::Y, TemplateRule::SampleFloor, 0.5);
    let error = sheared(&volume, &Scene::default(), &geometry, &DiscreteOptions::default(), None).unwrap_err();
    assert!(matches!(error, TwinError::Geometry { .. }), "{error}");
}
