//! The stiff and the extreme: smallest volumes, no opacity and full opacity, values and spacings at their limits, bad
//! input.

use crate::common::{VIEWS, assert_sane, noise, one_voxel_a_pixel, scene_along};
use cube3_reference::{ImageOrderOptions, RaycastError, image_order};
use cube3_scene::{Mode, Scene, Transfer, View};
use cube3_volume::{Samples, Volume};

#[test]
fn the_smallest_volumes_are_rendered() {
    for dims in [[1; 3], [1, 1, 9], [9, 1, 1], [1, 9, 1], [2; 3], [3, 1, 2], [1, 6, 6]] {
        let volume = Volume::from_fn(dims, [1.0; 3], |_, _, _| 200_u8).unwrap();
        for direction in VIEWS {
            for mode in Mode::ALL {
                let scene = Scene { mode, image: one_voxel_a_pixel(21, 21), ..scene_along(direction) };
                let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
                assert_sane(picture.picture.pixels.iter().copied().flatten());
            }
        }
    }
    // A single voxel is one thick: two samples straight ahead, half a voxel before its centre and half a voxel behind.
    let volume = Volume::from_fn([1; 3], [1.0; 3], |_, _, _| 200_u8).unwrap();
    let ahead = View::from_angles(0.0, 0.0);
    let scene = Scene { view: ahead, image: one_voxel_a_pixel(3, 3), ..Scene::default() };
    let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
    assert_eq!(picture.samples, 2);
    assert!(picture.picture.pixels[4][0] > 0.0 && picture.picture.pixels[3] == [0.0; 3]);
}

#[test]
fn a_line_of_voxels_is_seen_along_it_and_across() {
    let volume = Volume::from_fn([1, 1, 9], [1.0; 3], |_, _, z| 20 * z as u8).unwrap();
    let seen = |direction: [f64; 3]| {
        let scene = Scene { image: one_voxel_a_pixel(11, 11), mode: Mode::Maximum, ..scene_along(direction) };
        let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
        (picture.samples, picture.picture.pixels.iter().filter(|pixel| pixel[0] > 0.0).count())
    };
    assert_eq!(seen([0.0, 0.0, 1.0]), (9, 1));
    // Voxels of 100 and more are seen, 80 is clear: four of them. Each is one thick.
    assert_eq!(seen([0.0, 1.0, 0.0]), (18, 4));
}

#[test]
fn nothing_is_nothing_and_full_is_full() {
    let volume = noise([8; 3], [1.0; 3], 9);
    let opacity = |alpha: f64| Transfer { opacity: vec![[0.0, alpha]], ..Transfer::default() };
    for direction in VIEWS {
        for mode in Mode::ALL {
            let clear = Scene { mode, transfer: opacity(0.0), background: [0.2, 0.4, 0.6], ..scene_along(direction) };
            let picture = image_order(&volume, &clear, &ImageOrderOptions::default(), None).unwrap();
            assert!(picture.picture.pixels.iter().all(|pixel| *pixel == clear.background), "{mode}");
        }
        // Opacity 1 at the first sample: one sample a ray, and exactly the first one's colour at any step.
        let full = Scene { transfer: opacity(1.0), ..scene_along(direction) };
        let first = Scene { mode: Mode::FirstOpaque, ..full.clone() };
        for step_voxel in [1e-3, 0.3, 1.0, 7.0] {
            let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
            let [full, first] = [&full, &first].map(|scene| image_order(&volume, scene, &options, None).unwrap());
            assert_eq!(full.picture.pixels, first.picture.pixels);
            assert!(full.samples <= (full.picture.width * full.picture.height) as u64, "the ray stops at once");
        }
    }
}

#[test]
fn spacings_of_one_to_a_thousand_are_rendered() {
    for spacing in [[1.0, 1.0, 1000.0], [1000.0, 1.0, 1000.0], [1e-3, 1.0, 0.03], [1e-9, 1e-6, 1e-9]] {
        let volume = noise([6; 3], spacing, 4);
        for direction in VIEWS {
            let mut scene = scene_along(direction);
            // An odd number of pixels has one in the middle, whose ray meets the thinnest volume.
            scene.image.width_px = 25;
            scene.image.height_px = 25;
            let options = ImageOrderOptions { step_voxel: 2.0, ..ImageOrderOptions::default() };
            let picture = image_order(&volume, &scene, &options, None).unwrap();
            assert_sane(picture.picture.pixels.iter().copied().flatten());
            assert!(picture.samples > 0);
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
            let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap();
            assert_sane(picture.picture.pixels.into_iter().flatten());
        }
    }
}

