//! Numbers as text, for the command line and the window.

use std::ops::Range;

/// A number with `digits` significant ones, zeros at the end included; with an exponent where its power of ten
/// is not among `decades`. Zero, infinities and NaN are as Rust writes them.
pub(crate) fn significant(value: f64, digits: usize, decades: Range<i32>) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = digits.saturating_sub(1);
    // Rounding first: 9.996 to three digits is 10.0, a decade up.
    let rounded = format!("{value:.decimals$e}");
    let decade = rounded.rsplit('e').next().and_then(|e| e.parse().ok()).unwrap_or(0);
    if !decades.contains(&decade) {
        return rounded;
    }
    let places = (decimals as i32 - decade).max(0) as usize;
    format!("{value:.places$}")
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
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(significant(value, 3, -3..5), text);
        }
    }
}
