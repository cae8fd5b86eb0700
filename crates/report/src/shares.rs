//! Shares of a whole that add up to it after rounding.

/// The share of each part in thousandths, by the method of the largest remainder: the shares add up
/// to exactly 1000. At equal remainders the earlier part takes the odd thousandth. All 0 for a whole
/// of 0.
pub(crate) fn thousandths(parts: &[u64]) -> Vec<u32> {
    let whole: u128 = parts.iter().map(|&part| u128::from(part)).sum();
    if whole == 0 {
        return vec![0; parts.len()];
    }
    let scaled = |part: u64| u128::from(part) * 1000;
    let mut shares: Vec<u32> = parts.iter().map(|&part| (scaled(part) / whole) as u32).collect();
    let missing = 1000 - shares.iter().sum::<u32>();
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&index| std::cmp::Reverse(scaled(parts[index]) % whole));
    for &index in order.iter().take(missing as usize) {
        shares[index] += 1;
    }
    shares
}

/// A share in thousandths as a percentage with one decimal, such as `72.5 %`.
pub(crate) fn percent(thousandths: u32) -> String {
    format!("{}.{} %", thousandths / 10, thousandths % 10)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    #[test]
    fn three_thirds_make_a_whole() {
        assert_eq!(thousandths(&[1, 1, 1]), [334, 333, 333]);
    }

    #[test]
    fn nothing_has_no_shares() {
        assert_eq!(thousandths(&[0, 0]), [0, 0]);
        assert!(thousandths(&[]).is_empty());
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn shares_add_up_and_are_within_a_thousandth(
            parts in proptest::collection::vec(any::<u64>(), 1..12)
        ) {
            let whole: u128 = parts.iter().map(|&part| u128::from(part)).sum();
            let shares = thousandths(&parts);
            prop_assert_eq!(shares.iter().sum::<u32>(), if whole == 0 { 0 } else { 1000 });
            for (&part, &share) in parts.iter().zip(&shares) {
                let exact = part as f64 / (whole as f64).max(1.0) * 1000.0;
                prop_assert!((exact - f64::from(share)).abs() <= 1.0 + 1e-6);
            }
        }
    }
}
