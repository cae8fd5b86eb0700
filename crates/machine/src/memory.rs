//! The table of memory modules: what a module is, and how far apart its commands must be.
//!
//! A module is a row of data. The controller in `cube3_cfb` knows commands and constraints, and no module by name.

use crate::{BurstOrder, Cfb, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryType};
use strum::VariantArray;

/// What a module is told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, VariantArray)]
pub enum Command {
    /// Opens a row of a bank: ACT, or RAS falling.
    Activate,
    /// Reads a burst of an open row: RD, or CAS falling.
    Read,
    /// Writes a word of an open row: WR.
    Write,
    /// Closes the row of a bank: PRE, or RAS rising.
    Precharge,
    /// Refreshes a row of every bank; all must be closed: REF.
    Refresh,
}

impl Command {
    /// Every command.
    pub const ALL: [Command; Command::VARIANTS.len()] = *Command::VARIANTS.first_chunk().unwrap();
}

/// Which earlier commands a constraint looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scope {
    /// Those to the same bank.
    Bank,
    /// Those to the same group of banks.
    Group,
    /// Those to any bank of the module.
    Module,
}

/// A time: ticks of the memory clock, a time that no clock changes, and the rest of a burst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Ticks.
    pub ticks: u64,
    /// Picoseconds on top.
    pub picoseconds: u64,
    /// Whether the ticks of a burst behind its first come on top.
    pub burst: bool,
}

/// So many ticks.
const fn ticks(ticks: u64) -> Span {
    Span { ticks, picoseconds: 0, burst: false }
}

/// So many nanoseconds.
const fn ns(nanoseconds: u64) -> Span {
    Span { ticks: 0, picoseconds: 1000 * nanoseconds, burst: false }
}

impl Span {
    /// Ticks that are at least as long, where a burst takes `burst_ticks`.
    pub fn ceil(self, clock_hz: f64, burst_ticks: u64) -> u64 {
        self.whole(burst_ticks) + Span::exact(self.picoseconds, clock_hz).div_ceil(Span::TICK) as u64
    }

    /// Ticks that are at most as long, where a burst takes `burst_ticks`.
    pub fn floor(self, clock_hz: f64, burst_ticks: u64) -> u64 {
        self.whole(burst_ticks) + (Span::exact(self.picoseconds, clock_hz) / Span::TICK) as u64
    }

    /// With the rest of a burst.
    const fn behind_burst(self) -> Span {
        Span { burst: true, ..self }
    }

    fn whole(self, burst_ticks: u64) -> u64 {
        self.ticks + if self.burst { burst_ticks - 1 } else { 0 }
    }

    /// A tick in picoseconds · millihertz.
    const TICK: u128 = 1_000_000_000_000_000;

    fn exact(picoseconds: u64, clock_hz: f64) -> u128 {
        u128::from(picoseconds) * (clock_hz * 1e3).round() as u128
    }
}

/// `to` is at least `span` behind the `nth` last `from` in its scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Constraint {
    /// The data sheet's name.
    pub name: &'static str,
    /// The earlier command.
    pub from: Command,
    /// The later command.
    pub to: Command,
    /// Which of the earlier ones count.
    pub scope: Scope,
    /// 1 for the last of them, 4 for the fourth last (tFAW).
    pub nth: usize,
    /// The least time between the two.
    pub span: Span,
}

/// Banks with rows that must be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Banks of a module, a power of 2.
    pub banks: usize,
    /// Groups that the banks are in, a power of 2; bank b is in group b mod groups.
    pub groups: usize,
    /// Words of a row, a power of 2.
    pub words: usize,
}

