//! The whole window but its frame, driven by label, key and pointer, with a real render behind it.

use super::app::App;
use super::document::{Document, Shown};
use super::keys::{self, TABLE};
use super::load::Source;
use burnish::brdf::Model;
use burnish::picture::{Curve, NAN_COLOUR, read_exr};
use burnish::progressive::{Snapshot, State};
use egui::accesskit::Role;
use egui::epaint::textures::TexturesDelta;
use egui::{Color32, Event, Key, Modifiers, PointerButton, Pos2, Rect, TextureId, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, TestRenderer};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Two balls side by side before black, a lamp out of sight; the comma draws a warning.
const SCENE: &str = "screen 64 48
camera 0 -6 0 0.4 x 90
brdf 0.5 0.1 0.1 0.1 0.1 0.1 50
sphere -1 0, 0 0.9
brdf 0.1 0.1 0.5 0.3 0.3 0.3 500
sphere 1 0 0 0.9
light 9 9 9
sphere 0 -3 5 1
";
const LEFT_BALL: [f32; 2] = [22.0, 24.0];
const RIGHT_BALL: [f32; 2] = [42.0, 24.0];
const BACKGROUND: [f32; 2] = [2.0, 2.0];

/// What has been uploaded to the graphics card.
#[derive(Clone, Default)]
struct Card(Rc<RefCell<HashMap<TextureId, (usize, Vec<Color32>)>>>);

impl TestRenderer for Card {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut textures = self.0.borrow_mut();
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                let egui::ImageData::Color(image) = &delta.image;
                let Some([x, y]) = delta.pos else {
                    textures.insert(id, (image.size[0], image.pixels.clone()));
                    continue;
                };
                let (width, pixels) = textures.get_mut(&id).expect("a part of no texture");
                for (row, line) in image.pixels.chunks_exact(image.size[0]).enumerate() {
                    let start = (y + row) * *width + x;
                    pixels[start..start + line.len()].copy_from_slice(line);
                }
            }
        }
        for id in delta.free.drain() {
            textures.remove(&id);
        }
    }
}

/// The app, its working folder, and the hands of its user.
struct Desk {
    harness: Harness<'static, Option<App>>,
    card: Card,
    folder: tempfile::TempDir,
}

impl Desk {
    /// With the scene open, at work towards very many passes.
    fn new() -> Desk {
        let mut desk = Desk::reading(SCENE);
        desk.until("a picture", |app| app.render.as_ref().is_some_and(|r| r.newest.is_some()));
        desk
    }

    /// The same, of so many passes, which are all there.
    fn done(passes: u64) -> Desk {
        let mut desk = Desk::new();
        desk.document(|d| d.set_limit(passes));
        desk.key(Key::R);
        desk.until_done(passes);
        desk
    }