/// The message of a refusal.
fn refusal(volume: &Volume, scene: &Scene, border: f64) -> String {
    let options = ImageOrderOptions { border, ..ImageOrderOptions::default() };
    image_order(volume, scene, &options, None).unwrap_err().to_string()
}

#[test]
fn what_is_not_a_number_is_refused_with_its_place() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let volume =
            Volume::from_fn([4; 3], [1.0; 3], |x, y, z| if [x, y, z] == [1, 2, 3] { bad } else { 0.0 }).unwrap();
        let message = refusal(&volume, &Scene::default(), 0.0);
        assert!(message.starts_with("volume: voxel (1, 2, 3) is"), "{message}");
        let refused = image_order(&volume, &Scene::default(), &ImageOrderOptions::default(), None);
        assert!(matches!(refused, Err(RaycastError::NonFinite(at)) if at.position == [1, 2, 3]));
    }
    let volume = noise([4; 3], [1.0; 3], 1);
    let message = refusal(&volume, &Scene::default(), f64::NAN);
    assert!(message.starts_with("border: NaN is not a value"), "{message}");
    let wide = Volume::from_fn([4; 3], [1.0; 3], |x, _, _| if x == 0 { f64::MAX } else { f64::MIN }).unwrap();
    let message = refusal(&wide, &Scene::default(), 0.0);
    assert!(message.contains("too far apart"), "{message}");
    let tilted = Scene { view: View::from_angles(f64::NAN, 0.0), ..Scene::default() };
    assert!(refusal(&volume, &tilted, 0.0).contains("view.yaw_deg"));
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let volume = noise([4, 5, 6], [1.0; 3], 1);
    for step_voxel in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
        let options = ImageOrderOptions { step_voxel, ..ImageOrderOptions::default() };
        let message = image_order(&volume, &Scene::default(), &options, None).unwrap_err().to_string();
        assert!(message.starts_with("step_voxel: "), "{message}");
    }
    let mut short = volume.clone();
    short.samples = Samples::U8(vec![0; 7]);
    assert!(refusal(&short, &Scene::default(), 0.0).contains("7 samples for 4×5×6 voxels"));
    let mut flat = volume;
    flat.spacing[1] = 0.0;
    let message = image_order(&flat, &Scene::default(), &ImageOrderOptions::default(), None).unwrap_err().to_string();
    assert!(message.contains("voxel spacing"), "{message}");
}

#[test]
fn a_view_along_an_axis_takes_every_voxel_once_whatever_rounding_does_at_the_faces() {
    for spacing in [1.0, 0.1, 0.3, 0.7, 1.0 / 3.0] {
        for n in [2, 3, 8, 11, 12] {
            let volume = noise([n; 3], [spacing; 3], 2);
            for direction in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
                let image = one_voxel_a_pixel(n as u32, n as u32);
                let scene = Scene { image, mode: Mode::Maximum, ..scene_along(direction) };
                for parts in [1, 3, 10] {
                    let options = ImageOrderOptions { step_voxel: 1.0 / parts as f64, ..ImageOrderOptions::default() };
                    let picture = image_order(&volume, &scene, &options, None).unwrap();
                    let samples = n * n * ((n - 1) * parts + 1);
                    assert_eq!(picture.samples, samples as u64, "{n}³ voxels of {spacing}, {parts} steps each");
                }
            }
        }
    }
    // Spacings whose ratios are whole but for rounding: the last sample is on the far face all the same.
    for n in 2..40 {
        for (spacing, ratio) in [([0.1, 0.3, 0.7], 3), ([0.1, 0.7, 0.3], 7), ([1.1, 3.3, 1.1], 3)] {
            let volume = noise([3, n, 3], spacing, 2);
            let scene = Scene { image: one_voxel_a_pixel(1, 1), mode: Mode::Maximum, ..scene_along([0.0, 1.0, 0.0]) };
            for parts in [1, 3, 10] {
                let options = ImageOrderOptions { step_voxel: 1.0 / parts as f64, ..ImageOrderOptions::default() };
                let picture = image_order(&volume, &scene, &options, None).unwrap();
                assert_eq!(picture.samples, ((n - 1) * ratio * parts + 1) as u64, "{n} voxels of {spacing:?}");
            }
        }
    }
}
