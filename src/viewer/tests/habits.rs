//! What people expect of any window that shows pictures.

use super::*;

#[test]
fn the_title_says_how_far_the_picture_is() {
    let mut desk = Desk::done(3);
    let title = |desk: &Desk| desk.app().title().to_owned();
    assert_eq!(title(&desk), "two.scn - burnish");
    desk.document(|d| d.set_limit(1 << 30));
    desk.until("a part of the way", |app| app.title().starts_with("0 % - two.scn"));
}

#[test]
fn the_picture_is_copied_as_it_is_shown() {
    let mut desk = Desk::done(2);
    desk.harness.event(Event::Copy);
    desk.harness.step();
    assert!(desk.notice().contains("64 x 48"), "{}", desk.notice());
    let commands = &desk.harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image.pixels.clone()),
        _ => None,
    });
    assert!(copied.expect("nothing on the clipboard") == desk.shown());
}

#[test]
fn a_decimal_comma_is_a_decimal_point() {
    let mut desk = Desk::done(1);
    desk.type_into("alpha", "0,25");
    assert_eq!(desk.alpha(), 0.25);
}

#[test]
fn the_help_has_a_button() {
    let mut desk = Desk::done(1);
    assert!(!desk.app().help.open);
    desk.click_role(Role::Button, "Help");
    desk.harness.run_ok();
    assert!(desk.app().help.open);
}

#[test]
fn escape_dismisses_one_thing_after_the_other() {
    let mut desk = Desk::done(1);
    desk.click_pixel(RIGHT_BALL);
    desk.key(Key::C);
    desk.key(Key::N);
    desk.key(Key::T);
    desk.key(Key::F1);
    desk.harness.run_ok();
    let state = |desk: &Desk| {
        let app = desk.app();
        let told = app.notice.is_some();
        [app.help.open, told, app.alone, app.doc().comparison.on, desk.doc().only_picked]
    };
    assert_eq!(state(&desk), [true; 5]);
    for gone in 1..=5 {
        desk.key(Key::Escape);
        desk.harness.run_ok();
        let state = state(&desk);
        assert!(state.iter().enumerate().all(|(i, on)| *on == (i >= gone)), "{gone}: {state:?}");
    }
}

#[test]
fn escape_leaves_a_text_and_nothing_else() {
    let mut desk = Desk::done(1);
    desk.key(Key::C);
    desk.harness.run_ok();
    let before = desk.alpha();
    desk.click_role(Role::SpinButton, "alpha");
    desk.harness.step();
    desk.harness.event(Event::Text("0.7".to_owned()));
    desk.harness.step();
    desk.key(Key::Escape);
    desk.harness.run_ok();
    assert!(desk.doc().comparison.on);
    assert_eq!(desk.alpha(), before);
}

#[test]
fn what_is_typed_in_vain_is_told() {
    let mut desk = Desk::done(1);
    desk.type_into("alpha", "7");
    assert_eq!(desk.notice(), "alpha: 7 is out of range, which is 0.0001 to 1; 1 was taken");
    assert_eq!(desk.alpha(), 1.0);
    desk.type_into("alpha", "rough");
    assert_eq!(desk.notice(), "alpha: \"rough\" is no number; it stays as it was");
    assert_eq!(desk.alpha(), 1.0);
    desk.key(Key::Escape);
    assert_eq!(desk.notice(), "");
    // What is in range, or not changed at all, is no news.
    desk.type_into("alpha", "0.3");
    desk.click_role(Role::SpinButton, "a_p");
    desk.harness.step();
    desk.key(Key::Enter);
    desk.harness.run_ok();
    assert_eq!((desk.notice(), desk.alpha()), ("", 0.3));
    desk.type_into("Pass limit", "0");
    assert!(desk.notice().starts_with("Pass limit: 0 is out of range"), "{}", desk.notice());
    assert_eq!(desk.doc().goal.passes, 1);
    desk.click_pixel(RIGHT_BALL);
    desk.key(Key::P);
    desk.settle();
    desk.type_into("Column", "64");
    assert!(desk.notice().starts_with("Column: 64 is out of range, which is 0 to 63"));
    assert_eq!(desk.doc().clicked, Some([63, 24]));
}

/// Typing into a colour goes on by Tab where Ks is 0 at first: what is typed does not go to shortcuts.
#[test]
fn the_keyboard_stays_in_its_field_when_a_lobe_appears() {
    let mut desk = Desk::done(1);
    desk.click_pixel(RIGHT_BALL);
    desk.document(|d| {
        let material = d.picked_material().unwrap().clone();
        d.set_picked(burnish::scene::Material { ks: [0.0; 3], ..material });
    });
    desk.settle();
    desk.click_role(Role::SpinButton, "Ks red");
    desk.harness.step();
    for _ in 0..3 {
        desk.harness.event(Event::Text("0.5".to_owned()));
        desk.harness.step();
        desk.key(Key::Tab);
        desk.harness.step();
        assert!(desk.harness.ctx.memory(|m| m.focused().is_some()));
    }
    desk.harness.run_ok();
    assert_eq!(desk.doc().picked_material().unwrap().ks, [0.5; 3]);
}

