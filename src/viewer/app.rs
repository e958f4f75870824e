//! The window's state: takes in what the background sent, lays the panels out, and tells the
//! renderer what they changed. Knows egui, but not the window itself.

use super::canvas::Canvas;
use super::command;
use super::controls::Controls;
use super::document::Document;
use super::energy::Energy;
use super::help::Help;
use super::keys::{self, Action};
use super::load::{Loaded, Loading, Source};
use super::materials::Materials;
use super::method::{self, MethodPanel};
use super::notice::Notice;
use super::open::{self, Open};
use super::orbit;
use super::proofs::Proofs;
use super::render::Render;
use super::report::ReportPanel;
use super::save::{Job, Saving, stem};
use super::status::{Facts, Status};
use super::view::View;
use super::{theme, widgets};
use burnish::progressive::{Recipe, State};
use egui::{
    Align2, Area, CentralPanel, Context, Frame, Id, Margin, Order, Panel, ScrollArea, Ui,
    ViewportCommand, vec2,
};
use std::path::PathBuf;

/// What one press of [ or ] does to alpha: four of them double it.
const ROUGHNESS_STEP: f64 = 1.189_207_115_002_721;
/// What one press of E does, in stops.
const EXPOSURE_STEP: f32 = 0.5;

pub(super) struct App {
    pub(super) document: Option<Document>,
    pub(super) render: Option<Render>,
    loading: Option<Loading>,
    /// The scene that was asked for last, to be read again.
    source: Source,
    saving: Option<Saving>,
    pub(super) notice: Option<Notice>,
    pub(super) canvas: Canvas,
    controls: Controls,
    view: View,
    materials: Materials,
    method: MethodPanel,
    proofs: Proofs,
    energy: Energy,
    report: ReportPanel,
    status: Status,
    pub(super) help: Help,
    open: Open,
    /// Worker threads; 0 for one a core.
    threads: usize,
    /// Where snapshots go.
    folder: PathBuf,
    full_screen: bool,
}

