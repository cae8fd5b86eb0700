//! Figures of other simulators beside ours.
//!
//! DRAMSys 5.0, first in first out; and the timing tables of DRAMsim3 under an in-order loop with 8 words ahead, which decides tick by tick.
//! Both read bursts from their first word. Parameters in ticks: SDRAM at 133 MHz with tRCD 3, CL 3, tRP 3, tRAS 6, tRC 9, tRRD 2, tRFC 9,
//! tREFI 1039, bursts of 4, 4 banks of 512-word rows; HBM as in the table.

use super::module::{CLOSED, Column};
use super::oracle::stream_choosing;
use super::tests::{random, round_robin, stream};
use super::*;
use cube3_machine::{BankHash, BurstOrder, Command, MemoryModel, MemoryType};
use std::collections::VecDeque;

/// Ticks from outside, and a share by which ours may be off.
struct Row {
    what: &'static str,
    outside: &'static [(&'static str, f64)],
    ours: f64,
    tolerance: f64,
}

const DRAMSYS: &str = "DRAMSys 5.0";
const TABLES: &str = "DRAMsim3's tables";
const ALONE: &str = "an in-order loop alone";

fn timing(kind: MemoryType, hash: BankHash, order: Option<BurstOrder>, refresh: bool) -> Timing {
    let model = MemoryModel::of(kind);
    let timing = Timing::new(model, model.clock_hz.unwrap());
    let refresh_interval = timing.refresh_interval.filter(|_| refresh);
    Timing { hash, burst_order: order, refresh_interval, look_ahead: 8, ..timing }
}

/// Words y + n·z of y, z = 0 … n − 1, z fastest.
fn across(n: u64) -> impl Iterator<Item = u64> {
    (0..n * n).map(move |i| i / n + n * (i % n))
}

/// Words of blocks of 8 × 8 words of a plane y, z.
fn blocks(n: u64, y: u64, z: u64) -> u64 {
    y % 8 + 8 * (z % 8) + 64 * (y / 8 + n / 8 * (z / 8))
}

/// Words along x, from the last to the first, of blocks of 8 × 8 × 8 words.
fn backward(n: u64) -> impl Iterator<Item = u64> {
    (0..n * n).map(move |i| {
        let (x, z) = (n - 1 - i % n, i / n);
        x % 8 + 64 * (z % 8) + 512 * (x / 8 + n / 8 * (n / 8 * (z / 8)))
    })
}

/// A controller that decides tick by tick: reads in the order of the words, in other banks what is ready, the oldest first. An activate
/// of a younger word that is ready first holds up that of an older one.
fn stream_by_tick(timing: &Timing, addresses: impl Iterator<Item = u64>) -> i64 {
    let (mut module, mut counters) = (Module::new(timing), MemoryCounters::default());
    let mut addresses = addresses.peekable();
    let (mut queue, mut leaving) = (VecDeque::<WordPlace>::new(), VecDeque::<i64>::new());
    let (mut tick, mut last) = (0, 0);
    while addresses.peek().is_some() || !queue.is_empty() || !leaving.is_empty() {
        module.calendar.forget(timing, tick.min(module.refresh_due));
        if leaving.front().is_some_and(|&ready| ready <= tick) {
            leaving.pop_front();
            last = tick;
        }
        while queue.len() + leaving.len() < timing.look_ahead
            && let Some(address) = addresses.next()
        {
            queue.push_back(timing.place(address));
        }
        if tick >= module.refresh_due {
            module.refresh(timing, tick, &mut counters);
        }
        while let Some(served) = queue.front().and_then(|&at| module.word_at_output(timing, at, tick)) {
            leaving.push_back(served.ready);
            queue.pop_front();
        }
        let (mut claimed, mut read) = (0_u32, false);
        for (i, &at) in queue.iter().enumerate() {
            let WordPlace { bank, row, .. } = at;
            let command = match module.open_row(bank) {
                open if open == row => Command::Read,
                CLOSED => Command::Activate,
                _ => Command::Precharge,
            };
            let free = claimed >> bank & 1 == 0 && module.ready(timing, command, bank, tick);
            claimed |= 1 << bank;
            if !free || (command == Command::Read && i > 0) {
                continue;
            }
            module.issue(timing, command, bank, tick, tick);
            match command {
                Command::Read => {
                    let column = Column { tick, opened: false, refresh_until: tick };
                    leaving.push_back(module.read_out(timing, at, &column).ready);
                }
                Command::Activate => module.set_row(bank, row),
                _ => module.set_row(bank, CLOSED),
            }
            read |= command == Command::Read;
        }
        if read {
            queue.pop_front();
        }
        tick += 1;
    }
    last
}

