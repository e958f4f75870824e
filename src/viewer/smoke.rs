//! A window that closes by itself after a while, with a picture of itself: for smoke tests.

use crate::viewer::ending::SharedEnding;
use crate::viewer::jobs::save::as_picture;
use burnish::picture::{Tone, write};
use egui::{ColorImage, Context, ViewportCommand};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// Seconds that the screenshot may take before the window is closed without one.
const PATIENCE: Duration = Duration::from_secs(10);

pub(super) struct Smoke {
    end: Instant,
    screenshot: Option<PathBuf>,
    requested: bool,
    ending: SharedEnding,
}

impl Smoke {
    pub(super) fn new(seconds: f64, screenshot: Option<PathBuf>, ending: SharedEnding) -> Smoke {
        let wait = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        let now = Instant::now();
        Smoke { end: now.checked_add(wait).unwrap_or(now), screenshot, requested: false, ending }
    }

    /// Called with each frame: waits, takes the picture, closes.
    pub(super) fn step(&mut self, ctx: &Context) {
        let now = Instant::now();
        if now < self.end {
            ctx.request_repaint_after(self.end - now);
            return;
        }
        if self.requested && now > self.end + PATIENCE {
            set(&self.ending, "the window gave no picture of itself".to_owned());
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        if std::mem::replace(&mut self.requested, true) {
            ctx.request_repaint_after(Duration::from_millis(100));
            return;
        }
        let Some(path) = self.screenshot.clone() else {
            ctx.send_viewport_cmd(ViewportCommand::Close);
            return;
        };
        let (ending, close) = (self.ending.clone(), ctx.clone());
        let callback = move |image: Arc<ColorImage>| {
            if let Err(why) = save(&path, &image) {
                set(&ending, why);
            }
            close.send_viewport_cmd(ViewportCommand::Close);
            close.request_repaint();
        };
        let callback = egui::ScreenshotCallback::new(callback);
        ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
        ctx.request_repaint();
    }
}

fn set(ending: &SharedEnding, why: String) {
    ending.lock().unwrap_or_else(PoisonError::into_inner).failure = Some(why);
}

/// As it was on screen.
fn save(path: &Path, image: &ColorImage) -> Result<(), String> {
    write(path, &as_picture(image)?, Tone::default()).map_err(|e| e.to_string())
}
