//! The data sheets' sentences, each at its tick and one before; closed forms; and every command of random runs against the table.

use super::{MemoryCounters, Module, Timing};
use Command::{Activate, Precharge, Read, Refresh, Write};
use cube3_cases::cases;
use cube3_machine::{BurstOrder, Command, Constraint, MemoryModel, MemoryType, Scope};
use proptest::prelude::*;

fn timing(kind: MemoryType) -> Timing {
    let model = MemoryModel::of(kind);
    Timing::new(model, model.clock_hz.unwrap())
}

/// Issues `from` to bank 0 at tick 1000, on a module that has done nothing: `to` is too early a tick before `ticks`, and ready on it.
fn assert_tight(kind: MemoryType, from: Command, to: Command, bank: usize, ticks: i64) {
    let timing = timing(kind);
    let mut module = Module::new(&timing);
    module.issue(&timing, from, 0, 1000, 0);
    assert!(!module.ready(&timing, to, bank, 1000 + ticks - 1), "{kind:?}: {from:?} to {to:?} at {}", ticks - 1);
    assert!(module.ready(&timing, to, bank, 1000 + ticks), "{kind:?}: {from:?} to {to:?} at {ticks}");
}

#[test]
fn vram_takes_any_address_every_125_nanoseconds() {
    assert_tight(MemoryType::Vram, Read, Read, 0, 1);
    assert_tight(MemoryType::Vram, Write, Write, 0, 1);
    let twice = Timing::new(MemoryModel::of(MemoryType::Vram), 16e6);
    let mut module = Module::new(&twice);
    module.issue(&twice, Read, 0, 10, 0);
    assert!(!module.ready(&twice, Read, 0, 11) && module.ready(&twice, Read, 0, 12));
    assert!(module.ready(&twice, Write, 0, 10), "the other port");
}

#[test]
fn fast_page_keeps_to_its_data_sheet_in_ticks_of_5_nanoseconds() {
    let tight = |from, to, ticks| assert_tight(MemoryType::FastPage, from, to, 0, ticks);
    tight(Activate, Read, 9);
    tight(Activate, Write, 9);
    tight(Read, Read, 7);
    tight(Write, Write, 7);
    tight(Read, Write, 7);
    tight(Write, Read, 7);
    tight(Read, Precharge, 3);
    tight(Write, Precharge, 3);
    tight(Activate, Precharge, 12);
    tight(Precharge, Activate, 8);
    tight(Precharge, Refresh, 8);
    tight(Activate, Activate, 22);
    tight(Activate, Refresh, 22);
    tight(Refresh, Activate, 22);
    tight(Refresh, Refresh, 22);
}

#[test]
fn sdram_keeps_to_its_data_sheet_in_ticks_of_7_and_a_half_nanoseconds() {
    let same = |from, to, ticks| assert_tight(MemoryType::Sdram, from, to, 0, ticks);
    let other = |from, to, ticks| assert_tight(MemoryType::Sdram, from, to, 1, ticks);
    same(Activate, Read, 3);
    same(Activate, Write, 3);
    same(Read, Read, 4);
    other(Read, Read, 4);
    other(Write, Write, 4);
    other(Read, Write, 8);
    other(Write, Read, 4);
    same(Read, Precharge, 4);
    same(Write, Precharge, 5);
    same(Activate, Precharge, 6);
    same(Precharge, Activate, 3);
    other(Precharge, Refresh, 3);
    same(Activate, Activate, 9);
    other(Activate, Activate, 2);
    other(Activate, Refresh, 9);
    other(Refresh, Activate, 9);
    other(Refresh, Refresh, 9);
}

#[test]
fn hbm_keeps_to_its_data_sheet_in_ticks_of_2_nanoseconds() {
    let same = |from, to, ticks| assert_tight(MemoryType::Hbm, from, to, 0, ticks);
    let group = |from, to, ticks| assert_tight(MemoryType::Hbm, from, to, 4, ticks);
    let other = |from, to, ticks| assert_tight(MemoryType::Hbm, from, to, 1, ticks);
    same(Activate, Read, 7);
    same(Activate, Write, 6);
    group(Read, Read, 3);
    other(Read, Read, 2);
    group(Write, Write, 3);
    other(Write, Write, 2);
    other(Read, Write, 7);
    group(Write, Read, 10);
    other(Write, Read, 8);
    same(Read, Precharge, 7);
    same(Write, Precharge, 14);
    same(Activate, Precharge, 17);
    same(Precharge, Activate, 7);
    other(Precharge, Refresh, 7);
    same(Activate, Activate, 24);
    group(Activate, Activate, 5);
    other(Activate, Activate, 4);
    other(Activate, Refresh, 24);
    other(Refresh, Activate, 80);
    other(Refresh, Refresh, 80);
}

