//! `FrameSetup` is all that enters the machine: written to a file and read back, it is checked whole and drives the same frame.

use cube3_cases::cases;
use cube3_frame::FrameSetup;
use cube3_function::{CanonicalVolume, render};
use cube3_host::{frame_setup, picture_setup};
use cube3_tests::{for_perspective, from_eye, machines, perspectives, scenes, volumes};
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn a_setup_read_back_is_the_same_and_gives_the_same_bits(
        (machine, scene, volume) in (machines(), scenes()).prop_flat_map(|(machine, scene)| {
            let bits = machine.words.voxel_bits;
            (Just(machine), Just(scene), volumes(5, bits))
        }),
    ) {
        let setup = frame_setup(&scene, &machine, &volume.info(), true).unwrap().setup;
        let text = serde_json::to_string(&setup).unwrap();
        let read = FrameSetup::from_json(&text, "setup.json").unwrap();
        prop_assert_eq!(&read, &setup);
        let image = |setup: &FrameSetup| {
            let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
            render(setup, &turned, true, &|_, _| {})
        };
        prop_assert_eq!(image(&read), image(&setup));
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn every_parallel_setup_that_the_host_makes_passes_the_check(
        machine in machines(), scene in scenes(), volume in volumes(9, 1), plan: bool,
    ) {
        let setup = frame_setup(&scene, &machine, &volume.info(), plan).unwrap().setup;
        prop_assert_eq!(setup.check(), Ok(()));
    }

    #[test]
    fn every_setup_for_an_eye_that_the_host_makes_passes_the_check(
        machine in machines(), scene in scenes(), eye in perspectives(), volume in volumes(9, 1), plan: bool,
    ) {
        let frames = picture_setup(&from_eye(&scene, eye), &for_perspective(&machine), &volume.info(), plan).unwrap();
        for setup in frames.setups {
            prop_assert_eq!(setup.check(), Ok(()));
        }
    }
}
