//! The data sheets of the fast bus and of the skewed buffers.
//!
//! Bus: a beam takes ⌈n_u / lanes⌉ cycles, one without voxels a cycle. Buffers: the write port takes as long for a beam, the
//! read port ⌈n_w / lanes⌉ cycles for a pair of rays; a plane can be read when it and the one below are written, from
//! the next cycle on, and gives its buffer back in the cycle in which its last ray leaves.

use cube3_cfb::Beam;
use cube3_channel::{Account, Activity, Channel, PortState, diagnose};
use cube3_dsb::bus::{BusUnit, NoBus};
use cube3_dsb::{DsbSpec, DsbUnit, NoPlanes, RayPair};
use cube3_host::{FrameSetup, MachineSpec, VolumeInfo, frame_setup};
use cube3_scene::{Scene, View};

/// Rays along z, and a little along x, so that u is x.
fn setup(machine: &MachineSpec, dims: [usize; 3]) -> FrameSetup {
    let scene = Scene { view: View::from_direction([1e-6, 0.0, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

/// A frame of `frame_planes` planes of n beams and n ray slots.
fn spec(n: u32, frame_planes: u32, planes: usize) -> DsbSpec {
    DsbSpec { planes, write_cycles: 1, read_cycles: 1, depths: n, slots: n, frame_planes, closes: false }
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

    /// One cycle; whether anything moved.
    fn tick(&mut self, drained: bool, row: impl Fn(u32) -> Option<u32>) -> bool {
        if self.offered < self.spec.frame_planes * self.spec.depths
            && let Some(beam) = self.aligned.push_slot()
        {
            (beam.plane, beam.depth) = (self.offered / self.spec.depths, self.offered % self.spec.depths);
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
        let spec = DsbSpec { write_cycles, read_cycles, ..spec(4, 3, 3) };
        let bench = Bench::new(spec, 2).run();
        // Beam m is written in cycle (m + 1)·w; the pair takes r cycles from the one after the second plane.
        assert_eq!(bench.left[0], 8 * write_cycles + read_cycles, "{write_cycles}, {read_cycles}");
        assert!(bench.left.windows(2).all(|pair| pair[1] - pair[0] >= read_cycles));
        let [write, read] = bench.unit.accounts();
        assert_eq!((write.busy, read.busy), (12 * write_cycles, 12 * read_cycles));
    }
}

#[test]
fn a_beam_without_voxels_takes_one_cycle() {
    let mut bench = Bench::new(DsbSpec { write_cycles: 4, ..spec(6, 1, 3) }, 2);
    while bench.left.is_empty() {
        bench.tick(true, |beam| (beam % 2 == 0).then_some(beam));
    }
    assert_eq!(bench.left[0], 3 * 4 + 3 + 1);
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
    assert_eq!(bench.left, []);
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
        let mut bus = BusUnit::new(&machine, [&setup.geometry], NoBus);
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
            bus.tick(std::slice::from_ref(&setup), &mut beams, &mut aligned);
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
    let mut bus = BusUnit::new(&machine, [&setup.geometry], NoBus);
    let mut beams = Channel::<Beam<()>>::new("beams", 2, 1).unwrap();
    let mut aligned = Channel::<Beam<()>>::new("aligned", 1, 1).unwrap();
    for cycle in 0..20 {
        if let Some(beam) = beams.push_slot() {
            beam.row = Some(0);
        }
        assert_eq!(bus.tick(std::slice::from_ref(&setup), &mut beams, &mut aligned).is_active(), cycle == 1);
        beams.commit();
        aligned.commit();
    }
    assert_eq!(*bus.account(), Account { busy: 1, starved: 1, blocked: 18, ..Account::default() });
}
