//! Label volumes in the reference: the nearest voxel and nothing between.

use crate::common::labels::{TOP, direction, labels, scene};
use crate::common::one_voxel_a_pixel;
use cube3_cases::cases;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ColourPoint, Image, ImagePlane, Mode, Perspective, View};
use cube3_volume::Volume;
use glam::DVec3;
use proptest::prelude::*;

/// Along a line `origin + t·direction` in voxels: where it is in the box of whole voxels.
fn in_box(dims: [usize; 3], origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for i in 0..3 {
        let faces = [-0.5, dims[i] as f64 - 0.5].map(|face| (face - origin[i]) / direction[i]);
        span = [span[0].max(faces[0].min(faces[1])), span[1].min(faces[0].max(faces[1]))];
    }
    (span[0] <= span[1]).then_some(span)
}

/// The largest label at steps of a ray; none where the ray misses, or comes so near a face between two voxels that rounding decides.
fn largest(volume: &Volume, origin: DVec3, direction: DVec3, start: f64, step: f64) -> Option<f64> {
    let [enter, leave] = in_box(volume.dims, origin, direction)?;
    let enter = enter.max(start);
    let whole = ((leave - enter) / step).floor();
    if leave < enter || ((leave - enter) / step - whole - 0.5).abs() > 0.4999 {
        return None;
    }
    let mut best = 0.0_f64;
    for index in 0..=whole as usize + 1 {
        let at = origin + direction * if index as f64 > whole { leave } else { enter + index as f64 * step };
        let mut voxel = [0; 3];
        for i in 0..3 {
            let from_face = (at[i] + 0.5).fract().abs();
            let on_outer = (at[i] + 0.5).abs() < 1e-6 || (at[i] + 0.5 - volume.dims[i] as f64).abs() < 1e-6;
            if !(1e-6..1.0 - 1e-6).contains(&from_face) && !on_outer {
                return None;
            }
            voxel[i] = ((at[i] + 0.5).max(0.0) as usize).min(volume.dims[i] - 1);
        }
        best = best.max(volume.value(voxel[0], voxel[1], voxel[2]));
    }
    Some(best)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(150) })]

    /// In mode maximum a pixel is the shade of the largest label that a loop over its ray finds.
    #[test]
    fn image_order_is_a_direct_loop_over_nearest_voxels(
        dims in [1_usize..8, 1_usize..8, 1_usize..8], spacing in [0.5..2.0_f64, 0.5..2.0_f64, 0.5..2.0_f64],
        direction in direction(), seed: u64, step in 0.2..1.5_f64, eye in prop::option::of(-30.0..2.0_f64),
    ) {
        let volume = labels(dims, spacing, seed);
        let mut scene = scene(direction, Mode::Maximum);
        scene.image = Image { width_px: 12, height_px: 12, ..Image::default() };
        scene.view.perspective = eye.map(|distance| {
            let toward = DVec3::from(direction).normalize() * distance;
            let middle = DVec3::from(dims.map(|n| (n - 1) as f64 / 2.0)) + DVec3::new(0.013, 0.017, 0.019);
            Perspective { eye_voxel: Some((middle + toward).into()), ..Perspective::new(50.0) }
        });
        let picture = image_order(&volume, &scene, &ImageOrderOptions { step_voxel: step, ..Default::default() }, None).unwrap();
        let plane = ImagePlane::new(&scene, &scene.view.frame().unwrap(), dims, spacing);
        let smallest = spacing.into_iter().fold(f64::INFINITY, f64::min);
        let mut compared = 0;
        for (i, pixel) in picture.picture.pixels.iter().enumerate() {
            let (origin, ray) = plane.ray((i % 12) as f64, (i / 12) as f64);
            let direction = ray.normalize() * smallest / DVec3::from(spacing);
            let start = if eye.is_some() { 0.0 } else { f64::NEG_INFINITY };
            let Some(label) = largest(&volume, origin / DVec3::from(spacing), direction, start, step) else {
                continue;
            };
            compared += 1;
            prop_assert!((pixel[0] - label / TOP).abs() < 1e-9, "pixel {}: {}, not {}", i, pixel[0] * TOP, label);
        }
        prop_assume!(compared > 0);
    }

    /// Mirroring volume and view mirrors the picture: x stands across the view, so columns change sides.
    #[test]
    fn a_mirrored_volume_has_the_mirrored_picture(seed: u64, tilt in 3.0..40.0_f64) {
        let dims = [7, 6, 5];
        let volume = labels(dims, [1.0, 1.3, 0.9], seed);
        let mirrored = Volume::from_fn(dims, volume.spacing, |x, y, z| volume.value(6 - x, y, z) as u8).unwrap();
        let mut scene = scene([0.0, 1.0, 0.0], Mode::Maximum);
        scene.view = View::from_angles(0.0, tilt);
        scene.image = Image { width_px: 14, height_px: 14, pixel_size_voxel: Some(0.61) };
        let of = |volume: &Volume| image_order(volume, &scene, &ImageOrderOptions { step_voxel: 0.37, ..Default::default() }, None).unwrap();
        let (right, left) = (of(&volume), of(&mirrored));
        for (right, left) in right.picture.pixels.chunks(14).zip(left.picture.pixels.chunks(14)) {
            let turned: Vec<[f64; 3]> = left.iter().rev().copied().collect();
            prop_assert_eq!(right, turned.as_slice());
        }
    }
}

/// m planes of a label are m voxels thick, from the front, and a volume of one voxel is one voxel thick from everywhere.
#[test]
fn labels_are_as_thick_as_their_voxels() {
    for (planes, along) in [(1, 9), (3, 9), (9, 9), (1, 1)] {
        let volume = Volume::from_fn([5, along, 5], [1.0; 3], |_, y, _| u8::from(y < planes)).unwrap();
        let mut scene = scene([0.0, 1.0, 0.0], Mode::Composite);
        scene.transfer.opacity = vec![[0.5, 0.0], [0.5, 0.3]];
        scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
        scene.image = one_voxel_a_pixel(1, 1);
        // Steps that divide a voxel, from its one face to the other.
        for step_voxel in [0.5, 0.25] {
            let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
            let got = image_order(&volume, &scene, &options, None).unwrap().picture.pixels[0][0];
            // The trapezoid rule at the two faces of the label: half a step at the volume's own face.
            let faces = if planes == along { 0.0 } else { 0.5 * step_voxel };
            let right = 1.0 - 0.7_f64.powf(planes as f64 - faces);
            assert!((got - right).abs() < 1e-12, "image order, {step_voxel}: {got}, not {right}");
        }
    }
}
