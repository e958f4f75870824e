//! Contact sheets: begun, stopped, reported.

use crate::viewer::app::App;
use crate::viewer::document::Shown;
use crate::viewer::jobs::save::plain;
use crate::viewer::jobs::sheet::{MakingSheet, News, SheetJob};
use crate::viewer::overlays::notice::Notice;
use burnish::progressive::{Params, Sheet};
use egui::Context;

impl App {
    /// Begins a sheet of what is shown, or stops the one in the making.
    pub(super) fn toggle_sheet(&mut self, ctx: &Context) {
        if let Some(making) = &self.sheet {
            return making.stop();
        }
        let (Some(document), Some(render)) = (&self.document, &mut self.render) else { return };
        if document.roughness() == Shown::None {
            let why =
                "No contact sheet: no specular lobe here (Ks = 0), and roughness has no effect";
            self.notice = Some(Notice::news(why));
            return;
        }
        let size = Sheet::fitted(document.params.size);
        let mut sheet = Sheet::new(Params { size, ..document.params.clone() });
        sheet.materials = document.picked.filter(|_| document.only_picked).into_iter().collect();
        let job = SheetJob {
            threads: self.threads,
            tone: document.tone,
            folder: self.folder.clone(),
            stem: format!("{}_sheet", plain(sheet.params.scene.name())),
            sheet,
        };
        let made = job.sheet.check().map_err(|e| e.to_string());
        match made.and_then(|()| MakingSheet::start(ctx, job)) {
            Ok(making) => {
                self.sheet = Some(making);
                render.give_way(true);
            }
            Err(why) => self.notice = Some(Notice::error(why)),
        }
    }

    /// Whether the notice is an error.
    pub(super) fn has_error(&self) -> bool {
        self.notice.as_ref().is_some_and(|notice| notice.is_error)
    }

    /// Takes in the news of the sheet in the making.
    pub(super) fn poll_sheet(&mut self) {
        let Some(of) = self.sheet.as_ref().map(|making| making.of) else { return };
        while let Some(news) = self.sheet.as_mut().and_then(MakingSheet::poll) {
            let notice = match news {
                News::At(number, title) => {
                    let error = self.notice.as_ref().is_some_and(|n| n.is_error);
                    let words =
                        format!("Contact sheet: {number} of {of}, {title}. Escape stops it");
                    Some(Notice::news(words)).filter(|_| !error)
                }
                News::End(end) => {
                    self.sheet = None;
                    if let Some(render) = &mut self.render {
                        render.give_way(false);
                    }
                    Some(end.map_or_else(Notice::error, Notice::news))
                }
            };
            self.notice = notice.or(self.notice.take());
        }
    }
}
