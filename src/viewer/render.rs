//! The session and the parameters applied to it: turns edits of the document into orders for the
//! workers, and hands back what they sent.

use crate::viewer::document::Document;
use crate::viewer::document::errors::Curves;
use crate::viewer::document::goal::{Goal, Outlook, Stop};
use crate::viewer::document::trend::Trend;
use crate::viewer::settings::Switching;
use burnish::brdf::Model;
use burnish::progressive::{
    Experiment, ExperimentError, KeptPictures, Options, Params, ParamsError, Session, Snapshot,
    State,
};
use egui::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// New pictures are shown at most this often, and less often where drawing is slow. Input and the
/// first picture after a change are shown at once.
const FRAME: Duration = Duration::from_millis(33);
const SLOWEST: Duration = Duration::from_millis(150);
/// Drawing is to take no more than one part in `SHARE` of the time: the workers want the cores,
/// too, where a processor has to do a graphics card's work.
const SHARE: f32 = 3.0;
/// Seconds after the last input from which on the window is only looked at, and the workers get nearly all of the
/// time.
const CALM: f64 = 2.0;
const CALM_FRAME: Duration = Duration::from_millis(400);
const CALM_SLOWEST: Duration = Duration::from_millis(2000);
const CALM_SHARE: f32 = 60.0;

pub(super) struct Render {
    session: Session,
    applied: Params,
    /// Parameters that are traced in turn with these.
    beside: Option<Params>,
    beside_epoch: u64,
    /// The newest picture of that.
    newest_beside: Option<Snapshot>,
    switching: Switching,
    goal: Goal,
    /// Passes at which the workers are to stop: for good, or until the error has been looked at.
    limit: u64,
    paused: bool,
    /// Whether the cores are left to other work, until a change is to be seen.
    gives_way: bool,
    /// Epoch of the pictures of the present parameters.
    pub(super) epoch: u64,
    changed: Instant,
    /// Time from the last change to its first pixels.
    pub(super) latency: Option<Duration>,
    /// The newest picture, of whichever epoch.
    pub(super) newest: Option<Arc<Snapshot>>,
    /// Set while the first picture after a change is awaited.
    awaited: Arc<AtomicBool>,
    /// Time from one picture to the next.
    pace: Duration,
    /// Seconds that drawing one frame takes.
    drawing: f32,
    /// When there was input, in egui's seconds.
    touched: f64,
}

impl Render {
    /// Starts `threads` workers (0 for one a core) on the document, which may go on with an experiment of
    /// its parameters.
    pub(super) fn start(
        ctx: &Context,
        document: &Document,
        threads: usize,
        switching: Switching,
        begin: Option<Experiment>,
    ) -> Result<Render, ExperimentError> {
        let ctx_time = ctx.input(|i| i.time);
        let awaited = Arc::new(AtomicBool::new(true));
        let (at_once, ctx) = (awaited.clone(), ctx.clone());
        let notify = move || {
            if at_once.load(Ordering::Relaxed) {
                ctx.request_repaint();
            } else {
                // The workers keep the pace; what they send out of turn, such as the end, is not to
                // wait for long.
                ctx.request_repaint_after(FRAME);
            }
        };
        let applied = document.params.clone();
        let (goal, limit) = (document.goal, document.goal.limit(0, None));
        let options = Options { keep: switching.keep << 20, ..Options::interactive(threads) };
        let session = match begin {
            Some(begin) => {
                let scene = applied.scene.clone();
                Session::with_experiment(begin, scene, limit, options, notify)?
            }
            None => Session::with_options(applied.clone(), limit, options, notify)?,
        };
        let mut render = Render {
            session,
            applied,
            beside: None,
            beside_epoch: 0,
            newest_beside: None,
            switching,
            goal,
            limit,
            paused: false,
            gives_way: false,
            epoch: 0,
            changed: Instant::now(),
            latency: None,
            newest: None,
            awaited,
            pace: FRAME,
            drawing: 0.0,
            touched: ctx_time,
        };
        render.apply(document)?;
        render.refine_others();
        Ok(render)
    }

    /// The parameters that are being rendered.
    pub(super) fn applied(&self) -> &Params {
        &self.applied
    }

    /// Applies whatever differs from what the workers have.
    pub(super) fn apply(&mut self, document: &Document) -> Result<(), ParamsError> {
        if document.params != self.applied {
            self.await_first_pixels();
            self.gives_way = false;
            self.epoch = self.session.set(document.params.clone())?;
            self.applied = document.params.clone();
            self.refine_others();
            self.set_goal(document.goal);
        } else if document.goal != self.goal {
            self.set_goal(document.goal);
        }
        let paused = document.paused || self.gives_way || self.time_is_up();
        if paused != self.paused {
            self.paused = paused;
            if self.paused { self.session.pause() } else { self.session.resume() }
        }
        Ok(())
    }

    /// Has the workers trace these in turn with the present parameters.
    pub(super) fn apply_beside(&mut self, params: Option<Params>) -> Result<(), ParamsError> {
        if params != self.beside {
            self.beside_epoch = self.session.set_beside(params.clone())?;
            self.newest_beside = None;
            self.beside = params;
            self.gives_way = false;
            self.refine_others();
        }
        Ok(())
    }

    /// Applies other settings of switching.
    pub(super) fn set_switching(&mut self, switching: Switching) {
        if switching != self.switching {
            self.switching = switching;
            self.session.set_keep(switching.keep << 20);
            self.refine_others();
        }
    }

    /// Leaves the cores to other work for now, or takes them back; a change is seen at once all the same.
    pub(super) fn give_way(&mut self, gives_way: bool) {
        self.gives_way = gives_way;
        self.refine_others();
    }

