//! Discs of complex numbers around a real one, and where functions take them.

/// All complex numbers whose distance from `mid` is at most `radius`, 0 and up.
///
/// An operation gives a disc that holds the result for every number of its operands. Of a function whose power series about `mid` is
/// known the radius is where the series of the coefficients' magnitudes ends, which no smaller disc around the same middle beats. Rounding
/// of the radius itself is not counted here: what is made of it is widened once ([`crate::panel`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disc {
    pub mid: f64,
    pub radius: f64,
}

impl Disc {
    pub fn new(mid: f64, radius: f64) -> Disc {
        Disc { mid, radius }
    }

    /// What a polynomial in ζ takes |ζ| ≤ `reach` to.
    #[inline]
    pub fn of_polynomial(coefficients: &[f64], reach: f64) -> Disc {
        let radius = coefficients[1..].iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * reach);
        Disc { mid: coefficients[0], radius }
    }

    /// The largest magnitude in it.
    #[inline]
    pub fn largest(self) -> f64 {
        self.mid.abs() + self.radius
    }

    #[inline]
    pub fn plus(self, other: Disc) -> Disc {
        Disc::new(self.mid + other.mid, self.radius + other.radius)
    }

    #[inline]
    pub fn scaled(self, by: f64) -> Disc {
        Disc::new(self.mid * by, self.radius * by.abs())
    }

    /// a + b·z.
    #[inline]
    pub fn affine(self, a: f64, b: f64) -> Disc {
        Disc::new(a + b * self.mid, self.radius * b.abs())
    }

    #[inline]
    pub fn times(self, other: Disc) -> Disc {
        let radius = self.mid.abs() * other.radius + self.radius * (other.mid.abs() + other.radius);
        Disc::new(self.mid * other.mid, radius)
    }

    /// √z; none where the disc reaches 0. The series of √(c − x) has one sign but for its first term, so the farthest is √(c − r).
    #[inline]
    pub fn sqrt(self) -> Option<Disc> {
        let least = self.mid - self.radius;
        if least > 0.0 {
            let (middle, least) = (self.mid.sqrt(), least.sqrt());
            return Some(Disc::new(middle, self.radius / (middle + least)));
        }
        None
    }

    /// 1/√z; none where the disc reaches 0. As [`Disc::sqrt`], the farthest is 1/√(c − r).
    #[inline]
    pub fn inverse_sqrt(self) -> Option<Disc> {
        let root = self.sqrt()?;
        let least = (self.mid - self.radius).sqrt();
        Some(Disc::new(1.0 / root.mid, root.radius / (root.mid * least)))
    }

    /// −ln z; none where the disc reaches 0. The farthest is −ln(c − r).
    #[inline]
    pub fn minus_ln(self) -> Option<Disc> {
        // Of numbers that are not numbers nothing is said.
        if self.radius < self.mid {
            let radius = if self.radius == 0.0 { 0.0 } else { -libm::log1p(-self.radius / self.mid) };
            return Some(Disc::new(-libm::log(self.mid), radius));
        }
        None
    }

    /// z to a power above 0: of a whole one by its expansion, wherever the disc lies; of another by (1 − r/c)^−s − 1, which bounds
    /// |(1 + x)^s − 1| for |x| ≤ r/c, and not where the disc reaches 0.
    #[inline]
    pub fn power(self, exponent: f64) -> Option<Disc> {
        if self.radius == 0.0 {
            return (self.mid >= 0.0 || is_whole(exponent)).then(|| Disc::new(libm::pow(self.mid, exponent), 0.0));
        }
        if self.radius < self.mid {
            let middle = libm::pow(self.mid, exponent);
            let ratio = self.radius / self.mid;
            // Of a whole power the expansion is (1 + r/c)^s − 1, which is less.
            let growth = if is_whole(exponent) { libm::log1p(ratio) } else { -libm::log1p(-ratio) };
            return Some(Disc::new(middle, middle * libm::expm1(exponent * growth)));
        }
        if !is_whole(exponent) {
            return None;
        }
        let (middle, all) = (libm::pow(self.mid, exponent), libm::pow(self.largest(), exponent));
        Some(Disc::new(middle, all - middle.abs()))
    }
}

