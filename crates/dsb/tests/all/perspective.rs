//! Perspective frames through the bus and the skewed buffers: every slot has the voxels of its column, and where slots need cells of
//! their own, those of the near side of its cell in both rows; what is outside of the volume is 0. And a store that is saved comes back.

use cube3_cases::cases;
use cube3_cfb::golden::output_lane;
use cube3_cfb::{Beam, VoxelBeam};
use cube3_channel::{Archive, ArchiveError};
use cube3_dsb::{PlaneStore, RayVoxels, Rotator, Store};
use cube3_frame::{FrameSetup, Geometry, Schedule};
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::MachineSpec;
use cube3_scene::{Perspective, Scene, View};
use proptest::prelude::*;
use std::sync::Arc;

fn frames(machine: &MachineSpec, dims: [usize; 3], eye: [f64; 3], direction: [f64; 3]) -> Vec<Arc<FrameSetup>> {
    let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(90.0) };
    let view = View { perspective: Some(perspective), ..View::from_direction(direction, None) };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    picture_setup(&Scene { view, ..Scene::default() }, machine, &volume, true).map_or(Vec::new(), |made| made.setups)
}

/// A voxel in the frame's axes; none is 0.
fn voxel([x, y, z]: [usize; 3]) -> u16 {
    (1 + x + 11 * y + 121 * z) as u16
}

/// A row of voxels as the frame buffer sends it.
fn row_in_lanes(geometry: &Geometry, lanes: usize, row: Option<usize>, depth: usize) -> Vec<u16> {
    // Without a row the bus must not look at what lies on its lanes.
    let mut beam = vec![u16::MAX; geometry.size[0].div_ceil(lanes) * lanes];
    if let Some(row) = row {
        for x in 0..geometry.size[0] {
            beam[x / lanes * lanes + output_lane(lanes, [x, row, depth])] = voxel([x, row, depth]);
        }
    }
    beam
}

/// Writes a plane of a frame through the bus into a store.
fn write_plane(geometry: &Geometry, lanes: usize, plane: usize, store: &mut PlaneStore) {
    for depth in 0..geometry.size[2] {
        let row = geometry.row_at(geometry.ray_in_slot(plane, 0, depth).v, depth);
        let mut words = row_in_lanes(geometry, lanes, row, depth);
        let below = geometry.row_below(plane, depth);
        if geometry.doubled() {
            words.extend(row_in_lanes(geometry, lanes, below, depth));
        }
        let mut beam = Beam { plane: plane as u32, depth: depth as u32, ..Beam::<VoxelBeam>::default() };
        Rotator { lanes }.gather(geometry, plane, depth, &words, &mut beam.data.0);
        beam.row = row.or(below.filter(|_| geometry.doubled())).map(|row| row as u32);
        Store::write(store, &beam);
    }
}

/// The voxels of a slot straight from the geometry: of the near side of its cells, `side` counting u and then v.
fn expected(geometry: &Geometry, lanes: usize, plane: usize, slot: usize, side: usize) -> Vec<u16> {
    let mut ray = vec![0; geometry.size[2].div_ceil(lanes) * lanes];
    for (k, word) in ray.iter_mut().enumerate().take(geometry.size[2]) {
        let owner = geometry.ray_in_slot(plane, slot, k);
        if let Some(xyz) = geometry.corner(owner, k, [0, side / 2, side % 2]) {
            *word = voxel(xyz);
        }
    }
    ray
}

fn assert_frame(geometry: &Geometry, lanes: usize) {
    let [slots, planes] = geometry.slot_counts();
    let mut store = PlaneStore::new(Schedule::of(geometry, lanes, None), 2);
    let mut out = RayVoxels::default();
    write_plane(geometry, lanes, 0, &mut store);
    for plane in 0..planes {
        if plane + 1 < planes {
            write_plane(geometry, lanes, plane + 1, &mut store);
        }
        for slot in 0..slots {
            let side = |side| expected(geometry, lanes, plane, slot, side);
            let below = (plane + 1 < planes).then_some(plane as u32 + 1);
            Store::read(&store, [0, plane as u32], below, false, slot, &mut out);
            if geometry.doubled() {
                assert_eq!(out.current, [side(0), side(1)].concat(), "plane {plane}, slot {slot}");
                assert_eq!(out.below, [side(2), side(3)].concat(), "below plane {plane}, slot {slot}");
            } else {
                let below = below
                    .map_or(vec![0; out.current.len()], |below| expected(geometry, lanes, below as usize, slot, 0));
                assert_eq!(out.current, side(0), "plane {plane}, slot {slot}");
                assert_eq!(out.below, below, "below plane {plane}, slot {slot}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(60) })]

    #[test]
    fn every_slot_has_the_voxels_of_its_cells(
        dims in prop::array::uniform3(2_usize..9), eye in prop::array::uniform3(-6.0..14.0_f64),
        direction in prop::array::uniform3(-1.0..1.0_f64), lanes in 1_usize..12,
    ) {
        prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
        let machine = MachineSpec { lanes, ..MachineSpec::default() };
        for setup in frames(&machine, dims, eye, direction) {
            assert_frame(&setup.geometry, lanes);
        }
    }
}

#[test]
fn a_near_eye_and_a_far_one() {
    for (distance, doubled) in [(2.0, true), (16.0, false)] {
        for lanes in [1, 3, 8, 11] {
            let machine = MachineSpec { lanes, ..MachineSpec::default() };
            let setups = frames(&machine, [8; 3], [3.5, 3.5, -distance], [0.0, 0.0, 1.0]);
            assert!(!setups.is_empty());
            for setup in setups {
                assert_eq!(setup.geometry.doubled(), doubled, "{distance}");
                assert_frame(&setup.geometry, lanes);
            }
        }
    }
}

#[test]
fn a_saved_store_comes_back_into_one_of_its_size_and_no_other() {
    let lanes = 5;
    let machine = MachineSpec { lanes, ..MachineSpec::default() };
    let of = |n: usize| frames(&machine, [n; 3], [3.5, 3.5, -2.0], [0.0, 0.0, 1.0]).remove(0).geometry.clone();
    let geometry = of(8);
    let [slots, _] = geometry.slot_counts();
    let mut store = PlaneStore::new(Schedule::of(&geometry, lanes, None), 2);
    write_plane(&geometry, lanes, 2, &mut store);
    write_plane(&geometry, lanes, 3, &mut store);
    let bytes = Archive::save(&mut store).unwrap();
    let mut other = PlaneStore::new(Schedule::of(&geometry, lanes, None), 2);
    Archive::restore(&bytes, &mut other).unwrap();
    for slot in 0..slots {
        let [mut saved, mut restored] = [RayVoxels::default(), RayVoxels::default()];
        Store::read(&store, [0, 2], Some(3), false, slot, &mut saved);
        Store::read(&other, [0, 2], Some(3), false, slot, &mut restored);
        assert!(slot != slots / 2 || saved.current.iter().any(|&word| word != 0));
        assert_eq!(saved, restored);
    }
    let mut smaller = PlaneStore::new(Schedule::of(&of(7), lanes, None), 2);
    assert!(matches!(Archive::restore(&bytes, &mut smaller), Err(ArchiveError::Length { .. })));
}
