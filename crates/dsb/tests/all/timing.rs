//! The data sheets of the fast bus and of the skewed buffers.
//!
//! Bus: a beam takes ⌈n_u / lanes⌉ cycles, one without voxels a cycle. Buffers: the write port takes as long for a beam, the
//! read port ⌈n_w / lanes⌉ cycles for a pair of rays; a plane can be read when it and the one below are written, from
//! the next cycle on, and gives its buffer back in the cycle in which its last ray leaves. Where the slots of a perspective frame need
//! their own cells, the bus gathers all slots four times, and the buffers write the four words of a slot side by side.

use crate::common::setup;
use cube3_cfb::Beam;
use cube3_channel::{Account, Activity, Channel, PortState, Reason, diagnose};
use cube3_dsb::bus::{BusUnit, NoBus};
use cube3_dsb::{DsbSpec, DsbUnit, NoPlanes, RayPair};
use cube3_frame::{FrameSetup, FrameShape, Schedule};
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{Bus, MachineSpec};
use cube3_scene::{Perspective, Scene, View};
use std::sync::Arc;

/// A frame of `frame_planes` planes of n beams and n ray slots on n lanes.
fn shape(n: u32, frame_planes: u32) -> FrameShape {
    let n = n as usize;
    FrameShape {
        slots: n,
        planes: frame_planes as usize,
        depths: n,
        columns: n,
        closes: [false; 2],
        doubled: false,
        lanes: n,
        section: None,
    }
}

/// Buffers of so many planes for it.
fn spec(n: u32, frame_planes: u32, planes: usize) -> DsbSpec {
    DsbSpec { schedule: Schedule::of_shape(shape(n, frame_planes)), planes, ports: 2 }
}

/// The buffers between their channels, with a beam offered in every cycle.
struct Bench {
    spec: DsbSpec,
    unit: DsbUnit<NoPlanes>,
    aligned: Channel<Beam<()>>,
    rays: Channel<RayPair<()>>,
    offered: u32,
    cycle: u64,
    /// Cycles in which pairs left.
    left: Vec<u64>,
}

impl Bench {
    fn new(spec: DsbSpec, capacity: usize) -> Bench {
        Bench {
            spec,
            unit: DsbUnit::new([(spec, NoPlanes)]),
            aligned: Channel::new("aligned", 2, 1).unwrap(),
            rays: Channel::new("rays", capacity, 1).unwrap(),
            offered: 0,
            cycle: 0,
            left: Vec::new(),
        }
    }

    fn shape(&self) -> FrameShape {
        *self.spec.schedule.shape()
    }

    /// One cycle; whether anything moved.
    fn tick(&mut self, drained: bool, row: impl Fn(u32) -> Option<u32>) -> bool {
        let [planes, depths] = [self.shape().planes, self.shape().depths].map(|count| count as u32);
        if self.offered < planes * depths
            && let Some(beam) = self.aligned.push_slot()
        {
            (beam.plane, beam.depth) = (self.offered / depths, self.offered % depths);
            beam.row = row(self.offered);
            self.offered += 1;
        }
        let before = self.rays.counters().pushes;
        let moved = self.unit.tick(&mut self.aligned, &mut self.rays).into_iter().any(Activity::is_active);
        if self.rays.counters().pushes > before {
            self.left.push(self.cycle);
        }
        if drained {
            self.rays.pop();
        }
        self.aligned.commit();
        self.rays.commit();
        self.cycle += 1;
        for account in self.unit.accounts() {
            assert_eq!(account.cycles(), self.cycle);
        }
        moved
    }

    fn run(mut self) -> Bench {
        while !self.unit.done() {
            self.tick(true, Some);
            assert!(self.cycle < 10_000, "stuck: {:?}", self.spec);
        }
        self
    }
}

#[test]
fn the_first_pair_leaves_when_two_planes_are_written_and_not_a_cycle_earlier() {
    for n in 1..9 {
        for planes in 2..5 {
            // Beam m is at the write port in cycle m + 1: 2·n beams are written after cycle 2·n.
            let bench = Bench::new(spec(n, 4, planes), 2).run();
            assert_eq!(bench.left[0], 2 * u64::from(n) + 1, "n = {n}, {planes} planes");
        }
        // A frame of one plane has none below.
        let bench = Bench::new(spec(n, 1, 1), 2).run();
        assert_eq!(bench.left[0], u64::from(n) + 1);
    }
}

