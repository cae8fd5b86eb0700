//! One memory module and its controller: rows stay open, words leave in the order in which they are asked for.
//!
//! The commands of a word are booked when it is asked for: closing, opening, reading, each at the first tick that its bank, the
//! constraints and the command bus leave. Reads and writes keep the order of the words. An activate may go before others that have
//! been booked, as long as each keeps its distance from those on both sides; what has been booked never moves. A refresh that has fallen
//! due goes before the next word whose first command would not come before it, and all that is booked after it comes after it.

use super::activates::Activates;
use super::calendar::Calendar;
use super::timing::Delays;
use super::{MemoryCounters, Timing, WordPlace};
use cube3_channel::{Activity, Reason};
use cube3_machine::{Command, MemoryModel};
use serde::{Deserialize, Serialize};

/// Before every tick; far enough from the end of the type that a time can be added.
pub(super) const NEVER: i64 = i64::MIN / 2;
/// A bank without an open row.
pub(super) const CLOSED: u64 = u64::MAX;

/// A memory module. What every word touches lies in its first two cache lines and that of its bank.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct Module {
    /// The last ticks of a read and of a write.
    columns: [i64; 2],
    /// The burst at the module's output.
    output: Burst,
    /// The first tick of an activate behind the last refresh.
    pub(super) refreshed: i64,
    pub(super) refresh_due: i64,
    /// The tick of the last refresh.
    refresh: i64,
    /// That of the bus of the rows, or of the one bus that there is.
    pub(super) calendar: Calendar,
    banks: [Bank; MemoryModel::MOST_BANKS],
    activates: Activates,
    /// The last ticks of a read and of a write in each group.
    group_columns: [[i64; 2]; MemoryModel::MOST_GROUPS],
    #[cfg(test)]
    #[serde(skip)]
    pub(super) log: Vec<(Command, usize, i64)>,
}

/// A bank: its open row, the ticks of its last activate and precharge, and the first tick of the next precharge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(align(32))]
struct Bank {
    row: u64,
    activated: i64,
    precharged: i64,
    precharge: i64,
}

impl Bank {
    const NEW: Bank = Bank { row: CLOSED, activated: NEVER, precharged: NEVER, precharge: NEVER };

    /// The first tick of an activate, as far as the bank's own commands count.
    #[inline(always)]
    fn activate(&self, delays: &Delays) -> i64 {
        (self.activated + delays.activate[Command::Activate as usize]).max(self.precharged + delays.open)
    }

    /// The first tick of a read or write behind the last activate.
    #[inline(always)]
    fn opened(&self, delays: &Delays, command: Command) -> i64 {
        self.activated + delays.activate[command as usize]
    }

    /// Has issued an activate.
    #[inline(always)]
    fn set_activated(&mut self, delays: &Delays, tick: i64) {
        self.activated = tick;
        self.precharge = self.precharge.max(tick + delays.activate[Command::Precharge as usize]);
    }

    /// Has issued a read or write.
    #[inline(always)]
    fn set_column(&mut self, delays: &Delays, column: usize, tick: i64) {
        self.precharge = self.precharge.max(tick + delays.close[column]);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Burst {
    /// The word that it starts at.
    start: u64,
    data: i64,
    row_until: i64,
}

/// When a word is there, and what it has waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Served {
    /// The tick in which the word is at the output.
    pub ready: i64,
    /// The tick of its read; before every tick where it came with an earlier one.
    pub issued: i64,
    /// Before this tick a row was opened or closed for it.
    pub row_until: i64,
    /// Before this tick the module was refreshed.
    pub refresh_until: i64,
}

impl Served {
    /// What needs no word.
    pub const AT_ONCE: Served = Served { ready: NEVER, issued: NEVER, row_until: NEVER, refresh_until: NEVER };

    /// Both.
    pub fn and(self, other: Served) -> Served {
        Served {
            ready: self.ready.max(other.ready),
            issued: self.issued.max(other.issued),
            row_until: self.row_until.max(other.row_until),
            refresh_until: self.refresh_until.max(other.refresh_until),
        }
    }

