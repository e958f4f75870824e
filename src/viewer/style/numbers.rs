//! Numbers as people read them.

/// A number with this many significant digits and no trailing noise: 98.63, 0.1414, 1.25e6.
pub(crate) fn digits(value: f64, significant: usize) -> String {
    crate::numbers::significant(value, significant, -4..7)
}

/// A part of one: 23.4 %, 1.81 %.
pub(crate) fn percent(relative: f64) -> String {
    let percent = relative * 100.0;
    let decimals = match percent {
        p if p >= 100.0 => 0,
        p if p >= 10.0 => 1,
        _ => 2,
    };
    format!("{percent:.decimals$} %")
}

/// A rate: 812, 45.1 k, 5.13 M.
pub(crate) fn short(rate: f64) -> String {
    match rate {
        r if r >= 1e6 => format!("{:.2} M", r / 1e6),
        r if r >= 1e3 => format!("{:.1} k", r / 1e3),
        r => format!("{r:.0}"),
    }
}

/// A time to come: 12 s, 3 min, 2.5 h, 4 d.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 100.0 * 60.0 => format!("{:.0} min", s / 60.0),
        s if s < 48.0 * 3600.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.0} d", s / 86400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        for (value, text) in [
            (0.0, "0"),
            (0.141421, "0.1414"),
            (98.0, "98.00"),
            (1234.56, "1235"),
            (123456.0, "123456"),
            (1e-4, "0.0001000"),
            (2e8 - 2.0, "2.000e8"),
            (9.99996, "10.00"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(digits(value, 4), text);
        }
    }

    #[test]
    fn times_have_the_unit_that_fits() {
        let shown = [0.4, 99.4, 125.0, 9000.0, 4e5].map(duration);
        assert_eq!(shown, ["0 s", "99 s", "2 min", "2.5 h", "5 d"]);
    }

    #[test]
    fn rates_and_errors_are_short() {
        assert_eq!([812.4, 45_120.0, 5.126e6].map(short), ["812", "45.1 k", "5.13 M"]);
        let found = [0.0181, 0.234, 0.0, 1.5].map(percent);
        assert_eq!(found, ["1.81 %", "23.4 %", "0.00 %", "150 %"]);
    }
}
