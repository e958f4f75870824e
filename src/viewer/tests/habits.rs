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
