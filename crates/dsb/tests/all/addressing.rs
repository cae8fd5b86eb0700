//! The definitions of turning and of reading a ray, each against where a single voxel goes.

use cube3_cases::cases;
use cube3_cfb::golden::output_lane;
use cube3_dsb::Rotator;
use cube3_dsb::golden::{beam_lane, module, rotation, slot, turned};
use cube3_frame::{Axes, Geometry, largest_offset, slope_register};
use cube3_machine::{RaySlots, TemplateRule};
use proptest::prelude::*;

#[test]
fn a_turned_beam_has_each_word_that_many_lanes_further() {
    for lanes in 1_usize..10 {
        let beam: Vec<usize> = (0..lanes).collect();
        for rotation in 0..lanes {
            let turned = turned(&beam, rotation);
            assert_eq!(turned.len(), lanes);
            for &lane in &beam {
                assert_eq!(turned[(lane + rotation) % lanes], lane, "{lanes} lanes, by {rotation}");
            }
        }
    }
}

fn geometry(size: [usize; 3], slopes: [f64; 2], padded: bool, reversed: [bool; 3]) -> Geometry {
    let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
    let rule = TemplateRule::SampleFloor;
    let slopes = slopes.map(slope_register);
    let offset = largest_offset(rule, slopes, 8).min(128);
    Geometry::new(size, Axes { axis: [0, 1, 2], reversed }, slopes, offset, 8, rule, slots)
}

prop_compose! {
    fn any_geometry()(
        size in prop::array::uniform3(1_usize..9), slopes in prop::array::uniform2(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64]),
        padded: bool, reversed: [bool; 3],
    ) -> Geometry {
        geometry(size, slopes, padded, reversed)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1000) })]

    #[test]
    fn the_rotation_takes_every_voxel_from_the_lane_it_is_fetched_to_into_the_module_of_its_slot(geometry in any_geometry()) {
        let lanes = geometry.size[0];
        let [_, planes] = geometry.slot_counts();
        for plane in 0..planes {
            for k in 0..geometry.size[2] {
                // A padded plane has depths without a row of voxels.
                let Some(row) = geometry.row_at(geometry.ray_in_slot(plane, 0, k).v, k) else {
                    continue;
                };
                let turn = rotation(&geometry, plane, k);
                prop_assert!(turn < lanes);
                for x in 0..lanes {
                    let (from, to) = (output_lane(lanes, [x, row, k]), module(lanes, slot(&geometry, x, k), k));
                    prop_assert_eq!((from + turn) % lanes, to, "plane {}, depth {}, voxel {}", plane, k, x);
                }
            }
        }
    }

    #[test]
    fn an_aligned_beam_has_its_voxels_and_nothing_of_lanes_that_hold_none(geometry in any_geometry(), lanes in 1_usize..18) {
        let [slots, _] = geometry.slot_counts();
        let mut aligned = Vec::new();
        for k in 0..geometry.size[2] {
            for v in 0..geometry.size[1] {
                let mut beam = vec![u16::MAX; geometry.size[0].div_ceil(lanes) * lanes];
                let mut expected = vec![0; slots.div_ceil(lanes) * lanes];
                for x in 0..geometry.size[0] {
                    beam[x / lanes * lanes + output_lane(lanes, [x, v, k])] = 1 + x as u16;
                    expected[beam_lane(lanes, slot(&geometry, x, k), k)] = 1 + x as u16;
                }
                Rotator { lanes }.align(&geometry, v, k, &beam, &mut aligned);
                prop_assert_eq!(&aligned, &expected, "row {}, depth {}", v, k);
            }
        }
    }
}
