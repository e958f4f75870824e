//! Numbers as text.

/// So many significant digits, without an exponent where that is as short; "-" for what is not a
/// number.
pub(super) fn significant(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "-".into();
    }
    if value == 0.0 || value.is_infinite() {
        return value.to_string();
    }
    let decimals = digits.saturating_sub(1);
    // Rounding first: 9.996 to three digits is 10.0, a decade up.
    let rounded = format!("{value:.decimals$e}");
    let decade: i32 = rounded.rsplit('e').next().and_then(|e| e.parse().ok()).unwrap_or(0);
    if (-3..5).contains(&decade) {
        let places = (decimals as i32 - decade).max(0) as usize;
        format!("{value:.places$}")
    } else {
        rounded
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn digits_are_significant_ones() {
        for (value, text) in [
            (0.0, "0"),
            (0.128, "0.128"),
            (8.0611, "8.06"),
            (9.996, "10.0"),
            (-297.4, "-297"),
            (99_999.0, "1.00e5"),
            (0.0012345, "0.00123"),
            (4.75e-4, "4.75e-4"),
            (f64::NAN, "-"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(significant(value, 3), text);
        }
    }
}