    fn reading(scene: &str) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.scn");
        std::fs::write(&path, scene).unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        let card = Card::default();
        let draw = move |ui: &mut egui::Ui, app: &mut Option<App>| {
            let source = || Source::File(path.clone());
            let app = app.get_or_insert_with(|| App::new(ui.ctx(), source(), 1, out.clone()));
            app.logic(ui.ctx());
            app.ui(ui);
        };
        let harness = Harness::builder()
            .with_size([1280.0, 900.0])
            .renderer(card.clone())
            .build_ui_state(draw, None);
        Desk { harness, card, folder }
    }

    fn app(&self) -> &App {
        self.harness.state().as_ref().unwrap()
    }

    fn document<R>(&mut self, change: impl FnOnce(&mut Document) -> R) -> R {
        change(self.harness.state_mut().as_mut().unwrap().document.as_mut().unwrap())
    }

    fn doc(&self) -> &Document {
        self.app().document.as_ref().unwrap()
    }

    fn newest(&self) -> &Snapshot {
        self.app().render.as_ref().unwrap().newest.as_ref().unwrap()
    }

    fn alpha(&self) -> f64 {
        match self.doc().roughness() {
            Shown::Same(r) | Shown::Mixed(r) => r.alpha(),
            Shown::None => panic!("no roughness is shown"),
        }
    }

    fn notice(&self) -> &str {
        self.app().notice.as_ref().map_or("", |n| &n.text)
    }

    /// Frame after frame until something is so.
    fn until(&mut self, what: &str, so: impl Fn(&App) -> bool) {
        let start = Instant::now();
        while !so(self.app()) {
            assert!(start.elapsed() < Duration::from_secs(60), "no {what}; {}", self.notice());
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
        self.harness.run_ok();
    }

    fn until_done(&mut self, passes: u64) {
        self.until("end", |app| {
            let render = app.render.as_ref().unwrap();
            let newest = render.newest.as_ref();
            newest.is_some_and(|s| {
                s.epoch >= render.epoch && s.state == State::Done && s.passes == passes
            })
        });
    }

    /// Until the picture is that of the present parameters.
    fn until_told(&mut self, epoch_before: u64) {
        self.until("new epoch", |app| {
            app.render.as_ref().unwrap().newest.as_ref().is_some_and(|s| s.epoch > epoch_before)
        });
    }

    fn key(&mut self, key: Key) {
        self.harness.key_press(key);
        self.harness.step();
    }

    fn chord(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.step();
    }

    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.step();
    }

    /// Types into the field of a name and leaves it.
    fn type_into(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::SpinButton, label).click();
        self.harness.step();
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.step();
        self.key(Key::Enter);
        self.harness.run_ok();
    }

    fn canvas(&self) -> Rect {
        self.harness.get_by_label("Picture").rect()
    }

    /// Where a pixel is on the screen, when the picture is fitted.
    fn point(&self, pixel: [f32; 2]) -> Pos2 {
        let (space, size) = (self.canvas(), vec2(64.0, 48.0));
        let times = ((space.size() - Vec2::splat(32.0)) / size).min_elem();
        space.center() + (vec2(pixel[0], pixel[1]) - size / 2.0) * times
    }

    fn press(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        self.harness.step();
    }

    fn click_pixel(&mut self, pixel: [f32; 2]) {
        let at = self.point(pixel);
        self.harness.hover_at(at);
        self.harness.step();
        self.press(at, PointerButton::Primary, true, Modifiers::NONE);
        self.press(at, PointerButton::Primary, false, Modifiers::NONE);
        self.harness.run_ok();
    }

    fn drag(&mut self, by: Vec2, button: PointerButton, modifiers: Modifiers) {
        let from = self.point([32.0, 24.0]);
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.hover_at(from);
        self.harness.step();
        self.press(from, button, true, modifiers);
        for i in 1..=4 {
            self.harness.hover_at(from + by * (i as f32 / 4.0));
            self.harness.step();
        }
        self.press(from + by, button, false, modifiers);
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.run_ok();
    }

    /// The codes of the picture on the card, row by row.
    fn shown(&self) -> Vec<Color32> {
        let textures = self.card.0.borrow();
        let picture = textures.values().find(|(width, pixels)| *width == 64 && pixels.len() == 64 * 48);
        picture.expect("no picture on the card").1.clone()
    }

    fn files(&self) -> Vec<String> {
        let files = std::fs::read_dir(self.folder.path().join("out")).unwrap();
        let mut names: Vec<String> =
            files.map(|f| f.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// How long egui would wait before drawing again, if nothing happens.
    fn rest(&self) -> Duration {
        self.harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay
    }
}

#[test]
fn every_control_is_found_by_its_label() {
    let desk = Desk::new();
    for label in
        ["Phong", "Beckmann", "GGX", "Pause", "Restart", "Snapshot", "Home", "Frame", "Copy", "All"]
    {
        desk.harness.get_by_role_and_label(Role::Button, label);
    }
    for curve in Curve::ALL {
        desk.harness.get_by_label(curve.title());
    }
    for field in ["alpha", "a_p", "Pass limit"] {
        desk.harness.get_by_role_and_label(Role::SpinButton, field);
    }
    for slider in ["Roughness", "Exposure"] {
        desk.harness.get_by_role_and_label(Role::Slider, slider);
    }
    for section in ["Materials", "View", "Scene", "Picture"] {
        desk.harness.get_by_label(section);
    }
    // And nothing that can be used is without a name.
    assert_eq!(desk.harness.unnamed_widgets(), Vec::<String>::new());
}

#[test]
fn digits_and_buttons_choose_the_model() {
    let mut desk = Desk::new();
    assert_eq!(desk.doc().params.model, Model::Ggx);
    for (key, model) in [(Key::Num1, Model::Phong), (Key::Num2, Model::Beckmann), (Key::Num3, Model::Ggx)] {
        let before = desk.newest().epoch;
        desk.key(key);
        assert_eq!(desk.doc().params.model, model);
        desk.until_told(before);
    }
    for model in Model::ALL {
        desk.click(model.title());
        assert_eq!(desk.doc().params.model, model);
        assert_eq!(desk.app().render.as_ref().unwrap().told().model, model);
    }
}

#[test]
fn the_models_give_different_pictures() {
    let mut desk = Desk::done(4);
    let ggx = desk.shown();
    desk.key(Key::Num2);
    desk.until_done(4);
    assert!(ggx != desk.shown());
    desk.key(Key::Num3);
    desk.until_done(4);
    assert!(ggx == desk.shown(), "the same parameters and passes are the same picture");
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
    desk.until_told(epoch);
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
    desk.click("as in file");
    desk.harness.run_ok();
    assert_eq!(alphas(desk.doc()), before);
    assert!(desk.harness.query_by_label("as in file").is_none());
}

#[test]
fn pause_stops_the_passes_and_resume_goes_on() {
    let mut desk = Desk::new();
    desk.document(|d| d.set_limit(1 << 32));
    desk.key(Key::Space);
    let paused = |app: &App| {
        app.render.as_ref().unwrap().newest.as_ref().unwrap().state == State::Paused
    };
    desk.until("pause", paused);
    let (epoch, passes) = (desk.newest().epoch, desk.newest().passes);
    std::thread::sleep(Duration::from_millis(150));
    desk.harness.run_steps(5);
    assert_eq!((desk.newest().epoch, desk.newest().passes), (epoch, passes));
    assert_eq!(desk.rest(), Duration::MAX, "a paused window is not redrawn");
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
    desk.until_told(epoch);
    assert!(!desk.doc().paused);
}

#[test]
fn restart_is_a_new_epoch_of_the_same_picture() {
    let mut desk = Desk::done(2);
    let (epoch, picture) = (desk.newest().epoch, desk.newest().mean());
    desk.click("Restart");
    desk.until_told(epoch);
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
        assert_eq!(desk.doc().limit, limit);
    }
}

