//! What the model does to energy, beside the slider and among the scene's remarks.

use crate::viewer::document::Document;
use crate::viewer::jobs::background::Background;
use crate::viewer::style::numbers::{digits, percent};
use burnish::brdf::{Model, Roughness};
use burnish::measure::energy::{LobeEnergy, remarks};
use burnish::scene::Material;
use egui::{Label, RichText, Ui};
use std::sync::Arc;

pub(crate) struct Energy {
    lobe: Background<(Model, Roughness), LobeEnergy>,
    scene: Background<(Model, Arc<Vec<Material>>), Vec<String>>,
}

/// So many remarks are shown; the rest is counted.
const MOST: usize = 6;

impl Energy {
    pub(crate) fn new() -> Energy {
        Energy {
            lobe: Background::new(|&(model, roughness)| LobeEnergy::of(model, roughness)),
            scene: Background::new(|(model, materials)| {
                remarks(materials, *model).iter().map(ToString::to_string).collect()
            }),
        }
    }

    /// What the lobe alone loses at the slider's roughness.
    pub(crate) fn of_lobe(&mut self, ui: &mut Ui, model: Model, roughness: Roughness) {
        let known = self.lobe.ask(ui.ctx(), &(model, roughness));
        // The figure before stands until the new one is there, milliseconds later; before the first
        // one its place is kept, or every control below would move under the pointer.
        let Some((energy, _)) = known else {
            ui.label(RichText::new("Energy lost ...").weak().small());
            return;
        };
        let (loss, most) = (energy.loss().max(0.0), energy.most());
        let gain = if most > 1.005 {
            format!(", gains {} at grazing", percent(most - 1.0))
        } else {
            String::new()
        };
        let tip = "What the lobe does to light on average with F = 1. One bounce between facets is \
                   all that the model knows: the rest is lost, and rough metals are darker than \
                   real ones. Phong's lobe gains at grazing where it is rough, for its D and \
                   Beckmann's G do not belong together.";
        let albedo = digits(1.0 - energy.loss(), 3);
        let words = format!("Energy lost {}{gain} (albedo {albedo})", percent(loss));
        ui.label(RichText::new(words).weak().small()).on_hover_text(tip);
    }

    /// The materials that reflect more than arrives.
    pub(crate) fn of_scene(&mut self, ui: &mut Ui, document: &Document) {
        let question = (document.params.model, document.params.materials.clone());
        let Some((remarks, _)) = self.scene.ask(ui.ctx(), &question) else { return };
        for remark in remarks.iter().take(MOST) {
            ui.add(Label::new(RichText::new(remark).weak()).wrap());
        }
        if remarks.len() > MOST {
            ui.weak(format!("and {} more such remarks", remarks.len() - MOST));
        }
    }
}
