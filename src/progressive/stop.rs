//! When a picture is good enough.

use crate::film::ErrorEstimate;

/// Renders on until the upper 95 % limit of the relative error is at most the wanted one.
///
/// The error is looked at after pass counts that follow from the estimates alone, never from the
/// clock, so the same parameters stop at the same pass with the same bits. Looks are few and far
/// between: each is one more chance to stop on a picture that happens to look better than it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// The relative error to reach, `sqrt(mean((x - r)² / (r² + 0.01)))`; above 0.
    pub wanted: f64,
}

impl StopRule {
    /// Passes before the first look: before, the tails of the error are not seen.
    pub const FIRST: u64 = 64;

    /// Passes before the next look at a picture that has `passes` and this error; `None` when it is
    /// good enough.
    pub fn next(&self, passes: u64, error: Option<&ErrorEstimate>) -> Option<u64> {
        let known = error.filter(|e| e.reliable && passes >= Self::FIRST);
        if known.is_some_and(|e| e.relative.interval.high <= self.wanted) {
            return None;
        }
        let least = (passes + passes / 8).max(Self::FIRST);
        let most = passes.saturating_mul(2).max(Self::FIRST);
        let needed = self.needed(passes, error).unwrap_or(most);
        Some(needed.clamp(least, most).next_multiple_of(4))
    }

    /// Passes that the error is expected to need, if it falls with the square root of their number;
    /// it falls faster where sampling is stratified.
    pub fn needed(&self, passes: u64, error: Option<&ErrorEstimate>) -> Option<u64> {
        let ratio = error?.relative.interval.high / self.wanted;
        Some((passes as f64 * ratio * ratio).min(1e18) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Figure, Interval};

    fn error(relative: f64, reliable: bool) -> ErrorEstimate {
        let figure = |value: f64| Figure {
            value,
            interval: Interval { low: value * 0.8, high: value * 1.25 },
        };
        let [rel_mse, rmse] = [figure(relative * relative), figure(relative)];
        ErrorEstimate { rel_mse, relative: figure(relative), rmse, terms: 100.0, reliable }
    }

    #[test]
    fn it_is_the_upper_limit_that_counts() {
        let rule = StopRule { wanted: 0.1 };
        assert_eq!(rule.next(64, Some(&error(0.079, true))), None);
        assert!(rule.next(64, Some(&error(0.081, true))).is_some());
        assert!(rule.next(64, Some(&error(0.01, false))).is_some());
        assert!(rule.next(32, Some(&error(0.01, true))).is_some());
    }

    #[test]
    fn looks_are_between_an_eighth_more_and_twice_as_many_passes() {
        let rule = StopRule { wanted: 0.1 };
        assert_eq!(rule.next(0, None), Some(StopRule::FIRST));
        assert_eq!(rule.next(64, Some(&error(1.0, true))), Some(128));
        assert_eq!(rule.next(64, Some(&error(0.0805, true))), Some(72));
        // 64 * 1.25² = 100.
        assert_eq!(rule.next(64, Some(&error(0.1, true))), Some(100));
        assert_eq!(rule.needed(64, Some(&error(0.1, true))), Some(100));
    }
}
