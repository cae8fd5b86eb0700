//! Frames one behind another: the bits of each are those of the frame alone, and the rate is that of the busiest port.

use cube3_cases::cases;
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Cfb, Frames, MachineSpec, RaySlots, Rays};
use cube3_pipeline::Machine;
use cube3_scene::{Scene, View};
use cube3_tests::{machines, scenes, volumes};
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn every_frame_of_a_sequence_has_the_bits_that_it_has_alone(
        machine in machines(), scenes in proptest::collection::vec(scenes(), 1..4), volume in volumes(6, 8), overlap: bool,
    ) {
        let machine = MachineSpec { frames: Frames { overlap }, ..machine };
        let info = VolumeInfo { window: [0.0, 255.0], ..volume.info() };
        let setups: Vec<FrameSetup> =
            scenes.iter().map(|scene| frame_setup(scene, &machine, &info, true).unwrap().setup).collect();
        let words: Vec<u16> = volume.words.iter().map(|word| word >> (8 - machine.words.voxel_bits.min(8))).collect();
        let alone: Vec<_> = setups.iter().map(|setup| {
            let mut run = Machine::cycle(&machine, vec![setup.clone()], volume.dims, &words).unwrap();
            run.run(&|_, _| {}).unwrap();
            (run.counters().cycles, run.overflows(), run.into_base_planes().remove(0))
        }).collect();
        let mut together = Machine::cycle(&machine, setups.clone(), volume.dims, &words).unwrap();
        together.run(&|_, _| {}).unwrap();
        let counters = together.counters();
        let mut timing = Machine::timing(&machine, setups).unwrap();
        timing.run(&|_, _| {}).unwrap();
        prop_assert_eq!(&timing.counters(), &counters);
        let one_by_one: u64 = alone.iter().map(|(cycles, _, _)| cycles).sum();
        // A frame alone finds every row of the memory closed, and another time to the next refresh.
        if machine.cfb == (Cfb { skew: machine.cfb.skew, ..Cfb::default() }) {
            if overlap {
                prop_assert!(counters.cycles <= one_by_one);
            } else {
                prop_assert_eq!(counters.cycles, one_by_one);
            }
        }
        prop_assert_eq!(counters.frame_ends.len(), alone.len());
        prop_assert_eq!(counters.frame_ends.last(), Some(&counters.cycles));
        for (name, account) in &counters.units {
            prop_assert_eq!(account.cycles(), counters.cycles, "{}", name);
        }
        let overflows = together.overflows();
        prop_assert_eq!(overflows.shading, alone.iter().map(|(_, o, _)| o.shading).sum::<u64>());
        for (base, (_, _, expected)) in together.into_base_planes().into_iter().zip(alone) {
            prop_assert_eq!(base, expected);
        }
    }

    #[test]
    fn overlapped_frames_of_a_machine_that_never_stalls_follow_at_the_rate_of_their_beams(
        n in 4_usize..24, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, padded: bool,
    ) {
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let machine = MachineSpec { lanes: n, rays: Rays { slots, ..Rays::default() }, ..MachineSpec::default() };
        let scene = Scene { view: View::from_direction([du, dv, 1.0], None), ..Scene::default() };
        let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let mut run = Machine::timing(&machine, vec![setup; 4]).unwrap();
        run.run(&|_, _| {}).unwrap();
        let counters = run.counters();
        let intervals: Vec<u64> = counters.frame_ends.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let steady = counters.steady_cycles / 4;
        prop_assert!(intervals.iter().all(|&interval| interval == steady), "{:?} for {}", intervals, steady);
    }
}
