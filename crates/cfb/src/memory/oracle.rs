//! A second controller, written from the rules in words: it tries one tick after the other and looks through all commands for each rule.

use super::tests::check_log;
use super::*;
use Command::{Activate, Precharge, Read, Refresh, Write};
use cube3_cases::cases;
use cube3_machine::{BankHash, BurstOrder, Command, Constraint, MemoryModel, Scope, Span};
use proptest::prelude::*;

/// All banks, for a precharge that closes all.
const ALL: usize = usize::MAX;

struct Plain<'a> {
    model: &'a MemoryModel,
    timing: &'a Timing,
    clock: f64,
    log: Vec<(Command, usize, i64)>,
    open: Vec<Option<u64>>,
    /// First word, first data and end of the opening of the burst at the output.
    output: Option<(u64, i64, Option<i64>)>,
    due: i64,
}

/// Tick at the output, tick of the read, end of the opening, end of the refresh.
type Result = (i64, Option<i64>, Option<i64>, Option<i64>);

impl Plain<'_> {
    fn meets(&self, scope: Scope, bank: usize, other: usize) -> bool {
        let groups = self.timing.groups;
        bank == ALL
            || other == ALL
            || match scope {
                Scope::Bank => bank == other,
                Scope::Group => bank % groups == other % groups,
                Scope::Module => true,
            }
    }

    fn on_bus(&self, command: Command) -> bool {
        self.timing.column_bus && matches!(command, Read | Write)
    }

    /// Whether a command may be issued, beside all that have been: each keeps its distance behind the `nth` last before it.
    fn legal(&self, command: Command, bank: usize, tick: i64) -> bool {
        let column = |command| matches!(command, Read | Write);
        let order = self.log.iter().all(|&(other, at_bank, at)| {
            let same_bus = self.on_bus(command) == self.on_bus(other);
            let after = self.meets(Scope::Bank, bank, at_bank)
                || other == Refresh
                || command == Refresh
                || column(command) && column(other);
            self.timing.rows.is_none() || (at != tick || !same_bus) && (!after || at <= tick)
        });
        let mut all: Vec<_> = self.log.iter().rev().take(150).copied().collect();
        all.push((command, bank, tick));
        order
            && self.model.constraints.iter().all(|rule| {
                let ticks = rule.span.ceil(self.clock, self.model.burst_ticks()) as i64;
                all.iter().enumerate().filter(|(_, to)| to.0 == rule.to && to.2 >= tick).all(|(i, to)| {
                    let others = all.iter().enumerate().filter(|&(j, from)| j != i && from.2 <= to.2);
                    let mut before: Vec<i64> = others
                        .filter(|(_, from)| from.0 == rule.from && self.meets(rule.scope, from.1, to.1))
                        .map(|(_, from)| from.2)
                        .collect();
                    before.sort_unstable_by(|a, b| b.cmp(a));
                    before.get(rule.nth - 1).is_none_or(|at| to.2 - at >= ticks)
                })
            })
    }

    fn first(&self, command: Command, bank: usize, from: i64) -> i64 {
        (from..).find(|&tick| self.legal(command, bank, tick)).unwrap()
    }

    fn book(&mut self, command: Command, bank: usize, from: i64) -> i64 {
        let tick = self.first(command, bank, from);
        self.log.push((command, bank, tick));
        tick
    }

    fn serve(&mut self, command: Command, at: WordPlace, asked: i64) -> Result {
        let burst = self.timing.burst as u64;
        let place = |start: u64| {
            let (word, start) = (at.word % burst, start % burst);
            let place = match self.timing.burst_order {
                None => word,
                Some(BurstOrder::Interleaved) => word ^ start,
                Some(BurstOrder::Sequential) => (word + burst - start) % burst,
            };
            (place / self.timing.words_per_tick as u64) as i64
        };
        if let Some((start, data, row)) = self.output.filter(|output| output.0 / burst == at.word / burst) {
            if command == Read {
                return (asked.max(data + place(start)), None, row, None);
            }
            self.output = None;
        }
        let from_first = place(at.word);
        if self.timing.rows.is_none() {
            let tick = self.book(command, 0, asked);
            return (tick + if command == Read { self.timing.latency + from_first } else { 0 }, Some(tick), None, None);
        }
        let mut refreshed = None;
        let needed = loop {
            let needed: &[Command] = match self.open[at.bank] {
                Some(row) if row == at.row => &[],
                None => &[Activate],
                Some(_) => &[Precharge, Activate],
            };
            let first = needed.first().copied().unwrap_or(command);
            if self.first(first, at.bank, asked) < self.due {
                break needed;
            }
            if self.open.iter().any(Option::is_some) {
                self.book(Precharge, ALL, self.due);
                self.open.fill(None);
            }
            let refresh = self.book(Refresh, ALL, self.due);
            let rule = self.model.constraints.iter().find(|rule| (rule.from, rule.to) == (Refresh, Activate)).unwrap();
            refreshed = Some(refresh + rule.span.ceil(self.clock, self.model.burst_ticks()) as i64);
            self.due += self.timing.refresh_interval.unwrap();
        };
        for &command in needed {
            self.book(command, at.bank, asked);
        }
        self.open[at.bank] = Some(at.row);
        let tick = self.book(command, at.bank, asked);
        let ready = tick + if command == Read { self.timing.latency } else { 0 };
        let row = (!needed.is_empty()).then_some(ready);
        if command == Read && burst > 1 {
            self.output = Some((at.word, ready, row));
        }
        (ready + if command == Read { from_first } else { 0 }, Some(tick), row, refreshed)
    }
}

