//! A row of the table of memory modules in ticks of a clock.

use cube3_host::{Command, MemoryModel, Rows, Scope};

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

/// A constraint in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rule {
    pub from: Command,
    pub scope: Scope,
    pub nth: usize,
    pub ticks: i64,
}

impl Timing {
    /// The timing of a module at a memory clock in hertz.
    pub fn new(model: &MemoryModel, clock_hz: f64) -> Timing {
        let rules = Command::ALL.map(|to| {
            let constraints = model.constraints.iter().filter(|constraint| constraint.to == to);
            let rule = |constraint: &cube3_host::Constraint| Rule {
                from: constraint.from,
                scope: constraint.scope,
                nth: constraint.nth,
                ticks: constraint.span.ceil(clock_hz) as i64,
            };
            constraints.map(rule).collect()
        });
        Timing {
            rows: model.rows,
            burst: model.burst,
            words_per_tick: model.words_per_tick,
            latency: model.latency.ceil(clock_hz) as i64,
            refresh_interval: model.refresh_interval.map(|interval| interval.floor(clock_hz) as i64),
            column_bus: model.column_bus,
            look_ahead: model.look_ahead,
            rules,
        }
    }

    /// Banks of a module.
    pub fn banks(&self) -> usize {
        self.rows.map_or(1, |rows| rows.banks)
    }

    /// Groups of banks.
    pub fn groups(&self) -> usize {
        self.rows.map_or(1, |rows| rows.groups)
    }
}
