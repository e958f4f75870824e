//! Errors over seconds by egui's painter, both logarithmic.

use super::Row;
use super::axes::Axis;
use crate::viewer::document::errors::{Curve, Point};
use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::progressive::Params;
use egui::epaint::Mesh;
use egui::{
    Align2, Color32, EventFilter, FontId, Key, Modifiers, Painter, Pos2, Rect, Role, Sense, Shape,
    Stroke, TextStyle, Ui, Visuals, WidgetInfo, pos2, vec2,
};

/// Height of the whole plot, in points.
const HEIGHT: f32 = 188.0;
/// Room for the errors' words at the left, the times' below, half of the last at the right, and the
/// axis's name above.
const LEFT: f32 = 40.0;
const RIGHT: f32 = 12.0;
const BELOW: f32 = 20.0;
const ABOVE: f32 = 24.0;
/// One press of an arrow key goes so far along the axis.
const STEP: f64 = 0.02;

/// Curves to draw.
pub(super) struct Plot<'a> {
    pub(super) rows: &'a [Row<'a>],
    pub(super) shown: &'a Params,
    /// The error that is wished for.
    pub(super) goal: Option<f64>,
}

/// The line of a curve: the shown one's is the boldest, those of other materials are faint.
pub(super) fn stroke(visuals: &Visuals, row: &Row, shown: &Params) -> Stroke {
    let colour = theme::model(visuals, row.params.model);
    match row.is_like(shown) {
        true if row.params == *shown => Stroke::new(2.5, colour),
        true => Stroke::new(1.25, colour),
        false => Stroke::new(1.25, faint(visuals, colour)),
    }
}

/// Half of the way to the ground.
fn faint(visuals: &Visuals, colour: Color32) -> Color32 {
    colour.lerp_to_gamma(visuals.panel_fill, 0.5)
}

/// A line through points; nothing for fewer than two.
pub(super) fn line(painter: &Painter, points: &[Pos2], stroke: Stroke) {
    if points.len() >= 2 {
        painter.add(Shape::line(points.to_vec(), stroke));
    }
}