/// A model with the commands and scopes of a row of the table, and other times.
fn models() -> impl Strategy<Value = MemoryModel> {
    let kinds = proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec());
    let spans = proptest::collection::vec((1_u64..26, any::<bool>()), 24);
    let orders = prop_oneof![Just(None), Just(Some(BurstOrder::Interleaved)), Just(Some(BurstOrder::Sequential))];
    (kinds, any::<bool>(), spans, 0_u32..4, orders, 0_u64..6, 4_u64..12).prop_map(
        |(kind, published, spans, burst, order, latency, interval)| {
            let table = *MemoryModel::of(kind);
            if published {
                return table;
            }
            let constraints: Vec<Constraint> = table
                .constraints
                .iter()
                .zip(spans)
                .map(|(&rule, (ticks, burst))| Constraint { span: Span { ticks, picoseconds: 0, burst }, ..rule })
                .collect();
            let burst = if table.rows.is_some() { 1 << burst } else { 1 };
            let all: u64 = constraints.iter().map(|rule| rule.span.ceil(1e6, burst as u64)).sum();
            MemoryModel {
                burst,
                burst_order: order,
                words_per_tick: table.words_per_tick.min(burst),
                latency: Span { ticks: latency, ..table.latency },
                refresh_interval: table.refresh_interval.map(|_| Span {
                    ticks: all * interval / 2,
                    picoseconds: 0,
                    burst: false,
                }),
                constraints: Box::leak(constraints.into_boxed_slice()),
                ..table
            }
        },
    )
}

proptest! {
    #![proptest_config(cases(300))]

    /// The controller books the commands that the rules in words give, and serves each word at the same tick.
    #[test]
    fn the_controller_does_what_the_rules_say(
        model in models(), speed in 0.6..3.0_f64, near in 0_u8..3, look_ahead in 1_usize..20,
        hash in proptest::sample::select(BankHash::TABLE.map(|row| row.hash).to_vec()),
        wishes in proptest::collection::vec((any::<u16>(), 0_i64..60, 0_u8..10), 1..80),
    ) {
        let clock = model.clock_hz.unwrap_or(8e6) * speed;
        let timing = Timing { hash, ..Timing::new(&model, clock) };
        let due = timing.refresh_interval.unwrap_or(i64::MAX);
        let open = vec![None; timing.banks()];
        let mut plain = Plain { model: &model, timing: &timing, clock, log: Vec::new(), open, output: None, due };
        let (mut module, mut counters) = (Module::new(&timing), MemoryCounters::default());
        let (mut asked, mut last, mut left) = (0, 0, vec![0; look_ahead]);
        for (i, (address, pause, what)) in wishes.into_iter().enumerate() {
            let address = u64::from(address);
            let address = [address % 64, address % 4096, 97 * address][usize::from(near)];
            let pause = if what == 9 { 100 * pause } else if pause < 40 { 0 } else { pause };
            asked = left[i % look_ahead].max(asked + pause);
            let at = timing.place(address);
            let served = if what == 0 {
                module.write(&timing, at, asked, &mut counters)
            } else {
                module.read(&timing, at, asked, &mut counters)
            };
            let expected = plain.serve(if what == 0 { Write } else { Read }, at, asked);
            let some = |tick: i64| (tick > i64::MIN / 4).then_some(tick);
            let found = (served.ready, some(served.issued), some(served.row_until), some(served.refresh_until));
            prop_assert_eq!(found, expected);
            last = served.ready.max(last);
            left[i % look_ahead] = last;
        }
        // Of refreshes while nothing was asked for the controller keeps the last.
        let commands = |log: &[(Command, usize, i64)]| -> Vec<(Command, i64)> {
            log.iter().filter(|entry| entry.0 != Refresh).map(|entry| (entry.0, entry.2)).collect()
        };
        prop_assert_eq!(commands(&module.log), commands(&plain.log));
        let refreshes = plain.log.iter().filter(|entry| entry.0 == Refresh).count() as u64;
        prop_assert_eq!(counters.refreshes, refreshes);
        check_log(&model, &timing, clock, &module.log)?;
    }
}

