//! The section "View": exposure, tone curve, camera, light or dark.

use crate::viewer::document::Document;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::picture::maps::{self, Layer};
use crate::viewer::style::labels;
use crate::viewer::style::widgets::{self, Weight};
use burnish::picture::Curve;
use egui::{Slider, ThemePreference, Ui};

#[derive(Default)]
pub(crate) struct View;

impl Panel for View {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        widgets::section(ui, "view", "View", None, true, |ui| {
            layer(ui, document);
            exposure(ui, document);
            curve(ui, document);
            actions.extend(camera(ui));
            appearance(ui);
        });
    }
}

impl View {
    /// Exposures that the slider reaches, in stops.
    pub(crate) const STOPS: [f32; 2] = [-10.0, 10.0];

    /// Adds `stops` to the exposure, within its range.
    pub(crate) fn expose(document: &mut Document, stops: f32) {
        let [low, high] = Self::STOPS;
        document.tone.exposure = (document.tone.exposure + stops).clamp(low, high);
    }
}

/// Draws the choice of layers: none is shown where a difference takes the picture's place.
fn layer(ui: &mut Ui, document: &mut Document) {
    widgets::field(ui, &labels::LAYER, |ui, _| {
        let there = !document.comparison.is_difference();
        let tip = |l| match there {
            true => maps::tip(ui.ctx(), l),
            false => labels::LAYER_NONE.to_owned(),
        };
        let entries = Layer::ALL.map(|l| (l.control().name, tip(l), there));
        let chosen = Layer::ALL.iter().position(|&l| there && l == document.layer);
        let pressed = widgets::segmented(ui, Weight::Quiet, chosen.unwrap_or(usize::MAX), &entries);
        if let Some(i) = pressed.filter(|_| there) {
            document.layer = Layer::ALL[i];
        }
    });
}

fn exposure(ui: &mut Ui, document: &mut Document) {
    let [low, high] = View::STOPS;
    widgets::field(ui, &labels::EXPOSURE, |ui, label| {
        ui.spacing_mut().slider_width = ui.available_width() - 80.0;
        ui.spacing_mut().interact_size.x = 72.0;
        let slider = Slider::new(&mut document.tone.exposure, low..=high)
            .fixed_decimals(1)
            .trailing_fill(false)
            .suffix(" stops");
        if ui.add(slider).labelled_by(label).double_clicked() {
            document.tone.exposure = 0.0;
        }
    });
}

fn curve(ui: &mut Ui, document: &mut Document) {
    widgets::field(ui, &labels::CURVE, |ui, _| {
        let chosen = Curve::ALL.iter().position(|&c| c == document.tone.curve).unwrap_or(0);
        let entries = Curve::ALL.map(|c| (c.title(), describe(c).to_owned(), true));
        if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
            document.tone.curve = Curve::ALL[i];
        }
    });
}

/// Describes a curve.
pub(crate) fn describe(curve: Curve) -> &'static str {
    match curve {
        Curve::Srgb => "min(x, 1): what is too bright is clipped.",
        Curve::Reinhard => "x / (1 + x), each channel: never clips, lowers contrast.",
        Curve::Filmic => "A film-like curve with a toe and a shoulder.",
        Curve::Neutral => "Khronos PBR Neutral: highlights keep their shape and hue.",
    }
}

fn camera(ui: &mut Ui) -> Option<Action> {
    const ACTIONS: [Action; 3] = [Action::Home, Action::Frame, Action::CopyCamera];
    let tips = ACTIONS.map(|a| (keys::binding(a).name, keys::tooltip(ui.ctx(), a), true));
    widgets::field(ui, &labels::CAMERA, |ui, _| widgets::button_row(ui, &tips).map(|i| ACTIONS[i]))
}

/// The colours of the window, with their names and what they do.
pub(crate) const THEMES: [(ThemePreference, &str, &str); 3] = [
    (ThemePreference::System, "System", "Light or dark as the system is."),
    (ThemePreference::Dark, "Dark", "Light text on dark grey."),
    (ThemePreference::Light, "Light", "Dark text on light grey."),
];

fn appearance(ui: &mut Ui) {
    let present = ui.ctx().options(|o| o.theme_preference);
    let chosen = THEMES.iter().position(|t| t.0 == present).unwrap_or(0);
    let entries = THEMES.map(|(_, words, tip)| (words, tip.to_owned(), true));
    widgets::field(ui, &labels::WINDOW, |ui, _| {
        if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
            ui.ctx().set_theme(THEMES[i].0);
        }
    });
}