#[test]
fn hbm_opens_four_rows_in_40_nanoseconds_and_no_fifth() {
    let timing = timing(MemoryType::Hbm);
    let mut module = Module::new(&timing);
    for bank in 0..4 {
        let tick = 1000 + 4 * bank as i64;
        assert!(module.ready(&timing, Activate, bank, tick));
        module.issue(&timing, Activate, bank, tick, 0);
    }
    assert!(!module.ready(&timing, Activate, 5, 1019));
    assert!(module.ready(&timing, Activate, 5, 1020));
}

/// Each constraint of each row alone, whatever stands beside it.
#[test]
fn every_constraint_of_the_table_is_tight_by_itself() {
    for model in MemoryModel::TABLE {
        for &constraint in model.constraints {
            let one: &'static [Constraint] = Box::leak(Box::new([constraint]));
            let clock = model.clock_hz.unwrap_or(8e6);
            let timing = Timing::new(&MemoryModel { constraints: one, ..model }, clock);
            let ticks = constraint.span.ceil(clock, model.burst_ticks()) as i64;
            let groups = timing.groups;
            for bank in 0..timing.banks() {
                let mut module = Module::new(&timing);
                for i in 0..constraint.nth {
                    module.issue(&timing, constraint.from, 0, 1000 + i as i64, 0);
                }
                let held = match constraint.scope {
                    Scope::Bank => bank == 0,
                    Scope::Group => bank % groups == 0,
                    Scope::Module => true,
                };
                let behind = 1000 + constraint.nth as i64;
                let earliest = module.free(&timing, constraint.to, bank, behind);
                let expected = if held { behind.max(1000 + ticks) } else { behind };
                assert_eq!(earliest, expected, "{} {constraint:?}, bank {bank}", model.name);
            }
        }
    }
}

#[test]
fn a_word_comes_the_latency_behind_its_read_and_the_burst_behind_it() {
    let timing = timing(MemoryType::Sdram);
    let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
    let ready: Vec<i64> = (0..6).map(|a| module.read(&timing, timing.place(a), 0, &mut counters).ready).collect();
    // ACT at 0, RD at 3 and 7, CAS latency 3.
    assert_eq!(ready, [6, 7, 8, 9, 10, 11]);
    let commands: Vec<_> = module.log.iter().map(|&(command, _, tick)| (command, tick)).collect();
    assert_eq!(commands, [(Activate, 0), (Read, 3), (Read, 7)]);
    assert_eq!((counters.words, counters.reads, counters.row_misses, counters.row_hits), (6, 2, 1, 1));
}

#[test]
fn a_burst_starts_at_the_word_asked_for_interleaved_or_in_sequence() {
    let from = |order, burst, start: u64| -> Vec<i64> {
        let model = MemoryModel { burst, burst_order: order, ..*MemoryModel::of(MemoryType::Sdram) };
        let timing = Timing::new(&model, 133e6);
        let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
        module.read(&timing, timing.place(start), 0, &mut counters);
        (0..burst as u64).map(|a| module.read(&timing, timing.place(a), 0, &mut counters).ready - 6).collect()
    };
    let [interleaved, sequential] = [BurstOrder::Interleaved, BurstOrder::Sequential].map(Some);
    // The place of words 0, 1, 2, …; Micron's burst definition lists the words by place: 3-2-1-0 and 3-0-1-2, 5-4-7-6-1-0-3-2 and 5-6-7-0-1-2-3-4.
    assert_eq!(from(interleaved, 4, 3), [3, 2, 1, 0]);
    assert_eq!(from(sequential, 4, 3), [1, 2, 3, 0]);
    assert_eq!(from(interleaved, 8, 5), [5, 4, 7, 6, 1, 0, 3, 2]);
    assert_eq!(from(sequential, 8, 5), [3, 4, 5, 6, 7, 0, 1, 2]);
    assert_eq!(from(None, 4, 3), [0, 1, 2, 3], "from its first word");
}

