//! The lobe at a surface and the directions that samples took there, side by side.

use crate::viewer::style::theme;
use burnish::brdf::Model;
use burnish::measure::lobe::{LobeAxis, LobeCurves};
use egui::{Align2, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, pos2, vec2};

const HEIGHT: f32 = 144.0;
/// Largest number of directions drawn.
const DOTS: usize = 2048;

/// At the left f cos in the plane of incidence around the surface's point, at the right directions
/// from above: the middle is the normal, the rim the horizon. The viewer is at the left in both.
pub(super) fn directions(ui: &mut Ui, curves: &LobeCurves, model: Model, taken: &[[f32; 3]]) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.on_hover_text(format!(
        "Left: f cos of {} in the plane of incidence. Right: {} sampled directions seen from \
         above; the middle is the normal, the rings are 30\u{b0} apart, {} ended below the \
         horizon. Circle: the viewer. Cross: the mirror direction.",
        model.title(),
        taken.len(),
        taken.iter().filter(|d| d[2] <= 0.0).count(),
    ));
    let half = rect.width() / 2.0;
    let left = Rect::from_min_size(rect.min, vec2(half - 4.0, HEIGHT));
    let right = Rect::from_min_max(pos2(rect.left() + half + 4.0, rect.top()), rect.max);
    lobe(ui, left, curves, model);
    from_above(ui, right, curves.theta_o, model, taken);
}

/// The lobe as a polar curve, as long as wide at its largest.
fn lobe(ui: &Ui, rect: Rect, curves: &LobeCurves, model: Model) {
    let painter = ui.painter_at(rect);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    let radius = (rect.width() / 2.0 - 2.0).min(rect.height() - 24.0);
    let centre = pos2(rect.center().x, rect.center().y + radius / 2.0);
    let at = |angle: f64, share: f64| {
        let (sin, cos) = angle.sin_cos();
        centre + vec2(sin as f32, -cos as f32) * (radius * share as f32)
    };
    for share in [0.5, 1.0] {
        let arc = (-90..=90).step_by(5).map(|d| at(f64::from(d).to_radians(), share));
        painter.add(Shape::line(arc.collect(), line));
    }
    painter.line_segment([at(-1.571, 1.0), at(1.571, 1.0)], line);
    let values = &curves.values[Model::ALL.iter().position(|&m| m == model).unwrap_or(0)];
    let high = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let axis = LobeAxis { low: 0.0, high, log: false };
    let points = curves.angles.iter().zip(values).map(|(&a, &v)| at(a, axis.share(v)));
    let colour = theme::model(ui.visuals(), model);
    painter.add(Shape::line(points.collect(), Stroke::new(2.0, colour)));
    marks(ui, &painter, at(-curves.theta_o, 1.0), at(curves.theta_o, 1.0));
    write(ui, &painter, rect, "f cos");
}

fn from_above(ui: &Ui, rect: Rect, theta_o: f64, model: Model, taken: &[[f32; 3]]) {
    let painter = ui.painter_at(rect);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    let radius = (rect.width() / 2.0 - 2.0).min(rect.height() / 2.0 - 10.0);
    let centre = pos2(rect.center().x, rect.top() + radius + 2.0);
    // Equal angles from the normal are equally far apart.
    let at = |theta: f32, x: f32, y: f32| {
        let across = x.hypot(y).max(f32::MIN_POSITIVE);
        let far = radius * theta / std::f32::consts::FRAC_PI_2;
        centre + vec2(x, -y) * (far / across)
    };
    for ring in 1..=3 {
        painter.circle_stroke(centre, radius * ring as f32 / 3.0, line);
    }
    let colour = theme::model(ui.visuals(), model).gamma_multiply(0.6);
    let above = taken.iter().filter(|d| d[2] > 0.0);
    for &[x, y, z] in above.step_by(taken.len().div_ceil(DOTS).max(1)) {
        painter.circle_filled(at(x.hypot(y).atan2(z), x, y), 1.0, colour);
    }
    let theta = theta_o as f32;
    marks(ui, &painter, at(theta, -1.0, 0.0), at(theta, 1.0, 0.0));
    write(ui, &painter, rect, &format!("{} directions", taken.len()));
}

/// The viewer's circle and the mirror direction's cross.
fn marks(ui: &Ui, painter: &egui::Painter, viewer: Pos2, mirror: Pos2) {
    let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
    painter.circle_stroke(viewer, 3.0, stroke);
    for (dx, dy) in [(3.0, 3.0), (3.0, -3.0)] {
        painter.line_segment([mirror - vec2(dx, dy), mirror + vec2(dx, dy)], stroke);
    }
}

fn write(ui: &Ui, painter: &egui::Painter, rect: Rect, words: &str) {
    let (font, weak) = (TextStyle::Small.resolve(ui.style()), theme::weak(ui));
    painter.text(rect.center_bottom(), Align2::CENTER_BOTTOM, words, font, weak);
}
