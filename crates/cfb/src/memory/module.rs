//! One memory module and its controller: rows stay open, words leave in the order in which they are asked for.
//!
//! Each command is booked in the order of the words at the first tick that the constraints and the command bus leave. Rows for
//! later words are so opened behind earlier ones, in other banks. A refresh that has fallen due goes before the next word
//! whose first command would not come before it.

use super::{Place, Timing};
use cube3_host::{Command, MemoryModel};
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// Before every tick; far enough from the end of the type that a time can be added.
const NEVER: i64 = i64::MIN / 2;
/// A bank without an open row.
const CLOSED: u64 = u64::MAX;
/// Commands that can be booked ahead: closing, opening and reading for each word that is asked for, and a refresh behind a closing.
const BOOKED: usize = 32;
const _: () = assert!(3 * MemoryModel::MOST_AHEAD + 2 <= BOOKED);

/// A memory module.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Module {
    /// The open row of each bank.
    rows: Vec<u64>,
    /// Last ticks of commands, where [`Timing`] places them: for each command the last four in the module, the latest first; for
    /// each group, and for each bank, the last of each command.
    marks: Vec<i64>,
    /// Ticks of the last commands on the bus of the rows, or on the one bus that there is.
    booked: [i64; BOOKED],
    next_booked: usize,
    last_booked: i64,
    /// The burst at the module's output.
    output: Burst,
    refresh_due: i64,
    #[cfg(test)]
    #[serde(skip)]
    pub(super) log: Vec<(Command, usize, i64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Burst {
    number: u64,
    data: i64,
    row_until: i64,
}

/// When a word is there, and what it has waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Served {
    /// The tick in which the word is at the output.
    pub ready: i64,
    /// Before this tick a row was opened or closed for it.
    pub row_until: i64,
    /// Before this tick the module was refreshed.
    pub refresh_until: i64,
}

impl Served {
    /// What needs no word.
    pub const AT_ONCE: Served = Served { ready: NEVER, row_until: NEVER, refresh_until: NEVER };

    /// Both.
    pub fn and(self, other: Served) -> Served {
        Served {
            ready: self.ready.max(other.ready),
            row_until: self.row_until.max(other.row_until),
            refresh_until: self.refresh_until.max(other.refresh_until),
        }
    }
}

/// What memory modules have done. `reads + writes = row_hits + row_misses + row_conflicts`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MemoryCounters {
    /// Words read.
    pub words: u64,
    /// Read commands; the other words came with an earlier burst.
    pub reads: u64,
    /// Words written.
    pub writes: u64,
    /// Reads and writes that found their row open.
    pub row_hits: u64,
    /// Reads and writes that found their bank closed.
    pub row_misses: u64,
    /// Reads and writes that found another row open.
    pub row_conflicts: u64,
    /// Refreshes.
    pub refreshes: u64,
}

impl MemoryCounters {
    /// The same in `modules` modules.
    pub fn times(self, modules: u64) -> MemoryCounters {
        MemoryCounters {
            words: self.words * modules,
            reads: self.reads * modules,
            writes: self.writes * modules,
            row_hits: self.row_hits * modules,
            row_misses: self.row_misses * modules,
            row_conflicts: self.row_conflicts * modules,
            refreshes: self.refreshes * modules,
        }
    }
}

impl AddAssign for MemoryCounters {
    fn add_assign(&mut self, other: MemoryCounters) {
        self.words += other.words;
        self.reads += other.reads;
        self.writes += other.writes;
        self.row_hits += other.row_hits;
        self.row_misses += other.row_misses;
        self.row_conflicts += other.row_conflicts;
        self.refreshes += other.refreshes;
    }
}

impl Module {
    /// A module with every bank closed, at tick 0.
    pub fn new(timing: &Timing) -> Module {
        Module {
            rows: vec![CLOSED; timing.banks()],
            marks: vec![NEVER; timing.marks()],
            booked: [NEVER; BOOKED],
            next_booked: 0,
            last_booked: NEVER,
            output: Burst { number: u64::MAX, data: NEVER, row_until: NEVER },
            refresh_due: timing.refresh_interval.unwrap_or(i64::MAX),
            #[cfg(test)]
            log: Vec::new(),
        }
    }

    /// The first tick at which the constraints allow a command to a bank.
    #[inline(always)]
    pub fn earliest(&self, timing: &Timing, command: Command, bank: usize) -> i64 {
        let group = timing.group(bank);
        let mut tick = NEVER;
        for rule in &timing.rules[command as usize] {
            tick = tick.max(self.marks[rule.first + rule.by_group * group + rule.by_bank * bank] + rule.ticks);
        }
        tick
    }

    /// Whether the constraints and the command bus allow a command to a bank at a tick.
    pub fn ready(&self, timing: &Timing, command: Command, bank: usize, tick: i64) -> bool {
        self.free(timing, command, bank, tick) == tick
    }

    /// The first tick, not before `tick`, at which the constraints and the command bus allow a command to a bank.
    #[inline(always)]
    fn free(&self, timing: &Timing, command: Command, bank: usize, tick: i64) -> i64 {
        let mut tick = tick.max(self.earliest(timing, command, bank));
        let own_bus = timing.column_bus && matches!(command, Command::Read | Command::Write);
        // All at once: a search that stops early is slower.
        while !own_bus && tick <= self.last_booked && self.booked.iter().fold(false, |met, &at| met | (at == tick)) {
            tick += 1;
        }
        tick
    }