fn rows() -> Vec<Row> {
    use BankHash::{DigitSum, Xor};
    use MemoryType::{Hbm, Sdram};
    let sdram = |hash, refresh| timing(Sdram, hash, None, refresh);
    let ticks = |timing: &Timing, addresses: &mut dyn Iterator<Item = u64>| stream(timing, addresses).0 as f64;
    let row = |what, outside, ours| Row { what, outside, ours, tolerance: 0.005 };
    let a_word = |timing: &Timing, addresses: &mut dyn Iterator<Item = u64>| {
        let mut words = 0;
        ticks(timing, &mut addresses.inspect(|_| words += 1)) / f64::from(words)
    };
    let off = sdram(Xor, false);
    let (on, sum) = (sdram(Xor, true), sdram(DigitSum, true));
    let interleaved = timing(Sdram, DigitSum, Some(BurstOrder::Interleaved), true);
    let short = MemoryModel { burst: 1, ..*MemoryModel::of(Sdram) };
    let bursts_of_one = Timing { hash: Xor, look_ahead: 8, ..Timing::new(&short, 133e6) };
    let yz = |n: u64| (0..n * n).map(move |i| blocks(n, (i / n + n - i % n) % n, i % n));
    let strides = |rows: u64| (0..20_000).map(move |i| i * rows * 512);
    let hbm = timing(Hbm, Xor, None, true);
    vec![
        row(
            "20,000 rows of one bank, without refresh",
            &[(DRAMSYS, 200_000.0)],
            ticks(&off, &mut round_robin(&off, 1, 20_000).into_iter()),
        ),
        row(
            "40,000 rows, each of the next bank, without refresh",
            &[(DRAMSYS, 160_006.0)],
            ticks(&off, &mut round_robin(&off, 4, 40_000).into_iter()),
        ),
        row("100,000 words at random, without refresh", &[(DRAMSYS, 594_391.0)], ticks(&off, &mut random(100_000))),
        row("words 0 to 99,999", &[(DRAMSYS, 101_476.0)], ticks(&on, &mut (0..100_000))),
        row("y + n·z, z fastest, n = 256", &[(DRAMSYS, 278_632.0)], ticks(&on, &mut across(256))),
        row("y + n·z, z fastest, n = 512", &[(DRAMSYS, 1_189_793.0)], ticks(&on, &mut across(512))),
        row(
            "HBM, y + n·z, z fastest, n = 512",
            &[(DRAMSYS, 1_389_056.0), (TABLES, 1_384_225.0)],
            ticks(&hbm, &mut across(512)),
        ),
        Row {
            what: "HBM, 100,000 words at random: an activate that is booked for an older word keeps its tick",
            outside: &[(DRAMSYS, 655_983.0), (TABLES, 664_869.0)],
            ours: ticks(&hbm, &mut random(100_000)),
            tolerance: 0.037,
        },
        Row {
            what: "the same where rows are opened tick by tick, whichever is ready",
            outside: &[(TABLES, 664_869.0)],
            ours: stream_by_tick(&hbm, random(100_000)) as f64,
            tolerance: 0.01,
        },
        row("ticks a word, strides of 64 rows, exclusive or", &[(ALONE, 10.0)], a_word(&off, &mut strides(64))),
        Row {
            what: "ticks a word, y + n·z, n = 256, digit sum",
            outside: &[(ALONE, 4.058)],
            ours: a_word(&sum, &mut across(256)),
            tolerance: 0.01,
        },
        Row {
            what: "ticks a word, y + n·z, n = 512, digit sum",
            outside: &[(ALONE, 4.246)],
            ours: a_word(&sum, &mut across(512)),
            tolerance: 0.01,
        },
        Row {
            what: "ticks a word, y + n·z, n = 256, bursts of 1, exclusive or; outside activates never overtake",
            outside: &[("ordered activates", 2.14)],
            ours: a_word(&bursts_of_one, &mut across(256)),
            tolerance: 0.025,
        },
        row("ticks a word, beams y, z over blocks, exclusive or", &[(ALONE, 4.160)], a_word(&on, &mut yz(256))),
        row("ticks a word, beams y, z over blocks, digit sum", &[(ALONE, 4.075)], a_word(&sum, &mut yz(256))),
        row(
            "ticks a word, back over blocks, bursts from their start",
            &[(ALONE, 1.508)],
            a_word(&sum, &mut backward(256)),
        ),
        row(
            "ticks a word, back over blocks, interleaved bursts",
            &[(ALONE, 1.144)],
            a_word(&interleaved, &mut backward(256)),
        ),
    ]
}

