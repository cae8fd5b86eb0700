//! What words cost is within the bound of the book: every pixel of the machine lies between the ends that the frame in reals and the grains
//! of its words give it.

use cube3_bound::{Grains, Interval, Walk};
use cube3_cases::cases;
use cube3_definition::Definition;
use cube3_frame::FrameSetup;
use cube3_host::picture_setup;
use cube3_machine::{GradientMethod, MachineSpec, RayEnds};
use cube3_scene::{Mode, Scene, Threshold};
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes};
use cube3_twin::{DiscreteOptions, sheared};
use cube3_volume::{Samples, Volume};
use cube3_word::{Rounding, Words, unit_full};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::sync::Mutex;

/// Data values of the voxel words.
const WINDOW: [f64; 2] = [0.0, 255.0];

/// The widest words; two-dimensional tables have fewer entries, so that a test makes many.
fn widest(scene: &Scene, rounding: Rounding) -> Words {
    let rows = scene.transfer.is_two_dimensional();
    Words {
        voxel_bits: 16,
        weight_bits: 12,
        sample_fraction_bits: 8,
        gradient_bits: 24,
        normal_bits: 15,
        table_bits: if rows { 8 } else { 14 },
        table_gradient_bits: 7,
        colour_bits: 16,
        opacity_bits: 16,
        accumulator_bits: 32,
        rounding,
    }
}

fn machine_of(machine: &MachineSpec, scene: &Scene) -> MachineSpec {
    let mut machine = machine.clone();
    machine.words = widest(scene, machine.words.rounding);
    (machine.abc.power_bits, machine.abc.root_bits, machine.abc.reflectance_bits) = (14, 10, 8);
    machine
}

/// Volumes of a few levels with plateaus of four voxels and more, some with noise of a few words on them.
fn volumes() -> impl Strategy<Value = SmallVolume> {
    let dims = [2_usize..=7, 2..=7, 2..=7];
    let spacing = prop_oneof![1 => Just([1.0; 3]), 2 => [0.5..2.0_f64, 0.5..2.0_f64, 0.5..2.0_f64]];
    (dims, spacing, any::<u64>(), prop_oneof![Just(0_u32), Just(9), Just(15)]).prop_map(
        |(dims, spacing, seed, noise)| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let levels: Vec<u32> = (0..64).map(|_| LEVELS[random.next_u32() as usize % LEVELS.len()]).collect();
            let [nx, ny, nz] = dims;
            let words = (0..nx * ny * nz).map(|i| {
                let [x, y, z] = [i % nx, i / nx % ny, i / (nx * ny)].map(|a| a / 2);
                let level = levels[x + 4 * (y + 4 * z)];
                (level + (random.next_u32() & ((1 << noise) - 1))).min(65535) as u16
            });
            let words = words.collect();
            SmallVolume { dims, spacing, words }
        },
    )
}

/// Words of the plateaus.
const LEVELS: [u32; 4] = [0, 20_000, 30_000, 50_000];

/// A scene without labels, whose threshold, if any, is half a sample's word below or above a plateau.
fn on_plateaus(scene: Scene, [low, high]: [usize; 2]) -> Scene {
    let half = 0.5 / 256.0;
    let value = |word: f64| word / 65535.0 * WINDOW[1];
    let threshold = scene.threshold.as_ref().map(|threshold| Threshold {
        low: threshold.low.map(|_| value(f64::from(LEVELS[low]) - half)),
        high: threshold.high.map(|_| value(f64::from(LEVELS[high]) + half)),
    });
    let mut scene = Scene { threshold, ..scene };
    scene.volume.labels = false;
    scene
}

fn parallel() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes(), volumes(), [0_usize..2, 2..4]).prop_map(|(machine, scene, volume, levels)| {
        let scene = on_plateaus(scene, levels);
        (machine_of(&machine, &scene), scene, volume)
    })
}

fn eyes() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (parallel(), perspectives()).prop_map(|((machine, scene, volume), perspective)| {
        (for_perspective(&machine), from_eye(&scene, perspective), volume)
    })
}

/// A volume's words as data.
fn data(volume: &SmallVolume) -> Volume {
    let value = |word: &u16| f64::from(*word) / 65535.0 * WINDOW[1];
    Volume::new(volume.dims, volume.spacing, Samples::F64(volume.words.iter().map(value).collect())).unwrap()
}

/// Errors and bounds of the channels in which there is something.
#[derive(Default)]
struct Measure {
    ratios: Vec<f64>,
    bounds: Vec<f64>,
}

impl Measure {
    fn add(&mut self, word: f64, real: f64, ends: Interval) {
        if word.max(real) > 1e-6 {
            let bound = ends.reach(real);
            self.ratios.push((word - real).abs() / bound);
            self.bounds.push(bound);
        }
    }

    fn show(mut self, name: &str) {
        for values in [&mut self.ratios, &mut self.bounds] {
            values.sort_by(f64::total_cmp);
        }
        let at = |values: &[f64], part: f64| values.get((part * (values.len() - 1) as f64) as usize).copied();
        let [ratios, bounds] = [&self.ratios, &self.bounds];
        println!(
            "{name}: {} channels, bound median {:.1e} 90 % {:.1e}, error/bound median {:.3} 99 % {:.3} max {:.3}",
            ratios.len(),
            at(bounds, 0.5).unwrap(),
            at(bounds, 0.9).unwrap(),
            at(ratios, 0.5).unwrap(),
            at(ratios, 0.99).unwrap(),
            at(ratios, 1.0).unwrap(),
        );
    }
}

