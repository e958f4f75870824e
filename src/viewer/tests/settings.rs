//! What is remembered, and what is not.

use super::*;
use crate::viewer::document::goal::{Goal, Stop};
use burnish::picture::Tone;
use egui::ThemePreference;

#[test]
fn the_first_scene_begins_as_remembered_and_only_the_looks_are() {
    let settings = Settings {
        curve: Curve::Reinhard,
        follow: false,
        goal: Goal { stop: Stop::Time, seconds: 7.0, ..Goal::default() },
        watch: false,
        ..Settings::default()
    };
    let mut desk = Desk::with(SCENE, settings.clone(), |_| Picked::Nothing);
    desk.until("a scene", |app| app.document.is_some());
    let document = desk.doc();
    let tone = Tone { exposure: 0.0, curve: settings.curve };
    assert_eq!((document.tone, document.goal), (tone, settings.goal));
    assert!(!document.can_undo(), "what is remembered is no edit");
    assert!(desk.app().watch.is_none());
    let ctx = desk.harness.ctx.clone();
    assert_eq!(desk.app().settings(&ctx).recent.paths(), [desk.folder.path().join("two.scn")]);
    // Model and roughness belong to a picture, not to the window.
    let before = desk.app().settings(&ctx);
    desk.key(Key::Num1);
    desk.key(Key::CloseBracket);
    assert_eq!(desk.app().settings(&ctx), before);
    desk.key(Key::E);
    desk.click("Filmic");
    desk.click("Passes");
    desk.click_role(Role::Button, "Light");
    let after = desk.app().settings(&ctx);
    assert_eq!(after.curve, Curve::Filmic);
    assert_eq!(desk.doc().tone.exposure, 0.5);
    assert_eq!((after.goal.stop, after.theme), (Stop::Passes, ThemePreference::Light));
}
