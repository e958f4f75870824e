//! A window that closes by itself after a while, with a picture of itself: for smoke tests.

use crate::viewer::window::Told;
use burnish::picture::{Picture, Tone, write};
use egui::{Color32, ColorImage, Context, Rgba, ViewportCommand};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// Seconds that the screenshot may take before the window is closed without one.
const PATIENCE: Duration = Duration::from_secs(10);

pub(super) struct Smoke {
    end: Instant,
    screenshot: Option<PathBuf>,
    asked: bool,
    told: Told,
}

impl Smoke {
    pub(super) fn new(seconds: f64, screenshot: Option<PathBuf>, told: Told) -> Smoke {
        let wait = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        let now = Instant::now();
        Smoke { end: now.checked_add(wait).unwrap_or(now), screenshot, asked: false, told }
    }

    /// Called with each frame: waits, takes the picture, closes.
    pub(super) fn step(&mut self, ctx: &Context) {
        let now = Instant::now();
        if now < self.end {
            ctx.request_repaint_after(self.end - now);
            return;
        }
        if self.asked && now > self.end + PATIENCE {
            set(&self.told, "the window gave no picture of itself".to_owned());
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        if std::mem::replace(&mut self.asked, true) {
            ctx.request_repaint_after(Duration::from_millis(100));
            return;
        }
        let Some(path) = self.screenshot.clone() else {
            ctx.send_viewport_cmd(ViewportCommand::Close);
            return;
        };
        let (told, close) = (self.told.clone(), ctx.clone());
        let callback = move |image: Arc<ColorImage>| {
            if let Err(why) = save(&path, &image) {
                set(&told, why);
            }
            close.send_viewport_cmd(ViewportCommand::Close);
            close.request_repaint();
        };
        let callback = egui::ScreenshotCallback::new(callback);
        ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
        ctx.request_repaint();
    }
}

fn set(told: &Told, why: String) {
    told.lock().unwrap_or_else(PoisonError::into_inner).failure = Some(why);
}

/// Codes become light and then the same codes again, so that the file holds what was on screen.
fn save(path: &Path, image: &ColorImage) -> Result<(), String> {
    let side = |s: usize| u32::try_from(s).map_err(|_| "too large a window".to_owned());
    let picture = Picture {
        width: side(image.size[0])?,
        height: side(image.size[1])?,
        pixels: image.pixels.iter().map(|&code| light(code)).collect(),
    };
    write(path, &picture, Tone::default()).map_err(|e| e.to_string())
}

fn light(code: Color32) -> [f32; 3] {
    let [r, g, b, _] = Rgba::from(code).to_array();
    [r, g, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back() {
        for code in 0..=255 {
            assert_eq!(Tone::default().exact(light(Color32::from_gray(code))), [code; 3]);
        }
    }
}
