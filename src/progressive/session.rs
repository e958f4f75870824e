//! Worker threads behind a handle.

use super::control::{Options, Shared, millis};
use super::driver::{Driver, Start};
use super::mailbox::Mailbox;
use super::params::MAX_PASSES;
use super::work::Workers;
use super::{Experiment, ExperimentError, Params, ParamsError, Snapshot, State};
use crate::scene::Scene;
use crossbeam_channel::{Receiver, bounded};
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
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

/// Pictures kept of other parameters than the present ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeptPictures {
    /// Their number.
    pub pictures: u64,
    /// Bytes of memory that they hold.
    pub bytes: u64,
}

impl Session {
    /// Largest pass limit.
    pub const MAX_PASSES: u64 = MAX_PASSES;

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
        self.shared.signal(wanted);
        Ok(number)
    }

    /// Renders these, the first first, whenever the present ones are done or paused: to as many passes
    /// as those have, and as far as there is [memory](Options::keep) to keep them.
    pub fn set_background(&self, params: Vec<Params>) {
        let mut wanted = self.shared.lock();
        if wanted.background != params {
            wanted.background = params;
            self.shared.signal(wanted);
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

impl Drop for Session {
    fn drop(&mut self) {
        self.shared.apply(|shared| shared.stopped.store(true, Ordering::Release));
        if let Some(driver) = self.driver.take() {
            // A panic of the driver has been told as a snapshot or by the panic hook.
            let _ = driver.join();
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
