//! Sums that do not lose their small terms.

/// A running sum with Neumaier's compensation.
///
/// The error is about one rounding of the result, whatever the number of terms. Terms are taken in
/// the order given, so the same terms give the same bits.
///
/// A. Neumaier, Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen, ZAMM 54
/// (1974), 39-51.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CompensatedSum {
    sum: f64,
    lost: f64,
}

impl CompensatedSum {
    /// Adds a finite term.
    pub(crate) fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.lost += if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
    }

    /// The sum so far.
    pub(crate) fn total(self) -> f64 {
        self.sum + self.lost
    }

    /// The sum so far over `count` terms, 0 for none.
    pub(crate) fn mean(self, count: usize) -> f64 {
        if count == 0 { 0.0 } else { self.total() / count as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(terms: &[f64]) -> f64 {
        let mut sum = CompensatedSum::default();
        terms.iter().for_each(|&term| sum.add(term));
        sum.total()
    }

    #[test]
    fn keeps_terms_that_a_plain_sum_loses() {
        assert_eq!(sum(&[1.0, 1e100, 1.0, -1e100]), 2.0);
    }

    #[test]
    fn ten_million_tenths_are_a_million() {
        let mut sum = CompensatedSum::default();
        (0..10_000_000).for_each(|_| sum.add(0.1));
        assert_eq!(sum.total(), 1e6);
    }

    #[test]
    fn mean_of_nothing_is_zero() {
        assert_eq!(CompensatedSum::default().mean(0), 0.0);
    }
}
