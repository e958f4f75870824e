//! The side panel and the keys.

use super::*;
use egui_kittest::kittest::NodeT;

#[test]
fn every_control_is_found_by_its_label() {
    let desk = Desk::new();
    for label in
        ["Phong", "Beckmann", "GGX", "Pause", "Restart", "Snapshot", "Home", "Frame", "Copy", "All"]
    {
        desk.harness.get_by_role_and_label(Role::Button, label);
    }
    for label in
        ["Undo", "Redo", "Copy command", "Open", "Save scene", "Reload", "Passes", "Error", "Time"]
    {
        desk.harness.get_by_role_and_label(Role::Button, label);
    }
    desk.harness.get_by_role_and_label(Role::Button, "Scenes");
    for curve in Curve::ALL {
        desk.harness.get_by_label(curve.title());
    }
    for field in ["alpha", "a_p", "Pass limit"] {
        desk.harness.get_by_role_and_label(Role::SpinButton, field);
    }
    for slider in ["Roughness", "Exposure"] {
        desk.harness.get_by_role_and_label(Role::Slider, slider);
    }
    for section in ["Materials", "View", "Tracing", "Sampling", "Deliberate bugs", "Scene"] {
        desk.harness.get_by_label(section);
    }
    for layer in ["Picture", "Noise", "Samples"] {
        desk.harness.get_by_role_and_label(Role::Button, layer);
    }
    desk.harness.get_by_role_and_label(Role::Image, "Picture");
    // And nothing that can be used is without a name.
    assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
}

#[test]
fn digits_and_buttons_choose_the_model() {
    let mut desk = Desk::new();
    assert_eq!(desk.doc().params.model, Model::Ggx);
    for (key, model) in
        [(Key::Num1, Model::Phong), (Key::Num2, Model::Beckmann), (Key::Num3, Model::Ggx)]
    {
        let before = desk.newest().epoch;
        desk.key(key);
        assert_eq!(desk.doc().params.model, model);
        desk.until_applied(before);
    }
    for model in Model::ALL {
        desk.click(model.title());
        assert_eq!(desk.doc().params.model, model);
        assert_eq!(desk.app().render.as_ref().unwrap().applied().model, model);
    }
}

#[test]
fn the_roughness_slider_is_logarithmic_and_moves_by_keyboard() {
    let mut desk = Desk::new();
    let slider = desk.harness.get_by_role_and_label(Role::Slider, "Roughness");
    let middle = slider.rect().center();
    slider.focus();
    desk.harness.step();
    let (alpha, epoch) = (desk.alpha(), desk.newest().epoch);
    desk.key(Key::ArrowRight);
    assert!(desk.alpha() > alpha);
    desk.until_applied(epoch);
    desk.key(Key::ArrowLeft);
    desk.key(Key::ArrowLeft);
    assert!(desk.alpha() < alpha);
    // Half way between 0.0001 and 1 on a logarithmic scale.
    desk.harness.hover_at(middle);
    desk.press(middle, PointerButton::Primary, true, Modifiers::NONE);
    desk.press(middle, PointerButton::Primary, false, Modifiers::NONE);
    assert!((desk.alpha().log10() + 2.0).abs() < 0.05, "{}", desk.alpha());
}

#[test]
fn alpha_and_the_exponent_are_typed_and_are_one_number() {
    let mut desk = Desk::new();
    desk.type_into("alpha", "0.1");
    assert!((desk.alpha() - 0.1).abs() < 1e-12);
    let shown = desk.harness.get_by_role_and_label(Role::SpinButton, "a_p").value();
    assert_eq!(shown.as_deref(), Some("198.0"));
    desk.type_into("a_p", "1e6");
    let shown = desk.harness.get_by_role_and_label(Role::SpinButton, "alpha").value();
    assert_eq!(shown.as_deref(), Some("0.001414"));
    let [first, second] = [0, 1].map(|i| desk.doc().params.materials[i].roughness.exponent());
    assert_eq!([first, second], [1e6; 2]);
}

