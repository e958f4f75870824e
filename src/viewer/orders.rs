//! Orders to the renderer: what the panels changed, and other workers.

use crate::viewer::app::App;
use crate::viewer::document::errors::Curves;
use crate::viewer::overlays::notice::Notice;
use crate::viewer::render::Render;
use egui::Context;

impl App {
    /// Other workers for the same document. The old ones end in the background, with their tile.
    pub(super) fn set_threads(&mut self, ctx: &Context, threads: usize) {
        let Some(document) = &mut self.document else { return };
        match Render::start(ctx, document, threads, self.settings.switching, None) {
            Ok(render) => {
                self.threads = threads;
                // Times by other workers are no times of the same curve.
                document.errors = Curves::default();
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
    pub(super) fn apply(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&mut self.document, &mut self.render) else { return };
        if document.params != *render.applied() {
            // A change is to be seen, and a paused renderer would show nothing of it.
            document.paused = false;
        }
        if let Err(why) = render.apply(document) {
            self.notice = Some(Notice::error(why.to_string()));
            document.params = render.applied().clone();
        }
        if let Err(why) = render.apply_beside(self.panels.compare.beside(ctx, document)) {
            self.notice = Some(Notice::error(why.to_string()));
            document.comparison.on = false;
        }
        let (now, down) = ctx.input(|i| (i.time, i.pointer.any_down()));
        document.note(now, down);
    }
}
