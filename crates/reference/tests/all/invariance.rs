//! What must not change a bit, the number of threads, or hardly one, the 48 symmetries of the cube.

use crate::common::turn::{Turn, all_turns};
use crate::common::{largest_difference, noise};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{Image, Light, Perspective, Scene, View};
use std::sync::atomic::{AtomicU64, Ordering};

#[test]
fn the_48_symmetries_of_the_cube_hold_in_perspective() {
    let spacing = [1.0, 1.25, 0.75];
    let volume = noise([9, 8, 7], spacing, 21);
    // The eye's place from the centre, in voxels, so that it turns about it; and the light.
    for (from_centre, light) in [([-9.0, 17.0, -6.0], [1.0, 2.0, -0.5]), ([1.25, 0.5, -2.0], [-1.0, 0.25, 3.0])] {
        let render = |turn: &Turn| {
            let volume = turn.volume(&volume);
            let place = turn.direction(from_centre);
            let eye = [0, 1, 2].map(|i| (volume.dims[i] - 1) as f64 / 2.0 + place[i]);
            let mut view =
                View::from_direction(turn.direction([0.5, -1.0, 0.25]), Some(turn.direction([0.1, 0.3, 1.0])));
            view.perspective = Some(Perspective { eye_voxel: Some(eye), ..Perspective::new(50.0) });
            let turned = Light { direction: Some(turn.direction(light)), colour: [0.2, 0.3, 0.4] };
            let image = Image { width_px: 24, height_px: 20, pixel_size_voxel: None };
            let scene = Scene { view, image, lights: vec![Light::default(), turned], ..Scene::default() };
            image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap()
        };
        let first = render(&Turn { axis: [0, 1, 2], reversed: [false; 3] });
        let shown = first.picture.pixels.iter().filter(|pixel| pixel[0] > 0.1).count();
        assert!(shown > 40, "{shown}");
        for turn in all_turns() {
            let mut turned = render(&turn);
            let odd = turn.reversed.iter().filter(|reversed| **reversed).count() % 2 == 1;
            let swapped = [[0, 2, 1], [1, 0, 2], [2, 1, 0]].contains(&turn.axis);
            if odd != swapped {
                // A mirror image of the volume has a mirror image for a picture.
                turned.picture.pixels.chunks_mut(24).for_each(<[_]>::reverse);
            }
            assert_eq!(turned.samples, first.samples);
            let error = largest_difference(&turned.picture.pixels, &first.picture.pixels);
            assert!(error < 1e-11, "{:?} {:?}: {error:e}", turn.axis, turn.reversed);
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let volume = noise([40, 41, 42], [1.0; 3], 5);
    let scene = Scene { view: View::from_angles(33.0, -12.0), ..Scene::default() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| image_order(&volume, &scene, &ImageOrderOptions::default(), None).unwrap())
    };
    let alone = on(1);
    assert_eq!(on(2), alone);
    assert_eq!(on(5), alone);
}

#[test]
fn progress_counts_every_row() {
    let volume = noise([20; 3], [1.0; 3], 5);
    let scene = Scene { view: View::from_direction([0.3, 0.2, 1.0], None), ..Scene::default() };
    let (calls, most) = (AtomicU64::new(0), AtomicU64::new(0));
    let report = |done: u64| {
        calls.fetch_add(1, Ordering::Relaxed);
        most.fetch_max(done, Ordering::Relaxed);
    };
    let picture = image_order(&volume, &scene, &ImageOrderOptions::default(), Some(&report)).unwrap();
    assert_eq!((calls.into_inner(), most.into_inner()), (picture.picture.height as u64, 512));
}