impl App {
    /// Starts to read the scene.
    pub(super) fn new(ctx: &Context, source: Source, threads: usize, folder: PathBuf) -> App {
        theme::install(ctx);
        let mut app = App {
            document: None,
            render: None,
            loading: None,
            source: source.clone(),
            saving: None,
            notice: None,
            canvas: Canvas::new(),
            controls: Controls,
            view: View,
            materials: Materials::default(),
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
                Err(why) => self.notice = Some(Notice::error(why)),
            }
        }
        if let Some(result) = self.saving.as_ref().and_then(Saving::poll) {
            self.saving = None;
            self.notice = Some(match result {
                Ok(text) => Notice::news(text),
                Err(why) => Notice::error(why),
            });
        }
        let (Some(render), Some(document)) = (&mut self.render, &self.document) else { return };
        if render.drain()
            && let Some(snapshot) = &render.newest
        {
            self.canvas.show(ctx, snapshot, document);
            if let State::Failed(why) = &snapshot.state {
                self.notice = Some(Notice::error(why.as_str()));
            }
        }
    }

    /// Draws the window and acts on the input.
    pub(super) fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let mut actions = keys::pressed(&ctx, self.canvas.has_focus(&ctx));
        if self.help.open {
            actions.retain(|action| *action == Action::Help);
        }
        self.dropped(&ctx);
        Panel::bottom("status").exact_size(28.0).frame(bar(ui)).show(ui, |ui| self.status(ui));
        let side = Frame::new().fill(ui.visuals().panel_fill);
        Panel::right("controls")
            .exact_size(theme::PANEL)
            .resizable(false)
            .frame(side)
            .show(ui, |ui| actions.extend(self.side(ui)));
        if self.open.is_shown() {
            let path = Panel::top("open")
                .exact_size(40.0)
                .frame(bar(ui))
                .show(ui, |ui| self.open.ui(ui))
                .inner;
            if let Some(path) = path {
                self.load(&ctx, Source::File(path), false);
            }
        }
        let ground = Frame::new().fill(theme::surround(ui.visuals()));
        CentralPanel::default().frame(ground).show(ui, |ui| self.picture(ui));
        self.help.ui(ui);
        for action in actions {
            self.act(&ctx, action);
        }
        self.tell(&ctx);
    }

    /// Takes note of how many seconds drawing one frame takes.
    pub(super) fn drawing_takes(&self, seconds: f32) {
        if let Some(render) = &self.render {
            render.drawing_takes(seconds);
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
                hover: self.canvas.hover,
                loading: self.loading.as_ref().map(|l| l.name.as_str()),
            },
        );
    }

    fn side(&mut self, ui: &mut Ui) -> Vec<Action> {
        let mut asked = Vec::new();
        let mut source = None;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Frame::new().inner_margin(Margin::same(16)).show(ui, |ui| {
                ui.set_max_width(theme::PANEL - 32.0);
                let Some(document) = &mut self.document else {
                    source = open::files(ui, &mut asked);
                    return;
                };
                asked.extend(self.controls.ui(ui, document, &mut self.energy));
                source = open::files(ui, &mut asked);
                self.materials.ui(ui, document);
                asked.extend(self.view.ui(ui, document));
                self.method.ui(ui, document);
                self.proofs.ui(ui, document);
                self.report.ui(ui, document, &mut self.energy);
            });
        });
        if let Some(source) = source {
            self.load(ui.ctx(), source, false);
        }
        asked
    }

    fn picture(&mut self, ui: &mut Ui) {
        let space = self.canvas.ui(ui, self.document.as_mut()).rect;
        if self.canvas.is_empty() && self.loading.is_none() && self.document.is_none() {
            let words = "Drop a scene here, or press Ctrl-O";
            let font = egui::TextStyle::Heading.resolve(ui.style());
            let colour = ui.visuals().strong_text_color();
            ui.painter().text(space.center(), Align2::CENTER_CENTER, words, font, colour);
        }
        if let Some(document) = &self.document {
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

    fn act(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::Open => self.open.toggle(),
            Action::Help => self.help.open = !self.help.open,
            Action::Zoom => self.canvas.toggle_zoom(),
            Action::FullScreen => {
                self.full_screen = !self.full_screen;
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(self.full_screen));
            }
            Action::Save => self.save(ctx),
            Action::Reload => self.load(ctx, self.source.clone(), true),
            Action::CopyCommand => self.copy_command(ctx),
            _ => self.edit(ctx, action),
        }
    }

    /// The actions that need a scene.
    fn edit(&mut self, ctx: &Context, action: Action) {
        let Some(document) = &mut self.document else { return };
        match action {
            Action::Model(model) => document.params.model = model,
            Action::Smoother => document.scale_roughness(1.0 / ROUGHNESS_STEP),
            Action::Rougher => document.scale_roughness(ROUGHNESS_STEP),
            Action::Pause => document.paused = !document.paused,
            Action::Brighter => View::expose(document, EXPOSURE_STEP),
            Action::Darker => View::expose(document, -EXPOSURE_STEP),
            Action::Home => document.params.camera = document.params.scene.camera(),
            Action::Frame => {
                let camera = &document.params.camera;
                document.params.camera =
                    orbit::framed(camera, document.subject(), document.aspect());
            }
            Action::Restart => {
                document.paused = false;
                if let Some(render) = &mut self.render {
                    render.restart();
                }
            }
            Action::CopyCamera => {
                let line = document.params.camera.scn_line();
                self.notice = Some(Notice::news(format!("Copied: {line}")));
                ctx.copy_text(line);
            }
            Action::Undo | Action::Redo => {
                let done = if action == Action::Undo { document.undo() } else { document.redo() };
                if done {
                    document.paused = false;
                }
            }
            // Done without one.
            _ => {}
        }
    }

    fn load(&mut self, ctx: &Context, source: Source, again: bool) {
        self.source = source.clone();
        match Loading::start(ctx, source, again) {
            Ok(loading) => self.loading = Some(loading),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Makes a scene that was read the one that is shown; the picture stays until its own comes.
    fn show(&mut self, ctx: &Context, loaded: Loaded) {
        let document = Document::open(loaded, self.document.as_ref());
        let told = match &mut self.render {
            Some(render) => render.tell(&document),
            None => Render::start(ctx, &document, self.threads).map(|r| self.render = Some(r)),
        };
        match told {
            Ok(()) => {
                let name = document.params.scene.name();
                ctx.send_viewport_cmd(ViewportCommand::Title(format!("{name} - burnish")));
                self.document = Some(document);
                self.notice = None;
            }
            Err(why) => self.notice = Some(Notice::error(why.to_string())),
        }
    }

    fn save(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let Some(snapshot) = render.newest.clone() else { return };
        if self.saving.is_some() {
            self.notice = Some(Notice::news("The snapshot before is still being written"));
            return;
        }
        let params = &document.params;
        let current = snapshot.epoch >= render.epoch;
        let job = Job {
            recipe: current.then(|| Recipe::new(render.told(), &snapshot)),
            snapshot,
            tone: document.tone,
            folder: self.folder.clone(),
            stem: stem(params),
        };
        match Saving::start(ctx, job) {
            Ok(saving) => self.saving = Some(saving),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    fn copy_command(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let Some(snapshot) = &render.newest else { return };
        let made = command::again(render.told(), snapshot, document.tone, &document.source);
        self.notice = Some(match made {
            Ok(text) => {
                let lines = text.lines().count();
                let told = match lines {
                    1 => format!("Copied: {text}"),
                    n => format!(
                        "Copied {n} lines: the edited scene, and the command that renders it"
                    ),
                };
                ctx.copy_text(text);
                Notice::news(told)
            }
            Err(why) => Notice::error(format!("no command: {why}")),
        });
    }

    fn dropped(&mut self, ctx: &Context) {
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_path_buf()));
        if let Some(path) = dropped {
            self.load(ctx, Source::File(path), false);
        }
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
        let (now, down) = ctx.input(|i| (i.time, i.pointer.any_down()));
        document.note(now, down);
    }
}

/// The frame of a line across the window.
fn bar(ui: &Ui) -> Frame {
    Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(16, 0))
}
