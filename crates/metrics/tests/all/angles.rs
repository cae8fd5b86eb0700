//! Gradient angles near 0° and 180°, and at the ends of the number range.

use cube3_cases::cases;
use cube3_metrics::{MetricsError, mean_angle_deg};
use proptest::prelude::*;

fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    mean_angle_deg([(a, b)]).unwrap().mean_deg.unwrap()
}

#[test]
fn right_angles_and_straight_lines() {
    assert_eq!(angle([1.0, 0.0, 0.0], [0.0, 0.0, 2.0]), 90.0);
    assert_eq!(angle([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]), 0.0);
    assert_eq!(angle([1.0, 2.0, 3.0], [-1.0, -2.0, -3.0]), 180.0);
    assert!((angle([1.0, 0.0, 0.0], [1.0, 1.0, 0.0]) - 45.0).abs() < 1e-13);
}

#[test]
fn small_angles_keep_their_digits() {
    for exponent in 1..300 {
        let small = 10.0_f64.powi(-exponent);
        let exact = small.atan().to_degrees();
        let found = angle([1.0, 0.0, 0.0], [1.0, small, 0.0]);
        assert!((found / exact - 1.0).abs() < 1e-14, "{small}");
    }
}

#[test]
fn angles_near_a_half_turn_keep_their_digits() {
    for exponent in 1..15 {
        let small = 10.0_f64.powi(-exponent);
        let exact = 180.0 - small.atan().to_degrees();
        assert!((angle([1.0, 0.0, 0.0], [-1.0, small, 0.0]) - exact).abs() < 1e-13);
    }
}

#[test]
fn lengths_at_the_ends_of_the_range_do_not_matter() {
    let (tiny, huge) = (5e-324, f64::MAX);
    assert_eq!(angle([tiny, 0.0, 0.0], [0.0, huge, 0.0]), 90.0);
    assert_eq!(angle([huge, huge, huge], [tiny, tiny, tiny]), 0.0);
    assert_eq!(angle([huge, -huge, huge], [-tiny, tiny, -tiny]), 180.0);
}

#[test]
fn vectors_without_a_direction_are_counted_apart() {
    let zero = [0.0, -0.0, 0.0];
    let x = [1.0, 0.0, 0.0];
    let error = mean_angle_deg([(zero, x), (x, [0.0, 1.0, 0.0]), (x, zero), (zero, zero)]).unwrap();
    assert_eq!((error.count, error.degenerate), (1, 3));
    assert_eq!([error.mean_deg, error.max_deg, error.rms_deg], [Some(90.0); 3]);
    let none = mean_angle_deg([(zero, x)]).unwrap();
    assert_eq!(([none.mean_deg, none.max_deg, none.rms_deg], none.count), ([None; 3], 0));
}

#[test]
fn mean_largest_and_root_mean_square() {
    let x = [1.0, 0.0, 0.0];
    let error = mean_angle_deg([(x, x), (x, [0.0, 1.0, 0.0]), (x, [-1.0, 0.0, 0.0])]).unwrap();
    assert_eq!((error.mean_deg, error.max_deg), (Some(90.0), Some(180.0)));
    assert!((error.rms_deg.unwrap() - 13_500.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_component_that_is_not_finite_is_an_error() {
    for value in [f64::NAN, f64::INFINITY] {
        let pairs = [([1.0; 3], [1.0; 3]), ([1.0; 3], [0.0, value, 0.0])];
        let error = mean_angle_deg(pairs).unwrap_err();
        assert!(matches!(error, MetricsError::BadNumber { index: 1, .. }), "{error}");
    }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn symmetric_bounded_and_free_of_length(
        a in proptest::array::uniform3(-1.0..1.0_f64),
        b in proptest::array::uniform3(-1.0..1.0_f64),
        scale in -60..60_i32,
    ) {
        let found = angle(a, b);
        prop_assert!((0.0..=180.0).contains(&found));
        prop_assert_eq!(found, angle(b, a));
        let length = 2.0_f64.powi(scale);
        prop_assert_eq!(found, angle(a.map(|value| value * length), b));
        prop_assert!((found + angle(a, b.map(|value| -value)) - 180.0).abs() < 1e-12);
    }
}
