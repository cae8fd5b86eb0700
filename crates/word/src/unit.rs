//! Unit words: `raw / (2^bits − 1)`, with 0 and 1 exact; and quantising of reals.

use crate::{Probe, Rounding};

/// The raw value that stands for 1: `2^bits − 1`. `bits` is 1 to 32.
#[inline(always)]
pub fn unit_full(bits: u32) -> u32 {
    u32::MAX >> (32 - bits)
}

/// The product of two unit words of `bits`: `a·b / (2^bits − 1)`, rounded to nearest (ties up) or down.
///
/// The division is exact and needs no divider: with `full = 2^b − 1`, `1/full = 2^−b·(1 + 2^−b + …)`, of which
/// two terms suffice below `full²` (Blinn's rule, here for any width). Either operand full gives the other.
#[inline(always)]
pub fn unit_mul(a: u32, b: u32, bits: u32, rounding: Rounding) -> u32 {
    unit_mul_wires(a, b, bits, rounding, &mut ())
}

/// [`unit_mul`], and what its wires carry.
#[inline(always)]
pub fn unit_mul_wires(a: u32, b: u32, bits: u32, rounding: Rounding, probe: &mut impl Probe) -> u32 {
    let product = u64::from(a) * u64::from(b);
    let start = match rounding {
        Rounding::Nearest => product + (1_u64 << (bits - 1)),
        Rounding::Truncate => product,
    };
    let carried = match rounding {
        Rounding::Nearest => start + (start >> bits),
        Rounding::Truncate => start + (start >> bits) + 1,
    };
    let value = (carried >> bits) as u32;
    probe.wire("product", 0, product.into());
    probe.wire("carried", 0, carried.into());
    probe.wire("value", 0, value.into());
    value
}

/// A unit word in another width. Both ends stay exact.
///
/// Wider repeats the bits (`0b101` in six bits is `0b101101`), which is the exact value where the new
/// width is a multiple of the old one; narrower keeps the leading bits. Both are wiring, not arithmetic.
#[inline(always)]
pub fn unit_resize(raw: u32, from: u32, to: u32) -> u32 {
    if to <= from {
        return raw >> (from - to);
    }
    let mut value = u64::from(raw);
    let mut width = from;
    while width < to {
        value |= value << width;
        width *= 2;
    }
    (value >> (width - to)) as u32
}

/// The nearest unit word of `bits` to `value`; outside [0, 1] the nearer end, and NaN is 0.
pub fn quantise_unit(value: f64, bits: u32) -> u32 {
    let full = f64::from(unit_full(bits));
    (value.clamp(0.0, 1.0) * full).round() as u32
}

/// The nearest fraction of `fraction_bits` to `value`, 0 to `2^fraction_bits`; NaN is 0.
pub fn quantise_fraction(value: f64, fraction_bits: u32) -> u32 {
    let one = f64::from(1_u32 << fraction_bits);
    (value.clamp(0.0, 1.0) * one).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quotients by integers, with the rounding written out.
    fn exact(a: u32, b: u32, bits: u32, rounding: Rounding) -> u64 {
        let (product, full) = (u128::from(a) * u128::from(b), u128::from(unit_full(bits)));
        let quotient = match rounding {
            Rounding::Nearest => (2 * product + full) / (2 * full),
            Rounding::Truncate => product / full,
        };
        quotient as u64
    }

    #[test]
    fn products_of_all_words_up_to_nine_bits_are_exact_quotients() {
        for bits in 1..=9 {
            for a in 0..=unit_full(bits) {
                for b in 0..=unit_full(bits) {
                    for rounding in [Rounding::Nearest, Rounding::Truncate] {
                        assert_eq!(
                            u64::from(unit_mul(a, b, bits, rounding)),
                            exact(a, b, bits, rounding),
                            "{a}·{b}, {bits} bits, {rounding:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn products_at_the_edges_of_wide_words_are_exact_quotients() {
        for bits in 10..=32 {
            let full = unit_full(bits);
            let edges = [0, 1, 2, 3, full / 3, full / 2 - 1, full / 2, full / 2 + 1, full - 2, full - 1, full];
            for a in edges {
                for b in edges {
                    for rounding in [Rounding::Nearest, Rounding::Truncate] {
                        assert_eq!(
                            u64::from(unit_mul(a, b, bits, rounding)),
                            exact(a, b, bits, rounding),
                            "{a}·{b}, {bits} bits, {rounding:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn resizing_keeps_both_ends_and_order() {
        for from in 1..=12 {
            for to in 1..=32 {
                assert_eq!(unit_resize(0, from, to), 0);
                assert_eq!(unit_resize(unit_full(from), from, to), unit_full(to));
                let all: Vec<u32> = (0..=unit_full(from)).map(|raw| unit_resize(raw, from, to)).collect();
                assert!(all.is_sorted(), "{from} to {to}");
            }
        }
        assert_eq!(unit_resize(0b101, 3, 6), 0b10_1101);
        assert_eq!(unit_resize(0b101, 3, 5), 0b1_0110);
    }

    #[test]
    fn quantising_takes_anything() {
        assert_eq!(quantise_unit(f64::NAN, 8), 0);
        assert_eq!(quantise_unit(f64::INFINITY, 8), 255);
        assert_eq!(quantise_unit(-1.0, 8), 0);
        assert_eq!(quantise_unit(1.0, 32), u32::MAX);
        assert_eq!(quantise_fraction(1.0, 8), 256);
        assert_eq!(quantise_fraction(0.5, 0), 1);
    }
}
