//! Reading an OpenEXR picture in the background, to be compared with.

use crate::viewer::panels::compare::Frozen;
use crate::viewer::picture::frozen;
use burnish::picture::{read_exr_part, read_recipe};
use burnish::progressive::Recipe;
use egui::Context;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// A picture on its way.
pub(crate) struct ReadingPicture {
    path: PathBuf,
    result: Receiver<Result<Frozen, String>>,
}

impl ReadingPicture {
    /// Whether a file of this name is read as a picture.
    pub(crate) fn is_for(path: &Path) -> bool {
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
    }

    /// Starts to read; repaints once the result is there.
    pub(crate) fn start(ctx: &Context, path: PathBuf) -> Result<ReadingPicture, String> {
        let (send, result) = channel();
        let (ctx, wanted) = (ctx.clone(), path.clone());
        std::thread::Builder::new()
            .name("picture".to_owned())
            .spawn(move || {
                // Nobody listens any more when another picture has been opened meanwhile.
                let _ = send.send(read(&wanted));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("{}: could not start a thread to read it: {e}", path.display()))?;
        Ok(ReadingPicture { path, result })
    }

    /// The picture or why there is none; `None` while it is on its way.
    pub(crate) fn poll(&self) -> Option<Result<Frozen, String>> {
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

fn read(path: &Path) -> Result<Frozen, String> {
    let read = read_exr_part(path, None).map_err(|e| e.to_string())?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let recipe = read_recipe(path).ok().flatten();
    let resumable = recipe.as_ref().map(|_| path.to_path_buf());
    let noise = recipe.and_then(|text| Recipe::parse(&text).ok()?.error).map(|e| e.relative);
    Ok(Frozen { name, snapshot: frozen::snapshot(&read.picture), resumable, noise })
}
