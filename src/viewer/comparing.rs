//! Comparing: the second picture beside the first, and the reference from a file.

use crate::viewer::app::App;
use crate::viewer::document::comparison::Frozen;
use crate::viewer::picture::versus::Versus;
use egui::Context;

impl App {
    /// Compares with a picture from a file. One that follows the window takes on its size: pictures of
    /// different sizes can't be compared. Without a document it waits for one.
    pub(super) fn compare_with(&mut self, frozen: Frozen) {
        let Some(document) = &mut self.document else {
            self.early = Some(frozen);
            return;
        };
        if document.follow {
            (document.follow, document.params.size) = (false, frozen.snapshot.grid.size);
        }
        document.comparison.take_file(frozen);
    }

    /// The comparison of this frame, if there are two pictures.
    pub(super) fn versus(&mut self, ctx: &Context) -> Option<Versus> {
        let (document, render) = (self.document.as_ref()?, self.render.as_ref()?);
        let comparison = &document.comparison;
        let first = comparison.first_frozen().map(|f| f.snapshot.clone());
        let back = first.is_none() && self.substituted;
        if let Some(first) = first.as_ref().or(render.newest.as_deref().filter(|_| back)) {
            self.canvas.put(0, first, document);
        }
        self.substituted = first.is_some();
        let traced = render.beside().cloned();
        let second = comparison.second_frozen().map(|f| f.snapshot.clone()).or(traced);
        let Some(second) = second.filter(|_| comparison.on) else {
            self.canvas.alone();
            return None;
        };
        self.canvas.put(1, &second, document);
        let first = first.or_else(|| render.newest.as_deref().cloned())?;
        let answer = self.panels.compare.compared(ctx, document, &first, &second);
        let difference = answer.and_then(|answer| answer.image.clone());
        let names = comparison.names(document.params.model);
        Some(Versus { layout: comparison.layout, names, difference })
    }
}
