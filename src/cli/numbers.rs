//! Numbers as the reports write them.

/// A number with `digits` significant ones, without an exponent where that is as short; "-" for NaN.
pub(super) fn significant(value: f64, digits: usize) -> String {
    if value.is_nan() { "-".to_owned() } else { crate::numbers::significant(value, digits, -3..5) }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn what_is_no_number_is_a_dash() {
        assert_eq!(
            [f64::NAN, 0.25, f64::INFINITY].map(|x| significant(x, 3)),
            ["-", "0.250", "inf"]
        );
    }
}
