//! What the machine makes of a frame is the frame by definition: in every pixel, whatever the machine, the scene and the volume.

use cube3_cases::cases;
use cube3_definition::Definition;
use cube3_frame::Overflows;
use cube3_frame::{BasePlane, FrameSetup};
use cube3_function::{CanonicalVolume, render};
use cube3_host::picture_setup;
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::Scene;
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes, volumes};
use proptest::prelude::*;
use std::sync::Arc;

fn parallel() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes()).prop_flat_map(|(machine, scene)| {
        let bits = machine.words.voxel_bits;
        (Just(machine), Just(scene), volumes(7, bits))
    })
}

fn eyes() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes(), perspectives()).prop_flat_map(|(machine, scene, perspective)| {
        let bits = machine.words.voxel_bits;
        (Just(for_perspective(&machine)), Just(from_eye(&scene, perspective)), volumes(7, bits))
    })
}

/// Words of a frame that overflow by definition.
fn overflows(defined: &Definition<'_>) -> Overflows {
    let depths = defined.setup().geometry.size[2] as i64;
    defined.rays().fold(Overflows::default(), |sum, ray| {
        let shading = (0..depths).map(|k| u64::from(defined.shade(ray, k).overflows)).sum();
        sum.plus(Overflows { shading, pixel: defined.pixel(ray).overflows.into() })
    })
}

/// The frames of a picture in *cycle* and in *function*, with the plan's savings and without.
fn assert_defined((machine, scene, volume): &(MachineSpec, Scene, SmallVolume), plan: bool) {
    let setups = picture_setup(scene, machine, &volume.info(), plan).unwrap().setups;
    if setups.is_empty() {
        return;
    }
    let defined: Vec<Definition<'_>> = setups.iter().map(|setup| Definition::new(setup, &volume.words)).collect();
    let planes: Vec<BasePlane> = defined.iter().map(Definition::base_plane).collect();
    let function = |setup: &Arc<FrameSetup>| {
        let turned = CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words);
        render(setup, &turned, plan, &|_, _| {}).base
    };
    assert_eq!(setups.iter().map(function).collect::<Vec<_>>(), planes, "function");
    let mut cycle = Machine::cycle(machine, setups.clone(), volume.dims, &volume.words).unwrap();
    cycle.run(&|_, _| {}).unwrap();
    assert_eq!(cycle.overflows(), defined.iter().map(overflows).fold(Overflows::default(), Overflows::plus));
    assert_eq!(cycle.into_base_planes(), planes, "cycle");
}

proptest! {
    #![proptest_config(cases(1500))]

    #[test]
    fn every_pixel_of_a_parallel_frame_is_what_the_definitions_say(case in parallel(), plan: bool) {
        assert_defined(&case, plan);
    }

    #[test]
    fn every_pixel_from_an_eye_is_what_the_definitions_say(case in eyes(), plan: bool) {
        assert_defined(&case, plan);
    }
}
