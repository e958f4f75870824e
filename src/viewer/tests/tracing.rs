//! The section "Tracing": size, seed, depth and threads.

use super::*;
use burnish::progressive::render;

fn desk() -> Desk {
    let mut desk = Desk::done(2);
    desk.click_role(Role::Button, "Tracing");
    desk.harness.run_ok();
    desk
}

fn undo(desk: &mut Desk) {
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::Z);
    desk.harness.run_ok();
}

#[test]
fn sizes_are_typed_or_chosen() {
    let mut desk = desk();
    desk.type_into("Width", "80");
    desk.type_into("Height", "20");
    assert_eq!(desk.doc().params.size, [80, 20]);
    desk.until("the picture", |app| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().grid.size == [80, 20]
    });
    for nonsense in ["", "wide", "-3", "1e99"] {
        desk.type_into("Width", nonsense);
        let width = desk.doc().params.size[0];
        assert!((1..=32_768).contains(&width), "{nonsense:?}: {width}");
        desk.document(|d| d.params.size = [80, 20]);
    }
    let room = desk.app().canvas.room;
    let fill = format!("Follow the window, {} x {}", room[0], room[1]);
    for (entry, size) in
        [("320 x 240", [320, 240]), ("As in file, 64 x 48", [64, 48]), (fill.as_str(), room)]
    {
        desk.click_role(Role::ComboBox, "Presets");
        desk.harness.run_steps(3);
        desk.click_role(Role::Button, entry);
        assert_eq!((desk.doc().params.size, desk.doc().follow), (size, size == room));
    }
    undo(&mut desk);
    assert_eq!(desk.doc().params.size, [64, 48]);
}

/// Types into the seed's field and leaves it by a key.
fn type_seed(desk: &mut Desk, text: &str, leave: Key) {
    desk.click_role(Role::TextInput, "Seed");
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::A);
    desk.harness.event(Event::Text(text.to_owned()));
    desk.harness.step();
    desk.key(leave);
    desk.harness.run_ok();
}

#[test]
fn every_seed_can_be_typed() {
    let mut desk = desk();
    let before = desk.shown();
    // Beyond what a 64-bit float tells apart.
    type_seed(&mut desk, "18446744073709551613", Key::Enter);
    assert_eq!(desk.doc().params.seed, 18_446_744_073_709_551_613);
    desk.until_done(2);
    assert!(desk.shown() != before, "other noise");
    for (text, leave) in [
        ("", Key::Enter),
        ("x", Key::Enter),
        ("18446744073709551616", Key::Enter),
        ("5", Key::Escape),
    ] {
        type_seed(&mut desk, text, leave);
        assert_eq!(desk.doc().params.seed, u64::MAX - 2, "{text:?}");
    }
    desk.click("Next");
    assert_eq!(desk.doc().params.seed, u64::MAX - 1);
    undo(&mut desk);
    undo(&mut desk);
    assert_eq!(desk.doc().params.seed, 0);
    desk.until_done(2);
    assert!(desk.shown() == before);
}

#[test]
fn the_depth_has_a_limit_or_none() {
    let mut desk = desk();
    assert_eq!(desk.doc().params.max_depth, None);
    desk.click("At most");
    assert_eq!(desk.doc().params.max_depth, Some(8));
    desk.type_into("Depth limit", "1");
    assert_eq!(desk.doc().params.max_depth, Some(1));
    desk.until_done(2);
    let direct = render(desk.doc().params.clone(), 2, 1).unwrap();
    assert!(desk.newest().mean() == direct.mean());
    desk.type_into("Depth limit", "0");
    assert_eq!(desk.doc().params.max_depth, Some(1), "at least one");
    desk.click("Unlimited");
    assert_eq!(desk.doc().params.max_depth, None);
    desk.click("At most");
    assert_eq!(desk.doc().params.max_depth, Some(1), "the last one is remembered");
}

#[test]
fn other_threads_make_the_same_picture_of_the_same_document() {
    let mut desk = desk();
    desk.document(|d| d.params.model = Model::Phong);
    desk.harness.step();
    desk.until_done(2);
    let before = desk.shown();
    desk.type_into("Threads", "3");
    assert_eq!(desk.app().threads, 3);
    desk.until_done(2);
    assert!(desk.shown() == before);
    assert_eq!(desk.doc().params.model, Model::Phong);
    assert!(desk.doc().can_undo(), "the document is the same");
    desk.type_into("Threads", "0");
    assert_eq!(desk.app().threads, 0);
    desk.until_done(2);
    desk.harness.get_by_label_contains("one a core");
    assert!(desk.shown() == before);
}