#[test]
fn three_planes_never_stall() {
    for n in 1..9_u64 {
        for frame_planes in 2..7_u64 {
            let bench = Bench::new(spec(n as u32, frame_planes as u32, 3), 2).run();
            let all = frame_planes * n;
            let expected: Vec<u64> = (0..all).map(|pair| 2 * n + 1 + pair).collect();
            assert_eq!(bench.left, expected);
            let [write, read] = bench.unit.accounts();
            assert_eq!(*write, Account { busy: all, starved: bench.cycle - all, ..Account::default() });
            assert_eq!(*read, Account { busy: all, starved: 2 * n + 1, ..Account::default() });
        }
    }
}

#[test]
fn with_two_planes_the_ports_take_turns() {
    // A plane is written while none is read, but for the cycle in which the last ray leaves: 2·n − 1 for each plane. The last
    // one is there with the one above.
    let n = 5;
    let bench = Bench::new(spec(5, 4, 2), 2).run();
    let starts = [2 * n + 1, 4 * n, 6 * n - 1, 7 * n - 1];
    let expected: Vec<u64> = starts.into_iter().flat_map(|start| start..start + n).collect();
    assert_eq!(bench.left, expected);
    let [write, read] = bench.unit.accounts();
    // The write port holds beam 10 from cycle 11 to 14, and one more for the next plane, twice n − 1.
    assert_eq!((write.busy, write.blocked), (20, 2 * (n - 1)));
    assert_eq!((read.busy, read.blocked), (20, 0));
}

#[test]
fn ports_take_their_cycles_over_the_lanes() {
    for (write_cycles, read_cycles) in [(1, 3), (3, 1), (2, 2)] {
        let [columns, depths] = [write_cycles, read_cycles].map(|cycles| 2 * cycles as usize);
        let schedule = Schedule::of_shape(FrameShape { lanes: 2, columns, depths, ..shape(4, 3) });
        let bench = Bench::new(DsbSpec { schedule, ..spec(4, 3, 3) }, 2).run();
        // Beam m is written in cycle (m + 1)·w; the pair takes r cycles from the one after the second plane.
        let beams = 2 * read_cycles;
        assert_eq!(bench.left[0], 2 * beams * write_cycles + read_cycles, "{write_cycles}, {read_cycles}");
        assert!(bench.left.windows(2).all(|pair| pair[1] - pair[0] >= read_cycles));
        let [write, read] = bench.unit.accounts();
        assert_eq!((write.busy, read.busy), (3 * beams * write_cycles, 12 * read_cycles));
    }
}

#[test]
fn a_beam_without_voxels_takes_one_cycle() {
    let schedule = Schedule::of_shape(FrameShape { columns: 4 * 6, ..shape(6, 1) });
    let mut bench = Bench::new(DsbSpec { schedule, ..spec(6, 1, 3) }, 2);
    while bench.left.is_empty() {
        bench.tick(true, |beam| (beam % 2 == 0).then_some(beam));
    }
    assert_eq!(bench.left[0], 3 * 4 + 3 + 1);
}

#[test]
fn with_one_port_writing_waits_while_rays_are_read() {
    let n = 5_u64;
    for planes in 2..6_u64 {
        let bench = Bench::new(DsbSpec { ports: 1, ..spec(5, 6, planes as usize) }, 2).run();
        // Two planes are written before the first is read; then a plane is read and a plane is written in turn, n cycles each,
        // and the last two are there together.
        let starts = [2, 4, 6, 8, 10, 11].map(|planes| planes * n + 1);
        let expected: Vec<u64> = starts.into_iter().flat_map(|start| start..start + n).collect();
        assert_eq!(bench.left, expected, "{planes} planes");
        let [write, read] = bench.unit.accounts();
        // A beam waits at the write port for a buffer, where there are but two, or else for the modules.
        let port = write.waiting[Reason::Port as usize];
        let held = 4 * n;
        assert_eq!((write.busy, write.blocked + port), (6 * n, held));
        assert_eq!(port, if planes == 2 { 4 } else { held });
        assert_eq!((read.busy, read.blocked), (6 * n, 0));
    }
}

