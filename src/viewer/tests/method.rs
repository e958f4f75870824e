//! Errata, strategies and normals.

use super::*;
use burnish::brdf::{Erratum, Normals};
use burnish::progressive::Strategy;

/// With the section open, a picture of a few passes there.
fn desk() -> Desk {
    let mut desk = Desk::done(4);
    desk.click("Sampling");
    desk.click("Deliberate bugs");
    desk.harness.run();
    desk
}

fn choose(desk: &mut Desk, entry: &str) {
    desk.click_role(Role::ComboBox, "Bug");
    desk.harness.run();
    desk.click_role(Role::Button, entry);
    desk.harness.run_ok();
    desk.until_done(4);
}

/// Whether the badge over the picture says this.
fn says(desk: &Desk, words: &str) -> bool {
    desk.harness.query_by_label(words).is_some()
}

fn wrong(erratum: Erratum) -> String {
    format!("WRONG ON PURPOSE: {}", erratum.title())
}

fn no_badge(desk: &Desk) -> bool {
    desk.harness.query_all_by_label_contains("WRONG ON PURPOSE").next().is_none()
}

#[test]
fn an_erratum_is_chosen_by_its_title_badged_and_undone() {
    let mut desk = desk();
    let right = desk.shown();
    assert!(no_badge(&desk));
    for erratum in [Erratum::DoubleDirect, Erratum::GgxGSum] {
        choose(&mut desk, erratum.title());
        assert_eq!(desk.doc().params.erratum, Some(erratum));
        assert_eq!(desk.app().render.as_ref().unwrap().applied().erratum, Some(erratum));
        assert!(says(&desk, &wrong(erratum)));
        assert!(desk.shown() != right);
        let header = desk.harness.get_by_role_and_label(Role::Button, "Deliberate bugs");
        assert_eq!(header.value().as_deref(), Some(erratum.name()));
        assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
    }
    choose(&mut desk, "None");
    assert_eq!(desk.doc().params.erratum, None);
    assert!(no_badge(&desk));
    assert!(desk.shown() == right, "the same bits as before");
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::Z);
    assert!(desk.doc().params.erratum.is_some());
}

#[test]
fn every_erratum_is_in_the_menu() {
    let mut desk = desk();
    desk.click_role(Role::ComboBox, "Bug");
    desk.harness.run();
    for erratum in Erratum::ALL {
        desk.harness.get_by_role_and_label(Role::Button, erratum.title());
    }
}

#[test]
fn an_erratum_about_another_model_says_so_and_changes_nothing() {
    let mut desk = desk();
    desk.key(Key::Num1);
    desk.until_done(4);
    let right = desk.shown();
    choose(&mut desk, Erratum::GgxGSum.title());
    assert!(desk.shown() == right);
    assert!(no_badge(&desk));
    assert!(says(&desk, "A sum under GGX's root: no effect on Phong"));
}

#[test]
fn strategies_and_normals_are_buttons_with_the_same_mean() {
    let mut desk = desk();
    let right = desk.shown();
    for strategy in Strategy::ALL {
        desk.click(strategy.title());
        desk.until_done(4);
        assert_eq!(desk.doc().params.strategy, strategy);
        assert_eq!(desk.shown() == right, strategy == Strategy::Mis);
    }
    desk.click(Strategy::Mis.title());
    desk.click(Normals::Distribution.title());
    desk.until_done(4);
    assert_eq!(desk.doc().params.normals, Normals::Distribution);
    assert!(desk.shown() != right);
    // Phong has nothing to choose.
    desk.key(Key::Num1);
    desk.until_done(4);
    desk.click(Normals::Visible.title());
    assert_eq!(desk.doc().params.normals, Normals::Distribution);
}

#[test]
fn a_wrong_picture_is_saved_under_its_name() {
    let mut desk = desk();
    choose(&mut desk, Erratum::ClampSamples.title());
    desk.key(Key::S);
    desk.until("files", |app| app.notice.is_some());
    let names = ["two_ggx_clamp-samples_0001.exr", "two_ggx_clamp-samples_0001.png"];
    assert_eq!(desk.files(), names);
}
