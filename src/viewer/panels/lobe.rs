//! The lobes of all models over each other, at the roughness that the slider shows.

mod draw;

use crate::viewer::document::{Document, Shown};
use crate::viewer::jobs::background::Background;
use crate::viewer::jobs::save::Plot;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::panels::export::{Content, Exports};
use crate::viewer::style::labels;
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Weight};
use burnish::brdf::{Model, Roughness};
use burnish::measure::lobe::{Channel, LobeCurves, Quantity, lobe_curves, value};
use burnish::measure::plot::Style;
use burnish::scene::Material;
use egui::{RichText, Slider, Ui, vec2};

/// Number of equally spaced angles of a curve: about one for each point of the panel's width.
const ANGLES: usize = 361;
/// The viewer's largest angle that the slider reaches, in degrees.
const MOST: f64 = 89.0;

pub(crate) struct LobePanel {
    quantity: Quantity,
    style: Style,
    /// Angle of the viewer, in degrees.
    theta_o: f64,
    source: Source,
    /// The angle whose values the table has, in radians, while the pointer or the keyboard is there.
    cursor: Option<f64>,
    curves: Background<Question, LobeCurves>,
    pub(crate) exports: Exports,
}

/// Whose lobe it is.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    /// The lobe of F = 1 at the slider's roughness.
    White,
    /// The picked material's.
    Material,
    /// The lobe of the surface behind the clicked pixel, at its viewer's angle.
    Pixel,
}

#[derive(Clone, PartialEq)]
struct Question {
    quantity: Quantity,
    channel: Channel,
    theta_o: f64,
}

impl Default for LobePanel {
    fn default() -> LobePanel {
        LobePanel {
            quantity: Quantity::default(),
            // What models differ in is small where the lobe is high.
            style: Style { polar: false, log: true },
            theta_o: 45.0,
            source: Source::White,
            cursor: None,
            curves: Background::new(|q: &Question| {
                lobe_curves(q.quantity, q.channel, q.theta_o, ANGLES)
            }),
            exports: Exports::default(),
        }
    }
}

impl Panel for LobePanel {
    /// Costs nothing while it is closed.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        self.exports.receive(actions);
        widgets::section(ui, "lobes", labels::LOBES, None, false, |ui| {
            self.body(ui, document, actions);
        });
    }
}

