//! Scenes in, snapshots out, and what the window says about them.

use super::*;
use burnish::scene::builtin::EXAMPLES;

#[test]
fn a_snapshot_is_two_numbered_files() {
    let mut desk = Desk::done(2);
    desk.key(Key::S);
    desk.until("files", |app| app.notice.is_some());
    assert!(desk.notice().contains("two_ggx_0001.png"), "{}", desk.notice());
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::S);
    desk.until("more files", |app| app.notice.as_ref().is_some_and(|n| n.text.contains("0002")));
    let names = ["two_ggx_0001.exr", "two_ggx_0001.png", "two_ggx_0002.exr", "two_ggx_0002.png"];
    assert_eq!(desk.files(), names);
    let exr = read_exr(&desk.folder.path().join("out/two_ggx_0001.exr")).unwrap();
    assert!(exr == desk.newest().mean());
}

#[test]
fn a_snapshot_that_cannot_be_written_says_why() {
    let mut desk = Desk::done(1);
    std::fs::remove_dir(desk.folder.path().join("out")).unwrap();
    desk.click("Snapshot");
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert!(desk.notice().contains("two_ggx_0001.png"), "{}", desk.notice());
    desk.click("Dismiss");
    assert_eq!(desk.notice(), "");
}

#[test]
fn warnings_are_seen_with_their_line_and_count() {
    let mut desk = Desk::new();
    let warnings = desk.doc().report.warnings.clone();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!(warnings[0].place.line, Some(4));
    desk.harness.get_by_label("two.scn:4");
    desk.harness.get_by_label(&warnings[0].text);
    let header = desk.harness.get_by_role_and_label(Role::Button, "Scene");
    assert_eq!(header.value().as_deref(), Some("1 warning"));
    desk.click("Scene");
    desk.harness.run();
    assert!(desk.harness.query_by_label("two.scn:4").is_none());
}

fn drop_file(desk: &mut Desk, path: &Path) {
    #[derive(Debug)]
    struct Dropped(PathBuf);
    impl egui::DroppedFile for Dropped {
        fn path(&self) -> &Path {
            &self.0
        }
        fn bytes(&self) -> Result<Vec<u8>, String> {
            Err("a path is enough".to_owned())
        }
    }
    let file = std::sync::Arc::new(Dropped(path.to_path_buf()));
    desk.harness.input_mut().dropped_files.push(file);
    desk.harness.step();
}

#[test]
fn a_dropped_scene_is_opened_and_the_settings_stay() {
    let mut desk = Desk::done(2);
    desk.key(Key::Num1);
    desk.key(Key::E);
    let path = desk.folder.path().join("one.scn");
    std::fs::write(&path, "screen 20 10\nlight 1 1 1\nsphere 0 0 0 1\n").unwrap();
    drop_file(&mut desk, &path);
    desk.until("the scene", |app| app.document.as_ref().is_some_and(|d| d.params.size == [20, 10]));
    desk.until_done(2);
    let document = desk.doc();
    assert_eq!((document.params.model, document.goal.passes), (Model::Phong, 2));
    assert_eq!(document.tone.exposure, 0.0, "that of the scene before");
    assert_eq!(desk.newest().grid.size, [20, 10]);
}

#[test]
fn a_broken_file_is_told_with_its_line_and_the_picture_stays() {
    let mut desk = Desk::done(2);
    let before = desk.shown();
    let path = desk.folder.path().join("broken.scn");
    std::fs::write(&path, "screen 20 10\nsphere 0 0 zero 1\n").unwrap();
    drop_file(&mut desk, &path);
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    assert!(desk.notice().contains("broken.scn:2"), "{}", desk.notice());
    assert!(desk.shown() == before);
    assert_eq!(desk.doc().params.size, [64, 48]);
}

#[test]
fn the_open_line_opens_what_is_typed_and_takes_the_keys() {
    let mut desk = Desk::new();
    let path = desk.folder.path().join("one.scn");
    std::fs::write(&path, "screen 20 10\nlight 1 1 1\nsphere 0 0 0 1\n").unwrap();
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::O);
    desk.harness.run_ok();
    // While a path is typed, digits and letters are no shortcuts.
    desk.key(Key::Num1);
    desk.key(Key::Space);
    assert_eq!((desk.doc().params.model, desk.doc().paused), (Model::Ggx, false));
    desk.harness.event(Event::Text(path.display().to_string()));
    desk.harness.step();
    desk.key(Key::Enter);
    desk.until("the scene", |app| app.document.as_ref().is_some_and(|d| d.params.size == [20, 10]));
    assert!(desk.harness.query_by_label("Open scene").is_none(), "the line has gone");
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::O);
    desk.harness.run_ok();
    desk.key(Key::Escape);
    desk.harness.run_ok();
    assert!(desk.harness.query_by_label("Open scene").is_none());
}

