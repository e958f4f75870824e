//! The clicked pixel: what it sees, which light makes it up, and its brightest path.

mod draw;
mod light;
mod path;

use crate::viewer::document::Document;
use crate::viewer::jobs::background::Background;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::panels::lobe::luminance;
use crate::viewer::style::labels;
use crate::viewer::style::number_field::{NumberField, Written};
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Badge};
use burnish::brdf::{Model, Terms};
use burnish::geometry::Kind;
use burnish::measure::lobe::{Channel, LobeCurves, Quantity, lobe_curves, terms};
use burnish::progressive::{Params, PixelReport, probe};
use burnish::scene::{FirstHit, Material};
use egui::{Label, Rect, RichText, Slider, Ui, vec2};
use std::sync::Arc;

/// Samples that a pixel is taken apart by, at first.
const SAMPLES: u64 = 1024;
/// The largest angle that the slider reaches, in degrees.
const MOST: f64 = 89.0;

pub(crate) struct PixelPanel {
    samples: u64,
    /// Angle of the light at which the factors are shown, in degrees; the mirror direction's without.
    theta_i: Option<f64>,
    /// Whether the brightest path is drawn over the picture.
    draws_path: bool,
    reports: Background<Question, Option<Arc<Answer>>>,
    /// The answer shown in this frame, if the section is open.
    shown: Option<Arc<Answer>>,
}

#[derive(Clone, PartialEq)]
struct Question {
    params: Params,
    pixel: [u32; 2],
    samples: u64,
}

struct Answer {
    report: PixelReport,
    /// The lobe at the first surface, if that has one.
    curves: Option<LobeCurves>,
    model: Model,
}

impl Default for PixelPanel {
    fn default() -> PixelPanel {
        PixelPanel {
            samples: SAMPLES,
            theta_i: None,
            draws_path: true,
            reports: Background::new(answer),
            shown: None,
        }
    }
}

impl Panel for PixelPanel {
    /// Costs nothing while it is closed.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, _: &mut Vec<Action>) {
        self.shown = None;
        let badge =
            document.clicked.map(|[x, y]| Badge { text: format!("{x}, {y}"), warns: false });
        widgets::section(ui, "pixel", labels::PIXEL, badge, false, |ui| self.body(ui, document));
    }
}

impl PixelPanel {
    fn body(&mut self, ui: &mut Ui, document: &mut Document) {
        self.question(ui, document);
        let Some(pixel) = document.clicked else {
            ui.add(
                Label::new(RichText::new("Click into the picture to ask a pixel.").weak()).wrap(),
            );
            return;
        };
        let [width, height] = document.params.size;
        if pixel[0] >= width || pixel[1] >= height {
            ui.weak("This pixel is outside of the picture.");
            return;
        }
        match document.clicked_hit() {
            Some(hit) => self.surface(ui, document, &hit),
            None => drop(ui.weak("Nothing is hit behind the pixel's middle.")),
        }
        let params = document.params.clone();
        let question = Question { params, pixel, samples: self.samples };
        let Some((Some(answer), current)) = self.reports.ask(ui.ctx(), &question) else {
            ui.weak("Being traced\u{2026}");
            return;
        };
        let answer = answer.clone();
        ui.scope(|ui| {
            // What belongs to parameters before is greyed until its successor comes.
            ui.multiply_opacity(if current { 1.0 } else { 0.4 });
            if let Some(curves) = &answer.curves {
                heading(ui, "Directions taken at the first surface", labels::DIRECTIONS_TIP);
                draw::directions(ui, curves, answer.model, &answer.report.directions);
            }
            light::draw(ui, &answer.report);
            heading(ui, "The brightest sample, vertex by vertex", labels::BRIGHTEST_TIP);
            ui.checkbox(&mut self.draws_path, labels::DRAW_PATH.name)
                .on_hover_text(labels::DRAW_PATH.tip);
            path::table(ui, &answer.report, &document.params.materials);
        });
        self.shown = Some(answer).filter(|_| current);
    }

