//! The window's title: the scene's name, and how far the picture is.

use crate::viewer::app::App;
use egui::{Context, ViewportCommand};

impl App {
    /// The window's title.
    #[cfg(test)]
    pub(super) fn title(&self) -> &str {
        &self.title
    }

    /// Sets the window's title: the scene shown, and how far it is.
    pub(super) fn name_window(&mut self, ctx: &Context) {
        let (Some(document), Some(render)) = (&self.document, &self.render) else { return };
        let part = render
            .newest
            .as_ref()
            .and_then(|s| document.goal.part(s, render.outlook(&document.errors)));
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
}