    /// Issues a command to a bank.
    #[inline(always)]
    pub fn issue(&mut self, timing: &Timing, command: Command, bank: usize, tick: i64) {
        if !(timing.column_bus && matches!(command, Command::Read | Command::Write)) {
            self.booked[self.next_booked] = tick;
            self.next_booked = (self.next_booked + 1) % BOOKED;
            self.last_booked = self.last_booked.max(tick);
        }
        self.note(timing, command, bank, tick);
        let last = &mut self.marks[timing.in_module(command)..][..Timing::KEPT];
        // Banks may be closed in another order than that of the words.
        let place = last.iter().position(|&earlier| tick >= earlier).unwrap_or(Timing::KEPT);
        for i in (place + 1..Timing::KEPT).rev() {
            last[i] = last[i - 1];
        }
        if place < Timing::KEPT {
            last[place] = tick;
        }
        #[cfg(test)]
        self.log.push((command, bank, tick));
    }

    /// Remembers a command where constraints on its bank and group look for it.
    #[inline(always)]
    fn note(&mut self, timing: &Timing, command: Command, bank: usize, tick: i64) {
        self.marks[timing.in_bank(command, bank)] = tick;
        if timing.groups() > 1 {
            let last = &mut self.marks[timing.in_group(command, timing.group(bank))];
            *last = tick.max(*last);
        }
    }

    /// Reads a word that has been asked for at tick `asked`, behind all words asked for before it.
    #[inline]
    pub fn read(&mut self, timing: &Timing, at: Place, asked: i64, counters: &mut MemoryCounters) -> Served {
        counters.words += 1;
        let number = at.word >> timing.burst.trailing_zeros();
        let place = (at.word & (timing.burst as u64 - 1)) >> timing.words_per_tick.trailing_zeros();
        if number == self.output.number {
            let Burst { data, row_until, .. } = self.output;
            return Served { ready: asked.max(data + place as i64), row_until, refresh_until: NEVER };
        }
        counters.reads += 1;
        let column = self.column(timing, Command::Read, at, asked, counters);
        let data = column.tick + timing.latency;
        let row_until = if column.opened { data } else { NEVER };
        if timing.burst > 1 {
            self.output = Burst { number, data, row_until };
        }
        Served { ready: data + place as i64, row_until, refresh_until: column.refresh_until }
    }

    /// Writes a word that has been brought at tick `asked`, behind all words asked for before it. `ready` is the tick of the write.
    pub fn write(&mut self, timing: &Timing, at: Place, asked: i64, counters: &mut MemoryCounters) -> Served {
        counters.writes += 1;
        if at.word >> timing.burst.trailing_zeros() == self.output.number {
            self.output.number = u64::MAX;
        }
        let column = self.column(timing, Command::Write, at, asked, counters);
        let row_until = if column.opened { column.tick } else { NEVER };
        Served { ready: column.tick, row_until, refresh_until: column.refresh_until }
    }

    /// Opens the row of a place where it is not open, and reads or writes.
    #[inline(always)]
    fn column(
        &mut self,
        timing: &Timing,
        command: Command,
        Place { bank, row, .. }: Place,
        asked: i64,
        counters: &mut MemoryCounters,
    ) -> Column {
        if timing.rows.is_none() {
            let tick = self.free(timing, command, 0, asked);
            self.issue(timing, command, 0, tick);
            counters.row_hits += 1;
            return Column { tick, opened: false, refresh_until: NEVER };
        }
        let mut refresh_until = NEVER;
        let (first, tick) = loop {
            let first = match self.rows[bank] {
                open if open == row => command,
                CLOSED => Command::Activate,
                _ => Command::Precharge,
            };
            let tick = self.free(timing, first, bank, asked);
            if tick < self.refresh_due {
                break (first, tick);
            }
            self.refresh(timing, asked, counters);
            refresh_until = self.earliest(timing, Command::Activate, bank);
        };
        self.issue(timing, first, bank, tick);
        if first == command {
            counters.row_hits += 1;
            return Column { tick, opened: false, refresh_until };
        }
        if first == Command::Precharge {
            counters.row_conflicts += 1;
            let tick = self.free(timing, Command::Activate, bank, asked);
            self.issue(timing, Command::Activate, bank, tick);
        } else {
            counters.row_misses += 1;
        }
        self.rows[bank] = row;
        let tick = self.free(timing, command, bank, asked);
        self.issue(timing, command, bank, tick);
        Column { tick, opened: true, refresh_until }
    }

    /// Closes every bank and refreshes, as often as has fallen due at `tick`, but at least once.
    #[cold]
    fn refresh(&mut self, timing: &Timing, tick: i64, counters: &mut MemoryCounters) {
        let Some(interval) = timing.refresh_interval else {
            return;
        };
        let open = |bank: &usize| self.rows[*bank] != CLOSED;
        let banks: Vec<usize> = (0..self.rows.len()).filter(open).collect();
        if let Some(&first) = banks.first() {
            // One command closes all, when the last of them may be closed.
            let due = banks.iter().map(|&bank| self.earliest(timing, Command::Precharge, bank)).max();
            let close = self.free(timing, Command::Precharge, first, due.unwrap_or(NEVER).max(self.refresh_due));
            self.issue(timing, Command::Precharge, first, close);
            for bank in banks {
                self.rows[bank] = CLOSED;
                self.note(timing, Command::Precharge, bank, close);
            }
        }
        let refresh = self.free(timing, Command::Refresh, 0, self.refresh_due);
        self.issue(timing, Command::Refresh, 0, refresh);
        counters.refreshes += 1;
        self.refresh_due += interval;
        // While nothing was asked for, each came when it was due; only the last can hold anything up.
        let idle = (tick - self.refresh_due).div_euclid(interval);
        if idle > 0 {
            counters.refreshes += idle as u64;
            self.refresh_due += idle * interval;
            self.issue(timing, Command::Refresh, 0, self.refresh_due - interval);
        }
    }
}

/// When a read or write was issued.
struct Column {
    tick: i64,
    opened: bool,
    refresh_until: i64,
}
