//! Undo and redo of everything that can be set.

use super::*;
use crate::viewer::document::goal::{Goal, Stop};
use burnish::brdf::{Erratum, Normals, Roughness};
use burnish::progressive::Strategy;

const COMMAND: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

/// A change, and how to see it.
type Case = (&'static str, fn(&mut Document));

const CASES: [Case; 13] = [
    ("model", |d| d.params.model = Model::Phong),
    ("roughness", |d| d.set_roughness(Roughness::from_alpha(0.5).unwrap())),
    ("camera", |d| d.params.camera.eye.x += 1.0),
    ("passes", |d| d.set_limit(77)),
    ("stop", |d| d.goal.stop = Stop::Error),
    ("error", |d| d.goal.error = 0.125),
    ("exposure", |d| d.tone.exposure = -1.5),
    ("curve", |d| d.tone.curve = Curve::Filmic),
    ("strategy", |d| d.params.strategy = Strategy::LightOnly),
    ("normals", |d| d.params.normals = Normals::Distribution),
    ("erratum", |d| d.params.erratum = Some(Erratum::DoubleDirect)),
    ("seed", |d| d.params.seed = 9),
    ("depth", |d| d.params.max_depth = Some(3)),
];

fn state(desk: &Desk) -> (burnish::progressive::Params, burnish::picture::Tone, Goal) {
    (desk.doc().params.clone(), desk.doc().tone, desk.doc().goal)
}

#[test]
fn every_change_is_undone_and_redone() {
    let mut desk = Desk::new();
    let mut states = vec![state(&desk)];
    for (what, change) in CASES {
        desk.document(change);
        desk.harness.step();
        assert!(state(&desk) != states[states.len() - 1], "{what}");
        states.push(state(&desk));
    }
    for (i, (what, _)) in CASES.iter().enumerate().rev() {
        desk.chord(COMMAND, Key::Z);
        assert!(state(&desk) == states[i], "undo of {what}");
        assert!(*desk.app().render.as_ref().unwrap().applied() == states[i].0, "undo of {what}");
    }
    for (i, (what, _)) in CASES.iter().enumerate() {
        match i % 2 {
            0 => desk.chord(COMMAND | Modifiers::SHIFT, Key::Z),
            _ => desk.chord(COMMAND, Key::Y),
        }
        assert!(state(&desk) == states[i + 1], "redo of {what}");
    }
}

#[test]
fn the_buttons_can_be_pressed_when_there_is_something_to_take_back() {
    let mut desk = Desk::new();
    let can = |desk: &Desk, name| {
        let node = desk.harness.get_by_role_and_label(Role::Button, name);
        !egui_kittest::kittest::NodeT::accesskit_node(&node).is_disabled()
    };
    assert!(!can(&desk, "Undo") && !can(&desk, "Redo"));
    let first = desk.doc().params.model;
    desk.key(Key::Num1);
    desk.harness.run_ok();
    assert!(can(&desk, "Undo") && !can(&desk, "Redo"));
    desk.click("Undo");
    desk.harness.run_ok();
    assert!(desk.doc().params.model == first && !can(&desk, "Undo"));
    desk.click("Redo");
    desk.harness.run_ok();
    assert!(desk.doc().params.model == Model::Phong && !can(&desk, "Redo"));
}

#[test]
fn a_drag_is_one_change() {
    let mut desk = Desk::new();
    let home = desk.doc().params.camera;
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    let turned = desk.doc().params.camera;
    assert_ne!(turned, home);
    desk.chord(COMMAND, Key::Z);
    assert_eq!(desk.doc().params.camera, home);
    desk.chord(COMMAND, Key::Y);
    assert_eq!(desk.doc().params.camera, turned);
}
