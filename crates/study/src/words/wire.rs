//! The words whose length is varied, and the designs made of them.

use cube3_machine::{ConeKind, ConeOrder, MachineSpec};
use cube3_word::{Length, Rounding, Words};
use serde::Serialize;
use std::ops::RangeInclusive;

/// A word of the machine: a key of `[words]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wire {
    /// Voxel.
    Voxel,
    /// Fraction of interpolation weights.
    Weight,
    /// Bits of a sample below the voxel's.
    SampleFraction,
    /// Gradient component.
    Gradient,
    /// Component of the normalised gradient.
    Normal,
    /// Index of the classification table.
    Table,
    /// Index over the gradient's magnitude.
    TableGradient,
    /// Colour.
    Colour,
    /// Opacity out of the table.
    Opacity,
    /// Colour and opacity in the cone.
    Accumulator,
}

impl Wire {
    /// Every wire, from the memory to the pixel.
    pub const ALL: [Wire; 10] = [
        Wire::Voxel,
        Wire::Weight,
        Wire::SampleFraction,
        Wire::Gradient,
        Wire::Normal,
        Wire::Table,
        Wire::TableGradient,
        Wire::Colour,
        Wire::Opacity,
        Wire::Accumulator,
    ];

    /// Those that reach the cone's arithmetic.
    pub const OF_THE_CONE: [Wire; 3] = [Wire::Colour, Wire::Opacity, Wire::Accumulator];

    /// The length that is varied.
    pub fn length(self) -> &'static Length {
        &Words::LENGTHS[self as usize]
    }

    /// The key in machine files, without `_bits`.
    pub fn name(self) -> &'static str {
        self.length().name.trim_end_matches("_bits")
    }

    /// Legal lengths in bits, where the other words are wide.
    pub fn lengths(self) -> RangeInclusive<u32> {
        self.length().low..=self.length().high
    }

    /// The length in bits.
    pub fn of(self, words: &Words) -> u32 {
        (self.length().of)(words)
    }

    /// The words with another length here. Gradient and table index are no longer than the sample allows.
    pub fn with(self, words: Words, bits: u32) -> Words {
        let mut words = words;
        *(self.length().of_mut)(&mut words) = bits;
        for wire in [Wire::Gradient, Wire::Table] {
            let length = wire.length();
            let allowed = (length.limit)(&words).min((length.of)(&words));
            *(length.of_mut)(&mut words) = allowed;
        }
        words
    }
}

/// Every word at its largest length.
pub fn widest(rounding: Rounding) -> Words {
    let start = Words { rounding, ..Words::default() };
    Wire::ALL.into_iter().fold(start, |words, wire| wire.with(words, *wire.lengths().end()))
}

/// All words of about `bits`: those that have a shorter or longer range take its nearest length, and samples are voxels.
pub fn uniform(bits: u32, rounding: Rounding) -> Words {
    let start = Words { rounding, ..Words::default() };
    Wire::ALL.into_iter().fold(start, |words, wire| {
        let (low, high) = (*wire.lengths().start(), *wire.lengths().end());
        let bits = if wire == Wire::SampleFraction { 0 } else { bits.clamp(low, high) };
        wire.with(words, bits)
    })
}

/// In which order the samples of a ray are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// Neighbours in pairs, level by level.
    Tree,
    /// One behind another from the eye on.
    InOrder,
}

impl Order {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Order::Tree => "tree",
            Order::InOrder => "in order",
        }
    }

    /// What the cone's nodes do.
    pub fn of_cone(self) -> ConeOrder {
        match self {
            Order::Tree => ConeOrder::Tree,
            Order::InOrder => ConeOrder::FrontToBack,
        }
    }
}

/// Order and rounding: the choices beside the lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Variant {
    /// Order in the cone.
    pub order: Order,
    /// Whether products are truncated, and not rounded to nearest.
    pub truncated: bool,
}

impl Variant {
    /// All four.
    pub const ALL: [Variant; 4] = [
        Variant { order: Order::Tree, truncated: false },
        Variant { order: Order::InOrder, truncated: false },
        Variant { order: Order::Tree, truncated: true },
        Variant { order: Order::InOrder, truncated: true },
    ];

    /// The rounding of every shift.
    pub fn rounding(self) -> Rounding {
        if self.truncated { Rounding::Truncate } else { Rounding::Nearest }
    }