#[test]
fn sdram_keeps_to_its_data_sheet_in_bursts_of_every_length() {
    for burst in [1, 2, 4, 8] {
        let model = MemoryModel { burst, ..*MemoryModel::of(MemoryType::Sdram) };
        let timing = Timing::new(&model, 133e6);
        let words = burst as i64;
        // tCCD of a tick and the burst; CL 3 and a tick to turn round; tCDL; PRE CL − 1 before the last word; tWR 2 from the last word.
        let spans = [(Read, Read, words), (Read, Write, words + 4), (Write, Read, words), (Write, Write, words)];
        for (from, to, ticks) in spans.into_iter().chain([(Read, Precharge, words), (Write, Precharge, words + 1)]) {
            let mut module = Module::new(&timing);
            module.issue(&timing, from, 0, 1000, 0);
            assert!(!module.ready(&timing, to, 0, 1000 + ticks - 1), "{from:?} to {to:?}, {burst} words");
            assert!(module.ready(&timing, to, 0, 1000 + ticks), "{from:?} to {to:?}, {burst} words");
        }
    }
}

#[test]
fn an_activate_goes_into_a_gap_that_keeps_its_distance_on_both_sides() {
    let timing = timing(MemoryType::Sdram);
    let mut module = Module::new(&timing);
    module.issue(&timing, Activate, 0, 1000, 0);
    module.issue(&timing, Activate, 1, 1004, 0);
    // tRRD of 2 from both.
    let ready: Vec<i64> = (1001..1008).filter(|&tick| module.ready(&timing, Activate, 2, tick)).collect();
    assert_eq!(ready, [1002, 1006, 1007]);
    module.issue(&timing, Activate, 2, 1002, 0);
    assert!(!module.ready(&timing, Activate, 3, 1003) && module.ready(&timing, Activate, 3, 1006));
    assert!(module.ready(&timing, Activate, 3, 998), "before all of them");
}

#[test]
fn a_written_word_is_read_again_and_not_taken_from_the_output() {
    let timing = timing(MemoryType::Sdram);
    let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
    module.read(&timing, timing.place(0), 0, &mut counters);
    assert_eq!(module.write(&timing, timing.place(1), 0, &mut counters).ready, 3 + 8);
    assert_eq!(module.read(&timing, timing.place(1), 0, &mut counters).ready, 11 + 4 + 3, "the burst starts there");
    assert_eq!((counters.reads, counters.writes, counters.row_hits), (2, 1, 2));
}

#[test]
fn a_refresh_that_is_due_goes_before_the_next_word() {
    let timing = timing(MemoryType::Sdram);
    let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
    module.read(&timing, timing.place(0), 0, &mut counters);
    module.read(&timing, timing.place(4), 1038, &mut counters);
    let late = module.read(&timing, timing.place(8), 1039, &mut counters);
    // Due at 1039; RD at 1038 keeps the bank open until 1042; PRE, REF 3 ticks later, ACT 9 after that.
    assert_eq!(module.log[3..6], [(Precharge, 0, 1042), (Refresh, 0, 1045), (Activate, 0, 1054)]);
    assert_eq!((late.refresh_until, late.row_until, late.ready), (1054, 1060, 1060));
    assert_eq!((counters.refreshes, counters.row_misses), (1, 2));
}

#[test]
fn refreshes_go_on_while_nothing_is_read() {
    let timing = timing(MemoryType::Sdram);
    let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
    module.read(&timing, timing.place(0), 0, &mut counters);
    let long = module.read(&timing, timing.place(0x100), 1039 * 1000 + 500, &mut counters);
    assert_eq!(counters.refreshes, 1000);
    assert_eq!(long.ready, 1039 * 1000 + 500 + 6, "the last one was over");
    let inside = module.read(&timing, timing.place(0x200), 1039 * 1500 + 4, &mut counters);
    assert_eq!((counters.refreshes, inside.ready), (1500, 1039 * 1500 + 9 + 6), "the last one still runs");
}

/// Reads words one behind another, the next as soon as one has left; the tick of the last word.
pub(super) fn stream(timing: &Timing, addresses: impl Iterator<Item = u64>) -> (i64, MemoryCounters) {
    let (mut module, mut counters) = (Module::new(timing), MemoryCounters::default());
    let mut left = vec![0; timing.look_ahead];
    let mut last = 0;
    for (i, address) in addresses.enumerate() {
        let place = i % timing.look_ahead;
        let ready = module.read(timing, timing.place(address), left[place], &mut counters).ready;
        last = ready.max(last + 1);
        left[place] = last;
    }
    (last, counters)
}