#[test]
fn nonsense_typed_changes_nothing_and_too_much_is_the_end_of_the_range() {
    let mut desk = Desk::new();
    let before = desk.alpha();
    for nonsense in ["", "rough", "nan", "1e", "--"] {
        desk.type_into("alpha", nonsense);
        assert_eq!(desk.alpha(), before, "{nonsense:?}");
    }
    for (text, alpha) in [("7", 1.0), ("-1", 1e-4), ("0", 1e-4), ("inf", 1.0)] {
        desk.type_into("alpha", text);
        assert_eq!(desk.alpha(), alpha, "{text:?}");
    }
    desk.type_into("a_p", "1e99");
    assert!((desk.alpha() - 1e-4).abs() < 1e-12);
}

#[test]
fn brackets_scale_the_roughness_and_keep_the_differences() {
    let mut desk = Desk::new();
    let alphas = |d: &Document| [0, 1].map(|i| d.params.materials[i].roughness.alpha());
    let before = alphas(desk.doc());
    for _ in 0..4 {
        desk.key(Key::CloseBracket);
    }
    for (was, is) in before.iter().zip(alphas(desk.doc())) {
        assert!((is / was - 2.0).abs() < 1e-9);
    }
    desk.click("Reset");
    desk.harness.run_ok();
    assert_eq!(alphas(desk.doc()), before);
    assert!(desk.harness.query_by_label("Reset").is_none());
}

#[test]
fn pause_stops_the_passes_and_resume_goes_on() {
    let mut desk = Desk::new();
    desk.document(|d| d.set_limit(1 << 32));
    desk.key(Key::Space);
    let paused =
        |app: &App| app.render.as_ref().unwrap().newest.as_ref().unwrap().state == State::Paused;
    desk.until("pause", paused);
    let (epoch, passes) = (desk.newest().epoch, desk.newest().passes);
    desk.until_at_rest();
    assert_eq!((desk.newest().epoch, desk.newest().passes), (epoch, passes));
    desk.click("Resume");
    desk.until("more passes", move |app| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().passes > passes
    });
    assert_eq!(desk.newest().epoch, epoch, "nothing was thrown away");
}

#[test]
fn a_change_while_paused_is_seen() {
    let mut desk = Desk::new();
    desk.click("Pause");
    assert!(desk.doc().paused);
    let epoch = desk.newest().epoch;
    desk.key(Key::Num1);
    desk.until_applied(epoch);
    assert!(!desk.doc().paused);
}

#[test]
fn restart_is_a_new_epoch_of_the_same_picture() {
    let mut desk = Desk::done(2);
    let (epoch, picture) = (desk.newest().epoch, desk.newest().mean());
    desk.click("Restart");
    desk.until_applied(epoch);
    desk.until_done(2);
    assert!(desk.newest().epoch > epoch);
    assert!(desk.newest().mean() == picture);
}

#[test]
fn the_pass_limit_stops_and_a_higher_one_goes_on() {
    let mut desk = Desk::done(3);
    let epoch = desk.newest().epoch;
    assert!(desk.harness.query_by_label("done").is_some());
    desk.type_into("Pass limit", "5");
    desk.until_done(5);
    assert_eq!(desk.newest().epoch, epoch);
    for (typed, limit) in [("0", 1), ("99999999999", 1 << 32)] {
        desk.type_into("Pass limit", typed);
        assert_eq!(desk.doc().goal.passes, limit);
    }
}

#[test]
fn the_list_of_materials_picks_too() {
    let mut desk = Desk::new();
    let names: Vec<String> = desk.doc().params.materials.iter().map(|m| m.name.clone()).collect();
    let label = |i: usize| names[i].clone();
    let row = desk.harness.get_all_by_label(&label(0)).next().unwrap().rect().center();
    desk.harness.hover_at(row);
    desk.press(row, PointerButton::Primary, true, Modifiers::NONE);
    desk.press(row, PointerButton::Primary, false, Modifiers::NONE);
    assert_eq!((desk.doc().picked, desk.doc().only_picked), (Some(0), true));
    desk.click("All");
    assert!(!desk.doc().only_picked);
}

