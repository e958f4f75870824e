//! The button that makes a contact sheet, or stops the one in the making.

use crate::viewer::keys::{self, Action};
use crate::viewer::style::theme;
use egui::{Button, Ui};

/// Draws it; `making` is the number of the picture that is traced, from 1, and of how many.
pub(crate) fn button(ui: &mut Ui, making: Option<[usize; 2]>) -> Option<Action> {
    let name = keys::binding(Action::Sheet).name;
    let words = match making {
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
    pressed.then_some(Action::Sheet)
}
