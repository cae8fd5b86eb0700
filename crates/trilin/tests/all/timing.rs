//! The interpolators' data sheet.
//!
//! A pair takes ⌈n_w / lanes⌉ cycles, and finishes the ray before it. The last ray of a plane leaves in the cycle after, beside
//! the first of the next plane, so that a plane takes no cycle more than its pairs.

use cube3_channel::{Account, Channel};
use cube3_dsb::RayPair;
use cube3_frame::{FrameSetup, FrameShape, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::MachineSpec;
use cube3_scene::Scene;
use cube3_trilin::{NoSamples, SampleRay, TrilinUnit};

fn setup() -> FrameSetup {
    let volume = VolumeInfo { dims: [2; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&Scene::default(), &MachineSpec::default(), &volume, true).unwrap().setup
}

/// A frame with a pair offered every `every` cycles: when rays left, and the account.
fn run(schedule: Schedule, every: u64, capacity: usize, drained: impl Fn(u64) -> bool) -> (Vec<u64>, Account) {
    let setup = setup();
    let mut unit = TrilinUnit::new([(schedule, NoSamples)]);
    let mut rays = Channel::<RayPair<()>>::new("rays", 2, 1).unwrap();
    let mut samples = Channel::<SampleRay<()>>::new("samples", capacity, 1).unwrap();
    let (slots, total) = (schedule.shape().slots as u64, schedule.ray_slots());
    let (mut offered, mut cycle, mut left) = (0, 0, Vec::new());
    while !unit.done() {
        if offered < total
            && cycle >= offered * every
            && let Some(pair) = rays.push_slot()
        {
            (pair.plane, pair.slot) = ((offered / slots) as u32, (offered % slots) as u32);
            offered += 1;
        }
        let before = samples.counters().pushes;
        unit.tick(std::slice::from_ref(&setup), &mut rays, &mut samples);
        if samples.counters().pushes > before {
            left.push(cycle);
        }
        if drained(cycle)
            && let Some(ray) = samples.pop()
        {
            let place = samples.counters().pops - 1;
            let expected = (place / slots, place % slots);
            assert_eq!((u64::from(ray.plane), u64::from(ray.slot)), expected);
        }
        rays.commit();
        samples.commit();
        cycle += 1;
        assert!(cycle < 10_000, "stuck");
    }
    assert_eq!(unit.account().cycles(), cycle);
    (left, *unit.account())
}

/// A frame that is taken whole, of rays of so many cycles.
fn schedule(ray_cycles: u64, slots: u32, planes: u32) -> Schedule {
    let lanes = 3;
    let (slots, depths) = (slots as usize, lanes * ray_cycles as usize);
    let shape = FrameShape {
        slots,
        planes: planes as usize,
        depths,
        columns: slots,
        closes: [false; 2],
        doubled: false,
        lanes,
        section: None,
    };
    Schedule::of_shape(shape)
}

#[test]
fn a_ray_leaves_with_the_pair_on_its_right_and_the_last_of_a_plane_a_cycle_after_its_own() {
    for ray_cycles in 1..4 {
        for slots in 1..5_u32 {
            for planes in 1..4_u32 {
                let (left, account) = run(schedule(ray_cycles, slots, planes), 1, 2, |_| true);
                // Pair m is at the input in cycle 1 and taken after ray_cycles more for each.
                let taken = |pair: u64| (pair + 1) * ray_cycles;
                let expected: Vec<u64> = (0..u64::from(slots * planes))
                    .map(|ray| if (ray + 1) % u64::from(slots) == 0 { taken(ray) + 1 } else { taken(ray + 1) })
                    .collect();
                assert_eq!(left, expected, "{ray_cycles} cycles, {slots} × {planes}");
                // One cycle without a pair at the start, and the last ray's own cycle at the end.
                let work = u64::from(slots * planes) * ray_cycles + 1;
                assert_eq!(account, Account { starved: 1, busy: work, ..Account::default() });
            }
        }
    }
}

#[test]
fn without_pairs_the_interpolators_starve() {
    let (left, account) = run(schedule(1, 3, 2), 10, 2, |_| true);
    assert_eq!(left, [11, 21, 22, 41, 51, 52]);
    // Six pairs; the last ray of each plane has a cycle of its own.
    assert_eq!(account, Account { busy: 8, starved: 53 - 8, ..Account::default() });
}

#[test]
fn without_room_the_interpolators_are_blocked() {
    let (left, account) = run(schedule(1, 3, 1), 1, 1, |cycle| cycle % 10 == 0);
    // Pair 0 gives nothing, pair 1 gives ray 0 in cycle 2; then a ray for every one that is taken away.
    assert_eq!(left, [2, 11, 21]);
    assert_eq!(account, Account { starved: 1, busy: 4, blocked: 22 - 5, ..Account::default() });
}
