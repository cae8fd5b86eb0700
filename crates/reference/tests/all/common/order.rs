//! The order of a method, measured: the slope of the error over the step, both as logarithms.

/// The slope of the straight line through (ln step, ln error) by least squares: 2 where half the step is a quarter of the error.
pub fn order(steps: &[f64], errors: &[f64]) -> f64 {
    assert!(steps.len() == errors.len() && steps.len() > 2 && errors.iter().all(|error| *error > 0.0), "{errors:?}");
    let mean = |numbers: &[f64]| numbers.iter().map(|number| number.ln()).sum::<f64>() / numbers.len() as f64;
    let (step, error) = (mean(steps), mean(errors));
    let points = || steps.iter().zip(errors).map(|(s, e)| (s.ln() - step, e.ln() - error));
    points().map(|(s, e)| s * e).sum::<f64>() / points().map(|(s, _)| s * s).sum::<f64>()
}

/// As `order`, but for a method that must have it: within `tolerance` of `expected`.
pub fn assert_order(what: &str, steps: &[f64], errors: &[f64], expected: f64, tolerance: f64) {
    let measured = order(steps, errors);
    println!("{what}: order {measured:.3}, errors {errors:?}");
    assert!((measured - expected).abs() < tolerance, "{what}: order {measured}, not {expected}, of {errors:?}");
}