#[test]
fn what_a_roughness_concerns_is_first_in_the_list() {
    let scene = SCENE.replace("brdf 0.5 0.1 0.1 0.1 0.1 0.1 50", "brdf 0.5 0.1 0.1 0 0 0 50");
    let mut desk = Desk::reading(&scene);
    desk.until("a picture", |app| app.render.as_ref().is_some_and(|r| r.newest.is_some()));
    desk.settle();
    let height = |desk: &Desk, i: usize| {
        let name = desk.doc().params.materials[i].name.clone();
        desk.harness.get_by_role_and_label(Role::Button, &name).rect().top()
    };
    let [matte, glossy, lamp] = [0, 1, 2].map(|i| height(&desk, i));
    assert!(glossy < lamp && lamp < matte, "{glossy} {lamp} {matte}");
}

#[test]
fn exposure_belongs_to_the_scene() {
    let mut desk = Desk::done(1);
    let own = desk.doc().source.clone();
    desk.key(Key::E);
    desk.click("Filmic");
    let open = |desk: &mut Desk, source: Source| {
        let number = desk.doc().number;
        let ctx = desk.harness.ctx.clone();
        desk.harness.state_mut().as_mut().unwrap().load(&ctx, source, false);
        desk.until("another scene", |app| app.document.as_ref().unwrap().number > number);
        desk.doc().tone
    };
    let tone = |exposure| burnish::picture::Tone { exposure, curve: Curve::Filmic };
    assert_eq!(open(&mut desk, Source::named("cornell".into())), tone(0.0));
    assert_eq!(open(&mut desk, own), tone(0.5));
}

#[test]
fn the_selected_surfaces_are_framed() {
    let mut desk = Desk::done(1);
    let home = desk.doc().params.camera;
    desk.click_pixel(RIGHT_BALL);
    desk.key(Key::F);
    let framed = desk.doc().params.camera;
    assert_eq!(framed.orientation, home.orientation);
    // Straight ahead is the middle of that ball, about (1, 0, 0).
    let to = glam::DVec3::X - framed.eye;
    assert!(to.cross(framed.axes()[2]).length() < 1e-5, "{to}");
    desk.key(Key::Escape);
    desk.key(Key::F);
    assert!(desk.doc().params.camera.eye.distance(framed.eye) > 1.0, "all of the scene");
}

#[test]
fn what_a_drag_holds_stays_in_its_place() {
    let mut desk = Desk::done(1);
    let from = desk.point([32.0 + 10.0, 24.0]);
    desk.harness.hover_at(from);
    desk.harness.step();
    desk.press(from, PointerButton::Primary, true, Modifiers::NONE);
    let params = desk.doc().params.clone();
    let held = params.scene.first_hit(&params.camera, params.size, [42.0, 24.0]).unwrap().point;
    for i in 1..=4 {
        desk.harness.hover_at(from + vec2(15.0, 4.0) * i as f32);
        desk.harness.step();
    }
    let camera = desk.doc().params.camera;
    assert_ne!(camera, params.camera);
    let beyond = held + (held - camera.eye);
    let at = camera.project(held, beyond, params.size).unwrap()[0];
    assert!((at[0] - 42.0).hypot(at[1] - 24.0) < 0.5, "{at:?}");
}

#[test]
fn a_part_of_the_picture_is_traced_alone() {
    let mut desk = Desk::done(2);
    let whole = desk.doc().params.camera;
    // From a quarter to three quarters of the picture, either way.
    let (from, by) =
        (desk.point([16.0, 12.0]), desk.point([48.0, 36.0]) - desk.point([16.0, 12.0]));
    let held = Modifiers::CTRL | Modifiers::COMMAND;
    desk.harness.event(Event::ModifiersChanged(held));
    desk.harness.hover_at(from);
    desk.harness.step();
    desk.press(from, PointerButton::Primary, true, held);
    for i in 1..=4 {
        desk.harness.hover_at(from + by * (i as f32 / 4.0));
        desk.harness.step();
        assert_eq!(desk.doc().params.camera, whole, "not before it is let go");
    }
    desk.press(from + by, PointerButton::Primary, false, held);
    desk.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    desk.harness.run_ok();
    let [x, y, side] = desk.doc().params.camera.crop.parts();
    for (part, expected) in [(x, 0.25), (y, 0.25), (side, 0.5)] {
        assert!((part - expected).abs() < 1e-3, "{x} {y} {side}");
    }
    desk.until_done(2);
    // The balls are twice as large: their edges, black behind, are where they were, doubled.
    let twice = desk.newest().mean();
    let before = desk.app().render.as_ref().unwrap();
    assert_eq!(before.applied().size, [64, 48]);
    let once = {
        let params = burnish::progressive::Params { camera: whole, ..desk.doc().params.clone() };
        burnish::progressive::render(params, 2, 1).unwrap().mean()
    };
    let dark = |p: [f32; 3]| p == [0.0; 3];
    let differ = (0..48 * 64).filter(|i| {
        let (x, y) = (i % 64, i / 64);
        let small = once.pixels[(12 + y / 2) * 64 + 16 + x / 2];
        dark(small) != dark(twice.pixels[*i])
    });
    assert!(differ.count() < 300, "not the part that was chosen");
    assert!(twice.pixels.iter().any(|&p| dark(p)) && twice.pixels.iter().any(|&p| !dark(p)));
    desk.key(Key::W);
    assert_eq!(desk.doc().params.camera, whole);
    desk.chord(held, Key::Z);
    assert_eq!(desk.doc().params.camera.crop.parts(), [x, y, side], "an edit like others");
}