#[test]
fn sdram_in_sequence_gives_a_word_a_tick_but_for_refresh() {
    let timing = timing(MemoryType::Sdram);
    let words = 1_000_000;
    let (ticks, counters) = stream(&timing, 0..words);
    // From the last burst before a refresh to the first word behind it: burst, tRP, tRFC, tRCD and CAS latency, of which the
    // words of the last burst fill its latency and itself.
    let refresh = 3 + 9 + 3 + 3;
    let expected = words as f64 * 1039.0 / (1039.0 - refresh as f64);
    assert!((ticks as f64 / expected - 1.0).abs() < 0.003, "{ticks}, expected {expected}");
    assert_eq!(counters.refreshes, ticks as u64 / 1039);
    // Each row is opened at its first word and behind each refresh; a few times these are the same word.
    let opened = words.div_ceil(512) + counters.refreshes - counters.row_conflicts - counters.row_misses;
    assert!(opened <= 10, "{opened}");
}

/// Words at random, of 2²⁴: those whose ticks outside simulators were asked for, so that the generator is theirs, a linear congruence.
pub(super) fn random(words: usize) -> impl Iterator<Item = u64> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 40
    })
    .take(words)
}

/// Addresses of rows whose banks go round from 0 to `banks − 1`, no row twice.
pub(super) fn round_robin(timing: &Timing, banks: usize, words: usize) -> Vec<u64> {
    let row_words = timing.rows.unwrap().words as u64;
    let mut next = vec![0; banks];
    (0..words)
        .map(|i| {
            let bank = i % banks;
            let row = (next[bank]..).find(|&row| timing.bank(row) == bank).unwrap();
            next[bank] = row + 1;
            row * row_words
        })
        .collect()
}

#[test]
fn rows_a_power_of_two_apart_are_in_different_banks() {
    for kind in [MemoryType::Sdram, MemoryType::Hbm] {
        let timing = timing(kind);
        let banks = timing.banks() as u64;
        for power in 0..64 / banks.trailing_zeros() {
            let mut met: Vec<usize> = (0..banks).map(|i| timing.bank(i * banks.pow(power))).collect();
            met.sort_unstable();
            assert_eq!(met, (0..banks as usize).collect::<Vec<_>>());
        }
    }
}

#[test]
fn sdram_in_strides_of_a_row_of_one_bank_takes_a_row_cycle_a_word() {
    let timing = Timing { refresh_interval: None, ..timing(MemoryType::Sdram) };
    let words = 10_000;
    let (ticks, counters) = stream(&timing, round_robin(&timing, 1, words as usize).into_iter());
    // ACT, RD after tRCD, PRE after the burst, ACT after tRP: 3 + 4 + 3, above tRC = 9.
    assert_eq!(ticks, 10 * (words as i64 - 1) + 6);
    assert_eq!((counters.row_misses, counters.row_conflicts), (1, words - 1));
}

#[test]
fn sdram_in_strides_over_its_banks_is_held_by_bursts_alone() {
    let timing = Timing { refresh_interval: None, ..timing(MemoryType::Sdram) };
    let words = 10_000;
    let (ticks, _) = stream(&timing, round_robin(&timing, 4, words).into_iter());
    // max(tRRD, 10 / 4 banks, burst) = max(2, 2.5, 4).
    assert_eq!(ticks, 4 * (words as i64 - 1) + 6);
}

#[test]
fn hbm_in_strides_over_its_banks_is_held_by_four_activates() {
    let timing = Timing { refresh_interval: None, ..timing(MemoryType::Hbm) };
    let words = 40_000;
    let (ticks, _) = stream(&timing, round_robin(&timing, 16, words).into_iter());
    // max(tRRDS, tRC / 16 banks, tFAW / 4) = max(4, 1.5, 5).
    assert!((ticks as f64 / words as f64 - 5.0).abs() < 0.01, "{ticks}");
}

#[test]
fn fast_page_takes_tpc_within_a_row_and_trc_across() {
    let timing = Timing { refresh_interval: None, ..timing(MemoryType::FastPage) };
    let (within, _) = stream(&timing, 0..1024);
    assert_eq!(within, 7 * 1023 + 9 + 3);
    let (across, _) = stream(&timing, (0..1000).map(|i| i * 1024));
    // tRC = 22 = 110 ns, above tRCD + tRSH + tRP = 9 + 3 + 8.
    assert_eq!(across, 22 * 999 + 9 + 3);
}

