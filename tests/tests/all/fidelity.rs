//! The three ways to run the machine agree: *cycle* = *function* in every bit, *cycle* = *timing* in every counter.

use cube3_cases::cases;
use cube3_frame::FrameSetup;
use cube3_function::{CanonicalVolume, FunctionRun, render};
use cube3_host::frame_setup;
use cube3_machine::{Cfb, Layout, MachineSpec, RaySlots, Rays};
use cube3_pipeline::Machine;
use cube3_scene::{Mode, Scene};
use cube3_tests::{SmallVolume, machines, scenes, volumes};
use cube3_word::Words;
use proptest::prelude::*;

fn setup(scene: &Scene, machine: &MachineSpec, volume: &SmallVolume, plan: bool) -> FrameSetup {
    frame_setup(scene, machine, &volume.info(), plan).unwrap().setup
}

fn function(setup: &FrameSetup, volume: &SmallVolume, skip: bool) -> FunctionRun {
    let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
    render(setup, &turned, skip, &|_, _| {})
}

fn case() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes()).prop_flat_map(|(machine, scene)| {
        let bits = machine.words.voxel_bits;
        (Just(machine), Just(scene), volumes(7, bits))
    })
}

proptest! {
    #![proptest_config(cases(1500))]

    #[test]
    fn cycle_equals_function_in_every_bit_and_timing_in_every_counter((machine, scene, volume) in case()) {
        let setup = setup(&scene, &machine, &volume, true);
        let mut cycle = Machine::cycle(&machine, vec![setup.clone()], volume.dims, &volume.words).unwrap();
        cycle.run(&|_, _| {}).unwrap();
        let function = function(&setup, &volume, true);
        let counters = cycle.counters();
        prop_assert_eq!(cycle.overflows(), function.overflows);
        prop_assert_eq!(cycle.into_base_planes().remove(0), function.base);

        let [slots, planes] = setup.geometry.slot_counts();
        prop_assert_eq!(counters.ray_slots, (slots * planes) as u64);
        let mut timing = Machine::timing(&machine, vec![setup]).unwrap();
        timing.run(&|_, _| {}).unwrap();
        prop_assert_eq!(&timing.counters(), &counters);

        for (name, account) in &counters.units {
            prop_assert_eq!(account.cycles(), counters.cycles, "{}", name);
        }
        for channel in &counters.channels {
            prop_assert_eq!(channel.counters.pushes, channel.counters.pops + channel.occupancy as u64);
        }
    }

    #[test]
    fn wrapped_and_padded_give_the_same_bits((machine, scene, volume) in case()) {
        let image = |slots: RaySlots| {
            let machine = MachineSpec { rays: Rays { slots, ..machine.rays }, ..machine.clone() };
            let setup = setup(&scene, &machine, &volume, true);
            let mut run = Machine::cycle(&machine, vec![setup], volume.dims, &volume.words).unwrap();
            run.run(&|_, _| {}).unwrap();
            run.into_base_planes().remove(0)
        };
        prop_assert_eq!(image(RaySlots::Wrapped), image(RaySlots::Padded));
    }

    #[test]
    fn every_layout_gives_the_same_bits((machine, scene, volume) in case()) {
        let skew = if Layout::MiniBlocks.takes(machine.cfb.skew, machine.lanes) { machine.cfb.skew } else { [1; 3] };
        let [rows, blocks, mini_blocks] = Layout::ALL.map(|layout| {
            let machine = MachineSpec { cfb: Cfb { layout, skew, ..machine.cfb }, ..machine.clone() };
            let setup = setup(&scene, &machine, &volume, true);
            let mut run = Machine::cycle(&machine, vec![setup], volume.dims, &volume.words).unwrap();
            run.run(&|_, _| {}).unwrap();
            (run.counters().beams, run.into_base_planes().remove(0))
        });
        prop_assert_eq!(&rows, &blocks);
        prop_assert_eq!(&rows, &mini_blocks);
    }

    #[test]
    fn what_the_plan_leaves_out_changes_no_bit((machine, scene, volume) in case()) {
        let planned = function(&setup(&scene, &machine, &volume, true), &volume, true);
        let everything = function(&setup(&scene, &machine, &volume, false), &volume, false);
        prop_assert_eq!(planned.base, everything.base);
    }
}

/// The opacity that makes a sample opaque is compared in the table's own words, so that the plateau of the transfer function
/// is reached by itself.
#[test]
fn the_opacity_of_the_plateau_is_opaque_in_every_word_length() {
    let volume = SmallVolume { dims: [4; 3], spacing: [1.0; 3], words: vec![u16::MAX; 64] };
    let mut scene = Scene { mode: Mode::FirstOpaque, ..Scene::default() };
    scene.transfer.opaque_alpha = 0.75;
    for opacity_bits in 1..=16 {
        for accumulator_bits in [opacity_bits, 16, 23, 32] {
            let words = Words { opacity_bits, accumulator_bits, ..Words::default() };
            let machine = MachineSpec { words, ..MachineSpec::default() };
            let run = function(&setup(&scene, &machine, &volume, true), &volume, true);
            assert!(run.base.pixels.iter().any(|pixel| pixel[3] > 0), "{opacity_bits}, {accumulator_bits}");
        }
    }
}

/// A ray that is full from end to end is full in the mean, to the rounding of its weight, and nothing overflows.
#[test]
fn a_full_ray_has_a_full_mean() {
    for depth in [1, 2, 3, 6, 300, 3972] {
        let volume = SmallVolume { dims: [1, 1, depth], spacing: [1.0; 3], words: vec![u16::MAX; depth] };
        let mut scene = Scene { mode: Mode::WeightedSum, ..Scene::default() };
        scene.view.direction = Some([0.0, 0.0, 1.0]);
        scene.transfer.opacity = vec![[0.0, 1.0]];
        let machine = MachineSpec { rays: Rays { offset: 0.0, ..Rays::default() }, ..MachineSpec::default() };
        let run = function(&setup(&scene, &machine, &volume, true), &volume, true);
        assert_eq!((run.base.pixels[0], run.overflows.pixel), ([65535; 4], 0), "{depth}");
    }
}
