//! Unit words in lanes: products and other widths with what depends on the width alone made before, so that a loop over lanes has no branch.

use crate::Rounding;

/// [`unit_mul`](crate::unit_mul) of lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitMul {
    bits: u32,
    before: u32,
    after: u32,
}

impl UnitMul {
    /// For words of `bits`, 1 to 32.
    pub fn new(bits: u32, rounding: Rounding) -> UnitMul {
        match rounding {
            Rounding::Nearest => UnitMul { bits, before: 1 << (bits - 1), after: 0 },
            Rounding::Truncate => UnitMul { bits, before: 0, after: 1 },
        }
    }

    /// The product of words of at most 16 bits, in 32.
    #[inline(always)]
    pub fn narrow(self, a: u32, b: u32) -> u32 {
        let start = a * b + self.before;
        (start + (start >> self.bits) + self.after) >> self.bits
    }

    /// The product of words of any width, in 64 bits.
    #[inline(always)]
    pub fn wide(self, a: u64, b: u64) -> u64 {
        let start = a * b + u64::from(self.before);
        (start + (start >> self.bits) + u64::from(self.after)) >> self.bits
    }
}

/// [`unit_resize`](crate::unit_resize) of lanes: repeated bits are a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitResize {
    repeat: u64,
    drop: u32,
    /// Whether the product has 32 bits at most.
    narrow: bool,
}

impl UnitResize {
    /// From a width to another, 1 to 32 bits each.
    pub fn new(from: u32, to: u32) -> UnitResize {
        if to <= from {
            return UnitResize { repeat: 1, drop: from - to, narrow: true };
        }
        let (mut repeat, mut width) = (1, from);
        while width < to {
            repeat |= repeat << width;
            width *= 2;
        }
        UnitResize { repeat, drop: width - to, narrow: width <= 32 }
    }

    /// A word in the new width.
    #[inline(always)]
    pub fn apply(self, raw: u32) -> u32 {
        if self.narrow { self.apply_narrow(raw) } else { ((u64::from(raw) * self.repeat) >> self.drop) as u32 }
    }

    /// The same to at most 16 bits: the product has 32 at most.
    #[inline(always)]
    pub fn apply_narrow(self, raw: u32) -> u32 {
        (raw * self.repeat as u32) >> self.drop
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{unit_full, unit_mul, unit_resize};
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn products_of_lanes_are_those_of_single_words(bits in 1_u32..=32, a: u32, b: u32, truncate: bool, ends in 0..9_usize) {
            let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
            let full = unit_full(bits);
            let [a, b] = [[a & full, 0, full][ends % 3], [b & full, 0, full][ends / 3]];
            let (product, lanes) = (unit_mul(a, b, bits, rounding), UnitMul::new(bits, rounding));
            prop_assert_eq!(lanes.wide(a.into(), b.into()), u64::from(product));
            if bits <= 16 {
                prop_assert_eq!(lanes.narrow(a, b), product);
            }
        }

        #[test]
        fn lanes_are_resized_as_single_words(from in 1_u32..=32, to in 1_u32..=32, raw: u32, full: bool) {
            let raw = if full { unit_full(from) } else { raw & unit_full(from) };
            let (resized, lanes) = (unit_resize(raw, from, to), UnitResize::new(from, to));
            prop_assert_eq!(lanes.apply(raw), resized);
            if from <= 16 && to <= 16 {
                prop_assert_eq!(lanes.apply_narrow(raw), resized);
            }
        }
    }
}