/// A row of the table: one type of memory module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryModel {
    /// The value of `cfb.memory`.
    pub kind: MemoryType,
    /// What it is.
    pub name: &'static str,
    /// Where the numbers are from.
    pub source: &'static str,
    /// Clock in hertz; the pipeline's where there is none.
    pub clock_hz: Option<f64>,
    /// Ports at which words go in and out at the same time.
    pub ports: usize,
    /// Banks and rows; a module without them takes any address at any time.
    pub rows: Option<Rows>,
    /// Neighbouring words that a read brings, a power of 2. The last ones stay at the module's output.
    pub burst: usize,
    /// Every length that a burst can have.
    pub burst_lengths: &'static [usize],
    /// The order of a burst that starts at the word asked for; none where bursts start at their first word.
    pub burst_order: Option<BurstOrder>,
    /// Words of a burst in a tick, a power of 2.
    pub words_per_tick: usize,
    /// From the read to its first word.
    pub latency: Span,
    /// At most so long from one refresh to the next.
    pub refresh_interval: Option<Span>,
    /// Whether reads and writes have a command bus of their own, beside that of the rows.
    pub column_bus: bool,
    /// Words of a module that are asked for ahead, 1 to [`MemoryModel::MOST_AHEAD`].
    pub look_ahead: usize,
    /// How far apart commands must be.
    pub constraints: &'static [Constraint],
}

/// Shorthand for the rows of the table.
const fn after(name: &'static str, from: Command, to: Command, scope: Scope, span: Span) -> Constraint {
    Constraint { name, from, to, scope, nth: 1, span }
}

use Command::{Activate, Precharge, Read, Refresh, Write};
use Scope::{Bank, Group, Module};

/// A word a tick.
const IDEAL: MemoryModel = MemoryModel {
    kind: MemoryType::Ideal,
    name: "ideal",
    source: "a word in every tick, whatever its address",
    clock_hz: None,
    ports: 2,
    rows: None,
    burst: 1,
    burst_lengths: &[1],
    burst_order: None,
    words_per_tick: 1,
    latency: ticks(0),
    refresh_interval: None,
    column_bus: true,
    look_ahead: 4,
    constraints: &[after("cycle", Read, Read, Module, ticks(1)), after("cycle", Write, Write, Module, ticks(1))],
};

/// The dual-access module that the paper's frame rate needs.
const VRAM: MemoryModel = MemoryModel {
    kind: MemoryType::Vram,
    name: "dual-ported video memory, 125 ns",
    source: "Pfister et al. 1995, section 5: dual-access modules, 512³ at up to 30 frames a second, a beam each 127 ns; ours: 125 ns for any address at each port",
    clock_hz: Some(8e6),
    ports: 2,
    rows: None,
    burst: 1,
    burst_lengths: &[1],
    burst_order: None,
    words_per_tick: 1,
    latency: ticks(0),
    refresh_interval: None,
    column_bus: true,
    look_ahead: 4,
    constraints: &[after("cycle", Read, Read, Module, ns(125)), after("cycle", Write, Write, Module, ns(125))],
};

/// Asynchronous; the clock is the controller's.
const FAST_PAGE: MemoryModel = MemoryModel {
    kind: MemoryType::FastPage,
    name: "fast-page DRAM, 60 ns, 1 M × 16",
    source: "Micron MT4C1M16C3, grade -6: tRAC 60, tRC 110, tPC 35, tCAC 15, tRP 40; tRCD is its largest, 45, at which tRAC and tCAC agree; 1024 rows in 16 ms",
    clock_hz: Some(200e6),
    ports: 1,
    rows: Some(Rows { banks: 1, groups: 1, words: 1024 }),
    burst: 1,
    burst_lengths: &[1],
    burst_order: None,
    words_per_tick: 1,
    latency: ns(15),
    refresh_interval: Some(ns(15_625)),
    column_bus: false,
    look_ahead: 2,
    constraints: &[
        after("tRCD", Activate, Read, Bank, ns(45)),
        after("tRCD", Activate, Write, Bank, ns(45)),
        after("tPC", Read, Read, Module, ns(35)),
        after("tPC", Write, Write, Module, ns(35)),
        after("tPC", Read, Write, Module, ns(35)),
        after("tPC", Write, Read, Module, ns(35)),
        after("tRSH", Read, Precharge, Bank, ns(15)),
        after("tRWL", Write, Precharge, Bank, ns(15)),
        after("tRAS", Activate, Precharge, Bank, ns(60)),
        after("tRP", Precharge, Activate, Bank, ns(40)),
        after("tRP", Precharge, Refresh, Module, ns(40)),
        after("tRC", Activate, Activate, Bank, ns(110)),
        after("tRC", Activate, Refresh, Module, ns(110)),
        after("tRC", Refresh, Activate, Module, ns(110)),
        after("tRC", Refresh, Refresh, Module, ns(110)),
    ],
};

