//! `FrameSetup` is all that enters the machine: written to a file and read back, it drives the same frame.

use cube3::function::{CanonicalVolume, render};
use cube3_frame::FrameSetup;
use cube3_host::frame_setup;
use cube3_tests::{machines, scenes, volumes};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn a_setup_read_back_is_the_same_and_gives_the_same_bits(
        (machine, scene, volume) in (machines(), scenes()).prop_flat_map(|(machine, scene)| {
            let bits = machine.words.voxel_bits;
            (Just(machine), Just(scene), volumes(5, bits))
        }),
    ) {
        let setup = frame_setup(&scene, &machine, &volume.info(), true).unwrap().setup;
        let text = serde_json::to_string(&setup).unwrap();
        let read: FrameSetup = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&read, &setup);
        let image = |setup: &FrameSetup| {
            let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
            render(setup, &turned, true, &|_, _| {})
        };
        prop_assert_eq!(image(&read), image(&setup));
    }
}
