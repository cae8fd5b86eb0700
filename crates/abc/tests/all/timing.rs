//! The ABC units' data sheet.
//!
//! A ray takes ⌈n_w / lanes⌉ cycles. With a gradient it leaves when the ray below and to the right has come: a plane and a ray
//! later, and where slots close, the first of each plane and the first plane come last. Without one it leaves as it
//! comes. The ring holds `abc.planes` planes: four by default, three at least with a gradient.

use crate::registers::{Dice, frame as any_frame};
use cube3_abc::{AbcSpec, AbcUnit, NoShading, ShadedRay};
use cube3_channel::{Account, Channel};
use cube3_frame::{FrameSetup, FrameShape, Schedule, ShadingOrder};
use cube3_trilin::SampleRay;

/// A frame in all that its timing depends on.
#[derive(Clone, Copy, Debug)]
struct TimedFrame {
    ray_cycles: u64,
    slots: u64,
    planes: u64,
    closes: [bool; 2],
    buffered: bool,
    reach: usize,
    ring: u64,
    section: Option<usize>,
}

impl TimedFrame {
    fn schedule(&self) -> Schedule {
        let (slots, lanes) = (self.slots as usize, 3);
        Schedule::of_shape(FrameShape {
            slots,
            planes: self.planes as usize,
            depths: lanes * self.ray_cycles as usize,
            columns: slots,
            closes: self.closes,
            doubled: false,
            lanes,
            section: self.section,
        })
    }

    fn order(&self) -> ShadingOrder {
        self.schedule().shading_order(self.reach, self.buffered)
    }

    fn spec(&self) -> AbcSpec {
        AbcSpec { order: self.order(), ring: self.ring }
    }

    /// How many rays must have come before a slot can be shaded.
    fn needed(&self, plane: u64, slot: u64) -> u64 {
        self.order().needed(plane, slot)
    }
}

/// Frames of every small shape, taken whole and in sections.
fn frames() -> impl Iterator<Item = TimedFrame> {
    let closes = [[false, false], [false, true], [true, false], [true, true]];
    let sizes = (1..=6_u64).flat_map(|slots| (1..=6_u64).map(move |planes| (slots, planes)));
    let shapes = sizes.flat_map(move |size| closes.map(|closes| (size, closes)));
    shapes.flat_map(|((slots, planes), closes)| {
        let kinds = [false, true].into_iter().flat_map(move |buffered| (1..=slots).map(move |width| (buffered, width)));
        kinds.map(move |(buffered, width)| TimedFrame {
            closes,
            buffered,
            section: Some(width as usize),
            ..frame_of(slots, planes)
        })
    })
}

/// A frame with a gradient that reads the next rays, taken whole, on four planes; no slots are shared.
fn frame_of(slots: u64, planes: u64) -> TimedFrame {
    TimedFrame { ray_cycles: 1, slots, planes, closes: [false; 2], buffered: true, reach: 1, ring: 4, section: None }
}

/// The rays of a frame, plane and slot, in the order in which they come.
fn taken(frame: &TimedFrame) -> Vec<(u32, u32)> {
    frame.schedule().finished_rays().map(|ray| (ray.plane, ray.slot)).collect()
}

/// A frame through the unit: the cycle in which each ray left, with its plane and slot.
struct Run {
    left: Vec<(u64, [u64; 2])>,
    account: Account,
    cycles: u64,
}

/// Runs a frame with a ray offered every `every` cycles and taken away where `drained` says so of a cycle; until it
/// is done, or nothing has moved for long.
fn run(setup: &FrameSetup, frame: TimedFrame, every: u64, capacity: usize, drained: impl Fn(u64) -> bool) -> Run {
    let mut unit = AbcUnit::new([(frame.spec(), NoShading)]);
    let mut samples = Channel::<SampleRay<()>>::new("samples", 2, 1).unwrap();
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", capacity, 1).unwrap();
    let total = frame.slots * frame.planes;
    let taken = taken(&frame);
    let order: Vec<[u64; 2]> = frame.order().shaded().collect();
    let mut offered = 0;
    let mut result = Run { left: Vec::new(), account: Account::default(), cycles: 0 };
    let mut idle = 0;
    while (result.left.len() as u64) < total {
        let now = result.cycles;
        if offered < total && now >= offered * every && samples.can_push() {
            let ray = samples.push_slot().unwrap();
            (ray.plane, ray.slot) = taken[offered as usize];
            offered += 1;
        }
        let before = shaded.counters().pushes;
        let moved = unit.tick(std::slice::from_ref(setup), &mut samples, &mut shaded).is_active();
        if shaded.counters().pushes > before {
            result.left.push((now, order[before as usize]));
        }
        if drained(now)
            && let Some(ray) = shaded.pop()
        {
            let popped = shaded.counters().pops - 1;
            assert_eq!([u64::from(ray.plane), u64::from(ray.slot)], order[popped as usize]);
        }
        samples.commit();
        shaded.commit();
        result.cycles += 1;
        idle = if moved { 0 } else { idle + 1 };
        assert!(idle < 50, "stuck after {} of {total} rays: {frame:?}", result.left.len());
    }
    assert!(unit.done());
    result.account = *unit.account();
    assert_eq!(result.account.cycles(), result.cycles);
    result
}

