//! The cone's data sheet: a ray takes ⌈n_w / lanes⌉ cycles, and its pixels leave in the last of them.

use cube3_abc::ShadedRay;
use cube3_channel::{Account, Channel};
use cube3_cone::{ConeSpec, ConeUnit, NoPixels, PixelGroup};
use cube3_frame::{FrameSetup, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::MachineSpec;
use cube3_scene::{Scene, View};

fn setup(machine: &MachineSpec, depths: usize) -> FrameSetup {
    let scene = Scene { view: View::from_direction([0.0, 0.0, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims: [1, 1, depths], spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

/// Six rays, one offered every `every` cycles: when pixels left, and the account after `cycles`.
fn run(lanes: usize, depths: usize, every: u64, drained: impl Fn(u64) -> bool, cycles: u64) -> (Vec<u64>, Account) {
    let machine = MachineSpec { lanes, ..MachineSpec::default() };
    let setup = setup(&machine, depths);
    let mut cone = ConeUnit::new(vec![ConeSpec::new(&machine, &Schedule::new(&machine, &setup.geometry))], NoPixels);
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 2, 1).unwrap();
    let mut pixels = Channel::<PixelGroup<()>>::new("pixels", 1, 1).unwrap();
    let (mut offered, mut left) = (0, Vec::new());
    for cycle in 0..cycles {
        if offered < 6
            && cycle >= u64::from(offered) * every
            && let Some(ray) = shaded.push_slot()
        {
            (ray.plane, ray.slot) = (offered / 2, offered % 2);
            offered += 1;
        }
        let before = pixels.counters().pushes;
        cone.tick(std::slice::from_ref(&setup), &mut shaded, &mut pixels);
        if pixels.counters().pushes > before {
            left.push(cycle);
        }
        if drained(cycle)
            && let Some(group) = pixels.pop()
        {
            let place = pixels.counters().pops as u32 - 1;
            assert_eq!((group.plane, group.slot), (place / 2, place % 2));
        }
        shaded.commit();
        pixels.commit();
    }
    assert_eq!(cone.account().cycles(), cycles);
    (left, *cone.account())
}

#[test]
fn pixels_leave_after_the_chunks_of_their_ray_and_not_a_cycle_earlier() {
    for (lanes, depths, cycles) in [(8, 17, 3), (8, 16, 2), (1, 3, 3), (5, 11, 3), (2, 9, 5)] {
        // Ray m is at the leaves from cycle 1 on.
        let (left, account) = run(lanes, depths, 1, |_| true, 60);
        let expected: Vec<u64> = (1..=6).map(|ray| ray * cycles).collect();
        assert_eq!(left, expected, "{depths} samples on {lanes} leaves");
        assert_eq!(account, Account { busy: 6 * cycles, starved: 60 - 6 * cycles, ..Account::default() });
    }
}

#[test]
fn with_a_leaf_for_each_sample_the_cone_takes_a_ray_in_every_other_cycle_of_a_channel_of_one() {
    // The pixels' channel holds one and gives its credit back with the commit.
    let (left, account) = run(8, 8, 1, |_| true, 40);
    assert_eq!(left, [1, 3, 5, 7, 9, 11]);
    assert_eq!(account, Account { busy: 6, blocked: 5, starved: 29, ..Account::default() });
}

#[test]
fn without_rays_the_cone_starves() {
    let (left, account) = run(8, 8, 5, |_| true, 40);
    assert_eq!(left, [1, 6, 11, 16, 21, 26]);
    assert_eq!(account, Account { busy: 6, starved: 34, ..Account::default() });
}

#[test]
fn without_room_the_cone_is_blocked() {
    let (left, account) = run(4, 8, 1, |cycle| cycle == 20, 30);
    // The second ray does its first cycle, and waits for room in its second from 4 to 20.
    assert_eq!(left, [2, 21]);
    assert_eq!(account, Account { starved: 1, busy: 2 + 2 + 1, blocked: 30 - 6, ..Account::default() });
}
