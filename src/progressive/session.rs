//! Worker threads behind a handle.

use super::driver::{Driver, Start};
use super::mailbox::Mailbox;
use super::turn::{Role, Turn};
use super::work::{Work, Workers};
use super::{Experiment, ExperimentError, Params, ParamsError, Snapshot, State};
use crate::scene::Scene;
use crossbeam_channel::{Receiver, bounded};
use std::fmt;
use std::mem::take;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Passes are traced in the background until the handle is dropped.
///
/// ```
/// use burnish::progressive::{Params, Session, State};
/// use burnish::scene::{Material, SceneBuilder};
/// use std::sync::Arc;
///
/// let mut builder = SceneBuilder::new("ball under a white sky");
/// let clay = builder.material(Material::reflecting("clay", [0.6, 0.4, 0.3], [0.0; 3], 10.0)?);
/// builder.sphere(glam::DVec3::ZERO, 1.0, clay)?;
/// builder.environment = [1.0; 3];
/// builder.screen = [40, 30];
///
/// let session = Session::start(Params::new(Arc::new(builder.build())), 8, 0, || {})?;
/// let finished = session.snapshots().iter().find(|s| s.state == State::Done).unwrap();
/// assert_eq!(finished.passes, 8);
/// assert!(finished.mean().pixels[0] == [1.0; 3]); // the sky
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Session {
    shared: Arc<Shared>,
    snapshots: Receiver<Snapshot>,
    beside: Receiver<Snapshot>,
    driver: Option<JoinHandle<()>>,
}

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

/// Pictures kept of other parameters than the present ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeptPictures {
    /// Their number.
    pub pictures: u64,
    /// Bytes of memory that they hold.
    pub bytes: u64,
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

/// What is to be rendered.
#[derive(Debug)]
struct Wanted {
    params: Params,
    /// Whether what there is of the parameters before is to be thrown away.
    discard: bool,
    /// To be compared with it.
    beside: Option<Params>,
    /// While there is nothing else to do, the first first.
    background: Vec<Params>,
}

/// What the handle tells the workers. The counters are written under the lock of `wanted`, and
/// read without it once a batch of paths.
#[derive(Debug)]
pub(super) struct Shared {
    wanted: Mutex<Wanted>,
    changed: Condvar,
    /// Counts the orders of every kind.
    orders: AtomicU64,
    epoch: AtomicU64,
    /// Number of the picture beside the shown one; counts up with every other one that is wanted.
    beside: AtomicU64,
    limit: AtomicU64,
    paused: AtomicBool,
    stopped: AtomicBool,
    /// Whether there are wishes.
    wished: AtomicBool,
    wishes: Wishes,
    /// Shortest time between two snapshots, in milliseconds.
    interval: AtomicU64,
    /// Bytes for accumulators that are not in use.
    keep: AtomicU64,
    /// Their number and the bytes that they hold.
    kept: [AtomicU64; 2],
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

/// What is to be done with the picture that is shown, as it is.
#[derive(Default)]
struct Wishes(Mutex<Vec<Wish>>);
pub(super) type Wish = Box<dyn FnOnce(&mut Experiment) + Send>;

impl fmt::Debug for Wishes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Wishes")
    }
}

impl Session {
    /// Largest pass limit.
    pub const MAX_PASSES: u64 = 1 << 32;

