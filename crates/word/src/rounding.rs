//! Rounding shifts, saturation and the linear interpolation built from them.

use crate::Probe;
use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// What happens to the bits that a right shift drops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Rounding {
    /// To the nearest value, ties towards +∞: half is added before the shift.
    #[default]
    Nearest,
    /// Towards −∞: the bits are dropped.
    Truncate,
}

impl Rounding {
    /// The name in machine files.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// `value / 2^bits`, rounded. `bits` is 0 to 62.
    #[inline(always)]
    pub fn shift_right(self, value: i64, bits: u32) -> i64 {
        self.by(bits).apply(value)
    }

    /// The shift as two constants, for loops that apply it to many values.
    #[inline(always)]
    pub fn by(self, bits: u32) -> Shift {
        let half = match self {
            Rounding::Nearest if bits > 0 => 1_i64 << (bits - 1),
            _ => 0,
        };
        Shift { half, bits }
    }
}

/// A rounding right shift: add `half`, then shift by `bits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shift {
    /// What is added before the shift.
    pub half: i64,
    /// How many bits are dropped.
    pub bits: u32,
}

impl Shift {
    /// The shift of a wide value.
    #[inline(always)]
    pub fn apply(self, value: i64) -> i64 {
        (value + self.half) >> self.bits
    }

    /// The same in 32 bits, for values whose sum with `half` is known to fit.
    #[inline(always)]
    pub fn apply32(self, value: i32) -> i32 {
        (value + self.half as i32) >> self.bits
    }
}

/// Linear interpolation of two words, as the TRILIN unit's multiplier rounds it.
///
/// `weight` is a fraction of `fraction_bits`, 0 to `2^fraction_bits` inclusive; the ends give `near` and `far`
/// exactly, and every weight gives a value between them, so the result has the operands' format and
/// cannot overflow. Pfister et al. 1995, section 3.
#[inline(always)]
pub fn lerp(near: i32, far: i32, weight: u32, fraction_bits: u32, rounding: Rounding) -> i32 {
    lerp_wires(near, far, weight, fraction_bits, rounding, &mut ())
}

/// [`lerp`], and what its wires carry.
#[inline(always)]
pub fn lerp_wires(
    near: i32,
    far: i32,
    weight: u32,
    fraction_bits: u32,
    rounding: Rounding,
    probe: &mut impl Probe,
) -> i32 {
    let difference = i64::from(far) - i64::from(near);
    let product = difference * i64::from(weight);
    let step = rounding.shift_right(product, fraction_bits);
    let value = (i64::from(near) + step) as i32;
    probe.wire("difference", 0, difference.into());
    probe.wire("product", 0, product.into());
    probe.wire("step", 0, step.into());
    probe.wire("value", 0, value.into());
    value
}

/// The nearest value that a signed word of `bits` (1 to 32) can hold, and whether it differs.
#[inline(always)]
pub fn saturate(value: i64, bits: u32) -> (i32, bool) {
    let top = (1_i64 << (bits - 1)) - 1;
    let held = value.clamp(-top - 1, top);
    (held as i32, held != value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn nearest_rounds_ties_up_and_truncate_rounds_down() {
        let expected = [(-3, -1, -2), (-2, -1, -1), (-1, 0, -1), (1, 1, 0), (3, 2, 1), (5, 3, 2)];
        for (value, nearest, truncated) in expected {
            assert_eq!(Rounding::Nearest.shift_right(value, 1), nearest, "{value}");
            assert_eq!(Rounding::Truncate.shift_right(value, 1), truncated, "{value}");
        }
        assert_eq!(Rounding::Nearest.shift_right(7, 0), 7);
    }

    #[test]
    fn lerp_of_every_small_word_is_the_rounded_real_value() {
        for fraction_bits in 0..=4 {
            let one = 1_u32 << fraction_bits;
            for near in -8..8 {
                for far in -8..8 {
                    for weight in 0..=one {
                        let real = f64::from(near) + f64::from(far - near) * f64::from(weight) / f64::from(one);
                        let nearest = lerp(near, far, weight, fraction_bits, Rounding::Nearest);
                        let truncated = lerp(near, far, weight, fraction_bits, Rounding::Truncate);
                        assert_eq!(f64::from(nearest), (real + 0.5).floor());
                        assert_eq!(f64::from(truncated), real.floor());
                    }
                }
            }
        }
    }

    #[test]
    fn saturation_holds_the_ends_of_every_width() {
        for bits in 1..=32 {
            let top = (1_i64 << (bits - 1)) - 1;
            assert_eq!(saturate(top, bits), (top as i32, false));
            assert_eq!(saturate(top + 1, bits), (top as i32, true));
            assert_eq!(saturate(-top - 1, bits), ((-top - 1) as i32, false));
            assert_eq!(saturate(-top - 2, bits), ((-top - 1) as i32, true));
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn lerp_stays_between_its_ends_and_meets_them(
            near in -(1_i32 << 24)..1 << 24, far in -(1_i32 << 24)..1 << 24,
            fraction_bits in 0_u32..=16, part in 0.0..=1.0_f64, truncate: bool,
        ) {
            let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
            let one = 1_u32 << fraction_bits;
            let weight = (part * f64::from(one)) as u32;
            let value = lerp(near, far, weight, fraction_bits, rounding);
            prop_assert!(value >= near.min(far) && value <= near.max(far));
            prop_assert_eq!(lerp(near, far, 0, fraction_bits, rounding), near);
            prop_assert_eq!(lerp(near, far, one, fraction_bits, rounding), far);
        }
    }
}
