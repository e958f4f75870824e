//! The scene that the command line names, read and built.

use super::{Failure, say};
use burnish::scene::builtin::{Example, default_scene};
use burnish::scene::{Camera, Report, Scene, SceneBuilder};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// A scene and how long it took.
pub(super) struct Loaded {
    pub(super) scene: Arc<Scene>,
    /// Seconds from the file's first byte to its shapes.
    pub(super) load_s: f64,
    /// Seconds for recentring them and building the tree.
    pub(super) build_s: f64,
}

/// Reads and builds the file, or the shipped scene of that name; the default scene without either.
/// The reader's remarks go to stderr.
pub(super) fn load(path: Option<&Path>) -> Result<Loaded, Failure> {
    let start = Instant::now();
    let (builder, report) = read(path)?;
    let load_s = start.elapsed().as_secs_f64();
    for warning in &report.warnings {
        say(format_args!("warning: {warning}"));
    }
    for note in &report.notes {
        say(format_args!("note: {note}"));
    }
    let start = Instant::now();
    let scene = Arc::new(builder.build());
    Ok(Loaded { scene, load_s, build_s: start.elapsed().as_secs_f64() })
}

/// Reads the same without building it; the remarks are the caller's.
pub(super) fn read(path: Option<&Path>) -> Result<(SceneBuilder, Report), Failure> {
    let Some(path) = path else { return default_scene().map_err(Failure::new) };
    // A file of that name comes first.
    match path.to_str().and_then(Example::named).filter(|_| !path.exists()) {
        Some(example) => example.read().map_err(Failure::new),
        None => burnish::scene::read::open(path).map_err(Failure::new),
    }
}

/// The text after the keyword `camera` of a `.scn` file.
pub(super) fn camera(text: &str) -> Result<Camera, String> {
    burnish::scene::read::parse_camera(text)
}
