//! The picture: what is shown of a render, and the pointer and keys over it.

use super::*;

#[test]
fn the_models_give_different_pictures() {
    let mut desk = Desk::done(4);
    let ggx = desk.shown();
    desk.key(Key::Num2);
    desk.until_done(4);
    assert!(ggx != desk.shown());
    desk.key(Key::Num3);
    desk.until_done(4);
    assert!(ggx == desk.shown(), "the same parameters and passes are the same picture");
}

#[test]
fn exposure_and_curve_change_what_is_shown_and_not_what_is_traced() {
    let mut desk = Desk::done(2);
    let (epoch, before) = (desk.newest().epoch, desk.shown());
    desk.key(Key::E);
    desk.harness.run();
    assert_eq!(desk.doc().tone.exposure, 0.5);
    let brighter = desk.shown();
    let sum = |codes: &[Color32]| codes.iter().map(|c| u64::from(c.r())).sum::<u64>();
    assert!(sum(&brighter) > sum(&before));
    desk.chord(Modifiers::SHIFT, Key::E);
    desk.harness.run();
    assert!(desk.shown() == before);
    desk.click("Filmic");
    desk.harness.run();
    assert!(desk.shown() != before);
    assert_eq!((desk.newest().epoch, desk.newest().passes), (epoch, 2));
}

#[test]
fn the_card_holds_the_tone_mapped_means() {
    let desk = Desk::done(2);
    let mean = desk.newest().mean();
    let tone = desk.doc().tone;
    for (shown, &radiance) in desk.shown().iter().zip(&mean.pixels) {
        let [r, g, b] = tone.exact(radiance);
        assert_eq!(*shown, Color32::from_rgb(r, g, b));
        assert_ne!([r, g, b], NAN_COLOUR);
    }
    assert!(mean.pixels.iter().any(|p| p[0] > 0.0), "the picture is black");
}

#[test]
fn a_click_picks_the_material_and_the_background_picks_all() {
    let mut desk = Desk::new();
    assert!(!desk.doc().only_picked);
    desk.click_pixel(RIGHT_BALL);
    let name = desk.doc().params.materials[1].name.clone();
    assert_eq!((desk.doc().picked, desk.doc().only_picked), (Some(1), true));
    let camera = desk.doc().params.camera;
    desk.type_into("alpha", "0.25");
    let alphas: Vec<f64> =
        desk.doc().params.materials.iter().map(|m| m.roughness.alpha()).collect();
    assert_eq!(alphas[1], 0.25);
    assert_ne!(alphas[0], 0.25);
    desk.click_pixel(LEFT_BALL);
    assert_eq!(desk.doc().picked, Some(0));
    desk.click_pixel(BACKGROUND);
    assert!(!desk.doc().only_picked);
    assert_eq!(desk.doc().params.camera, camera, "a click is not a drag");
    // Its name is in the list and, once picked, in the choice above.
    desk.click_pixel(RIGHT_BALL);
    assert_eq!(desk.harness.query_all_by_label(&name).count(), 2);
}

#[test]
fn drags_and_the_wheel_move_the_camera_and_home_puts_it_back() {
    let mut desk = Desk::new();
    let home = desk.doc().params.camera;
    let centre = desk.doc().subject().centre;
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    let orbited = desk.doc().params.camera;
    assert_ne!(orbited, home);
    assert!(orbited.eye.x < home.eye.x, "dragging to the right turns the scene to the right");
    assert!(orbited.axes()[0].z.abs() < 1e-9, "the horizon tilts");
    desk.key(Key::Home);
    assert_eq!(desk.doc().params.camera, home);
    for (button, modifiers) in
        [(PointerButton::Middle, Modifiers::NONE), (PointerButton::Primary, Modifiers::SHIFT)]
    {
        desk.drag(vec2(40.0, 0.0), button, modifiers);
        let panned = desk.doc().params.camera;
        assert!(panned.eye.x < home.eye.x && panned.orientation == home.orientation, "{button:?}");
        desk.click("Home");
    }
    let at = desk.point([32.0, 24.0]);
    desk.harness.hover_at(at);
    desk.harness.step();
    desk.harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    desk.harness.run_steps(10);
    let nearer = desk.doc().params.camera;
    assert!((nearer.eye - centre).length() < (home.eye - centre).length());
    assert_eq!(nearer.orientation, home.orientation);
    desk.key(Key::F);
    let framed = desk.doc().params.camera;
    assert!(framed != nearer && framed.orientation == home.orientation);
}

#[test]
fn the_focused_picture_takes_the_arrow_keys() {
    let mut desk = Desk::new();
    let home = desk.doc().params.camera;
    desk.key(Key::ArrowLeft);
    assert_eq!(desk.doc().params.camera, home, "without focus nothing moves");
    desk.harness.get_by_role_and_label(Role::Image, "Picture").focus();
    desk.harness.step();
    desk.key(Key::ArrowLeft);
    let turned = desk.doc().params.camera;
    assert_ne!(turned.orientation, home.orientation);
    desk.chord(Modifiers::SHIFT, Key::ArrowUp);
    assert_eq!(desk.doc().params.camera.orientation, turned.orientation);
    assert_ne!(desk.doc().params.camera.eye, turned.eye);
    desk.key(Key::Space);
    assert!(desk.doc().paused, "Space still pauses");
}