impl Plot<'_> {
    /// Draws it. The cursor follows the pointer, or the arrow keys while the plot has the focus; it
    /// is none otherwise. Returns the plot's place.
    pub(super) fn draw(&self, ui: &mut Ui, cursor: &mut Option<f64>) -> Rect {
        let size = vec2(ui.available_width(), HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let name = labels::ERROR_CURVES.name;
        response.widget_info(|| WidgetInfo::labeled(Role::Image, ui.is_enabled(), name));
        let inner = Rect::from_min_max(rect.min + vec2(LEFT, ABOVE), rect.max - vec2(RIGHT, BELOW));
        let Some(frame) = self.frame(ui, rect, inner) else {
            *cursor = None;
            let line = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().rect_stroke(inner, 0.0, line, egui::StrokeKind::Inside);
            return rect;
        };
        let pointed = response.hover_pos().filter(|at| frame.inner.x_range().contains(at.x));
        *cursor = match (pointed, response.has_focus()) {
            (Some(at), _) => Some(frame.seconds(at.x)),
            (None, true) => Some(frame.arrows(ui, response.id, *cursor)),
            (None, false) => None,
        };
        frame.grid();
        self.goal(&frame);
        self.guide(&frame);
        self.curves(&frame);
        if let Some(seconds) = *cursor {
            self.cursor(&frame, seconds);
        }
        if response.has_focus() {
            widgets::focus_frame(ui, rect);
        }
        rect
    }

    fn frame<'u>(&self, ui: &'u Ui, rect: Rect, inner: Rect) -> Option<Frame<'u>> {
        let curves = || self.rows.iter().filter_map(|row| row.curve);
        let points = || curves().flat_map(|c| [&c.estimated, &c.truth]).flat_map(|h| h.points());
        let x = Axis::over(points().map(|p| p.seconds))?;
        let y = Axis::over(points().map(|p| p.error).chain(self.goal))?;
        Some(Frame {
            painter: ui.painter_at(rect),
            within: ui.painter_at(inner.expand(1.5).intersect(rect)),
            visuals: ui.visuals(),
            font: TextStyle::Small.resolve(ui.style()),
            inner,
            x,
            y,
        })
    }

    fn newest(&self) -> Option<&Point> {
        let row = self.rows.iter().find(|row| row.params == *self.shown)?;
        row.curve?.estimated.newest()
    }

    /// The error that is wished for.
    fn goal(&self, frame: &Frame) {
        let Some(goal) = self.goal else { return };
        let colour = theme::accent_of(frame.visuals);
        let [from, to] = frame.x.ends().map(|x| frame.at(x, goal));
        frame.within.line_segment([from, to], Stroke::new(1.0, colour));
        frame.write(from + vec2(4.0, -2.0), Align2::LEFT_BOTTOM, "goal", colour);
    }

    /// The line through the newest point along which errors of independent samples fall.
    fn guide(&self, frame: &Frame) {
        let Some(newest) = self.newest() else { return };
        let weak = frame.visuals.weak_text_color();
        let error = |seconds: f64| newest.error * (newest.seconds / seconds).sqrt();
        let [from, to] = frame.x.ends().map(|x| frame.at(x, error(x)));
        let dashes = Shape::dashed_line(&[from, to], Stroke::new(1.0, weak), 4.0, 4.0);
        frame.within.extend(dashes);
        frame.write(
            pos2(frame.inner.right(), frame.inner.top() - 8.0),
            Align2::RIGHT_BOTTOM,
            "dashed: slope -1/2",
            weak,
        );
    }

    /// The shown one last, over the others.
    fn curves(&self, frame: &Frame) {
        let is_shown = |row: &&Row| row.params == *self.shown;
        let (last, first): (Vec<_>, Vec<_>) = self.rows.iter().partition(is_shown);
        for row in first.into_iter().rev().chain(last) {
            let Some(curve) = row.curve else { continue };
            let stroke = stroke(frame.visuals, row, self.shown);
            if row.params == *self.shown {
                frame.band(curve, stroke.color);
            }
            frame.estimate(curve, stroke);
            frame.truth(curve, stroke);
        }
    }

    fn cursor(&self, frame: &Frame, seconds: f64) {
        let x = frame.at(seconds, 1.0).x;
        let colour = frame.visuals.strong_text_color();
        frame.within.vline(x, frame.inner.y_range(), Stroke::new(1.0, colour));
        for row in self.rows {
            let Some(curve) = row.curve else { continue };
            let colour = stroke(frame.visuals, row, self.shown).color;
            let values = [&curve.estimated, &curve.truth].map(|history| history.at(seconds));
            for error in values.into_iter().flatten() {
                frame.within.circle_filled(frame.at(seconds, error), 3.0, colour);
            }
        }
    }
}

/// Map from times and errors to the screen.
struct Frame<'a> {
    painter: Painter,
    /// Draws between the axes alone.
    within: Painter,
    visuals: &'a Visuals,
    font: FontId,
    inner: Rect,
    x: Axis,
    y: Axis,
}

