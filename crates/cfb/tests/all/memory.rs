//! The frame buffer with memory modules that take their time: frame rates, waits by reason, clocks.

use cube3_cases::cases;
use cube3_cfb::memory::{MemoryCounters, Supply};
use cube3_cfb::{Beam, CfbSpec, CfbUnit, NoVoxels};
use cube3_channel::{Account, Channel, Reason};
use cube3_frame::{FrameSetup, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{BankHash, Cfb, ControllerKind, Layout, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryType};
use cube3_scene::{Scene, View};
use proptest::prelude::*;
use std::sync::Arc;

/// Views whose beams run along x, y, z.
const ALONG: [[f64; 3]; 3] = [[0.3, 0.1, 1.0], [0.1, 0.3, 1.0], [0.1, 1.0, 0.3]];

fn setup(machine: &MachineSpec, n: usize, direction: [f64; 3]) -> FrameSetup {
    setup_of(machine, [n; 3], direction)
}

fn setup_of(machine: &MachineSpec, dims: [usize; 3], direction: [f64; 3]) -> FrameSetup {
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

fn machine(lanes: usize, clock_hz: f64, memory: MemoryType, layout: Layout) -> MachineSpec {
    MachineSpec { lanes, clock_hz, cfb: Cfb { memory, layout, ..Cfb::default() }, ..MachineSpec::default() }
}

/// Runs frames against a bus that takes every beam; cycles, account, and what the modules did in all frames.
fn run(machine: &MachineSpec, setup: FrameSetup, frames: usize) -> (u64, Account, MemoryCounters) {
    let specs = vec![CfbSpec::new(machine, &setup.geometry, Schedule::new(machine, &setup.geometry)); frames];
    let modules = Supply::new(machine, std::slice::from_ref(&setup)).unwrap();
    let mut cfb = CfbUnit::new(specs, NoVoxels).with_modules(modules);
    let setup = Arc::new(setup);
    let setups: Vec<Arc<FrameSetup>> = (0..frames).map(|_| Arc::clone(&setup)).collect();
    let mut beams = Channel::<Beam<()>>::new("beams", 4, 2).unwrap();
    let mut cycles = 0;
    while !cfb.done() {
        beams.pop_slot();
        cfb.tick(&setups, u32::MAX, &mut beams);
        beams.commit();
        cycles += 1;
    }
    let mut sum = MemoryCounters::default();
    cfb.memory_counters().iter().for_each(|&counters| sum += counters);
    assert_eq!(cfb.account().cycles(), cycles);
    (cycles, *cfb.account(), sum)
}

#[test]
fn vram_of_125_nanoseconds_gives_30_frames_and_a_half_of_512_cubed() {
    for (axis, direction) in ALONG.into_iter().enumerate() {
        for layout in [Layout::Rows, Layout::Blocks] {
            let machine = machine(512, 8e6, MemoryType::Vram, layout);
            let setup = setup(&machine, 512, direction);
            assert_eq!(setup.geometry.axes.axis[0], axis);
            let (cycles, account, _) = run(&machine, setup, 2);
            assert_eq!((cycles, account.busy), (2 * 512 * 512, cycles));
            let rate = machine.clock_hz / (cycles as f64 / 2.0);
            assert!((rate - 30.517).abs() < 0.001, "{rate}");
        }
    }
}

#[test]
fn a_pipeline_of_twice_the_clock_waits_every_other_cycle_for_vram() {
    let machine = machine(64, 16e6, MemoryType::Vram, Layout::Rows);
    let (cycles, account, counters) = run(&machine, setup(&machine, 64, ALONG[0]), 1);
    // Cycles 0 and 1 make the first tick of the memory; its word is there when the tick is over.
    assert_eq!((cycles, account.busy, counters.words), (2 * 64 * 64, cycles, 64 * 64 * 64));
}

#[test]
fn a_memory_clock_that_does_not_divide_the_pipelines_keeps_its_rate() {
    let mut machine = machine(64, 9e6, MemoryType::Ideal, Layout::Rows);
    machine.cfb.memory_clock_hz = Some(7e6);
    let (cycles, account, _) = run(&machine, setup(&machine, 64, ALONG[1]), 1);
    assert_eq!(cycles, (64 * 64 * 9_u64).div_ceil(7));
    assert_eq!(account.busy, cycles);
}

#[test]
fn blocks_keep_rows_open_along_every_axis_where_rows_of_voxels_do_along_one_walk() {
    let misses = |layout, direction| {
        let machine = machine(256, 8e6, MemoryType::Sdram, layout);
        let (_, _, counters) = run(&machine, setup(&machine, 256, direction), 1);
        (counters.row_misses + counters.row_conflicts) as f64 / counters.words as f64
    };
    let [x, y, z] = ALONG;
    let [rows, blocks] = [Layout::Rows, Layout::Blocks].map(|layout| [x, y, z].map(|view| misses(layout, view)));
    // A memory row of 512 words has two rows of 256.
    assert!(rows.iter().all(|&share| share > 0.5), "{rows:?}");
    // Eight words in a block, and some in the next one.
    assert!(blocks.iter().all(|&share| share < 0.17), "{blocks:?}");
    // Beams along x whose depth is along y: a module reads word behind word.
    assert!(misses(Layout::Rows, [0.3, 1.0, 0.1]) < 0.07);
}

#[test]
fn waits_for_rows_and_refresh_have_their_buckets() {
    let machine = machine(64, 60e6, MemoryType::Sdram, Layout::Rows);
    let (cycles, account, counters) = run(&machine, setup(&machine, 64, ALONG[2]), 4);
    let waiting = |reason: Reason| account.waiting[reason as usize];
    assert!(waiting(Reason::MemoryRow) > 0 && waiting(Reason::Refresh) > 0, "{account:?}");
    assert_eq!(waiting(Reason::BankConflict), 0);
    assert_eq!(account.busy + waiting(Reason::MemoryRow) + waiting(Reason::Refresh), cycles);
    assert_eq!(counters.words, 4 * 64 * 64 * 64);
    // Every module is refreshed each time that 1039 ticks of 133 MHz have passed, but for those that have just fallen due.
    let due = (cycles as f64 / 60e6 * 133e6 / 1039.0).floor() as u64;
    assert!((due - 1) * 64 <= counters.refreshes && counters.refreshes <= due * 64, "{counters:?}, {due}");
}

#[test]
fn conflicts_of_the_skew_are_counted_beside_the_waits_for_the_memory() {
    let mut slow = machine(8, 60e6, MemoryType::Sdram, Layout::Rows);
    slow.cfb.skew = [0, 1, 1];
    let ideal = MachineSpec { cfb: Cfb { memory: MemoryType::Ideal, ..slow.cfb }, ..slow.clone() };
    let (_, with_rows, counters) = run(&slow, setup(&slow, 16, ALONG[0]), 1);
    let (_, without, none) = run(&ideal, setup(&ideal, 16, ALONG[0]), 1);
    let conflict = Reason::BankConflict as usize;
    assert_eq!(with_rows.waiting[conflict], without.waiting[conflict]);
    assert_eq!((counters.words, none), (16 * 16 * 16, MemoryCounters::default()));
}

/// SDRAM behind one lane at the pipeline's clock, a volume whose words are one row of one bank.
fn in_sequence(cfb: Cfb) -> u64 {
    let mut machine = machine(1, 133e6, MemoryType::Sdram, Layout::Rows);
    machine.cfb = Cfb { memory: MemoryType::Sdram, ..cfb };
    machine.check("test").unwrap();
    run(&machine, setup_of(&machine, [512, 1, 1], [0.0, 0.0, 1.0]), 1).0
}

/// The words lie one behind another. Opening the row takes 3 ticks, a read 3, and a word is taken when its tick is over.
#[test]
fn a_look_ahead_counts_from_the_word_that_is_waited_for() {
    let words = |look_ahead| Cfb { look_ahead: Some(look_ahead), ..Cfb::default() };
    // One word: the next burst is asked for when the last word of this one has been taken, and comes three ticks later.
    assert_eq!(in_sequence(words(1)), 3 + 512 / 4 * (3 + 4));
    // With k more, so many ticks earlier; with four the bursts join.
    assert_eq!(in_sequence(words(2)), 3 + 512 / 4 * (2 + 4) + 1);
    assert_eq!(in_sequence(words(4)), 3 + 512 / 4 * 4 + 3);
    assert_eq!(in_sequence(words(64)), 3 + 512 / 4 * 4 + 3);
    // One burst: the next is asked for when the first word of this one has been taken.
    let bursts = Cfb { look_ahead_unit: LookAheadUnit::Bursts, ..words(1) };
    assert_eq!(in_sequence(bursts), 3 + 512 / 4 * 4 + 3);
    // One word that is free at its read: two words wait, as with a look-ahead of two.
    let column = Cfb { look_ahead_freed: LookAheadFreed::Column, ..words(1) };
    assert_eq!(in_sequence(column), in_sequence(words(2)));
}

/// Ways to ask ahead.
fn asking() -> impl Strategy<Value = Cfb> {
    let hash = proptest::sample::select(BankHash::TABLE.map(|row| row.hash).to_vec());
    (hash, 1_usize..12, any::<[bool; 3]>(), 1_usize..12, proptest::option::of(0_u32..4)).prop_map(
        |(bank_hash, look_ahead, [bursts, column, chooses], window, length)| Cfb {
            bank_hash,
            look_ahead: Some(look_ahead),
            look_ahead_unit: if bursts { LookAheadUnit::Bursts } else { LookAheadUnit::Words },
            look_ahead_freed: if column { LookAheadFreed::Column } else { LookAheadFreed::Word },
            controller: if chooses { ControllerKind::FrFcfs } else { ControllerKind::InOrder },
            window: Some(window.min(look_ahead)),
            burst_words: length.map(|length| 1 << length),
            ..Cfb::default()
        },
    )
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn no_memory_is_faster_than_the_ideal_one_nor_than_its_clock(
        memory in proptest::sample::select(vec![MemoryType::Ideal, MemoryType::Vram, MemoryType::FastPage, MemoryType::Sdram, MemoryType::Hbm]),
        lanes in 1_usize..10, n in 1_usize..12, direction in prop::array::uniform3(-1.0..1.0_f64), skew in prop::array::uniform3(-2_i64..3),
        clock in 1e6..2e8_f64, speed in 0.3..2.0_f64, blocks: bool, frames in 1_usize..3, asking in asking(),
    ) {
        prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
        let layout = if blocks { Layout::Blocks } else { Layout::Rows };
        let mut slow = machine(lanes, clock, memory, layout);
        let burst_words = asking.burst_words.filter(|_| memory == MemoryType::Sdram);
        slow.cfb = Cfb { skew, memory, layout, burst_words, ..asking };
        slow.cfb.memory_clock_hz = Some(slow.memory_clock_hz() * speed);
        let mut ideal = slow.clone();
        ideal.cfb = Cfb { skew, ..Cfb::default() };
        slow.check("test").unwrap();
        let setup = setup(&slow, n, direction);
        let (cycles, account, counters) = run(&slow, setup.clone(), frames);
        let (least, free, _) = run(&ideal, setup, frames);
        prop_assert!(cycles >= least && account.busy >= free.busy);
        let conflict = Reason::BankConflict as usize;
        prop_assert_eq!(account.waiting[conflict], free.waiting[conflict]);
        prop_assert_eq!(counters.words, (frames * n * n * n) as u64);
        // Each module gives at most a burst for each read.
        let ticks = cycles as f64 * slow.memory_clock_hz() / clock;
        prop_assert!(counters.reads as f64 <= (ticks + 1.0) * lanes as f64);
    }
}
