//! What it saves to leave something out.

use cube3_machine::OperatorCounts;

/// Savings of one item, in numbers with a unit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Savings {
    /// Operators of a lane.
    pub operators: OperatorCounts,
    /// Cycles of the picture's frames, from the first fetch to the last pixel, where memory and links keep up.
    pub cycles: u64,
    /// Bytes of memory in the machine.
    pub bytes: u64,
    /// Operations of the picture's frames: each of those operators once for every sample.
    pub operations: u64,
    /// Passes over the volume.
    pub passes: u64,
}

impl Savings {
    /// Of two frames, one after another: memory is there once.
    #[must_use]
    pub fn and(self, other: Savings) -> Savings {
        Savings {
            operators: if other.operators.all() > self.operators.all() { other.operators } else { self.operators },
            cycles: self.cycles + other.cycles,
            bytes: self.bytes.max(other.bytes),
            operations: self.operations + other.operations,
            passes: self.passes + other.passes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_one_after_another_share_the_machine() {
        let frame =
            |bytes, cycles| Savings { bytes, cycles, operators: OperatorCounts::new(1, 0, 0), ..Savings::default() };
        assert_eq!(frame(5, 10).and(frame(7, 20)), frame(7, 30));
    }
}
