//! Intervals: what the spread of a few numbers says about the truth.

use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// The probability of every interval of this crate.
pub const CONFIDENCE: f64 = 0.95;

/// Where a number lies with probability [`CONFIDENCE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower limit.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
}

impl Interval {
    /// Whether `x` lies within it.
    pub fn contains(&self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }

    /// The interval of a monotone function's value.
    pub fn map(self, f: impl Fn(f64) -> f64) -> Interval {
        Interval { low: f(self.low), high: f(self.high) }
    }
}

/// Standard errors that a mean's two-sided interval spans to each side, when the error was itself
/// estimated with these degrees of freedom (Student 1908). Infinite for none.
pub fn student(degrees_of_freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom)
        .map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + 0.5 * CONFIDENCE))
}

/// Standard deviations that the two-sided interval of a normal number spans to each side.
pub(super) fn normal_quantile() -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * CONFIDENCE)
}

/// The chance that Student's t with this number of degrees of freedom exceeds `t`; 1/2 for none.
pub fn tail(t: f64, degrees_of_freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(0.5, |student| student.cdf(-t))
}

/// The standard normal number that is as rare as Student's `t` with this number of degrees of freedom.
pub fn normal_score(t: f64, degrees_of_freedom: f64) -> f64 {
    let Ok(student) = StudentsT::new(0.0, 1.0, degrees_of_freedom) else { return 0.0 };
    let tail = student.cdf(-t.abs()).max(f64::MIN_POSITIVE);
    -Normal::standard().inverse_cdf(tail).copysign(-t)
}

/// Where the ratio of two independent mean squares lies, the upper one of `upper`, the lower one
/// of `lower` degrees of freedom (Fisher and Snedecor). Everywhere where there are none.
pub fn ratio(upper: f64, lower: f64) -> Interval {
    // Beyond this many the quantiles are 1 to a per mille, and their series no longer converge.
    const MOST: f64 = 1e7;
    let tail = 0.5 - 0.5 * CONFIDENCE;
    FisherSnedecor::new(upper.min(MOST), lower.min(MOST)).map_or(
        Interval { low: 0.0, high: f64::INFINITY },
        |f| Interval { low: f.inverse_cdf(tail), high: f.inverse_cdf(1.0 - tail) },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles as every table of them has them.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, expected) in [(1.0, 12.706), (3.0, 3.182), (27.0, 2.052), (1e6, 1.960)] {
            assert!((student(degrees) - expected).abs() < 1e-3, "{degrees}");
        }
        for (upper, lower, low, high) in [
            (5.0, 15.0, 0.1556, 3.5764),
            (10.0, 30.0, 0.3029, 2.5112),
            (120.0, 120.0, 0.698, 1.433),
        ] {
            let f = ratio(upper, lower);
            assert!((f.low - low).abs() < 2e-3 && (f.high - high).abs() < 2e-3, "{f:?}");
        }
    }

    /// P(|t| > 2.1315) is 5 % with 15 degrees of freedom, as is that of 1.96 normally.
    #[test]
    fn rare_as_students_is_rare_as_the_normal() {
        for (t, z) in [(2.1315, 1.96), (-2.1315, -1.96), (0.0, 0.0), (2.9467, 2.5758)] {
            assert!((normal_score(t, 15.0) - z).abs() < 1e-3, "{t}");
        }
        assert!((normal_score(3.0, 1e6) - 3.0).abs() < 1e-4);
        assert!(normal_score(1e9, 15.0) > 8.0);
    }

    #[test]
    fn many_degrees_of_freedom_leave_no_doubt_and_none_leave_all() {
        let f = ratio(1e9, 3e9);
        assert!(f.low > 0.998 && f.high < 1.002, "{f:?}");
        assert_eq!(ratio(0.0, 3.0).high, f64::INFINITY);
        assert_eq!(student(0.0), f64::INFINITY);
    }
}
