//! A row of the table of memory modules in ticks of a clock.

use cube3_machine::{BankHash, BurstOrder, Command, Constraint, MachineSpec, MemoryModel, Rows, Scope};

/// Where there is no constraint; far from the end of the type, so that a tick can be added.
const NONE: i64 = i64::MIN / 4;

/// What a module must keep to, in ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Banks and rows, if any.
    pub rows: Option<Rows>,
    /// In which bank a row lies.
    pub hash: BankHash,
    /// Words that a read brings.
    pub burst: usize,
    /// The order of a burst that starts at the word asked for; none where bursts start at their first word.
    pub burst_order: Option<BurstOrder>,
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
    /// Groups of banks; 1 where there are none.
    pub(super) groups: usize,
    /// Whether all distances between activates are the calendar's, and those between reads and writes the module's.
    pub(super) plain: bool,
    /// Bits of a word's number within its row, and of a bank's number.
    pub(super) row_bits: u32,
    pub(super) bank_bits: u32,
    pub(super) delays: Delays,
    /// Least ticks between neighbouring activates of the module and of a group, where they are at most [`Timing::NEAR`]; else 1.
    pub(super) near: [i64; 2],
    /// The other distances between activates of the module or of a group.
    pub(super) spacings: Vec<Spacing>,
    /// No activate that is so far behind another has to do with it.
    pub(super) reach: i64,
}

/// Where a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordPlace {
    /// Its number in the module.
    pub word: u64,
    /// The bank, 0 where there is but one.
    pub bank: usize,
    /// A number that no other row of the bank has.
    pub row: u64,
}

/// Least ticks from a command to another, as [`MemoryModel::known`] lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Delays {
    /// From an activate to the next command of each kind in its bank.
    pub activate: [i64; 4],
    /// From a read, and from a write, to a precharge of its bank.
    pub close: [i64; 2],
    /// From a precharge to an activate of its bank.
    pub open: i64,
    /// Between reads and writes: first index the earlier one.
    pub columns: [[i64; 2]; 2],
    /// The same in a group.
    pub group_columns: [[i64; 2]; 2],
    /// From an activate and from a precharge to a refresh.
    pub to_refresh: [i64; 2],
    /// From a refresh to an activate and to the next refresh.
    pub refresh: [i64; 2],
}

/// So many ticks at least from each activate to the `nth` behind it, in the module or in a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spacing {
    pub of_group: bool,
    pub nth: usize,
    pub ticks: i64,
}

impl Timing {
    /// Distances up to here are kept by a [calendar](super::calendar).
    pub(super) const NEAR: i64 = 32;

    /// The timing of a module at a memory clock in hertz, with the default hash.
    pub fn new(model: &MemoryModel, clock_hz: f64) -> Timing {
        let ticks = |constraint: &Constraint| constraint.span.ceil(clock_hz, model.burst_ticks()) as i64;
        let spaces = |c: &&Constraint| [c.from, c.to] == [Command::Activate; 2] && c.scope != Scope::Bank;
        let all: Vec<Spacing> = model
            .constraints
            .iter()
            .filter(spaces)
            .map(|c| Spacing { of_group: c.scope == Scope::Group, nth: c.nth, ticks: ticks(c) })
            .collect();
        let (near, spacings): (Vec<Spacing>, Vec<Spacing>) =
            all.into_iter().partition(|spacing| spacing.nth == 1 && spacing.ticks <= Timing::NEAR);
        let groups = model.rows.map_or(1, |rows| rows.groups);
        let nearest = |of_group: bool| {
            let spacings = near.iter().filter(|spacing| spacing.of_group == of_group || groups == 1);
            spacings.map(|spacing| spacing.ticks).max().unwrap_or(1).max(1)
        };
        let least = |from: Command, to: Command, scope: Scope| {
            let same = |c: &&Constraint| (c.from, c.to, c.scope) == (from, to, scope);
            model.constraints.iter().filter(same).map(ticks).max().unwrap_or(NONE)
        };
        use Command::{Activate, Precharge, Read, Refresh, Write};
        use Scope::{Bank, Group, Module};
        let columns = |scope| [Read, Write].map(|from| [Read, Write].map(|to| least(from, to, scope)));
        Timing {
            rows: model.rows,
            hash: BankHash::default(),
            burst: model.burst,
            burst_order: model.burst_order,
            words_per_tick: model.words_per_tick,
            latency: model.latency.ceil(clock_hz, model.burst_ticks()) as i64,
            refresh_interval: model.refresh_interval.map(|interval| interval.floor(clock_hz, 1) as i64),
            column_bus: model.column_bus,
            look_ahead: model.look_ahead,
            groups,
            plain: groups == 1 && spacings.is_empty(),
            row_bits: model.rows.map_or(0, |rows| rows.words.trailing_zeros()),
            bank_bits: model.rows.map_or(0, |rows| rows.banks.trailing_zeros()),
            delays: Delays {
                activate: [Activate, Read, Write, Precharge].map(|to| least(Activate, to, Bank)),
                close: [Read, Write].map(|from| least(from, Precharge, Bank)),
                open: least(Precharge, Activate, Bank),
                columns: columns(Module),
                group_columns: columns(Group),
                to_refresh: [Activate, Precharge].map(|from| least(from, Refresh, Module)),
                refresh: [Activate, Refresh].map(|to| least(Refresh, to, Module)),
            },
            reach: spacings.iter().map(|spacing| spacing.ticks).max().unwrap_or(0).max(1),
            near: [nearest(false), nearest(true)],
            spacings,
        }
    }

