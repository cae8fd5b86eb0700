//! Bus, ports, planes, boards, cone and host link in the whole machine: what each limit does to the cycles of a frame, to the cycle
//! where there is a closed form.

use cube3::limits::frame_interval;
use cube3_cases::cases;
use cube3_channel::Reason;
use cube3_host::{ParallelFrame, VolumeInfo, frame_setup};
use cube3_machine::{Abc, Boards, Bus, Cone, ConeKind, Dsb, Frames, HostLink, MachineSpec, RaySlots, Rays};
use cube3_pipeline::{Machine, RunCounters};
use cube3_scene::{Scene, View};
use proptest::prelude::*;

const N: usize = 64;

fn base() -> MachineSpec {
    MachineSpec { lanes: N, ..MachineSpec::default() }
}

fn frame(machine: &MachineSpec, n: usize) -> ParallelFrame {
    let scene = Scene { view: View::from_direction([0.5, 0.25, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap()
}

/// A frame alone, with each unit's cycles accounted for; and the interval at which it follows itself.
fn run(machine: &MachineSpec) -> (RunCounters, u64) {
    let frame = frame(machine, N);
    let mut run = Machine::timing(machine, vec![frame.setup.clone()]).unwrap();
    run.run(&|_, _| {}).unwrap();
    let counters = run.counters();
    for (name, account) in &counters.units {
        assert_eq!(account.cycles(), counters.cycles, "{name}");
    }
    (counters, frame_interval(machine, std::slice::from_ref(&frame.setup)).unwrap())
}

fn waiting(counters: &RunCounters, unit: &str, reason: Reason) -> u64 {
    let (_, account) = counters.units.iter().find(|(name, _)| *name == unit).unwrap();
    account.waiting[reason as usize]
}

const SQUARE: u64 = (N * N) as u64;

#[test]
fn the_default_machine_takes_a_beam_a_cycle_and_its_bus_is_always_full() {
    let (counters, interval) = run(&base());
    assert_eq!(interval, SQUARE);
    assert_eq!(counters.bus.words, SQUARE * N as u64);
    assert_eq!(counters.bus.slots, counters.cycles * N as u64);
    assert_eq!((counters.bus.link_words, counters.ray_words), Default::default());
    let pixels = counters.host.pixels;
    let [width, height] = frame(&base(), N).setup.geometry.base_plane_size();
    // Rays at two corners of the base plane meet no voxel where a slot goes over to the next ray in both directions at once.
    assert!(pixels > SQUARE && pixels <= (width * height) as u64);
    assert_eq!(counters.host.bytes, pixels * 8);
}

#[test]
fn without_overlap_a_frame_costs_what_it_costs_alone() {
    for overlap in [false, true] {
        let (counters, interval) = run(&MachineSpec { frames: Frames { overlap }, ..base() });
        assert_eq!(interval, if overlap { SQUARE } else { counters.cycles });
    }
}

#[test]
fn a_bus_with_fewer_slices_than_a_beam_has_words_sets_the_rate() {
    for (channels, clock_hz, ticks, every) in
        [(N, 4e6, 1, 2), (N / 2, 8e6, 1, 1), (N / 4, 24e6, 3, 1), (N / 2, 16e6, 2, 1), (N, 12e6, 3, 2), (N, 7e6, 7, 8)]
    {
        let bus = Bus { channels: Some(channels), clock_hz: Some(clock_hz), ..Bus::default() };
        let (counters, interval) = run(&MachineSpec { bus, ..base() });
        let slices = (N / channels) as u64;
        let beams = (SQUARE * slices * every).div_ceil(ticks).max(SQUARE);
        // The clocks meet again at every frame's start, to a cycle.
        assert!(interval.abs_diff(beams) <= 1, "{channels} channels at {clock_hz} Hz: {interval}, not {beams}");
        assert_eq!(waiting(&counters, "bus", Reason::BusSlice) + SQUARE, beams, "{channels} at {clock_hz}");
    }
}

#[test]
fn two_three_and_four_planes_with_one_port_and_two() {
    let mut table = Vec::new();
    for planes in [2, 3, 4] {
        for ports in [1, 2] {
            let machine = MachineSpec { dsb: Dsb { planes, ports }, ..base() };
            let (counters, interval) = run(&machine);
            let port = waiting(&counters, "dsb.write", Reason::Port);
            println!("{planes} planes, {ports} ports: {} cycles, interval {interval}, {port} waited", counters.cycles);
            table.push((planes, ports, interval));
            assert_eq!(port > 0, ports == 1);
        }
    }
    let interval = |planes, ports| table.iter().find(|row| (row.0, row.1) == (planes, ports)).unwrap().2;
    // Written and read in turn, each plane takes both.
    assert_eq!([interval(3, 2), interval(4, 2)], [SQUARE; 2]);
    assert_eq!([interval(3, 1), interval(4, 1)], [2 * SQUARE; 2]);
    // Two buffers take turns, too, but that with two ports a plane's last ray leaves while the next plane's first beam comes, and the
    // last plane is read together with the first, which is kept: no turn for it.
    let n = N as u64;
    assert_eq!([interval(2, 1), interval(2, 2)], [2 * SQUARE, (n - 1) * (2 * n - 1) + n]);
}

#[test]
fn three_planes_of_samples_run_slower_and_two_cannot() {
    let with = |planes| MachineSpec { abc: Abc { planes, ..Abc::default() }, ..base() };
    let intervals = [3, 4, 5].map(|planes| run(&with(planes)).1);
    println!("sample planes 3, 4, 5: {intervals:?}");
    // Slots close along u: the first ray of a plane is shaded last, after its neighbours, and the input stands for two cycles a plane
    // but for the first and the last, whose samples are kept.
    assert_eq!(intervals, [SQUARE + 2 * (N as u64 - 2), SQUARE, SQUARE]);
    let machine = with(2);
    let mut run = Machine::timing(&machine, vec![frame(&machine, N).setup]).unwrap();
    let text = run.run(&|_, _| {}).unwrap_err().to_string();
    assert!(text.ends_with("abc waits for abc: sample planes is full (2 of 2); which closes the circle"), "{text}");
}

#[test]
fn each_kind_of_cone_sets_its_rate_and_its_drain() {
    let with = |kind| {
        let mut machine = MachineSpec { cone: Cone { kind }, ..base() };
        machine.channel.pixels = cube3_machine::ChannelSize::pipelined(7);
        machine
    };
    let (folded, _) = run(&with(ConeKind::FoldedTree));
    for (kind, latency) in [(ConeKind::FoldedTree, 7), (ConeKind::ShiftedTree, 13), (ConeKind::Chain, 64)] {
        let (counters, interval) = run(&with(kind));
        assert_eq!(interval, SQUARE, "{kind:?}");
        assert_eq!(counters.cycles - folded.cycles, latency - 7, "{kind:?}");
    }
    let (counters, interval) = run(&with(ConeKind::Accumulator));
    assert_eq!(interval, SQUARE * N as u64, "a sample a cycle");
    let (_, cfb) = counters.units[0];
    // The buffers let the memory run ahead by the planes that they hold: three of voxels and four of samples, of 64.
    assert!(cfb.blocked > 55 * SQUARE, "{}", cfb.blocked);
}

#[test]
fn a_slow_host_stops_the_machine_right_through_to_the_memory() {
    for rate in [1.0, 0.3, 4.0, 7.5] {
        let machine = MachineSpec { host_link: HostLink { bytes_per_cycle: Some(rate) }, ..base() };
        let (counters, interval) = run(&machine);
        // Eight bytes of a pixel and more: no slot is sent in part of a cycle, and the link never rests.
        let exact = counters.host.bytes as f64 / rate;
        assert!((interval as f64 - exact).abs() <= 1.0, "{rate}: {interval}, not {exact}");
        for unit in ["cfb", "bus", "dsb.read", "trilin", "abc", "cone"] {
            let (_, account) = counters.units.iter().find(|(name, _)| *name == unit).unwrap();
            assert!(account.blocked > 0, "{unit} at {rate} bytes a cycle");
        }
        let (_, host) = counters.units[7];
        assert_eq!(host.busy, SQUARE);
        assert!(host.waiting[Reason::Host as usize] + SQUARE >= exact as u64);
    }
    let fast = MachineSpec { host_link: HostLink { bytes_per_cycle: Some(24.0) }, ..base() };
    let (counters, interval) = run(&fast);
    assert_eq!((counters.cycles, interval), (run(&base()).0.cycles, SQUARE), "three pixels fit a cycle");
}

#[test]
fn boards_cost_their_links() {
    let (alone, _) = run(&base());
    let with = |count, rate, latency| MachineSpec {
        boards: Boards { count, link_words_per_cycle: rate, link_latency_cycles: latency, ..Boards::default() },
        ..base()
    };
    // Bus to the farthest board, TRILIN and ABC to the next, cone over 1 + 2 + 4 links: the rate is what it was.
    for (count, hops) in [(2, 1 + 1 + 1 + 1), (8, 4 + 1 + 1 + 7)] {
        let (counters, interval) = run(&with(count, None, 3));
        assert_eq!(interval, SQUARE);
        assert_eq!(counters.cycles - alone.cycles, 3 * hops, "{count} boards");
        assert_eq!(counters.bus.link_peak, N as u64 / 2);
    }
    // Links of four words a cycle. 64 rotations, as often each: min(r, 64 − r) words of a beam over each link, forwards as often as backwards; and
    // of a ray over each link two words each way for TRILIN, one for the 12-sample gradient, and 12 of its nodes on the average: those of
    // five levels back and of the root on.
    let (counters, interval) = run(&with(8, Some(4.0), 1));
    let cycles =
        |r: u64| if r < 33 { (r + 2 + 1 + 10) as f64 / 4.0 } else { ((N as u64 - r) + 2 + 1 + 2) as f64 / 4.0 };
    let mean = (0..N as u64).map(|r| cycles(r).max(1.0)).sum::<f64>() / N as f64;
    let measured = interval as f64 / SQUARE as f64;
    // The few beams on their way when the way round changes, once or twice in a plane, use both directions at once.
    assert!((0.95..=1.0).contains(&(measured / mean)), "{measured} cycles a beam, not {mean}");
    assert!(waiting(&counters, "dsb.write", Reason::Link) > 2 * SQUARE);
    assert_eq!(counters.bus.link_words, 8 * N as u64 * (0..N as u64).map(|r| r.min(N as u64 - r)).sum::<u64>());
    let words = counters.ray_words;
    assert_eq!([words.trilin, words.abc, words.cone], [2 * 2 * 8, 2 * 8, 12 * 8].map(|ray| ray * SQUARE));
}

/// Where both lack, slices are booked: what they cost is the same as without links of a width, and what links cost is beside it.
#[test]
fn slices_are_booked_as_without_links_where_both_are_scarce() {
    let machine = |channels, clock_hz, link_words_per_cycle| MachineSpec {
        bus: Bus { channels: Some(channels), clock_hz: Some(clock_hz), ..Bus::default() },
        boards: Boards { count: 8, link_words_per_cycle, link_capacity_words: 8, ..Boards::default() },
        ..base()
    };
    for (channels, clock_hz, each) in [(N / 2, 8e6, 2), (N, 4e6, 2), (N / 4, 16e6, 2), (N / 8, 8e6, 8)] {
        let (any, _) = run(&machine(channels, clock_hz, None));
        let (narrow, _) = run(&machine(channels, clock_hz, Some(4.0)));
        let slices = [&any, &narrow].map(|counters| waiting(counters, "bus", Reason::BusSlice));
        assert_eq!(slices, [SQUARE * (each - 1); 2], "{channels} channels at {clock_hz} Hz");
        assert_eq!(waiting(&any, "bus", Reason::Link), 0);
        let (_, account) = narrow.units.iter().find(|(name, _)| *name == "bus").unwrap();
        assert!(account.waiting[Reason::Link as usize] > SQUARE / 4, "{account:?}");
        let all = account.busy + account.starved + account.blocked + slices[1] + account.waiting[Reason::Link as usize];
        assert_eq!((account.busy, all), (any.units[1].1.busy, narrow.cycles));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(40) })]

    #[test]
    fn the_slowest_resource_sets_the_rate(
        n in 4_usize..20, channels in 1_usize..20, bytes in prop_oneof![0.5..8.0_f64, 24.0..90.0_f64], padded: bool,
    ) {
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let machine = MachineSpec {
            lanes: n,
            rays: Rays { slots, ..Rays::default() },
            bus: Bus { channels: Some(channels), ..Bus::default() },
            host_link: HostLink { bytes_per_cycle: Some(bytes) },
            ..MachineSpec::default()
        };
        let frame = frame(&machine, n);
        let interval = frame_interval(&machine, std::slice::from_ref(&frame.setup)).unwrap();
        let [slots, planes] = frame.setup.geometry.slot_counts().map(|n| n as u64);
        let empty = planes * n as u64 - (n * n) as u64;
        let beams = (n * n) as u64 * (n.div_ceil(channels) as u64).max(1) + empty;
        let mut run = Machine::timing(&machine, vec![frame.setup]).unwrap();
        run.run(&|_, _| {}).unwrap();
        let host = run.counters().host.bytes as f64 / bytes;
        let bound = (beams.max(slots * planes) as f64).max(host);
        // No resource is outrun.
        prop_assert!(interval as f64 >= bound - 1.0, "{} < {}", interval, bound);
        if !padded {
            // Where every frame has one beam and one slot in turn, the slowest is all that counts: but for the start and end of planes.
            prop_assert!(interval as f64 <= bound + 4.0 * n as f64 + 2.0, "{} > {}", interval, bound);
        }
    }
}
