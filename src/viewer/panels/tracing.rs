//! The section "Tracing": the picture's size, seed and depth, and by how many threads.

use crate::viewer::document::Document;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::number_field::{self, NumberField, Written};
use crate::viewer::style::numbers::percent;
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Weight};
use burnish::progressive::Params;
use burnish::scene::Crop;
use egui::{Button, ComboBox, Id, Key, TextEdit, Ui};

/// Sizes in use.
const SIZES: [[u32; 2]; 8] = [
    [320, 240],
    [640, 480],
    [800, 600],
    [1024, 768],
    [1280, 720],
    [1600, 1200],
    [1920, 1080],
    [3840, 2160],
];
/// Largest depth that can be set. Light that has met more surfaces carries nothing any more.
const DEEPEST: u32 = 1000;
const MOST_THREADS: u32 = 1024;

/// Whether the depth has a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    Unlimited,
    Limited,
}

impl Depth {
    pub(crate) const ALL: [Depth; 2] = [Depth::Unlimited, Depth::Limited];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Depth::Unlimited => "Unlimited",
            Depth::Limited => "At most",
        }
    }

    pub(crate) fn tip(self) -> &'static str {
        match self {
            Depth::Unlimited => "As far as light goes: paths end by chance, without bias.",
            Depth::Limited => "Light that met more surfaces than the figure beside it is left out.",
        }
    }
}

pub(crate) struct TracingPanel {
    /// The depth limit that was last in use.
    depth: u32,
}

impl Default for TracingPanel {
    fn default() -> TracingPanel {
        TracingPanel { depth: 8 }
    }
}

impl Panel for TracingPanel {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        widgets::section(ui, "tracing", "Tracing", None, false, |ui| {
            size(ui, document);
            if crop(ui, document.params.camera.crop) {
                actions.push(Action::Whole);
            }
            seed(ui, &mut document.params);
            self.depth(ui, &mut document.params);
            let threads = worker_threads(ui, document.live.threads);
            actions.extend(threads.map(Action::Threads));
        });
    }
}

impl TracingPanel {
    fn depth(&mut self, ui: &mut Ui, params: &mut Params) {
        self.depth = params.max_depth.unwrap_or(self.depth);
        let chosen = usize::from(params.max_depth.is_some());
        let entries = Depth::ALL.map(|d| (d.title(), d.tip().to_owned(), true));
        let pressed = widgets::field(ui, &labels::DEPTH, |ui, _| {
            let width = ui.available_width() - NUMBER - theme::GAP;
            let row = egui::vec2(width, theme::ROW);
            let layout = egui::Layout::left_to_right(egui::Align::Center);
            let pressed = ui
                .allocate_ui_with_layout(row, layout, |ui| {
                    widgets::segmented(ui, Weight::Quiet, chosen, &entries)
                })
                .inner;
            ui.add_enabled_ui(chosen == 1, |ui| {
                number(ui, &labels::DEPTH_LIMIT, &mut self.depth, [1, DEEPEST], 0.05);
            });
            pressed
        });
        let limited = pressed.unwrap_or(chosen) == 1;
        params.max_depth = limited.then_some(self.depth);
    }
}

/// Width of a field of few digits, in points.
const NUMBER: f32 = 50.0;

fn number(
    ui: &mut Ui,
    control: &Control,
    value: &mut u32,
    [low, high]: [u32; 2],
    speed: f64,
) -> egui::Response {
    let field = NumberField {
        name: control.name,
        range: [low.into(), high.into()],
        speed,
        written: Written::Whole,
        unit: "",
        prefix: "",
        size: egui::vec2(NUMBER, ui.spacing().interact_size.y),
    };
    let mut wide = u64::from(*value);
    let response = field.whole(ui, &mut wide);
    *value = u32::try_from(wide).unwrap_or(high);
    response.accessible_name(control.name).on_hover_text(control.tip)
}