    /// The timing of the modules of a machine.
    pub fn of(machine: &MachineSpec) -> Timing {
        let model = MemoryModel::of_machine(&machine.cfb);
        Timing { hash: machine.cfb.bank_hash, ..Timing::new(&model, machine.memory_clock_hz()) }
    }

    /// The group of a bank.
    #[inline]
    pub(super) fn group(&self, bank: usize) -> usize {
        bank & (self.groups - 1)
    }

    /// Banks of a module.
    #[inline]
    pub fn banks(&self) -> usize {
        self.rows.map_or(1, |rows| rows.banks)
    }

    /// The bank of a row of words, numbered through the module.
    #[inline(always)]
    pub fn bank(&self, row: u64) -> usize {
        let bits = self.bank_bits;
        match (self.hash, bits) {
            (BankHash::DigitSum, 1 | 2 | 4) => digit_sum(row, bits),
            (hash, _) => (hash.row().bank)(row, bits),
        }
    }

    /// Of the ticks that an activate takes from others of the module how many are before it, and how many there are.
    #[inline(always)]
    pub(super) fn around(&self) -> [u64; 2] {
        let before = self.near[0] as u64 - 1;
        [before, 2 * before + 1]
    }

    /// Where a word is whose bank follows from its number alone.
    #[inline(always)]
    pub fn place(&self, word: u64) -> WordPlace {
        let row = if self.rows.is_some() { word >> self.row_bits } else { 0 };
        WordPlace { word, bank: self.bank(row), row }
    }

    /// Ticks from the first word of a burst to another, where the burst starts at `start`.
    #[inline(always)]
    pub(super) fn behind(&self, word: u64, start: u64) -> i64 {
        let place = match self.burst_order {
            None => word,
            Some(BurstOrder::Interleaved) => word ^ start,
            Some(BurstOrder::Sequential) => word.wrapping_sub(start),
        };
        ((place & (self.burst as u64 - 1)) >> self.words_per_tick.trailing_zeros()) as i64
    }
}

/// The sum of the digits of 1, 2 or 4 bits, modulo their base: neighbouring fields are added until each is a byte, and a product adds the
/// bytes. The definition is [`BankHash::DigitSum`]'s.
#[inline(always)]
fn digit_sum(row: u64, bits: u32) -> usize {
    let halve = |row: u64, bits: u32, mask: u64| (row & mask) + ((row >> bits) & mask);
    let row = if bits == 1 { halve(row, 1, 0x5555_5555_5555_5555) } else { row };
    let row = if bits <= 2 { halve(row, 2, 0x3333_3333_3333_3333) } else { row };
    let bytes = halve(row, 4, 0x0f0f_0f0f_0f0f_0f0f);
    (bytes.wrapping_mul(0x0101_0101_0101_0101) >> 56) as usize & ((1 << bits) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn the_sum_of_digits_is_its_definition(row: u64, shift in 0_u32..64, bits in prop_oneof![Just(1_u32), Just(2), Just(4)]) {
            let row = row >> shift;
            prop_assert_eq!(digit_sum(row, bits), (BankHash::DigitSum.row().bank)(row, bits));
        }
    }
}