    /// Pictures kept of other parameters.
    pub(super) fn kept(&self) -> KeptPictures {
        self.session.kept()
    }

    /// The newest picture of what is traced beside the shown one; that itself where the two are the
    /// same.
    pub(super) fn beside(&self) -> Option<&Snapshot> {
        match &self.beside {
            Some(params) if *params == self.applied => self.current(),
            Some(_) => self.newest_beside.as_ref(),
            None => None,
        }
    }

    /// Parameters traced beside the shown ones.
    #[cfg(test)]
    pub(super) fn beside_params(&self) -> Option<&Params> {
        self.beside.as_ref()
    }

    /// The other models may be wanted next.
    fn refine_others(&self) {
        let others = Model::ALL.into_iter().filter(|_| self.switching.refine && !self.gives_way);
        let others = others.filter(|&model| model != self.applied.model);
        self.session
            .set_background(others.map(|model| Params { model, ..self.applied.clone() }).collect());
    }

    /// Starts again from the first pass.
    pub(super) fn restart(&mut self) {
        self.await_first_pixels();
        self.gives_way = false;
        self.epoch = self.session.restart();
        self.set_goal(self.goal);
    }

    /// Whether the picture is what was wished for: then nothing is traced any more.
    pub(super) fn is_done(&self) -> bool {
        let reached = |s: &Snapshot| s.state == State::Done && s.passes >= self.limit;
        self.current().is_some_and(reached) || self.time_is_up()
    }

    /// Takes the newest picture, if there is a new one, and notes its error.
    pub(super) fn drain(&mut self, errors: &mut Curves) -> bool {
        if let Some(beside) = self.session.latest_beside() {
            self.newest_beside = Some(beside).filter(|s| s.epoch == self.beside_epoch);
            if let (Some(params), Some(snapshot)) = (&self.beside, &self.newest_beside) {
                errors.note(params, snapshot);
            }
        }
        let Some(snapshot) = self.session.latest() else { return false };
        if snapshot.epoch >= self.epoch {
            errors.note(&self.applied, &snapshot);
        }
        self.newest = Some(Arc::new(snapshot));
        let looks = |s: &Snapshot| s.state == State::Done && s.passes >= self.limit;
        if self.goal.stop == Stop::Error && self.current().is_some_and(looks) {
            self.set_goal(self.goal);
        }
        true
    }

    /// Expected way to the goal.
    pub(super) fn outlook(&self, errors: &Curves) -> Outlook {
        let curve = errors.of(&self.applied).filter(|_| self.current().is_some());
        Outlook { trend: curve.and_then(|c| Trend::of(&c.estimated)), look: self.limit }
    }

    /// Takes note that the newest picture is shown.
    pub(super) fn note_shown(&mut self) {
        if self.current().is_some() && self.awaited.swap(false, Ordering::Relaxed) {
            self.latency = Some(self.changed.elapsed());
        }
    }

    /// Takes note of how many seconds drawing one frame takes.
    pub(super) fn note_drawing(&mut self, seconds: f32) {
        self.drawing = seconds;
    }

    /// Sets the pace of the pictures, at `now` seconds: brisk while somebody is at work in the window
    /// (`touched`), calm afterwards.
    pub(super) fn pace(&mut self, now: f64, touched: bool) {
        if touched || self.awaited.load(Ordering::Relaxed) || self.ends_soon() {
            self.touched = now;
        }
        let wait = wait(self.drawing, now - self.touched);
        if wait.as_millis() != self.pace.as_millis() {
            self.pace = wait;
            self.session.set_interval(wait);
        }
    }

    /// The newest picture, if it is one of the present parameters.
    pub(super) fn current(&self) -> Option<&Snapshot> {
        self.newest.as_deref().filter(|s| s.epoch >= self.epoch)
    }

    /// Whether the clock has to be looked at often, for the workers don't.
    fn ends_soon(&self) -> bool {
        let soon = 2.0 * CALM_SLOWEST.as_secs_f64();
        let left = |s: &Snapshot| self.goal.seconds - s.seconds;
        self.goal.stop == Stop::Time && self.current().is_some_and(|s| left(s) < soon)
    }

    fn time_is_up(&self) -> bool {
        self.current().is_some_and(|s| self.goal.time_is_up(s.seconds))
    }

    /// Has the workers go on as far as it takes, from what is there.
    fn set_goal(&mut self, goal: Goal) {
        let there = self.current().map(|s| (s.passes, s.error));
        let (passes, error) = there.unwrap_or((0, None));
        self.goal = goal;
        let limit = goal.limit(passes, error.as_ref());
        if limit != self.limit {
            self.limit = limit;
            self.session.set_limit(limit);
        }
    }

    fn await_first_pixels(&mut self) {
        self.changed = Instant::now();
        self.awaited.store(true, Ordering::Relaxed);
    }
}

/// Time from one picture to the next, where drawing one takes `drawing` seconds and the last input was
/// `since` seconds ago.
fn wait(drawing: f32, since: f64) -> Duration {
    let (share, shortest, longest) =
        if since < CALM { (SHARE, FRAME, SLOWEST) } else { (CALM_SHARE, CALM_FRAME, CALM_SLOWEST) };
    Duration::try_from_secs_f32(share * drawing).unwrap_or(shortest).clamp(shortest, longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_is_only_looked_at_leaves_the_workers_their_time() {
        for (drawing, since, millis) in [
            (0.001, 0.0, 33),
            (0.03125, 1.9, 93),
            (0.5, 0.0, 150),
            (0.001, 2.0, 400),
            (0.03125, 5.0, 1875),
            (0.5, 5.0, 2000),
            (f32::NAN, 5.0, 400),
        ] {
            assert_eq!(wait(drawing, since).as_millis(), millis, "{drawing} s, {since} s");
        }
    }
}
