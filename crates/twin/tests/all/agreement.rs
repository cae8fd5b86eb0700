//! The twin and the reference in the limit of fine voxels.

use crate::common::{ball, ball_scene, geometry_along, largest_difference};
use cube3_machine::TemplateRule;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ImagePlane, Mode};
use cube3_twin::{DiscreteOptions, true_3d};

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
    assert!(reference.picture.pixels.iter().any(|pixel| pixel[0] > 0.03), "{mode}: the picture shows something");
    largest_difference(&warped, &reference.picture.pixels)
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
