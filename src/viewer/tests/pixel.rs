//! Asking a pixel: what is told of the one that was clicked.

use super::*;
use crate::viewer::style::numbers::digits;
use burnish::progressive::{Technique, probe};

/// The middle of a pixel on the right ball.
const MIDDLE: [f32; 2] = [42.5, 24.5];

impl Desk {
    /// Clicks a pixel and waits for what is told of it.
    fn ask(&mut self, pixel: [f32; 2]) {
        self.click_pixel(pixel);
        self.until_asked();
    }

    /// Until the report is that of the present parameters.
    fn until_asked(&mut self) {
        // What a key or the pointer changed is drawn with the next frame.
        self.harness.step();
        let asked = self.doc().clicked;
        self.until("a report", |app| {
            app.panels.pixel.report().is_some_and(|r| Some(r.pixel) == asked)
        });
    }

    fn tells(&self, text: &str) -> bool {
        self.harness.query_all_by_label_contains(text).next().is_some()
    }
}

#[test]
fn a_clicked_pixel_is_taken_apart() {
    let mut desk = Desk::done(2);
    desk.click_role(Role::Button, "Pixel");
    assert!(desk.tells("Click into the picture"));
    desk.ask(MIDDLE);
    assert_eq!(desk.doc().clicked, Some([42, 24]));
    assert_eq!(desk.doc().picked, Some(1), "the click picks the material as before");
    let hit = desk.doc().clicked_hit().unwrap();
    for told in ["sphere 1", "First surface", "theta of wo"] {
        assert!(desk.tells(told), "{told}");
    }
    assert!(desk.tells(&format!("{:.2}\u{b0}", hit.theta_o.to_degrees())));
    assert!(desk.tells(&digits(hit.distance, 4)));
    // The figures are those of the library for these very parameters.
    let report = probe(&desk.doc().params, [42, 24], 1024).unwrap();
    for (technique, part) in Technique::ALL.into_iter().zip(&report.by_technique) {
        let row = format!("{} {}", technique.title(), digits(part.luminance.value, 3));
        assert!(desk.tells(&row), "{row}");
    }
    assert!(desk.tells(&format!("all {}", digits(report.total.luminance.value, 3))));
    let times = f64::from(report.brightest.1.value.luminance());
    assert!(desk.tells(&format!("luminance {}", digits(times, 3))));
    assert_eq!(report.brightest.1, desk.app().panels.pixel.report().unwrap().brightest.1);
}

#[test]
fn it_is_asked_again_when_something_changes() {
    let mut desk = Desk::done(2);
    desk.click_role(Role::Button, "Pixel");
    desk.ask(MIDDLE);
    let before = desk.app().panels.pixel.report().unwrap().total;
    desk.key(Key::Num1);
    desk.until_asked();
    let after = desk.app().panels.pixel.report().unwrap().total;
    assert_ne!(before, after, "of another model");
    assert_eq!(after, probe(&desk.doc().params, [42, 24], 1024).unwrap().total);
    desk.type_into("Samples", "64");
    desk.until_asked();
    assert_eq!(desk.app().panels.pixel.report().unwrap().samples, 64);
    // By keyboard alone.
    desk.type_into("Column", "22");
    desk.until_asked();
    assert_eq!(desk.doc().clicked, Some([22, 24]));
    assert!(desk.tells("sphere 0"));
    desk.type_into("Row", "0");
    desk.until_asked();
    assert!(desk.tells("Nothing is hit"));
    // A smaller picture has no such pixel.
    desk.document(|d| d.params.size = [16, 12]);
    desk.until("the smaller picture", |app| app.panels.pixel.report().is_none());
    assert!(desk.tells("outside of the picture"));
}

#[test]
fn factors_are_told_at_the_light_that_is_chosen() {
    let mut desk = Desk::done(1);
    desk.click_role(Role::Button, "Pixel");
    desk.ask(MIDDLE);
    let hit = desk.doc().clicked_hit().unwrap();
    let material = desk.doc().params.materials[1].clone();
    let channel = burnish::measure::lobe::Channel {
        kd: material.kd[0].into(),
        ks: material.ks[0].into(),
        roughness: material.roughness,
    };
    let d = |theta_i: f64| {
        let terms = burnish::measure::lobe::terms(Model::Ggx, channel, hit.theta_o, theta_i);
        digits(terms.d.into(), 4)
    };
    assert!(desk.tells(&d(hit.theta_o)), "{}", d(hit.theta_o));
    desk.type_into("theta of wi", "20");
    assert!(desk.tells(&d(20f64.to_radians())), "{}", d(20f64.to_radians()));
    desk.click("Mirror");
    desk.harness.run_ok();
    assert!(desk.tells(&d(hit.theta_o)));
}

#[test]
fn the_brightest_path_is_drawn_over_the_picture_where_its_vertices_are() {
    let mut desk = Desk::done(1);
    desk.click_role(Role::Button, "Pixel");
    let shapes = |desk: &Desk| desk.harness.output().shapes.len();
    desk.ask(MIDDLE);
    let numbered = |desk: &Desk| {
        let output = desk.harness.output();
        let canvas = desk.canvas();
        let texts = output.shapes.iter().filter_map(|s| match &s.shape {
            egui::Shape::Text(text) if canvas.contains(text.pos) => {
                Some(text.galley.text().to_owned())
            }
            _ => None,
        });
        texts.filter(|t| t == "1").count()
    };
    assert_eq!(numbered(&desk), 1);
    let with = shapes(&desk);
    desk.click("Draw over the picture");
    desk.harness.run_ok();
    assert_eq!(numbered(&desk), 0);
    assert!(shapes(&desk) < with);
    // Closed, nothing is drawn and nothing asked.
    desk.click("Draw over the picture");
    desk.click_role(Role::Button, "Pixel");
    desk.harness.run_ok();
    assert!(desk.app().panels.pixel.report().is_none());
    assert_eq!(numbered(&desk), 0);
}
