//! How many cases a property test tries: so many as it names, times a factor that a run may ask for.
//!
//! `proptest`'s own `PROPTEST_CASES` gives every test the same number, be a case a microsecond or a second. With the factor of
//! [`FACTOR`] each test keeps its measure: `.ci/full` tries ten times as many of each.

use proptest::test_runner::Config;

/// The variable with the factor, above 0: 10 for ten times as many cases, 0.1 for a tenth. It is 1 where the variable is not set.
pub const FACTOR: &str = "CUBE3_CASES";

/// `proptest`'s default configuration with `count` cases, times the factor. Cases that an assumption turns away may be more in the same
/// measure.
///
/// # Panics
/// Where [`FACTOR`] is no number above 0.
pub fn cases(count: u32) -> Config {
    match std::env::var(FACTOR) {
        Ok(text) => scaled(count, factor(&text).unwrap_or_else(|| panic!("{FACTOR}={text}: give a number above 0"))),
        Err(_) => scaled(count, 1.0),
    }
}

/// The factor of a text; none where it is no number above 0.
fn factor(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
}

/// One case at least.
fn scaled(count: u32, factor: f64) -> Config {
    let config = Config::with_cases((f64::from(count) * factor).round().max(1.0) as u32);
    let more = |rejects: u32| (f64::from(rejects) * factor.max(1.0)) as u32;
    Config {
        max_local_rejects: more(config.max_local_rejects),
        max_global_rejects: more(config.max_global_rejects),
        ..config
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_test_keeps_its_measure() {
        assert_eq!([1, 60, 1500].map(|count| scaled(count, 10.0).cases), [10, 600, 15_000]);
        assert_eq!([1, 60, 1500].map(|count| scaled(count, 0.1).cases), [1, 6, 150], "one at least");
        assert_eq!(scaled(256, 1.0), Config::with_cases(256));
    }

    #[test]
    fn more_cases_may_turn_more_away_and_fewer_as_many() {
        let [one, ten, tenth] = [1.0, 10.0, 0.1].map(|factor| scaled(100, factor));
        assert_eq!(ten.max_global_rejects, 10 * one.max_global_rejects);
        assert_eq!(ten.max_local_rejects, 10 * one.max_local_rejects);
        assert_eq!(tenth.max_global_rejects, one.max_global_rejects);
    }

    #[test]
    fn a_factor_is_a_number_above_zero() {
        assert_eq!(["10", " 0.5 ", "1e1"].map(factor), [Some(10.0), Some(0.5), Some(10.0)]);
        assert_eq!(["", "0", "-1", "nan", "inf", "ten"].map(factor), [None; 6]);
    }
}