#[test]
fn the_help_lists_every_key_and_closes() {
    let mut desk = Desk::new();
    desk.key(Key::Questionmark);
    desk.harness.run_ok();
    for binding in TABLE {
        let keys = keys::keys_text(&desk.harness.ctx, binding);
        assert!(desk.harness.query_all_by_label(&keys).count() >= 1, "{keys} is not listed");
        let does = desk.harness.query_all_by_label(binding.does);
        assert!(does.count() >= 1, "{} is not listed", binding.does);
    }
    for (what, _) in keys::MOUSE.iter().chain(keys::PICTURE_KEYS) {
        desk.harness.get_by_label(what);
    }
    desk.key(Key::Escape);
    assert!(!desk.app().help.open);
    desk.key(Key::F1);
    desk.harness.run_ok();
    desk.click("Close");
    assert!(!desk.app().help.open);
}

#[test]
fn every_button_with_a_key_says_so() {
    let desk = Desk::new();
    for name in
        ["Phong", "Beckmann", "GGX", "Pause", "Restart", "Snapshot", "Home", "Frame", "Copy"]
            .into_iter()
            .chain(["Undo", "Redo", "Copy command", "Open", "Save scene", "Reload"])
    {
        let node = desk.harness.get_by_role_and_label(Role::Button, name);
        let description = egui_kittest::kittest::NodeT::accesskit_node(&node).description();
        let description = description.unwrap_or_default();
        let binding = TABLE.iter().find(|b| b.name == name).unwrap();
        assert!(description.contains(&keys::keys_text(&desk.harness.ctx, binding)), "{name}");
    }
}

#[test]
fn undo_takes_back_one_change_after_the_other() {
    let mut desk = Desk::new();
    let first = desk.doc().params.clone();
    desk.key(Key::Num1);
    desk.harness.run_steps(8); // two seconds of egui's time
    let second = desk.doc().params.clone();
    desk.key(Key::CloseBracket);
    desk.key(Key::CloseBracket); // at once: one change
    for expected in [second, first.clone(), first] {
        desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::Z);
        assert!(desk.doc().params == expected);
        assert!(*desk.app().render.as_ref().unwrap().applied() == expected);
    }
}

#[test]
fn the_window_is_closed_by_its_key() {
    let mut desk = Desk::new();
    // In the very frame of the press the window is told.
    desk.harness.event(Event::Key {
        key: Key::Q,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::CTRL | Modifiers::COMMAND,
    });
    desk.harness.step();
    let told = &desk.harness.output().viewport_output[&egui::ViewportId::ROOT].commands;
    assert!(told.contains(&egui::ViewportCommand::Close), "{told:?}");
}

#[test]
fn no_control_moves_while_the_picture_gets_better() {
    let mut desk = Desk::new();
    for section in ["Tracing", "Sampling", "Deliberate bugs", "Checks"] {
        desk.click_role(Role::Button, section);
        desk.harness.run_ok();
    }
    let places = |desk: &Desk| {
        let roles = [Role::Button, Role::CheckBox, Role::ComboBox, Role::Slider, Role::SpinButton];
        let all = roles.into_iter().flat_map(|role| desk.harness.query_all_by_role(role));
        all.map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect()))
            .collect::<Vec<_>>()
    };
    desk.key(Key::R);
    let before = places(&desk);
    assert!(before.len() > 40, "{}", before.len());
    desk.until("passes", |app| {
        let newest = app.render.as_ref().unwrap().newest.as_ref().unwrap();
        newest.passes > 100 && newest.error.is_some_and(|e| e.reliable)
    });
    assert_eq!(places(&desk), before);
}

#[test]
fn presses_within_one_frame_all_count() {
    let mut desk = Desk::new();
    let before = desk.alpha();
    for _ in 0..4 {
        for pressed in [true, false] {
            desk.harness.input_mut().events.push(Event::Key {
                key: Key::CloseBracket,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            });
        }
    }
    desk.harness.step();
    assert!((desk.alpha() / before - 2.0).abs() < 1e-9, "{before} became {}", desk.alpha());
}
