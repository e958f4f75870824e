//! Going back and forth between models, and two pictures against each other.

use super::*;
use crate::viewer::document::comparison::{First, Layout, Second};
use burnish::picture::write;
use burnish::progressive::render;

#[test]
fn back_to_a_model_is_its_picture_at_once_and_goes_on() {
    let mut desk = Desk::done(6);
    let ggx = desk.shown();
    desk.key(Key::Num2);
    desk.until_done(6);
    let beckmann = desk.shown();
    assert!(ggx != beckmann);
    let epoch = desk.newest().epoch;
    desk.key(Key::Num3);
    desk.until_applied(epoch);
    // The first that came of it is all of it.
    assert_eq!(desk.newest().passes, 6);
    assert!(desk.shown() == ggx);
    desk.document(|d| d.set_limit(9));
    desk.until_done(9);
    let plain = render(desk.doc().params.clone(), 9, 1).unwrap();
    assert!(desk.newest().mean() == plain.mean());
    let kept = desk.app().render.as_ref().unwrap().kept();
    assert!(kept.pictures >= 1 && kept.bytes > 64 * 48 * 96, "{kept:?}");
}

#[test]
fn the_other_models_are_refined_while_nothing_else_is_to_be_done() {
    let mut desk = Desk::done(5);
    desk.until("other models", |app| app.render.as_ref().unwrap().kept().pictures == 2);
    let epoch = desk.newest().epoch;
    desk.key(Key::Num1);
    desk.until_applied(epoch);
    assert!(desk.newest().passes > 0, "Phong begins anew");
    desk.until_done(5);
}

/// Coarse blocks do not take the place of a picture, unless it is of another view or all there will be.
#[test]
fn the_old_picture_stays_until_the_new_one_is_as_fine_as_is_asked_for() {
    let mut desk = Desk::done(4);
    let next = Snapshot { epoch: desk.newest().epoch + 1, ..desk.newest().clone() };
    let App { canvas, document, .. } = desk.harness.state_mut().as_mut().unwrap();
    let document = document.as_mut().unwrap();
    let with = |passes, state| Snapshot { passes, state, ..next.clone() };
    assert!(!canvas.show(&with(0, State::Running), document, 3));
    assert!(!canvas.show(&with(2, State::Running), document, 3));
    assert!(canvas.show(&with(2, State::Done), document, 3), "more than this never comes");
    let later = |passes| Snapshot { epoch: next.epoch + 1, ..with(passes, State::Running) };
    assert!(!canvas.show(&later(2), document, 3));
    assert!(canvas.show(&later(0), document, 0), "at once, while something is dragged");
    assert!(canvas.show(&later(1), document, 3), "it goes on from there");
    document.params.camera.eye.x += 0.2;
    let moved = Snapshot { epoch: next.epoch + 2, ..with(0, State::Running) };
    assert!(canvas.show(&moved, document, 3), "another view");
}

/// What the two pictures are called.
fn names(desk: &Desk) -> [String; 2] {
    desk.doc().comparison.names(desk.doc().params.model)
}

