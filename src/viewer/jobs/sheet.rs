//! A contact sheet in the making, on a thread of its own.

use crate::viewer::jobs::save::free_names;
use burnish::picture::Tone;
use burnish::progressive::{Sheet, SheetProgress};
use egui::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

/// A sheet to make, and the place it goes to.
pub(crate) struct SheetJob {
    pub(crate) sheet: Sheet,
    /// Worker threads; 0 for one a core.
    pub(crate) threads: usize,
    pub(crate) tone: Tone,
    pub(crate) folder: PathBuf,
    /// The name before the number.
    pub(crate) stem: String,
}

/// A sheet in the making. It stops when this is dropped, and then writes nothing.
pub(crate) struct MakingSheet {
    stop: Arc<AtomicBool>,
    news: Receiver<News>,
    /// Its pictures.
    pub(crate) of: usize,
    /// The picture that is traced, from 1; 0 before the first.
    pub(crate) at: usize,
}

/// News of a sheet in the making.
#[derive(Debug, PartialEq)]
pub(crate) enum News {
    /// Another picture is traced: its number from 1, and what it is.
    At(usize, String),
    /// The end: the place of the sheet, or why there is none.
    End(Result<String, String>),
}

impl MakingSheet {
    /// Begins; repaints whenever there are news.
    pub(crate) fn start(ctx: &Context, job: SheetJob) -> Result<MakingSheet, String> {
        let (send, news) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let (of, stopped, ctx) = (job.sheet.len(), stop.clone(), ctx.clone());
        std::thread::Builder::new()
            .name("sheet".to_owned())
            .spawn(move || {
                let end = job.run(&stopped, &send, &ctx);
                // Nobody listens when the window has been closed.
                let _ = send.send(News::End(end.map_err(|why| format!("no contact sheet: {why}"))));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("no contact sheet: could not start a thread for it: {e}"))?;
        Ok(MakingSheet { stop, news, of, at: 0 })
    }

    /// The next news, if there are any.
    pub(crate) fn poll(&mut self) -> Option<News> {
        let news = match self.news.try_recv() {
            Ok(news) => news,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {
                let why = "no contact sheet: making it ended in a fault of burnish";
                News::End(Err(why.to_owned()))
            }
        };
        if let News::At(number, _) = news {
            self.at = number;
        }
        Some(news)
    }

    /// Has it end soon; the end is among the news.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Drop for MakingSheet {
    fn drop(&mut self) {
        self.stop();
    }
}

impl SheetJob {
    fn run(&self, stop: &AtomicBool, news: &Sender<News>, ctx: &Context) -> Result<String, String> {
        let mut begun = 0;
        let watch = |SheetProgress { cell, .. }: SheetProgress| {
            if begun <= cell {
                begun = cell + 1;
                let _ = news.send(News::At(begun, self.sheet.title(cell)));
                ctx.request_repaint();
            }
            !stop.load(Ordering::Relaxed)
        };
        let traced = self.sheet.trace(self.threads, watch).map_err(|e| e.to_string())?;
        if stop.load(Ordering::Relaxed) {
            return Ok("Contact sheet stopped: nothing is written".to_owned());
        }
        let [png, exr] = free_names(&self.folder, &self.stem)
            .ok_or_else(|| format!("{} is full of them", self.folder.display()))?;
        for path in [&png, &exr] {
            traced.save(path, self.tone).map_err(|e| e.to_string())?;
        }
        let reached = traced.cells.iter().flatten().filter(|cell| cell.reached).count();
        let of = self.sheet.len();
        let short = match of - reached {
            0 => String::new(),
            n => format!("; {n} have not the error after {} passes", self.sheet.most_passes),
        };
        Ok(format!("Wrote {} and .exr ({of} pictures{short})", png.display()))
    }
}