#[test]
fn a_finished_window_is_not_redrawn() {
    let mut desk = Desk::done(2);
    desk.until_at_rest();
}

#[test]
fn every_size_of_window_is_drawn() {
    let mut desk = Desk::new();
    for size in [[1.0, 1.0], [200.0, 100.0], [320.0, 480.0], [4000.0, 3000.0]] {
        for scale in [1.0, 2.0] {
            desk.harness.set_size(size.into());
            desk.harness.set_pixels_per_point(scale);
            desk.key(Key::Z);
            desk.harness.run_steps(2);
        }
    }
}

#[test]
fn the_pixel_under_the_pointer_is_told() {
    let mut desk = Desk::done(8);
    let at = desk.point([42.5, 24.5]);
    desk.harness.hover_at(at);
    desk.harness.run_ok();
    let hover = desk.app().canvas.hover.unwrap();
    assert_eq!((hover.pixel, hover.passes), ([42, 24], 8));
    assert_eq!(hover.mean, desk.newest().mean().pixels[24 * 64 + 42]);
    let error = desk.newest().standard_error().pixels[24 * 64 + 42];
    assert_eq!(hover.standard_error, Some(error));
    assert!(error[0] > 0.0, "{error:?}");
    assert_eq!(hover.samples, desk.newest().samples()[24 * 64 + 42]);
    // In the status line, below the picture and not over it, in columns that stay.
    let line = |desk: &Desk| {
        let node = desk.harness.get_by_label_contains("RGB  ");
        (node.rect(), node.value().unwrap_or_default())
    };
    let (place, text) = line(&desk);
    assert_eq!(text, crate::viewer::panels::status::hovered(&hover, [64, 48])[0]);
    assert!(place.min.y >= desk.canvas().max.y, "over the picture");
    let corner = desk.point([0.5, 0.5]);
    desk.harness.hover_at(corner);
    desk.harness.run_ok();
    let (other, text_there) = line(&desk);
    assert_eq!(other, place);
    assert_eq!(text.chars().count(), text_there.chars().count());
    // Narrow windows leave out the end, and not the pixel.
    desk.harness.set_size(vec2(900.0, 600.0));
    desk.harness.run_ok();
    let at = desk.point([42.5, 24.5]);
    desk.harness.hover_at(at);
    desk.harness.run_ok();
    let hover = desk.app().canvas.hover.unwrap();
    let texts = crate::viewer::panels::status::hovered(&hover, [64, 48]);
    assert!(texts[1..].contains(&line(&desk).1), "{:?}", line(&desk));
    desk.harness.hover_at(egui::pos2(1.0, 1.0));
    desk.harness.run_ok();
    assert!(desk.app().canvas.hover.is_none());
    assert!(desk.harness.query_by_label_contains("RGB  ").is_none());
}

fn wheel(desk: &mut Desk, modifiers: Modifiers) {
    desk.harness.event(Event::ModifiersChanged(modifiers));
    desk.harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers,
    });
    desk.harness.run_steps(10);
    desk.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    desk.harness.run_ok();
}

#[test]
fn the_picture_is_zoomed_about_the_pointer() {
    let mut desk = Desk::done(2);
    let camera = desk.doc().params.camera;
    let at = desk.point([42.5, 24.5]);
    desk.harness.hover_at(at);
    desk.harness.step();
    wheel(&mut desk, Modifiers::CTRL | Modifiers::COMMAND);
    let zoomed = desk.app().canvas.hover.unwrap();
    assert_eq!(zoomed.pixel, [42, 24], "the pixel under the pointer stays");
    assert_eq!(desk.doc().params.camera, camera, "the picture is zoomed, not the camera moved");
    desk.key(Key::Z);
    desk.harness.run_ok();
    assert_eq!(desk.app().canvas.hover.unwrap().pixel, [42, 24], "fitted again");
}

#[test]
fn a_large_picture_is_given_its_tones_elsewhere_and_all_of_it_at_once() {
    let mut desk = Desk::done(1);
    desk.document(|d| d.params.size = [900, 700]);
    desk.until("the large picture", |app| {
        let newest = app.render.as_ref().unwrap().newest.as_ref().unwrap();
        newest.grid.size == [900, 700] && newest.state == State::Done && app.canvas.is_settled()
    });
    let shown = |desk: &Desk| {
        let textures = desk.card.0.borrow();
        let mut large = textures.values().filter(|(w, p)| *w == 900 && p.len() == 900 * 700);
        large.next().expect("not on the card").1.clone()
    };
    let codes = |desk: &Desk| -> Vec<Color32> {
        let (mean, tone) = (desk.newest().mean(), desk.doc().tone);
        mean.pixels
            .iter()
            .map(|&p| tone.exact(p))
            .map(|[r, g, b]| Color32::from_rgb(r, g, b))
            .collect()
    };
    assert!(shown(&desk) == codes(&desk));
    desk.key(Key::E);
    desk.until("the new exposure", |app| app.canvas.is_settled());
    assert!(shown(&desk) == codes(&desk));
}
