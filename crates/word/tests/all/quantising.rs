//! Reals become the nearest word, on both sides of every step.

use cube3_word::{quantise_fraction, quantise_unit, unit_full};

#[test]
fn a_real_becomes_the_nearest_word() {
    for bits in 1..=12 {
        let full = unit_full(bits);
        for raw in 0..=full {
            for away in [-0.49, -0.01, 0.0, 0.01, 0.49] {
                let unit = (f64::from(raw) + away) / f64::from(full);
                assert_eq!(quantise_unit(unit, bits), raw, "{unit} in {bits} bits");
                let fraction = (f64::from(raw) + away) / f64::from(full + 1);
                assert_eq!(quantise_fraction(fraction, bits), raw, "{fraction} in {bits} bits");
            }
        }
    }
}

#[test]
fn halfway_between_two_words_the_larger_is_taken() {
    // Fractions of 2 are exact in binary.
    for bits in 0..=20 {
        let one = 1_u32 << bits;
        for raw in [0, 1, one / 2, one - 1].into_iter().filter(|&raw| raw < one) {
            let between = (f64::from(raw) + 0.5) / f64::from(one);
            assert_eq!(quantise_fraction(between, bits), raw + 1, "{between} in {bits} bits");
        }
    }
    assert_eq!(quantise_unit(0.5, 1), 1);
}