fn setup() -> FrameSetup {
    any_frame(&mut Dice::new(0))
}

#[test]
fn no_shape_of_frame_gets_stuck_with_four_planes() {
    let setup = setup();
    for frame in frames() {
        for ray_cycles in [1, 3] {
            let frame = TimedFrame { ray_cycles, ..frame };
            run(&setup, frame, 1, 2, |_| true);
            run(&setup, frame, 1, 1, |now| now % 7 == 0);
        }
    }
}

#[test]
fn without_a_gradient_a_ray_leaves_as_it_comes() {
    let setup = setup();
    for ray_cycles in 1..5 {
        let frame = TimedFrame { ray_cycles, closes: [true; 2], buffered: false, ..frame_of(4, 3) };
        let left = run(&setup, frame, 1, 2, |_| true).left;
        for (e, (cycle, _)) in left.into_iter().enumerate() {
            // It is at the input in cycle 1, taken after ray_cycles, given after as many, the two at once.
            assert_eq!(cycle, (e as u64 + 2) * ray_cycles - 1, "ray {e}, {ray_cycles} cycles each");
        }
    }
}

#[test]
fn the_first_ray_leaves_a_plane_and_a_ray_later_and_not_a_cycle_earlier() {
    let setup = setup();
    for slots in 1..7 {
        for planes in 1..6 {
            for (closes, buffered) in [([false; 2], true), ([true; 2], true), ([false; 2], false)] {
                let frame = TimedFrame { closes, buffered, ..frame_of(slots, planes) };
                let result = run(&setup, frame, 1, 2, |_| true);
                let [plane, slot] = frame.order().shaded().next().unwrap();
                // Ray number m (from 0) is at the input in cycle m + 1, and given in the cycle in which it is taken.
                assert_eq!(result.left[0].0, frame.needed(plane, slot), "{frame:?}");
                let late = match (buffered, closes[0]) {
                    (false, _) => 0,
                    (true, true) if planes > 2 && slots > 2 => 2 * slots + 2,
                    (true, true) => continue,
                    (true, false) => u64::from(planes > 1) * slots + u64::from(slots > 1),
                };
                assert_eq!(result.left[0].0, 1 + late, "{frame:?}");
            }
        }
    }
}

#[test]
fn rays_leave_at_the_rate_of_the_lanes() {
    let setup = setup();
    for ray_cycles in 1..5 {
        for closes in [[false; 2], [true; 2]] {
            let frame = TimedFrame { ray_cycles, closes, ..frame_of(6, 5) };
            let result = run(&setup, frame, 1, 2, |_| true);
            let steady = result.left.windows(2).all(|pair| pair[1].0 - pair[0].0 >= ray_cycles);
            assert!(steady, "{ray_cycles}: {:?}", result.left);
            // At the end of the frame nothing comes any more, and a ray leaves every ray_cycles.
            let tail = &result.left[result.left.len() - 4..];
            assert!(tail.windows(2).all(|pair| pair[1].0 - pair[0].0 == ray_cycles), "{tail:?}");
        }
    }
}

#[test]
fn a_frame_that_never_stalls_takes_its_rays_and_its_fill() {
    let setup = setup();
    for (slots, planes) in [(5, 5), (1, 4), (7, 1), (2, 2)] {
        let frame = frame_of(slots, planes);
        let result = run(&setup, frame, 1, 2, |_| true);
        // The first cycle has no ray yet; then one is taken or given in every cycle.
        let needed = frame.needed(0, 0);
        assert_eq!(result.cycles, needed + slots * planes, "{slots} × {planes}");
        assert_eq!(result.account, Account { starved: 1, busy: needed + slots * planes - 1, ..Account::default() });
    }
}

#[test]
fn a_unit_without_rays_is_starved_and_one_without_room_blocked() {
    let setup = setup();
    let frame = TimedFrame { buffered: false, ..frame_of(3, 2) };
    let slow = run(&setup, frame, 10, 2, |_| true);
    // Ray m comes in cycle 10·m + 1: 6 cycles of work in 52.
    assert_eq!(slow.account, Account { busy: 6, starved: 46, ..Account::default() });
    // Room for one, taken away in cycles 0, 10, 20 …: pushed in 1, and in each cycle after a pop. The unit takes on
    // into its buffers, but does not work without a ray at the input.
    let held = run(&setup, frame, 1, 1, |now| now % 10 == 0);
    let left: Vec<u64> = held.left.iter().map(|(cycle, _)| *cycle).collect();
    assert_eq!(left, [1, 11, 21, 31, 41, 51]);
    assert_eq!(held.account.starved, 1);
    // Busy while rays are taken (cycles 1 to 6) or given.
    assert_eq!(held.account, Account { starved: 1, busy: 6 + 5, blocked: 52 - 12, ..Account::default() });
}