fn size(ui: &mut Ui, document: &mut Document) {
    let room = document.live.room;
    let Document { params, follow, .. } = document;
    let before = params.size;
    let as_read = params.scene.screen();
    widgets::field(ui, &labels::SIZE, |ui, _| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let [width, height] = &mut params.size;
        for (i, (control, side)) in
            [(&labels::WIDTH, width), (&labels::HEIGHT, height)].into_iter().enumerate()
        {
            if i > 0 {
                ui.weak("x");
            }
            let speed = 0.005 * f64::from(*side);
            number(ui, control, side, [1, Params::MAX_SIDE], speed);
        }
        let menu = ComboBox::from_id_salt("sizes")
            .width(ui.available_width())
            .height(400.0)
            .selected_text(if *follow { "Window" } else { "Presets" })
            .show_ui(ui, |ui| {
                theme::quiet_choice(ui);
                let [w, h] = room;
                let fill = format!("Follow the window, {w} x {h}");
                if ui.selectable_label(*follow, fill).clicked() {
                    (*follow, params.size) = (true, room);
                }
                let [w, h] = as_read;
                let file = (format!("As in file, {w} x {h}"), as_read);
                let others = SIZES.map(|size @ [w, h]| (format!("{w} x {h}"), size));
                for (words, size) in std::iter::once(file).chain(others) {
                    let chosen = !*follow && params.size == size;
                    if ui.selectable_label(chosen, words).clicked() {
                        (*follow, params.size) = (false, size);
                    }
                }
            });
        let menu = menu.response;
        menu.accessible_name(labels::PRESETS.name).on_hover_text(labels::PRESETS.tip);
    });
    // A side that was typed is to stay.
    *follow &= params.size == before || params.size == room;
}

/// Draws the part of the picture that is traced; true once the whole is asked for.
fn crop(ui: &mut Ui, crop: Crop) -> bool {
    let [x, y, side] = crop.parts().map(percent);
    widgets::field(ui, &labels::CROP, |ui, _| {
        let words = match crop {
            Crop::WHOLE => "the whole picture".to_owned(),
            _ => format!("{side} at {x}, {y}"),
        };
        ui.weak(words).on_hover_text(labels::CROP.tip);
        let button = Button::new(keys::binding(Action::Whole).name).small();
        let tip = keys::tooltip(ui.ctx(), Action::Whole);
        crop != Crop::WHOLE && ui.add(button).on_hover_text(tip).clicked()
    })
}

fn seed(ui: &mut Ui, params: &mut Params) {
    widgets::field(ui, &labels::SEED, |ui, label| {
        let next = Button::new(labels::NEXT_SEED.name);
        let padding = 2.0 * ui.spacing().button_padding.x;
        let button = widgets::text_width(ui, labels::NEXT_SEED.name) + padding + theme::GAP;
        if let Some(seed) = whole_number(ui, label, params.seed, ui.available_width() - button) {
            params.seed = seed;
        }
        if ui.add(next).on_hover_text(labels::NEXT_SEED.tip).clicked() {
            params.seed = params.seed.wrapping_add(1);
        }
    });
}

/// A field for all of 64 bits, which a number that is dragged has not. Returns what was typed once
/// it is left, unless by Escape.
fn whole_number(ui: &mut Ui, label: Id, value: u64, width: f32) -> Option<u64> {
    let id = ui.make_persistent_id("whole number");
    let typed = ui.data(|d| d.get_temp::<String>(id));
    let mut text = typed.unwrap_or_else(|| value.to_string());
    let font = egui::TextStyle::Monospace;
    let field = TextEdit::singleline(&mut text).id(id).font(font).desired_width(width - 8.0);
    let field = ui.add(field).labelled_by(label).on_hover_text(labels::SEED.tip);
    if field.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, text));
        return None;
    }
    ui.data_mut(|d| d.remove::<String>(id));
    let meant = field.lost_focus() && !ui.input(|i| i.key_pressed(Key::Escape));
    let number = text.trim().parse();
    if meant && number.is_err() {
        let text = text.trim();
        let complaint =
            format!("Seed: \"{text}\" is no whole number from 0 to {}; it stays", u64::MAX);
        number_field::complain(ui.ctx(), complaint);
    }
    number.ok().filter(|_| meant)
}

/// Returns another number once it stands still: each one starts the workers anew.
fn worker_threads(ui: &mut Ui, threads: usize) -> Option<usize> {
    widgets::field(ui, &labels::THREADS, |ui, _| {
        let id = ui.make_persistent_id("threads");
        let threads = threads as u32;
        let mut shown = ui.data(|d| d.get_temp::<u32>(id)).unwrap_or(threads);
        let field = number(ui, &labels::THREADS, &mut shown, [0, MOST_THREADS], 0.05);
        if shown == 0 {
            let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
            ui.weak(format!("one a core: {cores}"));
        }
        if field.dragged() {
            ui.data_mut(|d| d.insert_temp(id, shown));
            return None;
        }
        ui.data_mut(|d| d.remove::<u32>(id));
        Some(shown as usize).filter(|_| shown != threads)
    })
}
