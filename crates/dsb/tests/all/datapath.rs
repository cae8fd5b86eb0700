//! Voxels from the frame buffer over the bus through the skewed buffers: every pair of rays has the voxels of its slot in its
//! plane and in the one below, in lane order, and what is outside of the volume is 0.

use cube3_cases::cases;
use cube3_cfb::golden::Skew;
use cube3_cfb::{Beam, CfbSpec, CfbUnit, FrameBuffer, VoxelBeam};
use cube3_channel::Channel;
use cube3_dsb::bus::BusUnit;
use cube3_dsb::{DsbSpec, DsbUnit, PlaneStore, RayPair, RayVoxels, Rotator};
use cube3_frame::{FrameSetup, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Cfb, Dsb, MachineSpec, RaySlots, Rays, TemplateRule};
use cube3_scene::{Scene, View};
use proptest::prelude::*;
use std::sync::Arc;

/// The voxels of a slot straight from the geometry; the plane after the last is the first where slots are shared.
fn expected(setup: &FrameSetup, lanes: usize, plane: usize, slot: usize, voxels: &[u16], dims: [usize; 3]) -> Vec<u16> {
    let geometry = &setup.geometry;
    let [_, planes] = geometry.slot_counts();
    let plane = if plane == planes && geometry.closes()[1] { 0 } else { plane };
    let mut ray = vec![0; geometry.size[2].div_ceil(lanes) * lanes];
    for k in (0..geometry.size[2]).filter(|_| plane < planes) {
        let owner = geometry.ray_in_slot(plane, slot, k);
        if let (Some(x), Some(y)) = (geometry.column_at(owner.u, k), geometry.row_at(owner.v, k)) {
            let [x, y, z] = geometry.axes.voxel(geometry.size, [x, y, k]);
            ray[k] = voxels[x + dims[0] * (y + dims[1] * z)];
        }
    }
    ray
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1000) })]

    #[test]
    fn every_pair_of_rays_has_its_voxels(
        dims in prop::array::uniform3(1_usize..8), direction in prop::array::uniform3(prop_oneof![Just(1.0), Just(0.0), -1.0..1.0_f64]),
        skew in prop::array::uniform3(-3_i64..4), padded: bool, plane_floor: bool, lanes in 1_usize..12, planes in 2_usize..5,
        slow in 1_u64..4,
    ) {
        prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
        let rays = Rays {
            slots: if padded { RaySlots::Padded } else { RaySlots::Wrapped },
            template: if plane_floor { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
            offset: 0.5, ..Rays::default() };
        let machine = MachineSpec { lanes, rays, cfb: Cfb { skew, ..Cfb::default() }, dsb: Dsb { planes, ..Dsb::default() }, ..MachineSpec::default() };
        let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
        let setup = Arc::new(frame_setup(&scene, &machine, &volume, true).unwrap().setup);
        let geometry = &setup.geometry;
        let voxels: Vec<u16> = (1..=dims.iter().product::<usize>() as u16).collect();
        let memory = FrameBuffer::new(Skew { coefficients: skew, lanes }, dims, &voxels).unwrap();

        let schedule = Schedule::new(&machine, geometry);
        let mut cfb = CfbUnit::new(vec![CfbSpec::new(&machine, geometry, schedule)], memory);
        let mut bus = BusUnit::new(&machine, [schedule], Rotator { lanes });
        let mut dsb = DsbUnit::new([(DsbSpec::new(&machine, schedule), PlaneStore::new(schedule, planes))]);
        let mut beams = Channel::<Beam<VoxelBeam>>::new("beams", 3, 2).unwrap();
        let mut aligned = Channel::<Beam<VoxelBeam>>::new("aligned", 2, 1).unwrap();
        let mut out = Channel::<RayPair<RayVoxels>>::new("rays", 2, 1).unwrap();
        let [slots, frame_planes] = geometry.slot_counts();
        let (mut taken, mut cycle) = (0, 0_u64);
        while taken < slots * frame_planes {
            dsb.tick(&mut aligned, &mut out);
            bus.tick(std::slice::from_ref(&setup), &mut beams, &mut aligned, None);
            cfb.tick(std::slice::from_ref(&setup), 1, &mut beams);
            if cycle.is_multiple_of(slow) && let Some(pair) = out.pop_slot() {
                let (plane, slot) = (taken / slots, taken % slots);
                prop_assert_eq!((pair.plane as usize, pair.slot as usize), (plane, slot));
                prop_assert_eq!(&pair.data.current, &expected(&setup, lanes, plane, slot, &voxels, dims));
                prop_assert_eq!(&pair.data.below, &expected(&setup, lanes, plane + 1, slot, &voxels, dims));
                taken += 1;
            }
            beams.commit();
            aligned.commit();
            out.commit();
            cycle += 1;
            prop_assert!(cycle < 100_000, "stuck");
        }
        prop_assert!(dsb.done() && cfb.done());
        prop_assert_eq!(cfb.fetched(), (geometry.size[1] * geometry.size[2]) as u64);
        for account in [cfb.account(), bus.account()].into_iter().chain(dsb.accounts()) {
            prop_assert_eq!(account.cycles(), cycle);
        }
    }
}
