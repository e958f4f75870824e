//! Places: what moves, and what stays where it is while sections open and windows grow.

use super::*;
use egui_kittest::kittest::NodeT;

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
fn controls_stay_in_place_without_a_lobe() {
    let mut desk = Desk::done(1);
    desk.click_pixel(RIGHT_BALL);
    desk.settle();
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
    desk.settle();
    assert!(desk.harness.query_by_label_contains("No specular lobe").is_some());
    assert_eq!(places(&desk), before);
}

#[test]
fn a_section_opened_at_the_foot_is_seen() {
    let mut desk = Desk::done(1);
    desk.harness.set_size(vec2(1280.0, 500.0));
    desk.settle();
    // Opening by the keyboard, for it lies below the window.
    desk.harness.get_by_role_and_label(Role::Button, "Tracing").focus();
    desk.harness.step();
    desk.key(Key::Enter);
    desk.settle();
    let seed = desk.harness.get_by_role_and_label(Role::TextInput, "Seed").rect();
    assert!(seed.bottom() <= 500.0 - 28.0, "{seed:?}");
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
    desk.settle();
    // A size that follows would have settled by then; what does not happen cannot be waited for.
    std::thread::sleep(Duration::from_millis(250));
    desk.settle();
    assert_eq!(desk.doc().params.size, [64, 48]);
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
    desk.settle();
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
        desk.settle();
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
        desk.settle();
        let opened = there(&desk);
        desk.key(key);
        desk.settle();
        assert!(opened > before && there(&desk) == before, "{key:?}");
    }
}

/// A picture that follows the window would begin anew with every point that it gains or loses.
#[test]
fn no_section_changes_the_room_of_the_picture() {
    let mut desk = Desk::done(8);
    desk.harness.set_size(vec2(1280.0, 720.0));
    desk.settle();
    let before = desk.canvas();
    desk.click_pixel(RIGHT_BALL);
    for key in [Key::C, Key::P, Key::L, Key::G, Key::P, Key::L, Key::G, Key::C] {
        desk.key(key);
        desk.settle();
        assert_eq!(desk.canvas(), before, "{key:?}");
    }
}
