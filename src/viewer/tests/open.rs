//! Ways to a scene and back to its file: dialog, recent ones, changed files, saved edits.

use super::*;
use burnish::scene::read;

const ONE: &str = "screen 20 10\nlight 1 1 1\nsphere 0 0 0 1\n";

fn is_one(app: &App) -> bool {
    app.document.as_ref().is_some_and(|d| d.params.size == [20, 10])
}

fn number(n: u64) -> impl Fn(&App) -> bool {
    move |app: &App| app.document.as_ref().is_some_and(|d| d.number == n)
}

const COMMAND: Modifiers = Modifiers::COMMAND.plus(Modifiers::CTRL);

/// Finds "one.scn" beside the scene that is open.
fn beside(folder: Option<&Path>) -> Picked {
    Picked::File(folder.unwrap().join("one.scn"))
}

#[test]
fn the_dialog_begins_beside_the_scene_and_opens_what_is_chosen() {
    let mut desk = Desk::with(SCENE, settings(), beside);
    desk.until("a scene", number(0));
    std::fs::write(desk.folder.path().join("one.scn"), ONE).unwrap();
    desk.chord(COMMAND, Key::O);
    desk.harness.run_ok();
    desk.click("Browse");
    desk.until("the scene", is_one);
    assert!(desk.harness.query_by_label("Open scene").is_none(), "the line has gone");
}

#[test]
fn a_dialog_that_is_closed_changes_nothing() {
    let mut desk = Desk::done(1);
    desk.chord(COMMAND | Modifiers::SHIFT, Key::O);
    desk.until("an end", |app| app.browsing.is_none());
    assert_eq!((desk.notice(), desk.doc().number), ("", 0));
}

#[test]
fn without_a_dialog_the_path_is_asked_for() {
    let mut desk = Desk::with(SCENE, settings(), |_| Picked::NoDialog);
    desk.until("a scene", number(0));
    desk.chord(COMMAND | Modifiers::SHIFT, Key::O);
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert!(desk.notice().contains("Type the path"), "{}", desk.notice());
    desk.harness.get_by_label("Open scene");
}

#[test]
fn the_path_may_be_the_name_of_a_shipped_scene() {
    let mut desk = Desk::new();
    desk.chord(COMMAND, Key::O);
    desk.harness.run_ok();
    desk.harness.event(Event::Text("furnace".to_owned()));
    desk.harness.step();
    desk.click("Open path");
    desk.until("the furnace", |app| {
        app.document.as_ref().is_some_and(|d| d.params.scene.name() == "White furnace")
    });
    assert!(matches!(desk.doc().source, Source::Example(e) if e.name == "furnace"));
}

#[test]
fn recent_scenes_are_in_the_menu_and_missing_ones_said_so() {
    let mut desk = Desk::new();
    let one = desk.folder.path().join("one.scn");
    std::fs::write(&one, ONE).unwrap();
    desk.chord(COMMAND, Key::O);
    desk.harness.run_ok();
    desk.harness.event(Event::Text(one.display().to_string()));
    desk.harness.step();
    desk.key(Key::Enter);
    desk.until("the scene", is_one);
    let ctx = desk.harness.ctx.clone();
    let two = desk.folder.path().join("two.scn");
    assert_eq!(desk.app().settings(&ctx).recent.paths(), [one.clone(), two]);
    desk.click_role(Role::Button, "Scenes");
    desk.harness.run_steps(3);
    desk.click_role(Role::Button, "two.scn");
    desk.until("the first again", |app| {
        app.document.as_ref().is_some_and(|d| d.params.size == [64, 48])
    });
    std::fs::remove_file(&one).unwrap();
    desk.click_role(Role::Button, "Scenes");
    desk.harness.run_steps(3);
    desk.click_role(Role::Button, "one.scn");
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert!(
        desk.notice().contains("one.scn: ") && desk.notice().contains("No such file"),
        "{}",
        desk.notice()
    );
}

#[test]
fn a_changed_file_is_read_again_and_a_broken_one_once_it_is_mended() {
    let mut desk = Desk::new();
    let path = desk.folder.path().join("two.scn");
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    let moved = desk.doc().params.camera;
    std::fs::write(&path, SCENE.replace("0.5 0.1 0.1", "0.25 0.1 0.1")).unwrap();
    desk.until("the changed scene", number(1));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.25);
    assert_eq!(desk.doc().params.camera, moved);
    std::fs::write(&path, "screen 20 10\nsphere 0 0 zero").unwrap();
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert_eq!((desk.doc().number, desk.doc().params.camera), (1, moved), "the old one stays");
    std::fs::write(&path, SCENE.replace("0.5 0.1 0.1", "0.125 0.1 0.1")).unwrap();
    desk.until("the mended scene", number(2));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.125);
    assert_eq!((desk.doc().params.camera, desk.notice()), (moved, ""));
}

