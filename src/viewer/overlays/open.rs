//! The line in which the path of a scene is typed.

use crate::viewer::jobs::load::Source;
use crate::viewer::keys::{self, Action};
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use egui::text::CCursorRange;
use egui::{Id, Key, TextEdit, Ui};
use std::path::PathBuf;

#[derive(Default)]
pub(crate) struct Open {
    shown: bool,
    path: String,
    focus: bool,
}

impl Open {
    /// Shows the line, ready to be typed into; hides it again when it is there.
    pub(crate) fn toggle(&mut self) {
        self.shown = !self.shown;
        self.focus = self.shown;
    }

    /// Shows the line.
    pub(crate) fn show(&mut self) {
        (self.shown, self.focus) = (true, true);
    }

    pub(crate) fn is_shown(&self) -> bool {
        self.shown
    }

    /// Draws the line; returns what is to be opened once that is clear.
    pub(crate) fn ui(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) -> Option<Source> {
        let mut chosen = false;
        ui.horizontal_centered(|ui| {
            let label = ui.label(labels::PATH.name).on_hover_text(labels::PATH.tip);
            let browse = keys::binding(Action::Browse).name;
            let [open, cancel] = [labels::OPEN_PATH, labels::CANCEL];
            let buttons = [browse, open.name, cancel.name];
            let padding = theme::GAP + 2.0 * ui.spacing().button_padding.x;
            let width: f32 = buttons.iter().map(|b| widgets::text_width(ui, b) + padding).sum();
            let width = ui.available_width() - width.ceil();
            let field = TextEdit::singleline(&mut self.path)
                .hint_text("path of a .scn, .obj or .ply file, or a shipped scene's name")
                .desired_width(width.max(80.0));
            let field = ui.add(field).labelled_by(label.id).on_hover_text(labels::PATH.tip);
            if std::mem::take(&mut self.focus) {
                field.request_focus();
                select_all(ui, field.id, &self.path);
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            let escaped = ui.input(|i| i.key_pressed(Key::Escape));
            let tip = keys::tooltip(ui.ctx(), Action::Browse);
            if ui.button(browse).on_hover_text(tip).clicked() {
                self.shown = false;
                actions.push(Action::Browse);
            }
            chosen = ui.button(open.name).on_hover_text(open.tip).clicked() || entered;
            if ui.button(cancel.name).on_hover_text(cancel.tip).clicked() || escaped {
                self.shown = false;
            }
        });
        let path = self.path.trim();
        if !chosen || path.is_empty() {
            return None;
        }
        self.shown = false;
        Some(Source::named(meant(path)))
    }
}

/// The path that is meant: file managers copy paths in quotes or as addresses, and shells know `~`.
fn meant(text: &str) -> PathBuf {
    let as_written = PathBuf::from(text);
    if as_written.exists() {
        return as_written;
    }
    let bare = ['"', '\''].iter().find_map(|q| text.strip_prefix(*q)?.strip_suffix(*q));
    let text = bare.unwrap_or(text);
    let text = text.strip_prefix("file://").map_or(text.to_owned(), unescaped);
    match text.strip_prefix("~/").zip(home()) {
        Some((rest, home)) => home.join(rest),
        None => PathBuf::from(text),
    }
}

fn home() -> Option<PathBuf> {
    std::env::home_dir().filter(|home| !home.as_os_str().is_empty())
}

/// The bytes that `%20` and the like stand for (RFC 3986, 2.1).
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let code = code.and_then(|two| u8::from_str_radix(two, 16).ok());
        match code.filter(|_| first == b'%') {
            Some(code) => {
                bytes.push(code);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// So that typing replaces the path before.
fn select_all(ui: &Ui, id: Id, text: &str) {
    let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::select_all_str(text)));
    state.store(ui.ctx(), id);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_taken_as_people_have_them() {
        for (text, path) in [
            ("a b.scn", "a b.scn"),
            ("\"/x/a b.scn\"", "/x/a b.scn"),
            ("'/x/y.obj'", "/x/y.obj"),
            ("file:///x/a%20b.scn", "/x/a b.scn"),
            ("file:///x/100%.scn", "/x/100%.scn"),
            ("'file:///x/%C3%A4.ply'", "/x/\u{e4}.ply"),
        ] {
            assert_eq!(meant(text), PathBuf::from(path), "{text}");
        }
        if let Some(home) = home() {
            assert_eq!(meant("~/x.scn"), home.join("x.scn"));
        }
    }
}
