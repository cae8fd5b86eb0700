//! What machines are made of, and what limits them.

use cube3::limits::{frame_interval, limits};
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::OperatorCounts;
use cube3_machine::{
    Abc, Boards, Bus, Cfb, ControllerKind, GradientMethod, HostLink, LookAheadFreed, LookAheadUnit, MachineSpec,
    MemoryType, RayEnds, RaySlots, Rays, Reuse, Trilin,
};
use cube3_pipeline::{Machine, RunCounters};
use cube3_report::ResourcesReport;
use cube3_resources::resources;
use cube3_scene::{Scene, View};
use cube3_word::{Rounding, Words};

fn setup(machine: &MachineSpec, n: usize) -> FrameSetup {
    let scene = Scene { view: View::from_direction([0.5, 0.25, 1.0], None), ..Scene::default() };
    let volume = VolumeInfo { dims: [n; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

fn count(machine: &MachineSpec, n: usize) -> (ResourcesReport, RunCounters) {
    let frames = vec![setup(machine, n)];
    let mut run = Machine::timing(machine, frames.clone()).unwrap();
    run.run(&|_, _| {}).unwrap();
    let counters = run.counters();
    let interval = frame_interval(machine, &frames).unwrap();
    (resources(machine, [n; 3], &frames, &counters, interval), counters)
}

fn part(report: &ResourcesReport, name: &str) -> OperatorCounts {
    report.operators.iter().find(|part| part.part == name).map(|part| part.each.times(part.count)).unwrap_or_default()
}

/// Section 3 of the paper: seven lerps, and fewer where neighbours share them. Each is one multiplier.
#[test]
fn interpolators_have_a_multiplier_for_each_lerp() {
    for (reuse, lerps) in [(Reuse::None, 7), (Reuse::Ray, 5), (Reuse::Plane, 4), (Reuse::Both, 3)] {
        for (rounding, adders) in [(Rounding::Nearest, 3), (Rounding::Truncate, 2)] {
            let machine = MachineSpec {
                lanes: 16,
                trilin: Trilin { reuse },
                words: Words { rounding, ..Words::default() },
                ..MachineSpec::default()
            };
            let trilin = part(&count(&machine, 16).0, "trilin");
            assert_eq!((trilin.multipliers, trilin.adders), (16 * lerps, 16 * lerps * adders));
        }
    }
}

#[test]
fn gradients_have_the_operators_of_their_formulas() {
    use GradientMethod::*;
    let expected = [
        (Six, 0, 3),
        (TwentySix, 0, 51),
        (Ten, 4, 15),
        (TenNormalised, 4, 15),
        (Twelve, 6, 21),
        (SixSheared, 2, 6),
        (TwentySixSheared, 2, 54),
    ];
    for (gradient, multipliers, adders) in expected {
        let machine = MachineSpec { lanes: 8, abc: Abc { gradient, ..Abc::default() }, ..MachineSpec::default() };
        let found = part(&count(&machine, 8).0, "abc: gradient");
        assert_eq!((found.multipliers, found.adders), (8 * multipliers, 8 * adders), "{gradient:?}");
    }
}

/// A divider for each of 18 half-spaces at both ends of up to three rays of a slot, and a table for each 32nd of a step up to four.
#[test]
fn exact_ends_have_their_dividers_and_tables() {
    let count_of = |ends, slots| {
        let machine = MachineSpec { lanes: 8, rays: Rays { ends, slots, ..Rays::default() }, ..MachineSpec::default() };
        let report = count(&machine, 8).0;
        let tables = report.memory.iter().find(|memory| memory.what == "tables").unwrap().bits;
        (part(&report, "abc: ends of rays").dividers, report.total.dividers, tables)
    };
    let (none, all, published) = count_of(RayEnds::Published, RaySlots::Wrapped);
    assert_eq!([none, all], [0, 0]);
    let (wrapped, all, exact) = count_of(RayEnds::Exact, RaySlots::Wrapped);
    assert_eq!([wrapped, all], [6 * 18, 6 * 18]);
    assert_eq!(exact - published, 8 * 129 * 4096 * 12);
    assert_eq!(count_of(RayEnds::Exact, RaySlots::Padded).0, 2 * 18);
}

#[test]
fn memory_is_what_the_buffers_hold() {
    let machine = MachineSpec { lanes: 32, ..MachineSpec::default() };
    let (report, _) = count(&machine, 32);
    let bits = |what: &str| report.memory.iter().find(|memory| memory.what == what).unwrap().bits;
    assert_eq!(bits("frame buffer"), 32 * 32 * 32 * 16);
    // Three planes, and the first one of two frames.
    assert_eq!(bits("skewed buffers"), 5 * 32 * 32 * 16);
    // Four planes, and the first two of two frames.
    assert_eq!(bits("sample planes"), 8 * 32 * 32 * 16);
    // Two rays and the first pair of a plane; a plane of lerps.
    assert_eq!(bits("lerps kept"), (4 * 32 + 32 * 32) * 16);
}

/// The reorder buffer holds the words of two voxel rows at two depths for each pair of depths, and what is asked for ahead; its words go in at the
/// modules' rate and out at the pipeline's.
#[test]
fn mini_blocks_have_a_reorder_buffer() {
    let n = 32_u64;
    let preset = cube3_inputs::machine("em-cube").unwrap();
    let (report, counters) = count(&preset, n as usize);
    let reorder = counters.reorder.unwrap();
    let bits = report.memory.iter().find(|memory| memory.what == "reorder buffer").unwrap().bits;
    assert_eq!(bits, 16 * reorder.words);
    // A plane of the volume twice at most, twice where reading goes on at one rate; two rows, and 16 bursts of 8 of four modules.
    let most = 4 * n * n + 2 * 4 * n + 16 * 8 * 4;
    assert!((n * n..=most).contains(&reorder.words) && reorder.peak_words <= reorder.words, "{reorder:?}");
    let [into, out] = [0, 1].map(|i| &report.interfaces[i]);
    assert_eq!([into.name.as_str(), &out.name], ["memory to reorder buffer", "reorder buffer to bus"]);
    assert_eq!((into.peak_bytes_per_s, out.peak_bytes_per_s), (Some(1e9), Some(1e9)));
    let more = counters.memory[0].words as f64 / (n * n * n) as f64;
    assert!((1.0..1.04).contains(&more) && (into.mean_bytes_per_s / out.mean_bytes_per_s / more - 1.0).abs() < 1e-9);
    let small = MachineSpec { cfb: Cfb { reorder_words: Some(1024), ..preset.cfb }, ..preset };
    let error = Machine::timing(&small, vec![setup(&small, n as usize)]).err().unwrap().to_string();
    assert!(error.starts_with("cfb.reorder_words = 1024 is too small for this view: a beam needs "), "{error}");
}

/// A module that chooses among its words holds those that it has been asked for.
#[test]
fn modules_that_choose_have_reorder_buffers() {
    let bits = |cfb: Cfb| {
        let machine =
            MachineSpec { lanes: 32, cfb: Cfb { memory: MemoryType::Sdram, ..cfb }, ..MachineSpec::default() };
        let (report, _) = count(&machine, 8);
        report.memory.iter().find(|memory| memory.what == "reorder buffers of the modules").map(|memory| memory.bits)
    };
    let chooses = Cfb { controller: ControllerKind::FrFcfs, ..Cfb::default() };
    assert_eq!(bits(Cfb::default()), None);
    assert_eq!(bits(chooses), Some(32 * 8 * 16), "the table's look-ahead");
    let bursts = Cfb { look_ahead: Some(4), look_ahead_unit: LookAheadUnit::Bursts, ..chooses };
    assert_eq!(bits(bursts), Some(32 * 4 * 4 * 16), "four bursts of four words");
    let column = Cfb { look_ahead: Some(4), look_ahead_freed: LookAheadFreed::Column, ..chooses };
    assert_eq!(bits(column), Some(32 * 2 * 4 * 16), "four to be read, four that wait");
}

/// Section 5: 512 modules of 16 bits with a cycle of 127 ns are 8.06 GB/s, and as many samples a second as words.
#[test]
fn the_papers_memory_bandwidth() {
    let machine = MachineSpec { lanes: 512, clock_hz: 1.0 / 127e-9, ..MachineSpec::default() };
    let (report, counters) = count(&machine, 512);
    let memory = &report.interfaces[0];
    assert!((memory.peak_bytes_per_s.unwrap() / 8.063e9 - 1.0).abs() < 1e-3);
    let carried = counters.beams as f64 * 1024.0 / (counters.cycles as f64 * 127e-9);
    assert!((memory.mean_bytes_per_s / carried - 1.0).abs() < 1e-12);
    let fps = machine.clock_hz / (512.0 * 512.0);
    assert!((report.fps_per_memory_gb_per_s / (fps / 8.063) - 1.0).abs() < 1e-3);
    let samples = setup(&machine, 512).geometry.sample_count() as f64;
    let each = samples * fps / report.total.multipliers as f64;
    assert!((report.samples_per_s_per_multiplier / each - 1.0).abs() < 1e-9);
}

#[test]
fn a_machine_that_never_waits_is_limited_by_its_pipeline() {
    let machine = MachineSpec { lanes: 16, ..MachineSpec::default() };
    let frames = [setup(&machine, 16)];
    let interval = frame_interval(&machine, &frames).unwrap();
    assert_eq!(interval, 256);
    let found = limits(&machine, &frames, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next, found.fps_without), ("pipeline", None, None));
    assert!(found.without.is_empty(), "nothing is in the way that could be taken out of it");
    assert!(found.sentence.starts_with("pipeline: 31250.0 frames/s"), "{}", found.sentence);
}

#[test]
fn a_bad_skew_makes_the_memory_critical_and_then_the_pipeline_limits() {
    let cfb = Cfb { skew: [4, 1, 1], ..Cfb::default() };
    let machine = MachineSpec { lanes: 16, cfb, ..MachineSpec::default() };
    let frames = [setup(&machine, 16)];
    let interval = frame_interval(&machine, &frames).unwrap();
    assert_eq!(interval, 4 * 256);
    let found = limits(&machine, &frames, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next.as_deref()), ("memory", Some("pipeline")));
    assert!((found.fps_without.unwrap() / found.fps - 4.0).abs() < 1e-12);
    assert_eq!(found.sentence, "memory: 7812.5 frames/s; without it 31250.0, then the pipeline limits");
}

#[test]
fn of_two_limits_the_slower_is_critical_and_the_other_limits_then() {
    let machine = MachineSpec {
        lanes: 16,
        cfb: Cfb { skew: [4, 1, 1], ..Cfb::default() },
        // A pixel of eight bytes in two cycles.
        host_link: HostLink { bytes_per_cycle: Some(4.0) },
        rays: Rays { slots: RaySlots::Padded, ..Rays::default() },
        ..MachineSpec::default()
    };
    let frames = [setup(&machine, 16)];
    let found = limits(&machine, &frames, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next.as_deref()), ("memory", Some("host")), "{}", found.sentence);
}

