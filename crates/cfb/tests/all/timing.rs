//! The frame buffer's data sheet.
//!
//! A beam takes ⌈n_u / lanes⌉ cycles, and a cycle more for every voxel that finds its module taken; a beam of a padded
//! plane outside of the volume takes one. Nothing comes in, so the unit starves only when the frame is done. Where the slots of a
//! perspective frame need their own cells, a beam is two rows, one after the other.

use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::{Account, Channel, Reason};
use cube3_frame::{FrameSetup, Schedule};
use cube3_host::{VolumeInfo, frame_setup, picture_setup};
use cube3_machine::{Cfb, MachineSpec, RaySlots, Rays};
use cube3_scene::{Perspective, Scene, View};
use std::sync::Arc;

fn machine(lanes: usize, skew: [i64; 3], slots: RaySlots) -> MachineSpec {
    let rays = Rays { slots, ..Rays::default() };
    MachineSpec { lanes, cfb: Cfb { skew, ..Cfb::default() }, rays, ..MachineSpec::default() }
}

/// Rays mainly along z, and a little along x where not at all, so that u is x.
fn setup(machine: &MachineSpec, dims: [usize; 3], slopes: [f64; 2]) -> FrameSetup {
    let scene = Scene { view: View::from_direction([slopes[0].max(1e-6), slopes[1], 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&scene, machine, &volume, true).unwrap().setup;
    assert_eq!(setup.geometry.size, dims);
    setup
}

/// A frame: the cycles in which beams were sent, and whether each had a row.
struct Run {
    sent: Vec<(u64, bool)>,
    account: Account,
    cycles: u64,
    fetched: u64,
}

fn run(machine: &MachineSpec, setup: &FrameSetup, capacity: usize, drained: impl Fn(u64) -> bool) -> Run {
    let mut unit =
        CfbUnit::new(vec![CfbSpec::new(machine, &setup.geometry, Schedule::new(machine, &setup.geometry))], NoVoxels);
    let setups = [Arc::new(setup.clone())];
    let mut beams = Channel::<Beam<()>>::new("beams", capacity, 1).unwrap();
    let (mut sent, mut cycle) = (Vec::new(), 0);
    let mut order = Vec::new();
    while !(unit.done() && beams.occupancy() == 0) {
        let before = beams.counters().pushes;
        unit.tick(&setups, 1, &mut beams);
        if beams.counters().pushes > before {
            sent.push((cycle, false));
        }
        if drained(cycle)
            && let Some(beam) = beams.pop()
        {
            sent[order.len()].1 = beam.row.is_some();
            order.push((beam.plane, beam.depth));
        }
        beams.commit();
        cycle += 1;
        assert!(cycle < 100_000, "stuck");
    }
    assert!(order.is_sorted(), "plane by plane, depth by depth");
    let account = *unit.account();
    assert_eq!(account.cycles(), cycle);
    Run { sent, account, cycles: cycle, fetched: unit.fetched() }
}

fn waiting(account: &Account) -> u64 {
    account.waiting[Reason::BankConflict as usize]
}

#[test]
fn a_beam_takes_its_voxels_over_the_lanes_and_not_a_cycle_less() {
    for (n, lanes, cycles) in [(8, 8, 1), (8, 9, 1), (9, 8, 2), (16, 5, 4), (1, 1, 1), (7, 1, 7), (1, 64, 1)] {
        let machine = machine(lanes, [1, 1, 1], RaySlots::Wrapped);
        let result = run(&machine, &setup(&machine, [n, 3, 2], [0.0; 2]), 4, |_| true);
        let expected: Vec<(u64, bool)> = (1..=6).map(|beam| (beam * cycles - 1, true)).collect();
        assert_eq!(result.sent, expected, "{n} voxels on {lanes} lanes");
        // The last beam is taken away in the cycle after it was sent.
        assert_eq!(result.account, Account { busy: 6 * cycles, starved: 1, ..Account::default() });
    }
}

#[test]
fn wrapped_planes_have_a_beam_for_each_row_of_voxels_at_every_angle() {
    let machine = machine(8, [1, 1, 1], RaySlots::Wrapped);
    for slopes in [[0.0, 0.0], [0.3, 0.1], [0.9, 0.6], [1.0, 1.0]] {
        let result = run(&machine, &setup(&machine, [8, 8, 8], slopes), 4, |_| true);
        assert_eq!((result.sent.len(), result.fetched), (64, 64), "along {slopes:?}");
        assert!(result.sent.iter().all(|(_, row)| *row));
        assert_eq!(result.cycles, 65);
    }
}

#[test]
fn padded_planes_pay_one_cycle_for_a_depth_outside_of_the_volume() {
    let machine = machine(4, [1, 1, 1], RaySlots::Padded);
    let setup = setup(&machine, [8, 8, 8], [0.9, 0.6]);
    let [_, planes] = setup.geometry.slot_counts();
    assert!(planes > 8);
    let result = run(&machine, &setup, 4, |_| true);
    assert_eq!(result.sent.len(), planes * 8);
    assert_eq!(result.fetched, 64);
    assert_eq!(result.sent.iter().filter(|(_, row)| *row).count(), 64);
    let empty = (planes * 8 - 64) as u64;
    assert_eq!(result.account, Account { busy: 64 * 2 + empty, starved: 1, ..Account::default() });
}

#[test]
fn conflicts_wait_for_their_bank_by_the_known_amount() {
    // Along x the stride is the first coefficient: it meets lanes / gcd modules.
    for (skew, lanes, cycles) in [
        ([1, 1, 1], 8, 1),
        ([3, 1, 1], 8, 1),
        ([2, 1, 1], 8, 2),
        ([4, 1, 1], 8, 4),
        ([0, 1, 1], 8, 8),
        ([-2, 1, 1], 8, 2),
        ([6, 1, 1], 9, 3),
    ] {
        let machine = machine(lanes, skew, RaySlots::Wrapped);
        for rows in [1, 2] {
            let n = lanes * rows;
            let result = run(&machine, &setup(&machine, [n, 2, 3], [0.0; 2]), 4, |_| true);
            let (work, conflicts) = (rows as u64, rows as u64 * (cycles - 1));
            assert_eq!(result.account.busy, 6 * work, "{skew:?}");
            assert_eq!(waiting(&result.account), 6 * conflicts, "{skew:?}");
            let expected: Vec<u64> = (1..=6).map(|beam| beam * (work + conflicts) - 1).collect();
            assert_eq!(result.sent.iter().map(|(cycle, _)| *cycle).collect::<Vec<_>>(), expected, "{skew:?}");
        }
    }
}

#[test]
fn a_view_along_another_axis_has_the_conflicts_of_that_axis() {
    let machine = machine(8, [1, 2, 4], RaySlots::Wrapped);
    let volume = VolumeInfo { dims: [8; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    for (direction, u, conflicts) in [([0.5, 0.1, 1.0], 0, 0), ([0.1, 0.5, 1.0], 1, 1), ([1.0, 0.1, 0.5], 2, 3)] {
        let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        assert_eq!(setup.geometry.axes.axis[0], u);
        let result = run(&machine, &setup, 4, |_| true);
        assert_eq!(waiting(&result.account), 64 * conflicts);
    }
}

#[test]
fn without_room_the_frame_buffer_is_blocked() {
    let machine = machine(8, [1, 1, 1], RaySlots::Wrapped);
    let setup = setup(&machine, [8, 2, 3], [0.0; 2]);
    // Room for one, taken away in cycles 10, 20 …: a beam is sent in 0, 11, 21 … 51.
    let result = run(&machine, &setup, 1, |cycle| cycle > 0 && cycle % 10 == 0);
    assert_eq!(result.sent.iter().map(|(cycle, _)| *cycle).collect::<Vec<_>>(), [0, 11, 21, 31, 41, 51]);
    assert_eq!(result.cycles, 61);
    assert_eq!(result.account, Account { busy: 6, blocked: 51 - 5, starved: 61 - 52, ..Account::default() });
}

/// The pass along +z of an eye before the middle of a cube.
fn seen_from(machine: &MachineSpec, n: usize, distance: f64) -> Arc<FrameSetup> {
    let middle = (n as f64 - 1.0) * 0.5;
    let perspective = Perspective { eye_voxel: Some([middle, middle, -distance]), ..Perspective::new(90.0) };
    let view = View { perspective: Some(perspective), ..View::from_direction([0.0, 0.0, 1.0], None) };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let scene = Scene { view, ..Scene::default() };
    picture_setup(&scene, machine, &volume, true).unwrap().setups.remove(0)
}

#[test]
fn a_near_eyes_beam_is_two_rows_and_a_far_ones_is_one() {
    // The first coefficient gives beams along x and y conflicts by the factor 1, 2, 4.
    for (n, lanes, stride, distance, rows) in [
        (8, 8, 1, 8.0, 1),
        (8, 8, 1, 4.0, 1),
        (8, 8, 1, 3.0, 2),
        (9, 4, 1, 2.0, 2),
        (8, 3, 1, 0.5, 2),
        (8, 8, 2, 1.0, 2),
        (16, 8, 4, 1.0, 2),
        (16, 8, 4, 20.0, 1),
    ] {
        let machine = machine(lanes, [stride, stride, 1], RaySlots::Wrapped);
        let setup = seen_from(&machine, n, distance);
        assert_eq!(setup.geometry.doubled(), rows == 2, "{distance}");
        let fan = &setup.geometry.perspective.as_ref().unwrap().v;
        let inside = |y: i32| (0..n as i32).contains(&y);
        let (mut beams, mut second, mut empty) = (0, 0, 0);
        for plane in 0..fan.count() {
            for depth in 0..n {
                if inside(fan.near(plane, depth)) {
                    beams += 1;
                    second += u64::from(inside(fan.right(plane, depth)));
                } else {
                    empty += 1;
                }
            }
        }
        assert!(beams > second && second > 0 && empty > 0, "the frame has beams of every kind");
        let result = run(&machine, &setup, 4, |_| true);
        assert_eq!(result.fetched, beams + if rows == 2 { second } else { 0 }, "n = {n}, {distance}");
        assert_eq!(result.sent.iter().filter(|(_, row)| *row).count() as u64, beams);
        // A row below that is outside of the volume costs its cycles, too.
        let work = rows * n.div_ceil(lanes) as u64;
        assert_eq!(result.account.busy, beams * work + empty, "n = {n}, {distance}");
        assert_eq!(waiting(&result.account), beams * work * (stride as u64 - 1));
        assert_eq!(result.cycles, beams * work * stride as u64 + empty + 1);
    }
}