#[test]
fn without_a_buffer_the_write_port_is_blocked() {
    let n = 4;
    let mut bench = Bench::new(spec(4, 8, 3), 1);
    for cycle in 0..40 {
        let moved = bench.tick(false, Some);
        assert_eq!(moved, (1..=3 * n).contains(&cycle), "cycle {cycle}");
    }
    // Three planes are in, one pair is out and nobody takes it.
    assert_eq!(bench.aligned.counters().pops, 3 * n);
    assert_eq!(bench.left, [2 * n + 1]);
    let [write, read] = bench.unit.accounts();
    assert_eq!(*write, Account { busy: 12, starved: 1, blocked: 27, ..Account::default() });
    assert_eq!(*read, Account { busy: 1, starved: 9, blocked: 30, ..Account::default() });
    let waits = bench.unit.inner_waits(&bench.aligned);
    assert_eq!(waits.len(), 1, "the read port waits for the channel alone: {waits:?}");
    assert_eq!((waits[0].unit, waits[0].upon, waits[0].state), ("dsb.write", "dsb.read", PortState::Full));
    assert_eq!((waits[0].occupancy, waits[0].capacity), (3, 3));
}

#[test]
fn one_plane_can_never_be_read_and_the_two_ports_wait_for_each_other() {
    let mut bench = Bench::new(spec(4, 3, 1), 2);
    for cycle in 0..30 {
        let moved = bench.tick(true, Some);
        assert_eq!(moved, (1..=4).contains(&cycle), "cycle {cycle}");
    }
    assert_eq!(bench.left, [0_u64; 0]);
    let waits = bench.unit.inner_waits(&bench.aligned);
    let deadlock = diagnose(4, &waits);
    assert!(deadlock.circular);
    let units: Vec<&str> = deadlock.waits.iter().map(|wait| wait.unit).collect();
    assert_eq!(units, ["dsb.write", "dsb.read"]);
    let text = deadlock.to_string();
    assert!(text.contains("dsb.write waits for dsb.read: plane buffers is full (1 of 1)"), "{text}");
    assert!(text.contains("dsb.read waits for dsb.write: the plane below is empty (1 of 1)"), "{text}");
}

#[test]
fn the_bus_takes_a_beam_as_long_as_its_lanes_need() {
    for (n, lanes, cycles) in [(8, 8, 1), (9, 8, 2), (7, 2, 4), (1, 3, 1)] {
        let machine = MachineSpec { lanes, ..MachineSpec::default() };
        let setup = setup(&machine, [n, 1, 1]);
        let mut bus = BusUnit::new(&machine, [Schedule::new(&machine, &setup.geometry)], NoBus);
        let mut beams = Channel::<Beam<()>>::new("beams", 2, 1).unwrap();
        let mut aligned = Channel::<Beam<()>>::new("aligned", 2, 1).unwrap();
        let (mut offered, mut left) = (0, Vec::new());
        for cycle in 0..60 {
            // Beams 3 and 4 have no voxels.
            if offered < 6
                && let Some(beam) = beams.push_slot()
            {
                (beam.depth, beam.row) = (offered, (offered != 3 && offered != 4).then_some(0));
                offered += 1;
            }
            let before = aligned.counters().pushes;
            bus.tick(std::slice::from_ref(&setup), &mut beams, &mut aligned, None);
            if aligned.counters().pushes > before {
                left.push(cycle);
            }
            if let Some(beam) = aligned.pop() {
                assert_eq!(u64::from(beam.depth), aligned.counters().pops - 1);
                assert_eq!(beam.row.is_none(), beam.depth == 3 || beam.depth == 4);
            }
            beams.commit();
            aligned.commit();
        }
        let c = cycles;
        assert_eq!(left, [c, 2 * c, 3 * c, 3 * c + 1, 3 * c + 2, 4 * c + 2], "{n} voxels on {lanes} lanes");
        let busy = 4 * c + 2;
        assert_eq!(*bus.account(), Account { busy, starved: 60 - busy, ..Account::default() });
    }
}

