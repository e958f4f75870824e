//! The line in which the path of a scene is typed.

use super::theme;
use egui::{Key, TextEdit, Ui};
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
            let width = ui.available_width() - 144.0;
            let field = TextEdit::singleline(&mut self.path)
                .hint_text("path of a .scn, .obj or .ply file")
                .desired_width(width.max(80.0));
            let field = ui.add(field).labelled_by(label.id);
            if std::mem::take(&mut self.focus) {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            let escaped = ui.input(|i| i.key_pressed(Key::Escape));
            ui.spacing_mut().item_spacing.x = theme::GAP;
            chosen = ui.button("Open").clicked() || entered;
            if ui.button("Cancel").clicked() || escaped {
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
