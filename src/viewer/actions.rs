//! The actions of keys and buttons.

use crate::viewer::app::App;
use crate::viewer::document::command;
use crate::viewer::jobs::load::Source;
use crate::viewer::jobs::save::{Job, PlotJob, Saving, SceneJob, stem};
use crate::viewer::keys::Action;
use crate::viewer::overlays::notice::Notice;
use crate::viewer::panels::export::{Content, Export};
use crate::viewer::panels::view::View;
use crate::viewer::style::labels;
use burnish::progressive::{Recipe, Snapshot};
use burnish::scene::{Axis, Crop};
use egui::{Context, ViewportCommand};

/// Factor of alpha for one press of [ or ]: four of them double it.
const ROUGHNESS_STEP: f64 = 1.189_207_115_002_721;
/// Exposure that one press of E adds, in stops.
const EXPOSURE_STEP: f32 = 0.5;

impl App {
    /// Does what a key or a button asks for.
    pub(super) fn act(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::Open => self.open.toggle(),
            Action::Help => self.help.open = !self.help.open,
            Action::Zoom => self.canvas.toggle_zoom(),
            Action::FullScreen => {
                self.full_screen = !self.full_screen;
                self.alone = self.full_screen;
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(self.full_screen));
            }
            Action::Save => self.save(ctx),
            Action::SaveScene => self.save_scene(ctx),
            Action::Sheet => self.toggle_sheet(ctx),
            Action::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Action::Browse => self.browse(ctx),
            Action::Reload => self.reload(ctx),
            Action::CopyCommand => self.copy_command(ctx),
            Action::Tag => self.tag(),
            Action::Lobes => self.turned = Some("lobes"),
            Action::Pixel => self.turned = Some("pixel"),
            Action::Errors => self.turned = Some("error"),
            Action::CopyPicture => self.copy_picture(ctx),
            Action::Dismiss => self.dismiss(ctx),
            Action::HidePanel => self.alone = !self.alone,
            Action::Export => self.export(ctx),
            Action::TurnUp => self.turn_up(ctx),
            Action::Resume => self.resume(ctx),
            Action::OpenExample(example) => self.load(ctx, Source::Example(example), false),
            Action::OpenRecent(place) => self.open_recent(ctx, place),
            Action::Threads(threads) => self.set_threads(ctx, threads),
            Action::Watch(watch) => {
                self.settings.watch = watch;
                self.look_after(ctx);
            }
            Action::Switching(switching) => self.settings.switching = switching,
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
            Action::Compare => document.comparison.on = !document.comparison.on,
            Action::Layer if document.comparison.is_difference() => {
                self.notice = Some(Notice::news(labels::LAYER_NONE));
            }
            Action::Layer => document.layer = document.layer.next(),
            Action::Brighter => View::expose(document, EXPOSURE_STEP),
            Action::Darker => View::expose(document, -EXPOSURE_STEP),
            Action::Home => document.params.camera = document.params.scene.camera(),
            Action::Whole => document.params.camera.crop = Crop::WHOLE,
            Action::Frame => {
                let (framed, aspect) = (document.framed(), document.aspect());
                let params = &mut document.params;
                params.camera = params.scene.framed(&params.camera, aspect, framed);
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

    /// Ends one of what stands over the picture or keeps the panel away, what came last first.
    fn dismiss(&mut self, ctx: &Context) {
        if self.help.open {
            self.help.open = false;
        } else if self.open.is_shown() {
            self.open.toggle();
        } else if let Some(sheet) = self.sheet.as_ref().filter(|_| !self.has_error()) {
            sheet.stop();
        } else if self.notice.is_some() {
            self.notice = None;
        } else if self.full_screen {
            self.act(ctx, Action::FullScreen);
        } else if self.alone {
            self.alone = false;
        } else if let Some(document) = &mut self.document {
            if document.comparison.on {
                document.comparison.on = false;
            } else {
                document.only_picked = false;
            }
        }
    }

    fn save(&mut self, ctx: &Context) {
        if self.is_saving() {
            return;
        }
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let Some(snapshot) = render.newest.as_deref().cloned() else { return };
        let params = &document.params;
        let current = snapshot.epoch >= render.epoch;
        let job = Job {
            recipe: current.then(|| Recipe::new(render.applied(), &snapshot)),
            snapshot,
            tone: document.tone,
            folder: self.folder.clone(),
            stem: stem(params),
        };
        match Saving::snapshot(ctx, job) {
            Ok(saving) => self.saving = Some(saving),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Writes the edited scene beside its own file, where its models are found; without one, where snapshots go.
    fn save_scene(&mut self, ctx: &Context) {
        if self.is_saving() {
            return;
        }
        let Some(document) = &self.document else { return };
        let beside = document.source.path().and_then(|path| path.parent());
        let folder = beside.unwrap_or(&self.folder).to_path_buf();
        let mut params = document.params.clone();
        if document.follow {
            // The window's size is no edit.
            params.size = params.scene.screen();
        }
        match Saving::scene(ctx, SceneJob { params, folder }) {
            Ok(saving) => self.saving = Some(saving),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Does with a plot's curves what was asked for.
    fn export(&mut self, ctx: &Context) {
        let ready = self.panels.lobe.exports.take().or_else(|| self.panels.error.exports.take());
        let Some(Export { stem, content }) = ready else { return };
        let plot = match content {
            Content::Copied(text) => {
                let lines = text.lines().count();
                self.notice = Some(Notice::news(format!("Copied a table of {lines} lines")));
                return ctx.copy_text(text);
            }
            Content::File(plot) => plot,
        };
        if self.is_saving() {
            return;
        }
        match Saving::plot(ctx, PlotJob { plot, folder: self.folder.clone(), stem }) {
            Ok(saving) => self.saving = Some(saving),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Goes on with the picture in the file that is compared with.
    fn resume(&mut self, ctx: &Context) {
        let file = self.document.as_ref().and_then(|d| d.comparison.file.as_ref());
        let Some(path) = file.and_then(|file| file.resumable.clone()) else { return };
        self.start_resuming(ctx, path);
    }

    /// Whether a file is being written; then it is told, too.
    fn is_saving(&mut self) -> bool {
        if self.saving.is_some() {
            self.notice = Some(Notice::news("The file before is still being written"));
        }
        self.saving.is_some()
    }

    fn open_recent(&mut self, ctx: &Context, place: usize) {
        if let Some(path) = self.settings.recent.paths().get(place).cloned() {
            self.load(ctx, Source::File(path), false);
        }
    }

    /// Keeps the picture as it is, to compare others with.
    fn tag(&mut self) {
        let (Some(document), Some(render)) = (&mut self.document, &self.render) else { return };
        let Some(snapshot) = &render.newest else { return };
        let name = format!("{}, {} passes", document.params.model.title(), snapshot.passes);
        self.notice = Some(Notice::news(format!("Tagged: {name}. Compare with it by C")));
        document.comparison.take_tag(name, Snapshot::clone(snapshot));
    }

    /// Stands a model by itself on its next axis.
    fn turn_up(&mut self, ctx: &Context) {
        let Some(document) = &self.document else { return };
        let Some(axis) = document.params.scene.source().up else {
            self.notice =
                Some(Notice::news("Only a model that was opened by itself can be turned"));
            return;
        };
        let source = document.source.clone();
        let at = Axis::ALL.iter().position(|&a| a == axis).unwrap_or(0);
        let next = Axis::ALL[(at + 1) % Axis::ALL.len()];
        self.source = source.clone();
        self.up = Some(next);
        self.load(ctx, source, false);
        self.notice = Some(Notice::news(format!("Its axis {} points up", next.name())));
    }

    /// Puts the picture on the clipboard as it is shown.
    fn copy_picture(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let Some(snapshot) = &render.newest else { return };
        let mean = snapshot.mean();
        let mut codes = vec![egui::Color32::BLACK; mean.pixels.len()];
        document.tone.map(&mean.pixels, &mut codes, |[r, g, b]| egui::Color32::from_rgb(r, g, b));
        let size = [mean.width as usize, mean.height as usize];
        ctx.copy_image(egui::epaint::ColorImage::new(size, codes));
        self.notice = Some(Notice::news(format!("Copied the picture, {} x {}", size[0], size[1])));
    }

    fn copy_command(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let Some(snapshot) = &render.newest else { return };
        let made = command::again(render.applied(), snapshot, document.tone, &document.source);
        self.notice = Some(match made {
            Ok(text) => {
                let lines = text.lines().count();
                let words = match lines {
                    1 => format!("Copied: {text}"),
                    n => format!(
                        "Copied {n} lines: the edited scene, and the command that renders it"
                    ),
                };
                ctx.copy_text(text);
                Notice::news(words)
            }
            Err(why) => Notice::error(format!("no command: {why}")),
        });
    }
}
