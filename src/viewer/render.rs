//! The session and what it has been told: turns edits of the document into orders for the
//! workers, and hands back what they sent.

use super::document::Document;
use burnish::progressive::{Params, ParamsError, Session, Snapshot};
use egui::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// New pictures are shown at most this often, and less often where drawing is slow. Input and the
/// first picture after a change are shown at once.
const FRAME: Duration = Duration::from_millis(33);
const SLOWEST: Duration = Duration::from_millis(150);
/// Drawing is to take no more than one part in so many of the time: the workers want the cores,
/// too, where a processor has to do a graphics card's work.
const SHARE: f32 = 3.0;

pub(super) struct Render {
    session: Session,
    told: Params,
    limit: u64,
    paused: bool,
    /// What the pictures of the present parameters carry.
    pub(super) epoch: u64,
    changed: Instant,
    /// From the last change to its first pixels.
    pub(super) latency: Option<Duration>,
    /// The newest picture, of whichever epoch.
    pub(super) newest: Option<Snapshot>,
    /// Set while the first picture after a change is awaited.
    awaited: Arc<AtomicBool>,
    /// Milliseconds from one picture to the next.
    pace: Arc<AtomicU64>,
}

impl Render {
    /// Starts `threads` workers (0 for one a core) on the document.
    pub(super) fn start(
        ctx: &Context,
        document: &Document,
        threads: usize,
    ) -> Result<Render, ParamsError> {
        let awaited = Arc::new(AtomicBool::new(true));
        let pace = Arc::new(AtomicU64::new(FRAME.as_millis() as u64));
        let (at_once, wait, ctx) = (awaited.clone(), pace.clone(), ctx.clone());
        let notify = move || {
            if at_once.load(Ordering::Relaxed) {
                ctx.request_repaint();
            } else {
                ctx.request_repaint_after(Duration::from_millis(wait.load(Ordering::Relaxed)));
            }
        };
        let told = document.params.clone();
        let session = Session::start(told.clone(), document.limit, threads, notify)?;
        let mut render = Render {
            session,
            told,
            limit: document.limit,
            paused: false,
            epoch: 0,
            changed: Instant::now(),
            latency: None,
            newest: None,
            awaited,
            pace,
        };
        render.tell(document)?;
        Ok(render)
    }

    /// The parameters that are being rendered.
    pub(super) fn told(&self) -> &Params {
        &self.told
    }

    /// Passes on whatever differs from what the workers know.
    pub(super) fn tell(&mut self, document: &Document) -> Result<(), ParamsError> {
        if document.limit != self.limit {
            self.limit = document.limit;
            self.session.set_limit(self.limit);
        }
        if document.params != self.told {
            self.await_first_pixels();
            self.epoch = self.session.set(document.params.clone())?;
            self.told = document.params.clone();
        }
        if document.paused != self.paused {
            self.paused = document.paused;
            if self.paused { self.session.pause() } else { self.session.resume() }
        }
        Ok(())
    }

    /// Starts again from the first pass.
    pub(super) fn restart(&mut self) {
        self.await_first_pixels();
        self.epoch = self.session.restart();
    }

    /// Takes the newest picture, if there is a new one.
    pub(super) fn drain(&mut self) -> bool {
        let Some(snapshot) = self.session.latest() else { return false };
        if snapshot.epoch >= self.epoch && self.awaited.swap(false, Ordering::Relaxed) {
            self.latency = Some(self.changed.elapsed());
        }
        self.newest = Some(snapshot);
        true
    }

    /// Takes note of how many seconds drawing one frame takes.
    pub(super) fn drawing_takes(&self, seconds: f32) {
        let wait = Duration::try_from_secs_f32(SHARE * seconds).unwrap_or(FRAME);
        self.pace.store(wait.clamp(FRAME, SLOWEST).as_millis() as u64, Ordering::Relaxed);
    }

    fn await_first_pixels(&mut self) {
        self.changed = Instant::now();
        self.awaited.store(true, Ordering::Relaxed);
    }
}