#[test]
fn two_models_are_traced_in_turn_and_laid_against_each_other() {
    let mut desk = Desk::done(40);
    desk.key(Key::C);
    assert!(desk.doc().comparison.on);
    desk.until("the other model", |app| {
        let beside = app.render.as_ref().unwrap().beside();
        beside.is_some_and(|s| s.passes == 40)
    });
    assert_eq!(names(&desk), ["GGX", "Beckmann"]);
    let plain = |desk: &Desk, model| {
        let params = burnish::progressive::Params { model, ..desk.doc().params.clone() };
        render(params, 40, 1).unwrap()
    };
    let beside = desk.app().render.as_ref().unwrap().beside().unwrap().mean();
    assert!(beside == plain(&desk, Model::Beckmann).mean());
    // The bar is dragged, and moved by the keyboard.
    let bar = desk.harness.get_by_label("Wipe bar").rect().center();
    desk.press(bar, PointerButton::Primary, true, Modifiers::NONE);
    desk.harness.hover_at(bar + vec2(60.0, 0.0));
    desk.harness.step();
    desk.press(bar + vec2(60.0, 0.0), PointerButton::Primary, false, Modifiers::NONE);
    let wipe = desk.app().canvas.wipe;
    assert!(wipe > 0.5, "{wipe}");
    let camera = desk.doc().params.camera;
    desk.harness.get_by_label("Wipe bar").focus();
    desk.harness.step();
    desk.key(Key::ArrowLeft);
    assert!(desk.app().canvas.wipe < wipe);
    assert_eq!(desk.doc().params.camera, camera, "the bar is not the scene");
    for (label, layout) in
        [("Side", Layout::SideBySide), ("Flip", Layout::Flip), ("Diff", Layout::Difference)]
    {
        desk.click(label);
        desk.harness.run_ok();
        assert_eq!(desk.doc().comparison.layout, layout);
    }
    desk.until("a verdict", |_| true);
    let start = Instant::now();
    while desk.harness.query_by_label_contains("Second brighter in").is_none() {
        assert!(start.elapsed() < PATIENCE, "no verdict");
        std::thread::sleep(Duration::from_millis(5));
        desk.harness.step();
    }
    // The other model's key swaps nothing: now both are one, and there is no difference.
    desk.key(Key::Num2);
    desk.until_done(40);
    desk.until("no difference", |app| app.render.as_ref().unwrap().beside().is_some());
    let start = Instant::now();
    while desk.harness.query_by_label_contains("no significant difference in 100 %").is_none() {
        assert!(start.elapsed() < PATIENCE, "a picture differs from itself");
        std::thread::sleep(Duration::from_millis(5));
        desk.harness.step();
    }
    desk.key(Key::C);
    desk.harness.run_ok();
    assert!(desk.app().render.as_ref().unwrap().beside().is_none());
}

#[test]
fn a_tag_and_a_file_stay_what_they_are() {
    let mut desk = Desk::done(3);
    let ggx = desk.newest().mean();
    desk.key(Key::T);
    assert!(desk.notice().contains("Tagged: GGX, 3 passes"), "{}", desk.notice());
    desk.key(Key::Num1);
    desk.until_done(3);
    let phong = desk.shown();
    desk.key(Key::C);
    desk.document(|d| {
        d.comparison.first = First::Tag;
        d.comparison.second = Second::Model(Model::Phong);
    });
    desk.harness.run_ok();
    let app = desk.app();
    assert!(app.doc().comparison.first_frozen().unwrap().snapshot.mean() == ggx);
    // The first is the tag, the second the present one.
    assert!(app.render.as_ref().unwrap().beside().unwrap().mean() != ggx);
    desk.document(|d| d.comparison.first = First::Shown);
    desk.harness.run_ok();
    desk.key(Key::C);
    desk.harness.run_ok();
    assert!(desk.shown() == phong, "what is traced is shown again");

    let path = desk.folder.path().join("reference.exr");
    write(&path, &ggx, Default::default()).unwrap();
    let ctx = desk.harness.ctx.clone();
    let app = desk.harness.state_mut().as_mut().unwrap();
    app.load(&ctx, Source::File(path), false);
    desk.until("the file", |app| app.doc().comparison.file.is_some());
    let comparison = &desk.doc().comparison;
    assert_eq!((comparison.on, comparison.second), (true, Second::File));
    assert!(comparison.second_frozen().unwrap().snapshot.mean() == ggx);
    assert_eq!(desk.doc().params.model, Model::Phong, "the scene stays");
    // A file that is none is told, and takes nothing away.
    let path = desk.folder.path().join("broken.exr");
    std::fs::write(&path, "no picture").unwrap();
    let app = desk.harness.state_mut().as_mut().unwrap();
    app.load(&ctx, Source::File(path), false);
    desk.until("a message", |app| {
        app.notice.as_ref().is_some_and(|n| n.text.contains("broken.exr"))
    });
    assert!(desk.doc().comparison.file.is_some());
}

#[test]
fn the_other_model_is_matched_by_what_is_asked_for() {
    use burnish::measure::match_roughness::Criterion;
    let mut desk = Desk::done(2);
    desk.type_into("alpha", "0.231");
    desk.key(Key::C);
    desk.document(|d| d.comparison.criterion = Some(Criterion::MeanSlope));
    // Beckmann's mean slope is sqrt(pi)/2 alpha, GGX's pi/2 alpha.
    let expected = 0.231 * std::f64::consts::PI.sqrt();
    desk.until("a match", |app| {
        let materials = app.render.as_ref().unwrap().beside_params().map(|p| p.materials.clone());
        materials.is_some_and(|m| (m[0].roughness.alpha() / expected - 1.0).abs() < 1e-4)
    });
}
