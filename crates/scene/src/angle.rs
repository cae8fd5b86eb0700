//! Sine and cosine of an angle in degrees, exact where a symmetric view needs it.

use std::f64::consts::FRAC_1_SQRT_2;

/// √3/2, the cosine of 30°.
const HALF_SQRT_3: f64 = 0.866_025_403_784_438_6;

/// Sine and cosine of `angle_deg`, reduced exactly, so that the symmetries of the circle hold to the
/// bit.
///
/// Multiples of 90° give 0 and ±1, odd multiples of 45° give two equal magnitudes, sin(−x) = −sin x,
/// cos(−x) = cos x, and sin x = cos(90° − x) whenever 90° − x is exact. Without this, a view at 45°
/// would have two slopes an ulp apart and choose another major axis than its mirror image. An
/// angle that is not finite gives NaN.
pub fn sin_cos_degrees(angle_deg: f64) -> (f64, f64) {
    // Each step is exact: a remainder always is, and the differences are of numbers within a factor
    // of two of each other (Sterbenz).
    let turn = (angle_deg % 360.0).abs();
    let (sine, cosine) = match turn {
        _ if turn < 90.0 => first_quadrant(turn),
        _ if turn < 180.0 => {
            let (s, c) = first_quadrant(turn - 90.0);
            (c, -s)
        }
        _ if turn < 270.0 => {
            let (s, c) = first_quadrant(turn - 180.0);
            (-s, -c)
        }
        _ => {
            let (s, c) = first_quadrant(turn - 270.0);
            (-c, s)
        }
    };
    (if angle_deg < 0.0 { -sine } else { sine }, cosine)
}

/// Sine and cosine from 0° up to, not including, 90°.
fn first_quadrant(angle_deg: f64) -> (f64, f64) {
    if angle_deg > 45.0 {
        let (s, c) = first_octant(90.0 - angle_deg);
        (c, s)
    } else {
        first_octant(angle_deg)
    }
}

/// Sine and cosine from 0° to 45°.
fn first_octant(angle_deg: f64) -> (f64, f64) {
    if angle_deg == 45.0 {
        (FRAC_1_SQRT_2, FRAC_1_SQRT_2)
    } else if angle_deg == 30.0 {
        (0.5, HALF_SQRT_3)
    } else {
        libm::sincos(angle_deg.to_radians())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn quarter_turns_are_exact() {
        let quarters = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for i in -9_i32..=9 {
            let expected = quarters[i.rem_euclid(4) as usize];
            assert_eq!(sin_cos_degrees(90.0 * f64::from(i)), expected, "{i} quarters");
        }
        assert_eq!(sin_cos_degrees(360.0 * 2_f64.powi(60) + 0.0), (0.0, 1.0));
    }

    #[test]
    fn eighth_turns_have_equal_magnitudes() {
        for i in -9_i32..=9 {
            let (s, c) = sin_cos_degrees(45.0 + 90.0 * f64::from(i));
            assert_eq!((s.abs(), c.abs()), (FRAC_1_SQRT_2, FRAC_1_SQRT_2));
        }
    }

    #[test]
    fn an_angle_an_ulp_off_is_not_snapped() {
        let (s, c) = sin_cos_degrees(45_f64.next_down());
        assert!(s <= c);
        let (s, _) = sin_cos_degrees(180_f64.next_down());
        assert!(s > 0.0);
        assert_eq!(sin_cos_degrees(1e-300).0, 1e-300_f64.to_radians());
    }

    #[test]
    fn angles_that_are_not_finite_give_nan() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(sin_cos_degrees(angle).0.is_nan() && sin_cos_degrees(angle).1.is_nan());
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn agrees_with_radians(angle in -720.0..720.0) {
            let (s, c) = sin_cos_degrees(angle);
            let radians = angle.to_radians();
            prop_assert!((s - radians.sin()).abs() < 4e-15 && (c - radians.cos()).abs() < 4e-15);
        }

        #[test]
        fn the_symmetries_of_the_circle_hold_to_the_bit(sixteenths in -5760_i32..5760) {
            let angle = f64::from(sixteenths) / 16.0;
            let (s, c) = sin_cos_degrees(angle);
            prop_assert_eq!(sin_cos_degrees(-angle), (-s, c));
            prop_assert_eq!(sin_cos_degrees(90.0 - angle), (c, s));
            prop_assert_eq!(sin_cos_degrees(180.0 - angle), (s, -c));
            prop_assert_eq!(sin_cos_degrees(360.0 + angle), (s, c));
        }
    }
}
