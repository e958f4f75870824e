//! How far a render is: a bar on a terminal, a line now and then elsewhere.

use super::talk::{Volume, loud, say};
use burnish::progressive::{Snapshot, StopRule};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// When a render is to end by itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Goal {
    /// After this number.
    Passes(u64),
    /// After so long.
    Time(Duration),
    /// When it is good enough.
    Error(StopRule),
}

/// Tells stderr about snapshots.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    goal: Goal,
    start: Instant,
    told: Instant,
}

/// Between two lines where there is no terminal.
const EVERY: Duration = Duration::from_secs(10);
/// The bar's length: finer than any terminal is wide.
const LENGTH: u64 = 10_000;

impl Progress {
    /// Begins to count the time.
    pub(super) fn start(goal: Goal) -> Progress {
        let now = Instant::now();
        let bar = (loud(Volume::Normal) && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(LENGTH), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:32} {percent:>3} %  {msg}  ETA {eta}");
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Progress { bar, goal, start: now, told: now }
    }

    /// Since the start.
    pub(super) fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// Shows a new snapshot.
    pub(super) fn show(&mut self, snapshot: &Snapshot) {
        let text = describe(snapshot, self.goal);
        if let Some(bar) = &self.bar {
            bar.set_position((self.share(snapshot) * LENGTH as f64) as u64);
            bar.set_message(text);
        } else if self.told.elapsed() >= EVERY {
            self.told = Instant::now();
            say(text);
        }
    }

    /// Done so far, in 0..=1. Passes are counted by their paths, as one may take minutes.
    fn share(&self, snapshot: &Snapshot) -> f64 {
        let share = match self.goal {
            Goal::Time(limit) => self.elapsed().as_secs_f64() / limit.as_secs_f64(),
            Goal::Passes(limit) => {
                let [width, height] = snapshot.grid.size.map(f64::from);
                snapshot.counts.paths as f64 / (width * height * limit as f64)
            }
            Goal::Error(rule) => rule
                .needed(snapshot.passes, snapshot.error.as_ref())
                .map_or(0.0, |needed| snapshot.passes as f64 / needed.max(1) as f64),
        };
        share.clamp(0.0, 1.0)
    }
}

impl Drop for Progress {
    /// Takes the bar away.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn describe(snapshot: &Snapshot, goal: Goal) -> String {
    let done = match goal {
        Goal::Passes(limit) => format!("{}/{limit} passes", snapshot.passes),
        Goal::Time(_) | Goal::Error(_) => passes(snapshot.passes),
    };
    let speed = snapshot.counts.paths as f64 / snapshot.seconds.max(1e-9) / 1e6;
    format!("{done}, {speed:.2} M paths/s{}", error(snapshot))
}

/// "1 pass", "2 passes".
pub(super) fn passes(n: u64) -> String {
    if n == 1 { "1 pass".into() } else { format!("{n} passes") }
}

/// ", relative error 1.8 %", or nothing while it is not known.
pub(super) fn error(snapshot: &Snapshot) -> String {
    let percent = |e: burnish::progressive::ErrorEstimate| {
        let [value, low, high] =
            [e.relative.value, e.relative.interval.low, e.relative.interval.high]
                .map(|x| 100.0 * x);
        format!(", relative error {value:.2} % (estimated; 95 % limits {low:.2} to {high:.2} %)")
    };
    snapshot.error.map(percent).unwrap_or_default()
}
