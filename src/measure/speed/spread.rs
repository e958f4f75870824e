//! Repeated measurements of one thing.

/// Median and ends of a few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Half of them are below, half above.
    pub median: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// Of the numbers that are not NaN; all NaN if there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut sorted: Vec<f64> = values.into_iter().filter(|v| !v.is_nan()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let n = sorted.len();
        match (sorted.first(), sorted.last()) {
            (Some(&min), Some(&max)) => {
                Spread { median: (sorted[(n - 1) / 2] + sorted[n / 2]) / 2.0, min, max }
            }
            _ => Spread { median: f64::NAN, min: f64::NAN, max: f64::NAN },
        }
    }
}
