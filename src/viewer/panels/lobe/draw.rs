//! Curves over angle by egui's painter, over a line of angles or around a point.

use crate::viewer::style::labels;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::brdf::Model;
use burnish::measure::lobe::{LobeAxis, LobeCurves, value};
use burnish::measure::plot::Style;
use std::ops::Range;

use egui::{
    Align2, EventFilter, Key, Modifiers, Painter, Pos2, Rect, Role, Sense, Shape, Stroke,
    TextStyle, Ui, Visuals, WidgetInfo, pos2, vec2,
};

/// Height of the whole plot, in points.
pub(super) const HEIGHT: f32 = 176.0;
/// Room for the values' words at the left, the angles' below, half of the last at the right, and a
/// line above.
const LEFT: f32 = 40.0;
const RIGHT: f32 = 12.0;
const BELOW: f32 = 20.0;
const ABOVE: f32 = 16.0;
/// Step of one press of an arrow key, in degrees.
const STEP: f64 = 1.0;

/// The line of a model's curve.
pub(super) fn stroke(visuals: &Visuals, model: Model, shown: bool) -> Stroke {
    Stroke::new(if shown { 2.5 } else { 1.25 }, theme::model(visuals, model))
}

/// Draws the curves. The cursor follows the pointer, or the arrow keys while the plot has the focus;
/// it is none otherwise. Returns the plot's place.
pub(super) fn plot(
    ui: &mut Ui,
    curves: &LobeCurves,
    style: Style,
    shown: Model,
    cursor: &mut Option<f64>,
) -> Rect {
    let size = vec2(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = labels::CURVES.name;
    response.widget_info(|| WidgetInfo::labeled(Role::Image, ui.is_enabled(), name));
    let frame = Frame::new(ui, rect, curves, style);
    let pointed = response.hover_pos().and_then(|at| frame.angle(at));
    *cursor = match (pointed, response.has_focus()) {
        (Some(angle), _) => Some(angle),
        (None, true) => Some(arrows(ui, response.id, cursor.unwrap_or(super::resting(curves)))),
        (None, false) => None,
    };
    frame.grid();
    frame.curves(shown);
    if let Some(angle) = *cursor {
        frame.cursor(angle);
    }
    if response.has_focus() {
        widgets::focus_frame(ui, rect);
    }
    rect
}

/// Moves the cursor by the arrow keys, which then do not take the focus away.
fn arrows(ui: &Ui, id: egui::Id, angle: f64) -> f64 {
    let filter = EventFilter { horizontal_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(id, filter));
    let presses = ui.input_mut(|i| {
        let count = |i: &mut egui::InputState, key| i.count_and_consume_key(Modifiers::NONE, key);
        count(i, Key::ArrowRight) as f64 - count(i, Key::ArrowLeft) as f64
    });
    let limit = LobeCurves::LIMIT;
    (angle + (STEP * presses).to_radians()).clamp(-limit, limit)
}

/// Map from angles and values to the screen.
struct Frame<'a> {
    painter: Painter,
    visuals: &'a Visuals,
    curves: &'a LobeCurves,
    axis: LobeAxis,
    font: egui::FontId,
    place: Place,
}

enum Place {
    Cartesian(Rect),
    /// Centre and radius.
    Polar(Pos2, f32),
}

