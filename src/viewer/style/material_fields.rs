//! The numbers of the picked material: what it reflects, how rough it is, what it emits.

use crate::viewer::document::{Document, has_lobe};
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::number_field::{NumberField, Written};
use crate::viewer::style::numbers::digits;
use crate::viewer::style::subscript;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::brdf::Roughness;
use burnish::scene::Material;
use burnish::scene::presets::{PRESETS, Preset};
use egui::{ComboBox, Ui};

/// Draws the fields of the picked material; an edit changes the document.
pub(crate) fn fields(ui: &mut Ui, document: &mut Document) {
    let Some(material) = document.picked_material().filter(|_| document.only_picked) else {
        return;
    };
    ui.add_space(theme::GAP);
    let mut edited = material.clone();
    let shines = material.emits() || document.picked_as_read().is_some_and(Material::emits);
    let reflects = material.kd != [0.0; 3] || has_lobe(material);
    if shines {
        colour(ui, &labels::EMISSION, Material::MAX_EMISSION, &mut edited.emission);
    }
    presets(ui, &mut edited);
    // A scene file has no words for a surface that does both.
    if !shines || reflects {
        colour(ui, &labels::KD, 1.0, &mut edited.kd);
        colour(ui, &labels::KS, 1.0, &mut edited.ks);
        exponent(ui, &mut edited);
    }
    if edited != *material {
        document.set_picked(edited);
    }
}

/// A menu of measured reflectances.
fn presets(ui: &mut Ui, material: &mut Material) {
    if material.emits() {
        return;
    }
    widgets::field(ui, &labels::PRESET, |ui, label| {
        let is = |p: &&Preset| {
            let f32s = |c: [f64; 3]| c.map(|x| x as f32);
            (f32s(p.kd), f32s(p.ks)) == (material.kd, material.ks)
        };
        let title = PRESETS.iter().find(is).map_or("Custom", |p| p.title);
        let menu = ComboBox::from_id_salt("preset")
            .width(ui.available_width())
            .selected_text(title)
            .show_ui(ui, |ui| {
                theme::quiet_choice(ui);
                for preset in &PRESETS {
                    let entry = ui.selectable_label(preset.title == title, preset.title);
                    widgets::beside(&entry, preset.source);
                    if let (true, Ok(made)) = (entry.clicked(), preset.material()) {
                        *material = Material { name: material.name.clone(), ..made };
                    }
                }
            });
        menu.response.labelled_by(label).on_hover_text(labels::PRESET.tip);
    });
}

/// A swatch and three numbers.
fn colour(ui: &mut Ui, control: &Control, most: f64, value: &mut [f32; 3]) {
    let Control { name, tip } = control;
    widgets::field(ui, control, |ui, _| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let height = ui.spacing().interact_size.y;
        // A radiance by its colour alone.
        let brightest = if most == 1.0 { 1.0 } else { value.iter().fold(1e-30, |a, &b| b.max(a)) };
        if most == 1.0 {
            ui.spacing_mut().interact_size = egui::vec2(18.0, 18.0);
            // The picker rounds what it is shown: to look is not to edit.
            let mut picked = *value;
            let picker = ui.color_edit_button_rgb(&mut picked);
            let picker = picker.accessible_name(format!("{name} colour"));
            if picker.on_hover_text(*tip).changed() {
                *value = picked;
            }
            ui.spacing_mut().interact_size.y = height;
        } else {
            widgets::swatch(ui, value.map(|c| c / brightest)).on_hover_text(*tip);
        }
        let size = egui::vec2((ui.available_width() - 8.0) / 3.0, height);
        for (channel, value) in labels::CHANNELS.into_iter().zip(value) {
            let mut wide = f64::from(*value);
            let speed = if most == 1.0 { 0.005 } else { (0.01 * wide).max(0.01) };
            let name = format!("{name} {channel}");
            let field = NumberField {
                name: &name,
                range: [0.0, most],
                speed,
                written: Written::Digits(3),
                unit: "",
                prefix: "",
                size,
            };
            let field = field.ui(ui, &mut wide).accessible_name(&name);
            if field.on_hover_text(*tip).changed() {
                *value = wide as f32;
            }
        }
    });
}

/// Width of "alpha 0.0001000", in points.
const FIGURE: f32 = 120.0;

fn exponent(ui: &mut Ui, material: &mut Material) {
    let tip = subscript::tip(ui, labels::EXPONENT.tip);
    widgets::field(ui, &labels::EXPONENT, |ui, label| {
        let mut a_p = material.roughness.exponent();
        let field = NumberField {
            name: labels::EXPONENT.name,
            range: Roughness::EXPONENT,
            speed: 0.01 * (a_p + 2.0),
            written: Written::Digits(4),
            unit: "",
            prefix: "",
            size: egui::vec2(ui.available_width() - FIGURE, ui.spacing().interact_size.y),
        };
        // Always there, so that the field that has the keyboard is the same one before and after Ks is 0.
        let field = ui.add_enabled_ui(has_lobe(material), |ui| field.ui(ui, &mut a_p)).inner;
        let field = field.labelled_by(label).on_hover_text(tip.clone());
        if !has_lobe(material) {
            field.on_disabled_hover_text(labels::KS.tip);
            ui.weak("no lobe: Ks is 0").on_hover_text(labels::KS.tip);
            return;
        }
        if field.changed()
            && let Ok(roughness) = Roughness::from_exponent(a_p)
        {
            material.roughness = roughness;
        }
        let alpha = format!("alpha {}", digits(material.roughness.alpha(), 4));
        ui.label(egui::RichText::new(alpha).monospace()).on_hover_text(tip);
    });
}
