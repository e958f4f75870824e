//! One line that says what happened, over the foot of the picture. It never takes it away.

use crate::viewer::style::labels;

use crate::viewer::style::theme;
use egui::{Align, Button, Frame, Label, Layout, Margin, RichText, Stroke, Ui};

/// Seconds that good news stays.
const STAY: f64 = 6.0;

pub(crate) struct Notice {
    pub(crate) text: String,
    pub(crate) is_error: bool,
    /// When it was first drawn, in egui's seconds.
    since: Option<f64>,
}

impl Notice {
    /// Goes by itself.
    pub(crate) fn news(text: impl Into<String>) -> Notice {
        Notice { text: text.into(), is_error: false, since: None }
    }

    /// Stays until dismissed or replaced.
    pub(crate) fn error(text: impl Into<String>) -> Notice {
        Notice { text: text.into(), is_error: true, since: None }
    }

    /// Draws the line; false once it is to go.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> bool {
        let now = ui.input(|i| i.time);
        let since = *self.since.get_or_insert(now);
        let left = since + STAY - now;
        if !self.is_error {
            if left <= 0.0 {
                return false;
            }
            // One repaint, when it is over.
            ui.ctx().request_repaint_after_secs(left as f32);
        }
        let visuals = ui.visuals();
        let colour = if self.is_error { visuals.error_fg_color } else { visuals.text_color() };
        let line = if self.is_error { colour } else { visuals.window_stroke.color };
        let frame = Frame::new()
            .fill(visuals.panel_fill)
            .stroke(Stroke::new(1.0, line))
            .corner_radius(4)
            .inner_margin(Margin::symmetric(12, 4));
        let mut stays = true;
        frame.show(ui, |ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let dismiss = Button::new(labels::DISMISS.name).frame(false);
                stays = !ui.add(dismiss).on_hover_text(labels::DISMISS.tip).clicked();
                ui.add_space(theme::GAP);
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let text = RichText::new(&self.text).color(colour);
                    ui.add(Label::new(text).wrap().selectable(true));
                });
            });
        });
        stays
    }
}
