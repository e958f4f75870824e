//! The section "Kept pictures": what is kept of models and roughnesses that were left, and what is seen
//! while one follows another.

use crate::viewer::document::Document;
use crate::viewer::document::live::Live;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::settings::Switching;
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::number_field::{NumberField, Written};
use crate::viewer::style::widgets::{self, Badge};
use burnish::limits::Bytes;
use burnish::progressive::KeptPictures;
use egui::Ui;

#[derive(Default)]
pub(crate) struct KeptPanel;

impl Panel for KeptPanel {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        let Live { kept, switching: before, .. } = document.live;
        let mut switching = before;
        let badge = Badge { text: kept.pictures.to_string(), warns: false };
        widgets::section(ui, "kept", "Kept pictures", Some(badge), false, |ui| {
            let KeptPictures { pictures, bytes } = kept;
            let plural = if pictures == 1 { "" } else { "s" };
            ui.weak(format!("{pictures} picture{plural} in {}", Bytes(bytes)));
            let keep = &mut switching.keep;
            let speed = (*keep as f64 * 0.01).max(1.0);
            number(ui, &labels::KEEP, keep, Switching::KEEP, speed, " MiB");
            number(ui, &labels::HOLD, &mut switching.hold, Switching::HOLD, 0.05, " passes");
            ui.checkbox(&mut switching.refine, labels::REFINE.name)
                .on_hover_text(labels::REFINE.tip);
        });
        if switching != before {
            actions.push(Action::Switching(switching));
        }
    }
}

fn number(ui: &mut Ui, control: &Control, value: &mut u64, most: u64, speed: f64, unit: &str) {
    widgets::field(ui, control, |ui, label| {
        let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        let field = NumberField {
            name: control.name,
            range: [0.0, most as f64],
            speed,
            written: Written::Whole,
            unit,
            prefix: "",
            size,
        };
        field.whole(ui, value).labelled_by(label).on_hover_text(control.tip);
    });
}
