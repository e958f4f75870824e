//! The one line of figures below the picture.

use super::canvas::Hover;
use super::document::Document;
use super::theme::digits;
use burnish::progressive::{Snapshot, State};
use egui::{Align, Label, Layout, RichText, Ui};
use std::time::Duration;

pub(super) struct Status;

/// What the line speaks of, as far as there is any.
pub(super) struct Facts<'a> {
    pub(super) document: Option<&'a Document>,
    pub(super) snapshot: Option<&'a Snapshot>,
    pub(super) latency: Option<Duration>,
    pub(super) hover: Option<Hover>,
    /// The scene being read, by name.
    pub(super) loading: Option<&'a str>,
}

impl Status {
    pub(super) fn ui(&mut self, ui: &mut Ui, facts: &Facts) {
        ui.horizontal_centered(|ui| {
            ui.spacing_mut().item_spacing.x = 16.0;
            if let Some(name) = facts.loading {
                ui.label(format!("Reading {name} ..."));
            }
            if let Some(document) = facts.document {
                progress(ui, document, facts);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    scene(ui, document);
                    warnings(ui, document);
                    if let Some(hover) = facts.hover {
                        pixel(ui, hover);
                    }
                });
            }
        });
    }
}

fn progress(ui: &mut Ui, document: &Document, facts: &Facts) {
    let passes = facts.snapshot.map_or(0, |s| s.passes);
    // As wide as it will get, so that what follows stays in place.
    let width = 2 * document.limit.to_string().len() + " /  passes".len();
    let state = match facts.snapshot.map(|s| &s.state) {
        Some(State::Done) => "done",
        Some(State::Paused) => "paused",
        Some(State::Failed(_)) => "failed",
        _ if document.paused => "paused",
        _ => "",
    };
    figure(
        ui,
        format!("{:<width$}", format!("{passes} / {} passes", document.limit)),
        "Whole passes traced, of the limit: every pixel has at least this many samples.",
    );
    if !state.is_empty() {
        ui.label(RichText::new(state).strong());
    }
    let Some(snapshot) = facts.snapshot else { return };
    let error = match snapshot.error {
        Some(error) => format!("rel. error {:>6}", percent(error.relative)),
        None => "rel. error      -".to_owned(),
    };
    figure(
        ui,
        error,
        "Square root of the mean over pixels and channels of variance / (mean\u{b2} + 0.01), estimated \
         from independent replicates. \"-\" until they allow an estimate.",
    );
    let seconds = snapshot.seconds;
    let rate = if seconds > 0.0 { snapshot.counts.paths as f64 / seconds } else { 0.0 };
    figure(
        ui,
        format!("{:>6} paths/s", millions(rate)),
        "Camera paths a second since the first pass.",
    );
    let latency =
        facts.latency.map_or("-".to_owned(), |l| (l.as_secs_f64() * 1e3).round().to_string());
    figure(ui, format!("{latency:>3} ms"), "From the last change to its first pixels.");
    if snapshot.counts.nonfinite > 0 {
        let text = format!("{} samples not finite", snapshot.counts.nonfinite);
        let colour = ui.visuals().error_fg_color;
        ui.add(Label::new(RichText::new(text).monospace().color(colour))).on_hover_text(
            "Samples that were NaN or infinite. They are left out of the sums, so their pixels \
             are wrong. This is a fault of burnish: please report it with the scene.",
        );
    }
}

fn scene(ui: &mut Ui, document: &Document) {
    let [w, h] = document.params.size;
    figure(ui, format!("{w} x {h}"), "Width and height of the picture in pixels.");
    ui.add(Label::new(document.params.scene.name()).truncate());
}

fn warnings(ui: &mut Ui, document: &Document) {
    let warnings = &document.report.warnings;
    let Some(first) = warnings.first() else { return };
    let plural = if warnings.len() == 1 { "" } else { "s" };
    let text = RichText::new(format!("{} warning{plural}", warnings.len()));
    let colour = ui.visuals().warn_fg_color;
    let tip = format!("{first}\nAll of them are under \"Scene\" in the side panel.");
    ui.add(Label::new(text.color(colour))).on_hover_text(tip);
}

fn pixel(ui: &mut Ui, hover: Hover) {
    let [x, y] = hover.pixel;
    let triple = |c: [f32; 3]| c.map(|v| format!("{:>7}", digits(f64::from(v), 3))).join(" ");
    let mut tip = "Column and row of the pixel from the top left, and its mean radiance: red, \
                   green, blue, linear Rec. 709."
        .to_owned();
    if let Some(error) = hover.standard_error {
        tip += &format!("\nStandard error: {}", triple(error));
    }
    figure(ui, format!("({x:>4}, {y:>4}) {}", triple(hover.mean)), &tip);
}

fn figure(ui: &mut Ui, text: String, tip: &str) {
    ui.add(Label::new(RichText::new(text).monospace())).on_hover_text(tip);
}

fn percent(relative: f64) -> String {
    let percent = relative * 100.0;
    if percent >= 10.0 { format!("{percent:.0} %") } else { format!("{percent:.2} %") }
}

/// 812, 45.1 k, 5.13 M.
fn millions(rate: f64) -> String {
    match rate {
        r if r >= 1e6 => format!("{:.2} M", r / 1e6),
        r if r >= 1e3 => format!("{:.1} k", r / 1e3),
        r => format!("{r:.0}"),
    }
}
