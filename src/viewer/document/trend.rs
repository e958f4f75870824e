//! Extrapolation of a picture's error: after how many passes it is expected to be small enough.
//!
//! The error falls with the root of the passes where samples are independent, faster where they are
//! stratified and where noisy parts get more of them, and it rises when rare bright samples turn up.
//! So the slope is measured from the history, over logarithms, and drawn towards -1/2 the more, the
//! shorter that is; and it is believed for as far ahead as it was seen behind, beyond which it is -1/2.

use crate::viewer::document::errors::{History, Point};
use burnish::measure::speed::Fit;
use burnish::progressive::{ErrorEstimate, Session, StopRule};

/// Slope of the error's upper limit over the last passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Trend {
    /// Passes of the newest point, and the upper 95 % limit there.
    passes: f64,
    high: f64,
    /// Slope of the limit's logarithm over that of the passes.
    slope: f64,
    /// Ratio of passes over which the slope was measured.
    seen: f64,
    /// Whether the slope is measured rather than supposed.
    pub(crate) measured: bool,
}

/// Part of the newest point's passes that a point must have to be looked at.
const WINDOW: f64 = 1.0 / 8.0;
/// Points from which a slope is measured, and the least ratio of passes that they span.
const POINTS: usize = 5;
const RATIO: f64 = 3.0;
/// Slopes that an error has which falls as errors do.
const SLOPES: [f64; 2] = [-1.2, -0.3];
/// What is supposed.
const ROOT: f64 = -0.5;
/// Points farther than this from the line, root mean square of logarithms, make no line.
const SCATTER: f64 = 0.1;

impl Trend {
    /// From the history of a picture; `None` while its error is not known, or cannot be relied on.
    pub(crate) fn of(history: &History) -> Option<Trend> {
        let newest = history.newest().filter(|p| p.reliable && p.passes > 0)?;
        let passes = newest.passes as f64;
        let late = |p: &&Point| p.reliable && p.passes as f64 >= WINDOW * passes;
        let logs: Vec<[f64; 2]> = history
            .points()
            .iter()
            .filter(late)
            .map(|p| [(p.passes as f64).ln(), p.limits.high.ln()])
            .collect();
        let seen = logs.first().map_or(1.0, |first| passes / first[0].exp());
        let high = newest.limits.high;
        let supposed = Trend { passes, high, slope: ROOT, seen, measured: false };
        let Some(line) = line(&logs).filter(|_| logs.len() >= POINTS && seen >= RATIO) else {
            return Some(supposed);
        };
        // The limit at either end is as uncertain by a part of it as the slope is beforehand.
        let weight = seen.ln().powi(2) / (seen.ln().powi(2) + 2.0);
        let slope = ROOT + weight * (line.slope - ROOT);
        // The newest limit is as uncertain as the line is.
        let high = (0.5 * (high.ln() + line.at(passes.ln()))).exp();
        Some(Trend { high, slope, measured: true, ..supposed })
    }

    /// The upper limit expected after `passes`.
    fn high_at(&self, passes: f64) -> f64 {
        let ahead = passes / self.passes;
        let near = ahead.min(self.seen);
        self.high * near.powf(self.slope) * (ahead / near).powf(ROOT)
    }

    /// Passes at which a rule is expected to stop that looks next after `look` passes; `None` where
    /// that is more than can be traced.
    pub(crate) fn end(&self, rule: StopRule, look: u64, now: &ErrorEstimate) -> Option<u64> {
        let mut passes = look.max(StopRule::FIRST);
        while passes < Session::MAX_PASSES {
            let mut expected = ErrorEstimate { reliable: true, ..*now };
            expected.relative.interval.high = self.high_at(passes as f64);
            match rule.next(passes, Some(&expected)) {
                None => return Some(passes),
                Some(next) => passes = next,
            }
        }
        None
    }
}

/// A line in logarithms.
struct Line {
    slope: f64,
    /// A point of it.
    mean: [f64; 2],
}

impl Line {
    fn at(&self, x: f64) -> f64 {
        self.mean[1] + self.slope * (x - self.mean[0])
    }
}

