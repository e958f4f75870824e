//! The window: a picture getting better, three models to switch, one roughness slider.
//!
//! [`app`] holds the state and lays the panels out; each panel is one file. Panels change the
//! [`document`]; [`render`] turns that into orders for the workers and hands back their
//! snapshots; [`canvas`] draws these. [`keys`] is the one table of shortcuts. Nothing here waits:
//! scenes are read and snapshots written by threads of their own ([`load`], [`save`]), and a
//! window in which nothing happens is not redrawn.

mod app;
mod background;
mod canvas;
mod command;
mod controls;
mod document;
mod energy;
mod figures;
mod goal;
mod help;
mod history;
mod keys;
mod load;
mod materials;
mod method;
mod notice;
mod open;
mod orbit;
mod proofs;
mod render;
mod report;
mod save;
mod smoke;
mod status;
mod surface;
mod texture;
mod theme;
mod view;
mod widgets;

#[cfg(test)]
mod tests;

use app::App;
use load::Source;
use smoke::Smoke;
use std::path::PathBuf;
use std::sync::PoisonError;

/// How the window starts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Options {
    /// The scene to open; the built-in one without.
    pub(crate) scene: Option<PathBuf>,
    /// Worker threads; 0 for one a core.
    pub(crate) threads: usize,
    /// Width and height of the window's inside in points.
    pub(crate) size: Option<[u32; 2]>,
    /// Light (`Some(true)`), dark, or as the system has it.
    pub(crate) light: Option<bool>,
    /// Closes after so many seconds: for smoke tests.
    pub(crate) exit_after: Option<f64>,
    /// Writes a picture of the window there, as PNG, before it closes by `exit_after`.
    pub(crate) screenshot: Option<PathBuf>,
}

/// Opens the window and returns when it is closed. The text of an error says why none could be
/// opened, or, in a smoke test, why there is no screenshot.
pub(crate) fn run(options: Options) -> Result<(), String> {
    let [width, height] = options.size.unwrap_or([1280, 800]).map(|s| s.clamp(1, 16_384) as f32);
    let viewport = egui::ViewportBuilder::default()
        .with_title("burnish")
        .with_app_id("burnish")
        .with_inner_size([width, height])
        .with_min_inner_size([720.0, 480.0])
        .with_drag_and_drop(true);
    let native = eframe::NativeOptions {
        viewport,
        // The picture's codes are to reach the screen as they are.
        dithering: false,
        ..Default::default()
    };
    let failure = smoke::Failure::default();
    let told = failure.clone();
    let create = move |cc: &eframe::CreationContext<'_>| {
        let smoke =
            options.exit_after.map(|seconds| Smoke::new(seconds, options.screenshot.clone(), told));
        Ok(Box::new(Shell::new(&cc.egui_ctx, &options, smoke)) as Box<dyn eframe::App>)
    };
    eframe::run_native("burnish", native, Box::new(create)).map_err(|e| reason(&e))?;
    match failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(why) => Err(why),
        None => Ok(()),
    }
}

/// Why there is no window, without the places in the source of the libraries that said so.
fn reason(error: &eframe::Error) -> String {
    let no_display = ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
        .iter()
        .all(|name| std::env::var_os(name).is_none_or(|value| value.is_empty()));
    if cfg!(all(unix, not(target_os = "macos"))) && no_display {
        return "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)".to_owned();
    }
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => {
            format!("the display could not be used: {}", last_part(&error.to_string()))
        }
        eframe::Error::Glutin(_)
        | eframe::Error::NoGlutinConfigs(..)
        | eframe::Error::OpenGL(_) => {
            format!("OpenGL could not be used: {}", last_part(&error.to_string()))
        }
        other => last_part(&other.to_string()),
    }
}

/// winit writes "os error at FILE:LINE: what happened".
fn last_part(text: &str) -> String {
    let end = text.rfind(".rs:").map_or(0, |i| i + 4);
    text[end..].trim_start_matches(|c: char| c.is_ascii_digit() || ":. ".contains(c)).to_owned()
}

/// Between the window and the app.
struct Shell {
    app: App,
    smoke: Option<Smoke>,
}

impl Shell {
    fn new(ctx: &egui::Context, options: &Options, smoke: Option<Smoke>) -> Shell {
        if let Some(light) = options.light {
            ctx.set_theme(if light { egui::Theme::Light } else { egui::Theme::Dark });
        }
        let source = options.scene.clone().map_or_else(Source::default, Source::File);
        // An empty path is the working directory.
        Shell { app: App::new(ctx, source, options.threads, PathBuf::new()), smoke }
    }
}

impl eframe::App for Shell {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        if let Some(seconds) = frame.info().cpu_usage {
            self.app.drawing_takes(seconds);
        }
        self.app.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.app.ui(ui);
        if let Some(smoke) = &mut self.smoke {
            smoke.step(ui.ctx());
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        theme::surround(visuals).to_normalized_gamma_f32()
    }
}

#[cfg(test)]
mod reason_tests {
    #[test]
    fn what_happened_is_told_without_where_in_a_library() {
        for (told, expected) in [
            ("os error at /a/b/winit-0.30/src/x11/mod.rs:93: no server", "no server"),
            ("plain words", "plain words"),
        ] {
            assert_eq!(super::last_part(told), expected);
        }
    }
}
