//! The brightest sample's path: a table, and a line over the picture.

use crate::viewer::style::labels;
use crate::viewer::style::numbers::digits;
use burnish::progressive::{Params, PixelReport};
use burnish::scene::Material;
use burnish::trace::{PathRecord, PathVertex};
use egui::{Align, Align2, Color32, Label, Layout, Pos2, Rect, RichText, Stroke, TextStyle, Ui};
use egui::{pos2, vec2};
use glam::DVec3;

/// Lines over the picture, within black ones: light enough for dark pictures in either theme.
const LINE: Color32 = Color32::from_rgb(0xff, 0xb8, 0x60);
/// Largest number of vertices listed; roulette ends most paths before.
const MOST: usize = 24;
/// Widths of the columns of figures, in points.
const FIGURE: f32 = 68.0;

pub(super) fn table(ui: &mut Ui, report: &PixelReport, materials: &[Material]) {
    let (pass, path) = &report.brightest;
    let value = f64::from(path.value.luminance());
    let mean = report.total.luminance.value;
    let times = if mean > 0.0 { value / mean } else { 0.0 };
    let words = format!("luminance {}, {} times the mean", digits(value, 3), digits(times, 3));
    ui.label(words).on_hover_text(format!(
        "Numbers of pass {pass} of the reference tracer: \"burnish pixel SCENE {} {} {pass} \
         --reference\" gives the same bits.",
        report.pixel[0], report.pixel[1]
    ));
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.spacing_mut().interact_size.y = 16.0;
        row(ui, RichText::new("vertex").small().weak(), ["beta", "adds"], true);
        for (i, vertex) in path.vertices.iter().take(MOST).enumerate() {
            let name = materials.get(vertex.material as usize).map_or("", |m| &m.name);
            let adds = vertex.emitted + vertex.direct;
            let figures = [vertex.beta, adds].map(|c| digits(c.luminance().into(), 3));
            let words = RichText::new(format!("{}  {name}", i + 1));
            row(ui, words, figures.each_ref().map(String::as_str), false)
                .on_hover_text(describe(vertex));
            let [x, y, z] = vertex.point.to_array().map(|x| digits(x, 4));
            let at = RichText::new(format!("    at {x}  {y}  {z}")).small().weak();
            ui.add(Label::new(at).truncate());
        }
        if path.vertices.len() > MOST {
            ui.weak(format!("and {} more", path.vertices.len() - MOST));
        }
        if let Some(escape) = path.escape {
            let found = digits(escape.found.luminance().into(), 3);
            row(ui, RichText::new("environment"), ["", &found], false);
        }
    });
}

fn describe(vertex: &PathVertex) -> String {
    let triple =
        |c: burnish::math::Rgb| <[f32; 3]>::from(c).map(|x| digits(x.into(), 3)).join("  ");
    format!(
        "throughput beta up to here  {}\nadded by its own emission  {}\nadded by light sampling  {}",
        triple(vertex.beta),
        triple(vertex.emitted),
        triple(vertex.direct),
    )
}

fn row(ui: &mut Ui, name: RichText, figures: [&str; 2], head: bool) -> egui::Response {
    ui.horizontal(|ui| {
        let size = vec2(ui.available_width() - 2.0 * FIGURE - 8.0, 16.0);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(size.x);
            ui.add(Label::new(name).truncate());
        });
        ui.spacing_mut().item_spacing.x = 0.0;
        for (figure, tip) in figures.into_iter().zip([labels::BETA_TIP, labels::ADDS_TIP]) {
            let layout = Layout::right_to_left(Align::Center);
            ui.allocate_ui_with_layout(vec2(FIGURE, 16.0), layout, |ui| {
                ui.set_min_width(FIGURE);
                let words = RichText::new(figure);
                let label = ui.label(if head { words.small().weak() } else { words.monospace() });
                if head {
                    label.on_hover_text(tip);
                }
            });
        }
    })
    .response
}

/// Draws the pixel's frame and the path over the picture, which is at `place` and may reach beyond
/// the `space` that is seen.
pub(super) fn overlay(
    ui: &Ui,
    params: &Params,
    pixel: [u32; 2],
    path: Option<&PathRecord>,
    place: Rect,
    space: Rect,
) {
    let painter = ui.painter_at(space);
    let scale = place.size() / vec2(params.size[0] as f32, params.size[1] as f32);
    let on_screen = |[x, y]: [f64; 2]| place.min + vec2(x as f32 * scale.x, y as f32 * scale.y);
    let line = |a: DVec3, b: DVec3, width: f32| {
        let Some(ends) = params.camera.project(a, b, params.size) else { return };
        let ends = ends.map(on_screen);
        // Beyond this the painter's own numbers lose their digits.
        if ends.iter().any(|e| !(e.x.abs() < 1e6 && e.y.abs() < 1e6)) {
            return;
        }
        painter.line_segment(ends, Stroke::new(width + 2.0, Color32::from_black_alpha(0xa0)));
        painter.line_segment(ends, Stroke::new(width, LINE));
    };
    if let Some(path) = path {
        let [low, high] = params.scene.bounds();
        let far = (high - low).length();
        for vertex in &path.vertices {
            if let Some(light) = vertex.light {
                line(vertex.point, light, 1.0);
            }
        }
        for pair in path.vertices.windows(2) {
            line(pair[0].point, pair[1].point, 2.0);
        }
        if let (Some(last), Some(escape)) = (path.vertices.last(), path.escape) {
            line(last.point, last.point + escape.direction * far, 2.0);
        }
        for (i, vertex) in path.vertices.iter().enumerate() {
            let at = params.camera.project(vertex.point, vertex.point, params.size);
            if let Some([at, _]) = at {
                number(ui, &painter, on_screen(at), i + 1);
            }
        }
    }
    let [x, y] = pixel.map(f64::from);
    let frame = Rect::from_two_pos(on_screen([x, y]), on_screen([x + 1.0, y + 1.0]));
    let frame = frame.expand((4.0 - frame.width() / 2.0).max(1.0));
    let stroke = |width, colour| Stroke::new(width, colour);
    let kind = egui::StrokeKind::Outside;
    painter.rect_stroke(frame.expand(1.0), 0.0, stroke(1.0, Color32::BLACK), kind);
    painter.rect_stroke(frame, 0.0, stroke(1.0, Color32::WHITE), kind);
}

/// A vertex's number on a dark disc.
fn number(ui: &Ui, painter: &egui::Painter, at: Pos2, number: usize) {
    if !painter.clip_rect().contains(at) {
        return;
    }
    let centre = pos2(at.x + 10.0, at.y - 10.0);
    painter.circle_filled(at, 3.0, LINE);
    painter.circle_filled(centre, 8.0, Color32::from_black_alpha(0xc0));
    let font = TextStyle::Small.resolve(ui.style());
    painter.text(centre, Align2::CENTER_CENTER, number.to_string(), font, Color32::WHITE);
}
