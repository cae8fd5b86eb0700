//! The enclosure: the integral lies in it, and so does image order at every step that its reach allows.

use crate::scenes::random;
use cube3_converged::{ConvergedOptions, converged, enclosure};
use cube3_reference::{ImageOrderOptions, image_order};

#[test]
fn the_integral_and_every_phase_of_samples_lie_in_it() {
    let (mut channels, mut width, mut narrow) = (0, 0.0, 0);
    for seed in 0..1500 {
        let (volume, scene) = random(seed, 3);
        if scene.view.perspective.is_some() || !scene.transfer.opacity_correction {
            continue;
        }
        // A step is in the smallest spacing, so no more voxels along any axis.
        let ranges = enclosure(&volume, &scene, 1.5).unwrap();
        let exact =
            converged(&volume, &scene, &ConvergedOptions { tolerance: 1e-6, ..Default::default() }, None).unwrap();
        let steps = [1.0, 0.37, 0.1].map(|step_voxel| {
            let options = ImageOrderOptions { step_voxel, ..Default::default() };
            image_order(&volume, &scene, &options, None).unwrap().picture
        });
        for (pixel, range) in ranges.iter().enumerate() {
            for i in 0..3 {
                let [low, high] = range[i];
                let inside = |value: f64, slack: f64| (low - slack..=high + slack).contains(&value);
                let (value, bound) = (exact.picture.pixels[pixel][i], exact.bounds[pixel]);
                assert!(inside(value, bound + 1e-12), "scene {seed}, pixel {pixel}: {value} not in {range:?}");
                for (picture, step) in steps.iter().zip(["1", "0.37", "0.1"]) {
                    let value = picture.pixels[pixel][i];
                    assert!(inside(value, 1e-9), "scene {seed} step {step}, pixel {pixel}: {value} not in {range:?}");
                }
                channels += 1;
                width += high - low;
                narrow += usize::from(high - low < 0.05);
            }
        }
    }
    println!("{channels} channels, {} wide on average, {narrow} narrower than 0.05", width / channels as f64);
    assert!(narrow * 10 > channels);
}