#[test]
fn without_a_scene_every_key_is_harmless() {
    let mut desk = Desk::reading("sphere 0 0 zero 1\n");
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    for binding in TABLE {
        for shortcut in binding.keys {
            desk.chord(shortcut.modifiers, shortcut.logical_key);
        }
    }
    desk.harness.run_steps(3);
    assert!(desk.app().document.is_none());
}

/// Closed while it reads, while it renders and while it saves: the window goes, and every file that
/// has its final name is whole.
#[test]
fn closing_at_any_moment_leaves_whole_files_or_none() {
    drop(Desk::reading(SCENE));
    drop(Desk::new());
    for _ in 0..5 {
        let mut desk = Desk::done(1);
        desk.key(Key::S);
        let folder = desk.folder.path().join("out");
        let Desk { harness, card, folder: kept } = desk;
        drop((harness, card));
        // The thread that writes goes on without a window.
        for _ in 0..50 {
            for file in std::fs::read_dir(&folder).unwrap() {
                let path = file.unwrap().path();
                match path.extension().and_then(|e| e.to_str()) {
                    Some("exr") => assert_eq!(read_exr(&path).unwrap().width, 64),
                    Some("png") => {
                        assert!(std::fs::read(&path).unwrap().ends_with(b"IEND\xaeB`\x82"))
                    }
                    _ => {}
                }
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        drop(kept);
    }
}

#[test]
fn the_menu_has_every_shipped_scene_and_opens_it() {
    let mut desk = Desk::new();
    desk.click_role(Role::Button, "Scenes");
    desk.harness.run_steps(3);
    for example in &EXAMPLES {
        desk.harness.get_by_role_and_label(Role::Button, example.title);
    }
    desk.click_role(Role::Button, "Gallery");
    let named =
        |app: &App| app.document.as_ref().is_some_and(|d| d.params.scene.name() == "Gallery");
    desk.until("the gallery", named);
    let gallery = EXAMPLES.iter().find(|e| e.name == "gallery").unwrap();
    assert!(desk.doc().source == Source::Example(gallery));
}

#[test]
fn reload_reads_the_file_again_and_a_moved_camera_stays() {
    // By the key and the button alone.
    let settings = Settings { watch: false, ..settings() };
    let mut desk = Desk::with(SCENE, settings, |_| Picked::Nothing);
    desk.until("a picture", |app| app.render.as_ref().is_some_and(|r| r.newest.is_some()));
    let path = desk.folder.path().join("two.scn");
    let edited = SCENE.replace("0.5 0.1 0.1", "0.25 0.1 0.1").replace("camera 0 -6", "camera 0 -7");
    std::fs::write(&path, edited).unwrap();
    let number = desk.doc().number;
    let read = move |n: u64| move |app: &App| app.document.as_ref().is_some_and(|d| d.number == n);
    desk.key(Key::F5);
    desk.until("the edited scene", read(number + 1));
    assert_eq!(desk.doc().params.materials[0].kd[0], 0.25);
    let home = desk.doc().params.camera;
    assert!(home == desk.doc().params.scene.camera(), "an unmoved camera is the file's");
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    let moved = desk.doc().params.camera;
    assert_ne!(moved, home);
    desk.click("Reload");
    desk.until("the scene again", read(number + 2));
    assert_eq!(desk.doc().params.camera, moved);
    // Opened, it is seen as its file has it.
    drop_file(&mut desk, &path);
    desk.until("the scene afresh", read(number + 3));
    assert_eq!(desk.doc().params.camera, home);
    // What is broken and then mended is read again, too.
    std::fs::write(&path, "sphere 0 0 zero 1\n").unwrap();
    desk.key(Key::F5);
    desk.until("an error", |app| app.notice.as_ref().is_some_and(|n| n.is_error));
    std::fs::write(&path, SCENE).unwrap();
    desk.key(Key::F5);
    desk.until("the mended scene", read(number + 4));
}