/// Each interface by its tokens: what one holds, how many there were, and how many a cycle there can be.
#[test]
fn every_interface_carries_what_its_tokens_hold() {
    let boards = Boards { count: 2, link_words_per_cycle: Some(8.0), ..Boards::default() };
    let host_link = HostLink { bytes_per_cycle: Some(24.0) };
    let clock_hz = MachineSpec::default().clock_hz;
    let bus = Bus { channels: Some(8), clock_hz: Some(4.0 * clock_hz), ..Bus::default() };
    let cfb = Cfb { memory_clock_hz: Some(2.0 * clock_hz), ..Cfb::default() };
    // A sample is longer than a voxel.
    let words = Words { sample_fraction_bits: 8, ..Words::default() };
    let machine = MachineSpec { lanes: 16, words, cfb, boards, host_link, bus, ..MachineSpec::default() };
    let (report, counters) = count(&machine, 16);
    let words = &machine.words;
    let [voxel, sample] = [words.voxel_bits, words.sample_bits()].map(|bits| f64::from(bits) / 8.0);
    let colour = f64::from(3 * words.colour_bits + words.opacity_bits) / 8.0;
    let pixel = f64::from(4 * words.accumulator_bits.div_ceil(8));
    // 16 planes of 16 slots, each of 16 samples; a pixel for each ray that meets a voxel.
    let geometry = setup(&machine, 16).geometry;
    let (first, [width, height]) = (geometry.first_ray(), geometry.base_plane_size());
    let meets = |u: i64, v: i64| (0..16).any(|k| geometry.column_at(u, k).is_some() && geometry.row_at(v, k).is_some());
    let rows = first.v..first.v + height as i64;
    let pixels = rows
        .flat_map(|v| (first.u..first.u + width as i64).map(move |u| [u, v]))
        .filter(|[u, v]| meets(*u, *v))
        .count();
    let samples = 16.0_f64.powi(3);
    let carried: f64 = counters.links.iter().map(|link| link.carried() as f64).sum();
    assert!(carried > 0.0);
    let expected = [
        ("memory to bus", Some(2.0 * 16.0 * voxel), samples * voxel),
        ("bus to buffers", Some(4.0 * 8.0 * voxel), samples * voxel),
        ("buffers to interpolation", Some(2.0 * 16.0 * voxel), 2.0 * samples * voxel),
        ("interpolation to shading", Some(16.0 * sample), samples * sample),
        ("shading to cone", Some(16.0 * colour), samples * colour),
        ("cone to host", Some(24.0), pixels as f64 * pixel),
        ("links between boards", Some(2.0 * 2.0 * 8.0 * voxel), carried * voxel),
    ];
    let seconds = counters.cycles as f64 / machine.clock_hz;
    let names: Vec<&str> = report.interfaces.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, expected.map(|(name, ..)| name));
    for ((name, peak, bytes), row) in expected.into_iter().zip(&report.interfaces) {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(row.mean_bytes_per_s, bytes / seconds), "{name}: {} bytes/s", row.mean_bytes_per_s);
        assert!(close(row.peak_bytes_per_s.unwrap(), peak.unwrap() * machine.clock_hz), "{name}");
    }
}

