//! The lobes' curves: what is told of them, and how they leave the window.

use super::*;
use crate::viewer::style::numbers::digits;
use burnish::brdf::Roughness;
use burnish::measure::lobe::{Channel, Quantity, lobe_curves, value};
use egui::{ColorImage, OutputCommand, ViewportCommand};
use std::sync::Arc;

impl Desk {
    fn open_lobes(&mut self) {
        self.type_into("alpha", "0.2");
        self.click_role(Role::Button, "Lobes");
        self.until_applied_of("albedo");
    }

    /// Frame after frame until a label with this text is there.
    fn until_applied_of(&mut self, text: &str) {
        let start = Instant::now();
        while self.harness.query_all_by_label_contains(text).next().is_none() {
            assert!(start.elapsed() < PATIENCE, "never told: {text}");
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
    }
}

fn white() -> Channel {
    Channel::white(Roughness::from_alpha(0.2).unwrap())
}

#[test]
fn the_curves_figures_are_the_library_s() {
    let mut desk = Desk::new();
    assert!(desk.harness.query_by_label("Lobe curves").is_none(), "closed, it costs nothing");
    desk.open_lobes();
    let curves = lobe_curves(Quantity::FCos, white(), 45f64.to_radians(), 361);
    desk.until_applied_of(&curves.caption());
    for (model, albedo) in Model::ALL.into_iter().zip(curves.albedo) {
        desk.harness.get_by_label(&format!("{albedo:.4}"));
        let at_mirror = value(model, Quantity::FCos, white(), curves.theta_o, curves.theta_o);
        assert!(desk.harness.query_all_by_label(&digits(at_mirror, 4)).next().is_some());
    }
    // Of another quantity, in other axes.
    for (label, caption) in [("D", "D, alpha 0.2000"), ("G1", "G1, alpha 0.2000")] {
        desk.click_role(Role::Button, label);
        desk.until_applied_of(caption);
    }
    for label in ["Polar", "Log", "Cartesian", "Linear"] {
        desk.click(label);
        desk.harness.run_ok();
    }
    desk.harness.get_by_label("Lobe curves");
}

#[test]
fn values_are_told_at_the_pointer_and_by_the_arrow_keys() {
    let mut desk = Desk::new();
    desk.open_lobes();
    desk.until_applied_of("at 45.0\u{b0}");
    let plot = desk.harness.get_by_label("Lobe curves").rect();
    desk.harness.hover_at(plot.center());
    desk.harness.run_ok();
    assert!(desk.harness.query_by_label("at 45.0\u{b0}").is_none(), "the pointer is elsewhere");
    desk.harness.hover_at(egui::pos2(1.0, 1.0));
    desk.harness.run_ok();
    desk.harness.get_by_label("at 45.0\u{b0}");
    desk.harness.get_by_label("Lobe curves").focus();
    desk.harness.run_ok();
    for _ in 0..3 {
        desk.key(Key::ArrowLeft);
    }
    desk.harness.run_ok();
    desk.harness.get_by_label("at 42.0\u{b0}");
}

#[test]
fn the_viewer_s_angle_is_the_clicked_pixel_s_and_f_the_picked_material_s() {
    let mut desk = Desk::new();
    desk.open_lobes();
    desk.click_pixel(RIGHT_BALL);
    let hit = desk.doc().clicked_hit().unwrap();
    desk.click("Clicked");
    let degrees = hit.theta_o.to_degrees();
    desk.until_applied_of(&format!("viewer at {degrees:.1}"));
    let material = desk.doc().picked_material().unwrap().clone();
    let kd: f32 = burnish::math::Rgb::from(material.kd).luminance();
    desk.until_applied_of(&format!("Kd {kd:.3}, Ks 0.300"));
    // It keeps up with the camera.
    desk.document(|d| d.params.camera.eye.x += 0.1);
    let moved = desk.doc().clicked_hit().map(|h| h.theta_o.to_degrees());
    desk.until_applied_of(&format!("viewer at {:.1}", moved.unwrap()));
    // The slider leaves the pixel and keeps its material.
    desk.type_into("theta of wo", "30");
    desk.until_applied_of(&format!("Kd {kd:.3}, Ks 0.300, viewer at 30.0"));
    desk.click("F = 1");
    desk.until_applied_of("F = 1, viewer at 30.0");
}

#[test]
fn the_curves_are_copied_as_a_table_and_written_as_svg_and_png() {
    let mut desk = Desk::new();
    desk.open_lobes();
    let curves = lobe_curves(Quantity::FCos, white(), 45f64.to_radians(), 361);
    desk.until_applied_of(&curves.caption());
    desk.click("Copy CSV");
    let copied = desk.harness.output().platform_output.commands.iter().find_map(|c| match c {
        OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert_eq!(copied.unwrap(), curves.csv());
    desk.click("Save SVG");
    desk.until("plot", |app| app.notice.as_ref().is_some_and(|n| n.text.starts_with("Wrote")));
    assert_eq!(desk.files(), ["lobes_f-cos_alpha-0.2000_0001.svg"]);
    let path = desk.folder.path().join("out").join(&desk.files()[0]);
    assert!(std::fs::read_to_string(path).unwrap().starts_with("<svg"));
    // The window is asked for a picture of itself, of which the plot is cut out.
    desk.click("Save PNG");
    let plot = desk.harness.get_by_label("Lobe curves").rect();
    let viewport = &desk.harness.output().viewport_output[&egui::ViewportId::ROOT];
    let callback = viewport.commands.iter().find_map(|c| match c {
        ViewportCommand::Screenshot(callback) => Some(callback.clone()),
        _ => None,
    });
    let image = ColorImage::filled([1280, 1600], Color32::from_rgb(10, 200, 30));
    callback.expect("no picture of the window asked for").complete(Arc::new(image));
    desk.until("picture", |app| app.notice.as_ref().is_some_and(|n| n.text.contains(".png")));
    let path = desk.folder.path().join("out/lobes_f-cos_alpha-0.2000_0001.png");
    let written = image::open(path).unwrap().to_rgb8();
    assert_eq!(written.width(), plot.width().round() as u32);
    assert_eq!(written.height(), plot.height().round() as u32);
    assert_eq!(written.get_pixel(5, 5).0, [10, 200, 30]);
}
