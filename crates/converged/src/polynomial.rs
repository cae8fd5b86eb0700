//! Cubics along a ray.

/// a + b·x + c·x² + d·x³.
pub(crate) type Cubic = [f64; 4];

/// What rounding can move a value of a polynomial by, as a part of the sum of its terms' magnitudes.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The same cubic in ζ of x = mid + half·ζ.
#[inline]
pub(crate) fn about(p: &Cubic, mid: f64, half: f64) -> Cubic {
    let [a, b, c, d] = *p;
    let value = a + mid * (b + mid * (c + mid * d));
    let first = b + mid * (2.0 * c + mid * 3.0 * d);
    let second = c + mid * 3.0 * d;
    [value, first * half, second * half * half, d * half * half * half]
}

/// The value at x.
#[inline]
pub(crate) fn at(p: &Cubic, x: f64) -> f64 {
    p[0] + x * (p[1] + x * (p[2] + x * p[3]))
}

/// The least and the largest value on [−1, 1], widened by what rounding may hide.
#[inline]
pub(crate) fn range(p: &Cubic) -> [f64; 2] {
    let moving = p[1].abs() + p[2].abs() + p[3].abs();
    if moving == 0.0 {
        return [p[0]; 2];
    }
    let (first, last) = (at(p, -1.0), at(p, 1.0));
    let (mut low, mut high) = (first.min(last), first.max(last));
    for turn in turns(p).into_iter().flatten().filter(|turn| turn.abs() < 1.0) {
        let value = at(p, turn);
        (low, high) = (low.min(value), high.max(value));
    }
    let slack = slack(p);
    [low - slack, high + slack]
}

/// What rounding can move a value on [−1, 1] by; nothing where it is one value.
#[inline]
pub(crate) fn slack(p: &Cubic) -> f64 {
    let moving = p[1].abs() + p[2].abs() + p[3].abs();
    if moving == 0.0 { 0.0 } else { ROUNDING * (moving + p[0].abs()) }
}

/// Where the slope is 0.
#[inline]
pub(crate) fn turns(p: &Cubic) -> [Option<f64>; 2] {
    let (a, b, c) = (3.0 * p[3], 2.0 * p[2], p[1]);
    // No turn in reach: the slope keeps its sign.
    if c.abs() > b.abs() + a.abs() {
        return [None, None];
    }
    let square = b * b - 4.0 * a * c;
    if square < 0.0 {
        return [None, None];
    }
    let q = -0.5 * (b + square.sqrt().copysign(b));
    let over = |top: f64, bottom: f64| Some(top / bottom).filter(|x| x.is_finite());
    [over(q, a), over(c, q)]
}

/// Where a polynomial takes a level between −1 and 1, if it is on different sides of it at both: by secants that keep coming from both sides
/// (the Illinois rule), and halves where they are slow.
pub(crate) fn crossing(f: impl Fn(f64) -> f64, level: f64) -> Option<f64> {
    let (mut left, mut right) = (-1.0, 1.0);
    let (mut at_left, mut at_right) = (f(left) - level, f(right) - level);
    if at_left == 0.0 || at_right == 0.0 || (at_left < 0.0) == (at_right < 0.0) {
        return None;
    }
    let first = at_left < 0.0;
    let mut moved_left = None;
    for step in 0..120 {
        let secant = left - at_left * (right - left) / (at_right - at_left);
        let middle = f64::midpoint(left, right);
        let x = if step % 4 != 3 && secant > left && secant < right { secant } else { middle };
        let value = f(x) - level;
        if value == 0.0 || right - left < 4.0 * f64::EPSILON {
            return Some(x);
        }
        let is_left = (value < 0.0) == first;
        if is_left {
            (left, at_left) = (x, value);
        } else {
            (right, at_right) = (x, value);
        }
        // An end that stays is weighed half, so that the next secant comes from its side.
        if moved_left == Some(is_left) {
            if is_left { at_right /= 2.0 } else { at_left /= 2.0 }
        }
        moved_left = Some(is_left);
    }
    Some(f64::midpoint(left, right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn about_another_place_it_is_the_same(p in prop::array::uniform4(-2.0..2.0_f64), mid in -2.0..2.0_f64, x in -1.0..1.0_f64) {
            prop_assert!((at(&about(&p, mid, 0.3), x) - at(&p, mid + 0.3 * x)).abs() < 1e-13);
        }

        /// No value lies outside, and each end is taken.
        #[test]
        fn the_range_is_that_of_a_thousand_values(p in prop::array::uniform4(prop_oneof![-2.0..2.0_f64, Just(0.0)])) {
            let [low, high] = range(&p);
            let values = (0..=1000).map(|i| at(&p, f64::from(i) / 500.0 - 1.0));
            let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            prop_assert!(low <= least && most <= high);
            prop_assert!(least - low < 2e-5 && high - most < 2e-5, "{low} {least} {most} {high}");
        }

        #[test]
        fn a_crossing_takes_the_level(p in prop::array::uniform4(-2.0..2.0_f64), level in -1.0..1.0_f64) {
            let apart = (at(&p, -1.0) - level) * (at(&p, 1.0) - level) < 0.0;
            let found = crossing(|x| at(&p, x), level);
            prop_assert_eq!(found.is_some(), apart);
            if let Some(x) = found {
                prop_assert!((at(&p, x) - level).abs() < 1e-13);
            }
        }
    }

    /// Secants alone stay on one side here.
    #[test]
    fn a_crossing_beside_a_turn_is_found_to_the_last_bits() {
        let p = [0.265_251_791_728_347_6, 0.0, -1.596_190_819_542_737_7, 1.408_162_637_157_578];
        let level = -0.157_243_776_284_637_15;
        let x = crossing(|x| at(&p, x), level).unwrap();
        assert!((at(&p, x) - level).abs() < 1e-15, "{x}");
    }
}
