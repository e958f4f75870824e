//! What a session's handle asks of its driver and workers: the state that they share, under one lock, and the
//! choice of the next piece of work.

use super::params::MAX_PASSES;
use super::turn::{Role, Turn};
use super::{Experiment, Params, State};
use std::fmt;
use std::mem::take;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How a session divides its time.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Worker threads; 0 for one a core.
    pub threads: usize,
    /// Show coarse blocks ahead of the first pass of every epoch.
    pub preview: bool,
    /// Shortest time between two snapshots, those at a change of state excepted.
    pub interval: Duration,
    /// Bytes of memory for pictures of other parameters, which go on from where they were when these
    /// are set again.
    pub keep: u64,
}

impl Options {
    /// For a window: coarse first, thirty snapshots a second.
    pub fn interactive(threads: usize) -> Options {
        Options { threads, preview: true, interval: Duration::from_millis(33), keep: 0 }
    }
    /// For a file: no preview, few snapshots.
    pub fn headless(threads: usize) -> Options {
        Options { threads, preview: false, interval: Duration::from_millis(500), keep: 0 }
    }
}

/// Pictures to be rendered.
#[derive(Debug)]
pub(super) struct Wanted {
    pub(super) params: Params,
    /// Whether what there is of the parameters before is to be thrown away.
    pub(super) discard: bool,
    /// To be compared with it.
    pub(super) beside: Option<Params>,
    /// While there is nothing else to do, the first first.
    pub(super) background: Vec<Params>,
}

/// State that the handle shares with the workers. The counters are written under the lock of `wanted`, and
/// read without it once a batch of paths.
#[derive(Debug)]
pub(super) struct Shared {
    wanted: Mutex<Wanted>,
    changed: Condvar,
    /// Counts the orders of every kind.
    orders: AtomicU64,
    pub(super) epoch: AtomicU64,
    /// Number of the picture beside the shown one; counts up with every other one that is wanted.
    pub(super) beside: AtomicU64,
    pub(super) limit: AtomicU64,
    paused: AtomicBool,
    pub(super) stopped: AtomicBool,
    /// Whether there are wishes.
    pub(super) wished: AtomicBool,
    pub(super) wishes: Wishes,
    /// Shortest time between two snapshots, in milliseconds.
    pub(super) interval: AtomicU64,
    /// Bytes for accumulators that are not in use.
    pub(super) keep: AtomicU64,
    /// Their number and the bytes that they hold.
    pub(super) kept: [AtomicU64; 2],
}

/// How far the driver is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Progress {
    /// Of the picture that is shown.
    pub(super) epoch: u64,
    pub(super) passes: u64,
    pub(super) failed: bool,
    /// Number of the picture beside it that the driver knows, and its passes if there is one that can
    /// be traced.
    pub(super) beside: u64,
    pub(super) beside_passes: Option<u64>,
}

/// Work to be done with the picture that is shown, as it is.
#[derive(Default)]
pub(super) struct Wishes(pub(super) Mutex<Vec<Wish>>);
pub(super) type Wish = Box<dyn FnOnce(&mut Experiment) + Send>;

impl fmt::Debug for Wishes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Wishes")
    }
}

impl Shared {
    pub(super) fn new(params: Params, limit: u64, options: Options) -> Shared {
        let wanted = Wanted { params, discard: false, beside: None, background: Vec::new() };
        Shared {
            wanted: Mutex::new(wanted),
            changed: Condvar::new(),
            orders: AtomicU64::new(0),
            epoch: AtomicU64::new(1),
            beside: AtomicU64::new(0),
            limit: AtomicU64::new(limit.clamp(1, MAX_PASSES)),
            paused: AtomicBool::new(false),
            stopped: AtomicBool::new(false),
            wished: AtomicBool::new(false),
            wishes: Wishes::default(),
            interval: AtomicU64::new(millis(options.interval)),
            keep: AtomicU64::new(options.keep),
            kept: Default::default(),
        }
    }

