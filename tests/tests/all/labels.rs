//! Label volumes: every sample is its nearest voxel, whole, in every view, and the machine shows nothing else.

use cube3_cases::cases;
use cube3_definition::Definition;
use cube3_frame::{BasePlane, DiscreteRay, FrameSetup};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::{ColourPoint, Image, Material, Mode, Perspective, Scene, Transfer, View, VolumeSource};
use cube3_tests::{SmallVolume, directions, for_perspective, from_eye, machines, perspectives, volumes};
use cube3_twin::{RealSamples, SampleCell};
use cube3_volume::{Volume, WordConversion};
use cube3_word::{quantise_unit, unit_resize};
use proptest::prelude::*;

/// Labels have these many bits.
const BITS: u32 = 5;

fn scene(direction: [f64; 3], mode: Mode) -> Scene {
    // Label 0 is clear, others are opaque and have a colour of their own.
    let colour = |value: f64| ColourPoint { value, rgb: [value / 31.0, 1.0 - value / 31.0, 0.5] };
    Scene {
        mode,
        volume: VolumeSource { labels: true, ..VolumeSource::default() },
        view: View::from_direction(direction, None),
        image: Image { width_px: 13, height_px: 9, ..Image::default() },
        transfer: Transfer {
            opacity: vec![[0.5, 0.0], [0.5, 1.0]],
            colour: vec![colour(0.0), colour(31.0)],
            ..Transfer::default()
        },
        material: Material { shaded: false, ..Material::default() },
        ..Scene::default()
    }
}

/// A machine with words of so many bits that each label has one, and an entry of the table.
fn case() -> impl Strategy<Value = (MachineSpec, SmallVolume, [f64; 3], Perspective)> {
    (machines(), volumes(8, BITS), directions(), perspectives()).prop_map(|(mut machine, volume, direction, eye)| {
        let words = &mut machine.words;
        words.voxel_bits = words.voxel_bits.max(BITS);
        words.table_bits = words.table_bits.clamp(BITS, words.sample_bits().min(8));
        (machine, volume, direction, eye)
    })
}

/// The volume's data, its machine words, and what the host knows of them.
fn load(machine: &MachineSpec, volume: &SmallVolume) -> (Volume, Vec<u16>, VolumeInfo) {
    let words = &machine.words;
    let data = Volume::from_fn(volume.dims, volume.spacing, |x, y, z| {
        volume.words[x + volume.dims[0] * (y + volume.dims[1] * z)]
    })
    .unwrap();
    let largest = data.largest_label(words.voxel_bits).unwrap();
    let conversion = WordConversion::labels(largest, words.voxel_bits, words.table_bits);
    let (words, report) = data.to_words(words.voxel_bits, &conversion).unwrap();
    (data, words.words, VolumeInfo { window: report.window, ..volume.info() })
}

/// The label at the voxel nearest to a sample, halves up, by the sample's position alone; none outside of all voxels.
fn nearest(setup: &FrameSetup, volume: &SmallVolume, ray: DiscreteRay, k: usize) -> Option<u16> {
    let geometry = &setup.geometry;
    let place = geometry.sample_position(ray, k);
    let mut at = [0; 3];
    for axis in 0..3 {
        let voxel = (place[axis] + 0.5).floor();
        if voxel < 0.0 || voxel >= geometry.size[axis] as f64 {
            return None;
        }
        at[axis] = voxel as usize;
    }
    let [x, y, z] = geometry.axes.voxel(geometry.size, at);
    Some(volume.words[x + volume.dims[0] * (y + volume.dims[1] * z)])
}

/// The pixel of a ray through these labels, one after another: the colour of the first that is opaque, or of the largest.
fn pixel(setup: &FrameSetup, mode: Mode, mut labels: impl Iterator<Item = u16>) -> [u32; 4] {
    let shown = match mode {
        Mode::FirstOpaque => labels.find(|&label| label > 0),
        _ => labels.max().filter(|&label| label > 0),
    };
    let Some(label) = shown else { return [0; 4] };
    let words = &setup.words;
    let colour = f64::from(label) / 31.0;
    let component =
        |x: f64| unit_resize(quantise_unit(x, words.colour_bits), words.colour_bits, words.accumulator_bits);
    let full = cube3_word::unit_full(words.accumulator_bits);
    [component(colour), component(1.0 - colour), component(0.5), full]
}

