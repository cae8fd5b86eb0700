//! Vectors of unit length, from vectors of any length.

use glam::DVec3;

/// `vector` scaled to unit length, or `None` if it is zero or not finite.
///
/// The largest component is brought to 1 first, so no finite vector over- or underflows, a vector
/// along an axis comes out exact, and equal components stay equal. The squares are summed from the smallest
/// up, so that a vector with its components exchanged has them exchanged to the bit.
pub fn unit_vector(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if largest == 0.0 || !vector.is_finite() {
        return None;
    }
    let scaled = vector / largest;
    let mut squares = (scaled * scaled).to_array();
    squares.sort_by(f64::total_cmp);
    Some(scaled / (squares[0] + squares[1] + squares[2]).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn axes_are_exact_at_every_length() {
        for length in [f64::from_bits(1), 1e-300, 0.1, 49.0, f64::MAX] {
            assert_eq!(unit_vector(DVec3::new(0.0, -length, 0.0)), Some(DVec3::NEG_Y));
        }
    }

    #[test]
    fn zero_and_not_finite_have_no_direction() {
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(unit_vector(DVec3::new(0.0, bad, 0.0)), None);
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn has_unit_length_and_the_same_direction(
            v in prop::array::uniform3(-1.0_f64..1.0),
            exponent in -300..300,
        ) {
            prop_assume!(v.iter().any(|c| c.abs() > 1e-3));
            let scale = 10_f64.powi(exponent);
            let unit = unit_vector(DVec3::from(v) * scale).unwrap();
            prop_assert!((unit.length() - 1.0).abs() < 1e-15);
            prop_assert!(unit.cross(DVec3::from(v)).length() < 1e-15);
            prop_assert!(unit.dot(DVec3::from(v)) > 0.0);
        }

        #[test]
        fn exchanged_components_stay_exchanged_to_the_bit(v in prop::array::uniform3(-1.0_f64..1.0)) {
            prop_assume!(v.iter().any(|c| c.abs() > 1e-3));
            let unit = unit_vector(DVec3::from(v)).unwrap();
            prop_assert_eq!(unit_vector(DVec3::new(v[2], v[0], -v[1])), Some(DVec3::new(unit.z, unit.x, -unit.y)));
        }
    }
}