#[test]
fn a_changed_model_is_read_again() {
    let mut desk = Desk::new();
    let place = |name: &str| desk.folder.path().join(name);
    let (model, scene) = (place("corner.obj"), place("corner.scn"));
    std::fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(&scene, "screen 20 10\nlight 1 1 1\nmesh corner.obj 0 0 0 1\n").unwrap();
    desk.chord(COMMAND, Key::O);
    desk.harness.run_ok();
    desk.harness.event(Event::Text(scene.display().to_string()));
    desk.harness.step();
    desk.key(Key::Enter);
    desk.until("the scene", is_one);
    assert_eq!(desk.doc().params.scene.counts().triangles, 1);
    std::fs::write(&model, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n").unwrap();
    desk.until("the second triangle", |app| {
        app.document.as_ref().is_some_and(|d| d.params.scene.counts().triangles == 2)
    });
}

#[test]
fn a_file_that_could_not_be_opened_is_opened_once_it_is_mended() {
    let mut desk = Desk::reading("sphere 0 0 zero 1\n");
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    std::fs::write(desk.folder.path().join("two.scn"), ONE).unwrap();
    desk.until("the scene", is_one);
}

#[test]
fn the_switch_ends_the_looking_and_what_changed_meanwhile_is_read_when_it_is_on_again() {
    let mut desk = Desk::new();
    assert!(desk.app().watch.is_some());
    desk.click("Read again when it changes");
    assert!(desk.app().watch.is_none());
    let ctx = desk.harness.ctx.clone();
    assert!(!desk.app().settings(&ctx).watch);
    let path = desk.folder.path().join("two.scn");
    std::fs::write(&path, SCENE.replace("0.5 0.1 0.1", "0.25 0.1 0.1")).unwrap();
    // F5 reads it all the same, and looks after nothing.
    desk.key(Key::F5);
    desk.until("the changed scene", number(1));
    assert!(desk.app().watch.is_none());
    std::fs::write(&path, SCENE.replace("0.5 0.1 0.1", "0.875 0.1 0.1")).unwrap();
    desk.click("Read again when it changes");
    desk.until("the scene changed meanwhile", number(2));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.875);
}

#[test]
fn the_edited_scene_is_saved_beside_its_file_and_reads_back() {
    let mut desk = Desk::done(1);
    desk.document(|d| d.pick(Some(0)));
    desk.harness.run_ok();
    desk.type_into("Kd green", "0.75");
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    for (n, name) in ["two-edited.scn", "two-edited-2.scn"].into_iter().enumerate() {
        if n == 0 {
            desk.chord(COMMAND | Modifiers::SHIFT, Key::S);
        } else {
            desk.click("Save scene");
        }
        let told = move |app: &App| app.notice.as_ref().is_some_and(|t| t.text.contains(name));
        desk.until("a file", told);
        let path = desk.folder.path().join(name);
        assert_eq!(desk.notice(), format!("Wrote {}", path.display()));
        let scene = read::open(&path).unwrap().0.build();
        assert_eq!(scene.materials()[0].kd, [0.5, 0.75, 0.1]);
        assert_eq!(scene.camera(), desk.doc().params.camera);
    }
    assert_eq!(std::fs::read_to_string(desk.folder.path().join("two.scn")).unwrap(), SCENE);
    assert_eq!(desk.files(), Vec::<String>::new(), "no picture was written");
}

#[test]
fn a_shipped_scene_is_saved_where_pictures_go() {
    let mut desk = Desk::new();
    desk.click_role(Role::Button, "Scenes");
    desk.harness.run_steps(3);
    desk.click_role(Role::Button, "White furnace");
    desk.until("the furnace", |app| {
        app.document.as_ref().is_some_and(|d| d.params.scene.name() == "White furnace")
    });
    desk.document(|d| d.params.size = [30, 20]);
    desk.chord(COMMAND | Modifiers::SHIFT, Key::S);
    desk.until("a file", |app| app.notice.is_some());
    assert_eq!(desk.files(), ["White-furnace-edited.scn"], "{}", desk.notice());
    let path = desk.folder.path().join("out/White-furnace-edited.scn");
    assert_eq!(read::open(&path).unwrap().0.build().screen(), [30, 20]);
}

#[test]
fn a_scene_that_cannot_be_saved_says_why() {
    let mut desk = Desk::new();
    desk.click_role(Role::Button, "Scenes");
    desk.harness.run_steps(3);
    desk.click_role(Role::Button, "Gallery");
    desk.until("the gallery", number(1));
    std::fs::remove_dir(desk.folder.path().join("out")).unwrap();
    desk.chord(COMMAND | Modifiers::SHIFT, Key::S);
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert!(
        desk.notice().starts_with("no scene: ") && desk.notice().contains("choose a folder"),
        "{}",
        desk.notice()
    );
}

#[test]
fn a_model_by_itself_is_stood_on_another_axis_and_a_scene_is_not() {
    use burnish::scene::Axis;
    let mut desk = Desk::done(1);
    desk.key(Key::U);
    assert!(desk.notice().contains("Only a model"), "{}", desk.notice());
    let path = desk.folder.path().join("tetrahedron.obj");
    std::fs::write(
        &path,
        "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    )
    .unwrap();
    let ctx = desk.harness.ctx.clone();
    let app = desk.harness.state_mut().as_mut().unwrap();
    app.load(&ctx, Source::File(path), false);
    let up = |app: &App| app.document.as_ref().and_then(|d| d.params.scene.source().up);
    desk.until("the model", |app| up(app).is_some());
    let mut axis = up(desk.app()).unwrap();
    for _ in 0..2 {
        let at = Axis::ALL.iter().position(|&a| a == axis).unwrap();
        let next = Axis::ALL[(at + 1) % 6];
        desk.key(Key::U);
        desk.until("the model on another axis", |app| up(app) == Some(next));
        axis = next;
    }
    // It stays so when its file is read again.
    let number = desk.doc().number;
    desk.key(Key::F5);
    desk.until("the file again", |app| app.document.as_ref().unwrap().number > number);
    assert_eq!(up(desk.app()), Some(axis));
}