#[test]
fn a_full_ring_stops_the_input_and_says_so() {
    let setup = setup();
    let frame = frame_of(2, 9);
    let mut unit = AbcUnit::new([(frame.spec(), NoShading)]);
    let mut samples = Channel::<SampleRay<()>>::new("samples", 2, 1).unwrap();
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 1, 1).unwrap();
    let mut offered = 0_u32;
    for cycle in 0..40 {
        if let Some(ray) = samples.push_slot() {
            (ray.plane, ray.slot) = (offered / 2, offered % 2);
            offered += 1;
        }
        let moved = unit.tick(std::slice::from_ref(&setup), &mut samples, &mut shaded).is_active();
        samples.commit();
        shaded.commit();
        // Nothing leaves: the ray of plane 4 is the first that does not fit.
        assert_eq!(moved, (1..=8).contains(&cycle), "cycle {cycle}");
        assert_eq!(unit.inner_wait(&samples).is_some(), cycle >= 8);
    }
    assert_eq!(samples.counters().pops, 8);
    let wait = unit.inner_wait(&samples).unwrap();
    assert_eq!((wait.unit, wait.occupancy, wait.capacity, wait.upon), ("abc", 4, 4, "cone"));
    // Plane 4 takes the buffer of plane 0 when plane 1, which needs it above, has been given.
    while unit.inner_wait(&samples).is_some() {
        assert!(shaded.counters().pushes < 4);
        shaded.pop();
        shaded.commit();
        unit.tick(std::slice::from_ref(&setup), &mut samples, &mut shaded);
        samples.commit();
        shaded.commit();
    }
    assert_eq!(shaded.counters().pushes, 4);
}

#[test]
fn with_three_planes_the_input_waits_for_the_end_of_a_plane_and_with_more_it_does_not() {
    let setup = setup();
    let (slots, planes) = (6, 8);
    let cycles = |ring: u64, every: u64| {
        let frame = TimedFrame { ring, ..frame_of(slots, planes) };
        run(&setup, frame, every, 2, |_| true).cycles
    };
    // One cycle before the first ray is there, its neighbours a plane and a ray later, and then a ray a cycle.
    let free = 1 + slots + 1 + slots * planes;
    assert_eq!([4, 5, 64].map(|ring| cycles(ring, 1)), [free; 3]);
    // The first ray of plane i + 2 takes the buffer of plane i − 1 from the cycle on after the last ray of plane i has been given,
    // which leaves one cycle after the last ray of plane i + 1 has come.
    assert_eq!(cycles(3, 1), free + THREE_PLANES_COST * (planes - 3));
    // Without a gradient nothing waits, with one plane or many.
    for ring in 1..5 {
        let frame = TimedFrame { closes: [true; 2], buffered: false, ring, ..frame_of(slots, planes) };
        assert_eq!(run(&setup, frame, 1, 2, |_| true).cycles, 1 + slots * planes);
    }
}

/// Cycles that a ring of three costs for each plane that comes in while one is being shaded.
const THREE_PLANES_COST: u64 = 1;

#[test]
fn no_shape_of_frame_gets_stuck_with_three_planes() {
    let setup = setup();
    for frame in frames() {
        for ray_cycles in [1, 3] {
            let frame = TimedFrame { ray_cycles, ring: 3, ..frame };
            run(&setup, frame, 1, 2, |_| true);
            run(&setup, frame, 1, 1, |now| now % 7 == 0);
        }
    }
}

#[test]
fn with_two_planes_the_unit_waits_for_itself_and_says_so() {
    let setup = setup();
    let frame = TimedFrame { ring: 2, ..frame_of(3, 5) };
    let mut unit = AbcUnit::new([(frame.spec(), NoShading)]);
    let mut samples = Channel::<SampleRay<()>>::new("samples", 2, 1).unwrap();
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 2, 1).unwrap();
    let mut offered = 0_u32;
    for _ in 0..60 {
        if let Some(ray) = samples.push_slot() {
            (ray.plane, ray.slot) = (offered / 3, offered % 3);
            offered += 1;
        }
        unit.tick(std::slice::from_ref(&setup), &mut samples, &mut shaded);
        shaded.pop();
        samples.commit();
        shaded.commit();
    }
    // Plane 0 is given, plane 1 lacks the plane below, and its buffer is taken by the one above.
    assert_eq!(shaded.counters().pushes, 3);
    let wait = unit.inner_wait(&samples).unwrap();
    assert_eq!((wait.upon, wait.occupancy, wait.capacity), ("abc", 2, 2));
    let text = cube3_channel::diagnose(9, &[wait]).to_string();
    assert_eq!(
        text,
        "nothing can move after cycle 9: abc waits for abc: sample planes is full (2 of 2); which closes the circle"
    );
}

