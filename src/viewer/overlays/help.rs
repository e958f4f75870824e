//! The list of keys and mouse moves, made from the one table of them.

use crate::viewer::keys::{self, Binding, MOUSE, PICTURE_KEYS, TABLE};
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use egui::{Frame, Grid, Id, Margin, Modal, RichText, Ui};

/// Least width of the column of keys and of that of words, in points.
const COLUMNS: [f32; 2] = [152.0, 208.0];

#[derive(Default)]
pub(crate) struct Help {
    pub(crate) open: bool,
}

impl Help {
    pub(crate) fn ui(&mut self, ui: &mut Ui) {
        if !self.open {
            return;
        }
        let frame = Frame::popup(&ui.ctx().global_style()).inner_margin(Margin::same(24));
        let modal = Modal::new(Id::unique("help")).frame(frame).show(ui.ctx(), |ui| {
            ui.horizontal(|ui| {
                ui.heading("Keys and mouse");
                ui.add_space(theme::GROUP);
                let close = ui.button(labels::CLOSE.name).on_hover_text(labels::CLOSE.tip);
                self.open = !close.clicked();
            });
            ui.add_space(theme::GROUP);
            // Lines of text, not of buttons.
            ui.spacing_mut().interact_size.y = 16.0;
            let (first, second) = TABLE.split_at(TABLE.len().div_ceil(2));
            side_by_side(ui, |ui| bindings(ui, first), |ui| bindings(ui, second));
            ui.add_space(theme::GROUP);
            side_by_side(
                ui,
                |ui| pairs(ui, "Over the picture", MOUSE),
                |ui| pairs(ui, "With the picture focused (Tab)", PICTURE_KEYS),
            );
        });
        self.open &= !modal.should_close();
    }
}

fn side_by_side(ui: &mut Ui, left: impl FnOnce(&mut Ui), right: impl FnOnce(&mut Ui)) {
    ui.horizontal_top(|ui| {
        ui.vertical(left);
        ui.add_space(theme::GROUP);
        ui.vertical(right);
    });
}

fn bindings(ui: &mut Ui, bindings: &[Binding]) {
    let id = bindings.first().map_or("", |b| b.name);
    grid(id).show(ui, |ui| {
        for binding in bindings {
            line(ui, &keys::keys_text(ui.ctx(), binding), binding.does, binding.tip);
        }
    });
}

fn pairs(ui: &mut Ui, title: &str, pairs: &[(&str, &str)]) {
    ui.weak(title);
    grid(title).show(ui, |ui| {
        for (what, does) in pairs {
            line(ui, what, does, "");
        }
    });
}

fn grid(id: &str) -> Grid {
    Grid::new(id).num_columns(2).spacing([theme::GROUP, 4.0]).min_row_height(16.0)
}

fn line(ui: &mut Ui, what: &str, does: &str, tip: &str) {
    ui.scope(|ui| {
        ui.set_min_width(COLUMNS[0]);
        ui.label(RichText::new(what).monospace().color(theme::accent_of(ui.visuals())));
    });
    ui.scope(|ui| {
        ui.set_min_width(COLUMNS[1]);
        let label = ui.label(does);
        if !tip.is_empty() {
            label.on_hover_text(tip);
        }
    });
    ui.end_row();
}
