//! What it saves to leave something out.

use crate::count;
use cube3_machine::OperatorCounts;
use serde::{Deserialize, Serialize};

/// Savings, in numbers with a unit each.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavingsReport {
    /// Operators of a lane.
    pub operators_per_lane: OperatorCounts,
    /// Cycles of the picture's frames, from the first fetch to the last pixel, where memory and links keep up.
    pub cycles: u64,
    /// Bytes of memory in the machine.
    pub bytes: u64,
    /// Operations of the picture's frames: each of those operators once for every sample.
    pub operations: u64,
    /// Passes over the volume.
    pub passes: u64,
}

impl SavingsReport {
    /// In words, without what is 0: "3 multipliers and 4 adders a lane, 1,024 bytes, 2,097,152 operations".
    pub fn in_words(&self) -> String {
        let OperatorCounts { multipliers, adders, comparators, dividers } = self.operators_per_lane;
        let kinds = [
            (multipliers, ["multiplier", "multipliers"]),
            (adders, ["adder", "adders"]),
            (comparators, ["comparator", "comparators"]),
            (dividers, ["divider", "dividers"]),
        ];
        let mut operators = counted(&kinds);
        let mut parts = Vec::new();
        if let Some(last) = operators.pop() {
            let before = if operators.is_empty() { String::new() } else { format!("{} and ", operators.join(", ")) };
            parts.push(format!("{before}{last} a lane"));
        }
        parts.extend(counted(&[
            (self.bytes, ["byte", "bytes"]),
            (self.cycles, ["cycle", "cycles"]),
            (self.operations, ["operation", "operations"]),
            (self.passes, ["pass", "passes"]),
        ]));
        if parts.is_empty() { "nothing".into() } else { parts.join(", ") }
    }
}

/// So many of each, without those of which there are none.
fn counted(amounts: &[(u64, [&str; 2])]) -> Vec<String> {
    let there = amounts.iter().filter(|(amount, _)| *amount > 0);
    there.map(|&(amount, [one, many])| format!("{} {}", count(amount), if amount == 1 { one } else { many })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn savings_are_said_in_words() {
        assert_eq!(SavingsReport::default().in_words(), "nothing");
        let operators_per_lane = OperatorCounts { multipliers: 3, adders: 1, comparators: 0, dividers: 2 };
        let all = SavingsReport { operators_per_lane, cycles: 1, bytes: 1024, operations: 9_000, passes: 5 };
        assert_eq!(
            all.in_words(),
            "3 multipliers, 1 adder and 2 dividers a lane, 1,024 bytes, 1 cycle, 9,000 operations, 5 passes"
        );
        let operators_per_lane = OperatorCounts::new(0, 12, 0);
        assert_eq!(SavingsReport { operators_per_lane, ..SavingsReport::default() }.in_words(), "12 adders a lane");
    }
}