impl LobePanel {
    fn body(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let (Shown::Same(roughness) | Shown::Mixed(roughness)) = document.roughness() else {
            ui.weak("No specular lobe here (Ks = 0): there is none to draw.");
            return;
        };
        self.choices(ui, document);
        self.viewer(ui, document);
        let channel = self.channel(document, roughness);
        let theta_o = self.theta_o.to_radians();
        let question = Question { quantity: self.quantity, channel, theta_o };
        let Some((curves, _)) = self.curves.ask(ui.ctx(), &question) else {
            // Its place is kept.
            ui.allocate_space(vec2(ui.available_width(), draw::HEIGHT));
            return;
        };
        let model = document.params.model;
        ui.label(RichText::new(curves.caption()).weak().small());
        let plot = draw::plot(ui, curves, self.style, model, &mut self.cursor);
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 4.0;
            ui.spacing_mut().interact_size.y = 16.0;
            table(ui, curves, model, self.cursor.unwrap_or(resting(curves)));
        });
        ui.add_space(theme::GAP);
        let (controls, style) =
            ([&labels::COPY_CSV, &labels::SAVE_SVG, &labels::SAVE_PNG], self.style);
        let content = |which| match which {
            0 => Content::Copied(curves.csv()),
            _ => Content::File(Plot::Lobes(curves.clone(), style)),
        };
        self.exports.buttons(ui, controls, stem(curves), plot, content, actions);
    }

    fn choices(&mut self, ui: &mut Ui, document: &Document) {
        widgets::field(ui, &labels::QUANTITY, |ui, _| {
            let entries = Quantity::ALL.map(|q| (q.title(), q.describe().to_owned(), true));
            let chosen = Quantity::ALL.iter().position(|&q| q == self.quantity).unwrap_or(0);
            if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
                self.quantity = Quantity::ALL[i];
            }
        });
        let two = |ui: &mut Ui, control, on: &mut bool, entries: [labels::Control; 2]| {
            widgets::field(ui, control, |ui, _| {
                let entries = entries.map(|c| (c.name, c.tip.to_owned(), true));
                if let Some(i) = widgets::segmented(ui, Weight::Quiet, usize::from(*on), &entries) {
                    *on = i == 1;
                }
            });
        };
        two(ui, &labels::AXES, &mut self.style.polar, labels::AXES_CHOICES);
        two(ui, &labels::SCALE, &mut self.style.log, labels::SCALE_CHOICES);
        let pixel = clicked_material(document).is_some();
        let all = [
            (Source::White, labels::WHITE, true),
            (Source::Material, labels::OF_MATERIAL, selected(document).is_some()),
            (Source::Pixel, labels::OF_PIXEL, pixel),
        ];
        if !all.iter().any(|(source, _, there)| *there && *source == self.source) {
            self.source = Source::White;
        }
        let chosen = all.iter().position(|a| a.0 == self.source).unwrap_or(0);
        let entries = all.map(|(_, c, there)| (c.name, c.tip.to_owned(), there));
        widgets::field(ui, &labels::LOBE_OF, |ui, _| {
            if let Some(i) = widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
                self.source = all[i].0;
            }
        });
    }

    /// The viewer's angle: the slider's, or the clicked pixel's, which moving the slider leaves.
    fn viewer(&mut self, ui: &mut Ui, document: &Document) {
        if let Some(hit) = document.clicked_hit().filter(|_| self.source == Source::Pixel) {
            self.theta_o = hit.theta_o.to_degrees().min(MOST);
        }
        widgets::field(ui, &labels::THETA_O, |ui, label| {
            const FIELD: f32 = 64.0;
            ui.spacing_mut().slider_width =
                ui.available_width() - FIELD - ui.spacing().item_spacing.x;
            ui.spacing_mut().interact_size.x = FIELD;
            let slider =
                // Not by decimals: those would round the pixel's angle and call it an edit.
                Slider::new(&mut self.theta_o, 0.0..=MOST)
                    .custom_formatter(|x, _| format!("{x:.1}"))
                    .suffix("\u{b0}");
            let response = ui.add(slider).labelled_by(label);
            if response.on_hover_text(labels::THETA_O.tip).changed() && self.source == Source::Pixel
            {
                self.source = Source::Material;
            }
        });
    }

    fn channel(&self, document: &Document, roughness: Roughness) -> Channel {
        let material = match self.source {
            Source::White => None,
            Source::Material => selected(document),
            Source::Pixel => clicked_material(document),
        };
        match material {
            Some(material) => Channel {
                kd: luminance(material.kd),
                ks: luminance(material.ks),
                roughness: material.roughness,
            },
            None => Channel::white(roughness),
        }
    }
}

/// The picked material.
fn selected(document: &Document) -> Option<&Material> {
    document.picked_material().filter(|_| document.only_picked)
}

/// Material of the surface behind the clicked pixel.
fn clicked_material(document: &Document) -> Option<&Material> {
    document.params.materials.get(document.clicked_hit()?.material as usize)
}

/// f is linear in Kd, and in Ks but for a constant: its luminance is that of the luminances.
pub(crate) fn luminance(c: [f32; 3]) -> f64 {
    burnish::math::Rgb::from(c).luminance().into()
}

/// The angle whose values the table has while no angle is pointed at: the mirror direction's.
fn resting(curves: &LobeCurves) -> f64 {
    if curves.quantity.has_viewer() { curves.theta_o } else { 0.0 }
}

/// The values at an angle, and the albedos.
fn table(ui: &mut Ui, curves: &LobeCurves, shown: Model, angle: f64) {
    let at = format!("at {:.1}\u{b0}", angle.to_degrees());
    let tip = "Share of light from everywhere alike that leaves towards the viewer, no unit.";
    widgets::number_row(ui, |_| {}, [&at, "albedo"], true).on_hover_text(tip);
    for (m, model) in Model::ALL.into_iter().enumerate() {
        let found = value(model, curves.quantity, curves.channel, curves.theta_o, angle);
        let figures = [digits(found, 4), format!("{:.4}", curves.albedo[m])];
        let name = |ui: &mut Ui| {
            let (chip, _) = ui.allocate_exact_size(vec2(16.0, 16.0), egui::Sense::hover());
            let ends = [chip.left_center(), chip.right_center()];
            ui.painter().line_segment(ends, draw::stroke(ui.visuals(), model, model == shown));
            let name = RichText::new(model.title());
            ui.label(if model == shown { name.strong() } else { name });
        };
        widgets::number_row(ui, name, [&figures[0], &figures[1]], false);
    }
}

/// Beginning of the curves' file names.
fn stem(curves: &LobeCurves) -> String {
    let quantity = curves.quantity.title().replace(' ', "-");
    format!("lobes_{quantity}_alpha-{:.4}", curves.channel.roughness.alpha())
}
