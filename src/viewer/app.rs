//! The window's state: takes in what the background sent, lays the panels out, and tells the
//! renderer what they changed. Knows egui, but not the window itself.

use crate::viewer::document::Document;
use crate::viewer::document::exposures::Exposures;
use crate::viewer::jobs::browse::{Browsing, Dialog};
use crate::viewer::jobs::load::{Loading, Source};
use crate::viewer::jobs::reference::ReadingPicture;
use crate::viewer::jobs::resume::Resuming;
use crate::viewer::jobs::save::Saving;
use crate::viewer::jobs::sheet::MakingSheet;
use crate::viewer::jobs::watch::Watch;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::compare::Compare;
use crate::viewer::panels::controls::Controls;
use crate::viewer::panels::energy::Energy;
use crate::viewer::panels::error::ErrorPanel;
use crate::viewer::panels::help::Help;
use crate::viewer::panels::kept::KeptPanel;
use crate::viewer::panels::lobe::LobePanel;
use crate::viewer::panels::materials::Materials;
use crate::viewer::panels::method::{self, MethodPanel};
use crate::viewer::panels::notice::Notice;
use crate::viewer::panels::open::{self, Open};
use crate::viewer::panels::pixel::PixelPanel;
use crate::viewer::panels::proofs::Proofs;
use crate::viewer::panels::report::ReportPanel;
use crate::viewer::panels::sheet;
use crate::viewer::panels::status::{Facts, Status};
use crate::viewer::panels::tracing::TracingPanel;
use crate::viewer::panels::view::View;
use crate::viewer::picture::canvas::{Canvas, Hover};
use crate::viewer::picture::versus::Versus;
use crate::viewer::render::Render;
use crate::viewer::settings::Settings;
use crate::viewer::style::number_field;
use crate::viewer::style::theme;
use crate::viewer::style::widgets;
use burnish::progressive::{Snapshot, State};
use burnish::scene::Axis;
use egui::{
    Align2, Area, CentralPanel, Context, Frame, Id, Label, Margin, Order, Panel, RichText,
    ScrollArea, Ui, UiBuilder, ViewportCommand, vec2,
};
use std::path::PathBuf;

/// Seconds after which a window that has not grown is taken to have its size.
const STANDS_STILL: f64 = 0.2;

/// How the window begins.
pub(super) struct Setup {
    pub(super) source: Source,
    /// Worker threads; 0 for one a core.
    pub(super) threads: usize,
    /// Where snapshots go; an empty path is the working directory.
    pub(super) folder: PathBuf,
    /// What is remembered from last time.
    pub(super) settings: Settings,
    pub(super) dialog: Dialog,
}

