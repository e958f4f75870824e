//! The list of materials and the fields of the picked one.

use super::*;
use burnish::scene::Material;
use egui::accesskit::Toggled;
use egui_kittest::kittest::NodeT;

/// With a material picked, a picture of a few passes there.
fn desk(picked: u32) -> Desk {
    let mut desk = Desk::done(2);
    desk.document(|d| d.pick(Some(picked)));
    desk.harness.run_ok();
    desk
}

fn material(desk: &Desk, i: usize) -> &Material {
    &desk.doc().params.materials[i]
}

fn is_there(desk: &Desk, role: Role, label: &str) -> bool {
    desk.harness.query_by_role_and_label(role, label).is_some()
}

#[test]
fn fields_are_there_for_the_picked_material_alone() {
    let mut desk = Desk::done(1);
    assert!(!is_there(&desk, Role::SpinButton, "Kd red"));
    desk.harness.get_by_label("pick one, here or in the picture");
    desk.document(|d| d.pick(Some(0)));
    desk.harness.run_ok();
    for quantity in ["Kd", "Ks"] {
        for channel in ["red", "green", "blue"] {
            assert!(is_there(&desk, Role::SpinButton, &format!("{quantity} {channel}")));
        }
    }
    assert!(is_there(&desk, Role::SpinButton, "Exponent"));
    assert!(!is_there(&desk, Role::SpinButton, "Emits red"), "it is no light");
    assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
    desk.click("All");
    desk.harness.run_ok();
    assert!(!is_there(&desk, Role::SpinButton, "Kd red"));
}

#[test]
fn reflectances_are_typed_and_seen_at_once() {
    let mut desk = desk(0);
    let (before, other) = (desk.shown(), material(&desk, 1).clone());
    let ks = material(&desk, 0).ks;
    desk.type_into("Kd green", "0.75");
    assert_eq!(material(&desk, 0).kd, [0.5, 0.75, 0.1]);
    assert_eq!(desk.app().render.as_ref().unwrap().applied().materials[0].kd, [0.5, 0.75, 0.1]);
    desk.until_done(2);
    assert!(desk.shown() != before);
    desk.type_into("Ks blue", "2");
    assert_eq!(material(&desk, 0).ks, [ks[0], ks[1], 1.0]);
    for nonsense in ["", "red", "nan"] {
        desk.type_into("Kd red", nonsense);
        assert_eq!(material(&desk, 0).kd[0], 0.5, "{nonsense:?}");
    }
    assert_eq!(*material(&desk, 1), other);
    for _ in 0..2 {
        desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::Z);
    }
    desk.until_done(2);
    assert!(desk.shown() == before, "the same bits as before");
}

#[test]
fn the_exponent_is_that_of_one_material_and_needs_a_lobe() {
    let mut desk = desk(1);
    desk.type_into("Exponent", "48");
    let exponents = [0, 1].map(|i| material(&desk, i).roughness.exponent());
    assert_eq!(exponents, [50.0, 48.0]);
    assert_eq!(desk.harness.query_all_by_label("alpha 0.2000").count(), 1);
    for channel in ["Ks red", "Ks green", "Ks blue"] {
        desk.type_into(channel, "0");
    }
    desk.harness.get_by_label("no lobe: Ks is 0");
    let field = desk.harness.get_by_role_and_label(Role::SpinButton, "Exponent");
    assert!(field.accesskit_node().is_disabled());
}

#[test]
fn a_light_has_its_emission() {
    let mut desk = desk(2);
    let before = desk.newest().mean();
    assert!(!is_there(&desk, Role::SpinButton, "Kd red"), "it reflects nothing");
    for (channel, value) in [("Emits red", "0"), ("Emits green", "-3"), ("Emits blue", "18")] {
        desk.type_into(channel, value);
    }
    assert_eq!(material(&desk, 2).emission, [0.0, 0.0, 18.0]);
    desk.until_done(2);
    for (was, is) in before.pixels.iter().zip(&desk.newest().mean().pixels) {
        assert!(is[0] == 0.0 && is[1] == 0.0);
        assert!((is[2] - 2.0 * was[2]).abs() <= 0.02 * is[2] + 1e-6, "{was:?} {is:?}");
    }
    // Turned off, it can be turned on again.
    desk.type_into("Emits blue", "0");
    assert!(is_there(&desk, Role::SpinButton, "Emits blue"));
}

