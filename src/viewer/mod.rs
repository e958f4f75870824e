//! The window: a picture getting better, three models to switch, one roughness slider.
//!
//! [`app`] holds the state and lays the [`panels`] out; each panel is one file. Panels change the
//! [`document`]; [`render`] turns that into orders for the workers and hands back their
//! snapshots; [`picture`] draws these. [`keys`] is the one table of shortcuts, [`style`] the one place
//! of colours and labels. Nothing here waits: scenes are read and snapshots written by the [`jobs`],
//! threads of their own, and a window in which nothing happens is not redrawn.

mod actions;
mod app;
mod comparing;
mod document;
mod ending;
mod frame_times;
mod jobs;
mod keys;
mod opening;
mod orders;
mod overlays;
mod panels;
mod picture;
mod render;
mod settings;
mod sheet;
mod smoke;
mod style;
mod title;
mod window;

#[cfg(test)]
mod tests;

use ending::SharedEnding;
use settings::Settings;
use std::path::PathBuf;
use std::sync::PoisonError;
use window::Window;

/// Options that the window starts with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Options {
    /// The scene to open, a file or a shipped one's name; the built-in one without.
    pub(crate) scene: Option<PathBuf>,
    /// Worker threads; 0 for one a core.
    pub(crate) threads: usize,
    /// Forgets what the window remembers of its last time.
    pub(crate) reset_settings: bool,
    /// Width and height of the window's inside in points.
    pub(crate) size: Option<[u32; 2]>,
    /// Light (`Some(true)`), dark, or as the system has it.
    pub(crate) light: Option<bool>,
    /// Measures how long frames take, and says so in the end.
    pub(crate) measure: bool,
    /// Seconds after which it closes: for smoke tests. Nothing is remembered then, from the last time
    /// or for the next.
    pub(crate) exit_after: Option<f64>,
    /// Writes a picture of the window there, as PNG, before it closes by `exit_after`.
    pub(crate) screenshot: Option<PathBuf>,
}

/// Opens the window and returns when it is closed, with how long its frames took if that was measured. The text of an
/// error says why none could be opened, or, in a smoke test, why there is no screenshot.
pub(crate) fn run(options: Options) -> Result<Option<String>, String> {
    let kept = Settings::path().filter(|_| options.exit_after.is_none());
    if let Some(path) = kept.as_deref().filter(|_| options.reset_settings) {
        Settings::reset(path)?;
    }
    let settings = kept.as_deref().map(Settings::read).unwrap_or_default();
    let given = options.size.map(|size| size.map(|s| s.clamp(1, 16_384) as f32));
    let [width, height] = given.or(settings.place.size).unwrap_or([1280.0, 800.0]);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("burnish")
        .with_app_id("burnish")
        .with_inner_size([width, height])
        .with_min_inner_size([720.0, 480.0])
        .with_drag_and_drop(true);
    if let Some(position) = settings.place.position.filter(|_| given.is_none()) {
        viewport = viewport.with_position(position);
    }
    let native = eframe::NativeOptions {
        viewport,
        // The picture's codes are to reach the screen as they are.
        dithering: false,
        ..Default::default()
    };
    let ending = SharedEnding::default();
    let at_end = ending.clone();
    let create = move |cc: &eframe::CreationContext<'_>| {
        bring_back(cc);
        Ok(Box::new(Window::new(&cc.egui_ctx, &options, settings, kept, at_end)) as Box<_>)
    };
    eframe::run_native("burnish", native, Box::new(create)).map_err(|e| reason(&e))?;
    let mut ending = ending.lock().unwrap_or_else(PoisonError::into_inner);
    match ending.failure.take() {
        Some(why) => Err(why),
        None => Ok(ending.work.take()),
    }
}

/// Moves a window to where it can be seen whose screen of last time is not there.
fn bring_back(cc: &eframe::CreationContext<'_>) {
    let Some((window, at)) = cc.winit_window().and_then(|w| Some((w, w.outer_position().ok()?)))
    else {
        return;
    };
    // Some of the line by which it is moved has to be on a screen.
    let (x, y) = (i64::from(at.x) + 100, i64::from(at.y) + 10);
    let screens: Vec<_> = window.available_monitors().map(|m| (m.position(), m.size())).collect();
    let holds =
        |low: i32, size: u32, at: i64| (0..i64::from(size)).contains(&(at - i64::from(low)));
    let seen = screens.iter().any(|(p, s)| holds(p.x, s.width, x) && holds(p.y, s.height, y));
    if !seen && !screens.is_empty() {
        cc.egui_ctx.send_viewport_cmd(egui::ViewportCommand::OuterPosition(egui::pos2(64.0, 64.0)));
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

#[cfg(test)]
mod reason_tests {
    #[test]
    fn what_happened_is_told_without_where_in_a_library() {
        for (text, expected) in [
            ("os error at /a/b/winit-0.30/src/x11/mod.rs:93: no server", "no server"),
            ("plain words", "plain words"),
        ] {
            assert_eq!(super::last_part(text), expected);
        }
    }
}
