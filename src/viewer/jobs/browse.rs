//! The desktop's own file dialog, on a thread of its own.

use egui::Context;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Result of a dialog.
#[derive(Debug)]
pub(crate) enum Picked {
    File(PathBuf),
    /// It was closed.
    Nothing,
    /// There is none to be had here.
    NoDialog,
}

/// Asks for a scene's file, beginning in a folder. Returns when the dialog is closed.
pub(crate) type Dialog = fn(Option<&Path>) -> Picked;

/// A dialog that is open.
pub(crate) struct Browsing {
    result: Receiver<Picked>,
}

impl Browsing {
    /// Opens one; repaints when it is closed.
    pub(crate) fn start(
        ctx: &Context,
        dialog: Dialog,
        folder: Option<PathBuf>,
    ) -> Result<Browsing, String> {
        let (send, result) = channel();
        let ctx = ctx.clone();
        std::thread::Builder::new()
            .name("file dialog".to_owned())
            .spawn(move || {
                // Nobody listens any more when the window is gone.
                let _ = send.send(dialog(folder.as_deref()));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("no file dialog: could not start a thread for it: {e}"))?;
        Ok(Browsing { result })
    }

    /// The result; `None` while the dialog is open.
    pub(crate) fn poll(&self) -> Option<Picked> {
        match self.result.try_recv() {
            Ok(picked) => Some(picked),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Picked::NoDialog),
        }
    }
}

/// The dialog of the system that this runs on.
pub(crate) fn native(folder: Option<&Path>) -> Picked {
    listen();
    let mut dialog = rfd::FileDialog::new()
        .set_title("Open a scene or a picture")
        .add_filter("Scenes and pictures", &["scn", "obj", "ply", "exr"])
        .add_filter("All files", &["*"]);
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    match (dialog.pick_file(), HEARD.take()) {
        (Some(path), _) => Picked::File(path),
        // It says the same of a dialog that was closed and of one that never came, but complains of
        // the latter.
        (None, Some(why)) if why.starts_with("Failed to pick") => Picked::NoDialog,
        (None, _) => Picked::Nothing,
    }
}

thread_local! {
    /// The last that rfd complained of.
    static HEARD: RefCell<Option<String>> = const { RefCell::new(None) };
}

struct Ears;

impl log::Log for Ears {
    fn enabled(&self, about: &log::Metadata) -> bool {
        about.level() == log::Level::Error && about.target().starts_with("rfd")
    }
    fn log(&self, record: &log::Record) {
        if self.enabled(record.metadata()) {
            HEARD.set(Some(record.args().to_string()));
        }
    }
    fn flush(&self) {}
}

fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Refused only where another listens already: then a missing dialog is one that was closed.
        if log::set_logger(&Ears).is_ok() {
            log::set_max_level(log::LevelFilter::Error);
        }
    });
    HEARD.take();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_complained_of_is_heard_by_the_thread_that_asked() {
        listen();
        log::error!(target: "rfd::backend", "Failed to pick file with zenity: no such file");
        log::error!(target: "another", "something else");
        std::thread::spawn(|| log::error!(target: "rfd", "not ours")).join().unwrap();
        assert_eq!(HEARD.take().unwrap(), "Failed to pick file with zenity: no such file");
    }
}
