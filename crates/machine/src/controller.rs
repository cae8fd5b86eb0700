//! How the controller of a memory module works: the choices of a machine file.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// In which bank a row of words lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum BankHash {
    /// The lowest digit of the row's number to the base of the banks.
    Plain,
    /// The exclusive or of its lowest three digits.
    Xor,
    /// The sum of all its digits, modulo the banks.
    #[default]
    DigitSum,
}

/// A row of the table of hashes.
#[derive(Clone, Copy, Debug)]
pub struct BankHashRow {
    /// The hash.
    pub hash: BankHash,
    /// Its name in machine files.
    pub name: &'static str,
    /// Where it is from.
    pub source: &'static str,
    /// The bank of a row, numbered through the module, of `1 << bits` banks.
    pub bank: fn(row: u64, bits: u32) -> usize,
}

impl BankHash {
    /// The table.
    pub const TABLE: [BankHashRow; 3] = [
        BankHashRow {
            hash: BankHash::Plain,
            name: "plain",
            source: "neighbouring rows in neighbouring banks, as data sheets have it",
            bank: plain,
        },
        BankHashRow {
            hash: BankHash::Xor,
            name: "xor",
            source: "Zhang, Zhu, Zhang 2000, permutation-based page interleaving, with a digit more",
            bank: exclusive_or,
        },
        BankHashRow {
            hash: BankHash::DigitSum,
            name: "digit-sum",
            source: "ours; linear skewing of Budnik and Kuck 1971, with a skew of 1 at every digit",
            bank: digit_sum,
        },
    ];

    /// The row of a hash.
    pub fn row(self) -> &'static BankHashRow {
        match self {
            BankHash::Plain => &Self::TABLE[0],
            BankHash::Xor => &Self::TABLE[1],
            BankHash::DigitSum => &Self::TABLE[2],
        }
    }
}

fn plain(row: u64, bits: u32) -> usize {
    (row & ((1 << bits) - 1)) as usize
}

fn exclusive_or(row: u64, bits: u32) -> usize {
    plain(row ^ (row >> bits) ^ (row >> (2 * bits)), bits)
}

fn digit_sum(row: u64, bits: u32) -> usize {
    let mut sum = 0;
    let mut rest = row;
    while bits > 0 && rest > 0 {
        sum += plain(rest, bits);
        rest >>= bits;
    }
    plain(sum as u64, bits)
}

/// In which order the words of a burst come that starts at the word asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum BurstOrder {
    /// Word p of a burst that starts at word s comes in place p ⊕ s.
    Interleaved,
    /// In place (p − s) mod the burst.
    Sequential,
}

/// What the look-ahead of a module counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum LookAheadUnit {
    /// Words; under the scan of beams, steps.
    #[default]
    Words,
    /// Bursts: a step for which no module reads a new burst does not count. At most as many steps as these bursts have words.
    Bursts,
}

/// When a place of the look-ahead is free again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum LookAheadFreed {
    /// When the pipeline takes the word.
    #[default]
    Word,
    /// When its read has been issued. At most as many that have been read wait at the outputs.
    Column,
}

/// In which order a module serves the words that it is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ControllerKind {
    /// Reads in the order of the words; rows are opened ahead.
    #[default]
    InOrder,
    /// Words of open rows first, then the oldest.
    FrFcfs,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MachineSpec;

    #[test]
    fn the_table_has_every_hash_in_its_place_by_its_name_in_files() {
        for row in &BankHash::TABLE {
            assert_eq!(row.hash.row().name, row.name);
            let file = format!("[cfb]\nbank_hash = \"{}\"", row.name);
            assert_eq!(MachineSpec::from_toml(&file, "file").unwrap().cfb.bank_hash, row.hash);
        }
        assert_eq!(BankHash::default(), BankHash::DigitSum);
    }

    /// Rows i · banksᵏ of i = 0 … banks − 1 lie in all banks, whatever k. Of three digits that holds to k = 2, of one at k = 0.
    #[test]
    fn rows_a_power_of_the_banks_apart_are_in_all_banks() {
        for bits in 1..=4 {
            let banks = 1_u64 << bits;
            for row in &BankHash::TABLE {
                let met = |k: u32| {
                    let mut met: Vec<usize> = (0..banks).map(|i| (row.bank)(i << (bits * k), bits)).collect();
                    met.sort_unstable();
                    met.dedup();
                    met.len() as u64
                };
                let all = (0..).take_while(|&k| k < 60 / bits && met(k) == banks).count() as u32;
                let expected = match row.hash {
                    BankHash::Plain => 1,
                    BankHash::Xor => 3,
                    BankHash::DigitSum => 60 / bits,
                };
                assert_eq!(all, expected.min(60 / bits), "{} of {banks} banks", row.name);
            }
        }
    }

    #[test]
    fn one_bank_takes_every_row() {
        for row in &BankHash::TABLE {
            assert!((0..100).chain([u64::MAX]).all(|n| (row.bank)(n, 0) == 0));
        }
    }
}
