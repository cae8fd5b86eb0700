//! Numbers for a reader.

/// A count with commas between thousands, such as `270,336`.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Three significant digits or all before the point, such as `34.1`, `0.00214` or `1.25e-9`. An exact
/// value goes without zeros at its end: `0.5`, `8`.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !(1e-4..1e6).contains(&size) {
        format!("{value:.2e}")
    } else {
        let decimals = (2 - size.log10().floor() as i32).clamp(0, 6);
        let text = format!("{value:.*}", decimals as usize);
        let exact = text.contains('.') && text.parse() == Ok(value);
        if exact { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    }
}

/// A value with a unit and a prefix, such as `34.1 ms`, `4.03 Gsamples/s` or, without a unit, `4.03 G`.
pub(crate) fn prefixed(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 8] =
        [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];
    let (scale, prefix) = PREFIXES.into_iter().find(|(scale, _)| value.abs() >= *scale).unwrap_or((1.0, ""));
    format!("{} {prefix}{unit}", number(value / scale)).trim_end().into()
}

/// A fraction as a percentage, such as `0.851 %`.
pub fn percentage(fraction: f64) -> String {
    format!("{} %", number(100.0 * fraction))
}

/// Sizes along axes, such as `128 × 128 × 128`.
pub(crate) fn sizes(sizes: &[usize]) -> String {
    sizes.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped_from_the_right() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(1000), "1,000");
        assert_eq!(count(u64::MAX), "18,446,744,073,709,551,615");
    }

    #[test]
    fn numbers_keep_three_digits() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(30.517578125), "30.5");
        assert_eq!(number(262_144.0), "262144");
        assert_eq!(number(0.002_141_9), "0.00214");
        assert_eq!(number(1.25e-9), "1.25e-9");
        assert_eq!(number(2.501), "2.50");
        assert_eq!(number(-2.5), "-2.5");
        assert_eq!(number(8.0), "8");
        assert_eq!(number(100.0), "100");
    }

    #[test]
    fn prefixes_go_by_thousands() {
        assert_eq!(prefixed(4.03e9, "samples/s"), "4.03 Gsamples/s");
        assert_eq!(prefixed(0.0341, "s"), "34.1 ms");
        assert_eq!(prefixed(0.0, "s"), "0 s");
        assert_eq!(prefixed(4.03e9, ""), "4.03 G");
        assert_eq!(prefixed(512.0, ""), "512");
    }
}