    /// What a pipeline cycle whose last tick is `tick` counts as, while this is waited for.
    #[inline]
    pub(super) fn activity(self, tick: i64) -> Activity {
        if tick < self.refresh_until {
            Activity::Waiting(Reason::Refresh)
        } else if tick < self.row_until {
            Activity::Waiting(Reason::MemoryRow)
        } else {
            Activity::Busy
        }
    }
}

impl Module {
    /// A module with every bank closed, at tick 0.
    pub fn new(timing: &Timing) -> Module {
        Module {
            banks: [Bank::NEW; MemoryModel::MOST_BANKS],
            columns: [NEVER; 2],
            group_columns: [[NEVER; 2]; MemoryModel::MOST_GROUPS],
            refreshed: NEVER,
            refresh: NEVER,
            refresh_due: timing.refresh_interval.unwrap_or(i64::MAX),
            activates: Activates::new(NEVER),
            calendar: Calendar::default(),
            output: Burst { start: u64::MAX, data: NEVER, row_until: NEVER },
            #[cfg(test)]
            log: Vec::new(),
        }
    }

    /// Whether the constraints and the command bus allow a command to a bank at a tick.
    #[cfg(test)]
    pub(super) fn ready(&self, timing: &Timing, command: Command, bank: usize, tick: i64) -> bool {
        self.free(timing, command, bank, tick) == tick
    }

    /// The first tick, not before `tick`, at which the constraints and the command bus allow a command to a bank.
    #[inline(always)]
    pub(super) fn free(&self, timing: &Timing, command: Command, bank: usize, tick: i64) -> i64 {
        let (of, delays) = (&self.banks[bank], &timing.delays);
        match command {
            Command::Activate => {
                let tick = tick.max(of.activate(delays)).max(self.refreshed);
                self.activates.free(timing, timing.group(bank), tick, &self.calendar)
            }
            Command::Precharge => self.calendar.free(timing, tick.max(of.precharge)),
            Command::Refresh => {
                let [activated, precharged] = delays.to_refresh;
                let of_bank = |bank: &Bank| (bank.activated + activated).max(bank.precharged + precharged);
                let banks = self.banks.iter().map(of_bank).fold(NEVER, i64::max);
                self.calendar.free(timing, tick.max(banks).max(self.refresh + delays.refresh[1]))
            }
            Command::Read | Command::Write => {
                let column = column(command);
                let mut tick = tick.max(of.opened(delays, command)).max(behind(self.columns, &delays.columns, column));
                if timing.groups > 1 {
                    tick = tick.max(behind(self.group_columns[timing.group(bank)], &delays.group_columns, column));
                }
                if timing.column_bus { tick } else { self.calendar.free(timing, tick) }
            }
        }
    }

    /// Issues a command to a bank. No command to come is issued before `asked`.
    #[inline(always)]
    pub(super) fn issue(&mut self, timing: &Timing, command: Command, bank: usize, tick: i64, asked: i64) {
        let delays = &timing.delays;
        let to = &mut self.banks[bank];
        match command {
            Command::Activate => {
                to.set_activated(delays, tick);
                self.calendar.activate(timing, timing.group(bank), tick);
                self.activates.book(timing, timing.group(bank), tick, asked);
            }
            Command::Precharge => to.precharged = tick,
            Command::Refresh => {
                self.refresh = tick;
                self.refreshed = tick + delays.refresh[0];
            }
            Command::Read | Command::Write => {
                let column = column(command);
                to.set_column(delays, column, tick);
                self.columns[column] = tick;
                if timing.groups > 1 {
                    self.group_columns[timing.group(bank)][column] = tick;
                }
            }
        }
        let own_bus = timing.column_bus && matches!(command, Command::Read | Command::Write);
        if command != Command::Activate && !own_bus {
            self.calendar.take(tick);
        }
        #[cfg(test)]
        self.log.push((command, bank, tick));
    }