    pub(super) fn pause(&self, paused: bool) {
        self.apply(|shared| shared.paused.store(paused, Ordering::Release));
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn apply(&self, what: impl FnOnce(&Shared)) {
        let guard = self.lock();
        what(self);
        self.signal(guard);
    }

    pub(super) fn signal(&self, guard: MutexGuard<'_, Wanted>) {
        self.orders.fetch_add(1, Ordering::Release);
        drop(guard);
        self.changed.notify_all();
    }

    pub(super) fn next_epoch(&self, guard: MutexGuard<'_, Wanted>) -> u64 {
        let epoch = self.epoch.load(Ordering::Acquire) + 1;
        self.epoch.store(epoch, Ordering::Release);
        self.signal(guard);
        epoch
    }

    /// Whether something is to be done with the picture that is shown.
    pub(super) fn is_wished(&self) -> bool {
        self.wished.load(Ordering::Acquire)
    }

    /// What that is; nothing is left.
    pub(super) fn wishes(&self) -> Vec<Wish> {
        let mut wishes = self.wishes.0.lock().unwrap_or_else(PoisonError::into_inner);
        self.wished.store(false, Ordering::Release);
        take(&mut *wishes)
    }

    /// Shortest time between two snapshots.
    pub(super) fn interval(&self) -> Duration {
        Duration::from_millis(self.interval.load(Ordering::Relaxed))
    }

    /// Passes to stop at.
    pub(super) fn limit(&self) -> u64 {
        self.limit.load(Ordering::Acquire)
    }

    /// Bytes for accumulators that are not in use.
    pub(super) fn keep(&self) -> u64 {
        self.keep.load(Ordering::Acquire)
    }

    /// Lets the handle know of accumulators that are not in use: how many, and their bytes.
    pub(super) fn set_kept(&self, size: [u64; 2]) {
        self.kept.iter().zip(size).for_each(|(place, n)| place.store(n, Ordering::Relaxed));
    }

    /// Number of the picture that is to be beside the shown one.
    pub(super) fn beside(&self) -> u64 {
        self.beside.load(Ordering::Acquire)
    }

    /// Whether paths of this turn may still be traced.
    pub(super) fn goes_on(&self, turn: Turn) -> bool {
        let paused = turn.role != Role::Background && self.paused.load(Ordering::Acquire);
        self.is_wanted(turn) && !paused
    }

    /// Whether what is being traced is still to be done, be it later. Where not, it is done when its
    /// accumulator has another turn.
    pub(super) fn is_wanted(&self, turn: Turn) -> bool {
        let due = match turn.role {
            Role::Shown => self.epoch.load(Ordering::Acquire) == turn.epoch,
            Role::Beside | Role::Background => self.orders.load(Ordering::Acquire) == turn.orders,
        };
        due && !self.stopped.load(Ordering::Acquire)
    }

    /// Waits until there is something to do for a driver that is so far and keeps at most `keep` bytes. `idle` is called with the
    /// reason when the picture that is shown is at rest; `there` tells the passes that there are of
    /// other parameters, if more can be kept of these.
    pub(super) fn wait(
        &self,
        at: Progress,
        keep: u64,
        mut idle: impl FnMut(State),
        there: impl Fn(&Params) -> Option<u64>,
    ) -> Work {
        let mut wanted = self.lock();
        loop {
            let (epoch, beside) = (self.epoch.load(Ordering::Acquire), self.beside());
            let turn = |role| {
                let number = if role == Role::Beside { beside } else { epoch };
                Turn { role, epoch: number, orders: self.orders.load(Ordering::Acquire) }
            };
            let (limit, paused) = (self.limit(), self.paused.load(Ordering::Acquire));
            if self.stopped.load(Ordering::Acquire) {
                return Work::Stop;
            } else if epoch != at.epoch {
                let discard = std::mem::take(&mut wanted.discard);
                return Work::Start(turn(Role::Shown), Box::new(wanted.params.clone()), discard);
            } else if beside != at.beside {
                let params = wanted.beside.clone().map(Box::new);
                return Work::StartBeside(turn(Role::Beside), params);
            } else if self.is_wished() {
                return Work::Keep;
            } else if self.keep() != keep {
                return Work::Resize;
            }
            let shown = (!at.failed && !paused && at.passes < limit).then_some(at.passes);
            let other = at.beside_passes.filter(|&passes| !paused && passes < limit);
            match (shown, other) {
                (Some(a), Some(b)) if b < a => {
                    return Work::Beside(turn(Role::Beside), yield_at(a));
                }
                (Some(_), Some(b)) => return Work::Shown(turn(Role::Shown), yield_at(b)),
                (Some(_), None) => return Work::Shown(turn(Role::Shown), u64::MAX),
                (None, Some(_)) => return Work::Beside(turn(Role::Beside), u64::MAX),
                (None, None) => {}
            }
            if !at.failed {
                idle(if at.passes >= limit { State::Done } else { State::Paused });
                let far = limit.min(at.passes);
                let next = wanted.background.iter().find(|p| there(p).is_some_and(|n| n < far));
                if let Some(params) = next {
                    return Work::Background(turn(Role::Background), Box::new(params.clone()));
                }
            }
            wanted = self.changed.wait(wanted).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Passes at which a picture leaves the workers to another that has so many: the two are to look as
/// if they were traced at once.
fn yield_at(passes: u64) -> u64 {
    passes + (passes / 16).clamp(1, 16)
}

/// A driver's next piece of work.
pub(super) enum Work {
    Stop,
    /// Keeps more or fewer bytes than before.
    Resize,
    /// Does what was wished with the experiment that is shown.
    Keep,
    /// Shows a picture of other parameters, or of the same ones anew; whether what was shown is to be
    /// thrown away.
    Start(Turn, Box<Params>, bool),
    /// Has a picture of these beside it, or none.
    StartBeside(Turn, Option<Box<Params>>),
    /// Traces, up to this number of passes.
    Shown(Turn, u64),
    /// The same of the picture beside.
    Beside(Turn, u64),
    /// Traces a picture of these as long as nothing else is wanted.
    Background(Turn, Box<Params>),
}

pub(super) fn millis(interval: Duration) -> u64 {
    u64::try_from(interval.as_millis()).unwrap_or(u64::MAX)
}
