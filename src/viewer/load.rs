//! Reading and building a scene in the background, so that the window never waits.

use burnish::scene::builtin::{EXAMPLES, Example};
use burnish::scene::{Report, Scene, read};
use egui::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    /// One that comes with burnish.
    Example(&'static Example),
    File(PathBuf),
}

impl Default for Source {
    fn default() -> Source {
        Source::Example(&EXAMPLES[0])
    }
}

impl Source {
    fn name(&self) -> String {
        match self {
            Source::Example(example) => example.title.to_owned(),
            Source::File(path) => path.display().to_string(),
        }
    }
}

/// A scene ready to be rendered.
pub(super) struct Loaded {
    pub(super) scene: Arc<Scene>,
    pub(super) report: Report,
    /// Where it was read.
    pub(super) source: Source,
    /// It is to be seen from where the one before was seen, if that came from the same place.
    pub(super) again: bool,
}

/// A scene on its way.
pub(super) struct Loading {
    /// For the line that says so.
    pub(super) name: String,
    result: Receiver<Result<Loaded, String>>,
}

impl Loading {
    /// Starts to read a scene, or to read it `again`; repaints once the result is there.
    pub(super) fn start(ctx: &Context, source: Source, again: bool) -> Result<Loading, String> {
        let name = source.name();
        let (send, result) = channel();
        let ctx = ctx.clone();
        std::thread::Builder::new()
            .name("scene".to_owned())
            .spawn(move || {
                // Nobody listens any more when another scene has been opened meanwhile.
                let _ = send.send(build(source, again));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("{name}: could not start a thread to read it: {e}"))?;
        Ok(Loading { name, result })
    }

    /// The scene or why there is none; `None` while it is on its way.
    pub(super) fn poll(&self) -> Option<Result<Loaded, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(format!(
                "{}: reading it ended in a fault of burnish; please report it with the file",
                self.name
            ))),
        }
    }
}

fn build(source: Source, again: bool) -> Result<Loaded, String> {
    let read = match &source {
        Source::Example(example) => example.read(),
        Source::File(path) => read::open(path),
    };
    let (builder, report) = read.map_err(|e| e.to_string())?;
    Ok(Loaded { scene: Arc::new(builder.build()), report, source, again })
}