    /// Reads a word that has been asked for at tick `asked`, behind all words asked for before it.
    #[inline(always)]
    pub fn read(&mut self, timing: &Timing, at: WordPlace, asked: i64, counters: &mut MemoryCounters) -> Served {
        counters.words += 1;
        if let Some(served) = self.word_at_output(timing, at, asked) {
            return served;
        }
        counters.reads += 1;
        let column = self.column(timing, Command::Read, at, asked, counters);
        self.read_out(timing, at, &column)
    }

    /// A word of the burst at the output.
    #[inline(always)]
    pub(super) fn word_at_output(&self, timing: &Timing, at: WordPlace, asked: i64) -> Option<Served> {
        let Burst { start, data, row_until } = self.output;
        let ready = asked.max(data + timing.behind(at.word, start));
        self.holds(timing, at).then_some(Served { ready, issued: NEVER, row_until, refresh_until: NEVER })
    }

    /// The burst of a read goes to the output.
    #[inline(always)]
    pub(super) fn read_out(&mut self, timing: &Timing, at: WordPlace, column: &Column) -> Served {
        let data = column.tick + timing.latency;
        let row_until = if column.opened { data } else { NEVER };
        if timing.burst > 1 {
            self.output = Burst { start: at.word, data, row_until };
        }
        let ready = data + timing.behind(at.word, at.word);
        Served { ready, issued: column.tick, row_until, refresh_until: column.refresh_until }
    }

    /// The open row of a bank, or [`CLOSED`].
    pub(super) fn open_row(&self, bank: usize) -> u64 {
        self.banks[bank].row
    }

    /// Which row of a bank is open from now on, or [`CLOSED`].
    pub(super) fn set_row(&mut self, bank: usize, row: u64) {
        self.banks[bank].row = row;
    }

    /// Whether the burst of a word is at the output.
    #[inline(always)]
    fn holds(&self, timing: &Timing, at: WordPlace) -> bool {
        (at.word ^ self.output.start) < timing.burst as u64 && timing.burst > 1
    }

    /// Writes a word that has been brought at tick `asked`, behind all words asked for before it. `ready` is the tick of the write.
    pub fn write(&mut self, timing: &Timing, at: WordPlace, asked: i64, counters: &mut MemoryCounters) -> Served {
        counters.writes += 1;
        if self.holds(timing, at) {
            self.output.start = u64::MAX;
        }
        let Column { tick, opened, refresh_until } = self.column(timing, Command::Write, at, asked, counters);
        let row_until = if opened { tick } else { NEVER };
        Served { ready: tick, issued: tick, row_until, refresh_until }
    }

    /// Opens the row of a place where it is not open, and reads or writes.
    #[inline(always)]
    fn column(
        &mut self,
        timing: &Timing,
        command: Command,
        WordPlace { bank, row, .. }: WordPlace,
        asked: i64,
        counters: &mut MemoryCounters,
    ) -> Column {
        if timing.rows.is_none() {
            let tick = self.free(timing, command, 0, asked);
            self.issue(timing, command, 0, tick, asked);
            counters.row_hits += 1;
            return Column { tick, opened: false, refresh_until: NEVER };
        }
        self.calendar.forget(timing, asked.min(self.refresh_due));
        if ![row, CLOSED].contains(&self.banks[bank].row)
            && let Some(tick) = self.turn(timing, command, bank, asked)
        {
            self.banks[bank].row = row;
            counters.row_conflicts += 1;
            return Column { tick, opened: true, refresh_until: NEVER };
        }
        let mut refresh_until = NEVER;
        let (first, tick) = loop {
            let first = match self.banks[bank].row {
                open if open == row => command,
                CLOSED => Command::Activate,
                _ => Command::Precharge,
            };
            let tick = self.free(timing, first, bank, asked);
            if tick < self.refresh_due {
                break (first, tick);
            }
            self.refresh(timing, asked, counters);
            refresh_until = self.refreshed;
        };
        self.issue(timing, first, bank, tick, asked);
        if first == command {
            counters.row_hits += 1;
            return Column { tick, opened: false, refresh_until };
        }
        if first == Command::Precharge {
            counters.row_conflicts += 1;
            let tick = self.free(timing, Command::Activate, bank, asked);
            self.issue(timing, Command::Activate, bank, tick, asked);
        } else {
            counters.row_misses += 1;
        }
        self.banks[bank].row = row;
        let tick = self.free(timing, command, bank, asked);
        self.issue(timing, command, bank, tick, asked);
        Column { tick, opened: true, refresh_until }
    }

