//! The one line of figures below the picture.

use crate::viewer::document::Document;
use crate::viewer::document::goal::Stop;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::picture::canvas::Hover;
use crate::viewer::style::numbers::{digits, percent, short};
use crate::viewer::style::theme;
use burnish::progressive::{ErrorEstimate, Interval, Snapshot, State};
use egui::{Align, Color32, Label, Layout, Rect, RichText, Ui, UiBuilder};

#[derive(Default)]
pub(crate) struct Status;

impl Panel for Status {
    /// Draws the scene at the right, the progress at the left. What there is no room for is left out, the
    /// least important first.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, _: &mut Vec<Action>) {
        let row = ui.max_rect();
        let right = group(ui, row, Layout::right_to_left(Align::Center), |ui| {
            scene(ui, document);
            warnings(ui, document);
        })
        .left();
        let rest = Rect::from_min_max(row.min, egui::pos2(right - theme::GROUP, row.bottom()));
        group(ui, rest, Layout::left_to_right(Align::Center), |ui| {
            reading(ui, document.live.loading.as_deref());
            progress(ui, document);
        });
    }
}

/// Draws the line where there is no document yet.
pub(crate) fn empty(ui: &mut Ui, loading: Option<&str>) {
    let row = ui.max_rect();
    let space = Rect::from_min_max(row.min, egui::pos2(row.right() - theme::GROUP, row.bottom()));
    group(ui, space, Layout::left_to_right(Align::Center), |ui| reading(ui, loading));
}

fn reading(ui: &mut Ui, loading: Option<&str>) {
    if let Some(name) = loading {
        ui.add(Label::new(format!("Reading {name} ...")).truncate());
    }
}

/// Draws into a part of the line; returns the part used.
fn group(ui: &mut Ui, space: Rect, layout: Layout, body: impl FnOnce(&mut Ui)) -> Rect {
    let mut ui = ui.new_child(UiBuilder::new().max_rect(space).layout(layout));
    ui.spacing_mut().item_spacing.x = theme::GROUP;
    body(&mut ui);
    ui.min_rect()
}

