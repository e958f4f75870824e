//! The proofs at the slider, and what is told of energy.

use super::*;
use burnish::brdf::Erratum;
use std::sync::Arc;

impl Desk {
    /// Frame after frame until a label with this text is drawn.
    fn until_drawn(&mut self, text: &str) {
        let start = Instant::now();
        while !self.is_drawn(text) {
            assert!(start.elapsed() < PATIENCE, "never drawn: {text}");
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
    }

    /// Opens the panel of proofs, wherever it moves to meanwhile.
    fn open_proofs(&mut self) {
        let start = Instant::now();
        while !self.is_drawn("Running") && !self.is_drawn("at alpha") {
            assert!(start.elapsed() < PATIENCE, "the proofs do not open");
            self.click("Checks");
            self.harness.run_ok();
        }
    }

    fn is_drawn(&self, text: &str) -> bool {
        self.harness.query_all_by_label_contains(text).next().is_some()
    }
}

#[test]
fn proofs_are_tried_at_the_slider_s_roughness_when_their_panel_is_open() {
    let mut desk = Desk::new();
    assert!(!desk.is_drawn("Running"), "closed, it costs nothing");
    desk.type_into("alpha", "0.2");
    desk.open_proofs();
    desk.until_drawn("pass at alpha 0.200.");
    for proof in ["normalisation of D", "limits of G", "samples against density", "albedo"] {
        desk.harness.get_by_label(proof);
    }
    assert!(!desk.is_drawn("FAIL"));
    // An older result stands, and says so, until its successor comes.
    desk.type_into("alpha", "0.5");
    assert!(desk.is_drawn("Running again") || desk.is_drawn("pass at alpha 0.500."));
    desk.until_drawn("pass at alpha 0.500.");
}

#[test]
fn a_mistake_made_on_purpose_fails_its_proof() {
    let mut desk = Desk::new();
    desk.open_proofs();
    desk.until_drawn("pass at alpha");
    desk.document(|d| d.params.erratum = Some(Erratum::GgxGSum));
    desk.until_drawn("fail at alpha");
    assert!(desk.is_drawn("FAIL"));
    // It is about GGX: on Beckmann all is well.
    desk.click("Beckmann");
    desk.until_drawn("pass at alpha");
    assert!(!desk.is_drawn("FAIL"));
}

#[test]
fn the_lobe_s_loss_stands_by_the_slider() {
    let mut desk = Desk::new();
    desk.type_into("alpha", "0.1");
    // 1 - 0.97156, from the table of means.
    desk.until_drawn("Energy lost 2.84 %");
    desk.click("Phong");
    desk.type_into("a_p", "2");
    desk.until_drawn("Energy lost 22.7 %, gains 17.9 % at grazing");
}

#[test]
fn a_material_that_gains_light_is_named_in_the_scene_s_remarks() {
    let mut desk = Desk::new();
    assert!(!desk.is_drawn("no finite answer"));
    desk.document(|d| Arc::make_mut(&mut d.params.materials)[0].kd = [1.0; 3]);
    desk.until_drawn("a closed room of it has no finite answer");
    desk.document(|d| Arc::make_mut(&mut d.params.materials)[0].kd = [0.2; 3]);
    let start = Instant::now();
    while desk.is_drawn("no finite answer") {
        assert!(start.elapsed() < PATIENCE, "still said");
        desk.harness.step();
    }
}
