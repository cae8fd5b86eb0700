//! The plan: whatever it leaves out changes no bit, and saves what its items say.

use cube3_cases::cases;
use cube3_frame::FrameSetup;
use cube3_function::{CanonicalVolume, FunctionRun, render};
use cube3_host::{PictureFrames, VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{MachineSpec, OperatorCounts, RaySlots, Rays, ShadingUnit};
use cube3_pipeline::Machine;
use cube3_plan::{Item, Plan, RULES, Rule, Rules, Savings};
use cube3_resources::{memory, operators};
use cube3_scene::{Cut, Material, Mode, Scene, View};
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes, volumes};
use proptest::prelude::*;
use std::sync::Arc;

fn function(setup: &FrameSetup, volume: &SmallVolume) -> FunctionRun {
    let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
    render(setup, &turned, true, &|_, _| {})
}

fn case() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes()).prop_flat_map(|(machine, scene)| {
        let bits = machine.words.voxel_bits;
        (Just(machine), Just(scene), volumes(7, bits))
    })
}

fn item(frames: &PictureFrames, rule: Rule) -> Option<&Item> {
    frames.left_out.iter().find(|item| item.rule == rule)
}

/// Bits of memory of a machine that renders these frames.
fn memory_bits(machine: &MachineSpec, dims: [usize; 3], frames: &[Arc<FrameSetup>]) -> u64 {
    memory(machine, dims, frames).iter().map(|memory| memory.bits).sum()
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn each_rule_alone_changes_no_bit((machine, scene, volume) in case(), eye in perspectives(), near in any::<bool>()) {
        let (machine, scene) = if near { (for_perspective(&machine), from_eye(&scene, eye)) } else { (machine, scene) };
        let frames = |rules| picture_setup(&scene, &machine, &volume.info(), rules).unwrap();
        let planned = frames(Rules::ALL);
        let runs: Vec<FunctionRun> = planned.setups.iter().map(|setup| function(setup, &volume)).collect();
        prop_assert!(frames(Rules::NONE).left_out.is_empty());
        for row in RULES {
            let kept = frames(Rules::ALL.without(row.rule));
            prop_assert_eq!(item(&kept, row.rule), None, "{}", row.name);
            for (setup, run) in kept.setups.iter().zip(&runs) {
                setup.check().unwrap();
                prop_assert_eq!(&function(setup, &volume).base, &run.base, "{}", row.name);
            }
            let differs = kept.setups != planned.setups;
            prop_assert_eq!(differs, row.can_idle && item(&planned, row.rule).is_some(), "{}", row.name);
        }
    }

    /// A part that is kept though the scene does not need it takes the memory that its item names.
    #[test]
    fn the_bytes_of_an_item_are_what_the_part_takes((machine, scene, volume) in case()) {
        let frames = |rules| picture_setup(&scene, &machine, &volume.info(), rules).unwrap();
        let planned = frames(Rules::ALL);
        let before = memory_bits(&machine, volume.dims, &planned.setups);
        let mut rules = Rules::ALL;
        let mut saved = 0;
        // Each part reads the one before it.
        for rule in [Rule::GradientUnit, Rule::Normaliser, Rule::ShadingUnit] {
            // An idle shading unit is one without a table of light.
            if rule == Rule::ShadingUnit && machine.abc.shading == ShadingUnit::ReflectanceTable {
                continue;
            }
            rules = rules.without(rule);
            saved += item(&planned, rule).map_or(0, |item| item.savings.bytes);
            let bits = memory_bits(&machine, volume.dims, &frames(rules).setups) - before;
            prop_assert!(bits.div_ceil(8) <= saved && saved <= bits.div_ceil(8) + 2, "{:?}: {} of {}", rule, saved, bits);
        }
    }
}

/// Operators of a lane, by the part's name in the report.
fn of_lane(machine: &MachineSpec, parts: &[&str]) -> OperatorCounts {
    let of_machine = operators(machine, &[] as &[FrameSetup]);
    parts.iter().filter_map(|name| of_machine.iter().find(|part| part.part == *name)).map(|part| part.each).sum()
}