    /// Closes the open row of a bank, opens another and reads or writes it: the commands of [`Module::issue`] at the ticks of
    /// [`Module::free`], where they all lie within the calendar's 64 ticks and no refresh is due; else nothing is done.
    #[inline(always)]
    fn turn(&mut self, timing: &Timing, command: Command, bank: usize, asked: i64) -> Option<i64> {
        if !timing.plain {
            return None;
        }
        let (delays, column) = (&timing.delays, column(command));
        let (first, mut draft) = self.calendar.draft();
        let mut to = self.banks[bank];
        to.precharged = first + draft.take(asked.max(to.precharge) - first);
        let activate = asked.max(to.activate(delays)).max(self.refreshed);
        to.set_activated(delays, first + draft.activate(timing, activate - first));
        let opened = asked.max(to.opened(delays, command));
        let tick = opened.max(behind(self.columns, &delays.columns, column));
        let tick = if timing.column_bus { tick } else { first + draft.take(tick - first) };
        if !draft.fits() || to.precharged >= self.refresh_due {
            return None;
        }
        to.set_column(delays, column, tick);
        #[cfg(test)]
        for (command, tick) in [(Command::Precharge, to.precharged), (Command::Activate, to.activated), (command, tick)]
        {
            self.log.push((command, bank, tick));
        }
        self.columns[column] = tick;
        self.calendar.book(draft);
        self.banks[bank] = to;
        Some(tick)
    }

    /// Closes every bank and refreshes, as often as has fallen due at tick `asked`, but at least once.
    #[cold]
    pub(super) fn refresh(&mut self, timing: &Timing, asked: i64, counters: &mut MemoryCounters) {
        let Some(interval) = timing.refresh_interval else {
            return;
        };
        let open = || (0..timing.banks()).filter(|&bank| self.banks[bank].row != CLOSED);
        if let Some(first) = open().next() {
            // One command closes all, when the last of them may be closed.
            let due = open().map(|bank| self.banks[bank].precharge).max();
            let close = self.free(timing, Command::Precharge, first, due.unwrap_or(NEVER).max(self.refresh_due));
            self.issue(timing, Command::Precharge, first, close, asked);
            for bank in &mut self.banks {
                bank.row = CLOSED;
                bank.precharged = close;
            }
        }
        let refresh = self.free(timing, Command::Refresh, 0, self.refresh_due);
        self.issue(timing, Command::Refresh, 0, refresh, asked);
        counters.refreshes += 1;
        self.refresh_due += interval;
        // While nothing was asked for, each came when it was due; only the last can hold anything up.
        let idle = (asked - self.refresh_due).div_euclid(interval);
        if idle > 0 {
            counters.refreshes += idle as u64;
            self.refresh_due += idle * interval;
            self.issue(timing, Command::Refresh, 0, self.refresh_due - interval, asked);
        }
    }
}

/// Index of a read or a write.
#[inline(always)]
fn column(command: Command) -> usize {
    usize::from(command == Command::Write)
}

/// The first tick of a read or write behind the last read and the last write.
#[inline(always)]
fn behind(last: [i64; 2], delays: &[[i64; 2]; 2], column: usize) -> i64 {
    (last[0] + delays[0][column]).max(last[1] + delays[1][column])
}

/// When a read or write was issued.
pub(super) struct Column {
    pub tick: i64,
    pub opened: bool,
    pub refresh_until: i64,
}
