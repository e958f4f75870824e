//! The one line of figures below the picture.

use crate::viewer::document::Document;
use crate::viewer::document::goal::Stop;
use crate::viewer::style::numbers::{percent, short};
use crate::viewer::style::theme;
use burnish::progressive::{ErrorEstimate, Interval, Snapshot, State};
use egui::{Align, Color32, Label, Layout, Rect, RichText, Ui, UiBuilder};
use std::time::Duration;

pub(crate) struct Status;

/// What the line speaks of, as far as there is any.
pub(crate) struct Facts<'a> {
    pub(crate) document: Option<&'a Document>,
    pub(crate) snapshot: Option<&'a Snapshot>,
    /// Whether the goal has been reached.
    pub(crate) done: bool,
    pub(crate) latency: Option<Duration>,
    /// The scene being read, by name.
    pub(crate) loading: Option<&'a str>,
}

impl Status {
    /// The scene at the right, the progress at the left. What there is no room for is left out, the
    /// least important first.
    pub(crate) fn ui(&mut self, ui: &mut Ui, facts: &Facts) {
        let row = ui.max_rect();
        let mut right = row.right();
        if let Some(document) = facts.document {
            right = group(ui, row, Layout::right_to_left(Align::Center), |ui| {
                scene(ui, document);
                warnings(ui, document);
            })
            .left();
        }
        let rest = Rect::from_min_max(row.min, egui::pos2(right - theme::GROUP, row.bottom()));
        group(ui, rest, Layout::left_to_right(Align::Center), |ui| {
            if let Some(name) = facts.loading {
                ui.add(Label::new(format!("Reading {name} ...")).truncate());
            }
            if let Some(document) = facts.document {
                progress(ui, document, facts);
            }
        });
    }
}

/// Draws into a part of the line; returns the part used.
fn group(ui: &mut Ui, space: Rect, layout: Layout, body: impl FnOnce(&mut Ui)) -> Rect {
    let mut ui = ui.new_child(UiBuilder::new().max_rect(space).layout(layout));
    ui.spacing_mut().item_spacing.x = theme::GROUP;
    body(&mut ui);
    ui.min_rect()
}

fn progress(ui: &mut Ui, document: &Document, facts: &Facts) {
    let passes = facts.snapshot.map_or(0, |s| s.passes);
    // As wide as it will get, so that what follows stays in place.
    let (text, width) = match (document.goal.stop, document.goal.passes) {
        (Stop::Passes, limit) => {
            let width = 2 * limit.to_string().len() + " /  passes".len();
            (format!("{passes} / {limit} passes"), width)
        }
        _ if passes == 1 => ("1 pass".to_owned(), "9999 passes".len()),
        _ => (format!("{passes} passes"), "9999 passes".len()),
    };
    figure(
        ui,
        format!("{text:<width$}"),
        "Whole passes traced, of the limit: every pixel has at least this many samples.",
    );
    let Some(snapshot) = facts.snapshot else { return };
    nonfinite(ui, snapshot);
    let state = match &snapshot.state {
        State::Failed(_) => "failed",
        _ if facts.done => "done",
        State::Paused => "paused",
        State::Running if document.paused => "paused",
        State::Running | State::Done => "",
    };
    if !state.is_empty() {
        ui.label(RichText::new(state).strong());
    }
    let error = snapshot.error.map_or("-".to_owned(), error);
    let seconds = snapshot.seconds;
    let rate = if seconds > 0.0 { snapshot.counts.paths as f64 / seconds } else { 0.0 };
    let rate = format!("{} paths/s", short(rate));
    let latency = facts.latency.map_or("-".to_owned(), |l| format!("{:.0}", l.as_secs_f64() * 1e3));
    let figures = [
        (
            format!("rel. error {error:<23}"),
            "sqrt(mean((x - r)\u{b2} / (r\u{b2} + 0.01))) over pixels and channels, r being the truth, \
             with its 95 % limits, estimated from independent replicates. \"-\" until they allow an \
             estimate, \"?\" while it can't be relied on: under 32 passes, or a handful of pixels \
             owns the error because their bright samples are rare.",
        ),
        (
            format!("{:<16}", document.goal.ahead(snapshot)),
            "What tracing stops at, and in how many seconds of tracing that is expected: from the \
             paths traced, or from the error's upper 95 % limit, falling with the square root of \
             the passes. \"-\" while it can't be told.",
        ),
        (format!("{rate:<15}"), "Camera paths a second since the first pass."),
        (format!("{latency} ms"), "From the last change to its first pixels."),
    ];
    for (text, tip) in figures {
        if !figure(ui, text, tip) {
            break;
        }
    }
}

/// 1.81 % (1.70 to 1.95 %), or 1.8 % ? while it is not reliable.
fn error(error: ErrorEstimate) -> String {
    let Interval { low, high } = error.relative.interval;
    let value = percent(error.relative.value);
    if !error.reliable {
        return format!("{value} ?");
    }
    format!("{value} ({} to {})", percent(low).trim_end_matches(" %"), percent(high))
}

