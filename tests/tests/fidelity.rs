//! The three ways to run the machine agree: *cycle* = *function* in every bit, *cycle* = *timing* in every counter.

use cube3::function::{CanonicalVolume, FunctionRun, render};
use cube3::machine::Machine;
use cube3_host::{FrameSetup, MachineSpec, RaySlots, Rays, frame_setup};
use cube3_scene::Scene;
use cube3_tests::{SmallVolume, machines, scenes, volumes};
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
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn cycle_equals_function_in_every_bit_and_timing_in_every_counter((machine, scene, volume) in case()) {
        let setup = setup(&scene, &machine, &volume, true);
        let mut cycle = Machine::cycle(&machine, setup.clone(), volume.dims, &volume.words).unwrap();
        cycle.run(&|_, _| {}).unwrap();
        let function = function(&setup, &volume, true);
        let counters = cycle.counters();
        prop_assert_eq!(cycle.overflows(), function.overflows);
        prop_assert_eq!(cycle.into_base_plane(), function.base);

        let [slots, planes] = setup.geometry.slot_counts();
        prop_assert_eq!(counters.ray_slots, (slots * planes) as u64);
        let mut timing = Machine::timing(&machine, setup).unwrap();
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
            let mut run = Machine::cycle(&machine, setup, volume.dims, &volume.words).unwrap();
            run.run(&|_, _| {}).unwrap();
            run.into_base_plane()
        };
        prop_assert_eq!(image(RaySlots::Wrapped), image(RaySlots::Padded));
    }

    #[test]
    fn what_the_plan_leaves_out_changes_no_bit((machine, scene, volume) in case()) {
        let planned = function(&setup(&scene, &machine, &volume, true), &volume, true);
        let everything = function(&setup(&scene, &machine, &volume, false), &volume, false);
        prop_assert_eq!(planned.base, everything.base);
    }
}
