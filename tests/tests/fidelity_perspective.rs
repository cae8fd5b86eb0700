//! The three ways to run the machine agree in perspective too, pass by pass: *cycle* = *function* in every bit, *cycle* = *timing* in
//! every counter, and both equal the definition of each unit for every sample.

use cube3::function::{CanonicalVolume, FunctionRun, render};
use cube3::machine::{Machine, Overflows};
use cube3_abc::golden::{Neighbourhood, shade};
use cube3_cone::golden::{Node, leaf, pixel, reduce};
use cube3_frame::{BasePlane, DiscreteRay, FrameSetup};
use cube3_host::{PictureFrames, picture_setup};
use cube3_machine::MachineSpec;
use cube3_scene::{Perspective, Scene};
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes, volumes};
use cube3_trilin::golden::{Weights, cell, lift};
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
    #![proptest_config(ProptestConfig::with_cases(1500))]

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

/// A sample of a pass by the definition of the interpolation.
fn sample(setup: &FrameSetup, volume: &SmallVolume, ray: DiscreteRay, k: i64) -> Option<i32> {
    let geometry = &setup.geometry;
    if !geometry.has_sample(ray, k) {
        return None;
    }
    let k = k as usize;
    let corners = [0, 1].map(|w| {
        [0, 1].map(|v| {
            [0, 1].map(|u| {
                geometry.corner(ray, k, [w, v, u]).map_or(0, |uvw| {
                    let [x, y, z] = geometry.axes.voxel(geometry.size, uvw);
                    lift(volume.words[x + volume.dims[0] * (y + volume.dims[1] * z)], &setup.words)
                })
            })
        })
    });
    let [u, v] = geometry.weights(ray, k);
    Some(cell(corners, Weights { w: geometry.offset, u, v }, &setup.words))
}

/// The pixel of a ray by the definitions alone: samples, shading, and a tree over absolute depth in chunks of the leaves.
fn defined(setup: &FrameSetup, volume: &SmallVolume, ray: DiscreteRay) -> [u32; 4] {
    let (cone, words, depths) = (&setup.cone, &setup.words, setup.geometry.size[2]);
    let border = setup.gradient.map_or(0, |registers| registers.border);
    let node = |k: i64| {
        if sample(setup, volume, ray, k).is_none() {
            return Node::default();
        }
        let apart = setup.reach(k as usize);
        let around: Neighbourhood = [-1, 0, 1].map(|w| {
            [-1, 0, 1].map(|v| {
                [-1, 0, 1].map(|u| {
                    let ray = DiscreteRay { u: ray.u + u * apart, v: ray.v + v * apart };
                    sample(setup, volume, ray, k + w).unwrap_or(border)
                })
            })
        });
        leaf(&shade(&around, [ray.u, ray.v, k], setup).value, cone, words)
    };
    let leaves: Vec<Node> = (0..depths as i64).map(node).collect();
    pixel(reduce(&leaves, cone, words), cone, words).value
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_pixel_is_what_the_definitions_say((machine, scene, volume) in case()) {
        for setup in frames(&scene, &machine, &volume, true).setups {
            let base = function(&setup, &volume, true).base;
            let first = setup.geometry.first_ray();
            for row in 0..base.height {
                for column in 0..base.width {
                    let ray = DiscreteRay { u: first.u + column as i64, v: first.v + row as i64 };
                    prop_assert_eq!(defined(&setup, &volume, ray), base.pixels[row * base.width + column], "{:?}", ray);
                }
            }
        }
    }
}