    /// Draws the fields of the pixel and of its number of samples.
    fn question(&mut self, ui: &mut Ui, document: &mut Document) {
        let [width, height] = document.params.size;
        let mut clicked = document.clicked.unwrap_or([width / 2, height / 2]);
        let before = clicked;
        widgets::field(ui, &labels::ASKED, |ui, _| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let size = vec2((ui.available_width() - 4.0) / 2.0, theme::ROW);
            let fields = [(&labels::COLUMN, width), (&labels::ROW, height)];
            for ((control, side), value) in fields.into_iter().zip(&mut clicked) {
                let most = u64::from(side.saturating_sub(1));
                let field = NumberField {
                    name: control.name,
                    range: [0.0, most as f64],
                    speed: 0.2,
                    written: Written::Whole,
                    prefix: &format!("{} ", control.name.to_lowercase()),
                    unit: "",
                    size,
                };
                let mut wide = u64::from(*value);
                let field = field.whole(ui, &mut wide).accessible_name(control.name);
                *value = u32::try_from(wide).unwrap_or(u32::MAX);
                field.on_hover_text(control.tip);
            }
        });
        if clicked != before {
            document.clicked = Some(clicked);
        }
        widgets::field(ui, &labels::SAMPLES, |ui, label| {
            let size = vec2(ui.available_width(), theme::ROW);
            let field = NumberField {
                name: labels::SAMPLES.name,
                range: [16.0, 65_536.0],
                speed: 16.0,
                written: Written::Whole,
                unit: "",
                prefix: "",
                size,
            };
            field
                .whole(ui, &mut self.samples)
                .labelled_by(label)
                .on_hover_text(labels::SAMPLES.tip);
        });
    }

    /// The first surface and the BRDF's factors there.
    fn surface(&mut self, ui: &mut Ui, document: &Document, hit: &FirstHit) {
        let Some(material) = document.params.materials.get(hit.material as usize) else { return };
        heading(ui, "First surface", "Behind the pixel's middle. Samples lie all over the pixel.");
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.spacing_mut().interact_size.y = 16.0;
            let shape = match hit.shape {
                Kind::Triangle(i) => format!("triangle {i}"),
                Kind::Sphere(i) => format!("sphere {i}"),
                Kind::Cylinder(i) => format!("cylinder {i}"),
            };
            fact(ui, "material", &material.name, "Whose surface it is.");
            fact(ui, "shape", &shape, "Which of the scene's shapes, counted from 0.");
            let triple = |v: [f64; 3]| v.map(|x| format!("{:>9}", digits(x, 4))).concat();
            fact(ui, "point", &triple(hit.point.to_array()), "In world units.");
            fact(
                ui,
                "distance",
                &format!("{:>9}", digits(hit.distance, 4)),
                "From the eye, in world units.",
            );
            fact(
                ui,
                "normal",
                &triple(hit.ns.to_array()),
                "Shading normal n, unit, on the viewer's side.",
            );
            let degrees = format!("{:>8.2}\u{b0}", hit.theta_o.to_degrees());
            fact(
                ui,
                "theta of wo",
                &degrees,
                "Angle between n and the direction wo to the viewer.",
            );
        });
        if material.ks.iter().any(|&ks| ks > 0.0) {
            self.factors(ui, document.params.model, material, hit.theta_o);
        }
    }

    /// D, F, G and f for the light at the slider's angle.
    fn factors(&mut self, ui: &mut Ui, model: Model, material: &Material, theta_o: f64) {
        widgets::field(ui, &labels::THETA_I, |ui, label| {
            const BUTTON: f32 = 52.0;
            const FIELD: f32 = 56.0;
            let spacing = 2.0 * ui.spacing().item_spacing.x;
            ui.spacing_mut().slider_width = ui.available_width() - BUTTON - FIELD - spacing;
            ui.spacing_mut().interact_size.x = FIELD;
            let mut degrees = self.theta_i.unwrap_or(theta_o.to_degrees()).clamp(-MOST, MOST);
            let slider = Slider::new(&mut degrees, -MOST..=MOST)
                // Not by decimals: those would round the mirror's angle and call it an edit.
                .custom_formatter(|x, _| format!("{x:.1}"))
                .trailing_fill(false)
                .suffix("\u{b0}");
            let response = ui.add(slider).labelled_by(label);
            if response.on_hover_text(labels::THETA_I.tip).changed() {
                self.theta_i = Some(degrees);
            }
            theme::quiet_choice(ui);
            let button = egui::Button::selectable(self.theta_i.is_none(), labels::MIRROR.name)
                .frame_when_inactive(true)
                .min_size(vec2(BUTTON, theme::ROW));
            if ui.add(button).on_hover_text(labels::MIRROR.tip).clicked() {
                self.theta_i = None;
            }
        });
        let theta_i = self.theta_i.map_or(theta_o, f64::to_radians);
        let roughness = material.roughness;
        let channels = [0, 1, 2].map(|c| {
            let [kd, ks] = [material.kd[c], material.ks[c]].map(f64::from);
            terms(model, Channel { kd, ks, roughness }, theta_o, theta_i)
        });
        let one = |x: f32| format!("{:>9}", digits(x.into(), 4));
        let three = |of: fn(&Terms) -> f32| channels.each_ref().map(|t| one(of(t))).concat();
        let f = [0, 1, 2].map(|c| {
            let diffuse = if channels[c].pdf_diffuse > 0.0 {
                material.kd[c] / std::f32::consts::PI
            } else {
                0.0
            };
            one(channels[c].specular + diffuse)
        });
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.spacing_mut().interact_size.y = 16.0;
            let alpha = one(roughness.alpha() as f32);
            fact(ui, "alpha", &alpha, labels::ALPHA.tip);
            fact(ui, "D", &one(channels[0].d), Quantity::D.describe());
            fact(ui, "G", &one(channels[0].g), "G1 of wo times G1 of wi, no unit.");
            let tip = "Fresnel reflectance Ks + (1 - Ks) (1 - cos)^5 of each channel, no unit.";
            fact(ui, "F", &three(|t| t.fresnel), tip);
            fact(
                ui,
                "f",
                &f.concat(),
                "Kd / pi + D G F / (4 cos_i cos_o) of each channel, in 1/sr.",
            );
        });
    }

    /// Whether the present pixel is shown, all of it worked out.
    #[cfg(test)]
    pub(crate) fn is_shown(&self) -> bool {
        self.shown.is_some()
    }

    /// The report that is shown.
    #[cfg(test)]
    pub(crate) fn report(&self) -> Option<&PixelReport> {
        self.shown.as_ref().map(|answer| &answer.report)
    }

    /// Draws the asked pixel and the brightest path over the picture, which is at `place`.
    pub(crate) fn overlay(&self, ui: &Ui, document: &Document, place: Rect, space: Rect) {
        let Some(answer) = &self.shown else { return };
        let path = self.draws_path.then_some(&answer.report.brightest.1);
        path::overlay(ui, &document.params, answer.report.pixel, path, place, space);
    }
}

