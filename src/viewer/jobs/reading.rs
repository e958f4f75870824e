//! A file being read in the background, so that the window never waits.

use egui::Context;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// A file being read into a `T`.
pub(crate) struct Reading<T> {
    path: PathBuf,
    result: Receiver<Result<T, String>>,
}

impl<T: Send + 'static> Reading<T> {
    /// Starts to read by a thread of this name; repaints once the result is there.
    pub(crate) fn start(
        ctx: &Context,
        name: &str,
        path: PathBuf,
        read: impl FnOnce(&Path) -> Result<T, String> + Send + 'static,
    ) -> Result<Reading<T>, String> {
        let (send, result) = channel();
        let (ctx, wanted) = (ctx.clone(), path.clone());
        std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || {
                // Nobody listens any more when something else has been opened meanwhile.
                let _ = send.send(read(&wanted));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("{}: could not start a thread to read it: {e}", path.display()))?;
        Ok(Reading { path, result })
    }

    /// The `T` or why there is none; `None` while the file is being read.
    pub(crate) fn poll(&self) -> Option<Result<T, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(format!(
                "{}: reading it ended in a fault of burnish; please report it with the file",
                self.path.display()
            ))),
        }
    }
}
