//! The window's state: takes in what the background sent, lays the panels out, and tells the
//! renderer what they changed. Knows egui, but not the window itself.

use crate::viewer::document::Document;
use crate::viewer::document::comparison::Frozen;
use crate::viewer::document::exposures::Exposures;
use crate::viewer::document::live::Live;
use crate::viewer::jobs::browse::{Browsing, Dialog};
use crate::viewer::jobs::load::{Loading, Source};
use crate::viewer::jobs::reference::ReadingPicture;
use crate::viewer::jobs::resume::Resuming;
use crate::viewer::jobs::save::Saving;
use crate::viewer::jobs::sheet::MakingSheet;
use crate::viewer::jobs::watch::Watch;
use crate::viewer::keys::{self, Action};
use crate::viewer::overlays::banner::banner;
use crate::viewer::overlays::help::Help;
use crate::viewer::overlays::notice::Notice;
use crate::viewer::overlays::open::Open;
use crate::viewer::panels::status::{self, Status};
use crate::viewer::panels::{Panel as _, SidePanels, files};
use crate::viewer::picture::canvas::{Canvas, Hover};
use crate::viewer::render::Render;
use crate::viewer::settings::Settings;
use crate::viewer::style::number_field;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::progressive::State;
use burnish::scene::Axis;
use egui::{
    Align2, Area, CentralPanel, Context, Frame, Id, Margin, Order, Panel, ScrollArea, Ui,
    UiBuilder, vec2,
};
use std::path::PathBuf;

/// Seconds after which a window that has not grown is taken to have its size.
const STANDS_STILL: f64 = 0.2;

/// Settings that the window begins with.
pub(super) struct Setup {
    pub(super) source: Source,
    /// Worker threads; 0 for one a core.
    pub(super) threads: usize,
    /// Folder that snapshots go to; an empty path is the working directory.
    pub(super) folder: PathBuf,
    /// Settings remembered from last time.
    pub(super) settings: Settings,
    pub(super) dialog: Dialog,
}

/// A scene that could not be read, to be tried again when its files change.
pub(super) struct Missed {
    pub(super) source: Source,
    pub(super) why: String,
    pub(super) watch: Option<Watch>,
}

pub(super) struct App {
    pub(super) document: Option<Document>,
    pub(super) render: Option<Render>,
    pub(super) loading: Option<Loading>,
    /// The scene that was asked for last.
    pub(super) source: Source,
    /// A scene that could not be read and is not the one shown; it is once its files change.
    pub(super) missed: Option<Missed>,
    pub(super) saving: Option<Saving>,
    pub(super) sheet: Option<MakingSheet>,
    /// A picture to compare with, being read.
    pub(super) reading: Option<ReadingPicture>,
    /// One that was read before there was a document.
    pub(super) early: Option<Frozen>,
    /// A picture from a file that is to go on, being read.
    pub(super) resuming: Option<Resuming>,
    pub(super) browsing: Option<Browsing>,
    pub(super) dialog: Dialog,
    pub(super) notice: Option<Notice>,
    pub(super) canvas: Canvas,
    /// Curve and goal here are those that the first scene begins with.
    pub(super) settings: Settings,
    pub(super) exposures: Exposures,
    /// Watch over the scene's files, while changed ones are to be read again.
    pub(super) watch: Option<Watch>,
    pub(super) panels: SidePanels,
    status: Status,
    pub(super) help: Help,
    pub(super) open: Open,
    /// Worker threads; 0 for one a core.
    pub(super) threads: usize,
    /// Folder that snapshots go to.
    pub(super) folder: PathBuf,
    pub(super) full_screen: bool,
    /// The axis of a model by itself that is to point up, if it is not the guessed one.
    pub(super) up: Option<Axis>,
    /// Whether the picture has the window for itself.
    pub(super) alone: bool,
    /// The room that a picture has, and since when, in egui's seconds, while the picture has not.
    growing: Option<([u32; 2], f64)>,
    /// A section of the panel that is to be opened or closed.
    pub(super) turned: Option<&'static str>,
    /// Whether text was being typed in the frame before.
    typed: bool,
    /// The window's title.
    pub(super) title: String,
    /// Whether the canvas shows another picture than the one being traced.
    pub(super) substituted: bool,
}

