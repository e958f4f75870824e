//! The controls that matter most: model, roughness, when to stop.

use crate::viewer::document::goal::{Goal, Stop};
use crate::viewer::document::{Document, Shown};
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::energy::Energy;
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Weight};
use burnish::brdf::{Model, Roughness};
use burnish::progressive::Session;
use egui::{Button, DragValue, RichText, Slider, Ui};

pub(crate) struct Controls;

impl Controls {
    /// Draws them; changes the document, and returns what a button asked for.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        document: &mut Document,
        energy: &mut Energy,
    ) -> Option<Action> {
        let asked = model(ui, document);
        ui.add_space(theme::GAP);
        roughness(ui, document, energy);
        widgets::rule(ui);
        stop_at(ui, document);
        let asked = asked.or(run(ui, document));
        asked.or(history(ui, document))
    }
}

fn model(ui: &mut Ui, document: &Document) -> Option<Action> {
    let chosen = Model::ALL.iter().position(|&m| m == document.params.model).unwrap_or(0);
    let entries = Model::ALL.map(|m| (m.title(), keys::tooltip(ui.ctx(), Action::Model(m)), true));
    widgets::segmented(ui, Weight::Strong, chosen, &entries).map(|i| Action::Model(Model::ALL[i]))
}

fn roughness(ui: &mut Ui, document: &mut Document, energy: &mut Energy) {
    let shown = document.roughness();
    let edited = document.roughness_is_edited();
    let mut reset = false;
    let label = ui
        .horizontal(|ui| {
            let label = ui.label(labels::ROUGHNESS.name).on_hover_text(labels::ROUGHNESS.tip);
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
    let (Shown::Same(value) | Shown::Mixed(value)) = shown else {
        ui.weak("No specular lobe here (Ks = 0): roughness has no effect.");
        applies_to(ui, document);
        return;
    };
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
        let width = (ui.available_width() - widgets::text_width(ui, name)) / 2.0 - theme::GAP;
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        let mut alpha = value.alpha();
        let field = widgets::number(&mut alpha, 4)
            .range(low..=high)
            .speed(0.01 * value.alpha())
            .min_size(size);
        if ui.add_sized(size, field).labelled_by(label).on_hover_text(tip).changed() {
            wanted = Roughness::from_alpha(alpha).ok();
        }
        let tip = labels::A_P.tip;
        let label = ui.label(name).on_hover_text(tip).id;
        let [low, high] = Roughness::EXPONENT;
        let mut exponent = value.exponent();
        let speed = 0.01 * (value.exponent() + 2.0);
        let field = widgets::number(&mut exponent, 4).range(low..=high).speed(speed).min_size(size);
        if ui.add_sized(size, field).labelled_by(label).on_hover_text(tip).changed() {
            wanted = Roughness::from_exponent(exponent).ok();
        }
    });
    energy.of_lobe(ui, document.params.model, value);
    if let Some(roughness) = wanted {
        document.set_roughness(roughness);
    }
    if reset {
        document.reset_roughness();
    }
    applies_to(ui, document);
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

/// What it is that ends the tracing, and its figure.
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
    match chosen {
        Stop::Passes => {
            let mut passes = goal.passes;
            let speed = (passes as f64 * 0.01).max(0.2);
            let field = DragValue::new(&mut passes).range(1..=Session::MAX_PASSES).speed(speed);
            if limit(ui, &chosen.limit(), field) {
                document.set_limit(passes);
            }
        }
        Stop::Error => {
            let [low, high] = Goal::ERROR.map(|e| 100.0 * e);
            let mut percent = 100.0 * goal.error;
            let speed = 0.01 * percent;
            let field = widgets::number(&mut percent, 3).range(low..=high).speed(speed);
            if limit(ui, &chosen.limit(), field.suffix(" %")) {
                goal.error = percent / 100.0;
            }
        }
        Stop::Time => {
            let [low, high] = Goal::SECONDS;
            let mut seconds = goal.seconds;
            let speed = 0.01 * seconds;
            let field = widgets::number(&mut seconds, 4).range(low..=high).speed(speed);
            if limit(ui, &chosen.limit(), field.suffix(" s")) {
                goal.seconds = seconds;
            }
        }
    }
}

/// A figure over the whole width; whether it was changed.
fn limit(ui: &mut Ui, control: &Control, field: DragValue<'_>) -> bool {
    widgets::field(ui, control, |ui, label| {
        let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        let field = field.update_while_editing(false).min_size(size);
        ui.add_sized(size, field).labelled_by(label).on_hover_text(control.tip).changed()
    })
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