/// What rounding of 64-bit reals may add.
const REALS: f64 = 1e-9;

/// The pixels of the machine, as reals.
fn words_of(setup: &FrameSetup, volume: &SmallVolume) -> Vec<[f64; 4]> {
    let base = Definition::new(setup, &volume.words).base_plane();
    let full = f64::from(unit_full(setup.words.accumulator_bits));
    base.pixels.iter().map(|pixel| pixel.map(|word| f64::from(word) / full)).collect()
}

/// The method of a frame's gradients; any where it has none.
fn method_of(setup: &FrameSetup, machine: &MachineSpec) -> GradientMethod {
    setup.gradient.map_or(machine.abc.gradient, |gradient| gradient.method)
}

/// What the twin of a machine is told.
fn twin_options(machine: &MachineSpec, scene: &Scene, gradient: GradientMethod) -> DiscreteOptions {
    let whole_steps = machine.rays.ends == RayEnds::Published || !scene.mode.adds_up();
    DiscreteOptions { gradient, border: WINDOW[0], whole_steps }
}

/// All pixels between their ends.
fn assert_within(pixels: &[[f64; 4]], ends: &[[Interval; 4]], what: &str) -> Result<(), TestCaseError> {
    prop_assert_eq!(pixels.len(), ends.len());
    for (place, (pixel, ends)) in pixels.iter().zip(ends).enumerate() {
        for (channel, (&value, range)) in pixel.iter().zip(ends).enumerate() {
            prop_assert!(
                range.holds(value, REALS),
                "{}: pixel {} channel {}: {} not in {:?}",
                what,
                place,
                channel,
                value,
                range
            );
        }
    }
    Ok(())
}

#[test]
fn every_pixel_of_a_parallel_frame_is_within_its_bound() {
    let measure = Mutex::new(Mode::ALL.map(|mode| (mode, Measure::default())));
    let points = Mutex::new([0_usize; 2]);
    proptest!(cases(600), |((machine, scene, volume) in parallel())| {
        let setup = picture_setup(&scene, &machine, &volume.info(), true).unwrap().setups.remove(0);
        let data = data(&volume);
        let method = method_of(&setup, &machine);
        let walk = |grains| Walk::new(&scene, &setup, &data, WINDOW, method, grains).base_plane();
        let twin = sheared(&data, &scene, &setup.geometry, &twin_options(&machine, &scene, method), None).unwrap().pixels;
        let reals = walk(Grains::none());
        assert_within(&twin, &reals, "twin")?;
        let ends = walk(Grains::of(&setup, WINDOW));
        assert_within(&twin, &ends, "twin in the bound")?;
        let words = words_of(&setup, &volume);
        assert_within(&words, &ends, "machine")?;
        let mut measure = measure.lock().unwrap();
        let of_mode = &mut measure.iter_mut().find(|(mode, _)| *mode == scene.mode).unwrap().1;
        for ((word, real), ends) in words.iter().zip(&twin).zip(&ends) {
            (0..4).for_each(|i| of_mode.add(word[i], real[i], ends[i]));
        }
        let mut points = points.lock().unwrap();
        for range in reals.iter().flatten() {
            points[usize::from(range.high - range.low < REALS)] += 1;
        }
    });
    for (mode, measure) in measure.into_inner().unwrap() {
        measure.show(&mode.to_string());
    }
    let [wide, points] = points.into_inner().unwrap();
    println!("{points} of {} channels of reals are one value", points + wide);
    assert!(wide * 50 < points, "the walk in reals is the twin");
}

#[test]
fn every_pixel_from_an_eye_is_within_its_bound() {
    let measure = Mutex::new(Measure::default());
    let (points, lost) = (Mutex::new([0_usize; 2]), Mutex::new([0_usize; 2]));
    proptest!(cases(300), |((machine, scene, volume) in eyes())| {
        let data = data(&volume);
        for setup in picture_setup(&scene, &machine, &volume.info(), true).unwrap().setups {
            let method = method_of(&setup, &machine);
            let walk = |grains| Walk::new(&scene, &setup, &data, WINDOW, method, grains).base_plane();
            let twin = sheared(&data, &scene, &setup.geometry, &twin_options(&machine, &scene, method), None).unwrap().pixels;
            let reals = walk(Grains::none());
            assert_within(&twin, &reals, "twin")?;
            let ends = walk(Grains::of(&setup, WINDOW));
            let words = words_of(&setup, &volume);
            assert_within(&words, &ends, "machine")?;
            let mut lost = lost.lock().unwrap();
            for (range, &real) in ends.iter().flatten().zip(twin.iter().flatten()) {
                lost[usize::from(range.holds(real, REALS))] += 1;
            }
            let mut points = points.lock().unwrap();
            for range in reals.iter().flatten() {
                points[usize::from(range.high - range.low < REALS)] += 1;
            }
            let mut measure = measure.lock().unwrap();
            for ((word, real), ends) in words.iter().zip(&twin).zip(&ends) {
                (0..4).for_each(|i| measure.add(word[i], real[i], ends[i]));
            }
        }
    });
    measure.into_inner().unwrap().show("perspective");
    let [wide, points] = points.into_inner().unwrap();
    println!("{points} of {} channels of reals are one value", points + wide);
    assert!(wide * 50 < points, "the walk in reals is the twin");
    // Before a far face the last samples of a ray may be missing; in words an end reaches two steps at most, in reals to the face.
    let [beyond, within] = lost.into_inner().unwrap();
    println!("{beyond} of {} channels of reals are beyond the bound of words", beyond + within);
    assert!(beyond * 50 < within, "in reals rays are longer");
}