impl<'a> Frame<'a> {
    fn new(ui: &'a Ui, rect: Rect, curves: &'a LobeCurves, style: Style) -> Frame<'a> {
        let place = if style.polar {
            let radius = (rect.height() - BELOW - ABOVE).min(rect.width() / 2.0 - ABOVE);
            Place::Polar(pos2(rect.center().x, rect.bottom() - BELOW), radius)
        } else {
            let min = rect.min + vec2(LEFT, ABOVE);
            Place::Cartesian(Rect::from_min_max(min, rect.max - vec2(RIGHT, BELOW)))
        };
        Frame {
            painter: ui.painter_at(rect),
            visuals: ui.visuals(),
            curves,
            axis: curves.axis(style.log),
            font: TextStyle::Small.resolve(ui.style()),
            place,
        }
    }

    /// Place of a share of the scale at an angle.
    fn at(&self, angle: f64, share: f64) -> Pos2 {
        match self.place {
            Place::Cartesian(rect) => {
                let x = (angle.to_degrees() + 90.0) / 180.0;
                pos2(
                    rect.left() + rect.width() * x as f32,
                    rect.bottom() - rect.height() * share as f32,
                )
            }
            Place::Polar(centre, radius) => {
                let (sin, cos) = angle.sin_cos();
                centre + vec2(sin as f32, -cos as f32) * (radius * share as f32)
            }
        }
    }

    /// The angle at a point of the screen, unless it is beside the curves.
    fn angle(&self, at: Pos2) -> Option<f64> {
        let angle = match self.place {
            Place::Cartesian(rect) => {
                let x = f64::from((at.x - rect.left()) / rect.width());
                (180.0 * x - 90.0).to_radians()
            }
            Place::Polar(centre, _) => {
                let to = at - centre;
                if to.y > 0.0 {
                    return None;
                }
                f64::from(to.x.atan2(-to.y))
            }
        };
        (-LobeCurves::LIMIT..=LobeCurves::LIMIT).contains(&angle).then_some(angle)
    }

    fn grid(&self) {
        let line = self.visuals.widgets.noninteractive.bg_stroke;
        let weak = self.visuals.weak_text_color();
        let write = |at: Pos2, align: Align2, text: String| {
            self.painter.text(at, align, text, self.font.clone(), weak);
        };
        let ticks = self.axis.ticks();
        for (i, &tick) in ticks.iter().enumerate() {
            let share = self.axis.share(tick);
            match self.place {
                Place::Cartesian(rect) => {
                    let at = self.at(-std::f64::consts::FRAC_PI_2, share);
                    self.painter.hline(rect.x_range(), at.y, line);
                    write(at - vec2(6.0, 0.0), Align2::RIGHT_CENTER, round(tick));
                }
                Place::Polar(..) => {
                    let arc = (-90..=90).step_by(3);
                    let arc = arc.map(|d| self.at(f64::from(d).to_radians(), share));
                    self.painter.add(Shape::line(arc.collect(), line));
                    // Words of the outer rings only, or they would run into each other.
                    if i + 1 == ticks.len() || (i > 0 && 2 * i + 1 == ticks.len()) {
                        let at = self.at(std::f64::consts::FRAC_PI_2, share);
                        write(at + vec2(0.0, 4.0), Align2::CENTER_TOP, round(tick));
                    }
                }
            }
        }
        for degrees in (-90i32..=90).step_by(30) {
            let angle = f64::from(degrees).to_radians();
            let ends = [self.at(angle, 0.0), self.at(angle, 1.0)];
            self.painter.line_segment(ends, line);
            match self.place {
                Place::Cartesian(_) => {
                    write(ends[0] + vec2(0.0, 4.0), Align2::CENTER_TOP, format!("{degrees}\u{b0}"))
                }
                Place::Polar(..) if degrees.abs() < 90 => {
                    let at = self.at(angle, 1.0 + 10.0 / self.radius());
                    write(at, Align2::CENTER_CENTER, format!("{degrees}\u{b0}"));
                }
                Place::Polar(..) => {}
            }
        }
        self.viewer();
    }

    fn radius(&self) -> f64 {
        match self.place {
            Place::Cartesian(rect) => rect.height().into(),
            Place::Polar(_, radius) => radius.max(1.0).into(),
        }
    }

    /// Draws the viewer's and the mirror direction.
    fn viewer(&self) {
        if !self.curves.quantity.has_viewer() {
            return;
        }
        let weak = self.visuals.weak_text_color();
        let theta = self.curves.theta_o;
        for (angle, word) in [(-theta, "wo"), (theta, "mirror")] {
            let ends = [self.at(angle, 0.0), self.at(angle, 1.0)];
            let dashes = Shape::dashed_line(&ends, Stroke::new(1.0, weak), 3.0, 3.0);
            self.painter.extend(dashes);
            if let Place::Cartesian(_) = self.place {
                let align = if angle < 0.0 { Align2::RIGHT_BOTTOM } else { Align2::LEFT_BOTTOM };
                let at = ends[1] - vec2(0.0, 2.0);
                self.painter.text(at, align, word, self.font.clone(), weak);
            }
        }
    }

    /// The one that is shown last, over the others.
    fn curves(&self, shown: Model) {
        let all = Model::ALL.into_iter().zip(&self.curves.values);
        let (last, first): (Vec<_>, Vec<_>) = all.partition(|(model, _)| *model == shown);
        for (model, values) in first.into_iter().chain(last) {
            let stroke = stroke(self.visuals, model, model == shown);
            for run in runs(values, self.axis.low) {
                let points =
                    run.map(|i| self.at(self.curves.angles[i], self.axis.share(values[i])));
                self.painter.add(Shape::line(points.collect(), stroke));
            }
        }
    }

    fn cursor(&self, angle: f64) {
        let line = Stroke::new(1.0, self.visuals.strong_text_color());
        self.painter.line_segment([self.at(angle, 0.0), self.at(angle, 1.0)], line);
        let LobeCurves { quantity, channel, theta_o, .. } = *self.curves;
        for model in Model::ALL {
            let share = self.axis.share(value(model, quantity, channel, theta_o, angle));
            let colour = theme::model(self.visuals, model);
            self.painter.circle_filled(self.at(angle, share), 3.0, colour);
        }
    }
}

/// The parts of a curve that are above the low end of the scale, each with the point before and after,
/// which are drawn at that end: nothing runs along it that is not there.
fn runs(values: &[f64], low: f64) -> Vec<Range<usize>> {
    let above = |i: &usize| values[*i] > low;
    let mut runs: Vec<Range<usize>> = Vec::new();
    for i in (0..values.len()).filter(above) {
        match runs.last_mut() {
            Some(run) if run.end >= i => run.end = i + 2,
            _ => runs.push(i.saturating_sub(1)..i + 2),
        }
    }
    if let Some(last) = runs.last_mut() {
        last.end = last.end.min(values.len());
    }
    runs
}

/// A tick's value, short: 0, 0.5, 20, 1e-6.
fn round(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if (1e-3..1e5).contains(&v.abs()) => {
            let text = format!("{v:.6}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        v => format!("{v:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{round, runs};

    #[test]
    fn curves_end_at_the_low_end_of_the_scale() {
        let values = [0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.2];
        assert_eq!(runs(&values, 0.1), [1..5, 6..8]);
        let all = 0..3;
        assert_eq!(runs(&[0.3, 0.0, 0.3], 0.1), [all]);
        assert!(runs(&[0.0; 4], 0.1).is_empty());
    }

    #[test]
    fn ticks_are_short() {
        let shown = [0.0, 0.5, 20.0, 1e-6, 1e6, 0.001, 1000.0].map(round);
        assert_eq!(shown, ["0", "0.5", "20", "1e-6", "1e6", "0.001", "1000"]);
    }
}