#[test]
fn a_row_of_sdram_for_every_random_word_takes_its_expected_time() {
    let timing = Timing { refresh_interval: None, look_ahead: 1, ..timing(MemoryType::Sdram) };
    let words = 200_000;
    let (ticks, counters) = stream(&timing, random(words));
    // Without look-ahead each word waits for PRE, ACT, RD and its data, 3 + 3 + 3: the next word is asked for when it has left. Where it is
    // in the same bank, the burst holds its PRE for a tick. The rows of 2^24 words almost never repeat.
    let expected = 9.0 + 0.25;
    let mean = ticks as f64 / words as f64;
    assert!((mean / expected - 1.0).abs() < 0.002, "{mean}, expected {expected}");
    assert!(counters.row_conflicts as f64 / words as f64 > 0.999);
}

/// All of the table against all commands of a run, and one command of a bus in a tick.
pub(super) fn check_log(
    model: &MemoryModel,
    timing: &Timing,
    clock: f64,
    log: &[(Command, usize, i64)],
) -> Result<(), TestCaseError> {
    let groups = timing.groups;
    for constraint in model.constraints {
        let ticks = constraint.span.ceil(clock, model.burst_ticks()) as i64;
        for &(command, bank, tick) in log.iter().filter(|entry| entry.0 == constraint.to) {
            let mut earlier: Vec<i64> = log
                .iter()
                .filter(|&&(from, other, at)| {
                    let near = match constraint.scope {
                        Scope::Bank => other == bank,
                        Scope::Group => other % groups == bank % groups,
                        Scope::Module => true,
                    };
                    from == constraint.from && near && (at < tick || (at == tick && from != command))
                })
                .map(|entry| entry.2)
                .collect();
            earlier.sort_unstable();
            if let Some(&at) = earlier.iter().rev().nth(constraint.nth - 1) {
                prop_assert!(tick >= at + ticks, "{} {:?}: {} after {}", model.name, constraint, tick, at);
            }
        }
    }
    let column = |command: Command| timing.column_bus && matches!(command, Read | Write);
    for bus in [false, true] {
        let mut ticks: Vec<i64> = log.iter().filter(|e| column(e.0) == bus).map(|e| e.2).collect();
        ticks.sort_unstable();
        prop_assert!(model.rows.is_none() || ticks.windows(2).all(|pair| pair[0] < pair[1]), "{}", model.name);
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn every_command_of_a_random_run_keeps_to_the_table(
        kind in proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec()), speed in 0.6..3.0_f64,
        near: bool, wishes in proptest::collection::vec((any::<u16>(), 0_i64..60, 0_u8..10), 1..150),
    ) {
        let model = MemoryModel::of(kind);
        let clock = model.clock_hz.unwrap_or(8e6) * speed;
        let timing = Timing::new(model, clock);
        let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
        let (mut asked, mut left) = (0, vec![0; timing.look_ahead]);
        let mut previous = i64::MIN;
        for (i, (address, pause, write)) in wishes.into_iter().enumerate() {
            let address = if near { u64::from(address) % 4096 } else { 97 * u64::from(address) };
            let pause = if write == 9 { 100 * pause } else if pause < 40 { 0 } else { pause };
            asked = left[i % timing.look_ahead].max(asked + pause);
            let served = if write == 0 {
                module.write(&timing, timing.place(address), asked, &mut counters)
            } else {
                module.read(&timing, timing.place(address), asked, &mut counters)
            };
            prop_assert!(served.ready >= asked && served.row_until <= served.ready.max(asked));
            previous = previous.max(served.ready);
            left[i % timing.look_ahead] = previous;
        }
        prop_assert_eq!(counters.reads + counters.writes, counters.row_hits + counters.row_misses + counters.row_conflicts);
        prop_assert!(counters.reads <= counters.words);
        let count = |command| module.log.iter().filter(|entry| entry.0 == command).count() as u64;
        prop_assert_eq!((count(Read), count(Write)), (counters.reads, counters.writes));
        prop_assert_eq!(count(Activate), counters.row_misses + counters.row_conflicts);
        check_log(model, &timing, clock, &module.log)?;
    }
}
