//! The machine from an eye against its twin in reals: what is left between them are words, and each part of a ray shows.

use cube3_inputs::{LoadedVolume, load_volume};
use cube3_machine::{MachineSpec, RayEnds, TemplateRule};
use cube3_method::{Choice, Subject};
use cube3_metrics::compare;
use cube3_picture::Picture;
use cube3_scene::{DepthCue, Image, Mode, Perspective, Scene, View, VolumeSource};
use cube3_volume::ReadOptions;
use cube3_word::Words;

/// A machine with more bits everywhere for each level, 0 to 2: the last has the widest words.
fn machine(level: u32) -> MachineSpec {
    let of = |bits: [u32; 3]| bits[level as usize];
    let mut machine = MachineSpec::default();
    machine.words = Words {
        voxel_bits: 16,
        weight_bits: of([6, 9, 12]),
        sample_fraction_bits: of([2, 5, 8]),
        gradient_bits: of([18, 21, 24]),
        normal_bits: of([9, 12, 15]),
        table_bits: of([10, 12, 14]),
        colour_bits: of([8, 12, 16]),
        opacity_bits: of([8, 12, 16]),
        accumulator_bits: of([12, 20, 32]),
        ..machine.words
    };
    (machine.abc.power_bits, machine.abc.root_bits) = (of([6, 10, 14]), of([6, 8, 10]));
    (machine.rays.template, machine.rays.ends) = (TemplateRule::PlaneFloor, RayEnds::Exact);
    machine
}

/// A head from an eye before it, which needs one pass; near it, which needs three; and in it.
fn scenes() -> [Scene; 3] {
    let of = |eye: [f64; 3], yaw_deg: f64, field: f64| Scene {
        volume: VolumeSource::from_phantom("head", 48),
        image: Image { width_px: 96, height_px: 80, pixel_size_voxel: None },
        view: View {
            perspective: Some(Perspective { eye_voxel: Some(eye), ..Perspective::new(field) }),
            ..View::from_angles(yaw_deg, 10.0)
        },
        depth_cue: Some(DepthCue { front: 1.0, back: 0.5 }),
        ..Scene::default()
    };
    [of([24.0, -70.0, 30.0], 0.0, 40.0), of([48.0, -25.0, 40.0], 30.0, 70.0), of([23.3, 24.1, 25.7], 30.0, 90.0)]
}

fn picture(method: &str, scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume) -> Picture {
    let choice: Choice = method.parse().unwrap();
    choice.render(&Subject::new(scene, machine, volume), &|_, _, _| {}).unwrap().picture
}

/// Mean distance of the machine to a method.
fn off(method: &str, scene: &Scene, machine: &MachineSpec) -> f64 {
    let volume = load_volume(scene, machine, &ReadOptions::default(), false).unwrap();
    let [words, reals] = ["function", method].map(|name| picture(name, scene, machine, &volume));
    assert!(reals.pixels.iter().any(|pixel| pixel[0] > 0.02), "{method} shows something");
    compare(&words, &reals, None).unwrap().whole.mean_relative
}

/// Without the correction of opacity, of which the machine has sixteen lengths, only words are between the two.
#[test]
fn the_machine_comes_to_its_twin_as_words_grow() {
    for (eye, scene) in scenes().iter().enumerate() {
        for mode in Mode::ALL {
            let mut scene = Scene { mode, ..scene.clone() };
            scene.transfer.opacity_correction = false;
            if mode == Mode::Minimum {
                // Around the head there is nothing, and it shall show.
                scene.transfer.opacity = vec![[0.0, 0.4], [255.0, 0.9]];
            }
            let errors = [0, 1, 2].map(|level| {
                let mut machine = machine(level);
                machine.rays.ends = RayEnds::Published;
                off("sheared:published", &scene, &machine)
            });
            println!("eye {eye}, {mode}: {errors:?}");
            assert!(errors[0] > 3.0 * errors[1] && errors[1] > 1.5 * errors[2], "eye {eye}, {mode}: {errors:?}");
            assert!(errors[2] < 1.2e-4, "eye {eye}, {mode}: {errors:?}");
        }
    }
}

/// With its ends and its step lengths the machine is farther off: a class of lengths is 3.3 % wide at most, and an end reaches two steps.
#[test]
fn ends_and_step_lengths_are_the_machines_to_what_its_registers_round_by() {
    for (scene, most) in scenes().iter().zip([5e-5, 1.5e-4, 2e-3]) {
        for mode in [Mode::Composite, Mode::WeightedSum] {
            let error = off("sheared", &Scene { mode, ..scene.clone() }, &machine(2));
            println!("{mode}: {error:.2e}");
            assert!(error < most, "{mode}: {error}");
        }
    }
}

/// What cells cost shows beside what words do.
#[test]
fn true_is_farther_from_the_machine_than_sheared_is() {
    for scene in scenes() {
        let [sheared, exact] = ["sheared", "true"].map(|method| off(method, &scene, &machine(2)));
        println!("sheared {sheared:.2e}, true {exact:.2e}");
        assert!(exact > 10.0 * sheared, "{sheared} {exact}");
    }
}