impl App {
    /// Starts to read the scene.
    pub(super) fn new(ctx: &Context, setup: Setup) -> App {
        theme::install(ctx);
        let Setup { source, threads, folder, settings, dialog } = setup;
        let mut app = App {
            document: None,
            render: None,
            loading: None,
            source: source.clone(),
            missed: None,
            saving: None,
            sheet: None,
            reading: None,
            early: None,
            resuming: None,
            browsing: None,
            dialog,
            notice: None,
            canvas: Canvas::new(),
            settings,
            exposures: Exposures::default(),
            watch: None,
            panels: SidePanels::default(),
            status: Status,
            help: Help::default(),
            open: Open::default(),
            threads,
            folder,
            full_screen: false,
            up: None,
            alone: false,
            growing: None,
            turned: None,
            typed: false,
            title: String::new(),
            substituted: false,
        };
        app.load(ctx, source, false);
        app
    }

    /// Takes in what the background threads have ready. Draws nothing.
    pub(super) fn logic(&mut self, ctx: &Context) {
        self.finish_jobs(ctx);
        let (Some(render), Some(document)) = (&mut self.render, &mut self.document) else { return };
        let (now, touched, down) =
            ctx.input(|i| (i.time, !i.events.is_empty(), i.pointer.any_down()));
        render.pace(now, touched);
        render.set_switching(self.settings.switching);
        let news = render.drain(&mut document.errors);
        let Some(snapshot) = render.newest.clone().filter(|_| news) else { return };
        // What is dragged is to be seen at once.
        let hold = if down { 0 } else { self.settings.switching.hold };
        let substituted = document.comparison.first_frozen().is_some();
        if substituted || self.canvas.show(&snapshot, document, hold) {
            render.note_shown();
        }
        if let State::Failed(why) = &snapshot.state {
            self.notice = Some(Notice::error(why.as_str()));
        }
    }

    /// Takes in what jobs have come to.
    fn finish_jobs(&mut self, ctx: &Context) {
        if let Some(result) = self.loading.as_ref().and_then(Loading::poll) {
            self.loading = None;
            match result {
                Ok(loaded) => self.show(ctx, loaded),
                Err(failed) => self.failed(ctx, failed),
            }
        }
        self.changed(ctx);
        self.browsed(ctx);
        self.poll_sheet();
        if let Some(result) = self.saving.as_ref().and_then(Saving::poll) {
            self.saving = None;
            self.notice = Some(result.map_or_else(Notice::error, Notice::news));
        }
        if let Some(result) = self.reading.as_ref().and_then(ReadingPicture::poll) {
            self.reading = None;
            match result {
                Ok(frozen) => self.compare_with(frozen),
                Err(why) => self.notice = Some(Notice::error(why)),
            }
        }
        if let Some(result) = self.resuming.as_ref().and_then(Resuming::poll) {
            self.resuming = None;
            match result {
                Ok(resumed) => self.go_on(ctx, resumed),
                Err(why) => self.notice = Some(Notice::error(why)),
            }
        }
    }