    /// Starts `threads` workers (0 for one a core). `notify` is called from a worker whenever a
    /// new snapshot waits; it must not block.
    pub fn start(
        params: Params,
        limit: u64,
        threads: usize,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> Result<Session, ParamsError> {
        Session::with_options(params, limit, Options::interactive(threads), notify)
    }

    /// The same with a say in how time is divided.
    pub fn with_options(
        params: Params,
        limit: u64,
        options: Options,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> Result<Session, ParamsError> {
        params.check()?;
        params.fit(limit, [0; 2], 0)?;
        Session::launch(params, limit, options, notify, None)
    }

    /// Goes on with an experiment, of its scene read again, up to `limit` passes in all: with the bits that it
    /// would have if it had never stopped. A scene that is not the experiment's is refused.
    pub fn with_experiment(
        experiment: Experiment,
        scene: Arc<Scene>,
        limit: u64,
        options: Options,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> Result<Session, ExperimentError> {
        experiment.is_resumable()?;
        let params = experiment.params(scene)?;
        // Its sums are there already.
        params.fit(limit, params.size, 0)?;
        Ok(Session::launch(params, limit, options, notify, Some(Start::of(experiment)))?)
    }

    fn launch(
        params: Params,
        limit: u64,
        options: Options,
        notify: impl Fn() + Send + Sync + 'static,
        start: Option<Start>,
    ) -> Result<Session, ParamsError> {
        let (sender, snapshots) = bounded(1);
        let (beside_sender, beside) = bounded(1);
        let shared = Arc::new(Shared::new(params, limit, options));
        let notify = Arc::new(notify);
        let outlets = [(sender, &snapshots), (beside_sender, &beside)].map(|(sender, receiver)| {
            let notify = notify.clone();
            Mailbox::new(sender, receiver.clone(), Box::new(move || notify()))
        });
        let workers = Workers::new(options, shared.clone(), outlets)?;
        let failed = |e: std::io::Error| ParamsError::Threads { threads: 1, reason: e.to_string() };
        let driver = std::thread::Builder::new()
            .name("burnish driver".into())
            .spawn(move || Driver::new(workers, start).drive())
            .map_err(failed)?;
        Ok(Session { shared, snapshots, beside, driver: Some(driver) })
    }

    /// Renders these from now on. Returns the epoch that their snapshots will carry; it is the
    /// present one when nothing changed. Takes effect within one batch of paths. What has been traced
    /// of the parameters before is [kept](Options::keep), and goes on once they are set again.
    pub fn set(&self, params: Params) -> Result<u64, ParamsError> {
        params.check()?;
        let mut wanted = self.shared.lock();
        if wanted.params == params {
            return Ok(self.epoch());
        }
        params.fit(self.shared.limit(), wanted.params.size, self.kept().bytes)?;
        wanted.params = params;
        Ok(self.shared.next_epoch(wanted))
    }

    /// Starts the present parameters from the first pass again, as a new epoch.
    pub fn restart(&self) -> u64 {
        let mut wanted = self.shared.lock();
        wanted.discard = true;
        self.shared.next_epoch(wanted)
    }

    /// Renders these in turn with the present parameters, the picture of fewer passes first; to the
    /// same limit. Returns the epoch that their snapshots, of [`Session::latest_beside`], will carry.
    /// Where they are the present parameters themselves there are none.
    pub fn set_beside(&self, params: Option<Params>) -> Result<u64, ParamsError> {
        if let Some(params) = &params {
            params.check()?;
            params.fit(self.shared.limit(), [0; 2], self.kept().bytes)?;
        }
        let mut wanted = self.shared.lock();
        if wanted.beside != params {
            wanted.beside = params;
            self.shared.beside.fetch_add(1, Ordering::Release);
        }
        let number = self.shared.beside.load(Ordering::Acquire);
        self.shared.tell_with(wanted);
        Ok(number)
    }

    /// Renders these, the first first, whenever the present ones are done or paused: to as many passes
    /// as those have, and as far as there is [memory](Options::keep) to keep them.
    pub fn set_background(&self, params: Vec<Params>) {
        let mut wanted = self.shared.lock();
        if wanted.background != params {
            wanted.background = params;
            self.shared.tell_with(wanted);
        }
    }

    /// Keeps at most this number of bytes of pictures of other parameters from now on.
    pub fn set_keep(&self, bytes: u64) {
        self.shared.apply(|shared| shared.keep.store(bytes, Ordering::Release));
    }

    /// What is kept of other parameters.
    pub fn kept(&self) -> KeptPictures {
        let [pictures, bytes] = [0, 1].map(|i: usize| self.shared.kept[i].load(Ordering::Relaxed));
        KeptPictures { pictures, bytes }
    }

    /// The epoch that is being rendered.
    pub fn epoch(&self) -> u64 {
        self.shared.epoch.load(Ordering::Acquire)
    }

    /// Stops at this many passes (1 to [`Session::MAX_PASSES`]); a higher one goes on.
    pub fn set_limit(&self, passes: u64) {
        let passes = passes.clamp(1, Self::MAX_PASSES);
        self.shared.apply(|shared| shared.limit.store(passes, Ordering::Release));
    }

    /// Stops after the batches of paths being traced. The sums stay what they are; of what is not yet
    /// in them, about a twentieth of a second of work, some is traced again.
    pub fn pause(&self) {
        self.shared.pause(true);
    }

    /// Goes on.
    pub fn resume(&self) {
        self.shared.pause(false);
    }

    /// Has the driver's thread do this with the experiment of the picture that is shown, at the next moment at
    /// which no worker is about it: at the end of a pass, unless a pause has come within one. Nothing is
    /// traced meanwhile. It is dropped undone if the session ends or fails before.
    pub fn visit_experiment(&self, wish: impl FnOnce(&mut Experiment) + Send + 'static) {
        self.shared.apply(|shared| {
            let mut wishes = shared.wishes.0.lock().unwrap_or_else(PoisonError::into_inner);
            wishes.push(Box::new(wish));
            shared.wished.store(true, Ordering::Release);
        });
    }

    /// From now on, the shortest time between two snapshots, to whole milliseconds; those at a change
    /// of state come at once all the same. Fewer leave more time for tracing.
    pub fn set_interval(&self, interval: Duration) {
        self.shared.interval.store(millis(interval), Ordering::Relaxed);
    }

    /// The newest snapshot not yet taken, if there is one. Never blocks.
    pub fn latest(&self) -> Option<Snapshot> {
        self.snapshots.try_recv().ok()
    }

    /// The newest snapshot not yet taken of the picture [beside](Session::set_beside), if there is one.
    pub fn latest_beside(&self) -> Option<Snapshot> {
        self.beside.try_recv().ok()
    }

    /// The channel itself, for waiting. It holds at most one snapshot, the newest.
    pub fn snapshots(&self) -> &Receiver<Snapshot> {
        &self.snapshots
    }
}

fn millis(interval: Duration) -> u64 {
    u64::try_from(interval.as_millis()).unwrap_or(u64::MAX)
}

impl Drop for Session {
    fn drop(&mut self) {
        self.shared.apply(|shared| shared.stopped.store(true, Ordering::Release));
        if let Some(driver) = self.driver.take() {
            // A panic of the driver has been told as a snapshot or by the panic hook.
            let _ = driver.join();
        }
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
            limit: AtomicU64::new(limit.clamp(1, Session::MAX_PASSES)),
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

    fn lock(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn apply(&self, what: impl FnOnce(&Shared)) {
        let guard = self.lock();
        what(self);
        self.tell_with(guard);
    }

    fn tell_with(&self, guard: MutexGuard<'_, Wanted>) {
        self.orders.fetch_add(1, Ordering::Release);
        drop(guard);
        self.changed.notify_all();
    }

    fn next_epoch(&self, guard: MutexGuard<'_, Wanted>) -> u64 {
        let epoch = self.epoch.load(Ordering::Acquire) + 1;
        self.epoch.store(epoch, Ordering::Release);
        self.tell_with(guard);
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
    pub(super) fn tell_kept(&self, size: [u64; 2]) {
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

    /// Waits until there is something to do for a driver that is so far. `idle` is called with the
    /// reason when the picture that is shown is at rest; `there` tells the passes that there are of
    /// other parameters, if more can be kept of these.
    pub(super) fn wait(
        &self,
        at: Progress,
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

/// Passes at which a picture leaves the workers to another that has as many: the two are to look as
/// if they were traced at once.
fn yield_at(passes: u64) -> u64 {
    passes + (passes / 16).clamp(1, 16)
}

/// Renders `passes` passes and returns the finished picture: the way without a window.
///
/// Blocks until done. The picture has the same bits on any number of threads.
pub fn render(params: Params, passes: u64, threads: usize) -> Result<Snapshot, ParamsError> {
    let session = Session::with_options(params, passes, Options::headless(threads), || {})?;
    let over = |s: &Snapshot| matches!(s.state, State::Done | State::Failed(_));
    match session.snapshots().iter().find(over) {
        Some(Snapshot { state: State::Failed(reason), .. }) => {
            Err(ParamsError::Threads { threads, reason })
        }
        Some(snapshot) => Ok(snapshot),
        None => Err(ParamsError::Threads { threads, reason: "the workers stopped".into() }),
    }
}