fn progress(ui: &mut Ui, document: &Document) {
    let live = &document.live;
    let passes = live.newest.as_ref().map_or(0, |s| s.passes);
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
    let Some(snapshot) = live.newest.as_deref() else { return };
    nonfinite(ui, snapshot);
    let state = match &snapshot.state {
        State::Failed(_) => "failed",
        _ if live.is_done => "done",
        State::Paused => "paused",
        State::Running if document.paused => "paused",
        State::Running | State::Done => "",
    };
    if !state.is_empty() {
        ui.label(RichText::new(state).strong());
    }
    let error = snapshot.error.map_or("-".to_owned(), error);
    let error = format!("rel. error {error:<23}");
    if let Some(hover) = &live.hover {
        // The error stays where both have room; what may change with every pixel gives way.
        let full = &hovered(hover, snapshot.grid.size)[0];
        let gap = ui.spacing().item_spacing.x;
        if width_of(ui, &error) + gap + width_of(ui, full) <= ui.available_width() {
            figure(ui, error, ERROR_TIP);
        }
        return pixel(ui, hover, snapshot.grid.size);
    }
    let seconds = snapshot.seconds;
    let rate = if seconds > 0.0 { snapshot.counts.paths as f64 / seconds } else { 0.0 };
    let rate = format!("{} paths/s", short(rate));
    let latency = live.latency.map_or("-".to_owned(), |l| format!("{:.0}", l.as_secs_f64() * 1e3));
    let figures = [
        (error, ERROR_TIP),
        (
            format!("{:<19}", document.goal.ahead(snapshot, live.outlook)),
            "What tracing stops at, and in how many seconds of tracing that is expected: from the \
             paths traced, or, for an error, from how its upper 95 % limit has fallen so far, and \
             beyond that with the square root of the passes, up to the pass at which it is looked \
             at. \"?\" while too little of its fall is seen, and the square root is supposed; \"-\" \
             while it can't be told.",
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

const ERROR_TIP: &str = "sqrt(mean((x - r)\u{b2} / (r\u{b2} + 0.01))) over pixels and channels, r being the truth, with \
     its 95 % limits, estimated from independent replicates. \"-\" until they allow an estimate, \
     \"?\" while it can't be relied on: under 32 passes, or a handful of pixels owns the error \
     because their bright samples are rare.";

/// The pixel under the pointer, at as great a length as there is room for.
fn pixel(ui: &mut Ui, hover: &Hover, size: [u32; 2]) {
    let tip = "The pixel under the pointer: column and row, linear Rec. 709 radiance in \
               W/(m\u{b2} sr), its standard error, and its own number of samples.";
    let _ = hovered(hover, size).into_iter().any(|words| figure(ui, words, tip));
}

/// Words about a pixel, from the longest to the shortest. Its columns are as wide as they get,
/// so that nothing moves from pixel to pixel.
pub(crate) fn hovered(hover: &Hover, size: [u32; 2]) -> [String; 3] {
    let [x, y] = hover.pixel;
    let [w, h] = size.map(|side| side.to_string().len());
    let triple = |c: [f32; 3], digits_of: usize| {
        c.map(|v| format!("{:>8}", digits(f64::from(v), digits_of))).concat()
    };
    let least = format!("({x:>w$}, {y:>h$})  RGB {}", triple(hover.mean, 3));
    let most = hover.standard_error.map(|c| c.iter().copied().fold(0.0, f32::max));
    let largest = most.map_or("-".to_owned(), |e| digits(e.into(), 2));
    let error = hover.standard_error.map_or(format!("{:>24}", "-"), |c| triple(c, 2));
    let samples = match hover.samples {
        0 if hover.passes == 0 => "preview".to_owned(),
        1 => "1 sample".to_owned(),
        n => format!("{n} samples"),
    };
    [format!("{least} \u{b1}{error}  {samples:>15}"), format!("{least} \u{b1} {largest:>7}"), least]
}

/// Width of a text in the line, in points.
fn width_of(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER).size().x
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
        let mut document = Document::open(loaded, None, Default::default());
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
            group: burnish::trace::ReuseGroup::None,
            state: State::Running,
        };
        change(&mut snapshot);
        document.live.is_done = snapshot.state == State::Done;
        document.live.newest = Some(Arc::new(snapshot));
        let mut has_fonts = false;
        let line = |ui: &mut Ui| {
            if has_fonts {
                return Status.ui(ui, &mut document, &mut Vec::new());
            }
            // They are there from the next frame on.
            ui.ctx().set_fonts(theme::fonts());
            ui.ctx().request_repaint();
            has_fonts = true;
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
    fn a_pixel_s_radiance_error_and_samples_are_told_as_far_as_they_are_known() {
        let known = Hover {
            pixel: [42, 24],
            mean: [0.5, 12.25, 0.0],
            standard_error: Some([0.001, 0.25, 0.0]),
            passes: 16,
            samples: 21,
        };
        let words = |hover: &Hover| {
            let texts = hovered(hover, [640, 480]);
            texts.map(|t| t.split_whitespace().collect::<Vec<_>>().join(" "))
        };
        let [full, short, least] = words(&known);
        assert_eq!(full, "( 42, 24) RGB 0.500 12.2 0 \u{b1} 0.0010 0.25 0 21 samples");
        assert_eq!(short, "( 42, 24) RGB 0.500 12.2 0 \u{b1} 0.25");
        assert_eq!(least, "( 42, 24) RGB 0.500 12.2 0");
        let preview = Hover { standard_error: None, passes: 0, samples: 0, ..known };
        assert_eq!(words(&preview)[0], "( 42, 24) RGB 0.500 12.2 0 \u{b1} - preview");
        // Columns stay in place whatever the numbers are.
        let other = Hover {
            pixel: [639, 0],
            mean: [1.234e-7, 123_456.0, 1e18],
            standard_error: Some([1.5e-9, 3e20, 0.000_123]),
            samples: 1_048_576,
            ..known
        };
        let lengths = |hover: &Hover| hovered(hover, [640, 480]).map(|t| t.chars().count());
        assert_eq!(lengths(&known), lengths(&other));
        assert_eq!(lengths(&known), lengths(&preview));
    }

    #[test]
    fn what_has_no_room_is_left_out_from_the_end() {
        let words = words(460.0, |_| {});
        assert!(words.iter().any(|w| w == "12 / 1024 passes"), "{words:?}");
        assert!(words.iter().any(|w| w == "empty.scn"), "{words:?}");
        assert!(!words.iter().any(|w| w.ends_with("paths/s")), "{words:?}");
    }
}