#[test]
fn the_bus_is_blocked_while_nobody_takes_its_beam() {
    let machine = MachineSpec { lanes: 8, ..MachineSpec::default() };
    let setup = setup(&machine, [8, 1, 1]);
    let mut bus = BusUnit::new(&machine, [Schedule::new(&machine, &setup.geometry)], NoBus);
    let mut beams = Channel::<Beam<()>>::new("beams", 2, 1).unwrap();
    let mut aligned = Channel::<Beam<()>>::new("aligned", 1, 1).unwrap();
    for cycle in 0..20 {
        if let Some(beam) = beams.push_slot() {
            beam.row = Some(0);
        }
        assert_eq!(bus.tick(std::slice::from_ref(&setup), &mut beams, &mut aligned, None).is_active(), cycle == 1);
        beams.commit();
        aligned.commit();
    }
    assert_eq!(*bus.account(), Account { busy: 1, starved: 1, blocked: 18, ..Account::default() });
}

/// So many full beams of plane 0 behind each other through the bus: cycles in which they left, and the bus.
fn through_the_bus(machine: &MachineSpec, dims: [usize; 3], beams: u32) -> (Vec<u64>, BusUnit<NoBus>) {
    beams_through_the_bus(machine, &setup(machine, dims), beams)
}

fn beams_through_the_bus(machine: &MachineSpec, setup: &FrameSetup, beams: u32) -> (Vec<u64>, BusUnit<NoBus>) {
    let mut bus = BusUnit::new(machine, [Schedule::new(machine, &setup.geometry)], NoBus);
    let mut input = Channel::<Beam<()>>::new("beams", 2, 1).unwrap();
    let mut aligned = Channel::<Beam<()>>::new("aligned", 2, 1).unwrap();
    let (mut offered, mut left) = (0, Vec::new());
    while left.len() < beams as usize {
        if offered < beams
            && let Some(beam) = input.push_slot()
        {
            let rows = setup.geometry.size[1] as u32;
            (beam.plane, beam.depth, beam.row) = (offered / rows, 0, Some(offered % rows));
            offered += 1;
        }
        let before = aligned.counters().pushes;
        bus.tick(std::slice::from_ref(setup), &mut input, &mut aligned, None);
        if aligned.counters().pushes > before {
            left.push(bus.account().cycles() - 1);
        }
        aligned.pop();
        input.commit();
        aligned.commit();
        assert!(bus.account().cycles() < 100_000, "stuck");
    }
    (left, bus)
}

