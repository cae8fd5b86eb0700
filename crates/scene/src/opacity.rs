//! The opacity of a step that is not of unit length.

/// 1 − (1 − α)^length: the opacity of `length` of a material of which a unit length has `alpha_unit`.
///
/// `alpha_unit` is clamped to 0 to 1, `length` to 0 and up. Computed as
/// −expm1(length·ln(1 − α)), so neither a thin material nor a short step loses digits to the 1. At
/// length 1 the opacity comes out as it went in, to the bit; length 0 is clear, and opacity 1 full at any
/// other length. NaN gives NaN.
pub fn corrected_opacity(alpha_unit: f64, length: f64) -> f64 {
    let alpha = alpha_unit.clamp(0.0, 1.0);
    if alpha == 0.0 || length <= 0.0 {
        // The sum is 0, and keeps a NaN of the other argument.
        return if alpha.is_nan() || length.is_nan() { f64::NAN } else { 0.0 };
    }
    if length == 1.0 {
        return alpha;
    }
    -libm::expm1(length * libm::log1p(-alpha))
}

/// Opacity-weighted colour over a background, held to 0..1.
pub fn over(pixel: [f64; 4], background: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (pixel[i] + (1.0 - pixel[3]) * background[i]).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    /// The largest opacity below 1.
    const ALMOST_FULL: f64 = 1.0 - f64::EPSILON / 2.0;

    fn assert_close(got: f64, expected: f64) {
        assert!((got - expected).abs() <= 1e-14 * expected, "{got:e}, not {expected:e}");
    }

    #[test]
    fn clear_and_full_stay_so_at_every_length() {
        for length in [1e-15, 0.5, 1.0, 1.7, 1e15, f64::INFINITY] {
            assert_eq!(corrected_opacity(0.0, length), 0.0);
            assert_eq!(corrected_opacity(1.0, length), 1.0);
        }
    }

    #[test]
    fn no_length_is_clear_and_unit_length_changes_nothing() {
        // The formula alone changes the last bit of some of these.
        let thousandths = (0..=1000).map(|i| f64::from(i) / 1000.0);
        for alpha in thousandths.chain([1e-300, ALMOST_FULL]) {
            assert_eq!(corrected_opacity(alpha, 0.0), 0.0);
            assert_eq!(corrected_opacity(alpha, 1.0), alpha);
        }
    }

    #[test]
    fn whole_and_half_lengths_agree_with_multiplication() {
        assert_close(corrected_opacity(0.5, 2.0), 0.75);
        assert_close(corrected_opacity(0.75, 0.5), 0.5);
        assert_close(corrected_opacity(0.36, 0.5), 0.2);
    }

    #[test]
    fn thin_material_is_linear_in_length() {
        assert_close(corrected_opacity(1e-300, 1e15), 1e-285);
        assert_close(corrected_opacity(1e-300, 1e-5), 1e-305);
        assert_close(corrected_opacity(1e-20, 1e-3), 1e-23);
        assert_close(corrected_opacity(0.5, 1e-15), 1e-15 * std::f64::consts::LN_2);
    }

    #[test]
    fn dense_material_keeps_its_optical_depth() {
        // 1 − 2⁻⁵³ is an optical depth of 53·ln 2.
        let depth = 53.0 * std::f64::consts::LN_2;
        let short = depth * 1e-15;
        assert_close(corrected_opacity(ALMOST_FULL, 1e-15), short - short * short / 2.0);
        assert_close(corrected_opacity(ALMOST_FULL, 1.0 / 53.0), 0.5);
        assert_eq!(corrected_opacity(ALMOST_FULL, 1e15), 1.0);
        assert_eq!(corrected_opacity(1e-3, 1e15), 1.0);
    }

    #[test]
    fn arguments_outside_are_clamped_and_nan_stays() {
        assert_eq!(corrected_opacity(-0.5, 2.0), 0.0);
        assert_eq!(corrected_opacity(1.5, 2.0), 1.0);
        assert_eq!(corrected_opacity(0.5, -2.0), 0.0);
        assert!(corrected_opacity(f64::NAN, 1.0).is_nan());
        assert!(corrected_opacity(f64::NAN, 0.0).is_nan());
        assert!(corrected_opacity(0.0, f64::NAN).is_nan());
        assert!(corrected_opacity(0.5, f64::NAN).is_nan());
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn two_steps_are_one_step_of_both_lengths(
            alpha in 0.0..=1.0_f64, a in 0.01..3.0_f64, b in 0.01..3.0_f64,
        ) {
            let (first, second) = (corrected_opacity(alpha, a), corrected_opacity(alpha, b));
            let both = corrected_opacity(alpha, a + b);
            prop_assert!((both - (first + (1.0 - first) * second)).abs() < 1e-15 * 4.0);
        }

        #[test]
        fn opacity_grows_with_length_and_stays_in_range(
            exponent in -300.0..0.0_f64, a in -15.0..15.0_f64, b in -15.0..15.0_f64,
        ) {
            let alpha = 10_f64.powf(exponent);
            let (short, long) = (10_f64.powf(a.min(b)), 10_f64.powf(a.max(b)));
            let (less, more) = (corrected_opacity(alpha, short), corrected_opacity(alpha, long));
            prop_assert!(0.0 < less && less <= more && more <= 1.0);
        }
    }
}