/// Bursts that nothing interrupts.
const SDRAM: MemoryModel = MemoryModel {
    kind: MemoryType::Sdram,
    name: "SDRAM, PC133, 16 M × 16",
    source: "Micron MT48LC16M16A2, grade -75, table 12 (AC operating conditions); CAS latency 3 at 133 MHz and 2 at 100; lengths and orders of bursts: its burst definition table",
    clock_hz: Some(133e6),
    ports: 1,
    rows: Some(Rows { banks: 4, groups: 1, words: 512 }),
    burst: 4,
    burst_lengths: &[1, 2, 4, 8],
    burst_order: Some(BurstOrder::Interleaved),
    words_per_tick: 1,
    latency: ns(20),
    refresh_interval: Some(Span { picoseconds: 7_812_500, ..ticks(0) }),
    column_bus: false,
    look_ahead: 8,
    constraints: &[
        after("tRCD", Activate, Read, Bank, ns(20)),
        after("tRCD", Activate, Write, Bank, ns(20)),
        // tCCD is a tick.
        after("burst", Read, Read, Module, ticks(1).behind_burst()),
        after("burst", Write, Write, Module, ticks(1).behind_burst()),
        // The burst leaves after the CAS latency, and the bus turns round in a tick.
        after("burst", Read, Write, Module, Span { ticks: 2, ..ns(20) }.behind_burst()),
        after("tCDL", Write, Read, Module, ticks(1).behind_burst()),
        // CL − 1 ticks before the last word is out.
        after("burst", Read, Precharge, Bank, ticks(1).behind_burst()),
        after("tWR", Write, Precharge, Bank, ns(15).behind_burst()),
        after("tRAS", Activate, Precharge, Bank, ns(44)),
        after("tRP", Precharge, Activate, Bank, ns(20)),
        after("tRP", Precharge, Refresh, Module, ns(20)),
        after("tRC", Activate, Activate, Bank, ns(66)),
        after("tRC", Activate, Refresh, Module, ns(66)),
        after("tRRD", Activate, Activate, Module, ns(15)),
        after("tRFC", Refresh, Activate, Module, ns(66)),
        after("tRFC", Refresh, Refresh, Module, ns(66)),
    ],
};

/// A pseudo-channel: 64 bits wide, bursts of 4 (32 bytes), rows of 1 KiB.
const HBM: MemoryModel = MemoryModel {
    kind: MemoryType::Hbm,
    name: "stacked memory, a pseudo-channel of 64 bits, 1 Gb/s a pin",
    source: "JEDEC JESD235 as in the timing table of Ramulator (HBM, 1 Gb/s, 500 MHz); tRFC of 2 Gb a channel as in Ramulator 2's HBM2",
    clock_hz: Some(500e6),
    ports: 1,
    rows: Some(Rows { banks: 16, groups: 4, words: 512 }),
    burst: 16,
    burst_lengths: &[16],
    burst_order: None,
    words_per_tick: 8,
    latency: ns(14),
    refresh_interval: Some(ns(3900)),
    column_bus: true,
    look_ahead: 8,
    constraints: &[
        after("tRCDRD", Activate, Read, Bank, ns(14)),
        after("tRCDWR", Activate, Write, Bank, ns(12)),
        after("tCCDS", Read, Read, Module, ticks(2)),
        after("tCCDL", Read, Read, Group, ticks(3)),
        after("tCCDS", Write, Write, Module, ticks(2)),
        after("tCCDL", Write, Write, Group, ticks(3)),
        // CL + burst + 2 − CWL.
        after("tRTW", Read, Write, Module, ticks(7)),
        // CWL + burst + tWTR.
        after("tWTRS", Write, Read, Module, ticks(8)),
        after("tWTRL", Write, Read, Group, ticks(10)),
        after("tRTP", Read, Precharge, Bank, ns(14)),
        // CWL + burst + tWR.
        after("tWR", Write, Precharge, Bank, Span { ticks: 6, ..ns(16) }),
        after("tRAS", Activate, Precharge, Bank, ns(34)),
        after("tRP", Precharge, Activate, Bank, ns(14)),
        after("tRP", Precharge, Refresh, Module, ns(14)),
        after("tRC", Activate, Activate, Bank, ns(48)),
        after("tRC", Activate, Refresh, Module, ns(48)),
        after("tRRDS", Activate, Activate, Module, ns(8)),
        after("tRRDL", Activate, Activate, Group, ns(10)),
        Constraint { name: "tFAW", from: Activate, to: Activate, scope: Module, nth: 4, span: ns(40) },
        after("tRFC", Refresh, Activate, Module, ns(160)),
        after("tRFC", Refresh, Refresh, Module, ns(160)),
    ],
};

