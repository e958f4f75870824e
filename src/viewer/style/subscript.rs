//! The Phong exponent's name with its subscript, which the fonts have no letter for.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, FontSelection, Response, TextStyle, Ui};

const NAME: &str = "a_p";

/// A text in which every "a_p" has its p as a subscript.
pub(crate) fn job(ui: &Ui, text: &str, style: TextStyle, colour: Color32) -> LayoutJob {
    let font = FontSelection::Style(style).resolve(ui.style());
    let plain = TextFormat { valign: Align::BOTTOM, ..TextFormat::simple(font.clone(), colour) };
    let mut small = plain.clone();
    small.font_id.size = (0.72 * font.size).round();
    let mut job = LayoutJob::default();
    for (i, part) in text.split(NAME).enumerate() {
        if i > 0 {
            job.append("a", 0.0, plain.clone());
            job.append("p", 0.0, small.clone());
        }
        if !part.is_empty() {
            job.append(part, 0.0, plain.clone());
        }
    }
    job
}

/// Width of such a text in points.
pub(crate) fn width(ui: &Ui, text: &str) -> f32 {
    let job = job(ui, text, TextStyle::Body, Color32::WHITE);
    ui.fonts_mut(|fonts| fonts.layout_job(job)).size().x
}

/// A tooltip with it.
pub(crate) fn tip(ui: &Ui, text: &str) -> LayoutJob {
    job(ui, text, TextStyle::Body, ui.visuals().text_color())
}

/// The name as a label; screen readers are told "a_p".
pub(crate) fn label(ui: &mut Ui, style: TextStyle, colour: Color32) -> Response {
    let job = job(ui, NAME, style, colour);
    let label = ui.label(job);
    ui.ctx().accesskit_node_builder(label.id, |node| node.set_value(NAME));
    label
}
