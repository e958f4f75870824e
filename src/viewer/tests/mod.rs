//! The whole window but its frame, driven by label, key and pointer, with a real render behind it.

mod command;
mod compare;
mod controls;
mod error;
mod files;
mod goal;
mod habits;
mod history;
mod labels;
mod layout;
mod lobe;
mod maps;
mod materials;
mod method;
mod open;
mod picture;
mod pixel;
mod proofs;
mod reload;
mod resume;
mod settings;
mod sheet;
mod tracing;

use crate::viewer::app::{App, Setup};
use crate::viewer::document::{Document, Shown};
use crate::viewer::jobs::browse::{Dialog, Picked};
use crate::viewer::jobs::load::Source;
use crate::viewer::keys::{self, TABLE};
use crate::viewer::settings::Settings;
use burnish::brdf::Model;
use burnish::picture::{Curve, NAN_COLOUR, read_exr};
use burnish::progressive::{Snapshot, State};
use egui::accesskit::Role;
use egui::epaint::textures::TexturesDelta;
use egui::{Color32, Event, Key, Modifiers, PointerButton, Pos2, Rect, TextureId, Vec2, vec2};
use egui_kittest::kittest::{By, Queryable};
use egui_kittest::{Harness, TestRenderer};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

/// What has not come by then never comes, however much else the machine has to do.
const PATIENCE: Duration = Duration::from_secs(900);

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

/// What has been uploaded to the graphics card: the width and the codes of each texture.
#[derive(Clone, Default)]
pub(super) struct Card(Rc<RefCell<Textures>>);
type Textures = HashMap<TextureId, (usize, Vec<Color32>)>;

impl Card {
    /// One texture's codes, row by row.
    pub(super) fn codes(&self, id: TextureId) -> Vec<Color32> {
        self.0.borrow().get(&id).expect("no such texture").1.clone()
    }
}

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

/// As on the first day, but that the picture is as large as the scene says: most tests count its pixels.
fn settings() -> Settings {
    Settings { follow: false, ..Settings::default() }
}

/// The app, its working folder, and the hands of its user.
struct Desk {
    harness: Harness<'static, Option<App>>,
    card: Card,
    folder: tempfile::TempDir,
}

impl App {
    fn doc(&self) -> &Document {
        self.document.as_ref().expect("no document")
    }
}

impl Desk {
    /// With the scene open, at work towards very many passes.
    fn new() -> Desk {
        let mut desk = Desk::reading(SCENE);
        desk.until("a picture", |app| app.render.as_ref().is_some_and(|r| r.newest.is_some()));
        desk
    }

    /// The same with its goal of `passes` reached.
    fn done(passes: u64) -> Desk {
        let mut desk = Desk::new();
        desk.document(|d| d.set_limit(passes));
        desk.key(Key::R);
        desk.until_done(passes);
        desk
    }

    fn reading(scene: &str) -> Desk {
        Desk::with(scene, settings(), |_| Picked::Nothing)
    }

    /// The same with what is remembered, and with a file dialog.
    fn with(scene: &str, settings: Settings, dialog: Dialog) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.scn");
        std::fs::write(&path, scene).unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        let card = Card::default();
        let draw = move |ui: &mut egui::Ui, app: &mut Option<App>| {
            let setup = || Setup {
                source: Source::File(path.clone()),
                threads: 1,
                folder: out.clone(),
                settings: settings.clone(),
                dialog,
            };
            let app = app.get_or_insert_with(|| App::new(ui.ctx(), setup()));
            app.logic(ui.ctx());
            app.ui(ui);
        };
        let harness = Harness::builder()
            .with_size([1280.0, 1600.0])
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
        self.app().doc()
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
            assert!(start.elapsed() < PATIENCE, "no {what}; {}", self.notice());
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
        self.harness.run_ok();
    }

    /// Draws until nothing moves any more.
    fn settle(&mut self) {
        for _ in 0..30 {
            self.harness.step();
            std::thread::sleep(Duration::from_millis(2));
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
    fn until_applied(&mut self, epoch_before: u64) {
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
        self.click_that(By::new().label(label));
    }

    /// The control of that role, where a label stands by another one too.
    fn click_role(&mut self, role: Role, label: &str) {
        self.click_that(By::new().role(role).label(label));
    }

    /// Clicks once the control is where it was some frames ago: a section that opens moves those
    /// below it.
    fn click_that(&mut self, which: By<'_>) {
        let start = Instant::now();
        let mut places = [Rect::NOTHING; 3];
        loop {
            let node = self.harness.get(which.clone());
            let place = node.rect();
            if places.iter().all(|p| *p == place) {
                node.click();
                return self.harness.step();
            }
            assert!(start.elapsed() < PATIENCE, "{which:?} moves about");
            places.rotate_left(1);
            places[2] = place;
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
    }

    /// Types into the field of a name and leaves it.
    fn type_into(&mut self, label: &str, text: &str) {
        // What is worked out beside may move a field away under the pointer: then again.
        let start = Instant::now();
        self.click_role(Role::SpinButton, label);
        while self.harness.ctx.memory(|m| m.focused().is_none()) {
            assert!(start.elapsed() < PATIENCE, "{label} takes no text");
            self.click_role(Role::SpinButton, label);
        }
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.step();
        self.key(Key::Enter);
        self.harness.run_ok();
    }

    fn canvas(&self) -> Rect {
        self.harness.get_by_role_and_label(Role::Image, "Picture").rect()
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
        let picture =
            textures.values().find(|(width, pixels)| *width == 64 && pixels.len() == 64 * 48);
        picture.expect("no picture on the card").1.clone()
    }

    fn files(&self) -> Vec<String> {
        let files = std::fs::read_dir(self.folder.path().join("out")).unwrap();
        let mut names: Vec<String> =
            files.map(|f| f.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Whether the last frame asked for no other, ever.
    fn rests(&self) -> bool {
        let viewport = &self.harness.output().viewport_output[&egui::ViewportId::ROOT];
        viewport.repaint_delay == Duration::MAX && !self.harness.ctx.has_requested_repaint()
    }

    /// Frame after frame, as they are asked for, until five looks in a row find that none is: animations,
    /// proofs and the workers' last words come to an end, on a busy machine late.
    fn until_at_rest(&mut self) {
        let start = Instant::now();
        let mut quiet = 0;
        while quiet < 5 {
            let causes = self.harness.ctx.repaint_causes();
            assert!(start.elapsed() < PATIENCE, "drawn without an end: {causes:?}");
            std::thread::sleep(Duration::from_millis(30));
            quiet += 1;
            if !self.rests() {
                quiet = 0;
                self.harness.step();
            }
        }
    }
}
