//! No subcommand: the window.

use super::{Failure, talk, values};
use burnish::plain;
use std::path::{Path, PathBuf};

/// How the window opens; the default is that nothing was given.
#[derive(Debug, Default, PartialEq, clap::Args)]
pub(super) struct Args {
    /// Scene to open: a .scn, .obj or .ply file, or the name of a shipped scene, such as gallery. The
    /// built-in scene without one.
    scene: Option<PathBuf>,
    /// Worker threads; 0 is one a core.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    /// Width and height of the window in points.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Light colours instead of the system's.
    #[arg(long, conflicts_with = "dark")]
    light: bool,
    /// Dark colours instead of the system's.
    #[arg(long)]
    dark: bool,
    /// Forgets what the window remembers of its last time: colours, exposure, goal, recent scenes,
    /// size and place.
    #[arg(long)]
    reset_settings: bool,
    /// Seconds after which it closes: for smoke tests.
    #[arg(long, value_name = "SECONDS", hide = true, value_parser = values::seconds)]
    exit_after: Option<f64>,
    /// Writes a picture of the window, as PNG, before it closes.
    #[arg(long, value_name = "FILE", hide = true, requires = "exit_after")]
    screenshot: Option<PathBuf>,
}

/// Opens the window and stays until it is closed.
pub(super) fn open(args: Args) -> Result<(), Failure> {
    // A missing file is the more useful message where there is no display either.
    if let Some(path) = args.scene.as_deref().filter(|path| !super::scene::is_there(path)) {
        return Err(Failure::new(format_args!(
            "{}: there is no such file, and no shipped scene of that name",
            plain::path(path)
        )));
    }
    let instead = headless(args.scene.as_deref());
    let times = run(args).map_err(|why| {
        let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
        Failure::new(format_args!("no window: {why}; to render without one: {instead}"))
    })?;
    if let Some(times) = times {
        talk::detail(times);
    }
    Ok(())
}

#[cfg(feature = "viewer")]
fn run(args: Args) -> Result<Option<String>, String> {
    crate::viewer::run(crate::viewer::Options {
        scene: args.scene,
        threads: args.threads,
        reset_settings: args.reset_settings,
        size: args.size,
        light: (args.light || args.dark).then_some(args.light),
        measure: talk::loud(talk::Volume::Verbose),
        exit_after: args.exit_after,
        screenshot: args.screenshot,
    })
}

#[cfg(not(feature = "viewer"))]
fn run(_: Args) -> Result<Option<String>, String> {
    Err("this burnish was built without the feature `viewer`".into())
}

/// The command that does without.
fn headless(scene: Option<&Path>) -> String {
    let scene = scene.map(|path| format!("{} ", plain::path(path))).unwrap_or_default();
    format!("burnish render {scene}-o picture.png")
}