proptest! {
    #![proptest_config(cases(600))]

    /// In parallel views and from every eye, by each word length: samples are there where a voxel is, and are its word.
    #[test]
    fn every_sample_is_its_nearest_voxel((machine, volume, direction, eye) in case(), from_an_eye: bool) {
        let mut scene = scene(direction, Mode::FirstOpaque);
        let machine = if from_an_eye { for_perspective(&machine) } else { machine };
        if from_an_eye {
            scene = from_eye(&scene, eye);
        }
        let (_, words, info) = load(&machine, &volume);
        for setup in picture_setup(&scene, &machine, &info, true).unwrap().setups {
            let geometry = &setup.geometry;
            let defined = Definition::new(&setup, &words);
            let (mut samples, eye_depth) = (0, geometry.perspective.as_ref().map_or(0, |pass| pass.first_depth));
            for ray in defined.rays() {
                for k in 0..geometry.size[2] {
                    let Some(sample) = defined.sample(ray, k as i64) else {
                        // A ray at the edge of a fan may be there for its neighbour's sake alone.
                        prop_assert!(from_an_eye || nearest(&setup, &volume, ray, k).is_none());
                        continue;
                    };
                    samples += 1;
                    prop_assert!(k >= eye_depth);
                    let word = sample >> machine.words.sample_fraction_bits;
                    let label = nearest(&setup, &volume, ray, k).unwrap();
                    let voxel = words[volume.words.iter().position(|&other| other == label).unwrap()];
                    prop_assert_eq!(word, i32::from(voxel));
                }
            }
            prop_assert_eq!(geometry.sample_count(), samples);
        }
    }

    /// The units in the loop: base planes of *cycle* and *function* are what walking from voxel to voxel shows.
    #[test]
    fn the_machine_shows_the_labels_of_a_direct_walk(
        (machine, volume, direction, eye) in case(), from_an_eye: bool, largest: bool,
    ) {
        let mode = if largest { Mode::Maximum } else { Mode::FirstOpaque };
        let mut scene = scene(direction, mode);
        let machine = if from_an_eye { for_perspective(&machine) } else { machine };
        if from_an_eye {
            scene = from_eye(&scene, eye);
        }
        let (_, words, info) = load(&machine, &volume);
        let setups = picture_setup(&scene, &machine, &info, true).unwrap().setups;
        prop_assume!(!setups.is_empty());
        let mut cycle = Machine::cycle(&machine, setups.clone(), volume.dims, &words).unwrap();
        cycle.run(&|_, _| {}).unwrap();
        for (setup, cycle) in setups.iter().zip(cycle.into_base_planes()) {
            let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &words);
            let function = render(setup, &turned, true, &|_, _| {}).base;
            prop_assert_eq!(&cycle, &function);
            let walk = |ray: DiscreteRay| {
                let there = |k: &usize| setup.geometry.has_sample(ray, *k as i64);
                let labels = (0..setup.geometry.size[2]).filter(there).filter_map(|k| nearest(setup, &volume, ray, k));
                pixel(setup, mode, labels)
            };
            let [width, height] = setup.geometry.base_plane_size();
            let pixels = Definition::new(setup, &words).rays().map(walk).collect();
            prop_assert_eq!(function, BasePlane { width, height, bits: machine.words.accumulator_bits, pixels });
        }
    }

    /// The references take the same voxels as the machine, *true* and *sheared* alike.
    #[test]
    fn references_at_the_machines_samples_have_its_labels((machine, volume, direction, _) in case()) {
        let (data, words, info) = load(&machine, &volume);
        let setups = picture_setup(&scene(direction, Mode::Composite), &machine, &info, true).unwrap().setups;
        for interpolation in [SampleCell::Exact, SampleCell::Sheared] {
            let samples = RealSamples::new(&data, &setups[0].geometry, interpolation, 0.0).unwrap();
            for ray in Definition::new(&setups[0], &words).rays() {
                for k in 0..setups[0].geometry.size[2] {
                    let expected = nearest(&setups[0], &volume, ray, k).map(f64::from);
                    prop_assert_eq!(samples.sample(ray, k as i64), expected);
                }
            }
        }
    }
}
