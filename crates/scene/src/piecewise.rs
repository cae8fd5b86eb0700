//! Look-up between points in ascending order: the one definition for every part of a transfer function.

/// The points on both sides of `at`, and the weight of the second, 0 to 1.
///
/// Outside all points both are the nearest. At a step, points of equal keys, `at` takes the last of
/// them. NaN takes the first point. `None` if there are no points.
pub(crate) fn bracket<P>(points: &[P], key: impl Fn(&P) -> f64, at: f64) -> Option<(&P, &P, f64)> {
    let after = points.partition_point(|point| key(point) <= at);
    let Some(upper) = points.get(after) else {
        return points.last().map(|last| (last, last, 0.0));
    };
    if after == 0 {
        return Some((upper, upper, 0.0));
    }
    let lower = &points[after - 1];
    let (from, to) = (key(lower), key(upper));
    // Halving keeps the differences of the largest numbers from overflowing.
    let scale = if (to - from).is_finite() { 1.0 } else { 0.5 };
    let weight = (at * scale - from * scale) / (to * scale - from * scale);
    Some((lower, upper, weight))
}

/// From `a` to `b` by `weight`, 0 to 1; exact at both ends and never outside of them.
pub(crate) fn lerp(a: f64, b: f64, weight: f64) -> f64 {
    (a + weight * (b - a)).clamp(a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weight(points: &[f64], at: f64) -> (f64, f64, f64) {
        let (lower, upper, weight) = bracket(points, |p| *p, at).unwrap();
        (*lower, *upper, weight)
    }

    #[test]
    fn finds_the_two_sides() {
        let points = [1.0, 3.0, 3.0, 7.0];
        assert_eq!(weight(&points, 0.0), (1.0, 1.0, 0.0));
        assert_eq!(weight(&points, 1.0), (1.0, 3.0, 0.0));
        assert_eq!(weight(&points, 1.5), (1.0, 3.0, 0.25));
        assert_eq!(weight(&points, 3.0), (3.0, 7.0, 0.0));
        assert_eq!(weight(&points, 7.0), (7.0, 7.0, 0.0));
        assert_eq!(weight(&points, f64::INFINITY), (7.0, 7.0, 0.0));
        assert_eq!(weight(&points, f64::NAN), (1.0, 1.0, 0.0));
        assert!(bracket(&[], |p: &f64| *p, 0.0).is_none());
    }

    #[test]
    fn points_at_the_limits_of_the_type_do_not_overflow() {
        assert_eq!(weight(&[f64::MIN, f64::MAX], 0.0), (f64::MIN, f64::MAX, 0.5));
        let tiny = f64::from_bits(2);
        assert_eq!(weight(&[0.0, tiny], f64::from_bits(1)), (0.0, tiny, 0.5));
    }

    #[test]
    fn a_lerp_stays_between_its_ends() {
        let (a, b) = (0.1, 0.1_f64.next_up());
        for weight in [0.0, 0.3, 0.7, 1.0] {
            assert!((a..=b).contains(&lerp(a, b, weight)) && (a..=b).contains(&lerp(b, a, weight)));
        }
        assert_eq!((lerp(0.9, 0.3, 0.0), lerp(0.9, 0.3, 1.0)), (0.9, 0.3));
    }
}
