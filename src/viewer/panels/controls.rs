//! The controls that matter most: model, roughness, when to stop.

use crate::viewer::document::goal::{Goal, Stop};
use crate::viewer::document::{Document, Shown};
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::panels::energy::EnergyOfLobe;
use crate::viewer::style::labels;
use crate::viewer::style::number_field::{NumberField, Written};
use crate::viewer::style::numbers::digits;
use crate::viewer::style::subscript;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Weight};
use burnish::brdf::{Model, Roughness};
use burnish::progressive::Session;
use egui::{Button, Response, RichText, Slider, TextStyle, Ui};

#[derive(Default)]
pub(crate) struct Controls {
    energy: EnergyOfLobe,
}

impl Panel for Controls {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        actions.extend(model(ui, document));
        ui.add_space(theme::GAP);
        roughness(ui, document, &mut self.energy);
        widgets::rule(ui);
        stop_at(ui, document);
        actions.extend(run(ui, document));
        actions.extend(history(ui, document));
    }
}

fn model(ui: &mut Ui, document: &Document) -> Option<Action> {
    let chosen = Model::ALL.iter().position(|&m| m == document.params.model).unwrap_or(0);
    let entries = Model::ALL.map(|m| (m.title(), keys::tooltip(ui.ctx(), Action::Model(m)), true));
    widgets::segmented(ui, Weight::Strong, chosen, &entries).map(|i| Action::Model(Model::ALL[i]))
}

fn roughness(ui: &mut Ui, document: &mut Document, energy: &mut EnergyOfLobe) {
    let shown = document.roughness();
    let edited = document.roughness_is_edited();
    let mut reset = false;
    let label = ui
        .horizontal(|ui| {
            let label = ui.label(labels::ROUGHNESS.name);
            let label = label.on_hover_text(subscript::tip(ui, labels::ROUGHNESS.tip));
            if let Shown::Mixed(_) = shown {
                let [low, high] = document.alphas();
                let words = format!("mixed, {} to {}", digits(low, 3), digits(high, 3));
                ui.weak(words).on_hover_text(
                    "Shown is the geometric mean of the alphas. Moving the slider gives all \
                     materials one roughness; the keys [ and ] scale each.",
                );
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let words = RichText::new(labels::AS_IN_FILE.name).small();
                let button = Button::new(words).small().frame(false);
                reset = edited && ui.add(button).on_hover_text(labels::AS_IN_FILE.tip).clicked();
            });
            label
        })
        .inner;
    // Without a lobe all stays in its place, or what is below would move under the pointer.
    let value = match shown {
        Shown::Same(value) | Shown::Mixed(value) => Some(value),
        Shown::None => None,
    };
    let any = document.picked_material().or(document.params.materials.first());
    let Some(idle) = value.or(any.map(|material| material.roughness)) else {
        ui.weak("No materials: nothing has a roughness");
        return;
    };
    let fields = |ui: &mut Ui| slider(ui, &label, idle);
    let wanted = ui.add_enabled_ui(value.is_some(), fields).inner;
    match value {
        Some(value) => energy.line(ui, document.params.model, value),
        None => {
            let words = "No specular lobe here (Ks = 0): roughness has no effect";
            ui.label(RichText::new(words).weak().small());
        }
    }
    if let Some(roughness) = wanted.filter(|_| value.is_some()) {
        document.set_roughness(roughness);
    }
    if reset {
        document.reset_roughness();
    }
    applies_to(ui, document);
}

/// The slider and the two fields; the roughness that they are set to, once they are.
fn slider(ui: &mut Ui, label: &Response, value: Roughness) -> Option<Roughness> {
    let mut wanted = None;
    let [low, high] = Roughness::ALPHA;
    let mut alpha = value.alpha();
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = Slider::new(&mut alpha, low..=high).logarithmic(true).show_value(false);
    if ui.add(slider).labelled_by(label.id).changed() {
        wanted = Roughness::from_alpha(alpha).ok();
    }
    widgets::field(ui, &labels::ALPHA, |ui, label| {
        let (tip, name) = (labels::ALPHA.tip, labels::A_P.name);
        let width = (ui.available_width() - subscript::width(ui, name)) / 2.0 - theme::GAP;
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        let mut alpha = value.alpha();
        let field = NumberField {
            name: labels::ALPHA.name,
            range: Roughness::ALPHA,
            speed: 0.01 * value.alpha(),
            written: Written::Digits(4),
            unit: "",
            prefix: "",
            size,
        };
        if field.ui(ui, &mut alpha).labelled_by(label).on_hover_text(tip).changed() {
            wanted = Roughness::from_alpha(alpha).ok();
        }
        let tip = subscript::tip(ui, labels::A_P.tip);
        let colour = ui.visuals().text_color();
        let label = subscript::label(ui, TextStyle::Body, colour).on_hover_text(tip.clone()).id;
        let mut exponent = value.exponent();
        let field = NumberField {
            name,
            range: Roughness::EXPONENT,
            speed: 0.01 * (value.exponent() + 2.0),
            written: Written::Digits(4),
            unit: "",
            prefix: "",
            size,
        };
        if field.ui(ui, &mut exponent).labelled_by(label).on_hover_text(tip).changed() {
            wanted = Roughness::from_exponent(exponent).ok();
        }
    });
    wanted
}

