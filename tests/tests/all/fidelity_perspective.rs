//! The three ways to run the machine agree in perspective too, pass by pass: *cycle* = *function* in every bit, *cycle* = *timing* in
//! every counter.

use cube3_cases::cases;
use cube3_frame::Overflows;
use cube3_frame::{BasePlane, FrameSetup};
use cube3_function::{CanonicalVolume, FunctionRun, render};
use cube3_host::{PictureFrames, picture_setup};
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::{Perspective, Scene};
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes, volumes};
use proptest::prelude::*;

fn frames(scene: &Scene, machine: &MachineSpec, volume: &SmallVolume, plan: bool) -> PictureFrames {
    picture_setup(scene, machine, &volume.info(), plan).unwrap()
}

fn function(setup: &FrameSetup, volume: &SmallVolume, skip: bool) -> FunctionRun {
    let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
    render(setup, &turned, skip, &|_, _| {})
}

fn case() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes(), perspectives()).prop_flat_map(|(machine, scene, perspective): (_, _, Perspective)| {
        let bits = machine.words.voxel_bits;
        (Just(for_perspective(&machine)), Just(from_eye(&scene, perspective)), volumes(7, bits))
    })
}

proptest! {
    #![proptest_config(cases(1500))]

    #[test]
    fn cycle_equals_function_in_every_bit_and_timing_in_every_counter((machine, scene, volume) in case()) {
        let setups = frames(&scene, &machine, &volume, true).setups;
        prop_assume!(!setups.is_empty());
        let mut cycle = Machine::cycle(&machine, setups.clone(), volume.dims, &volume.words).unwrap();
        cycle.run(&|_, _| {}).unwrap();
        let functions: Vec<FunctionRun> = setups.iter().map(|setup| function(setup, &volume, true)).collect();
        let counters = cycle.counters();
        let overflows = functions.iter().fold(Overflows::default(), |sum, run| sum.plus(run.overflows));
        prop_assert_eq!(cycle.overflows(), overflows);
        let bases: Vec<BasePlane> = functions.into_iter().map(|run| run.base).collect();
        prop_assert_eq!(cycle.into_base_planes(), bases);

        let mut timing = Machine::timing(&machine, setups).unwrap();
        timing.run(&|_, _| {}).unwrap();
        prop_assert_eq!(&timing.counters(), &counters);
        for (name, account) in &counters.units {
            prop_assert_eq!(account.cycles(), counters.cycles, "{}", name);
        }
    }

    #[test]
    fn what_the_plan_leaves_out_changes_no_bit((machine, scene, volume) in case()) {
        let planned = frames(&scene, &machine, &volume, true).setups;
        let everything = frames(&scene, &machine, &volume, false).setups;
        prop_assert_eq!(planned.len(), everything.len());
        for (planned, everything) in planned.iter().zip(&everything) {
            prop_assert_eq!(function(planned, &volume, true).base, function(everything, &volume, false).base);
        }
    }
}