#[test]
fn exposure_and_curve_change_what_is_shown_and_not_what_is_traced() {
    let mut desk = Desk::done(2);
    let (epoch, before) = (desk.newest().epoch, desk.shown());
    desk.key(Key::E);
    desk.harness.run();
    assert_eq!(desk.doc().tone.exposure, 0.5);
    let brighter = desk.shown();
    let sum = |codes: &[Color32]| codes.iter().map(|c| u64::from(c.r())).sum::<u64>();
    assert!(sum(&brighter) > sum(&before));
    desk.chord(Modifiers::SHIFT, Key::E);
    desk.harness.run();
    assert!(desk.shown() == before);
    desk.click("Filmic");
    desk.harness.run();
    assert!(desk.shown() != before);
    assert_eq!((desk.newest().epoch, desk.newest().passes), (epoch, 2));
}

#[test]
fn the_card_holds_the_tone_mapped_means() {
    let desk = Desk::done(2);
    let mean = desk.newest().mean();
    let tone = desk.doc().tone;
    for (shown, &radiance) in desk.shown().iter().zip(&mean.pixels) {
        let [r, g, b] = tone.exact(radiance);
        assert_eq!(*shown, Color32::from_rgb(r, g, b));
        assert_ne!([r, g, b], NAN_COLOUR);
    }
    assert!(mean.pixels.iter().any(|p| p[0] > 0.0), "the picture is black");
}