/// Whether the roughness is that of all materials or of the picked one.
fn applies_to(ui: &mut Ui, document: &mut Document) {
    let picked = document.picked_material().map(|m| m.name.clone());
    let (words, tip) = match &picked {
        Some(name) => (name.as_str(), format!("Only \"{name}\", the material picked.")),
        None => (labels::PICKED.name, labels::PICKED.tip.to_owned()),
    };
    let all = (labels::ALL.name, labels::ALL.tip.to_owned(), true);
    let entries = [all, (words, tip, picked.is_some())];
    let chosen = usize::from(document.only_picked);
    let pressed = widgets::field(ui, &labels::APPLIES_TO, |ui, _| {
        widgets::segmented(ui, Weight::Quiet, chosen, &entries)
    });
    if let Some(pressed) = pressed {
        document.only_picked = pressed == 1;
    }
}

/// Draws the condition that ends the tracing, and its number.
fn stop_at(ui: &mut Ui, document: &mut Document) {
    let chosen = document.goal.stop;
    widgets::field(ui, &labels::STOP_AT, |ui, _| {
        let place = Stop::ALL.iter().position(|&s| s == chosen).unwrap_or(0);
        let entries = Stop::ALL.map(|s| (s.title(), s.limit().tip.to_owned(), true));
        if let Some(i) = widgets::segmented(ui, Weight::Quiet, place, &entries) {
            document.goal.stop = Stop::ALL[i];
        }
    });
    let goal = &mut document.goal;
    let chosen = goal.stop;
    let control = chosen.limit();
    let mut field = NumberField {
        name: control.name,
        range: [1.0, Session::MAX_PASSES as f64],
        speed: 1.0,
        written: Written::Whole,
        unit: "",
        prefix: "",
        size: egui::Vec2::ZERO,
    };
    widgets::field(ui, &control, |ui, label| {
        field.size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        let response = match chosen {
            Stop::Passes => {
                field.speed = (goal.passes as f64 * 0.01).max(0.2);
                field.whole(ui, &mut goal.passes)
            }
            Stop::Error => {
                let mut percent = 100.0 * goal.error;
                (field.range, field.speed) = (Goal::ERROR.map(|e| 100.0 * e), 0.01 * percent);
                (field.written, field.unit) = (Written::Digits(3), " %");
                let response = field.ui(ui, &mut percent);
                if response.changed() {
                    goal.error = percent / 100.0;
                }
                response
            }
            Stop::Time => {
                (field.range, field.speed) = (Goal::SECONDS, 0.01 * goal.seconds);
                (field.written, field.unit) = (Written::Digits(4), " s");
                field.ui(ui, &mut goal.seconds)
            }
        };
        response.labelled_by(label).on_hover_text(control.tip);
    });
}

fn run(ui: &mut Ui, document: &Document) -> Option<Action> {
    let pause = if document.paused { "Resume" } else { keys::binding(Action::Pause).name };
    let buttons = [(pause, Action::Pause), (keys::binding(Action::Save).name, Action::Save)];
    let tips = buttons.map(|(words, action)| (words, keys::tooltip(ui.ctx(), action), true));
    widgets::button_row(ui, &tips).map(|i| buttons[i].1)
}

fn history(ui: &mut Ui, document: &Document) -> Option<Action> {
    let buttons = [
        (Action::Undo, "Undo", document.can_undo()),
        (Action::Redo, "Redo", document.can_redo()),
        (Action::Restart, "Restart", true),
        (Action::CopyCommand, "Copy command", true),
        (Action::Help, "?", true),
    ];
    let mut pressed = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = 6.0;
        for (action, words, can) in buttons {
            // Quieter than what is done often.
            let button = Button::new(RichText::new(words).weak()).frame_when_inactive(false);
            let tip = keys::tooltip(ui.ctx(), action);
            let name = keys::binding(action).name;
            let button = ui.add_enabled(can, button).accessible_name(name);
            if button.on_hover_text(&tip).on_disabled_hover_text(&tip).clicked() {
                pressed = Some(action);
            }
        }
    });
    pressed
}