impl MemoryModel {
    /// The table.
    pub const TABLE: [MemoryModel; 5] = [IDEAL, VRAM, FAST_PAGE, SDRAM, HBM];

    /// Most words that a module can be asked for ahead.
    pub const MOST_AHEAD: usize = 64;

    /// Most banks of a module.
    pub const MOST_BANKS: usize = 16;

    /// Most groups of banks.
    pub const MOST_GROUPS: usize = 4;

    /// Most ticks of a memory clock in a pipeline cycle.
    pub const MOST_TICKS: f64 = 65_536.0;

    /// The row of a type.
    pub fn of(kind: MemoryType) -> &'static MemoryModel {
        match kind {
            MemoryType::Ideal => &IDEAL,
            MemoryType::Vram => &VRAM,
            MemoryType::FastPage => &FAST_PAGE,
            MemoryType::Sdram => &SDRAM,
            MemoryType::Hbm => &HBM,
        }
    }

    /// The model with the bursts and the look-ahead that a machine gives it.
    pub fn of_machine(cfb: &Cfb) -> MemoryModel {
        let model = *MemoryModel::of(cfb.memory);
        MemoryModel {
            burst: cfb.burst_words.unwrap_or(model.burst),
            burst_order: model.burst_order.map(|order| cfb.burst_order.unwrap_or(order)),
            look_ahead: cfb.look_ahead.unwrap_or(model.look_ahead),
            ..model
        }
    }

    /// Words of a module that can have been asked for and not been taken.
    pub fn words_held(cfb: &Cfb) -> usize {
        let model = MemoryModel::of_machine(cfb);
        let of_unit = match cfb.look_ahead_unit {
            LookAheadUnit::Words => 1,
            LookAheadUnit::Bursts => model.burst,
        };
        let behind = match cfb.look_ahead_freed {
            LookAheadFreed::Word => 1,
            LookAheadFreed::Column => 2,
        };
        model.look_ahead * of_unit * behind
    }

    /// Ticks in which the words of a burst leave.
    pub fn burst_ticks(&self) -> u64 {
        self.burst.div_ceil(self.words_per_tick) as u64
    }

    /// Whether a controller knows a constraint. It looks from activates to all but refreshes in the same bank, from reads and writes to
    /// precharges in the same bank, from precharges to activates in it; between reads and writes, and between activates, in the group and
    /// the module, there to the `nth` last activate too; and around refreshes in the module.
    pub fn known(constraint: &Constraint) -> bool {
        let &Constraint { from, to, scope, nth, .. } = constraint;
        let column = |command| matches!(command, Read | Write);
        let known = match scope {
            Bank => match from {
                Activate => to != Refresh,
                Precharge => to == Activate,
                _ => column(from) && to == Precharge,
            },
            Group => column(from) && column(to) || from == Activate && to == Activate,
            Module => match to {
                Activate => matches!(from, Activate | Refresh),
                Refresh => matches!(from, Activate | Precharge | Refresh),
                _ => column(from) && column(to),
            },
        };
        known && (nth == 1 || nth > 1 && scope == Module && from == Activate && to == Activate)
    }

    /// Whether refreshes at a clock leave most of the time to reads: an interval has to hold the closing, the refresh and a row cycle
    /// four times.
    pub fn refreshes_in_time(&self, clock_hz: f64) -> bool {
        let longest = |to| {
            self.constraints
                .iter()
                .filter(|c| c.to == to)
                .map(|c| c.span.ceil(clock_hz, self.burst_ticks()))
                .max()
                .unwrap_or_default()
        };
        let once: u64 = Command::ALL.map(longest).iter().sum();
        self.refresh_interval.is_none_or(|interval| interval.floor(clock_hz, 1) >= 4 * once)
    }
}

