//! `burnish report`: figures about the program itself. One file a kind of figure.

mod errata;
mod latency;
mod profile;
mod rays;
mod scaling;
mod sheet;
mod speed;
mod table;

use super::{Failure, values};
use clap::builder::TypedValueParser;
use std::path::{Path, PathBuf};

/// Measures this program on this machine: how the error falls with time, with --latency how soon a
/// change is seen, with --errata what each mistake on purpose does to the picture, with --rays what
/// rays cost, with --scaling how the time grows with what is rendered, with --profile where it goes.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish report table.scn --plot table.svg --csv table.csv
  burnish report --model ggx --strategy mis,bsdf --passes 256 --size 640x480
  burnish report furnace.scn --exact 1 --seconds 5
  burnish report --latency table.scn --size 1600x1200 --changes 200
  burnish report --errata --passes 256 --repeats 8
  burnish report --rays table.scn
  burnish report --scaling --largest 100000
  burnish report --profile table.scn --passes 16")]
pub(super) struct Args {
    /// Scenes to render: .scn, .obj or .ply files, or names of shipped ones. The built-in scene
    /// without one.
    scenes: Vec<PathBuf>,
    /// Measures the time from a change of roughness to the tone-mapped picture that shows it.
    #[arg(long)]
    latency: bool,
    /// Measures what each erratum does: the same passes with it and without, and the difference. Takes
    /// --size, --passes, --repeats, --seed and --threads.
    #[arg(long, conflicts_with_all = ["latency", "changes", "model", "strategy", "normals",
          "seconds", "reference_passes", "reference", "exact", "csv", "plot"])]
    errata: bool,
    /// Measures rays a second on one thread: from the camera, scattered, towards lights. Takes --size,
    /// --count, --repeats and --seed.
    #[arg(long, conflicts_with_all = ["latency", "changes", "errata", "scaling", "model",
          "strategy", "normals", "passes", "seconds", "reference_passes", "reference", "exact",
          "csv", "plot", "threads"])]
    rays: bool,
    /// How many rays of each kind.
    #[arg(long, value_name = "N", default_value_t = 1 << 18, requires = "rays",
          value_parser = clap::value_parser!(u64).range(1..=1 << 26).map(|n| n as usize))]
    count: usize,
    /// Measures the time of a path against the number of triangles, lights, pixels and threads, in
    /// scenes made for it, and how it grows. Takes --largest, --repeats, --seed and --threads.
    #[arg(long, conflicts_with_all = ["latency", "changes", "errata", "rays", "model", "strategy",
          "normals", "passes", "seconds", "reference_passes", "reference", "exact", "csv", "plot",
          "size", "scenes"])]
    scaling: bool,
    /// Measures where the engine's time goes: by stage, rays by kind, lanes in use. Takes --size,
    /// --passes and --seed.
    #[arg(long, conflicts_with_all = ["latency", "changes", "errata", "rays", "scaling", "model",
          "strategy", "normals", "seconds", "reference_passes", "reference", "exact", "csv", "plot",
          "repeats", "threads"])]
    profile: bool,
    /// Most triangles; lights go up to a thousandth of it, pixels to a fifth. 100000 takes seconds,
    /// 10000000 minutes and 4 GB of memory.
    #[arg(long, value_name = "N", default_value_t = 10_000_000, requires = "scaling",
          value_parser = clap::value_parser!(u32).range(1000..=100_000_000))]
    largest: u32,
    /// How many changes.
    #[arg(long, value_name = "N", default_value_t = 200, requires = "latency",
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    changes: u32,
    /// Width and height in pixels; 320x240, with --latency 1600x1200 without it.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Worker threads; 0 is one a core.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    #[command(flatten)]
    speed: speed::Args,
}

/// Measures and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    match args {
        Args { latency: true, .. } => latency::run(args),
        Args { errata: true, .. } => errata::run(args),
        Args { rays: true, .. } => rays::run(args),
        Args { scaling: true, .. } => scaling::run(args),
        Args { profile: true, .. } => profile::run(args),
        _ => speed::run(args),
    }
}

impl Args {
    /// The scenes to measure; `None` is the built-in one.
    fn scenes(&self) -> Vec<Option<&Path>> {
        match &self.scenes[..] {
            [] => vec![None],
            scenes => scenes.iter().map(|path| Some(path.as_path())).collect(),
        }
    }
}