/// The line through these points, if they are on one and it falls as errors do.
fn line(points: &[[f64; 2]]) -> Option<Line> {
    let slope = Fit::line(points.iter().copied())?.slope;
    let n = points.len() as f64;
    let mean = [0, 1].map(|c: usize| points.iter().map(|p| p[c]).sum::<f64>() / n);
    let line = Line { slope, mean };
    let squares = points.iter().map(|p| (p[1] - line.at(p[0])).powi(2)).sum::<f64>();
    let [least, most] = SLOPES;
    ((least..=most).contains(&slope) && (squares / n).sqrt() <= SCATTER).then_some(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::document::errors::tests::{history, point_at};
    use burnish::progressive::{Figure, Interval};

    fn now(high: f64) -> ErrorEstimate {
        let figure = Figure { value: 0.8 * high, interval: Interval { low: 0.6 * high, high } };
        let (rel_mse, relative, rmse) = (figure, figure, figure);
        ErrorEstimate { rel_mse, relative, rmse, terms: 100.0, reliable: true }
    }

    /// Points of 32 to 256 passes whose upper limit falls with this power from 0.1 at 256.
    fn falling(power: f64) -> History {
        let passes = (0..=12).map(|i| (32.0 * 2f64.powf(f64::from(i) / 4.0)).round() as u64);
        history(passes.map(|n| point_at(n, 0.1 * (n as f64 / 256.0).powf(power), n >= 32)))
    }

    #[test]
    fn the_end_follows_the_measured_slope_and_beyond_what_was_seen_the_root() {
        let rule = |wanted| StopRule { wanted };
        // -0.75 as it is drawn towards -0.5 by eight times the passes.
        let drawn = -0.5 - 0.25 * 8f64.ln().powi(2) / (8f64.ln().powi(2) + 2.0);
        assert!(drawn < -0.65);
        for (power, wanted, exact) in [
            // 256 * 2^2.
            (-0.5, 0.05, 1024.0),
            (-0.75, 0.05, 256.0 * 2f64.powf(-1.0 / drawn)),
            // Eight times the passes at the slope seen, the rest at -1/2.
            (-0.75, 0.01, 256.0 * 8.0 * (0.1 * 8f64.powf(drawn) / 0.01).powi(2)),
        ] {
            let trend = Trend::of(&falling(power)).unwrap();
            assert!(trend.measured, "{trend:?}");
            let found = trend.end(rule(wanted), 256, &now(0.1)).unwrap() as f64;
            // Looks are an eighth apart at least, and none is before the end.
            assert!(
                (0.99 * exact..1.2 * exact).contains(&found),
                "{power} {wanted}: {found} {exact}"
            );
        }
        let trend = Trend::of(&falling(-0.5)).unwrap();
        assert_eq!(trend.end(rule(0.2), 300, &now(0.1)), Some(300), "not before the next look");
        assert_eq!(trend.end(rule(1e-9), 256, &now(0.1)), None, "never");
    }

    #[test]
    fn what_falls_otherwise_than_errors_do_is_not_believed() {
        let rising = Trend::of(&falling(0.3)).unwrap();
        assert!(!rising.measured && rising.slope == ROOT, "{rising:?}");
        let still = Trend::of(&falling(-0.01)).unwrap();
        assert!(!still.measured);
        // A firefly on the way.
        let jump = |n: u64| if n > 150 { 2.0 } else { 1.0 };
        let points = falling(-0.5).points().to_vec();
        let points =
            points.into_iter().map(|p| point_at(p.passes, jump(p.passes) * p.limits.high, true));
        assert!(!Trend::of(&history(points)).unwrap().measured);
        // Too short a history.
        let short = falling(-0.5).points()[6..].to_vec();
        assert!(!Trend::of(&history(short.into_iter())).unwrap().measured);
    }

    #[test]
    fn an_error_that_cannot_be_relied_on_has_no_trend() {
        let points = (1..20).map(|i| point_at(i, 1.0 / i as f64, false));
        assert_eq!(Trend::of(&history(points)), None);
        assert_eq!(Trend::of(&History::default()), None);
    }
}
