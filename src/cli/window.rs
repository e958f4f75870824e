//! No subcommand: the window.

use super::Failure;
use std::path::{Path, PathBuf};

/// Opens the window and stays until it is closed.
pub(super) fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    // A missing file is the more useful message where there is no display either.
    if let Some(path) = scene.as_deref().filter(|path| !path.exists()) {
        return Err(Failure::new(format_args!("{}: there is no such file", path.display())));
    }
    let instead = headless(scene.as_deref());
    run(scene).map_err(|why| {
        let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
        Failure::new(format_args!("no window ({why}); to render without one: {instead}"))
    })
}

#[cfg(feature = "viewer")]
fn run(scene: Option<PathBuf>) -> Result<(), String> {
    crate::viewer::run(scene)
}

#[cfg(not(feature = "viewer"))]
fn run(_: Option<PathBuf>) -> Result<(), String> {
    Err("this burnish was built without the feature `viewer`".into())
}

/// The command that does without.
fn headless(scene: Option<&Path>) -> String {
    let scene = scene.map(|path| format!("{} ", path.display())).unwrap_or_default();
    format!("burnish render {scene}-o picture.png")
}