#[test]
fn a_beam_waits_for_the_slices_that_its_words_need() {
    // Lanes, words, channels, slices a cycle as a fraction, and the cycles of twelve beams that follow each other.
    for (lanes, n, channels, [ticks, every]) in [
        (8, 8, 8, [1, 1]),
        (8, 8, 4, [1, 1]),
        (8, 8, 3, [1, 1]),
        (8, 8, 3, [3, 2]),
        (8, 8, 8, [1, 3]),
        (4, 8, 8, [1, 1]),
        (4, 8, 2, [2, 1]),
        (8, 5, 1, [7, 3]),
    ] {
        let bus = Bus {
            channels: Some(channels),
            clock_hz: Some(8e6 * f64::from(ticks as u32) / f64::from(every as u32)),
            ..Bus::default()
        };
        let machine = MachineSpec { lanes, bus, ..MachineSpec::default() };
        let (left, unit) = through_the_bus(&machine, [n, 1, 1], 12);
        let slices = n.div_ceil(channels) as u64;
        let lane_cycles = n.div_ceil(lanes) as u64;
        // The first beam is there in cycle 1; beams that need less than their lanes give no slice on to later ones.
        let by_slices = |beams: u64| (beams * slices * every).div_ceil(ticks);
        let bound = slices * every > lane_cycles * ticks;
        let expected: Vec<u64> =
            (1..=12).map(|beam| if bound { by_slices(beam) } else { beam * lane_cycles }).collect();
        assert_eq!(left, expected, "{n} words on {channels} channels, {ticks} slices in {every} cycles");
        let account = unit.account();
        assert_eq!(account.busy, 12 * lane_cycles);
        assert_eq!(account.waiting[Reason::BusSlice as usize], expected[11] - 12 * lane_cycles);
        assert_eq!(account.starved, 1);
        let counters = unit.counters();
        assert_eq!(counters.words, 12 * n as u64);
        assert_eq!(counters.slots, channels as u64 * (account.cycles() * ticks / every));
        assert!(counters.words <= counters.slots);
    }
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
fn a_near_eyes_beam_is_gathered_four_times_for_all_slots_and_a_far_ones_once() {
    // Voxels, lanes, distance of the eye, channels, and slices a cycle as a fraction.
    for (n, lanes, distance, channels, [ticks, every]) in [
        (8, 8, 16.0, 8, [1, 1]),
        (8, 3, 4.0, 8, [1, 1]),
        (8, 8, 3.0, 8, [1, 1]),
        (8, 8, 1.0, 8, [1, 1]),
        (9, 4, 0.5, 4, [1, 1]),
        (16, 4, 2.0, 4, [1, 1]),
        (8, 8, 2.0, 3, [1, 1]),
        (8, 4, 2.0, 8, [1, 3]),
        (8, 8, 2.0, 5, [3, 2]),
    ] {
        let bus = Bus { channels: Some(channels), clock_hz: Some(8e6 * ticks as f64 / every as f64), ..Bus::default() };
        let machine = MachineSpec { lanes, bus, ..MachineSpec::default() };
        let setup = seen_from(&machine, n, distance);
        let [slots, planes] = setup.geometry.slot_counts();
        let near = 2.0 * distance < n as f64;
        assert_eq!(setup.geometry.doubled(), near, "{distance}");
        assert!(!near || slots > n, "there are more rays than voxels");
        let (words, gathers) = if near { (slots, 4) } else { (n, 1) };
        let (left, unit) = beams_through_the_bus(&machine, &setup, 12);
        let lane_cycles = gathers * words.div_ceil(lanes);
        let slices = gathers * words.div_ceil(channels);
        let each = |beams: usize| (beams * lane_cycles).max((beams * slices * every).div_ceil(ticks)) as u64;
        let expected: Vec<u64> = (1..=12).map(each).collect();
        assert_eq!(left, expected, "n = {n}, {lanes} lanes, {channels} channels, {distance}");
        let (account, counters) = (unit.account(), unit.counters());
        assert_eq!(account.busy, 12 * lane_cycles as u64);
        assert_eq!(account.waiting[Reason::BusSlice as usize], expected[11] - account.busy);
        assert_eq!(counters.words, (12 * gathers * words) as u64);

        // The buffers take the four words of a slot at once.
        let schedule = Schedule::new(&machine, &setup.geometry);
        let cycles = [schedule.aligned_cycles(), schedule.ray_cycles()];
        assert_eq!(cycles, [words, n].map(|words| words.div_ceil(lanes) as u64));
        let shape = schedule.shape();
        assert_eq!([shape.slots, shape.planes, shape.depths], [slots, planes, n]);
        assert_eq!(shape.closes, [false; 2]);
    }
}

#[test]
fn the_ring_takes_planes_of_this_frame_and_the_next_and_of_no_third() {
    let n = 3;
    for frame_planes in 1..4 {
        for planes in 2..9 {
            let one = spec(n, frame_planes, planes as usize);
            let mut unit = DsbUnit::new([(one, NoPlanes); 4]);
            let mut aligned = Channel::<Beam<()>>::new("aligned", 2, 1).unwrap();
            // Nobody takes the rays, and so plane 0 of frame 0 stays.
            let mut rays = Channel::<RayPair<()>>::new("rays", 1, 1).unwrap();
            let mut offered = 0;
            for _ in 0..100 {
                if offered < 4 * frame_planes * n
                    && let Some(beam) = aligned.push_slot()
                {
                    let plane = offered / n;
                    (beam.frame, beam.plane, beam.depth) = (plane / frame_planes, plane % frame_planes, offered % n);
                    beam.row = Some(0);
                    offered += 1;
                }
                unit.tick(&mut aligned, &mut rays);
                aligned.commit();
                rays.commit();
            }
            // First planes are kept for two frames.
            let taken = u64::from(planes.min(2 * frame_planes) * n);
            assert_eq!(aligned.counters().pops, taken, "frames of {frame_planes}, {planes} planes");
        }
    }
}