#[test]
fn picking_in_the_list_and_in_the_picture_is_the_same() {
    let mut desk = Desk::done(1);
    let name = material(&desk, 1).name.clone();
    let chosen = |desk: &Desk, name: &str| {
        let rows = desk.harness.get_all_by_role_and_label(Role::Button, name);
        rows.filter(|row| row.accesskit_node().toggled() == Some(Toggled::True)).count()
    };
    assert_eq!(chosen(&desk, &name), 0);
    desk.click(&name);
    desk.harness.run_ok();
    assert_eq!((desk.doc().picked, desk.doc().only_picked), (Some(1), true));
    // In the list and in the choice above.
    assert_eq!(chosen(&desk, &name), 2);
    desk.click_pixel(LEFT_BALL);
    let left = material(&desk, 0).name.clone();
    assert_eq!((chosen(&desk, &name), chosen(&desk, &left)), (0, 2));
    desk.click_pixel(RIGHT_BALL);
    assert_eq!((chosen(&desk, &name), chosen(&desk, &left)), (2, 0));
    desk.click_pixel(BACKGROUND);
    assert_eq!(chosen(&desk, &left), 0);
    assert!(!desk.doc().only_picked);
}

#[test]
fn a_very_long_list_is_drawn_where_it_is_seen() {
    let balls =
        (0..1000).map(|i| format!("brdf 0.5 0.5 0.5 0.1 0.1 0.1 {}\nsphere {i} 0 0 0.4\n", i + 1));
    let head = "screen 64 48\ncamera 0 -9 0 0.4 x 90\nlight 9 9 9\nsphere 0 -3 5 1\n";
    let mut desk = Desk::reading(&(head.to_owned() + &balls.collect::<String>()));
    desk.until("a scene", |app| app.document.is_some());
    let names: Vec<String> = desk.doc().params.materials.iter().map(|m| m.name.clone()).collect();
    let drawn =
        |desk: &Desk| names.iter().filter(|n| desk.harness.query_by_label(n).is_some()).count();
    assert_eq!(names.len(), 1001);
    assert!((5..100).contains(&drawn(&desk)), "{} lines", drawn(&desk));
    assert!(desk.harness.query_by_label(&names[700]).is_none());
    desk.document(|d| d.pick(Some(700)));
    desk.harness.run_ok();
    // In the choice above the list, and in the list.
    assert_eq!(desk.harness.query_all_by_label(&names[700]).count(), 2);
    // Another one in sight is picked without the list being moved.
    let before = desk.harness.get_by_label(&names[702]).rect();
    desk.click(&names[702]);
    desk.harness.run_ok();
    let rows = desk.harness.query_all_by_label(&names[702]).map(|n| n.rect());
    assert_eq!(desk.doc().picked, Some(702));
    assert!(rows.into_iter().any(|r| r.min == before.min));
}

#[test]
fn a_preset_has_measured_reflectances_and_its_roughness() {
    let mut desk = Desk::done(1);
    desk.document(|d| d.pick(Some(0)));
    desk.harness.run_ok();
    let name = desk.doc().params.materials[0].name.clone();
    desk.click_role(Role::ComboBox, "Preset");
    desk.harness.run_ok();
    desk.click_role(Role::Button, "Gold");
    desk.harness.run_ok();
    let gold = burnish::scene::presets::Preset::named("gold").unwrap().material().unwrap();
    let made = &desk.doc().params.materials[0];
    assert_eq!((made.kd, made.ks, made.roughness), (gold.kd, gold.ks, gold.roughness));
    assert_eq!(made.name, name, "it stays the same material");
    assert_eq!(desk.app().render.as_ref().unwrap().applied().materials[0].ks, gold.ks);
}