impl Frame<'_> {
    fn at(&self, seconds: f64, error: f64) -> Pos2 {
        pos2(
            self.inner.left() + self.inner.width() * self.x.share(seconds) as f32,
            self.inner.bottom() - self.inner.height() * self.y.share(error) as f32,
        )
    }

    fn seconds(&self, x: f32) -> f64 {
        self.x.value(f64::from((x - self.inner.left()) / self.inner.width()))
    }

    /// Moves the cursor by the arrow keys, which then do not take the focus away.
    fn arrows(&self, ui: &Ui, id: egui::Id, cursor: Option<f64>) -> f64 {
        let filter = EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(id, filter));
        let presses = ui.input_mut(|i| {
            let count =
                |i: &mut egui::InputState, key| i.count_and_consume_key(Modifiers::NONE, key);
            count(i, Key::ArrowRight) as f64 - count(i, Key::ArrowLeft) as f64
        });
        let share = cursor.map_or(0.5, |seconds| self.x.share(seconds));
        self.x.value((share + STEP * presses).clamp(0.0, 1.0))
    }

    fn write(&self, at: Pos2, align: Align2, words: impl ToString, colour: Color32) {
        self.painter.text(at, align, words, self.font.clone(), colour);
    }

    fn grid(&self) {
        let line = self.visuals.widgets.noninteractive.bg_stroke;
        let weak = self.visuals.weak_text_color();
        for error in self.y.ticks() {
            let at = self.at(self.x.ends()[0], error);
            self.painter.hline(self.inner.x_range(), at.y, line);
            let words = format!("{} %", short(100.0 * error));
            self.write(at - vec2(6.0, 0.0), Align2::RIGHT_CENTER, words, weak);
        }
        // Words that would run into the one before are left out.
        let mut free = f32::NEG_INFINITY;
        for seconds in self.x.ticks() {
            let at = self.at(seconds, self.y.ends()[0]);
            self.painter.vline(at.x, self.inner.y_range(), line);
            let words = format!("{} s", short(seconds));
            let galley = self.painter.layout_no_wrap(words, self.font.clone(), weak);
            let left =
                (at.x - galley.size().x / 2.0).min(self.inner.right() + RIGHT - galley.size().x);
            if left >= free {
                free = left + galley.size().x + 6.0;
                self.painter.galley(pos2(left, at.y + 4.0), galley, weak);
            }
        }
        let top = self.inner.left_top() - vec2(LEFT, 8.0);
        self.write(top, Align2::LEFT_BOTTOM, "relative error", weak);
    }

    /// Draws the 95 % limits, as far as they can be relied on.
    fn band(&self, curve: &Curve, colour: Color32) {
        let mut mesh = Mesh::default();
        let colour = colour.gamma_multiply(0.25);
        for point in curve.estimated.points().iter().filter(|p| p.reliable) {
            let next = mesh.vertices.len() as u32;
            for error in [point.limits.low, point.limits.high] {
                let lowest = self.y.ends()[0] * 1e-3;
                mesh.colored_vertex(self.at(point.seconds, error.max(lowest)), colour);
            }
            if next >= 2 {
                mesh.add_triangle(next - 2, next - 1, next);
                mesh.add_triangle(next - 1, next, next + 1);
            }
        }
        self.within.add(mesh);
    }

    /// Thin and faint before it can be relied on.
    fn estimate(&self, curve: &Curve, stroke: Stroke) {
        let points = curve.estimated.points();
        let on_screen = |points: &[Point]| -> Vec<Pos2> {
            points.iter().map(|p| self.at(p.seconds, p.error)).collect()
        };
        let first = points.iter().position(|p| p.reliable).unwrap_or(points.len());
        let doubtful = Stroke::new(1.0, faint(self.visuals, stroke.color));
        line(&self.within, &on_screen(&points[..(first + 1).min(points.len())]), doubtful);
        line(&self.within, &on_screen(&points[first..]), stroke);
        if let Some(newest) = points.last() {
            let at = self.at(newest.seconds, newest.error);
            self.within.circle_filled(at, 1.0 + stroke.width, stroke.color);
        }
    }

    fn truth(&self, curve: &Curve, stroke: Stroke) {
        let points = curve.truth.points().iter().map(|p| self.at(p.seconds, p.error));
        let points: Vec<Pos2> = points.collect();
        let thin = Stroke::new(1.5, stroke.color);
        self.within.extend(Shape::dotted_line(&points, thin.color, 5.0, thin.width));
        if let Some(newest) = points.last() {
            self.within.circle_stroke(*newest, 1.0 + stroke.width, thin);
        }
    }
}

/// A round number, short: 0.03, 1, 500, 1e6.
fn short(value: f64) -> String {
    match value {
        v if (1e-3..1e5).contains(&v) => {
            let text = format!("{v:.6}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        v => format!("{v:.0e}"),
    }
}