/// The asked pixel taken apart.
fn answer(question: &Question) -> Option<Arc<Answer>> {
    let Question { params, pixel, samples } = question;
    let report = probe(params, *pixel, *samples)?;
    let model = params.model;
    let lobe = report.first.and_then(|hit| {
        let material = params.materials.get(hit.material as usize)?;
        let [kd, ks] = [luminance(material.kd), luminance(material.ks)];
        let channel = Channel { kd, ks, roughness: material.roughness };
        (kd + ks > 0.0).then(|| lobe_curves(Quantity::FCos, channel, hit.theta_o, 181))
    });
    Some(Arc::new(Answer { report, curves: lobe, model }))
}

/// Above a part of the section.
fn heading(ui: &mut Ui, words: &str, tip: &str) {
    ui.add_space(4.0);
    ui.label(RichText::new(words).strong()).on_hover_text(tip);
}

/// A name and what it is.
fn fact(ui: &mut Ui, name: &str, value: &str, tip: &str) {
    ui.horizontal(|ui| {
        let left = ui.cursor().left();
        ui.weak(name).on_hover_text(tip);
        ui.add_space((theme::LABELS - (ui.cursor().left() - left)).max(0.0));
        ui.add(Label::new(RichText::new(value).monospace()).truncate()).on_hover_text(tip);
    });
}
