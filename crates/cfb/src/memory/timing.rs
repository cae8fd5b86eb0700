//! A row of the table of memory modules in ticks of a clock.

use cube3_host::{Command, Constraint, MemoryModel, Rows, Scope};

/// What a module must keep to, in ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Banks and rows, if any.
    pub rows: Option<Rows>,
    /// Words that a read brings.
    pub burst: usize,
    /// Words of a burst in a tick.
    pub words_per_tick: usize,
    /// From the read to its first word.
    pub latency: i64,
    /// From one refresh to the next.
    pub refresh_interval: Option<i64>,
    /// Whether reads and writes have a command bus of their own.
    pub column_bus: bool,
    /// Words of a module that are asked for ahead.
    pub look_ahead: usize,
    /// For each command, in the order of [`Command`], what it must wait for.
    pub(super) rules: [Vec<Rule>; 5],
}

/// Where a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its number in the module.
    pub word: u64,
    /// The bank, 0 where there is but one.
    pub bank: usize,
    /// A number that no other row of the bank has.
    pub row: u64,
}

/// A constraint: so many ticks behind the mark of an earlier command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    pub first: usize,
    pub by_group: usize,
    pub by_bank: usize,
    pub ticks: i64,
}

impl Timing {
    /// The timing of a module at a memory clock in hertz.
    pub fn new(model: &MemoryModel, clock_hz: f64) -> Timing {
        let mut timing = Timing {
            rows: model.rows,
            burst: model.burst,
            words_per_tick: model.words_per_tick,
            latency: model.latency.ceil(clock_hz) as i64,
            refresh_interval: model.refresh_interval.map(|interval| interval.floor(clock_hz) as i64),
            column_bus: model.column_bus,
            look_ahead: model.look_ahead,
            rules: Default::default(),
        };
        timing.rules = Command::ALL.map(|to| {
            let constraints = model.constraints.iter().filter(|constraint| constraint.to == to);
            constraints.map(|constraint| timing.rule(constraint, clock_hz)).collect()
        });
        timing
    }

    fn rule(&self, constraint: &Constraint, clock_hz: f64) -> Rule {
        let (from, ticks) = (constraint.from, constraint.span.ceil(clock_hz) as i64);
        let [by_group, by_bank] = match constraint.scope {
            Scope::Module => [0, 0],
            Scope::Group => [Self::COMMANDS, 0],
            Scope::Bank => [0, Self::COMMANDS],
        };
        let first = match constraint.scope {
            Scope::Module => self.in_module(from) + constraint.nth - 1,
            Scope::Group => self.in_group(from, 0),
            Scope::Bank => self.in_bank(from, 0),
        };
        Rule { first, by_group, by_bank, ticks }
    }

    const COMMANDS: usize = Command::ALL.len();

    /// Last ticks of each command that a module keeps.
    pub(super) const KEPT: usize = 4;

    /// The first of the marks of a command in the module.
    #[inline]
    pub(super) fn in_module(&self, command: Command) -> usize {
        Self::KEPT * command as usize
    }

    /// The mark of a command in a group of banks.
    #[inline]
    pub(super) fn in_group(&self, command: Command, group: usize) -> usize {
        Self::COMMANDS * (Self::KEPT + group) + command as usize
    }

    /// The mark of a command in a bank.
    #[inline]
    pub(super) fn in_bank(&self, command: Command, bank: usize) -> usize {
        Self::COMMANDS * (Self::KEPT + self.groups() + bank) + command as usize
    }

    /// All marks.
    pub(super) fn marks(&self) -> usize {
        self.in_bank(Command::Activate, self.banks())
    }

    /// The group of a bank.
    #[inline]
    pub(super) fn group(&self, bank: usize) -> usize {
        bank & (self.groups() - 1)
    }

    /// Banks of a module.
    #[inline]
    pub fn banks(&self) -> usize {
        self.rows.map_or(1, |rows| rows.banks)
    }

    /// The bank of a row of words, numbered through the module: the exclusive or of the lowest three digits of its number to the
    /// base of the banks, so that rows a power of 2 apart are in different banks too (Zhang, Zhu, Zhang 2000, permutation-based
    /// interleaving).
    #[inline]
    pub fn bank(&self, row: u64) -> usize {
        let bits = self.banks().trailing_zeros();
        (row ^ (row >> bits) ^ (row >> (2 * bits))) as usize & (self.banks() - 1)
    }

    /// Where a word is whose bank follows from its number alone.
    #[inline]
    pub fn place(&self, word: u64) -> Place {
        let row = self.rows.map_or(0, |rows| word >> rows.words.trailing_zeros());
        Place { word, bank: self.bank(row), row }
    }

    /// Groups of banks.
    #[inline]
    pub fn groups(&self) -> usize {
        self.rows.map_or(1, |rows| rows.groups)
    }
}