#[test]
fn a_click_picks_the_material_and_the_background_picks_all() {
    let mut desk = Desk::new();
    assert!(!desk.doc().only_picked);
    desk.click_pixel(RIGHT_BALL);
    let name = desk.doc().params.materials[1].name.clone();
    assert_eq!((desk.doc().picked, desk.doc().only_picked), (Some(1), true));
    let camera = desk.doc().params.camera;
    desk.type_into("alpha", "0.25");
    let alphas: Vec<f64> = desk.doc().params.materials.iter().map(|m| m.roughness.alpha()).collect();
    assert_eq!(alphas[1], 0.25);
    assert_ne!(alphas[0], 0.25);
    desk.click_pixel(LEFT_BALL);
    assert_eq!(desk.doc().picked, Some(0));
    desk.click_pixel(BACKGROUND);
    assert!(!desk.doc().only_picked);
    assert_eq!(desk.doc().params.camera, camera, "a click is not a drag");
    // Its name is in the list and, once picked, in the choice above.
    desk.click_pixel(RIGHT_BALL);
    assert_eq!(desk.harness.query_all_by_label(&name).count(), 2);
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
fn a_snapshot_is_two_numbered_files() {
    let mut desk = Desk::done(2);
    desk.key(Key::S);
    desk.until("files", |app| app.notice.is_some());
    assert!(desk.notice().contains("two_ggx_0001.png"), "{}", desk.notice());
    desk.chord(Modifiers::CTRL | Modifiers::COMMAND, Key::S);
    desk.until("more files", |app| app.notice.as_ref().is_some_and(|n| n.text.contains("0002")));
    let names =
        ["two_ggx_0001.exr", "two_ggx_0001.png", "two_ggx_0002.exr", "two_ggx_0002.png"];
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
    for name in ["Phong", "Beckmann", "GGX", "Pause", "Restart", "Snapshot", "Home", "Frame", "Copy"] {
        let node = desk.harness.get_by_role_and_label(Role::Button, name);
        let description = egui_kittest::kittest::NodeT::accesskit_node(&node).description();
        let description = description.unwrap_or_default();
        let binding = TABLE.iter().find(|b| b.name == name).unwrap();
        assert!(description.contains(&keys::keys_text(&desk.harness.ctx, binding)), "{name}");
    }
}

#[test]
fn drags_and_the_wheel_move_the_camera_and_home_puts_it_back() {
    let mut desk = Desk::new();
    let home = desk.doc().params.camera;
    let centre = desk.doc().subject().centre;
    desk.drag(vec2(80.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    let orbited = desk.doc().params.camera;
    assert_ne!(orbited, home);
    assert!(orbited.eye.x < home.eye.x, "dragging to the right turns the scene to the right");
    assert!(orbited.axes()[0].z.abs() < 1e-9, "the horizon tilts");
    desk.key(Key::Home);
    assert_eq!(desk.doc().params.camera, home);
    for (button, modifiers) in
        [(PointerButton::Middle, Modifiers::NONE), (PointerButton::Primary, Modifiers::SHIFT)]
    {
        desk.drag(vec2(40.0, 0.0), button, modifiers);
        let panned = desk.doc().params.camera;
        assert!(panned.eye.x < home.eye.x && panned.orientation == home.orientation, "{button:?}");
        desk.click("Home");
    }
    let at = desk.point([32.0, 24.0]);
    desk.harness.hover_at(at);
    desk.harness.step();
    desk.harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    desk.harness.run_steps(10);
    let nearer = desk.doc().params.camera;
    assert!((nearer.eye - centre).length() < (home.eye - centre).length());
    assert_eq!(nearer.orientation, home.orientation);
    desk.key(Key::F);
    let framed = desk.doc().params.camera;
    assert!(framed != nearer && framed.orientation == home.orientation);
}

#[test]
fn the_focused_picture_takes_the_arrow_keys() {
    let mut desk = Desk::new();
    let home = desk.doc().params.camera;
    desk.key(Key::ArrowLeft);
    assert_eq!(desk.doc().params.camera, home, "without focus nothing moves");
    desk.harness.get_by_label("Picture").focus();
    desk.harness.step();
    desk.key(Key::ArrowLeft);
    let turned = desk.doc().params.camera;
    assert_ne!(turned.orientation, home.orientation);
    desk.chord(Modifiers::SHIFT, Key::ArrowUp);
    assert_eq!(desk.doc().params.camera.orientation, turned.orientation);
    assert_ne!(desk.doc().params.camera.eye, turned.eye);
    desk.key(Key::Space);
    assert!(desk.doc().paused, "Space still pauses");
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
        assert!(*desk.app().render.as_ref().unwrap().told() == expected);
    }
}

#[test]
fn a_finished_window_is_not_redrawn() {
    let mut desk = Desk::done(2);
    // The last snapshot may ask for one more frame.
    desk.until("rest", |_| true);
    for _ in 0..3 {
        std::thread::sleep(Duration::from_millis(60));
        assert_eq!(desk.rest(), Duration::MAX, "{:?}", desk.harness.ctx.repaint_causes());
        assert!(!desk.harness.ctx.has_requested_repaint());
    }
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
    desk.until("the scene", |app| {
        app.document.as_ref().is_some_and(|d| d.params.size == [20, 10])
    });
    desk.until_done(2);
    let document = desk.doc();
    assert_eq!((document.params.model, document.limit), (Model::Phong, 2));
    assert_eq!(document.tone.exposure, 0.5);
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
    desk.until("the scene", |app| {
        app.document.as_ref().is_some_and(|d| d.params.size == [20, 10])
    });
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

#[test]
fn every_size_of_window_is_drawn() {
    let mut desk = Desk::new();
    for size in [[1.0, 1.0], [200.0, 100.0], [320.0, 480.0], [4000.0, 3000.0]] {
        for scale in [1.0, 2.0] {
            desk.harness.set_size(size.into());
            desk.harness.set_pixels_per_point(scale);
            desk.key(Key::Z);
            desk.harness.run_steps(2);
        }
    }
}

#[test]
fn the_pixel_under_the_pointer_is_told() {
    let mut desk = Desk::done(2);
    let at = desk.point([42.5, 24.5]);
    desk.harness.hover_at(at);
    desk.harness.run_ok();
    let hover = desk.app().canvas.hover.unwrap();
    assert_eq!(hover.pixel, [42, 24]);
    assert_eq!(hover.mean, desk.newest().mean().pixels[24 * 64 + 42]);
}
