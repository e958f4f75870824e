//! The button that makes a contact sheet, or stops the one in the making.

use crate::viewer::document::Document;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::style::theme;
use egui::{Button, Ui};

#[derive(Default)]
pub(crate) struct SheetButton;

impl Panel for SheetButton {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        let name = keys::binding(Action::Sheet).name;
        let words = match document.live.sheet {
            Some([at, of]) => format!("Stop the sheet at {at} of {of}"),
            None => name.to_owned(),
        };
        // In the same place and of the same size, whatever it says.
        let size = egui::vec2(ui.available_width(), theme::ROW);
        let pressed = ui
            .add_sized(size, Button::new(words))
            .accessible_name(name)
            .on_hover_text(keys::tooltip(ui.ctx(), Action::Sheet))
            .clicked();
        actions.extend(pressed.then_some(Action::Sheet));
    }
}
