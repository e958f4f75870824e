//! Tracing until a goal is reached, with checkpoints on the way.

use super::checkpoint::Keeper;
use super::progress::{self, Goal, Progress};
use super::snapshots::next;
use super::talk::{detail, note, say, warning};
use super::{Failure, interrupt};
use burnish::progressive::{Options, Session, Snapshot, State, StopRule};
use std::time::{Duration, Instant};

/// A render that is over.
pub(super) struct Traced {
    pub(super) snapshot: Snapshot,
    /// Ended by Ctrl-C or another signal.
    pub(super) interrupted: bool,
    /// From the program's start until every pixel had a sample.
    pub(super) first_image: Option<Duration>,
}

/// When a render ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) goal: Goal,
    /// At the latest.
    pub(super) time: Option<f64>,
}

/// How long Ctrl-C may go unnoticed.
const TICK: Duration = Duration::from_millis(50);
/// Between two snapshots: how late the first complete picture may be noticed.
const INTERVAL: Duration = Duration::from_millis(20);

impl End {
    /// By what the command line says: passes, unless it is seconds or an error.
    pub(super) fn new(passes: u64, time: Option<f64>, error: Option<f64>) -> End {
        let goal = match (error, time) {
            (Some(wanted), _) => Goal::Error(StopRule { wanted }),
            (None, Some(seconds)) => Goal::Time(Duration::from_secs_f64(seconds)),
            (None, None) => Goal::Passes(passes),
        };
        End { goal, time }
    }

    /// Passes to begin with for a picture that has some already.
    pub(super) fn limit(self, has: u64) -> u64 {
        match self.goal {
            Goal::Passes(passes) => passes,
            Goal::Time(_) => Session::MAX_PASSES,
            Goal::Error(_) => StopRule::FIRST.max(has),
        }
    }
}

/// How the workers divide their time.
pub(super) fn options(threads: usize) -> Options {
    Options { interval: INTERVAL, ..Options::headless(threads) }
}

/// Traces until the goal is reached or Ctrl-C is pressed; what is to be kept is kept then too.
pub(super) fn trace(
    session: &Session,
    end: End,
    started: Instant,
    keeper: &mut Option<Keeper>,
) -> Result<Traced, Failure> {
    let time = end.time.map_or(Duration::MAX, Duration::from_secs_f64);
    let mut progress = Progress::start(end.goal);
    let mut first_image = None;
    let mut stopping = false;
    loop {
        let left = time.saturating_sub(progress.elapsed());
        let wait = if stopping { TICK } else { left.min(TICK) };
        if let Some(snapshot) = next(session, wait)? {
            if snapshot.passes > 0 {
                first_image.get_or_insert_with(|| started.elapsed());
                // From now on nobody watches as closely.
                session.set_interval(TICK * 10);
            }
            progress.show(&snapshot);
            let again = match (end.goal, &snapshot.state) {
                (Goal::Error(rule), State::Done) => {
                    rule.next(snapshot.passes, snapshot.error.as_ref())
                }
                _ => None,
            };
            if let Some(passes) = again.filter(|_| !stopping) {
                session.set_limit(passes);
            } else if snapshot.state != State::Running {
                let interrupted = snapshot.state == State::Paused && interrupt::came();
                return Ok(Traced { snapshot, interrupted, first_image });
            }
        }
        if let Some(keeper) = keeper.as_mut().filter(|_| first_image.is_some()) {
            keeper.keep_if_due(session);
        }
        if !stopping && (left.is_zero() || interrupt::came()) {
            stopping = true;
            session.pause();
        }
    }
}

/// What there is to know about a finished render.
pub(super) fn tell(traced: &Traced) {
    let Traced { snapshot, interrupted, first_image } = traced;
    let early = if *interrupted { "stopped by a signal: " } else { "" };
    let Snapshot { passes, seconds, counts, .. } = snapshot;
    let (done, error) = (progress::passes(*passes), progress::error(snapshot));
    say(format_args!("{early}{done} in {seconds:.2} s{error}"));
    let millions = |n: u64| n as f64 / seconds.max(1e-9) / 1e6;
    detail(format_args!(
        "{:.2} M paths/s, {:.2} M rays/s; every pixel had a sample after {:.3} s",
        millions(counts.paths),
        millions(counts.rays),
        first_image.map_or(f64::NAN, |t| t.as_secs_f64())
    ));
    if snapshot.error.is_some_and(|e| !e.reliable) {
        note("the error is not yet reliable: too few passes, or a handful of pixels owns it");
    }
    if *passes == 0 {
        warning("not every pixel has a sample yet; the rest is black");
    }
    if counts.nonfinite > 0 {
        let n = counts.nonfinite;
        warning(format_args!(
            "{n} samples were NaN or infinite and are left out; their pixels are wrong"
        ));
    }
    if counts.capped > 0 {
        let n = counts.capped;
        note(format_args!(
            "{n} paths were ended by the safety caps on their length and throughput"
        ));
    }
}
