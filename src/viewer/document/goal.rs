//! When tracing is to stop, and how long it may take until then.

use crate::viewer::document::trend::Trend;
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::numbers::{duration, percent};
use burnish::progressive::{ErrorEstimate, Session, Snapshot, StopRule};

/// The condition that ends the tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    Passes,
    Error,
    Time,
}

impl Stop {
    pub(crate) const ALL: [Stop; 3] = [Stop::Passes, Stop::Error, Stop::Time];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Stop::Passes => "Passes",
            Stop::Error => "Error",
            Stop::Time => "Time",
        }
    }

    /// The field of its figure.
    pub(crate) fn limit(self) -> Control {
        match self {
            Stop::Passes => labels::PASS_LIMIT,
            Stop::Error => labels::ERROR_LIMIT,
            Stop::Time => labels::TIME_LIMIT,
        }
    }
}

/// The end that is chosen, with the figures of all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Goal {
    pub(crate) stop: Stop,
    /// 1 to [`Session::MAX_PASSES`].
    pub(crate) passes: u64,
    /// The relative error that its upper 95 % limit is to reach, as a part of one.
    pub(crate) error: f64,
    /// Of tracing.
    pub(crate) seconds: f64,
}

/// Expected way to a goal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outlook {
    /// Trend of the error, where it is known.
    pub(crate) trend: Option<Trend>,
    /// Passes at which the error is looked at next.
    pub(crate) look: u64,
}

impl Default for Goal {
    fn default() -> Goal {
        Goal { stop: Stop::Passes, passes: 1024, error: 0.01, seconds: 60.0 }
    }
}

impl Goal {
    /// The largest number of passes that can be wished for.
    pub(crate) const PASSES: u64 = Session::MAX_PASSES;
    /// Errors that can be wished for.
    pub(crate) const ERROR: [f64; 2] = [1e-6, 1.0];
    /// Times that can be, in seconds.
    pub(crate) const SECONDS: [f64; 2] = [0.1, 1e9];

    /// Passes at which to stop, or to look again, where there are `passes` with this error.
    pub(crate) fn limit(&self, passes: u64, error: Option<&ErrorEstimate>) -> u64 {
        match self.stop {
            Stop::Passes => self.passes,
            // As a file is rendered, so that both end at the same pass.
            Stop::Error if passes < StopRule::FIRST => StopRule::FIRST,
            Stop::Error => self.rule().next(passes, error).unwrap_or(passes),
            Stop::Time => Session::MAX_PASSES,
        }
    }

    /// Whether the time is over. The workers don't look at the clock.
    pub(crate) fn time_is_up(&self, seconds: f64) -> bool {
        self.stop == Stop::Time && seconds >= self.seconds
    }

    /// When the end is expected: "1.00 % in 12 s", with "?" while how the error falls is supposed
    /// rather than seen.
    pub(crate) fn ahead(&self, snapshot: &Snapshot, outlook: Outlook) -> String {
        let Some(left) = self.left(snapshot, outlook).map(duration) else {
            return match self.stop {
                Stop::Passes | Stop::Time => "done in -".to_owned(),
                Stop::Error => format!("{} in -", percent(self.error)),
            };
        };
        match self.stop {
            Stop::Passes | Stop::Time => format!("done in {left}"),
            Stop::Error => {
                let seen = outlook.trend.is_some_and(|t| t.measured);
                format!("{} in {left}{}", percent(self.error), if seen { "" } else { " ?" })
            }
        }
    }

    /// The part of the way to the end that is done, if that can be told.
    pub(crate) fn part(&self, snapshot: &Snapshot, outlook: Outlook) -> Option<f64> {
        let left = self.left(snapshot, outlook)?;
        let part = snapshot.seconds / (snapshot.seconds + left);
        Some(part.clamp(0.0, 1.0)).filter(|part| part.is_finite())
    }

    /// Seconds of tracing still to go, if that can be told.
    fn left(&self, snapshot: &Snapshot, outlook: Outlook) -> Option<f64> {
        let seconds = snapshot.seconds;
        let passes = match self.stop {
            Stop::Time => return Some((self.seconds - seconds).max(0.0)),
            Stop::Passes => self.passes,
            Stop::Error => {
                let error = snapshot.error.filter(|e| e.reliable)?;
                outlook.trend?.end(self.rule(), outlook.look, &error)?
            }
        };
        // By paths, as one pass may take minutes.
        let [width, height] = snapshot.grid.size.map(f64::from);
        let times = width * height * passes as f64 / snapshot.counts.paths as f64;
        Some(seconds * (times - 1.0).max(0.0)).filter(|left| left.is_finite())
    }

