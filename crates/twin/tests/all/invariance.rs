//! What must not change a bit: the 48 symmetries of the cube, and the number of threads.

use crate::common::turn::{Turn, all_turns};
use crate::common::{geometry_along, noise, scene_along};
use cube3_machine::{GradientMethod, TemplateRule};
use cube3_scene::{Mode, Scene, View};
use cube3_twin::{DiscreteOptions, SampleCell, discrete, sheared};
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

#[test]
fn the_48_symmetries_of_the_cube_hold_to_the_bit() {
    // Powers of two, so that the length of the direction has no rounding that depends on the order of its squares.
    let direction = [0.5, -1.0, 0.25];
    for spacing in [[1.0; 3], [1.0, 1.25, 0.75]] {
        let volume = noise([9, 8, 7], spacing, 21);
        let render = |turn: &Turn, interpolation, mode, gradient| {
            let volume = turn.volume(&volume);
            let scene = Scene { mode, ..scene_along(turn.direction(direction)) };
            let along = scene.view.frame().unwrap().direction;
            let geometry = geometry_along(&volume, along, TemplateRule::SampleFloor, 0.5);
            let options = DiscreteOptions { gradient, border: 0.0, ..DiscreteOptions::default() };
            discrete(&volume, &scene, &geometry, interpolation, &options, None).unwrap()
        };
        let same = Turn { axis: [0, 1, 2], reversed: [false; 3] };
        for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
            for (gradient, name) in GradientMethod::ALL {
                let first = render(&same, interpolation, Mode::Composite, gradient);
                assert!(first.pixels.iter().filter(|pixel| pixel[3] > 0.5).count() > 40);
                for turn in all_turns() {
                    let turned = render(&turn, interpolation, Mode::Composite, gradient);
                    assert_eq!(turned, first, "{name}, {:?} {:?}", turn.axis, turn.reversed);
                }
            }
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let volume = noise([40, 41, 42], [1.0; 3], 5);
    let scene = Scene { view: View::from_angles(33.0, -12.0), ..Scene::default() };
    let direction = scene.view.frame().unwrap().direction;
    let geometry = geometry_along(&volume, direction, TemplateRule::PlaneFloor, 0.5);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), None).unwrap())
    };
    let alone = on(1);
    assert_eq!(on(2), alone);
    assert_eq!(on(5), alone);
}

#[test]
fn progress_counts_every_row() {
    let volume = noise([20; 3], [1.0; 3], 5);
    let scene = Scene { view: View::from_direction([0.3, 0.2, 1.0], None), ..Scene::default() };
    let geometry = geometry_along(&volume, DVec3::new(0.3, 0.2, 1.0), TemplateRule::SampleFloor, 0.5);
    let (calls, most) = (AtomicU64::new(0), AtomicU64::new(0));
    let report = |done: u64| {
        calls.fetch_add(1, Ordering::Relaxed);
        most.fetch_max(done, Ordering::Relaxed);
    };
    let base = sheared(&volume, &scene, &geometry, &DiscreteOptions::default(), Some(&report)).unwrap();
    assert_eq!((calls.into_inner(), most.into_inner()), (base.height as u64, base.height as u64));
}
