//! What the twin works out for itself, against what the host makes the registers from: two pieces of arithmetic, one meaning.

use crate::common::{geometry_along, largest_difference, noise};
use cube3_cases::cases;
use cube3_frame::Geometry;
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{Image, ImagePlane, Scene, View};
use cube3_twin::{Basis, DiscreteOptions, sheared, step_length};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;

/// Directions of every octant, some of them along axes and between two of them.
fn directions() -> impl Strategy<Value = DVec3> {
    let part = || prop_oneof![3 => -1.0..1.0_f64, 1 => prop::sample::select(vec![-1.0, 0.0, 0.5, 1.0])];
    [part(), part(), part()].prop_map(DVec3::from).prop_filter("no direction", |direction| direction.length() > 1e-3)
}

/// Voxels up to a thousand times as long as wide.
fn spacings() -> impl Strategy<Value = [f64; 3]> {
    let side = || prop_oneof![1 => Just(1.0), 3 => (-1.5..1.5_f64).prop_map(|power| 10_f64.powf(power))];
    [side(), side(), side()]
}

fn geometry(direction: DVec3, spacing: [f64; 3]) -> Geometry {
    let volume = Volume::from_fn([2, 3, 4], spacing, |_, _, _| 0_u8).unwrap();
    geometry_along(&volume, direction, TemplateRule::PlaneFloor, 0.5)
}

/// Relative to the larger of the two, or of `most` where both may be next to nothing.
fn close(ours: f64, hosts: f64, most: f64) -> bool {
    (ours - hosts).abs() <= 1e-12 * ours.abs().max(hosts.abs()).max(most)
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn a_step_is_as_long_as_the_hosts(direction in directions(), spacing in spacings()) {
        let geometry = geometry(direction, spacing);
        let (ours, hosts) = (step_length(&geometry, spacing), cube3_host::step_length(&geometry, spacing));
        prop_assert!(close(ours, hosts, 0.0), "{ours}, not {hosts}");
    }

    #[test]
    fn the_basis_is_the_hosts(
        direction in directions(), spacing in spacings(), vector in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let geometry = geometry(direction, spacing);
        let axes = &geometry.axes;
        for (method, name) in GradientMethod::ALL {
            let ours = Basis::new(&geometry, spacing, method);
            let hosts = cube3_host::Basis::new(&geometry, spacing, method);
            let what = format!("{name}: {ours:?}, not {hosts:?}");
            for i in 0..3 {
                prop_assert!(close(ours.lengths[i], hosts.lengths[i], 0.0), "{}", what);
                // Of unit length: a component may be what rounding has left of nothing.
                prop_assert!((0..3).all(|j| close(ours.vectors[i][j], hosts.vectors[i][j], 1.0)), "{}", what);
            }
            prop_assert!((0..2).all(|i| close(ours.feet[i], hosts.feet[i], 0.0)), "{}", what);
            let parts = (ours.components(axes, vector.into()), hosts.components(axes, vector.into()));
            prop_assert!((0..3).all(|i| close(parts.0[i], parts.1[i], 1.0)), "{}: {:?}", what, parts);
            let world = (ours.world(axes, vector), hosts.world(axes, vector));
            prop_assert!((0..3).all(|i| close(world.0[i], world.1[i], 1.0)), "{}: {:?}", what, world);
        }
    }

    /// As the definition says: of unit length, along the ray and at right angles to it, the feet no farther than a step.
    #[test]
    fn the_perpendiculars_of_ten_are_at_right_angles_to_the_ray(direction in directions(), spacing in spacings()) {
        let geometry = geometry(direction, spacing);
        let [du, dv] = geometry.real_slopes();
        let spacing_uvw = geometry.axes.permute(spacing);
        let ray = DVec3::new(du * spacing_uvw[0], dv * spacing_uvw[1], spacing_uvw[2]);
        let basis = Basis::new(&geometry, spacing, GradientMethod::TenNormalised);
        let vectors = basis.vectors.map(DVec3::from);
        prop_assert!(vectors.iter().all(|vector| (vector.length() - 1.0).abs() < 1e-12));
        prop_assert!((vectors[2] - ray.normalize()).length() < 1e-12);
        prop_assert!((basis.lengths[2] / ray.length() - 1.0).abs() < 1e-12);
        for i in 0..2 {
            prop_assert!((0.0..=1.0).contains(&basis.feet[i]));
            let cosine = vectors[i].dot(ray.normalize());
            // What is lost where the ray beside runs nearly along the one in the middle.
            let rounding = 1e-14 * spacing_uvw[i] / basis.lengths[i];
            prop_assert!(cosine.abs() < 1e-14 + rounding || basis.feet[i] == 1.0 && cosine > 0.0, "{cosine:e}");
        }
    }

    #[test]
    fn a_picture_is_warped_as_the_host_warps(direction in directions(), seed: u64) {
        let volume = noise([6, 5, 7], [1.0, 0.8, 1.3], seed);
        let scene = Scene {
            view: View::from_direction(direction.to_array(), None),
            image: Image { width_px: 11, height_px: 9, pixel_size_voxel: Some(0.9) },
            background: [0.1, 0.5, 0.2],
            ..Scene::default()
        };
        let view = scene.view.frame().unwrap();
        let geometry = geometry_along(&volume, view.direction, TemplateRule::SampleFloor, 0.5);
        let plane = ImagePlane::new(&scene, &view, volume.dims, volume.spacing);
        let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap();
        let ours = base.warp(&geometry, &plane, volume.spacing, scene.background);
        let pixel = |column, row| base.pixel(column, row);
        let hosts = cube3_host::warp_reals(&pixel, &geometry, &plane, volume.spacing, scene.background);
        prop_assert!(largest_difference(&ours, &hosts) < 1e-12);
        prop_assert!(ours.iter().any(|pixel| *pixel != scene.background));
    }
}

/// Cubes at 45°: the foot is half a step away, its perpendicular √½ long.
#[test]
fn a_foot_at_45_degrees_is_half_a_step_away() {
    let geometry = geometry(DVec3::new(0.0, 1.0, 1.0), [1.0; 3]);
    let basis = Basis::new(&geometry, [1.0; 3], GradientMethod::Ten);
    assert_eq!(basis.feet, [0.5, 0.0]);
    assert!((basis.lengths[0] - 0.5_f64.sqrt()).abs() < 1e-15 && (basis.lengths[2] - 2_f64.sqrt()).abs() < 1e-15);
    assert_eq!((basis.lengths[1], basis.vectors[1]), (1.0, [0.0, 1.0, 0.0]));
    assert!((step_length(&geometry, [1.0; 3]) - 2_f64.sqrt()).abs() < 1e-15);
}
