//! What the model does to energy: a part of the controls and one of the scene's report.

use crate::viewer::document::Document;
use crate::viewer::jobs::background::Background;
use crate::viewer::style::numbers::{digits, percent};
use burnish::brdf::{Model, Roughness};
use burnish::measure::energy::{LobeEnergy, remarks};
use burnish::scene::Material;
use egui::{Label, RichText, Ui};
use std::sync::Arc;

/// The line below the slider.
pub(crate) struct EnergyOfLobe {
    found: Background<(Model, Roughness), LobeEnergy>,
}

/// The remarks on materials that reflect more than arrives.
pub(crate) struct EnergyOfScene {
    found: Background<(Model, Arc<Vec<Material>>), Vec<String>>,
}

/// Remarks that are shown at most; the rest is counted.
const MOST: usize = 6;

impl Default for EnergyOfLobe {
    fn default() -> EnergyOfLobe {
        let of = |&(model, roughness): &(Model, Roughness)| LobeEnergy::of(model, roughness);
        EnergyOfLobe { found: Background::new(of) }
    }
}

impl Default for EnergyOfScene {
    fn default() -> EnergyOfScene {
        EnergyOfScene {
            found: Background::new(|(model, materials)| {
                remarks(materials, *model).iter().map(ToString::to_string).collect()
            }),
        }
    }
}

impl EnergyOfLobe {
    /// Draws what the lobe alone loses at the slider's roughness.
    pub(crate) fn line(&mut self, ui: &mut Ui, model: Model, roughness: Roughness) {
        let known = self.found.ask(ui.ctx(), &(model, roughness));
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
}

impl EnergyOfScene {
    /// Draws them, and counts those that are too many.
    pub(crate) fn lines(&mut self, ui: &mut Ui, document: &Document) {
        let question = (document.params.model, document.params.materials.clone());
        let Some((remarks, _)) = self.found.ask(ui.ctx(), &question) else { return };
        for remark in remarks.iter().take(MOST) {
            ui.add(Label::new(RichText::new(remark).weak()).wrap());
        }
        if remarks.len() > MOST {
            ui.weak(format!("and {} more such remarks", remarks.len() - MOST));
        }
    }
}