    /// The name in tables.
    pub fn name(self) -> String {
        format!("{}, {}", self.order.name(), self.rounding().name())
    }
}

/// Index bits of the tables of a wide design: the longest that machine files take.
const FINE_TABLES: (u32, u32) = (10, 11);

/// A point of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Design {
    /// Word lengths and rounding.
    pub words: Words,
    /// Order in the cone.
    pub order: Order,
    /// Whether the tables of roots and powers are as fine as machine files take, and not the machine's own.
    pub fine_tables: bool,
}

impl Design {
    /// Every word at its largest length, tables as fine as can be.
    pub fn widest(variant: Variant) -> Design {
        Design { words: widest(variant.rounding()), order: variant.order, fine_tables: true }
    }

    /// Words of a machine, whose tables are kept.
    pub fn of(words: Words, variant: Variant) -> Design {
        Design { words: Words { rounding: variant.rounding(), ..words }, order: variant.order, fine_tables: false }
    }

    /// Order and rounding.
    pub fn variant(&self) -> Variant {
        Variant { order: self.order, truncated: self.words.rounding == Rounding::Truncate }
    }

    /// The machine that it is of. Its cone keeps its kind where that has the order; else it is a folded tree or a chain, which
    /// take as many nodes for as many rays.
    pub fn machine(&self, machine: &MachineSpec) -> MachineSpec {
        let mut made = machine.clone();
        if self.fine_tables {
            (made.abc.root_bits, made.abc.power_bits) = FINE_TABLES;
        }
        made = made.with_words(self.words);
        if made.cone.kind.order() != self.order.of_cone() {
            made.cone.kind = match self.order {
                Order::Tree => ConeKind::FoldedTree,
                Order::InOrder => ConeKind::Chain,
            };
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use cube3_machine::PARAMETERS;
    use cube3_parameter::{Legal, Value};
    use proptest::prelude::*;

    #[test]
    fn lengths_are_the_legal_ones() {
        for rounding in [Rounding::Nearest, Rounding::Truncate] {
            let wide = widest(rounding);
            wide.check().unwrap();
            for wire in Wire::ALL {
                let (low, high) = (*wire.lengths().start(), *wire.lengths().end());
                assert_eq!(wire.of(&wide), high);
                wire.with(wide, low).check().unwrap();
                let error = wire.with(wide, high + 1).check().unwrap_err();
                assert_eq!(error.name, format!("{}_bits", wire.name()));
                if low > 0 {
                    let error = wire.with(wide, low - 1).check().unwrap_err();
                    assert_eq!(error.name, format!("{}_bits", wire.name()));
                }
            }
        }
    }

    #[test]
    fn a_wire_is_a_row_of_the_machine() {
        for wire in Wire::ALL {
            let name = format!("{wire:?}").to_lowercase();
            assert_eq!(wire.name().replace('_', ""), name);
            let row = PARAMETERS.iter().find(|row| row.key == format!("words.{}_bits", wire.name())).unwrap();
            let mut machine = MachineSpec { words: widest(Rounding::Nearest), ..MachineSpec::default() };
            for bits in wire.lengths() {
                (row.set)(&mut machine, &Value::Whole(bits.into())).unwrap();
                assert_eq!(wire.of(&machine.words), bits);
            }
            machine.words = widest(Rounding::Nearest);
            let (low, high) = (*wire.lengths().start(), *wire.lengths().end());
            assert_eq!((row.legal)(&machine), Legal::whole(low.into(), high.into()));
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn any_walk_over_the_wires_stays_legal(
            steps in proptest::collection::vec((0_usize..10, 0.0..=1.0_f64), 0..40), uniform_bits in 1_u32..=32,
        ) {
            let part = |range: RangeInclusive<u32>, part: f64| {
                range.start() + (f64::from(range.end() - range.start()) * part) as u32
            };
            let mut words = uniform(uniform_bits, Rounding::Nearest);
            prop_assert!(words.check().is_ok());
            for (wire, at) in steps {
                let wire = Wire::ALL[wire];
                let bits = part(wire.lengths(), at);
                // Gradient and table index follow the sample.
                words = wire.with(words, bits);
                prop_assert!(words.check().is_ok(), "{words:?}");
                let machine = Design { words, order: Order::InOrder, fine_tables: true }.machine(&MachineSpec::default());
                prop_assert!(machine.check("design").is_ok());
                prop_assert_eq!(machine.cone.kind, ConeKind::Chain);
            }
        }
    }
}