/// Each group of data lines by what it carries in a cycle.
#[test]
fn every_group_of_lines_is_as_wide_as_what_it_carries() {
    let boards = Boards { count: 4, link_words_per_cycle: Some(2.5), ..Boards::default() };
    let host_link = HostLink { bytes_per_cycle: Some(3.5) };
    let bus = Bus { channels: Some(10), ..Bus::default() };
    let machine = MachineSpec { lanes: 16, boards, host_link, bus, ..MachineSpec::default() };
    let voxel = u64::from(machine.words.voxel_bits);
    let of = |machine: &MachineSpec| -> Vec<(String, u64)> {
        count(machine, 16).0.lines.into_iter().map(|row| (row.what, row.lines)).collect()
    };
    let row = |what: &str, lines: u64| (what.to_owned(), lines);
    // Links of 3 words in two directions, two at each board; a share of the bus rounded up.
    let expected = [
        row("bus lines", 10 * voxel),
        row("link lines", 4 * 2 * 3 * voxel),
        row("pins of a board", (10 * voxel).div_ceil(4) + 2 * 2 * 3 * voxel + 32),
        row("host lines", 32),
    ];
    assert_eq!(of(&machine), expected);
    let whole = MachineSpec { lanes: 16, ..MachineSpec::default() };
    let pixel = 4 * 8 * u64::from(whole.words.accumulator_bits.div_ceil(8));
    assert_eq!(of(&whole), [row("bus lines", 16 * voxel), row("host lines", pixel)]);
}
