//! The line in which the path of a scene is typed.

use super::{theme, widgets};
use egui::text::CCursorRange;
use egui::{Id, Key, TextEdit, Ui};
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

/// So that typing replaces the path before.
fn select_all(ui: &Ui, id: Id, text: &str) {
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::select_all_str(text)));
    state.store(ui.ctx(), id);
}
