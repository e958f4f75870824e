//! Reading and building a scene in the background, so that the window never waits.

use crate::viewer::jobs::watch::Stamp;
use burnish::scene::builtin::{EXAMPLES, Example};
use burnish::scene::read::{self, Disk, Files, ReadOptions};
use burnish::scene::{Axis, Report, Scene};
use egui::Context;
use std::borrow::Cow;
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// The place a scene is read from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
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
    /// A file, or the scene that comes with burnish by that name. A file of that name comes first.
    pub(crate) fn named(path: PathBuf) -> Source {
        match path.to_str().and_then(Example::named).filter(|_| !path.exists()) {
            Some(example) => Source::Example(example),
            None => Source::File(path),
        }
    }

    /// The file itself, if it is one.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Source::Example(_) => None,
            Source::File(path) => Some(path),
        }
    }

    fn name(&self) -> String {
        match self {
            Source::Example(example) => example.title.to_owned(),
            Source::File(path) => path.display().to_string(),
        }
    }
}

/// A scene ready to be rendered.
pub(crate) struct Loaded {
    pub(crate) scene: Arc<Scene>,
    pub(crate) report: Report,
    /// The place it was read from.
    pub(crate) source: Source,
    /// It is to be seen from where the one before was seen, if that came from the same place.
    pub(crate) again: bool,
    /// Its files as they were, and the places where others would be that it names.
    pub(crate) files: Vec<Stamp>,
}

/// A scene that could not be had.
pub(crate) struct Failed {
    pub(crate) why: String,
    pub(crate) source: Source,
    /// Its own file and those that it names, as they were, there or not.
    pub(crate) files: Vec<Stamp>,
}

/// A scene on its way.
pub(crate) struct Loading {
    /// For the line that says so.
    pub(crate) name: String,
    source: Source,
    result: Receiver<Result<Loaded, Failed>>,
}

impl Loading {
    /// Starts to read a scene, or to read it `again`; repaints once the result is there. A model by
    /// itself is stood on the axis opposite to `up`, or as it is guessed.
    pub(crate) fn start(
        ctx: &Context,
        source: Source,
        again: bool,
        up: Option<Axis>,
    ) -> Result<Loading, String> {
        let name = source.name();
        let (send, result) = channel();
        let ctx = ctx.clone();
        let wanted = source.clone();
        std::thread::Builder::new()
            .name("scene".to_owned())
            .spawn(move || {
                // Nobody listens any more when another scene has been opened meanwhile.
                let _ = send.send(build(wanted, again, up));
                drop(send);
                ctx.request_repaint();
            })
            .map_err(|e| format!("{name}: could not start a thread to read it: {e}"))?;
        Ok(Loading { name, source, result })
    }

    /// The scene or why there is none; `None` while it is on its way.
    pub(crate) fn poll(&self) -> Option<Result<Loaded, Failed>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(Failed {
                why: format!(
                    "{}: reading it ended in a fault of burnish; please report it with the file",
                    self.name
                ),
                source: self.source.clone(),
                files: Vec::new(),
            })),
        }
    }
}

/// Reads it here and now.
pub(crate) fn build(source: Source, again: bool, up: Option<Axis>) -> Result<Loaded, Failed> {
    let (read, files) = match &source {
        Source::Example(example) => (example.read(), Vec::new()),
        Source::File(path) => {
            // Before it is read: what is written meanwhile is a change.
            let own = Stamp::of(path);
            let files = Watched { disk: Disk::beside(path), stamps: RefCell::new(vec![own]) };
            let options = ReadOptions { up, ..ReadOptions::default() };
            (read::open_with_options(path, &files, options), files.stamps.into_inner())
        }
    };
    match read {
        Ok((builder, mut report)) => match builder.try_build() {
            Ok(scene) => {
                let scene = Arc::new(scene);
                scene.report(&mut report);
                Ok(Loaded { scene, report, source, again, files })
            }
            Err(e) => Err(Failed { why: e.to_string(), source, files }),
        },
        Err(e) => Err(Failed { why: e.to_string(), source, files }),
    }
}

/// Files on disk; every place that is looked at is remembered, whether a file is there or not.
struct Watched {
    disk: Disk,
    stamps: RefCell<Vec<Stamp>>,
}

impl Watched {
    fn note(&self, place: &Path) {
        let mut stamps = self.stamps.borrow_mut();
        if !stamps.iter().any(|stamp| stamp.is_of(place)) {
            stamps.push(Stamp::of(place));
        }
    }
}

impl Files for Watched {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), io::Error> {
        self.disk.places(name).iter().for_each(|place| self.note(place));
        let found = self.disk.find(name)?;
        // It may be found elsewhere after all.
        self.note(&found.0);
        Ok(found)
    }
}
