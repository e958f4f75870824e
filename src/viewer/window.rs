//! The system's window around the app: remembers settings, measures frames.

use crate::viewer::Options;
use crate::viewer::app::{App, Setup};
use crate::viewer::ending::SharedEnding;
use crate::viewer::frame_times::{FrameTimes, Moment};
use crate::viewer::jobs::browse;
use crate::viewer::jobs::load::Source;
use crate::viewer::settings::{Place, Settings};
use crate::viewer::smoke::Smoke;
use crate::viewer::style::theme;
use egui::{Context, ThemePreference};
use std::path::PathBuf;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

/// Settings are written once they have been the same for so long, and when the window is closed.
const SETTLED: Duration = Duration::from_secs(2);

pub(super) struct Window {
    app: App,
    smoke: Option<Smoke>,
    memory: Memory,
    /// Measured where it is to be told.
    times: Option<FrameTimes>,
    ending: SharedEnding,
}

impl Window {
    /// The app in its window. Settings are written to `kept`, if they are.
    pub(super) fn new(
        ctx: &Context,
        options: &Options,
        settings: Settings,
        kept: Option<PathBuf>,
        ending: SharedEnding,
    ) -> Window {
        let given = options.light.map(|light| match light {
            true => ThemePreference::Light,
            false => ThemePreference::Dark,
        });
        ctx.set_theme(given.unwrap_or(settings.theme));
        let smoke = options
            .exit_after
            .map(|seconds| Smoke::new(seconds, options.screenshot.clone(), ending.clone()));
        let memory = Memory::new(kept, settings.clone(), given);
        let setup = Setup {
            source: options.scene.clone().map_or_else(Source::default, Source::named),
            threads: options.threads,
            folder: PathBuf::new(),
            settings,
            dialog: browse::native,
        };
        let times = options.measure.then(FrameTimes::default);
        Window { app: App::new(ctx, setup), smoke, memory, times, ending }
    }
}

impl Window {
    /// Does some of the app's own work.
    fn work(&mut self, work: impl FnOnce(&mut Window)) {
        let start = self.times.is_some().then(Moment::now);
        work(self);
        if let (Some(times), Some(start)) = (&mut self.times, start) {
            times.own(&start);
        }
    }
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        if let Some(seconds) = frame.info().cpu_usage {
            self.app.note_drawing(seconds);
            if let Some(times) = &mut self.times {
                times.frame(seconds);
            }
        }
        self.work(|window| window.app.logic(ctx));
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.work(|window| {
            window.app.ui(ui);
            window.memory.note(ui.ctx(), window.app.settings(ui.ctx()));
        });
        if let Some(times) = &mut self.times {
            times.end_frame(&self.app);
        }
        if let Some(smoke) = &mut self.smoke {
            smoke.step(ui.ctx());
        }
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        self.memory.write();
        let mut ending = self.ending.lock().unwrap_or_else(PoisonError::into_inner);
        ending.work = self.times.as_ref().map(FrameTimes::words);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::surround(visuals).to_normalized_gamma_f32()
    }
}

/// Keeps the settings in their file.
struct Memory {
    path: Option<PathBuf>,
    /// The settings in the file.
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

/// Place of the window; `None` while it fills the screen, which is no place to come back to.
fn place(ctx: &Context) -> Option<Place> {
    ctx.input(|i| {
        let view = i.viewport();
        let special = [view.fullscreen, view.maximized, view.minimized];
        if special.contains(&Some(true)) {
            return None;
        }
        // Not every system tells where a window is.
        let position = view.outer_rect.map(|r| r.min.into());
        Some(Place { size: Some(i.content_rect().size().into()), position })
    })
}
