//! Numbers as a person reads them.

/// A number in at most seven digits, and whole ones below 10¹⁵ in all of theirs: `0.3`, `4095`, `2.3e301`.
///
/// ```
/// use cube3_volume::readable;
/// assert_eq!(readable(0.1 + 0.2), "0.3");
/// assert_eq!(readable(23e300), "2.3e301");
/// ```
pub fn readable(value: f64) -> String {
    let size = value.abs();
    let trimmed = |text: &str| text.trim_end_matches('0').trim_end_matches('.').to_owned();
    if value == 0.0 {
        "0".into()
    } else if !value.is_finite() || (value.fract() == 0.0 && size < 1e15) {
        value.to_string()
    } else if (1e-4..1e7).contains(&size) {
        let decimals = (6 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { trimmed(&text) } else { text }
    } else {
        let text = format!("{value:.6e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{exponent}", trimmed(digits))
    }
}

#[cfg(test)]
mod tests {
    use super::readable;

    #[test]
    fn at_most_seven_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-1024.0, "-1024"),
            (123_456_789_012.0, "123456789012"),
            (0.1 + 0.2, "0.3"),
            (0.699_999_988, "0.7"),
            (327.675, "327.675"),
            (1.0 / 3.0, "0.3333333"),
            (1_234.567_891, "1234.568"),
            (9_999_999.96, "10000000"),
            (2.3e-5, "2.3e-5"),
            (-23.0 * 1e300, "-2.3e301"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(readable(value), text);
        }
    }
}
