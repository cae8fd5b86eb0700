//! Sequences: what is refused before anything runs.

use cube3::sequence::run_sequence;
use cube3::{Error, RunOptions};
use cube3_inputs::Series;
use cube3_machine::MachineSpec;
use cube3_method::{CONVERGED, Choice};
use cube3_scene::{Image, Mode, Scene, VolumeSource};
use cube3_volume::ReadOptions;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many pictures and steps there were, and the outcome, of two frames against a method that shows no mode that chooses a sample.
fn against_converged(mode: Mode) -> ([usize; 2], Result<cube3::RunResult, Error>) {
    let phantom = VolumeSource { phantom: Some("shells".into()), size_voxels: Some(16), ..VolumeSource::default() };
    let scene = Scene {
        volume: phantom,
        mode,
        image: Image { width_px: 16, height_px: 16, ..Image::default() },
        ..Scene::default()
    };
    let machine = MachineSpec::default();
    let mut series = Series::open(&scene, &machine, &ReadOptions::default(), false, 2).unwrap();
    let options = RunOptions { reference: Some(Choice::of(&CONVERGED)), limits: false, ..RunOptions::default() };
    let (mut pictures, steps) = (0, AtomicUsize::new(0));
    let mut take = |_: cube3::sequence::Shown<'_>| {
        pictures += 1;
        Ok(())
    };
    let watch = |_: &'static str, _: u64, _: u64| {
        steps.fetch_add(1, Ordering::Relaxed);
    };
    let result = run_sequence(&scene, &machine, &mut series, 2, &options, &mut take, &watch);
    ([pictures, steps.into_inner()], result)
}

#[test]
fn a_reference_that_cannot_show_the_scene_is_refused_before_the_clock_runs() {
    let (seen, result) = against_converged(Mode::Maximum);
    assert!(matches!(result, Err(Error::Method(_))), "{:?}", result.err());
    assert_eq!(seen, [0, 0], "pictures and steps");
    let (seen, result) = against_converged(Mode::Composite);
    assert!(result.is_ok() && seen[0] == 2 && seen[1] > 0, "{seen:?}, {:?}", result.err());
}
