//! The scene's materials: pick one to edit it.

use crate::viewer::document::{Document, has_lobe};
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::style::material_fields;
use crate::viewer::style::numbers::digits;
use crate::viewer::style::subscript;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::scene::{Material, MaterialId};
use egui::{Align, Button, Layout, Response, RichText, ScrollArea, TextStyle, Ui};
use std::ops::Range;

/// Least number of lines that are shown at once; half a line says that there are more.
const LINES: f32 = 3.5;
/// A list of more materials is drawn only where it is seen, or it would take all of a frame's time.
/// The keyboard then walks what is seen.
const ALL_DRAWN: usize = 300;
/// Height of all else in the panel, in points: a tall window has room for more lines.
const REST: f32 = 760.0;

const HINT: &str = "pick one, here or in the picture";

#[derive(Default)]
pub(crate) struct Materials {
    /// The one that was picked when last drawn, to scroll to a new one.
    seen: Option<MaterialId>,
    /// The one that was last clicked in the list.
    clicked: Option<MaterialId>,
    /// The lines of a very long list that were drawn.
    drawn: Range<usize>,
}

impl Panel for Materials {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, _: &mut Vec<Action>) {
        let count = document.params.materials.len().to_string();
        let count = widgets::Badge { text: count, warns: false };
        widgets::section(ui, "materials", "Materials", Some(count), true, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            header(ui);
            let height = LINES * (ui.spacing().interact_size.y + ui.spacing().item_spacing.y);
            let height = height.max(ui.clip_rect().height() - REST);
            self.list(ui, document, height);
            material_fields::fields(ui, document);
        });
    }
}

impl Materials {
    fn list(&mut self, ui: &mut Ui, document: &mut Document, height: f32) {
        let materials = &document.params.materials;
        let order = order(materials);
        let chosen = document.picked.filter(|_| document.only_picked);
        let line = ui.spacing().interact_size.y;
        let mut clicked = None;
        let mut rows = |ui: &mut Ui, range: Range<usize>, scroll: bool| {
            for &id in order.get(range).unwrap_or_default() {
                let Some(material) = materials.get(id as usize) else { continue };
                let row = row(ui, material, chosen == Some(id));
                if scroll && chosen == Some(id) {
                    row.scroll_to_me(Some(Align::Min));
                }
                if row.clicked() {
                    clicked = Some(id);
                }
            }
        };
        // Not one that was clicked in the list: it would run away from the pointer.
        let newly = chosen.filter(|_| self.seen != chosen && self.clicked != chosen);
        let newly = newly.and_then(|id| order.iter().position(|&other| other == id));
        // Each scene's list begins at its top.
        let area = ScrollArea::vertical().id_salt(document.number);
        let mut area = area.max_height(height).auto_shrink([false, true]);
        if materials.len() <= ALL_DRAWN {
            area.show(ui, |ui| rows(ui, 0..materials.len(), newly.is_some()));
        } else {
            if let Some(i) = newly.filter(|i| !self.drawn.contains(i)) {
                let top = i as f32 * (line + ui.spacing().item_spacing.y);
                area = area.vertical_scroll_offset((top - height / 2.0).max(0.0));
            }
            let drawn = &mut self.drawn;
            area.show_rows(ui, line, materials.len(), |ui, range| {
                drawn.clone_from(&range);
                rows(ui, range, false);
            });
        }
        self.seen = chosen;
        if clicked.is_some() {
            self.clicked = clicked;
            // A second click lets go of it.
            document.pick(clicked.filter(|_| clicked != chosen));
        }
    }
}

/// Order of the list: materials with a lobe, then emitters, then diffuse ones; else as in the scene.
fn order(materials: &[Material]) -> Vec<MaterialId> {
    let rank = |material: &Material| match material {
        material if has_lobe(material) => 0,
        material if material.emits() => 1,
        _ => 2,
    };
    let mut order: Vec<MaterialId> = (0..materials.len() as MaterialId).collect();
    order.sort_by_key(|&id| materials.get(id as usize).map_or(2, rank));
    order
}

/// Draws the heads of the columns.
fn header(ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(RichText::new("Kd Ks").small().weak());
        ui.add_space(8.0);
        ui.label(RichText::new(HINT).small().weak());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(theme::GAP);
            let colour = theme::weak(ui);
            subscript::label(ui, TextStyle::Small, colour);
        });
    });
}

fn row(ui: &mut Ui, material: &Material, chosen: bool) -> Response {
    let tip = subscript::tip(ui, &describe(material));
    let row = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        theme::quiet_choice(ui);
        swatches(ui, material);
        let width = ui.available_width();
        let name = Button::selectable(chosen, material.name.as_str())
            .right_text(RichText::new(figure(material)).monospace())
            .truncate();
        let layout = Layout::left_to_right(Align::Center).with_main_justify(true);
        let size = egui::vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, layout, |ui| ui.add(name))
            .inner
            .accessible_name(material.name.as_str())
            .on_hover_text(tip)
    });
    if chosen {
        widgets::focus_frame(ui, row.response.rect);
    }
    row.inner
}

/// Two squares: Kd and Ks, or one of what it emits.
fn swatches(ui: &mut Ui, material: &Material) {
    if material.emits() {
        let brightest = material.emission.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        widgets::swatch(ui, material.emission.map(|c| c / brightest))
            .on_hover_text("Colour of the emitted radiance");
        ui.add_space(16.0);
    } else {
        widgets::swatch(ui, material.kd).on_hover_text("Diffuse reflectance Kd");
        widgets::swatch(ui, material.ks)
            .on_hover_text("Specular reflectance at normal incidence Ks");
    }
}

/// The one figure at the right: the exponent, or what there is instead of a lobe.
fn figure(material: &Material) -> String {
    if material.emits() && !has_lobe(material) {
        "light".to_owned()
    } else if has_lobe(material) {
        digits(material.roughness.exponent(), 4)
    } else {
        "diffuse".to_owned()
    }
}

fn describe(material: &Material) -> String {
    let triple = |c: [f32; 3]| c.map(|x| digits(f64::from(x), 3)).join("  ");
    let mut lines =
        vec![format!("Kd  {}", triple(material.kd)), format!("Ks  {}", triple(material.ks))];
    if has_lobe(material) {
        let r = material.roughness;
        lines.push(format!("alpha {}   a_p {}", digits(r.alpha(), 4), digits(r.exponent(), 4)));
    }
    if material.emits() {
        lines.push(format!("emits {}  W/(m\u{b2} sr)", triple(material.emission)));
    }
    lines.join("\n")
}
