//! The section "Scene": the reader's warnings with their lines, and its notes.

use crate::viewer::document::Document;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::panels::energy::EnergyOfScene;
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::scene::Warning;
use egui::{Label, RichText, Ui};

#[derive(Default)]
pub(crate) struct ReportPanel {
    energy: EnergyOfScene,
}

impl Panel for ReportPanel {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        let warnings = &document.report.warnings;
        let badge = (!warnings.is_empty()).then(|| {
            let plural = if warnings.len() == 1 { "" } else { "s" };
            widgets::Badge { text: format!("{} warning{plural}", warnings.len()), warns: true }
        });
        // The number keeps each scene's section apart: a new scene's warnings are seen once.
        let id = ("scene", document.number);
        widgets::section(ui, id, "Scene", badge, !warnings.is_empty(), |ui| {
            ui.spacing_mut().item_spacing.y = 4.0;
            // First: what the model does to energy is told below it a moment later.
            ui.horizontal(|ui| {
                let reload = keys::binding(Action::Reload).name;
                let tip = keys::tooltip(ui.ctx(), Action::Reload);
                if ui.button(reload).on_hover_text(tip).clicked() {
                    actions.push(Action::Reload);
                }
                let mut watch = document.live.watch;
                let checkbox = ui.checkbox(&mut watch, labels::WATCH.name);
                if checkbox.on_hover_text(labels::WATCH.tip).changed() {
                    actions.push(Action::Watch(watch));
                }
            });
            for warning in warnings {
                one(ui, warning);
            }
            for note in &document.report.notes {
                ui.add(Label::new(RichText::new(note).weak()).wrap());
            }
            self.energy.lines(ui, document);
            let counts = document.params.scene.counts();
            let shapes = [
                (counts.triangles, "triangle"),
                (counts.spheres, "sphere"),
                (counts.cylinders, "cylinder"),
            ];
            let shapes: Vec<String> = shapes
                .iter()
                .filter(|(n, _)| *n > 0)
                .map(|(n, what)| format!("{n} {what}{}", if *n == 1 { "" } else { "s" }))
                .collect();
            ui.weak(shapes.join(", "));
        });
    }
}

fn one(ui: &mut Ui, warning: &Warning) {
    let place = &warning.place;
    let file = place.file.file_name().map_or_else(
        || place.file.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    );
    let line = place.line.map(|l| format!(":{l}")).unwrap_or_default();
    let place = RichText::new(format!("{file}{line}")).monospace();
    let place = place.color(theme::accent_of(ui.visuals()));
    ui.add(Label::new(place).selectable(true)).on_hover_text(warning.place.to_string());
    ui.add(Label::new(warning.text.as_str()).wrap().selectable(true));
    ui.add_space(4.0);
}
