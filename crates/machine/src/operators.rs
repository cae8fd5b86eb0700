//! Operators of a lane's parts, counted from word lengths: what an architect pays for a unit, and saves without it.
//!
//! They are those of the units' definitions, one for one, as the synthesizer finds them: a lerp is a multiplier, a subtracter and an adder,
//! and an adder more where the product is rounded to nearest and drops bits. Shifts, selections and table look-ups are none.

use crate::{GradientMethod, MachineSpec, ShadingUnit};
use cube3_word::{Rounding, Words};
use serde::{Deserialize, Serialize};

/// Operators, by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OperatorCounts {
    /// Multipliers.
    pub multipliers: u64,
    /// Adders and subtracters; the one that rounds a product counts.
    pub adders: u64,
    /// Comparators of magnitude.
    pub comparators: u64,
    /// Dividers.
    pub dividers: u64,
}

impl OperatorCounts {
    /// Operators without a divider.
    pub const fn new(multipliers: u64, adders: u64, comparators: u64) -> Self {
        Self { multipliers, adders, comparators, dividers: 0 }
    }

    /// So many of each.
    pub const fn times(self, count: u64) -> Self {
        Self {
            multipliers: self.multipliers * count,
            adders: self.adders * count,
            comparators: self.comparators * count,
            dividers: self.dividers * count,
        }
    }

    /// All of them, of whatever kind.
    pub const fn all(self) -> u64 {
        self.multipliers + self.adders + self.comparators + self.dividers
    }
}

impl std::ops::Add for OperatorCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            multipliers: self.multipliers + other.multipliers,
            adders: self.adders + other.adders,
            comparators: self.comparators + other.comparators,
            dividers: self.dividers + other.dividers,
        }
    }
}

impl std::iter::Sum for OperatorCounts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |sum, counts| sum + counts)
    }
}

/// The adder that rounds to nearest, where any bits are dropped: 1 or 0.
pub fn rounds(words: &Words, dropped: u32) -> u64 {
    u64::from(words.rounding == Rounding::Nearest && dropped > 0)
}

/// A linear interpolation.
pub fn lerp(words: &Words) -> OperatorCounts {
    OperatorCounts::new(1, 2 + rounds(words, words.weight_bits), 0)
}

/// A product of unit words. Blinn's division: one addition before, one between the shifts, and one more when it truncates.
pub const UNIT_MUL: OperatorCounts = OperatorCounts::new(1, 2, 0);

/// A gradient estimator: the differences of each component, and their sum.
pub fn gradient(method: GradientMethod, words: &Words) -> OperatorCounts {
    let (row, pairs) = (method.row(), u64::from(method.row().pairs()));
    let differences = OperatorCounts::new(0, 3 * (2 * pairs - 1), 0) + lerp(words).times(u64::from(row.lerps()));
    if row.sheared {
        differences + OperatorCounts::new(2, 2 + rounds(words, words.weight_bits), 0)
    } else {
        differences
    }
}

/// Factors of a gradient's components, whose products drop so many bits.
pub fn gradient_scale(words: &Words, dropped: u32) -> OperatorCounts {
    OperatorCounts::new(3, 3 * rounds(words, dropped), 0)
}

/// A gradient's components held in their words; an estimator's weights exceed 1 by so many bits.
pub fn gradient_word(words: &Words, extra_bits: u32) -> OperatorCounts {
    OperatorCounts::new(0, 3 * rounds(words, words.gradient_drop() + extra_bits), 6)
}

/// The normaliser: magnitudes, squares and their sum, the products with the root, rounded, held at one, and the signs.
pub const NORMALISER: OperatorCounts = OperatorCounts::new(6, 3 + 2 + 3 + 3, 3);

/// A gradient's magnitude: what a two-dimensional opacity table is read with.
pub const MAGNITUDE: OperatorCounts = OperatorCounts::new(3, 3, 0);

/// The row of a two-dimensional opacity table: held at the last.
pub const ROW: OperatorCounts = OperatorCounts::new(0, 0, 1);

/// Both ends of the threshold.
pub const THRESHOLD: OperatorCounts = OperatorCounts::new(0, 0, 2);

/// Shading of a light: two cosines, the power table's index, three diffuse and three specular products and sums.
pub fn light(machine: &MachineSpec) -> OperatorCounts {
    let words = &machine.words;
    let one_bits = words.normal_bits - 1;
    let cosine = OperatorCounts::new(3, 2 + 1 + rounds(words, one_bits), 1);
    let products = OperatorCounts::new(6, 3 * rounds(words, one_bits) + 3 * rounds(words, words.colour_bits) + 6, 0);
    let index = OperatorCounts::new(0, rounds(words, one_bits.saturating_sub(machine.abc.power_bits)), 0);
    cosine.times(2) + index + products
}

/// A gradient's face and place on it: the address of the reflectance table.
pub const DIRECTION: OperatorCounts = OperatorCounts { multipliers: 0, adders: 3 + 2, comparators: 2 + 2, dividers: 2 };

/// A shading unit of so many lights.
pub fn shading(machine: &MachineSpec, lights: u64) -> OperatorCounts {
    match machine.abc.shading {
        ShadingUnit::Phong => light(machine).times(lights),
        ShadingUnit::ReflectanceTable => DIRECTION,
    }
}

/// Colour times light, and what is mirrored.
pub fn lit_colour(words: &Words) -> OperatorCounts {
    OperatorCounts::new(3, 3 * rounds(words, words.colour_bits) + 3, 3)
}

/// Depth cueing: a step, a clamp, and three products with a factor of so many bits.
pub fn depth_cue(words: &Words, factor_bits: u32) -> OperatorCounts {
    OperatorCounts::new(3, 1 + 3 * rounds(words, factor_bits), 2)
}

/// So many half-spaces that samples must lie in: a step and a comparison each.
pub fn half_spaces(count: u64) -> OperatorCounts {
    OperatorCounts::new(0, count, count)
}