/// Every figure, printed.
#[test]
fn ours_stand_beside_those_of_other_simulators() {
    let rows = rows();
    for Row { what, outside, ours, .. } in &rows {
        let list: Vec<String> = outside.iter().map(|(who, ticks)| format!("{who} {ticks}")).collect();
        println!("| {what} | {} | {ours:.5} |", list.join(", "));
    }
    for Row { what, outside, ours, tolerance } in rows {
        for (who, theirs) in outside {
            assert!((ours / theirs - 1.0).abs() < tolerance, "{what}: {ours}, {who} has {theirs}");
        }
    }
}

/// DRAMsim3 itself reorders: 462,582 ticks for the words at random. What a window brings here is between that of 4 and of 8 words.
#[test]
fn a_window_brings_what_a_simulator_that_reorders_gains() {
    let timing = timing(MemoryType::Sdram, BankHash::Xor, None, false);
    let in_order = stream(&timing, random(100_000)).0;
    let gains = [1, 2, 4, 8].map(|window| stream_choosing(&timing, window, random(100_000)).0);
    println!("in order {in_order}, windows of 1, 2, 4 and 8 words {gains:?}");
    assert!(gains.is_sorted_by(|a, b| a > b), "{gains:?}");
    assert!(gains[3] < 462_582 && 462_582 < gains[2], "{gains:?}");
    assert!((gains[2] as f64 / 462_582.0 - 1.0).abs() < 0.01, "{gains:?}");
}

/// Strides of 2ᵏ rows, k = 0 … 12: ticks a word. With the sum of the digits none stays in one bank, nor in two.
#[test]
fn strides_of_powers_of_two_rows() {
    for kind in [MemoryType::Sdram, MemoryType::Hbm] {
        for row in &BankHash::TABLE {
            let timing = timing(kind, row.hash, None, false);
            let ticks: Vec<f64> = (0..13)
                .map(|k| {
                    let words = 4096;
                    let addresses = (0..words).map(|i| (i << k) * timing.rows.unwrap().words as u64);
                    stream(&timing, addresses).0 as f64 / words as f64
                })
                .collect();
            let list: Vec<String> = ticks.iter().map(|ticks| format!("{ticks:.2}")).collect();
            println!("| {kind:?} | {} | {} |", row.name, list.join(" | "));
            let most = ticks.iter().fold(0.0_f64, |most, &ticks| most.max(ticks));
            match (kind, row.hash) {
                (MemoryType::Sdram, BankHash::DigitSum) => assert!(most < 4.6, "{ticks:?}"),
                (MemoryType::Hbm, BankHash::DigitSum) => assert!(most < 5.01, "{ticks:?}"),
                (MemoryType::Sdram, _) => assert!(most > 9.9, "{ticks:?}"),
                _ => assert!(most > 23.9, "{ticks:?}"),
            }
        }
    }
}