fn nonfinite(ui: &mut Ui, snapshot: &Snapshot) {
    let count = snapshot.counts.nonfinite;
    if count == 0 {
        return;
    }
    let plural = if count == 1 { "" } else { "s" };
    let text = RichText::new(format!("{count} sample{plural} not finite"));
    ui.add(Label::new(text.color(ui.visuals().error_fg_color))).on_hover_text(
        "Samples that were NaN or infinite. They are left out of the sums, so their pixels are \
         wrong. This is a fault of burnish: please report it with the scene.",
    );
}

fn scene(ui: &mut Ui, document: &Document) {
    let [w, h] = document.params.size;
    figure(ui, format!("{w} x {h}"), "Width and height of the picture in pixels.");
    let name = document.params.scene.name();
    // A long name gives way to the progress.
    ui.scope(|ui| {
        ui.set_max_width(ui.available_width().min(240.0));
        ui.add(Label::new(name).truncate()).on_hover_text(name);
    });
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

/// A text with a tooltip, if there is room for all of it; whether there was.
fn figure(ui: &mut Ui, text: String, tip: &str) -> bool {
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text, font, Color32::PLACEHOLDER);
    let fits = galley.size().x <= ui.available_width();
    if fits {
        ui.add(Label::new(galley)).on_hover_text(tip);
    }
    fits
}

#[cfg(test)]
mod tests {
    use super::*;
    use burnish::progressive::{Counts, Figure, TileGrid};
    use burnish::scene::{Report, SceneBuilder};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use std::sync::Arc;

    /// The words of the line for a snapshot.
    fn words(width: f32, change: impl FnOnce(&mut Snapshot)) -> Vec<String> {
        let scene = Arc::new(SceneBuilder::new("empty.scn").build());
        let loaded = crate::viewer::jobs::load::Loaded {
            scene,
            report: Report::default(),
            source: Default::default(),
            again: false,
            files: Vec::new(),
        };
        let document = Document::open(loaded, None, Default::default());
        let mut snapshot = Snapshot {
            epoch: 1,
            grid: TileGrid { size: [640, 480] },
            tiles: Vec::new(),
            dirty: Vec::new(),
            passes: 12,
            whole: true,
            counts: Counts { paths: 3_000_000, ..Counts::default() },
            error: None,
            seconds: 2.0,
            group: burnish::trace::Group::None,
            state: State::Running,
        };
        change(&mut snapshot);
        let line = |ui: &mut Ui| {
            let (document, snapshot) = (Some(&document), Some(&snapshot));
            let done = snapshot.is_some_and(|s| s.state == State::Done);
            let facts = Facts { document, snapshot, done, latency: None, loading: None };
            Status.ui(ui, &facts);
        };
        let harness = Harness::builder().with_size([width, 28.0]).build_ui(line);
        let labels = harness.get_all_by_role(egui::accesskit::Role::Label);
        labels.filter_map(|node| node.value()).map(|text| text.trim_end().to_owned()).collect()
    }

    #[test]
    fn what_is_not_known_is_not_told() {
        let words = words(1200.0, |_| {});
        for expected in [
            "12 / 1024 passes",
            "rel. error -",
            "done in 3 min",
            "1.50 M paths/s",
            "- ms",
            "640 x 480",
        ] {
            assert!(words.iter().any(|w| w == expected), "{expected}: {words:?}");
        }
    }

    fn one_percent(reliable: bool) -> ErrorEstimate {
        let figure = Figure { value: 1e-2, interval: Interval { low: 0.9e-2, high: 1.2e-2 } };
        ErrorEstimate { rel_mse: figure, relative: figure, rmse: figure, terms: 99.0, reliable }
    }

    #[test]
    fn an_error_that_is_not_reliable_is_doubted() {
        let words = words(1200.0, |s| s.error = Some(one_percent(false)));
        assert!(words.iter().any(|w| w == "rel. error 1.00 % ?"), "{words:?}");
    }

    #[test]
    fn states_errors_and_faults_are_told() {
        let words = words(1200.0, |s| {
            s.state = State::Done;
            s.error = Some(one_percent(true));
            s.counts.nonfinite = 3;
        });
        for expected in ["done", "rel. error 1.00 % (0.90 to 1.20 %)", "3 samples not finite"] {
            assert!(words.iter().any(|w| w == expected), "{expected}: {words:?}");
        }
    }

    #[test]
    fn what_has_no_room_is_left_out_from_the_end() {
        let words = words(460.0, |_| {});
        assert!(words.iter().any(|w| w == "12 / 1024 passes"), "{words:?}");
        assert!(words.iter().any(|w| w == "empty.scn"), "{words:?}");
        assert!(!words.iter().any(|w| w.ends_with("paths/s")), "{words:?}");
    }
}
