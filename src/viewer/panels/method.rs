//! The sections "Sampling" and "Deliberate bugs".

use crate::viewer::document::Document;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Badge, Weight};
use burnish::brdf::{Erratum, Model, Normals};
use burnish::progressive::{Params, Strategy};
use egui::{ComboBox, Ui};

#[derive(Default)]
pub(crate) struct MethodPanel;

impl Panel for MethodPanel {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, _: &mut Vec<Action>) {
        let params = &mut document.params;
        widgets::section(ui, "method", "Sampling", None, false, |ui| {
            strategy(ui, params);
            normals(ui, params);
        });
        let badge = params.erratum.map(|e| Badge { text: e.name().to_owned(), warns: true });
        widgets::section(ui, "bugs", "Deliberate bugs", badge, false, |ui| erratum(ui, params));
    }
}

fn erratum(ui: &mut Ui, params: &mut Params) {
    let tip = labels::ERRATUM.tip;
    let chosen = params.erratum;
    widgets::field(ui, &labels::ERRATUM, |ui, label| {
        let text = chosen.map_or("None", Erratum::title);
        let menu = ComboBox::from_id_salt("erratum")
            .width(ui.available_width())
            .height(450.0)
            .selected_text(text)
            .truncate()
            .show_ui(ui, |ui| {
                theme::quiet_choice(ui);
                let none = ui.selectable_value(&mut params.erratum, None, "None");
                widgets::beside(&none, "Everything right.");
                for e in Erratum::ALL {
                    let entry = ui.selectable_value(&mut params.erratum, Some(e), e.title());
                    widgets::beside(&entry, &describe(e, params.model));
                }
            });
        menu.response.labelled_by(label).on_hover_text(tip);
    });
    if let Some(e) = params.erratum {
        ui.weak(describe(e, params.model));
    }
}

fn describe(e: Erratum, model: Model) -> String {
    let about = match e.model() {
        Some(other) if other != model => {
            format!("\n\nOnly about {}: no effect on {}.", other.title(), model.title())
        }
        _ => String::new(),
    };
    format!("Wrong: {}.\nRight: {}.\n{}{about}", e.wrong(), e.right(), e.shows())
}

fn strategy(ui: &mut Ui, params: &mut Params) {
    ui.label(labels::LIGHT.name).on_hover_text(labels::LIGHT.tip);
    ui.scope(|ui| {
        let chosen = Strategy::ALL.iter().position(|&s| s == params.strategy).unwrap_or(0);
        let entries = Strategy::ALL.map(|s| (s.title(), found(s).to_owned(), true));
        if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
            params.strategy = Strategy::ALL[i];
        }
    });
}

/// Describes how a strategy finds light.
pub(crate) fn found(strategy: Strategy) -> &'static str {
    match strategy {
        Strategy::Mis => {
            "Multiple importance sampling: by sampling lights and by sampling the BRDF, weighed against \
             each other (Veach 1997)."
        }
        Strategy::LightOnly => "Only by sampling lights: noisy where surfaces are smooth.",
        Strategy::BsdfOnly => {
            "Only by directions sampled from the BRDF that meet a light: noisy where lights are small."
        }
    }
}

fn normals(ui: &mut Ui, params: &mut Params) {
    let phong = params.model == Model::Phong;
    widgets::field(ui, &labels::NORMALS, |ui, _| {
        let chosen = Normals::ALL.iter().position(|&n| n == params.normals).unwrap_or(0);
        let chosen = if phong { Normals::ALL.len() } else { chosen };
        let entries = Normals::ALL.map(|n| (n.title(), drawn(n, phong).to_owned(), !phong));
        if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
            params.normals = Normals::ALL[i];
        }
    });
}

/// Describes the normals that are drawn, with Phong or another model.
pub(crate) fn drawn(normals: Normals, phong: bool) -> &'static str {
    match normals {
        _ if phong => "Phong has no distribution of visible normals: it samples the whole one.",
        Normals::Visible => {
            "The distribution of visible normals (Heitz 2014): those that the viewer sees, by how much of \
             them is seen."
        }
        Normals::Distribution => {
            "The whole distribution D cos: the older way, slower and noisier at grazing."
        }
    }
}