    /// Draws the window and acts on the input.
    pub(super) fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let mut actions = keys::pressed(&ctx, self.canvas.has_focus(&ctx), self.typed);
        if self.help.open {
            actions.retain(|action| matches!(action, Action::Help | Action::Dismiss));
        }
        self.dropped(&ctx);
        self.refresh_live();
        if !self.alone {
            let frame = bar(ui);
            Panel::bottom("status").exact_size(28.0).frame(frame).show(ui, |ui| {
                match &mut self.document {
                    Some(document) => self.status.ui(ui, document, &mut actions),
                    None => status::empty(ui, self.loading.as_ref().map(|l| l.name.as_str())),
                }
            });
            let side = Frame::new().fill(ui.visuals().panel_fill);
            Panel::right("controls").exact_size(theme::PANEL).resizable(false).frame(side).show(
                ui,
                |ui| {
                    // As wide as it is, whatever is in it: what is a rounding too wide would move its left edge,
                    // and a picture that follows the window would begin anew.
                    let place = ui.available_rect_before_wrap();
                    let mut inside = ui.new_child(UiBuilder::new().max_rect(place));
                    self.side(&mut inside, &mut actions);
                    ui.advance_cursor_after_rect(place);
                },
            );
        }
        if self.open.is_shown() {
            let source = Panel::top("open")
                .exact_size(40.0)
                .frame(bar(ui))
                .show(ui, |ui| self.open.ui(ui, &mut actions))
                .inner;
            if let Some(source) = source {
                self.load(&ctx, source, false);
            }
        }
        let ground = Frame::new().fill(theme::surround(ui.visuals()));
        CentralPanel::default().frame(ground).show(ui, |ui| self.picture(ui));
        self.follow(&ctx);
        self.help.ui(ui);
        for action in actions {
            self.act(&ctx, action);
        }
        if let Some(complaint) = number_field::take_complaint(&ctx) {
            self.notice = Some(Notice::error(complaint));
        }
        self.typed = ctx.text_edit_focused();
        self.apply(&ctx);
        self.name_window(&ctx);
    }

    /// Takes note of how many seconds drawing one frame takes.
    pub(super) fn note_drawing(&mut self, seconds: f32) {
        if let Some(render) = &mut self.render {
            render.note_drawing(seconds);
        }
    }

    /// Makes the picture as large as the window has room for, if it is to follow that: once the window
    /// has stopped to grow, for each size is a picture of its own.
    fn follow(&mut self, ctx: &Context) {
        let room = self.canvas.room;
        let Some(document) = self.document.as_mut().filter(|d| d.follow) else { return };
        if document.params.size == room {
            self.growing = None;
            return;
        }
        let now = ctx.input(|i| i.time);
        let since = self.growing.filter(|(size, _)| *size == room).map_or(now, |(_, at)| at);
        self.growing = Some((room, since));
        if now - since >= STANDS_STILL || self.canvas.is_empty() {
            document.params.size = room;
        } else {
            ctx.request_repaint_after_secs(STANDS_STILL as f32);
        }
    }

    /// Writes what the panels of this frame read besides the document's own settings.
    fn refresh_live(&mut self) {
        let (Some(document), Some(render)) = (&mut self.document, &self.render) else { return };
        document.live = Live {
            newest: render.newest.clone(),
            is_current: render.current().is_some(),
            is_done: render.is_done(),
            latency: render.latency,
            outlook: render.outlook(&document.errors),
            kept: render.kept(),
            hover: self.canvas.hover,
            room: self.canvas.room,
            loading: self.loading.as_ref().map(|l| l.name.clone()),
            sheet: self.sheet.as_ref().map(|sheet| [sheet.at, sheet.of]),
            threads: self.threads,
            recent: self.settings.recent.clone(),
            watch: self.settings.watch,
            switching: self.settings.switching,
        };
    }

    /// Draws the panels of the side below each other; without a document the way to one.
    fn side(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| {
                // A line beside the panel takes some of its width.
                ui.set_max_width(ui.available_width());
                let Some(document) = &mut self.document else {
                    return files::row(ui, &self.settings.recent, actions);
                };
                if let Some(section) = self.turned.take() {
                    widgets::turn_section(ui, section);
                }
                for panel in self.panels.all() {
                    panel.ui(ui, document, actions);
                }
            });
        });
    }

    /// Settings to be remembered, but for the window's place.
    pub(super) fn settings(&self, ctx: &Context) -> Settings {
        let (curve, goal, follow) = match &self.document {
            Some(document) => (document.tone.curve, document.goal, document.follow),
            None => (self.settings.curve, self.settings.goal, self.settings.follow),
        };
        let theme = ctx.options(|o| o.theme_preference);
        Settings { theme, curve, goal, follow, ..self.settings.clone() }
    }

    fn picture(&mut self, ui: &mut Ui) {
        let key = |hover: &Option<Hover>| hover.map(|h| (h.pixel, h.passes, h.samples));
        let before = key(&self.canvas.hover);
        let versus = self.versus(ui.ctx());
        let space = self.canvas.ui(ui, self.document.as_mut(), versus).rect;
        if key(&self.canvas.hover) != before {
            // The status line, which tells of it, was drawn before.
            ui.ctx().request_repaint();
        }
        if self.canvas.is_empty() && self.loading.is_none() && self.document.is_none() {
            let words = "Drop a scene here, or press Ctrl-O";
            let font = egui::TextStyle::Heading.resolve(ui.style());
            let colour = ui.visuals().strong_text_color();
            ui.painter().text(space.center(), Align2::CENTER_CENTER, words, font, colour);
        }
        if let Some(document) = &self.document {
            if let Some(place) = self.canvas.place.filter(|_| !self.alone) {
                self.panels.pixel.overlay(ui, document, place, space);
            }
            banner(ui, &document.params, space);
        }
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            widgets::drop_target(ui, space);
        }
        let Some(notice) = &mut self.notice else { return };
        let width = (space.width() - 32.0).min(720.0);
        let stays = Area::new(Id::unique("notice"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(space.center_bottom() - vec2(0.0, 16.0))
            .show(ui.ctx(), |ui| {
                ui.set_width(width);
                notice.ui(ui)
            })
            .inner;
        if !stays {
            self.notice = None;
        }
    }
}

/// The frame of a line across the window.
fn bar(ui: &Ui) -> Frame {
    Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(16, 0))
}
