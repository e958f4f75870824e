//! The list of keys and mouse moves, made from the one table of them.

use super::keys::{self, MOUSE, PICTURE_KEYS, TABLE};
use super::theme;
use egui::{Grid, Id, Modal, RichText, Ui};

#[derive(Default)]
pub(super) struct Help {
    pub(super) open: bool,
}

impl Help {
    pub(super) fn ui(&mut self, ui: &mut Ui) {
        if !self.open {
            return;
        }
        let modal = Modal::new(Id::unique("help")).show(ui.ctx(), |ui| {
            ui.set_width(680.0);
            ui.horizontal(|ui| {
                ui.heading("Keys and mouse");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    self.open = !ui.button("Close").clicked();
                });
            });
            ui.add_space(theme::GAP);
            ui.columns_const(|[left, right]| {
                keys_table(left);
                pairs(right, "Over the picture", MOUSE);
                right.add_space(theme::GROUP);
                pairs(right, "With the picture focused (Tab)", PICTURE_KEYS);
            });
        });
        self.open &= !modal.should_close();
    }
}

fn keys_table(ui: &mut Ui) {
    Grid::new("keys").num_columns(2).spacing([theme::GROUP, 4.0]).show(ui, |ui| {
        for binding in TABLE {
            ui.label(RichText::new(keys::keys_text(ui.ctx(), binding)).monospace());
            ui.label(binding.name).on_hover_text(binding.tip);
            ui.end_row();
        }
    });
}

fn pairs(ui: &mut Ui, title: &str, pairs: &[(&str, &str)]) {
    ui.weak(title);
    Grid::new(title).num_columns(2).spacing([theme::GROUP, 4.0]).show(ui, |ui| {
        for (what, does) in pairs {
            ui.label(RichText::new(*what).monospace());
            ui.label(*does);
            ui.end_row();
        }
    });
}
