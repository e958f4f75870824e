//! The copied command line: what it says is what it renders.

use super::*;
use crate::viewer::document::command::again;
use burnish::brdf::{Erratum, Normals, Roughness};
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::read;
use std::sync::Arc;

/// What Shift-V copies.
fn copied(desk: &mut Desk) -> String {
    desk.chord(Modifiers::SHIFT, Key::V);
    assert!(desk.notice().starts_with("Copied"), "{}", desk.notice());
    let render = desk.app().render.as_ref().unwrap();
    again(render.applied(), desk.newest(), desk.doc().tone, &desk.doc().source).unwrap()
}

/// What follows an option, with its quotes gone.
fn value<'a>(command: &'a str, option: &str) -> Option<&'a str> {
    let rest = command.split_once(&format!(" --{option} "))?.1;
    Some(match rest.strip_prefix('\'') {
        Some(quoted) => quoted.split('\'').next().unwrap(),
        None => rest.split(' ').next().unwrap(),
    })
}

#[test]
fn every_setting_is_in_the_command() {
    let mut desk = Desk::done(3);
    desk.document(|d| {
        d.set_roughness(Roughness::from_alpha(0.3).unwrap());
        d.params.camera.eye.x += 0.5;
        d.params.size = [32, 24];
        d.params.model = Model::Beckmann;
        d.params.seed = 7;
        d.params.max_depth = Some(5);
        d.params.strategy = Strategy::LightOnly;
        d.params.normals = Normals::Distribution;
        d.params.erratum = Some(Erratum::DoubleDirect);
        d.tone.exposure = -1.5;
        d.tone.curve = Curve::Filmic;
    });
    desk.harness.step();
    desk.until_done(3);
    let command = copied(&mut desk);
    let path = desk.folder.path().join("two.scn").display().to_string();
    assert!(command.starts_with(&format!("burnish render {path} -o ")), "{command}");
    let params = &desk.doc().params;
    for (option, expected) in [
        ("alpha", "0.3"),
        ("camera", params.camera.scn_line().trim_start_matches("camera ")),
        ("size", "32x24"),
        ("model", "beckmann"),
        ("passes", "3"),
        ("seed", "7"),
        ("max-depth", "5"),
        ("strategy", Strategy::LightOnly.name()),
        ("normals", Normals::Distribution.name()),
        ("erratum", Erratum::DoubleDirect.name()),
        ("exposure", "-1.5"),
        ("tone", "filmic"),
    ] {
        assert_eq!(value(&command, option), Some(expected), "{option}: {command}");
    }
    assert_eq!(desk.notice(), format!("Copied: {command}"));
}

#[test]
fn edited_materials_go_along_as_a_scene_that_gives_the_same_bits() {
    let mut desk = Desk::done(2);
    desk.document(|d| {
        d.pick(Some(0));
        d.params.model = Model::Phong;
        let mut material = d.picked_material().unwrap().clone();
        material.kd = [0.125, 0.25, 0.75];
        d.set_picked(material);
    });
    desk.harness.step();
    desk.until_done(2);
    desk.click("Copy command");
    assert!(desk.notice().contains("lines: the edited scene"), "{}", desk.notice());
    let text = copied(&mut desk);
    let (first, rest) = text.split_once('\n').unwrap();
    assert_eq!(first, "cat > two-edited.scn <<'END-OF-SCENE'");
    let (scene, command) = rest.split_once("\nEND-OF-SCENE\n").unwrap();
    assert!(command.starts_with("burnish render two-edited.scn "), "{command}");
    let path = desk.folder.path().join("two-edited.scn");
    std::fs::write(&path, scene).unwrap();
    let mut params = Params::new(Arc::new(read::open(&path).unwrap().0.build()));
    params.model = Model::Phong;
    let passes = value(command, "passes").unwrap().parse().unwrap();
    assert!(render(params, passes, 1).unwrap().mean() == desk.newest().mean());
}

#[test]
fn a_picture_that_was_not_edited_needs_no_materials() {
    let mut desk = Desk::done(1);
    let command = copied(&mut desk);
    for option in ["alpha", "exponent", "camera", "erratum"] {
        assert_eq!(value(&command, option), None, "{command}");
    }
}