    fn rule(&self) -> StopRule {
        StopRule { wanted: self.error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::document::errors::tests::{history, point_at};
    use burnish::progressive::{Counts, Figure, Interval, State, TileGrid};

    /// 100 passes of 10 x 10 pixels in 20 seconds.
    fn snapshot(error: Option<ErrorEstimate>) -> Snapshot {
        Snapshot {
            epoch: 1,
            grid: TileGrid { size: [10, 10] },
            tiles: Vec::new(),
            dirty: Vec::new(),
            passes: 100,
            whole: true,
            counts: Counts { paths: 10_000, ..Counts::default() },
            error,
            seconds: 20.0,
            group: burnish::trace::ReuseGroup::None,
            state: State::Running,
        }
    }

    /// 2 %, at most 4 %.
    fn error(reliable: bool) -> Option<ErrorEstimate> {
        let figure = Figure { value: 0.02, interval: Interval { low: 0.015, high: 0.04 } };
        Some(ErrorEstimate {
            rel_mse: figure,
            relative: figure,
            rmse: figure,
            terms: 9.0,
            reliable,
        })
    }

    /// Of passes and upper limits.
    fn outlook<const N: usize>(points: [(u64, f64); N]) -> Outlook {
        let points = points.into_iter().map(|(n, high)| point_at(n, high, true));
        Outlook { trend: Trend::of(&history(points)), look: 100 }
    }

    #[test]
    fn the_end_is_told_as_far_as_it_is_known() {
        let passes = Goal { passes: 250, ..Goal::default() };
        let wanted = |error| Goal { stop: Stop::Error, error, ..Goal::default() };
        let time = |seconds| Goal { stop: Stop::Time, seconds, ..Goal::default() };
        for (goal, error, words) in [
            (passes, None, "done in 30 s"),
            (Goal { passes: 3, ..passes }, None, "done in 0 s"),
            // It is the upper limit that has to come down, to a half: four times the passes, if it
            // falls with their root, which is not known yet.
            (wanted(0.02), error(true), "2.00 % in 60 s ?"),
            (wanted(0.02), error(false), "2.00 % in -"),
            (wanted(0.02), None, "2.00 % in -"),
            (time(65.0), None, "done in 45 s"),
            (time(1.0), None, "done in 0 s"),
        ] {
            assert_eq!(goal.ahead(&snapshot(error), outlook([(100, 0.04)])), words, "{goal:?}");
        }
        let unborn = Snapshot { counts: Counts::default(), seconds: 0.0, ..snapshot(None) };
        assert_eq!(passes.ahead(&unborn, Outlook::default()), "done in -");
        // Seen to fall with the passes themselves, if not for long: about three times as many rather
        // than four times.
        let seen = [33, 40, 50, 64, 80, 100].map(|n: u64| (n, 3.99 / n as f64));
        let (goal, now) = (wanted(0.02), snapshot(error(true)));
        assert_eq!(goal.ahead(&now, outlook(seen)), "2.00 % in 42 s");
        assert!((goal.part(&now, outlook(seen)).unwrap() - 20.0 / 61.6).abs() < 1e-9);
        // Not before it is looked at again.
        assert_eq!(goal.ahead(&now, Outlook { look: 300, ..outlook(seen) }), "2.00 % in 40 s");
    }

    #[test]
    fn an_error_is_looked_at_as_when_a_file_is_rendered() {
        let goal = Goal { stop: Stop::Error, error: 0.05, ..Goal::default() };
        assert_eq!(goal.limit(0, None), StopRule::FIRST);
        assert_eq!(goal.limit(7, error(true).as_ref()), StopRule::FIRST);
        assert_eq!(goal.limit(100, error(true).as_ref()), 100, "good enough");
        assert_eq!(goal.limit(100, error(false).as_ref()), 112, "good, but not reliably so");
        assert!(!goal.time_is_up(1e12));
    }
}
