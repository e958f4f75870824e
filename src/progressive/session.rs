//! Worker threads behind a handle.

use super::work::{Work, Workers};
use super::{Params, ParamsError, Snapshot, State};
use crossbeam_channel::{Receiver, bounded};
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
}

impl Options {
    /// For a window: coarse first, thirty snapshots a second.
    pub fn interactive(threads: usize) -> Options {
        Options { threads, preview: true, interval: Duration::from_millis(33) }
    }
    /// For a file: no preview, few snapshots.
    pub fn headless(threads: usize) -> Options {
        Options { threads, preview: false, interval: Duration::from_millis(500) }
    }
}

/// What the handle tells the workers. The counters are written under the lock of `wanted`, and
/// read without it once a bundle of paths.
#[derive(Debug)]
pub(super) struct Shared {
    wanted: Mutex<Params>,
    changed: Condvar,
    epoch: AtomicU64,
    limit: AtomicU64,
    paused: AtomicBool,
    stopped: AtomicBool,
    /// Shortest time between two snapshots, in milliseconds.
    interval: AtomicU64,
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
        params.fit([0; 2])?;
        let (sender, snapshots) = bounded(1);
        let shared = Arc::new(Shared::new(params, limit, options.interval));
        let outlet = super::outlet::Outlet::new(sender, snapshots.clone(), Box::new(notify));
        let workers = Workers::new(options, shared.clone(), outlet)?;
        let failed = |e: std::io::Error| ParamsError::Threads { threads: 1, reason: e.to_string() };
        let driver = std::thread::Builder::new()
            .name("burnish driver".into())
            .spawn(move || workers.drive())
            .map_err(failed)?;
        Ok(Session { shared, snapshots, driver: Some(driver) })
    }

    /// Renders these from now on. Returns the epoch that their snapshots will carry; it is the
    /// present one when nothing changed. Takes effect within one bundle of paths.
    pub fn set(&self, params: Params) -> Result<u64, ParamsError> {
        params.check()?;
        let mut wanted = self.shared.lock();
        if *wanted == params {
            return Ok(self.epoch());
        }
        params.fit(wanted.size)?;
        *wanted = params;
        Ok(self.shared.next_epoch(wanted))
    }

    /// Starts the present parameters from the first pass again, as a new epoch.
    pub fn restart(&self) -> u64 {
        self.shared.next_epoch(self.shared.lock())
    }

    /// The epoch that is being rendered.
    pub fn epoch(&self) -> u64 {
        self.shared.epoch.load(Ordering::Acquire)
    }

    /// Stops at this many passes (1 to [`Session::MAX_PASSES`]); a higher one goes on.
    pub fn set_limit(&self, passes: u64) {
        let passes = passes.clamp(1, Self::MAX_PASSES);
        self.shared.tell(|shared| shared.limit.store(passes, Ordering::Release));
    }

    /// Stops after the bundles of paths being traced. The sums stay what they are; of what is not yet
    /// in them, about a twentieth of a second of work, some is traced again.
    pub fn pause(&self) {
        self.shared.pause(true);
    }

    /// Goes on.
    pub fn resume(&self) {
        self.shared.pause(false);
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
        self.shared.tell(|shared| shared.stopped.store(true, Ordering::Release));
        if let Some(driver) = self.driver.take() {
            // A panic of the driver has been told as a snapshot or by the panic hook.
            let _ = driver.join();
        }
    }
}

impl Shared {
    pub(super) fn new(params: Params, limit: u64, interval: Duration) -> Shared {
        Shared {
            wanted: Mutex::new(params),
            changed: Condvar::new(),
            epoch: AtomicU64::new(1),
            limit: AtomicU64::new(limit.clamp(1, Session::MAX_PASSES)),
            paused: AtomicBool::new(false),
            stopped: AtomicBool::new(false),
            interval: AtomicU64::new(millis(interval)),
        }
    }

    pub(super) fn pause(&self, paused: bool) {
        self.tell(|shared| shared.paused.store(paused, Ordering::Release));
    }

    fn lock(&self) -> MutexGuard<'_, Params> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self, what: impl FnOnce(&Shared)) {
        let guard = self.lock();
        what(self);
        drop(guard);
        self.changed.notify_all();
    }

    fn next_epoch(&self, guard: MutexGuard<'_, Params>) -> u64 {
        let epoch = self.epoch.load(Ordering::Acquire) + 1;
        self.epoch.store(epoch, Ordering::Release);
        drop(guard);
        self.changed.notify_all();
        epoch
    }

    /// Shortest time between two snapshots.
    pub(super) fn interval(&self) -> Duration {
        Duration::from_millis(self.interval.load(Ordering::Relaxed))
    }

    /// Passes to stop at.
    pub(super) fn limit(&self) -> u64 {
        self.limit.load(Ordering::Acquire)
    }

    /// Whether paths of this epoch may still be traced.
    pub(super) fn goes_on(&self, epoch: u64) -> bool {
        self.epoch.load(Ordering::Acquire) == epoch
            && !self.paused.load(Ordering::Acquire)
            && !self.stopped.load(Ordering::Acquire)
    }

    /// Whether anyone wants the picture of this epoch any more, be it later.
    pub(super) fn is_wanted(&self, epoch: u64) -> bool {
        self.epoch.load(Ordering::Acquire) == epoch && !self.stopped.load(Ordering::Acquire)
    }

    /// Waits until there is something to do for a driver that has rendered `passes` of `epoch`, or
    /// has `failed` to. `idle` is called with the reason before each wait.
    pub(super) fn wait(
        &self,
        epoch: u64,
        passes: u64,
        failed: bool,
        mut idle: impl FnMut(State),
    ) -> Work {
        let mut wanted = self.lock();
        loop {
            let now = self.epoch.load(Ordering::Acquire);
            if self.stopped.load(Ordering::Acquire) {
                return Work::Stop;
            } else if now != epoch {
                return Work::Start(now, Box::new(wanted.clone()));
            } else if failed {
                // Told already; the next epoch starts afresh.
            } else if passes >= self.limit() {
                idle(State::Done);
            } else if self.paused.load(Ordering::Acquire) {
                idle(State::Paused);
            } else {
                return Work::Continue;
            }
            wanted = self.changed.wait(wanted).unwrap_or_else(PoisonError::into_inner);
        }
    }
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
