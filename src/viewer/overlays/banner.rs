//! The line over the picture's head while a mistake is made on purpose.

use crate::viewer::style::theme;
use burnish::progressive::Params;
use egui::{Align2, Area, Frame, Id, Margin, Order, Rect, RichText, Ui, vec2};

/// Draws the line into the picture's space, if there is a mistake.
pub(crate) fn banner(ui: &Ui, params: &Params, space: Rect) {
    let Some(erratum) = params.erratum else { return };
    let has_effect = erratum.concerns(params.model);
    let words = if has_effect {
        format!("WRONG ON PURPOSE: {}", erratum.title())
    } else {
        format!("{}: no effect on {}", erratum.title(), params.model.title())
    };
    let fill = if has_effect { theme::ALARM } else { ui.visuals().panel_fill };
    let colour = if has_effect { egui::Color32::WHITE } else { ui.visuals().text_color() };
    Area::new(Id::unique("erratum"))
        .order(Order::Middle)
        .interactable(false)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(space.center_top() + vec2(0.0, theme::GROUP))
        .show(ui.ctx(), |ui| {
            let frame = Frame::new().fill(fill).corner_radius(theme::RADIUS);
            frame.inner_margin(Margin::symmetric(12, 6)).show(ui, |ui| {
                ui.label(RichText::new(words).strong().color(colour));
            });
        });
}
