//! Lengths from geometry: what the samples of a discrete ray stand for adds up to the ray's length in the box of voxel centres, inside of
//! the crop box and the cut planes.

use crate::common::{constant, fog, geometry_along, stretch};
use cube3_cases::cases;
use cube3_frame::DiscreteRay;
use cube3_host::step_length;
use cube3_machine::TemplateRule;
use cube3_scene::{Crop, Cut, Mode, Scene, View};
use cube3_twin::{DiscreteOptions, SampleCell, discrete, sheared, true_3d};
use glam::DVec3;
use proptest::prelude::*;

#[test]
fn a_homogeneous_slab_has_its_closed_form_at_every_angle() {
    for alpha in [1e-12, 0.01, 0.3, 0.999] {
        let (volume, scene) = (constant([9, 33, 9]), fog(alpha));
        let density = -(-alpha).ln_1p();
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
    let (volume, mut scene) = (constant([3, 9, 3]), fog(0.25));
    scene.transfer.opacity_correction = false;
    let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::SampleFloor, 0.5);
    let base = true_3d(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
    assert!((base.pixel(1, 1)[3] - (1.0 - 0.75_f64.powi(8))).abs() < 1e-14);
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
            for offset in [0.0, 0.5] {
                let geometry = geometry_along(&volume, along, TemplateRule::PlaneFloor, offset);
                let base = discrete(&volume, &scene, &geometry, SampleCell::Sheared, &DiscreteOptions::default(), None);
                let most = base.unwrap().pixels.iter().map(|pixel| pixel[3]).fold(0.0, f64::max);
                assert!((most - expected).abs() < 1e-9, "{most}, not {expected} through {dims:?} along {along}");
            }
        }
    }
}

#[test]
fn the_mean_over_all_planes_is_what_is_in_them() {
    for (n, offset) in [(2, 0.0), (5, 0.5), (9, 0.25), (33, 0.9)] {
        let volume = constant([9, n, 9]);
        let scene = Scene { mode: Mode::WeightedSum, ..fog(1.0) };
        let geometry = geometry_along(&volume, DVec3::Y, TemplateRule::PlaneFloor, offset);
        let base = discrete(&volume, &scene, &geometry, SampleCell::Exact, &DiscreteOptions::default(), None).unwrap();
        assert!((base.pixel(4, 4)[0] - 1.0).abs() < 1e-12, "{n} planes at offset {offset}");
    }
}

proptest! {
    #![proptest_config(cases(256))]

    /// Fog inside random cuts and a random crop box, seen along random rays: 1 − e^(−density · length) on every ray.
    #[test]
    fn every_ray_has_its_length(
        dims in prop::array::uniform3(1_usize..9), direction in prop::array::uniform3(-1.0..1.0_f64),
        low in prop::array::uniform3(-1.0..3.0_f64), size in prop::array::uniform3(0.0..7.0_f64),
        normal in prop::array::uniform3(-1.0..1.0_f64), through in prop::array::uniform3(0.0..6.0_f64),
        offset in prop::sample::select(vec![0.0, 0.3, 0.5]),
    ) {
        prop_assume!(DVec3::from(direction).length() > 0.1 && DVec3::from(normal).length() > 0.1);
        let volume = constant(dims);
        let mut scene = fog(0.3);
        scene.view = View::from_direction(direction, None);
        scene.crop = Some(Crop { min_voxel: low, max_voxel: [0, 1, 2].map(|i| low[i] + size[i]) });
        scene.cuts = vec![Cut { normal, through_voxel: through }];
        let density = -(0.7_f64).ln();
        let opacity = |length: f64| -(-density * length).exp_m1();
        let thick = scene.thickened(dims.map(|n| n == 1));
        let drawn = volume.thickened();
        let view = thick.view.frame().unwrap();
        let geometry = geometry_along(&volume, view.direction, TemplateRule::PlaneFloor, offset);
        let base = discrete(&volume, &scene, &geometry, SampleCell::Exact, &DiscreteOptions::default(), None).unwrap();
        for (i, pixel) in base.pixels.iter().enumerate() {
            let first = geometry.first_ray();
            let ray = DiscreteRay { u: first.u + (i % base.width) as i64, v: first.v + (i / base.width) as i64 };
            let [du, dv] = geometry.real_slopes();
            let place = |w: f64| {
                let at = [ray.u as f64 + w * du, ray.v as f64 + w * dv, w];
                DVec3::from(geometry.axes.voxel_position(geometry.size, at))
            };
            let planes = [0.0, (geometry.size[2] - 1) as f64];
            let span = stretch(&thick, drawn.dims, place(0.0), place(1.0) - place(0.0), planes);
            let length = span.map_or(0.0, |[enter, leave]| leave - enter) * step_length(&geometry, drawn.spacing);
            // A stretch between two samples has none.
            prop_assert!(pixel[3] == 0.0 || (pixel[3] - opacity(length)).abs() < 1e-7, "{pixel:?}, not {length}");
            prop_assert!(pixel[3] > 0.0 || length < 2.01 * step_length(&geometry, drawn.spacing));
        }
    }
}
