//! The section "Error over time": how the error of the picture, and of others of the same view, fell
//! while they were traced.

mod axes;
mod distance;
mod draw;
mod svg;

use crate::viewer::document::Document;
use crate::viewer::document::errors::{Curve, Curves, History, Point, csv, name};
use crate::viewer::document::goal::Stop;
use crate::viewer::jobs::save::{Plot, plain};
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::panels::export::{Content, Exports};
use crate::viewer::style::labels;
use crate::viewer::style::numbers::{digits, percent};
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Badge};
use burnish::brdf::Model;
use burnish::progressive::{Params, Snapshot};
#[cfg(test)]
pub(crate) use distance::Against;
use distance::Distances;
use egui::text::LayoutJob;
use egui::{Label, RichText, Sense, TextStyle, Ui, vec2};

/// Curves of other materials or methods than the shown ones that are drawn at most.
const OTHERS: usize = 4;
/// Height of the words on the numbers' origin, in points: two lines of small type.
const CAPTION: f32 = 30.0;

#[derive(Default)]
pub(crate) struct ErrorPanel {
    distances: Distances,
    /// The time whose values the table has, in seconds, while the pointer or the keyboard is there.
    cursor: Option<f64>,
    pub(crate) exports: Exports,
}

/// One line of the table, and of the plot where there is a curve.
struct Row<'a> {
    params: Params,
    curve: Option<&'a Curve>,
}

impl Panel for ErrorPanel {
    /// Costs nothing while it is closed.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        self.exports.receive(actions);
        let newest = document.live.current().cloned();
        let error = newest.as_ref().and_then(|s| s.error);
        let badge =
            error.map(|e| Badge { text: error_words(e.relative.value, e.reliable), warns: false });
        widgets::section(ui, "error", labels::ERRORS, badge, false, |ui| {
            self.distances.choose(ui, &document.comparison);
            let Document { params, errors, .. } = document;
            self.distances.ask(ui.ctx(), params, newest.as_deref(), errors);
            self.body(ui, document, newest.as_deref(), actions);
        });
    }
}

impl ErrorPanel {
    fn body(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        newest: Option<&Snapshot>,
        actions: &mut Vec<Action>,
    ) {
        let words = match newest.and_then(|s| s.error) {
            None => "No error is known before 4 passes.".to_owned(),
            Some(_) => self.distances.words(),
        };
        caption(ui, &words);
        let Document { params, errors: curves, .. } = document;
        let rows = rows(curves, params);
        let goal = (document.goal.stop == Stop::Error).then_some(document.goal.error);
        let plot = draw::Plot { rows: &rows, shown: params, goal };
        let place = plot.draw(ui, &mut self.cursor);
        let against = self.distances.is_chosen();
        table(ui, &rows, params, self.cursor, against);
        ui.add_space(theme::GAP);
        let stem = format!("errors_{}", plain(params.scene.name()));
        let controls = [&labels::ERROR_CSV, &labels::SAVE_SVG, &labels::SAVE_PNG];
        let content = |which| match which {
            0 => Content::Copied(csv(&curves.of_view(params), params)),
            _ => Content::File(Plot::Errors(svg::panel(&rows, params))),
        };
        self.exports.buttons(ui, controls, stem, place, content, actions);
    }
}

/// Small words in a place of their own; all of them where they are pointed at.
fn caption(ui: &mut Ui, words: &str) {
    let size = vec2(ui.available_width(), CAPTION);
    let font = TextStyle::Small.resolve(ui.style());
    let mut job = LayoutJob::simple(words.to_owned(), font, theme::weak(ui), size.x);
    job.wrap.max_rows = 2;
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.add(Label::new(job)).on_hover_text(format!("{words}\n\n{}", labels::ERROR_CAPTION));
    });
}

/// The three models with the materials that are shown, traced or not, and some of what else there is.
fn rows<'a>(curves: &'a Curves, shown: &Params) -> Vec<Row<'a>> {
    let models = Model::ALL.map(|model| Params { model, ..shown.clone() });
    let is_other = |c: &&&Curve| !models.contains(&c.params);
    let of_view = curves.of_view(shown);
    let others: Vec<Row> = of_view
        .iter()
        .filter(is_other)
        .take(OTHERS)
        .map(|c| Row { params: c.params.clone(), curve: Some(c) })
        .collect();
    let drawn = |c: &&Curve| !c.estimated.points().is_empty();
    let first = models.map(|params| Row { curve: curves.of(&params).filter(drawn), params });
    first.into_iter().chain(others).collect()
}

impl Row<'_> {
    /// Whether it is of the materials and the method that are shown.
    fn is_like(&self, shown: &Params) -> bool {
        self.params == Params { model: self.params.model, ..shown.clone() }
    }
}

/// 1.81 %, or 1.81 % ? while it cannot be relied on.
fn error_words(error: f64, reliable: bool) -> String {
    format!("{}{}", percent(error), if reliable { "" } else { " ?" })
}

/// The values at the cursor, or the newest.
fn table(ui: &mut Ui, rows: &[Row], shown: &Params, cursor: Option<f64>, against: bool) {
    let figure = |history: &History| {
        let newest = |p: &Point| error_words(p.error, p.reliable);
        let found = match cursor {
            Some(seconds) => history.at(seconds).map(percent),
            None => history.newest().map(newest),
        };
        found.unwrap_or("-".to_owned())
    };
    let head = cursor.map_or("newest".to_owned(), |s| format!("after {} s", digits(s, 3)));
    let second = if against { "true" } else { "traced" };
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.spacing_mut().interact_size.y = 16.0;
        let words = |ui: &mut Ui| {
            ui.label(RichText::new(head).small().weak());
        };
        let response = widgets::number_row(ui, words, ["estimated", second], true);
        response.on_hover_text(labels::ERROR_TABLE);
        for row in rows {
            let estimated = row.curve.map_or("-".to_owned(), |c| figure(&c.estimated));
            let newest = row.curve.and_then(|c| c.estimated.newest());
            let other = match against {
                true => row.curve.map_or("-".to_owned(), |c| figure(&c.truth)),
                false => newest.map_or("-".to_owned(), |p| format!("{} s", digits(p.seconds, 3))),
            };
            let name = name(&row.params, shown);
            let label = |ui: &mut Ui| {
                let (chip, _) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
                let ends = [chip.left_center(), chip.right_center()];
                draw::line(ui.painter(), &ends, draw::stroke(ui.visuals(), row, shown));
                let text = RichText::new(&name);
                let text = if row.params == *shown { text.strong() } else { text };
                ui.add(Label::new(text).truncate());
            };
            widgets::number_row(ui, label, [&estimated, &other], false);
        }
    });
}