impl MachineSpec {
    /// Clock of the memory modules in hertz.
    pub fn memory_clock_hz(&self) -> f64 {
        self.cfb.memory_clock_hz.or(MemoryModel::of(self.cfb.memory).clock_hz).unwrap_or(self.clock_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_every_type_in_its_place_and_powers_of_two() {
        for model in MemoryModel::TABLE {
            assert_eq!(*MemoryModel::of(model.kind), model);
            let file = format!("[cfb]\nmemory = \"{}\"\nmemory_clock_hz = 60e6", model.kind.key());
            assert_eq!(MachineSpec::from_toml(&file, "file").unwrap().cfb.memory, model.kind);
            assert!(model.burst.is_power_of_two() && model.words_per_tick.is_power_of_two());
            assert!((1..=MemoryModel::MOST_AHEAD).contains(&model.look_ahead));
            assert!(model.burst_lengths.contains(&model.burst));
            assert!(model.constraints.iter().all(MemoryModel::known), "{}", model.name);
            if let Some(rows) = model.rows {
                assert!([rows.banks, rows.groups, rows.words].iter().all(|n| n.is_power_of_two()));
                assert!(rows.groups <= rows.banks && model.burst_lengths.iter().all(|&burst| burst <= rows.words));
                assert!(rows.banks <= MemoryModel::MOST_BANKS && rows.groups <= MemoryModel::MOST_GROUPS);
            }
            assert_eq!(model.rows.is_some(), model.refresh_interval.is_some());
            assert!(model.clock_hz.is_none_or(|clock| model.refreshes_in_time(clock)));
        }
    }

    #[test]
    fn a_time_becomes_the_next_whole_tick_and_an_interval_the_one_before() {
        // Micron's example: tRCD of 20 ns at 125 MHz is 2.5 clocks, rounded to 3.
        assert_eq!((ns(20).ceil(125e6, 1), ns(20).floor(125e6, 1)), (3, 2));
        assert_eq!(ns(20).ceil(100e6, 1), 2, "whole already");
        assert_eq!(Span { ticks: 3, ..ns(15) }.ceil(133e6, 4), 5);
        assert_eq!(Span { picoseconds: 7_812_500, ..ticks(0) }.floor(133e6, 4), 1039);
        // Write recovery counts from the last word of a burst.
        assert_eq!([1, 4, 8].map(|burst| ns(15).behind_burst().ceil(133e6, burst)), [2, 5, 9]);
    }

    #[test]
    fn a_machine_sets_bursts_and_look_ahead_and_what_is_held_follows() {
        let cfb = Cfb { memory: MemoryType::Sdram, ..Cfb::default() };
        assert_eq!((MemoryModel::of_machine(&cfb), MemoryModel::words_held(&cfb)), (SDRAM, 8));
        let long = Cfb { burst_words: Some(8), look_ahead: Some(16), look_ahead_unit: LookAheadUnit::Bursts, ..cfb };
        let model = MemoryModel::of_machine(&long);
        assert_eq!((model.burst, model.look_ahead, model.burst_ticks()), (8, 16, 8));
        assert_eq!(MemoryModel::words_held(&long), 16 * 8);
        let column = Cfb { look_ahead_freed: LookAheadFreed::Column, ..long };
        assert_eq!(MemoryModel::words_held(&column), 2 * 16 * 8);
        let hbm = Cfb { memory: MemoryType::Hbm, ..Cfb::default() };
        let model = MemoryModel::of_machine(&hbm);
        assert_eq!((model.burst_order, model.burst_ticks()), (None, 2));
        let sequential = Cfb { burst_order: Some(BurstOrder::Sequential), ..cfb };
        assert_eq!(MemoryModel::of_machine(&sequential).burst_order, Some(BurstOrder::Sequential));
    }
}
