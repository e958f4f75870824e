//! Export of plots: as a table, an SVG file, a picture.

use crate::viewer::jobs::save::Plot;
use crate::viewer::keys::Action;
use crate::viewer::style::labels::Control;
use crate::viewer::style::widgets;
use egui::{ColorImage, Context, Rect, Ui, ViewportCommand};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

/// Curves that leave the window.
pub(crate) struct Export {
    /// Beginning of a file's name, such as "lobes_f-cos_alpha-0.1414".
    pub(crate) stem: String,
    pub(crate) content: Content,
}

pub(crate) enum Content {
    /// A table for the clipboard.
    Copied(String),
    File(Plot),
}

/// The way of a panel's plot out of the window.
#[derive(Default)]
pub(crate) struct Exports {
    /// A picture of the plot, once the window has made it.
    shot: Option<Receiver<Shot>>,
    /// The export to be written or copied.
    ready: Option<Export>,
}

impl Exports {
    /// Draws the buttons: what they are called, and what a press of each of the first two gives.
    /// The third takes a picture of the plot's place.
    pub(crate) fn buttons(
        &mut self,
        ui: &mut Ui,
        controls: [&Control; 3],
        stem: String,
        plot: Rect,
        content: impl FnOnce(usize) -> Content,
        actions: &mut Vec<Action>,
    ) {
        let entries = controls.map(|c| (c.name, c.tip.to_owned(), true));
        match widgets::button_row(ui, &entries) {
            Some(2) => self.shot = Some(shoot(ui.ctx(), plot, stem)),
            Some(which) => {
                self.ready = Some(Export { stem, content: content(which) });
                actions.push(Action::Export);
            }
            None => {}
        }
    }

    /// Takes the picture of the plot, if there is one by now.
    pub(crate) fn receive(&mut self, actions: &mut Vec<Action>) {
        let Some(shot) = self.shot.as_ref().and_then(|s| s.try_recv().ok()) else { return };
        self.shot = None;
        self.ready =
            Some(Export { stem: shot.stem, content: Content::File(Plot::Png(shot.image)) });
        actions.push(Action::Export);
    }

    /// Takes the export that is ready.
    pub(crate) fn take(&mut self) -> Option<Export> {
        self.ready.take()
    }
}

/// The plot as the window shows it.
struct Shot {
    stem: String,
    image: ColorImage,
}

/// Asks the window for a picture of a part of itself; repaints when it is there.
fn shoot(ctx: &Context, place: Rect, stem: String) -> Receiver<Shot> {
    let (send, shot) = channel();
    let (scale, repaint) = (ctx.pixels_per_point(), ctx.clone());
    let callback = egui::ScreenshotCallback::new(move |window: Arc<ColorImage>| {
        let image = part(&window, place, scale);
        // Nobody listens when another picture has been asked for meanwhile.
        let _ = send.send(Shot { stem, image });
        repaint.request_repaint();
    });
    ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
    ctx.request_repaint();
    shot
}

/// Part of a picture within a rectangle in points, clipped to the picture.
fn part(window: &ColorImage, place: Rect, scale: f32) -> ColorImage {
    let [width, height] = window.size;
    let within = |from: f32, to: f32, size: usize| {
        let [from, to] = [from, to].map(|x| (x * scale).round().max(0.0) as usize);
        from.min(size)..to.min(size)
    };
    let columns = within(place.left(), place.right(), width);
    let rows = within(place.top(), place.bottom(), height);
    let size = [columns.len(), rows.len()];
    let rows = rows.map(|y| &window.pixels[y * width..][columns.clone()]);
    ColorImage::new(size, rows.flatten().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, pos2};

    #[test]
    fn a_part_is_cut_out_and_never_beyond_the_window() {
        let pixels = (0..6 * 4).map(|i| Color32::from_gray(i as u8)).collect();
        let window = ColorImage::new([6, 4], pixels);
        let place = Rect::from_min_max(pos2(0.5, 1.0), pos2(1.5, 9.0));
        let cut = part(&window, place, 2.0);
        assert_eq!(cut.size, [2, 2]);
        let codes: Vec<u8> = cut.pixels.iter().map(|c| c.r()).collect();
        assert_eq!(codes, [13, 14, 19, 20]);
    }
}
