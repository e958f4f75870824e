//! Pictures from files: a snapshot is a reference and goes on, and so does an experiment.

use super::*;
use std::sync::Arc;

/// Opens a picture as if it were dropped.
fn open(desk: &mut Desk, name: &str) {
    let path = desk.folder.path().join("out").join(name);
    let ctx = desk.harness.ctx.clone();
    desk.harness.state_mut().as_mut().unwrap().load(&ctx, Source::File(path), false);
}

#[test]
fn a_snapshot_is_a_reference_and_goes_on() {
    let mut desk = Desk::done(20);
    desk.type_into("alpha", "0.31");
    desk.drag(vec2(30.0, 10.0), PointerButton::Primary, Modifiers::NONE);
    desk.until_done(20);
    let before = (desk.newest().mean(), desk.doc().params.camera);
    desk.key(Key::S);
    desk.until("files", |app| app.saving.is_none());
    let files = desk.files();
    let [exr, png] = ["exr", "png"]
        .map(|kind| files.iter().find(|name| name.ends_with(kind)).expect("no snapshot").clone());
    for name in [exr, png] {
        // Elsewhere meanwhile.
        desk.key(Key::Home);
        desk.key(Key::Num1);
        desk.type_into("alpha", "0.05");
        open(&mut desk, &name);
        if name.ends_with("exr") {
            desk.until("the reference", |app| {
                app.doc().comparison.file.is_some() && app.doc().comparison.on
            });
            desk.settle();
            desk.click_role(Role::Button, "Resume the file");
        }
        desk.until("the same picture", |app| {
            let render = app.render.as_ref().unwrap();
            app.resuming.is_none()
                && app.document.as_ref().unwrap().params.model == Model::Ggx
                && render.newest.as_ref().is_some_and(|s| s.passes == 20)
        });
        assert_eq!((desk.doc().params.camera, desk.alpha()), (before.1, 0.31));
        assert!(desk.newest().mean() == before.0, "{name}");
        desk.document(|d| d.goal.passes = 24);
        desk.until_done(24);
        desk.document(|d| d.goal.passes = 20);
    }
}

#[test]
fn an_experiment_goes_on_from_its_sums() {
    let mut desk = Desk::done(17);
    let path = desk.folder.path().join("out/sums.exr");
    let (send, told) = std::sync::mpsc::channel();
    let file = desk.doc().source.path().unwrap().to_path_buf();
    let scene = Arc::new(burnish::scene::read::open(&file).unwrap().0.build());
    let params = burnish::progressive::Params::new(scene);
    let options = burnish::progressive::Options::headless(1);
    let session = burnish::progressive::Session::with_options(params, 17, options, || {}).unwrap();
    session.visit_experiment(move |experiment| send.send(experiment.save(&path)).unwrap());
    told.recv().unwrap().unwrap();
    let passes = session.latest().map_or(0, |s| s.passes);
    drop(session);
    desk.key(Key::Num1);
    desk.until_done(17);
    open(&mut desk, "sums.exr");
    desk.until("the reference", |app| {
        app.doc().comparison.file.is_some() && app.doc().comparison.on
    });
    desk.settle();
    desk.click_role(Role::Button, "Resume the file");
    desk.until("the picture", |app| app.resuming.is_none() && !app.doc().comparison.on);
    assert!(desk.notice().starts_with("Goes on after"), "{} {passes}", desk.notice());
    desk.until_done(17);
    let whole = burnish::progressive::render(desk.doc().params.clone(), 17, 1).unwrap();
    assert!(desk.newest().mean() == whole.mean());
}
