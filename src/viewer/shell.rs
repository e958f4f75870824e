//! Between the system's window and the app: what is remembered, and how long its work takes.

use super::app::{App, Setup};
use super::browse;
use super::load::Source;
use super::settings::{Place, Settings};
use super::smoke::Smoke;
use super::{Options, theme};
use egui::{Context, ThemePreference};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Settings are written once they have been the same for so long, and when the window is closed.
const SETTLED: Duration = Duration::from_secs(2);

/// What the window tells when it is closed.
#[derive(Default)]
pub(super) struct Ending {
    /// Why there is no screenshot.
    pub(super) failure: Option<String>,
    /// How its work went, in words.
    pub(super) figures: String,
}
pub(super) type Told = Arc<Mutex<Ending>>;

pub(super) struct Shell {
    app: App,
    smoke: Option<Smoke>,
    memory: Memory,
    load: Load,
    told: Told,
}

impl Shell {
    /// The app in its window. Settings are written to `kept`, if they are.
    pub(super) fn new(
        ctx: &Context,
        options: &Options,
        settings: Settings,
        kept: Option<PathBuf>,
        told: Told,
    ) -> Shell {
        let given = options.light.map(|light| match light {
            true => ThemePreference::Light,
            false => ThemePreference::Dark,
        });
        ctx.set_theme(given.unwrap_or(settings.theme));
        let smoke = options
            .exit_after
            .map(|seconds| Smoke::new(seconds, options.screenshot.clone(), told.clone()));
        let memory = Memory::new(kept, settings.clone(), given);
        let setup = Setup {
            source: options.scene.clone().map_or_else(Source::default, Source::named),
            threads: options.threads,
            folder: PathBuf::new(),
            settings,
            dialog: browse::native,
        };
        Shell { app: App::new(ctx, setup), smoke, memory, load: Load::default(), told }
    }
}

impl eframe::App for Shell {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        if let Some(seconds) = frame.info().cpu_usage {
            self.app.drawing_takes(seconds);
            self.load.frame(seconds);
        }
        let start = Moment::now();
        self.app.logic(ctx);
        self.load.own(&start);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let start = Moment::now();
        self.app.ui(ui);
        self.memory.note(ui.ctx(), self.app.settings(ui.ctx()));
        self.load.own(&start);
        self.load.end_frame(&self.app);
        if let Some(smoke) = &mut self.smoke {
            smoke.step(ui.ctx());
        }
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.memory.write();
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.figures = self.load.words();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::surround(visuals).to_normalized_gamma_f32()
    }
}

/// Keeps the settings in their file.
struct Memory {
    path: Option<PathBuf>,
    /// As they are in the file.
    written: Settings,
    now: Settings,
    /// When they were last changed.
    changed: Option<Instant>,
    /// The colours that the command line asked for, for this time alone.
    given: Option<ThemePreference>,
}

impl Memory {
    fn new(path: Option<PathBuf>, read: Settings, given: Option<ThemePreference>) -> Memory {
        Memory { path, written: read.clone(), now: read, changed: None, given }
    }

    /// Takes note of how they are.
    fn note(&mut self, ctx: &Context, mut settings: Settings) {
        if self.path.is_none() {
            return;
        }
        if self.given == Some(settings.theme) {
            settings.theme = self.written.theme;
        } else {
            self.given = None;
        }
        settings.place = place(ctx).unwrap_or(self.now.place);
        if settings != self.now {
            self.now = settings;
            self.changed = Some(Instant::now());
            ctx.request_repaint_after(SETTLED);
        }
        if self.changed.is_some_and(|at| at.elapsed() >= SETTLED) {
            self.changed = None;
            let (Some(path), now) = (self.path.clone(), self.now.clone()) else { return };
            self.written = now.clone();
            // What cannot be remembered is no reason to disturb anybody.
            let write = move || drop(now.write(&path));
            let _ = std::thread::Builder::new().name("settings".to_owned()).spawn(write);
        }
    }

    fn write(&mut self) {
        if let Some(path) = self.path.as_deref().filter(|_| self.now != self.written) {
            let _ = self.now.write(path);
        }
    }
}

/// Where the window is; `None` while it fills the screen, which is no place to come back to.
fn place(ctx: &Context) -> Option<Place> {
    ctx.input(|i| {
        let view = i.viewport();
        let special = [view.fullscreen, view.maximized, view.minimized];
        if special.contains(&Some(true)) {
            return None;
        }
        let (inner, outer) = (view.inner_rect, view.outer_rect);
        Some(Place { size: inner.map(|r| r.size().into()), position: outer.map(|r| r.min.into()) })
    })
}

/// A moment on the clock and in the life of this thread.
struct Moment {
    clock: Instant,
    /// Time that a processor has spent on this thread, where the system tells.
    spent: Option<Duration>,
}

impl Moment {
    fn now() -> Moment {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanos = told.and_then(|text| text.split_whitespace().next()?.parse().ok());
        Moment { clock: Instant::now(), spent: nanos.map(Duration::from_nanos) }
    }
}

/// How much the window's thread has to do.
#[derive(Default)]
struct Load {
    frames: u64,
    /// Of the app's own work in the present frame: by the clock, and what of it a processor was at
    /// work. The rest is waiting for one that is busy with the workers.
    now: [Duration; 2],
    slowest: [Duration; 2],
    total: Duration,
    /// With what egui and the graphics driver do.
    whole: f64,
    /// Paths and seconds of tracing when the window had been left alone for a while, and frames.
    calm: Option<(u64, f64, u64)>,
    last: (u64, f64),
    began: Option<Instant>,
}

impl Load {
    /// From the start until it is taken to be left alone.
    const CALM: Duration = Duration::from_secs(4);

    fn own(&mut self, since: &Moment) {
        let now = Moment::now();
        let clock = now.clock - since.clock;
        let spent = now.spent.zip(since.spent).map_or(clock, |(now, then)| now - then);
        self.now = [self.now[0] + clock, self.now[1] + spent];
    }

    fn frame(&mut self, seconds: f32) {
        self.whole += f64::from(seconds);
    }

    fn end_frame(&mut self, app: &App) {
        let began = *self.began.get_or_insert_with(Instant::now);
        self.frames += 1;
        let work = std::mem::take(&mut self.now);
        self.slowest = [0, 1].map(|i: usize| self.slowest[i].max(work[i]));
        self.total += work[0];
        if let Some(snapshot) = app.render.as_ref().and_then(|r| r.newest.as_ref()) {
            self.last = (snapshot.counts.paths, snapshot.seconds);
            if self.calm.is_none() && began.elapsed() >= Load::CALM {
                self.calm = Some((self.last.0, self.last.1, self.frames));
            }
        }
    }

    fn words(&self) -> String {
        let millis = |seconds: f64| 1e3 * seconds / self.frames.max(1) as f64;
        let mut words = format!(
            "{} frames; own work of one: at most {:.2} ms, of which a processor's {:.2} ms at most, \
             mean {:.2} ms; all of one: mean {:.1} ms",
            self.frames,
            1e3 * self.slowest[0].as_secs_f64(),
            1e3 * self.slowest[1].as_secs_f64(),
            millis(self.total.as_secs_f64()),
            millis(self.whole),
        );
        if let Some((paths, seconds, frames)) = self.calm {
            let time = self.last.1 - seconds;
            if time > 0.0 {
                words += &format!(
                    "; after {} s: {:.0} paths/s, {:.1} frames/s of tracing",
                    Load::CALM.as_secs(),
                    self.last.0.saturating_sub(paths) as f64 / time,
                    (self.frames - frames) as f64 / time,
                );
            }
        }
        words
    }
}
