//! Beams, ray slots and cycles: the counts of the geometry, and the closed form of a machine that never stalls.

use cube3_cases::cases;
use cube3_host::{ParallelFrame, VolumeInfo, frame_setup};
use cube3_machine::{ChannelSize, Channels, MachineSpec, RaySlots, Rays};
use cube3_pipeline::{Machine, RunCounters};
use cube3_scene::{Scene, View};
use proptest::prelude::*;

/// A view with slopes du and dv along x and y.
fn scene(du: f64, dv: f64) -> Scene {
    Scene { view: View { direction: Some([du, dv, 1.0]), ..View::default() }, ..Scene::default() }
}

fn machine(n: usize, slots: RaySlots) -> MachineSpec {
    MachineSpec { lanes: n, rays: Rays { slots, ..Rays::default() }, ..MachineSpec::default() }
}

fn run(machine: &MachineSpec, scene: &Scene, dims: [usize; 3]) -> (ParallelFrame, RunCounters) {
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    let frame = frame_setup(scene, machine, &volume, true).unwrap();
    let mut run = Machine::timing(machine, vec![frame.setup.clone()]).unwrap();
    run.run(&|_, _| {}).unwrap();
    (frame, run.counters())
}

/// Cycles of a cube on as many lanes as it has voxels a side, where nothing ever waits.
///
/// Two planes must be in the skewed buffers before a ray leaves (a single plane needs no second); a ray waits for the one
/// on its right; the gradient waits for a plane and a ray more, and for yet one of each where slots are shared and the
/// first is therefore shaded last.
fn closed_form(frame: &ParallelFrame, machine: &MachineSpec) -> u64 {
    let [slots, planes] = frame.setup.geometry.slot_counts().map(|n| n as u64);
    let depth = frame.setup.geometry.size[2] as u64;
    let Channels { beams, aligned, rays, samples, shaded, pixels } = machine.channel;
    let latency: u64 = [beams, aligned, rays, samples, shaded, pixels].iter().map(|size| size.latency).sum();
    let [closes_u, closes_v] = frame.setup.geometry.closes();
    let beam = depth.div_ceil(machine.lanes as u64);
    let first_read = planes.min(2) * depth;
    let wait = |n: u64, closes: bool| if closes { 2.min(n - 1) } else { 1.min(n - 1) };
    let gradient = wait(planes, closes_v) * slots + wait(slots, closes_u);
    beam * (first_read + gradient + slots * planes) + later(beam) + 1 + latency
}

/// Seven ports follow the frame buffer (bus, two of the skewed buffers, TRILIN, two of ABC, cone); each passes a token of several
/// cycles on with its last one.
fn later(beam: u64) -> u64 {
    7 * (beam - 1)
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn a_wrapped_frame_is_n_squared_beams_and_slots_and_its_cycles_are_the_closed_form(
        n in 1_usize..40, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64, extra in [1_u64..9, 1_u64..9, 1_u64..9, 1_u64..9, 1_u64..9, 1_u64..9],
    ) {
        let [beams, aligned, rays, samples, shaded, pixels] = extra.map(ChannelSize::pipelined);
        let machine = MachineSpec { channel: Channels { beams, aligned, rays, samples, shaded, pixels }, ..machine(n, RaySlots::Wrapped) };
        let (frame, counters) = run(&machine, &scene(du, dv), [n; 3]);
        let square = (n * n) as u64;
        prop_assert_eq!((counters.beams, counters.ray_slots, counters.steady_cycles), (square, square, square));
        prop_assert_eq!(counters.cycles, closed_form(&frame, &machine));
        prop_assert!(counters.units.iter().all(|(_, account)| account.blocked == 0));
    }

    #[test]
    fn a_padded_frame_has_the_counts_of_the_geometry(n in 1_usize..40, du in 0.0..=1.0_f64, dv in 0.0..=1.0_f64) {
        let (frame, counters) = run(&machine(n, RaySlots::Padded), &scene(du, dv), [n; 3]);
        let geometry = &frame.setup.geometry;
        let last = (n - 1) as f64 + geometry.real_offset();
        let [more_u, more_v] = geometry.real_slopes().map(|slope| (last * slope).floor() as u64);
        let n = n as u64;
        prop_assert_eq!(counters.beams, n * n);
        prop_assert_eq!(counters.ray_slots, (n + more_u) * (n + more_v));
        prop_assert_eq!(counters.steady_cycles, counters.ray_slots);
    }
}

