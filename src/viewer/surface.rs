//! The numbers of the picked material: what it reflects, how rough it is, what it emits.

use super::document::{Document, has_lobe};
use super::figures::digits;
use super::widgets;
use burnish::brdf::Roughness;
use burnish::scene::Material;
use egui::Ui;

/// A colour of a material.
struct Quantity {
    name: &'static str,
    tip: &'static str,
    most: f64,
}

const KD: Quantity = Quantity {
    name: "Kd",
    tip: "Diffuse reflectance, linear Rec. 709, each channel 0 to 1, no unit: f = Kd / pi. What \
          reflects more than arrives is told under \"Scene\".",
    most: 1.0,
};
const KS: Quantity = Quantity {
    name: "Ks",
    tip: "Specular reflectance at normal incidence, linear Rec. 709, each channel 0 to 1, no unit: \
          F = Ks + (1 - Ks) (1 - cos)^5. With 0 0 0 there is no specular lobe at all.",
    most: 1.0,
};
const EMISSION: Quantity = Quantity {
    name: "Emits",
    tip: "Radiance that leaves every point in every direction, linear Rec. 709, 0 to 1e18 W/(m\u{b2} sr).",
    most: Material::MAX_EMISSION,
};
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Draws the fields of the picked material; an edit changes the document.
pub(super) fn fields(ui: &mut Ui, document: &mut Document) {
    let Some(material) = document.picked_material().filter(|_| document.only_picked) else {
        ui.weak("Pick one, here or in the picture, to edit it.");
        return;
    };
    let mut edited = material.clone();
    let shines = material.emits() || document.picked_as_read().is_some_and(Material::emits);
    let reflects = material.kd != [0.0; 3] || has_lobe(material);
    if shines {
        colour(ui, &EMISSION, &mut edited.emission);
    }
    // A scene file has no words for a surface that does both.
    if !shines || reflects {
        colour(ui, &KD, &mut edited.kd);
        colour(ui, &KS, &mut edited.ks);
        exponent(ui, &mut edited);
    }
    if edited != *material {
        document.set_picked(edited);
    }
}

/// A swatch and three numbers.
fn colour(ui: &mut Ui, quantity: &Quantity, value: &mut [f32; 3]) {
    let Quantity { name, tip, most } = quantity;
    widgets::field(ui, name, tip, |ui, _| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let height = ui.spacing().interact_size.y;
        // A radiance by its colour alone.
        let brightest = if *most == 1.0 { 1.0 } else { value.iter().fold(1e-30, |a, &b| b.max(a)) };
        widgets::swatch(ui, value.map(|c| c / brightest)).on_hover_text(*tip);
        let size = egui::vec2((ui.available_width() - 8.0) / 3.0, height);
        for (channel, value) in CHANNELS.into_iter().zip(value) {
            let mut wide = f64::from(*value);
            let speed = if *most == 1.0 { 0.005 } else { (0.01 * wide).max(0.01) };
            let field =
                widgets::number(&mut wide, 3).range(0.0..=*most).speed(speed).min_size(size);
            let field = ui.add_sized(size, field).accessible_name(format!("{name} {channel}"));
            if field.on_hover_text(*tip).changed() {
                *value = wide as f32;
            }
        }
    });
}

fn exponent(ui: &mut Ui, material: &mut Material) {
    let tip = "Phong exponent a_p of this material, no unit, 0 (dull) to 2e8 - 2 (mirror-like); \
               alpha = sqrt(2 / (a_p + 2)). Drag or type.";
    widgets::field(ui, "Exponent", tip, |ui, label| {
        if !has_lobe(material) {
            ui.weak("no lobe: Ks is 0").on_hover_text(KS.tip);
            return;
        }
        let [low, high] = Roughness::EXPONENT;
        let mut a_p = material.roughness.exponent();
        let size = egui::vec2(ui.available_width() / 2.0, ui.spacing().interact_size.y);
        let speed = 0.01 * (a_p + 2.0);
        let field = widgets::number(&mut a_p, 4).range(low..=high).speed(speed).min_size(size);
        if ui.add_sized(size, field).labelled_by(label).on_hover_text(tip).changed()
            && let Ok(roughness) = Roughness::from_exponent(a_p)
        {
            material.roughness = roughness;
        }
        let alpha = format!("alpha {}", digits(material.roughness.alpha(), 4));
        ui.label(egui::RichText::new(alpha).monospace()).on_hover_text(tip);
    });
}