/// Words through a module that chooses, as [`stream`] has them through one that does not: ticks, counters and commands.
pub(super) fn stream_choosing(
    timing: &Timing,
    window: usize,
    addresses: impl Iterator<Item = u64>,
) -> (i64, MemoryCounters, Vec<(Command, usize, i64)>) {
    let mut chooser = Chooser::new(timing, window);
    let mut counters = [MemoryCounters::default()];
    let mut addresses = addresses.peekable();
    let mut waiting: std::collections::VecDeque<Option<Served>> = Default::default();
    let (mut left, mut asked, mut tick, mut last) = (0, 0, 0, 0);
    while addresses.peek().is_some() || !waiting.is_empty() {
        chooser.advance(timing, tick, &mut counters, |step, served| {
            waiting[(step - left) as usize] = Some(served);
        });
        if waiting.front().copied().flatten().is_some_and(|served| served.ready <= tick) {
            waiting.pop_front();
            left += 1;
            last = tick;
        }
        while asked - left < timing.look_ahead as u64
            && let Some(address) = addresses.next()
        {
            chooser.ask(timing.place(address), tick, asked, 0);
            waiting.push_back(None);
            asked += 1;
        }
        tick += 1;
    }
    (last, counters[0], chooser.module.log)
}

/// Each column of a run finds its row open: the last activate or precharge of its bank is the activate of that row.
fn rows_are_open(log: &[(Command, usize, i64)]) -> bool {
    let mut log = log.to_vec();
    log.sort_by_key(|entry| entry.2);
    log.iter().enumerate().filter(|(_, entry)| matches!(entry.0, Read | Write)).all(|(i, column)| {
        let last =
            log[..i].iter().rev().find(|e| e.0 == Refresh || e.1 == column.1 && matches!(e.0, Activate | Precharge));
        last.is_some_and(|last| last.0 == Activate)
    })
}

proptest! {
    #![proptest_config(cases(300))]

    /// A module that chooses keeps to the table, serves every word once, and in a window of one word goes in order.
    #[test]
    fn a_module_that_chooses_keeps_to_the_table(
        model in models(), window in 1_usize..20, more in 0_usize..5, near in 0_u8..3,
        hash in proptest::sample::select(BankHash::TABLE.map(|row| row.hash).to_vec()),
        words in proptest::collection::vec(any::<u16>(), 1..150),
    ) {
        let clock = model.clock_hz.unwrap_or(8e6);
        let timing = Timing { hash, look_ahead: window + more, ..Timing::new(&model, clock) };
        let addresses: Vec<u64> = words
            .iter()
            .map(|&word| [u64::from(word) % 64, u64::from(word) % 4096, 97 * u64::from(word)][usize::from(near)])
            .collect();
        let (_, counters, log) = stream_choosing(&timing, window, addresses.iter().copied());
        prop_assert_eq!(counters.words, words.len() as u64);
        prop_assert_eq!(counters.reads, counters.row_hits + counters.row_misses + counters.row_conflicts);
        prop_assert_eq!(log.iter().filter(|entry| entry.0 == Read).count() as u64, counters.reads);
        prop_assert!(timing.rows.is_none() || rows_are_open(&log));
        check_log(&model, &timing, clock, &log)?;
        let again = stream_choosing(&timing, window, addresses.iter().copied());
        prop_assert_eq!((counters, log), (again.1, again.2));
    }
}

/// Words of an open row pass a word of another row of its bank; words leave in order, so only those that are asked for before it leaves.
#[test]
fn no_word_is_passed_over_for_ever() {
    let model = MemoryModel::of(cube3_machine::MemoryType::Sdram);
    let timing = Timing { refresh_interval: None, look_ahead: 8, ..Timing::new(model, 133e6) };
    // Row 0 is open; then one word of another row of its bank, and many of row 0.
    let other = (1..).find(|&row| timing.bank(row) == timing.bank(0)).unwrap() * 512;
    let addresses = [0].into_iter().chain([other]).chain((1..400).map(|i| 4 * i % 512));
    let (_, _, log) = stream_choosing(&timing, 8, addresses);
    let reads = log.iter().filter(|entry| entry.0 == Read).map(|entry| entry.2).collect::<Vec<_>>();
    let opened = log.iter().filter(|entry| entry.0 == Activate).nth(1).unwrap().2;
    let passed = reads.iter().filter(|&&tick| tick < opened).count();
    assert!((2..=8).contains(&passed), "{passed}");
}
