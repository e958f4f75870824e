//! The proofs of the model at the roughness that the slider shows: the table of `burnish check`.

use crate::viewer::document::{Document, Shown};
use crate::viewer::jobs::background::Background;
use crate::viewer::keys::Action;
use crate::viewer::panels::Panel;
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::measure::check::{Bound, Effort, Proof, Subject, prove};
use egui::{Align, Layout, RichText, Ui};

pub(crate) struct Proofs {
    tried: Background<Subject, Result<Vec<Proof>, String>>,
}

impl Default for Proofs {
    fn default() -> Proofs {
        // One thread: the picture wants the others.
        let prove =
            |subject: &Subject| prove(*subject, Effort::Quick, 1).map_err(|e| e.to_string());
        Proofs { tried: Background::new(prove) }
    }
}

impl Panel for Proofs {
    /// Costs nothing while it is closed.
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, _: &mut Vec<Action>) {
        widgets::section(ui, "proofs", "Checks", None, false, |ui| self.table(ui, document));
    }
}

impl Proofs {
    fn table(&mut self, ui: &mut Ui, document: &Document) {
        let (Shown::Same(roughness) | Shown::Mixed(roughness)) = document.roughness() else {
            ui.weak("No specular lobe here (Ks = 0): there is nothing to check.");
            return;
        };
        let params = &document.params;
        let (normals, erratum) = (params.normals, params.erratum);
        let subject = Subject { model: params.model, roughness, normals, erratum };
        let Some((tried, current)) = self.tried.ask(ui.ctx(), &subject) else {
            ui.weak("Running\u{2026}");
            return;
        };
        let alpha = digits(roughness.alpha(), 3);
        ui.spacing_mut().item_spacing.y = 2.0;
        match tried {
            Ok(proofs) => {
                let failing = proofs.iter().filter(|p| !p.holds()).count();
                let words = match (current, failing) {
                    (false, _) => "Running again\u{2026}".to_owned(),
                    (true, 0) => format!("All {} pass at alpha {alpha}.", proofs.len()),
                    (true, n) => format!("{n} of {} fail at alpha {alpha}.", proofs.len()),
                };
                ui.label(words);
                ui.scope(|ui| {
                    // What belongs to an earlier roughness is greyed until its successor comes.
                    ui.multiply_opacity(if current { 1.0 } else { 0.4 });
                    proofs.iter().for_each(|proof| row(ui, proof));
                });
            }
            Err(why) => {
                ui.label(why);
            }
        }
    }
}

fn row(ui: &mut Ui, proof: &Proof) {
    let (bound, must) = match proof.bound {
        Bound::AtMost(most) => (most, "at most"),
        Bound::AtLeast(least) => (least, "at least"),
    };
    let figure = digits(proof.figure, 2);
    let tip = format!("{}.\nFound {figure}; must be {must} {}.", proof.says, digits(bound, 2));
    ui.horizontal(|ui| {
        ui.label(proof.name).on_hover_text(&tip);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let verdict = if proof.holds() {
                RichText::new("pass").weak()
            } else {
                RichText::new("FAIL").strong().color(theme::accent_of(ui.visuals()))
            };
            ui.label(verdict).on_hover_text(&tip);
            ui.label(RichText::new(figure).monospace()).on_hover_text(&tip);
        });
    });
}