/// A scene that was asked for in vain.
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
    /// A picture from a file that is to go on, being read.
    pub(super) resuming: Option<Resuming>,
    pub(super) browsing: Option<Browsing>,
    pub(super) dialog: Dialog,
    pub(super) notice: Option<Notice>,
    pub(super) canvas: Canvas,
    /// Curve and goal here are those that the first scene begins with.
    pub(super) settings: Settings,
    pub(super) exposures: Exposures,
    /// While changed files are to be read again.
    pub(super) watch: Option<Watch>,
    controls: Controls,
    pub(super) compare: Compare,
    view: View,
    pub(super) lobe: LobePanel,
    pub(super) error: ErrorPanel,
    pub(super) pixel: PixelPanel,
    materials: Materials,
    tracing: TracingPanel,
    method: MethodPanel,
    proofs: Proofs,
    energy: Energy,
    report: ReportPanel,
    status: Status,
    pub(super) help: Help,
    pub(super) open: Open,
    /// Worker threads; 0 for one a core.
    pub(super) threads: usize,
    /// Where snapshots go.
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
    /// What the window's title says.
    title: String,
    /// Whether the canvas shows another picture than the one being traced.
    substituted: bool,
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
            resuming: None,
            browsing: None,
            dialog,
            notice: None,
            canvas: Canvas::new(),
            settings,
            exposures: Exposures::default(),
            watch: None,
            controls: Controls,
            compare: Compare::new(),
            view: View,
            lobe: LobePanel::new(),
            error: ErrorPanel::new(),
            pixel: PixelPanel::new(),
            materials: Materials::default(),
            tracing: TracingPanel::default(),
            method: MethodPanel,
            proofs: Proofs::new(),
            energy: Energy::new(),
            report: ReportPanel,
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
        if let Some(result) = self.loading.as_ref().and_then(Loading::poll) {
            self.loading = None;
            match result {
                Ok(loaded) => self.show(ctx, loaded),
                Err(failed) => self.failed(ctx, failed),
            }
        }
        self.changed(ctx);
        self.browsed(ctx);
        self.hear_of_sheet();
        if let Some(result) = self.saving.as_ref().and_then(Saving::poll) {
            self.saving = None;
            self.notice = Some(match result {
                Ok(text) => Notice::news(text),
                Err(why) => Notice::error(why),
            });
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
        let (Some(render), Some(document)) = (&mut self.render, &self.document) else { return };
        let (now, touched, down) =
            ctx.input(|i| (i.time, !i.events.is_empty(), i.pointer.any_down()));
        render.pace(now, touched);
        render.switch_like(self.settings.switching);
        let news = render.drain();
        if let (true, Some(snapshot)) = (news, &render.newest) {
            // What is dragged is to be seen at once.
            let hold = if down { 0 } else { self.settings.switching.hold };
            if self.compare.first_frozen().is_some() || self.canvas.show(snapshot, document, hold) {
                render.is_shown();
            }
        }
        if let (true, Some(Snapshot { state: State::Failed(why), .. })) = (news, &render.newest) {
            self.notice = Some(Notice::error(why.as_str()));
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
        if !self.alone {
            let frame = bar(ui);
            Panel::bottom("status").exact_size(28.0).frame(frame).show(ui, |ui| self.status(ui));
            let side = Frame::new().fill(ui.visuals().panel_fill);
            Panel::right("controls").exact_size(theme::PANEL).resizable(false).frame(side).show(
                ui,
                |ui| {
                    // As wide as it is, whatever is in it: what is a rounding too wide would move its left edge,
                    // and a picture that follows the window would begin anew.
                    let place = ui.available_rect_before_wrap();
                    let mut inside = ui.new_child(UiBuilder::new().max_rect(place));
                    actions.extend(self.side(&mut inside));
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
        if let Some(told) = number_field::told(&ctx) {
            self.notice = Some(Notice::error(told));
        }
        self.typed = ctx.text_edit_focused();
        self.tell(&ctx);
        self.name_window(&ctx);
    }

    /// What the window's title says.
    #[cfg(test)]
    pub(super) fn title(&self) -> &str {
        &self.title
    }

    /// Has the window's title say what is shown and how far it is.
    fn name_window(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let part = render.newest.as_ref().and_then(|s| document.goal.part(s, render.outlook()));
        let ahead = part.filter(|_| !render.is_done()).map_or(String::new(), |part| {
            // In few steps: a title is not a clock.
            format!("{:.0} % - ", (20.0 * part).floor() * 5.0)
        });
        let title = format!("{ahead}{} - burnish", document.params.scene.name());
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Takes note of how many seconds drawing one frame takes.
    pub(super) fn drawing_takes(&mut self, seconds: f32) {
        if let Some(render) = &mut self.render {
            render.drawing_takes(seconds);
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

    fn status(&mut self, ui: &mut Ui) {
        let render = self.render.as_ref();
        self.status.ui(
            ui,
            &Facts {
                document: self.document.as_ref(),
                snapshot: render.and_then(|r| r.newest.as_ref()),
                done: render.is_some_and(Render::is_done),
                latency: render.and_then(|r| r.latency),
                outlook: render.map(Render::outlook).unwrap_or_default(),
                hover: self.canvas.hover.as_ref(),
                loading: self.loading.as_ref().map(|l| l.name.as_str()),
            },
        );
    }

    fn side(&mut self, ui: &mut Ui) -> Vec<Action> {
        let mut asked = Vec::new();
        let (mut source, mut threads) = (None, None);
        let mut watch = self.settings.watch;
        let recent = self.settings.recent.clone();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| {
                // A line beside the panel takes some of its width.
                ui.set_max_width(ui.available_width());
                let Some(document) = &mut self.document else {
                    source = open::files(ui, &recent, &mut asked);
                    return;
                };
                if let Some(section) = self.turned.take() {
                    widgets::turn_section(ui, section);
                }
                asked.extend(self.controls.ui(ui, document, &mut self.energy));
                let making = self.sheet.as_ref().map(|sheet| [sheet.at, sheet.of]);
                asked.extend(sheet::button(ui, making));
                self.compare.ui(ui, document, &mut asked);
                source = open::files(ui, &recent, &mut asked);
                if let Some(caption) = document.params.scene.caption() {
                    ui.add(Label::new(RichText::new(caption).small().weak()).wrap());
                }
                self.lobe.ui(ui, document, &mut asked);
                self.pixel.ui(ui, document, &mut asked);
                self.materials.ui(ui, document);
                let layer =
                    Some(&mut self.canvas.maps.layer).filter(|_| !self.compare.is_difference());
                asked.extend(self.view.ui(ui, document, layer));
                if let Some(render) = &mut self.render {
                    self.error.ui(ui, document, render, &self.compare, &mut asked);
                }
                threads = self.tracing.ui(ui, document, self.threads, self.canvas.room);
                if let Some(render) = &self.render {
                    KeptPanel.ui(ui, render.kept(), &mut self.settings.switching);
                }
                self.method.ui(ui, document);
                asked.extend(self.report.ui(ui, document, &mut self.energy, &mut watch));
                // Last, for it grows when its proofs are done.
                self.proofs.ui(ui, document);
            });
        });
        if let Some(source) = source {
            self.load(ui.ctx(), source, false);
        }
        if let Some(threads) = threads {
            self.set_threads(ui.ctx(), threads);
        }
        if watch != self.settings.watch {
            self.settings.watch = watch;
            self.look_after(ui.ctx());
        }
        asked
    }

    /// What is to be remembered, but for the window's place.
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
                self.pixel.overlay(ui, document, place, space);
            }
            method::banner(ui, &document.params, space);
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

    /// What is compared in this frame, if there are two pictures.
    fn versus(&mut self, ctx: &Context) -> Option<Versus> {
        let (document, render) = (self.document.as_ref()?, self.render.as_ref()?);
        let compare = &mut self.compare;
        let first = compare.first_frozen().map(|f| f.snapshot.clone());
        let back = first.is_none() && self.substituted;
        if let Some(first) = first.as_ref().or(render.newest.as_ref().filter(|_| back)) {
            self.canvas.put(0, first, document);
        }
        self.substituted = first.is_some();
        let traced = render.beside().cloned();
        let second = compare.second_frozen().map(|f| f.snapshot.clone()).or(traced);
        let Some(second) = second.filter(|_| compare.on) else {
            self.canvas.alone();
            return None;
        };
        self.canvas.put(1, &second, document);
        let first = first.or_else(|| render.newest.clone())?;
        let answer = compare.compared(ctx, document, &first, &second);
        let difference = answer.and_then(|answer| answer.image.clone());
        let names = compare.names(document);
        Some(Versus { layout: compare.layout, names, difference })
    }

    /// Other workers for the same document. The old ones end in the background, with their tile.
    fn set_threads(&mut self, ctx: &Context, threads: usize) {
        let Some(document) = &self.document else { return };
        match Render::start(ctx, document, threads, self.settings.switching, None) {
            Ok(render) => {
                self.threads = threads;
                self.replace_render(render);
            }
            Err(why) => self.notice = Some(Notice::error(why.to_string())),
        }
    }

    pub(super) fn replace_render(&mut self, render: Render) {
        let old = self.render.replace(render);
        // Without a thread for it its workers are waited for here.
        let _ = std::thread::Builder::new().spawn(move || drop(old));
    }

    /// Tells the renderer what changed, and remembers what was before for undo.
    fn tell(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&mut self.document, &mut self.render) else { return };
        if document.params != *render.told() {
            // A change is to be seen, and a paused renderer would show nothing of it.
            document.paused = false;
        }
        if let Err(why) = render.tell(document) {
            self.notice = Some(Notice::error(why.to_string()));
            document.params = render.told().clone();
        }
        if let Err(why) = render.tell_beside(self.compare.beside(ctx, document)) {
            self.notice = Some(Notice::error(why.to_string()));
            self.compare.on = false;
        }
        let (now, down) = ctx.input(|i| (i.time, i.pointer.any_down()));
        document.note(now, down);
    }
}

/// The frame of a line across the window.
fn bar(ui: &Ui) -> Frame {
    Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(16, 0))
}