#[test]
fn the_operators_of_an_item_are_those_of_the_machines_parts() {
    let volume = VolumeInfo { dims: [8; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let scene = Scene { mode: Mode::Maximum, ..Scene::default() };
    let lights = scene.lights.len() as u64;
    for shading in [ShadingUnit::Phong, ShadingUnit::ReflectanceTable] {
        for (gradient, _) in cube3_machine::GradientMethod::ALL {
            let mut machine = MachineSpec::default();
            (machine.abc.shading, machine.abc.gradient) = (shading, gradient);
            let frames = picture_setup(&scene, &machine, &volume, true).unwrap();
            let light = match shading {
                ShadingUnit::Phong => of_lane(&machine, &["abc: a light"]).times(lights),
                ShadingUnit::ReflectanceTable => of_lane(&machine, &["abc: direction"]),
            };
            let expected = [
                (
                    Rule::GradientUnit,
                    of_lane(&machine, &["abc: gradient", "abc: gradient scale", "abc: gradient word"]),
                ),
                (Rule::Normaliser, of_lane(&machine, &["abc: normaliser"])),
                (Rule::ShadingUnit, light + of_lane(&machine, &["abc: lit colour"])),
                (Rule::DepthCue, of_lane(&machine, &["abc: depth cue"])),
                (Rule::HalfSpaces, of_lane(&machine, &["abc: cut planes and crop box"])),
            ];
            for (rule, operators) in expected {
                let saved = item(&frames, rule).unwrap().savings;
                assert_eq!(saved.operators, operators, "{rule:?} {gradient:?}");
                let all = operators.multipliers + operators.adders + operators.comparators + operators.dividers;
                assert_eq!(saved.operations, 8 * 8 * 8 * all, "{rule:?} {gradient:?}");
            }
        }
    }
}

/// Cycles of a frame of an ideal machine with as many lanes as voxels along a side.
fn cycles(scene: &Scene, machine: &MachineSpec, n: usize, rules: Rules) -> u64 {
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(scene, machine, &volume, rules).unwrap().setup;
    let mut run = Machine::timing(machine, vec![setup]).unwrap();
    run.run(&|_, _| {}).unwrap();
    run.counters().cycles
}

#[test]
fn the_cycles_of_an_item_are_those_that_a_frame_is_shorter() {
    let material = Material { shaded: false, ..Material::default() };
    let mut seen = std::collections::BTreeSet::new();
    for slots in [RaySlots::Wrapped, RaySlots::Padded] {
        for direction in [[0.0, 0.0, 1.0], [0.4, 0.0, 1.0], [0.0, 0.3, 1.0], [0.5, 0.25, 1.0]] {
            for n in [2, 9, 16] {
                let machine =
                    MachineSpec { lanes: n, rays: Rays { slots, ..Rays::default() }, ..MachineSpec::default() };
                let view = View::from_direction(direction, None);
                let scene = Scene { view, material: material.clone(), ..Scene::default() };
                let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
                let frames = picture_setup(&scene, &machine, &volume, true).unwrap();
                let saved: u64 = frames.left_out.iter().map(|item| item.savings.cycles).sum();
                let [without, with] = [Rules::ALL.without(Rule::GradientUnit), Rules::ALL]
                    .map(|rules| cycles(&scene, &machine, n, rules));
                assert_eq!(without - with, saved, "{slots:?} {direction:?} {n}");
                seen.insert(saved);
            }
        }
    }
    assert!(seen.len() > 5, "{seen:?}");
}

/// Faces without a ray, and what all frames of a picture have in common.
#[test]
fn an_eye_has_no_frames_for_faces_that_no_ray_needs() {
    let machine = MachineSpec::default();
    let volume = VolumeInfo { dims: [16; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let mut scene = Scene::default();
    scene.view.perspective =
        Some(cube3_scene::Perspective { eye_voxel: Some([7.0, 7.5, 8.0]), ..cube3_scene::Perspective::new(100.0) });
    let frames = picture_setup(&scene, &machine, &volume, true).unwrap();
    assert!(frames.setups.len() > 1);
    let passes = item(&frames, Rule::OtherFaces).unwrap().savings.passes;
    assert_eq!(passes, 6 - frames.setups.len() as u64);
    let cue = item(&frames, Rule::DepthCue).unwrap().savings;
    let samples = |setup: &Arc<FrameSetup>| setup.geometry.slot_counts().iter().product::<usize>() * 16;
    let all: usize = frames.setups.iter().map(samples).sum();
    assert_eq!(cue.operations, cue.operators.all() * all as u64);
}

/// What one frame has is in the machine; what all of them lack saves its cycles and operations in each.
#[test]
fn items_of_several_frames_are_what_all_of_them_lack() {
    let machine = MachineSpec::default();
    let volume = VolumeInfo { dims: [8; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let plain = Scene { mode: Mode::Maximum, ..Scene::default() };
    let cut = Cut { normal: [0.0, 0.0, 1.0], through_voxel: [4.0; 3] };
    let cropped = Scene { cuts: vec![cut], ..plain.clone() };
    let setup = |scene: &Scene| frame_setup(scene, &machine, &volume, true).unwrap().setup;
    let plan = Plan::new(&plain, &machine, Rules::ALL);
    let items = |frames: &[FrameSetup]| plan.items(&machine, 1, frames);
    let rules = |items: &[Item]| items.iter().map(|item| item.rule).collect::<Vec<Rule>>();
    let one = items(&[setup(&plain)]);
    let without = |rule: Rule| rules(&one).into_iter().filter(|other| *other != rule).collect::<Vec<Rule>>();
    assert!(rules(&one).contains(&Rule::HalfSpaces));
    for frames in [[setup(&plain), setup(&cropped)], [setup(&cropped), setup(&plain)]] {
        let both = items(&frames);
        assert_eq!(rules(&both), without(Rule::HalfSpaces));
        for item in &both {
            let alone = one.iter().find(|other| other.rule == item.rule).unwrap().savings;
            let expected = (2 * alone.cycles, alone.bytes, 2 * alone.operations, alone.operators);
            let Savings { cycles, bytes, operations, operators, .. } = item.savings;
            assert_eq!((cycles, bytes, operations, operators), expected, "{:?}", item.rule);
        }
    }
}
