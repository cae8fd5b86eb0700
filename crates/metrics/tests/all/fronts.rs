//! Fronts of work-precision diagrams.

use cube3_cases::cases;
use cube3_metrics::{WorkPrecision, front};
use proptest::prelude::*;

fn points(points: &[(f64, f64)]) -> Vec<WorkPrecision> {
    points.iter().map(|&(cost, error)| WorkPrecision { cost, error }).collect()
}

#[test]
fn dominated_points_fall() {
    let found = front(&points(&[(3.0, 1.0), (1.0, 3.0), (2.0, 2.0), (2.5, 2.0), (3.0, 3.0)]));
    assert_eq!(found.unwrap(), [1, 2, 0]);
}

#[test]
fn equal_points_stay_in_the_order_of_the_input() {
    assert_eq!(front(&points(&[(1.0, 0.0), (2.0, 0.0), (1.0, -0.0)])).unwrap(), [0, 2]);
}

#[test]
fn nothing_and_one() {
    assert!(front(&[]).unwrap().is_empty());
    assert_eq!(front(&points(&[(5.0, 5.0)])).unwrap(), [0]);
}

#[test]
fn a_point_that_is_not_finite_is_named() {
    let error = front(&points(&[(1.0, 1.0), (2.0, f64::NAN)])).unwrap_err();
    assert!(error.to_string().starts_with("error of point 1 is NaN"), "{error}");
    assert!(front(&points(&[(f64::INFINITY, 1.0)])).is_err());
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn is_what_the_definition_says(
        given in proptest::collection::vec((0_u8..8, 0_u8..8), 0..40)
    ) {
        let given: Vec<_> = given.into_iter().map(|(t, e)| (f64::from(t), f64::from(e))).collect();
        let dominated = |&(t, e): &(f64, f64)| {
            given.iter().any(|&(u, f)| u <= t && f <= e && (u < t || f < e))
        };
        let mut expected: Vec<usize> = (0..given.len()).filter(|&i| !dominated(&given[i])).collect();
        expected.sort_by(|&i, &j| given[i].0.total_cmp(&given[j].0));
        prop_assert_eq!(front(&points(&given)).unwrap(), expected);
    }
}
