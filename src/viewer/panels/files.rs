//! The row of buttons that open and save scenes, with what the present scene says of itself.

use crate::viewer::document::Document;
use crate::viewer::document::recent::Recent;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::scene::builtin::EXAMPLES;
use egui::{Button, Label, Popup, RichText, Ui};

#[derive(Default)]
pub(crate) struct Files;

impl Panel for Files {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        row(ui, &document.live.recent, actions);
        if let Some(caption) = document.params.scene.caption() {
            ui.add(Label::new(RichText::new(caption).small().weak()).wrap());
        }
    }
}

/// Draws the buttons that open and save, and the menu of scenes; also where there is no document yet.
pub(crate) fn row(ui: &mut Ui, recent: &Recent, actions: &mut Vec<Action>) {
    let width = (ui.available_width() - 2.0 * theme::GAP) / 3.0;
    ui.horizontal(|ui| {
        let size = egui::vec2(width, theme::ROW);
        for action in [Action::Open, Action::SaveScene] {
            let button = Button::new(keys::binding(action).name).min_size(size);
            let tip = keys::tooltip(ui.ctx(), action);
            if ui.add_sized(size, button).on_hover_text(tip).clicked() {
                actions.push(action);
            }
        }
        let menu = ui.add_sized(size, Button::new(labels::SCENES.name).min_size(size));
        widgets::menu_arrow(ui, &menu);
        let menu = menu.on_hover_text(labels::SCENES.tip);
        Popup::menu(&menu).show(|ui| scenes(ui, recent, actions));
    });
}

/// The menu's entries: shipped scenes, then recent ones.
fn scenes(ui: &mut Ui, recent: &Recent, actions: &mut Vec<Action>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    for example in &EXAMPLES {
        let entry = ui.button(example.title);
        widgets::beside(&entry, example.shows);
        if entry.clicked() {
            actions.push(Action::OpenExample(example));
        }
    }
    if !recent.paths().is_empty() {
        ui.separator();
    }
    for (i, path) in recent.paths().iter().enumerate() {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let entry = ui.button(name);
        widgets::beside(&entry, &path.display().to_string());
        if entry.clicked() {
            actions.push(Action::OpenRecent(i));
        }
    }
}
