//! What people expect of any window that shows pictures.

use super::*;
use egui_kittest::kittest::NodeT;
use std::sync::Arc;

#[test]
fn the_title_says_how_far_the_picture_is() {
    let mut desk = Desk::done(3);
    let title = |desk: &Desk| desk.app().title().to_owned();
    assert_eq!(title(&desk), "two.scn - burnish");
    desk.document(|d| d.set_limit(1 << 30));
    desk.until("a part of the way", |app| app.title().starts_with("0 % - two.scn"));
}

#[test]
fn the_picture_can_have_the_window_for_itself() {
    let mut desk = Desk::done(1);
    let narrow = desk.canvas().width();
    desk.key(Key::N);
    desk.harness.run_ok();
    assert!(desk.canvas().width() > narrow + 250.0);
    assert!(desk.harness.query_by_label("Pass limit").is_none());
    desk.key(Key::N);
    desk.harness.run_ok();
    assert_eq!(desk.canvas().width(), narrow);
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

/// Draws until nothing moves any more.
fn settled(desk: &mut Desk) {
    for _ in 0..30 {
        desk.harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    desk.harness.run_ok();
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
    settled(&mut desk);
    desk.type_into("Column", "64");
    assert!(desk.notice().starts_with("Column: 64 is out of range, which is 0 to 63"));
    assert_eq!(desk.doc().clicked, Some([63, 24]));
}

#[test]
fn controls_stay_in_place_without_a_lobe() {
    let mut desk = Desk::done(1);
    desk.click_pixel(RIGHT_BALL);
    settled(&mut desk);
    let places = |desk: &Desk| {
        let field = |name| desk.harness.get_by_role_and_label(Role::SpinButton, name).rect();
        let button = |name| desk.harness.get_by_role_and_label(Role::Button, name).rect();
        [
            field("alpha"),
            field("a_p"),
            field("Pass limit"),
            button("Snapshot"),
            button("Copy command"),
        ]
    };
    let before = places(&desk);
    desk.document(|d| {
        let material = d.picked_material().unwrap().clone();
        d.set_picked(burnish::scene::Material { ks: [0.0; 3], ..material });
    });
    settled(&mut desk);
    assert!(desk.harness.query_by_label_contains("No specular lobe").is_some());
    assert_eq!(places(&desk), before);
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
    settled(&mut desk);
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
    settled(&mut desk);
    let height = |desk: &Desk, i: usize| {
        let name = desk.doc().params.materials[i].name.clone();
        desk.harness.get_by_role_and_label(Role::Button, &name).rect().top()
    };
    let [matte, glossy, lamp] = [0, 1, 2].map(|i| height(&desk, i));
    assert!(glossy < lamp && lamp < matte, "{glossy} {lamp} {matte}");
}

#[test]
fn a_section_opened_at_the_foot_is_seen() {
    let mut desk = Desk::done(1);
    desk.harness.set_size(vec2(1280.0, 500.0));
    settled(&mut desk);
    // Opening by the keyboard, for it lies below the window.
    desk.harness.get_by_role_and_label(Role::Button, "Tracing").focus();
    desk.harness.step();
    desk.key(Key::Enter);
    settled(&mut desk);
    let seed = desk.harness.get_by_role_and_label(Role::TextInput, "Seed").rect();
    assert!(seed.bottom() <= 500.0 - 28.0, "{seed:?}");
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
fn the_picture_follows_the_window_once_that_stands_still() {
    let mut desk = Desk::with(SCENE, Settings::default(), |_| Picked::Nothing);
    desk.harness.set_size(vec2(500.0, 300.0));
    desk.until("a picture", |app| {
        let newest = app.render.as_ref().and_then(|r| r.newest.as_ref());
        newest.is_some_and(|s| s.grid.size == app.canvas.room && s.passes > 0)
    });
    let size = desk.doc().params.size;
    let room = desk.canvas().size() - Vec2::splat(32.0);
    assert_eq!(size, [room.x as u32, room.y as u32]);
    // Pixel by pixel.
    assert_eq!(desk.app().canvas.place.unwrap().size(), vec2(size[0] as f32, size[1] as f32));
    assert!(!desk.doc().can_undo(), "a window's size is no edit");
    desk.harness.set_size(vec2(520.0, 310.0));
    desk.harness.step();
    assert_eq!(desk.doc().params.size, size, "it has only begun to grow");
    desk.until("a larger picture", |app| {
        app.document.as_ref().unwrap().params.size == [size[0] + 20, size[1] + 10]
    });
    // Undo takes back an edit and leaves the size.
    desk.document(|d| d.tone.exposure = 1.0);
    desk.harness.run_ok();
    assert!(desk.document(|d| d.undo()));
    assert_eq!(desk.doc().params.size, [size[0] + 20, size[1] + 10]);
    // A size that was chosen stays.
    desk.document(|d| (d.follow, d.params.size) = (false, [64, 48]));
    desk.harness.set_size(vec2(600.0, 400.0));
    settled(&mut desk);
    std::thread::sleep(Duration::from_millis(250));
    settled(&mut desk);
    assert_eq!(desk.doc().params.size, [64, 48]);
}

/// Opens a picture as if it were dropped.
fn open(desk: &mut Desk, name: &str) {
    let path = desk.folder.path().join("out").join(name);
    let ctx = desk.harness.ctx.clone();
    desk.harness.state_mut().as_mut().unwrap().load(&ctx, Source::File(path), false);
}

#[test]
fn a_snapshot_is_a_reference_and_goes_on() {
    let mut desk = Desk::done(20);
    desk.type_into("alpha", "0.31");
    desk.drag(vec2(30.0, 10.0), PointerButton::Primary, Modifiers::NONE);
    desk.until_done(20);
    let before = (desk.newest().mean(), desk.doc().params.camera);
    desk.key(Key::S);
    desk.until("files", |app| app.saving.is_none());
    let files = desk.files();
    let [exr, png] = ["exr", "png"]
        .map(|kind| files.iter().find(|name| name.ends_with(kind)).expect("no snapshot").clone());
    for name in [exr, png] {
        // Elsewhere meanwhile.
        desk.key(Key::Home);
        desk.key(Key::Num1);
        desk.type_into("alpha", "0.05");
        open(&mut desk, &name);
        if name.ends_with("exr") {
            desk.until("the reference", |app| {
                app.doc().comparison.file.is_some() && app.doc().comparison.on
            });
            settled(&mut desk);
            desk.click_role(Role::Button, "Resume the file");
        }
        desk.until("the same picture", |app| {
            let render = app.render.as_ref().unwrap();
            app.resuming.is_none()
                && app.document.as_ref().unwrap().params.model == Model::Ggx
                && render.newest.as_ref().is_some_and(|s| s.passes == 20)
        });
        assert_eq!((desk.doc().params.camera, desk.alpha()), (before.1, 0.31));
        assert!(desk.newest().mean() == before.0, "{name}");
        desk.document(|d| d.goal.passes = 24);
        desk.until_done(24);
        desk.document(|d| d.goal.passes = 20);
    }
}

#[test]
fn an_experiment_goes_on_from_its_sums() {
    let mut desk = Desk::done(17);
    let path = desk.folder.path().join("out/sums.exr");
    let (send, told) = std::sync::mpsc::channel();
    let file = desk.doc().source.path().unwrap().to_path_buf();
    let scene = Arc::new(burnish::scene::read::open(&file).unwrap().0.build());
    let params = burnish::progressive::Params::new(scene);
    let options = burnish::progressive::Options::headless(1);
    let session = burnish::progressive::Session::with_options(params, 17, options, || {}).unwrap();
    session.visit_experiment(move |experiment| send.send(experiment.save(&path)).unwrap());
    told.recv().unwrap().unwrap();
    let passes = session.latest().map_or(0, |s| s.passes);
    drop(session);
    desk.key(Key::Num1);
    desk.until_done(17);
    open(&mut desk, "sums.exr");
    desk.until("the reference", |app| {
        app.doc().comparison.file.is_some() && app.doc().comparison.on
    });
    settled(&mut desk);
    desk.click_role(Role::Button, "Resume the file");
    desk.until("the picture", |app| app.resuming.is_none() && !app.doc().comparison.on);
    assert!(desk.notice().starts_with("Goes on after"), "{} {passes}", desk.notice());
    desk.until_done(17);
    let whole = burnish::progressive::render(desk.doc().params.clone(), 17, 1).unwrap();
    assert!(desk.newest().mean() == whole.mean());
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
fn zooming_beside_the_picture_does_not_lose_it() {
    let mut desk = Desk::done(1);
    let space = desk.canvas();
    desk.harness.hover_at(space.left_top() + Vec2::splat(2.0));
    desk.harness.step();
    desk.harness.event(Event::ModifiersChanged(Modifiers::CTRL | Modifiers::COMMAND));
    for _ in 0..10 {
        desk.harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, 30.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
            modifiers: Modifiers::CTRL | Modifiers::COMMAND,
        });
        desk.harness.run_steps(5);
    }
    let place = desk.app().canvas.place.unwrap();
    assert!(place.width() > 2.0 * space.width(), "{place:?}");
    assert!(place.intersect(space).area() > 0.0, "{place:?} is not in {space:?}");
}

#[test]
fn the_panel_s_right_margin_is_kept_by_every_section() {
    let mut desk = Desk::done(4);
    desk.harness.set_size(vec2(1280.0, 4000.0));
    desk.click_pixel(RIGHT_BALL);
    settled(&mut desk);
    let sections = crate::viewer::style::labels::table().into_iter().map(|(part, _)| part);
    let open = ["Materials", "View"];
    let closed: Vec<&str> = sections
        .chain(["Checks"])
        .filter(|name| !open.contains(name))
        .filter(|name| desk.harness.query_by_role_and_label(Role::Button, name).is_some())
        .collect();
    assert!(closed.len() > 4, "{closed:?}");
    for section in closed {
        desk.click_role(Role::Button, section);
        settled(&mut desk);
    }
    // The harness has a margin of 8 points around all.
    let right = 1280.0 - 8.0 - 16.0;
    let left = desk.canvas().right();
    let (mut seen, mut beyond) = (0, Vec::new());
    for role in [Role::Button, Role::SpinButton, Role::Label, Role::ComboBox, Role::Slider] {
        for node in desk.harness.query_all_by_role(role).filter(|n| n.rect().left() > left) {
            seen += 1;
            // Less than half a point is a rounding.
            if node.rect().right() > right + 0.5 {
                let name = node.accesskit_node().label().or_else(|| node.value());
                beyond.push((role, name, node.rect()));
            }
        }
    }
    assert!(beyond.is_empty(), "{beyond:#?}");
    assert!(seen > 100, "{seen}");
}

#[test]
fn the_full_screen_is_the_picture_s() {
    let mut desk = Desk::done(1);
    desk.key(Key::F11);
    desk.harness.run_ok();
    assert!(desk.harness.query_by_label("Pass limit").is_none());
    desk.key(Key::Escape);
    desk.harness.run_ok();
    assert!(!desk.app().full_screen && desk.harness.query_by_label("Pass limit").is_some());
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

#[test]
fn a_window_s_size_is_not_saved_with_the_scene() {
    let mut desk = Desk::done(1);
    desk.document(|d| d.follow = true);
    desk.until("another size", |app| app.document.as_ref().unwrap().params.size != [64, 48]);
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    desk.until("the file", |app| app.saving.is_none() && app.notice.is_some());
    let saved = std::fs::read_to_string(desk.folder.path().join("two-edited.scn")).unwrap();
    assert_eq!(saved, SCENE);
}

#[test]
fn sections_have_keys() {
    let mut desk = Desk::done(1);
    for (key, inside) in [(Key::L, "Quantity"), (Key::P, "Pixel")] {
        let there = |desk: &Desk| desk.harness.query_all_by_label(inside).count();
        let before = there(&desk);
        desk.key(key);
        settled(&mut desk);
        let opened = there(&desk);
        desk.key(key);
        settled(&mut desk);
        assert!(opened > before && there(&desk) == before, "{key:?}");
    }
}

/// A picture that follows the window would begin anew with every point that it gains or loses.
#[test]
fn no_section_changes_the_room_of_the_picture() {
    let mut desk = Desk::done(8);
    desk.harness.set_size(vec2(1280.0, 720.0));
    settled(&mut desk);
    let before = desk.canvas();
    desk.click_pixel(RIGHT_BALL);
    for key in [Key::C, Key::P, Key::L, Key::G, Key::P, Key::L, Key::G, Key::C] {
        desk.key(key);
        settled(&mut desk);
        assert_eq!(desk.canvas(), before, "{key:?}");
    }
}
