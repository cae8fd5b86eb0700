//! Label volumes on the base plane: the nearest voxel and nothing between.

use crate::common::geometry_along;
use crate::common::labels::{TOP, direction, labels, scene};
use cube3_cases::cases;
use cube3_frame::{DiscreteRay, Geometry};
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{ColourPoint, Mode};
use cube3_twin::{DiscreteOptions, RealSamples, SampleCell, sheared, true_3d};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(150) })]

    /// The cells differ, the nearest voxel does not.
    #[test]
    fn true_and_sheared_are_the_same(
        dims in [1_usize..8, 1_usize..8, 1_usize..8], direction in direction(), seed: u64, whole_steps: bool, lit: bool,
    ) {
        let volume = labels(dims, [1.0; 3], seed);
        let mut scene = scene(direction, Mode::Composite);
        scene.transfer.opacity = vec![[0.0, 0.0], [TOP, 0.4]];
        scene.material.shaded = lit;
        let geometry = nearest(&volume, direction);
        let options = DiscreteOptions { whole_steps, ..DiscreteOptions::default() };
        let of = [true_3d, sheared].map(|caster| caster(&volume, &scene, &geometry, &options, None).unwrap());
        prop_assert_eq!(&of[0], &of[1]);
    }
}

/// The geometry of labels, whose axes of one voxel are not doubled.
fn nearest(volume: &Volume, direction: [f64; 3]) -> Geometry {
    let geometry = geometry_along(volume, direction.into(), TemplateRule::Nearest, 0.5);
    let size = geometry.axes.permute(volume.dims);
    Geometry::new(size, geometry.axes, geometry.slopes, 0, geometry.weight_bits, TemplateRule::Nearest, geometry.slots)
}

/// m planes of a label are m voxels thick, from the front, and a volume of one voxel is one voxel thick from everywhere.
#[test]
fn labels_are_as_thick_as_their_voxels() {
    for (planes, along) in [(1, 9), (3, 9), (9, 9), (1, 1)] {
        let volume = Volume::from_fn([5, along, 5], [1.0; 3], |_, y, _| u8::from(y < planes)).unwrap();
        let mut scene = scene([0.0, 1.0, 0.0], Mode::Composite);
        scene.transfer.opacity = vec![[0.5, 0.0], [0.5, 0.3]];
        scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
        let right = 1.0 - 0.7_f64.powi(planes as i32);
        let close = |got: f64, what: &str| assert!((got - right).abs() < 1e-12, "{what}: {got}, not {right}");
        for whole_steps in [false, true] {
            let options = DiscreteOptions { whole_steps, ..DiscreteOptions::default() };
            let base = sheared(&volume, &scene, &nearest(&volume, [0.0, 1.0, 0.0]), &options, None).unwrap();
            close(base.pixels[base.width * (base.height / 2) + base.width / 2][0], "sheared");
            scene.mode = Mode::WeightedSum;
            let base = sheared(&volume, &scene, &nearest(&volume, [0.0, 1.0, 0.0]), &options, None).unwrap();
            let sum = base.pixels[base.width * (base.height / 2) + base.width / 2][0];
            assert!((sum - 0.3 * planes as f64 / along as f64).abs() < 1e-12, "{sum}");
            scene.mode = Mode::Composite;
        }
    }
}

/// Normals of a ball of labels against the true ones: estimators keep their slopes, and many differences are better than few.
#[test]
fn many_differences_make_better_normals_of_labels() {
    let centre = DVec3::splat(14.0);
    let inside = |x, y, z| u8::from((DVec3::new(x as f64, y as f64, z as f64) - centre).length() < 10.0);
    let volume = Volume::from_fn([29; 3], [1.0; 3], inside).unwrap();
    let geometry = nearest(&volume, [0.6, 0.45, 1.0]);
    let samples = RealSamples::new(&volume, &geometry, SampleCell::Exact, 0.0).unwrap();
    let [width, height] = geometry.base_plane_size();
    let first = geometry.first_ray();
    let mut surface = Vec::new();
    for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
        let ray = DiscreteRay { u: first.u + column as i64, v: first.v + row as i64 };
        surface.extend((0..29).find(|&k| samples.sample(ray, k) == Some(1.0)).map(|k| (ray, k)));
    }
    let mean = |gradient: &dyn Fn(DiscreteRay, i64) -> DVec3| {
        let angle = |&(ray, k): &(DiscreteRay, i64)| {
            let place = geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k as usize));
            let gradient = gradient(ray, k);
            let lost = gradient == DVec3::ZERO;
            if lost { 90.0 } else { (-gradient).angle_between(DVec3::from(place) - centre).to_degrees() }
        };
        surface.iter().map(angle).sum::<f64>() / surface.len() as f64
    };
    let of = |method: GradientMethod| mean(&|ray, k| samples.world_gradient(ray, k, method));
    let [twelve, normalised, many] =
        [GradientMethod::Twelve, GradientMethod::TenNormalised, GradientMethod::TwentySixSheared].map(of);
    // Estimator 12 with its weights 0.6 and 0.45 rounded to 1 and 0: straight behind is then the ray on the left.
    let rounded = mean(&|ray, k| {
        let at = |i, j, l| samples.sample(DiscreteRay { u: ray.u + i, v: ray.v + j }, k + l).unwrap_or(0.0);
        let across = [at(1, 0, 0) - at(-1, 0, 0), at(0, 1, 0) - at(0, -1, 0)];
        geometry.axes.to_world([across[0], across[1], at(-1, 0, 1) - at(1, 0, -1)])
    });
    println!("{} rays: 12 {twelve:.1}°, rounded {rounded:.1}°, 10n {normalised:.1}°, 26d {many:.1}°", surface.len());
    assert!(twelve < 27.0 && normalised < 23.0 && many < 14.5 && rounded > twelve + 5.0);
}
