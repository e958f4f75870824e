//! Ways in: scenes and pictures that are opened, read again, dropped or gone on with.

use crate::viewer::app::{App, Missed};
use crate::viewer::document::Document;
use crate::viewer::document::dropped::Dropped;
use crate::viewer::jobs::browse::{Browsing, Picked};
use crate::viewer::jobs::load::{Failed, Loaded, Loading, Source};
use crate::viewer::jobs::reference;
use crate::viewer::jobs::resume::{self, Resumed};
use crate::viewer::jobs::watch::Watch;
use crate::viewer::overlays::notice::Notice;
use crate::viewer::render::Render;
use burnish::picture::Tone;
use burnish::progressive::ExperimentError;
use egui::Context;
use std::path::PathBuf;

impl App {
    pub(super) fn load(&mut self, ctx: &Context, source: Source, again: bool) {
        if let Some(path) = source.path().filter(|path| reference::is_for(path)) {
            match reference::start(ctx, path.to_path_buf()) {
                Ok(reading) => self.reading = Some(reading),
                Err(why) => self.notice = Some(Notice::error(why)),
            }
            return;
        }
        if !again && source != self.source {
            self.up = None;
        }
        if let Some(path) = source.path().filter(|path| resume::is_for(path)) {
            return self.start_resuming(ctx, path.to_path_buf());
        }
        self.source = source.clone();
        match Loading::start(ctx, source, again, self.up) {
            Ok(loading) => self.loading = Some(loading),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Reads the scene that is shown again; without one, that which was asked for.
    pub(super) fn reload(&mut self, ctx: &Context) {
        let shown = self.document.as_ref().map(|d| d.source.clone());
        self.load(ctx, shown.unwrap_or(self.source.clone()), true);
    }

    /// Reads again what has changed on disk. What is on its way is waited for: it is not to be
    /// thrown away.
    pub(super) fn changed(&mut self, ctx: &Context) {
        if self.loading.is_some() {
            return;
        }
        if self.watch.as_ref().is_some_and(Watch::poll) {
            self.reload(ctx);
            return;
        }
        let Some(missed) = &self.missed else { return };
        if missed.watch.as_ref().is_some_and(Watch::poll) {
            self.load(ctx, missed.source.clone(), true);
        }
    }

    /// Makes a scene that was read the one that is shown; the picture stays until its own comes.
    pub(super) fn show(&mut self, ctx: &Context, loaded: Loaded) {
        let again = loaded.again;
        let document = self.opened(loaded);
        let applied = match &mut self.render {
            Some(render) => render.apply(&document).map_err(ExperimentError::from),
            None => Render::start(ctx, &document, self.threads, self.settings.switching, None)
                .map(|r| self.render = Some(r)),
        };
        match applied {
            Ok(()) => self.adopt(document, again),
            Err(why) => self.notice = Some(Notice::error(why.to_string())),
        }
        self.look_after(ctx);
    }

    /// Reads a picture that is to go on. Its scene may be one that was opened before.
    pub(super) fn start_resuming(&mut self, ctx: &Context, path: PathBuf) {
        let shown = self.document.as_ref().and_then(|d| d.source.path()).map(|p| p.to_path_buf());
        let recent = self.settings.recent.paths().iter().cloned();
        match resume::start(ctx, path, shown.into_iter().chain(recent).collect()) {
            Ok(resuming) => self.resuming = Some(resuming),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Goes on with a picture from a file.
    pub(super) fn go_on(&mut self, ctx: &Context, resumed: Resumed) {
        let Resumed { loaded, params, experiment, passes } = resumed;
        let sums = experiment.is_some();
        self.source = loaded.source.clone();
        let mut document = self.opened(loaded);
        document.go_on(params, passes);
        let switching = self.settings.switching;
        match Render::start(ctx, &document, self.threads, switching, experiment) {
            Ok(render) => {
                self.replace_render(render);
                document.comparison.on = false;
                self.adopt(document, false);
                let how = if sums { "Goes on after" } else { "Traced again, to go on after" };
                self.notice = Some(Notice::news(format!("{how} {passes} passes")));
            }
            Err(why) => self.notice = Some(Notice::error(why.to_string())),
        }
        self.look_after(ctx);
    }

    /// The document of a scene that was read.
    fn opened(&mut self, loaded: Loaded) -> Document {
        if let Some(before) = &self.document {
            self.exposures.note(&before.source, before.tone.exposure);
        }
        let tone = Tone { exposure: self.exposures.of(&loaded.source), curve: self.settings.curve };
        let first = (tone, self.settings.goal, self.settings.follow);
        let mut document = Document::open(loaded, self.document.as_ref(), first);
        if document.follow {
            document.params.size = self.canvas.room;
        }
        document
    }

    /// Shows this document from now on.
    fn adopt(&mut self, document: Document, again: bool) {
        if let Some(path) = document.source.path() {
            self.settings.recent.add(path);
        }
        // Another scene that is still waited for is not forgotten, nor what is wrong in it.
        self.missed = self.missed.take().filter(|m| again && m.source != document.source);
        let waits = |n: &Notice| self.missed.as_ref().is_some_and(|m| m.why == n.text);
        self.notice = self.notice.take().filter(waits);
        self.document = Some(document);
        if let Some(frozen) = self.early.take() {
            self.compare_with(frozen);
        }
    }

    /// Tells why there is no scene. What was shown stays, and is looked after as before. All that
    /// the message may be about is looked after, too.
    pub(super) fn failed(&mut self, ctx: &Context, Failed { why, source, files }: Failed) {
        self.notice = Some(Notice::error(why.as_str()));
        let watch = self.settings.watch;
        if self.document.as_ref().is_some_and(|d| d.source == source) {
            match &self.watch {
                Some(watch) => watch.add(files),
                None if watch => self.watch = Watch::start(ctx, files),
                None => {}
            }
            return;
        }
        let watch = if watch { Watch::start(ctx, files) } else { None };
        self.missed = Some(Missed { source, why, watch });
    }

    /// Looks after the files of the scene that is shown, if that is wished for.
    pub(super) fn look_after(&mut self, ctx: &Context) {
        let files = self.document.as_ref().filter(|_| self.settings.watch).map(|d| &d.files);
        self.watch = files.and_then(|files| Watch::start(ctx, files.clone()));
        if !self.settings.watch {
            self.missed = None;
        }
    }

    pub(super) fn browse(&mut self, ctx: &Context) {
        if self.browsing.is_some() {
            return;
        }
        let near = self.source.path().and_then(|p| std::path::absolute(p).ok());
        let folder = near.and_then(|p| p.parent().map(|f| f.to_path_buf()));
        match Browsing::start(ctx, self.dialog, folder) {
            Ok(browsing) => self.browsing = Some(browsing),
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Opens what was chosen in the file dialog, once it is closed.
    pub(super) fn browsed(&mut self, ctx: &Context) {
        let Some(picked) = self.browsing.as_ref().and_then(Browsing::poll) else { return };
        self.browsing = None;
        match picked {
            Picked::File(path) => self.load(ctx, Source::File(path), false),
            Picked::Nothing => {}
            Picked::NoDialog => {
                self.open.show();
                let why = "No file dialog could be had from the desktop (on Linux: a portal or \
                           zenity). Type the path above, or drop the file on the window.";
                self.notice = Some(Notice::error(why));
            }
        }
    }

    pub(super) fn dropped(&mut self, ctx: &Context) {
        let dropped = ctx.input(|i| {
            i.raw.dropped_files.iter().map(|f| f.path().to_path_buf()).collect::<Vec<_>>()
        });
        let Dropped { scene, picture, left } = Dropped::sorted(dropped);
        for path in [scene, picture].into_iter().flatten() {
            self.load(ctx, Source::File(path), false);
        }
        if !left.is_empty() {
            let names = left.join(", ");
            self.notice = Some(Notice::news(format!("Left alone of what was dropped: {names}")));
        }
    }
}
