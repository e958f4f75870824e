//! Ways to another scene: the line in which a path is typed, and the menu of shipped ones.

use super::keys::{self, Action};
use super::load::Source;
use super::{theme, widgets};
use burnish::scene::builtin::EXAMPLES;
use egui::text::CCursorRange;
use egui::{Button, ComboBox, Id, Key, TextEdit, Ui};
use std::path::PathBuf;

#[derive(Default)]
pub(super) struct Open {
    shown: bool,
    path: String,
    focus: bool,
}

impl Open {
    /// Shows the line, ready to be typed into; hides it again when it is there.
    pub(super) fn toggle(&mut self) {
        self.shown = !self.shown;
        self.focus = self.shown;
    }

    pub(super) fn is_shown(&self) -> bool {
        self.shown
    }

    /// Returns the path once it is to be opened.
    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<PathBuf> {
        let mut chosen = false;
        ui.horizontal_centered(|ui| {
            let label = ui.label("Open scene");
            let buttons = ["Open", "Cancel"];
            let padding = theme::GAP + 2.0 * ui.spacing().button_padding.x;
            let width: f32 = buttons.iter().map(|b| widgets::text_width(ui, b) + padding).sum();
            let width = ui.available_width() - width.ceil();
            let field = TextEdit::singleline(&mut self.path)
                .hint_text("path of a .scn, .obj or .ply file")
                .desired_width(width.max(80.0));
            let field = ui.add(field).labelled_by(label.id);
            if std::mem::take(&mut self.focus) {
                field.request_focus();
                select_all(ui, field.id, &self.path);
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            let escaped = ui.input(|i| i.key_pressed(Key::Escape));
            let [open, cancel] = buttons;
            chosen = ui.button(open).clicked() || entered;
            if ui.button(cancel).clicked() || escaped {
                self.shown = false;
            }
        });
        let path = self.path.trim();
        if !chosen || path.is_empty() {
            return None;
        }
        self.shown = false;
        Some(PathBuf::from(path))
    }
}

/// The buttons that open and reload, and the menu of shipped scenes. Returns the one chosen there.
pub(super) fn files(ui: &mut Ui, asked: &mut Vec<Action>) -> Option<Source> {
    let mut chosen = None;
    let width = (ui.available_width() - 2.0 * theme::GAP) / 3.0;
    ui.horizontal(|ui| {
        let size = egui::vec2(width, theme::ROW);
        for action in [Action::Open, Action::Reload] {
            let button = Button::new(keys::binding(action).name).min_size(size);
            let tip = keys::tooltip(ui.ctx(), action);
            if ui.add_sized(size, button).on_hover_text(tip).clicked() {
                asked.push(action);
            }
        }
        let menu = ComboBox::from_id_salt("examples")
            .width(ui.available_width())
            .selected_text("Examples")
            .show_ui(ui, |ui| {
                for example in &EXAMPLES {
                    let entry = ui.selectable_label(false, example.title);
                    widgets::beside(&entry, example.shows);
                    if entry.clicked() {
                        chosen = Some(Source::Example(example));
                    }
                }
            });
        menu.response.accessible_name("Examples").on_hover_text("Scenes that come with burnish.");
    });
    chosen
}

/// So that typing replaces the path before.
fn select_all(ui: &Ui, id: Id, text: &str) {
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::select_all_str(text)));
    state.store(ui.ctx(), id);
}