/// Whether a power is a whole number, of which every polynomial's power is one.
pub(crate) fn is_whole(exponent: f64) -> bool {
    exponent.fract() == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    /// A complex number by its parts; enough of them to try what the discs say.
    #[derive(Clone, Copy)]
    struct Complex(f64, f64);

    impl Complex {
        fn polar(magnitude: f64, angle: f64) -> Complex {
            Complex(magnitude * angle.cos(), magnitude * angle.sin())
        }
        fn times(self, other: Complex) -> Complex {
            Complex(self.0 * other.0 - self.1 * other.1, self.0 * other.1 + self.1 * other.0)
        }
        fn power(self, exponent: f64) -> Complex {
            Complex::polar(self.0.hypot(self.1).powf(exponent), self.1.atan2(self.0) * exponent)
        }
        fn ln(self) -> Complex {
            Complex(self.0.hypot(self.1).ln(), self.1.atan2(self.0))
        }
        fn is_in(self, disc: Disc) -> bool {
            (self.0 - disc.mid).hypot(self.1) <= disc.radius * (1.0 + 1e-12) + 1e-13 * disc.largest().max(1e-3)
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        /// Each function takes every number of a disc into the disc that it gives, and some number of the edge near to its edge.
        #[test]
        fn what_a_function_gives_lies_in_its_disc(
            mid in 0.01..3.0_f64, part in 0.0..0.999_f64, angle in 0.0..6.3_f64, within in 0.0..=1.0_f64,
            exponent in prop_oneof![0.1..40.0_f64, (1..40_u32).prop_map(f64::from)], other in -2.0..2.0_f64,
        ) {
            let disc = Disc::new(mid, mid * part);
            let at = |angle: f64, within: f64| {
                let edge = Complex::polar(disc.radius * within, angle);
                Complex(mid + edge.0, edge.1)
            };
            let z = at(angle, within);
            prop_assert!(z.power(0.5).is_in(disc.sqrt().unwrap()));
            prop_assert!(z.power(-0.5).is_in(disc.inverse_sqrt().unwrap()));
            prop_assert!(z.power(exponent).is_in(disc.power(exponent).unwrap()));
            let ln = z.ln();
            prop_assert!(Complex(-ln.0, -ln.1).is_in(disc.minus_ln().unwrap()));
            let second = Disc::new(other, 0.3);
            let w = Complex(other + 0.3 * angle.sin(), 0.3 * angle.cos());
            prop_assert!(z.times(w).is_in(disc.times(second)));
            prop_assert!(Complex(z.0 + w.0, z.1 + w.1).is_in(disc.plus(second)));
            // The nearest to 0 is where roots and logarithm are farthest from the middle.
            let least = at(std::f64::consts::PI, 1.0).0;
            let near = |distance: f64, disc: Disc| (distance - disc.radius).abs() <= 1e-9 * (1.0 + disc.radius);
            prop_assert!(near(mid.sqrt() - least.sqrt(), disc.sqrt().unwrap()));
            prop_assert!(near(1.0 / least.sqrt() - 1.0 / mid.sqrt(), disc.inverse_sqrt().unwrap()));
            prop_assert!(near((mid / least).ln(), disc.minus_ln().unwrap()));
        }

        #[test]
        fn a_whole_power_is_known_of_a_disc_around_zero(
            mid in -1.0..1.0_f64, radius in 0.0..2.0_f64, angle in 0.0..6.3_f64, exponent in 1..12_u32,
        ) {
            let z = Complex(mid + radius * angle.cos(), radius * angle.sin());
            let power = (1..exponent).fold(z, |power, _| power.times(z));
            prop_assert!(power.is_in(Disc::new(mid, radius).power(f64::from(exponent)).unwrap()));
        }

        #[test]
        fn a_polynomial_stays_in_its_disc(
            c in prop::array::uniform4(-2.0..2.0_f64), reach in 0.0..3.0_f64, angle in 0.0..6.3_f64,
        ) {
            let z = Complex::polar(reach, angle);
            let value = c.iter().rev().fold(Complex(0.0, 0.0), |sum, &c| {
                let product = sum.times(z);
                Complex(product.0 + c, product.1)
            });
            prop_assert!(value.is_in(Disc::of_polynomial(&c, reach)));
        }
    }

    /// Of an exponent below 1 the farthest is beside 0, not on the other side.
    #[test]
    fn a_root_as_a_power_reaches_to_the_root_of_what_is_left() {
        let disc = Disc::new(1.0, 0.99).power(0.5).unwrap();
        assert!(disc.mid - disc.radius <= 0.1 && disc.mid + disc.radius >= 1.99_f64.sqrt(), "{disc:?}");
    }

    #[test]
    fn nothing_is_said_of_roots_and_logarithms_at_zero() {
        for disc in [Disc::new(1.0, 1.0), Disc::new(-1.0, 0.5), Disc::new(0.0, 0.0)] {
            assert_eq!((disc.sqrt(), disc.inverse_sqrt(), disc.minus_ln()), (None, None, None));
        }
        assert_eq!(Disc::new(1.0, 1.0).power(0.5), None);
    }
}
