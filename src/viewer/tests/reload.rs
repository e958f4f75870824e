//! What is looked after on disk: all that the picture or the message is about.

use super::*;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const WITH_MESH: &str = "screen 20 10\nlight 1 1 1\nmesh corner.obj 0 0 0 1\n";

fn failed(app: &App) -> bool {
    app.notice.as_ref().is_some_and(|n| n.is_error)
}

fn number(n: u64) -> impl Fn(&App) -> bool {
    move |app| app.document.as_ref().is_some_and(|d| d.number == n)
}

fn triangles(n: usize) -> impl Fn(&App) -> bool {
    move |app| app.document.as_ref().is_some_and(|d| d.params.scene.counts().triangles == n)
}

/// Opens this file of the desk's folder by the line in which paths are typed.
fn open(desk: &mut Desk, name: &str) {
    let path = desk.folder.path().join(name).display().to_string();
    open_path(desk, &path);
}

fn open_path(desk: &mut Desk, path: &str) {
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::O);
    desk.harness.run_ok();
    desk.harness.event(Event::Text(path.to_owned()));
    desk.harness.step();
    desk.key(Key::Enter);
}

fn write(desk: &Desk, name: &str, text: &str) {
    std::fs::write(desk.folder.path().join(name), text).unwrap();
}

/// Kind: a model that is missing, or broken, at the first load.
#[test]
fn a_scene_is_opened_once_the_model_that_it_lacked_is_there() {
    let mut desk = Desk::reading(WITH_MESH);
    desk.until("an error", failed);
    assert!(desk.notice().contains("corner.obj"), "{}", desk.notice());
    write(&desk, "corner.obj", "v 0 0 zero\n");
    desk.until("another error", |app| {
        app.notice.as_ref().is_some_and(|n| n.text.contains("corner.obj:1"))
    });
    assert!(desk.app().document.is_none());
    write(&desk, "corner.obj", TRIANGLE);
    desk.until("the scene", triangles(1));
    assert_eq!(desk.notice(), "");
}

/// Kind: a material library that is missing at the first load.
#[test]
fn a_library_that_was_missing_is_read_once_it_is_there() {
    let mut desk = Desk::new();
    write(&desk, "corner.obj", &format!("mtllib corner.mtl\nusemtl red\n{TRIANGLE}"));
    open(&mut desk, "corner.obj");
    desk.until("the model", triangles(1));
    assert!(!desk.doc().report.warnings.is_empty());
    let before = desk.doc().number;
    write(&desk, "corner.mtl", "newmtl red\nKd 0.75 0.125 0.125\n");
    desk.until("its materials", number(before + 1));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.75);
}

/// Kind: a file that the scene names only later.
#[test]
fn a_model_that_is_named_later_is_looked_after() {
    let mut desk = Desk::new();
    write(&desk, "two.scn", &(SCENE.to_owned() + "mesh corner.obj 0 0 0 1\n"));
    desk.until("an error", failed);
    assert_eq!(desk.doc().number, 0, "the old one stays");
    // It is told once, not with every look.
    desk.click("Dismiss");
    for _ in 0..20 {
        std::thread::sleep(Duration::from_millis(50));
        desk.harness.step();
    }
    assert_eq!(desk.notice(), "");
    write(&desk, "corner.obj", TRIANGLE);
    desk.until("the scene with the model", triangles(1));
    write(&desk, "corner.obj", &(TRIANGLE.to_owned() + "v 0 0 1\nf 1 2 4\n"));
    desk.until("the second triangle", triangles(2));
}

/// Kind: another file that cannot be opened.
#[test]
fn after_a_failed_open_the_scene_shown_is_still_looked_after_and_reloaded() {
    let mut desk = Desk::new();
    write(&desk, "other.scn", "sphere 0 0 zero 1\n");
    open(&mut desk, "other.scn");
    desk.until("an error", failed);
    // F5 reads what is shown.
    desk.key(Key::F5);
    desk.until("the scene again", number(1));
    assert_eq!(desk.doc().params.size, [64, 48]);
    assert!(desk.notice().contains("other.scn:1"), "what is wrong is not forgotten");
    // What is shown is read when it changes.
    write(&desk, "two.scn", &SCENE.replace("0.5 0.1 0.1", "0.25 0.1 0.1"));
    desk.until("the changed scene", number(2));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.25);
    // The other one is opened once it is mended, and then is the one looked after.
    write(&desk, "other.scn", "screen 20 10\nlight 1 1 1\nsphere 0 0 0 1\n");
    desk.until("the other scene", number(3));
    assert_eq!((desk.doc().params.size, desk.notice()), ([20, 10], ""));
    write(&desk, "two.scn", SCENE);
    write(&desk, "other.scn", "screen 22 10\nlight 1 1 1\nsphere 0 0 0 1\n");
    desk.until("the other scene changed", number(4));
    assert_eq!(desk.doc().params.size, [22, 10]);
}

/// Kind: a file that is not there at all.
#[test]
fn a_scene_that_is_missing_is_opened_once_it_is_there() {
    let mut desk = Desk::new();
    open(&mut desk, "later.scn");
    desk.until("an error", failed);
    write(&desk, "later.scn", WITH_MESH);
    desk.until("another error", |app| {
        app.notice.as_ref().is_some_and(|n| n.text.contains("corner.obj"))
    });
    write(&desk, "corner.obj", TRIANGLE);
    desk.until("the scene", triangles(1));
    // Once another scene has been chosen, what is left of the failed one is not waited for.
    write(&desk, "broken.scn", "sphere\n");
    open(&mut desk, "broken.scn");
    desk.until("an error", failed);
    open(&mut desk, "two.scn");
    desk.until("the first scene", |app| {
        app.document.as_ref().is_some_and(|d| d.params.size == [64, 48])
    });
    assert!(desk.app().missed.is_none() && desk.notice().is_empty());
}

/// File managers copy paths in quotes.
#[test]
fn a_path_in_quotes_is_the_path() {
    let mut desk = Desk::new();
    write(&desk, "o ne.scn", "screen 20 10\nlight 1 1 1\nsphere 0 0 0 1\n");
    let path = desk.folder.path().join("o ne.scn").display().to_string();
    open_path(&mut desk, &format!("\"{path}\""));
    desk.until("the scene", number(1));
    assert_eq!(desk.doc().params.size, [20, 10]);
}