/// Frames a second of 512³ at a memory cycle of 125 ns, planes following each other without a gap.
#[test]
fn the_papers_rate_wrapped_and_what_padding_costs() {
    let rate = |slots, du: f64, dv: f64| {
        let (_, counters) = run(&machine(512, slots), &scene(du, dv), [512; 3]);
        8.0e6 / counters.steady_cycles as f64
    };
    let slope = |degrees: f64| degrees.to_radians().tan();
    let close = |got: f64, expected: f64| (got - expected).abs() < 0.05;
    assert!(close(rate(RaySlots::Wrapped, 1.0, slope(20.0)), 30.5));
    assert!(close(rate(RaySlots::Padded, 1.0, 0.0), 15.3));
    assert!(close(rate(RaySlots::Padded, 1.0, slope(20.0)), 11.2));
    assert!(close(rate(RaySlots::Padded, 1.0, 1.0), 7.6));
}

#[test]
fn a_lone_frame_pays_its_fill() {
    let (frame, counters) = run(&machine(512, RaySlots::Wrapped), &scene(0.5, 0.25), [512; 3]);
    assert_eq!(counters.cycles, closed_form(&frame, &machine(512, RaySlots::Wrapped)));
    // Beams, two planes before the first ray, two planes and two rays before the first colour, the last ray, the latencies.
    assert_eq!(counters.cycles, 512 * 512 + 2 * 512 + (2 * 512 + 2) + 1 + 36);
}

#[test]
fn fewer_lanes_than_voxels_take_as_many_cycles_more() {
    for (lanes, beam) in [(16, 2), (11, 3), (8, 4), (1, 32)] {
        let machine = machine(lanes, RaySlots::Wrapped);
        let (frame, counters) = run(&machine, &scene(0.5, 0.25), [32; 3]);
        assert_eq!(counters.cycles, closed_form(&frame, &machine), "{lanes} lanes");
        assert_eq!(counters.steady_cycles, 32 * 32 * beam, "{lanes} lanes");
    }
}

#[test]
fn a_bad_skew_waits_for_its_modules() {
    let mut machine = machine(32, RaySlots::Wrapped);
    machine.cfb.skew = [4, 1, 1];
    let (frame, counters) = run(&machine, &scene(0.5, 0.25), [32; 3]);
    assert_eq!(frame.setup.geometry.axes.axis, [0, 1, 2]);
    let (_, cfb) = counters.units[0];
    assert_eq!(cfb.busy, 32 * 32, "a cycle of work a beam");
    assert_eq!(cfb.waiting.iter().sum::<u64>(), 3 * 32 * 32, "and three more for the other voxels of a module");
}

#[test]
fn a_machine_that_cannot_move_says_who_waits_for_whom() {
    let mut machine = machine(8, RaySlots::Wrapped);
    machine.dsb.planes = 1;
    let volume = VolumeInfo { dims: [8; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let frame = frame_setup(&scene(0.5, 0.25), &machine, &volume, true).unwrap();
    let mut run = Machine::timing(&machine, vec![frame.setup]).unwrap();
    let deadlock = run.run(&|_, _| {}).unwrap_err();
    let text = deadlock.to_string();
    assert!(deadlock.circular);
    assert!(text.contains("dsb.write waits for dsb.read: plane buffers is full (1 of 1)"), "{text}");
    assert!(text.contains("dsb.read waits for dsb.write: the plane below is empty (1 of 1)"), "{text}");
    assert!(text.starts_with("nothing can move after cycle 1"), "{text}");
}