#[test]
fn the_ring_takes_planes_of_this_frame_and_the_next_and_of_no_third() {
    let setup = setup();
    let frames = vec![setup; 4];
    for closes in [[false; 2], [true; 2]] {
        for planes in 1..4_u64 {
            for ring in 3..9 {
                let frame = TimedFrame { closes, ring, ..frame_of(3, planes) };
                let mut unit = AbcUnit::new([(frame.spec(), NoShading); 4]);
                let mut samples = Channel::<SampleRay<()>>::new("samples", 2, 1).unwrap();
                // Nobody takes the shaded rays, and so the first planes of frame 0 stay.
                let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 1, 1).unwrap();
                let mut offered = 0;
                for _ in 0..100 {
                    if offered < 4 * planes * frame.slots
                        && let Some(ray) = samples.push_slot()
                    {
                        let plane = offered / frame.slots;
                        (ray.frame, ray.plane) = ((plane / planes) as u32, (plane % planes) as u32);
                        ray.slot = (offered % frame.slots) as u32;
                        offered += 1;
                    }
                    unit.tick(&frames, &mut samples, &mut shaded);
                    samples.commit();
                    shaded.commit();
                }
                // First planes are kept for two frames.
                let taken = ring.min(2 * planes) * frame.slots;
                assert_eq!(samples.counters().pops, taken, "frames of {planes}, {ring} planes, {closes:?}");
            }
        }
    }
}

/// Neighbours of a near frame are several rays and planes away: the first slot waits for that many, and a ring of 2·reach + 2 planes never
/// holds the input.
#[test]
fn farther_neighbours_cost_their_planes_once() {
    let setup = setup();
    let (slots, planes) = (6, 12);
    for reach in 1..=5 {
        let frame = |ring| TimedFrame { reach, ring, ..frame_of(slots, planes) };
        let away = reach as u64;
        assert_eq!(frame(4).needed(0, 0), away * slots + away + 1);
        assert_eq!(frame(4).needed(planes - 1, slots - 1), planes * slots);
        let cycles = |ring| run(&setup, frame(ring), 1, 2, |_| true).cycles;
        let free = 1 + away * slots + away + slots * planes;
        assert_eq!([cycles(2 * away + 2), cycles(64)], [free; 2], "{reach}");
        assert!(cycles(2 * away + 1) > free, "{reach}");
    }
}

#[test]
fn a_ring_too_small_for_farther_neighbours_is_named() {
    let setup = setup();
    let frame = TimedFrame { reach: 3, ring: 6, ..frame_of(3, 9) };
    let mut unit = AbcUnit::new([(frame.spec(), NoShading)]);
    let mut samples = Channel::<SampleRay<()>>::new("samples", 2, 1).unwrap();
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 2, 1).unwrap();
    let mut offered = 0_u32;
    for _ in 0..90 {
        if let Some(ray) = samples.push_slot() {
            (ray.plane, ray.slot) = (offered / 3, offered % 3);
            offered += 1;
        }
        unit.tick(std::slice::from_ref(&setup), &mut samples, &mut shaded);
        shaded.pop();
        samples.commit();
        shaded.commit();
    }
    let wait = unit.inner_wait(&samples).unwrap();
    assert_eq!((wait.unit, wait.capacity, wait.upon), ("abc", 6, "abc"));
}

/// A frame whose neighbours are near follows one whose are far: it may come in as far as its own ring goes, not the other's.
#[test]
fn the_next_frame_comes_in_as_far_as_its_own_ring_goes() {
    let setups = [setup(), setup()];
    let spec = |reach, ring| TimedFrame { reach, ring, ..frame_of(1, 12) }.spec();
    let mut unit = AbcUnit::new([(spec(4, 10), NoShading), (spec(1, 4), NoShading)]);
    let mut samples = Channel::<SampleRay<()>>::new("samples", 1, 1).unwrap();
    let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 1, 1).unwrap();
    let mut offered = 0_u32;
    for _ in 0..200 {
        if let Some(ray) = samples.push_slot() {
            (ray.frame, ray.plane, ray.slot) = (offered / 12, offered % 12, 0);
            offered += 1;
        }
        unit.tick(&setups, &mut samples, &mut shaded);
        // The last ray of the first frame stays.
        if shaded.counters().pushes < 11 {
            shaded.pop();
        }
        samples.commit();
        shaded.commit();
    }
    assert_eq!(samples.counters().pops, 12 + 4);
}
