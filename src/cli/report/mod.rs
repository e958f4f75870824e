//! `burnish report`: figures about the program itself. One file a kind of figure.

mod errata;
mod latency;
mod measured;
mod profile;
mod rays;
mod scaling;
mod sheet;
mod speed;
mod table;

use super::{Failure, values};
use std::path::{Path, PathBuf};

/// Measures this program on this machine.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report speed table.scn --plot table.svg --csv table.csv
  burnish report latency table.scn --size 1600x1200 --changes 200
  burnish report errata --passes 256 --repeats 8")]
pub(super) struct Args {
    #[command(subcommand)]
    kind: Kind,
    #[command(flatten)]
    moved: Moved,
}

/// What is measured.
#[derive(Debug, clap::Subcommand)]
enum Kind {
    Speed(speed::Args),
    Latency(latency::Args),
    Errata(errata::Args),
    Rays(rays::Args),
    Scaling(scaling::Args),
    Profile(profile::Args),
}

/// Flags that have become commands.
#[derive(Debug, clap::Args)]
struct Moved {
    #[arg(long, hide = true, num_args = 0, default_missing_value = "latency", value_parser = moved)]
    latency: Option<String>,
    #[arg(long, hide = true, num_args = 0, default_missing_value = "errata", value_parser = moved)]
    errata: Option<String>,
    #[arg(long, hide = true, num_args = 0, default_missing_value = "rays", value_parser = moved)]
    rays: Option<String>,
    #[arg(long, hide = true, num_args = 0, default_missing_value = "scaling", value_parser = moved)]
    scaling: Option<String>,
    #[arg(long, hide = true, num_args = 0, default_missing_value = "profile", value_parser = moved)]
    profile: Option<String>,
}

fn moved(name: &str) -> Result<String, String> {
    Err(format!("it is a command of its own now: burnish report {name}"))
}

/// Measures and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    match &args.kind {
        Kind::Speed(args) => speed::run(args),
        Kind::Latency(args) => latency::run(args),
        Kind::Errata(args) => errata::run(args),
        Kind::Rays(args) => rays::run(args),
        Kind::Scaling(args) => scaling::run(args),
        Kind::Profile(args) => profile::run(args),
    }
}

/// Which scenes.
#[derive(Debug, clap::Args)]
struct Scenes {
    /// Scenes to render: .scn, .obj or .ply files, or names of shipped ones. The built-in scene
    /// without one.
    scenes: Vec<PathBuf>,
}

impl Scenes {
    /// The scenes to measure; `None` is the built-in one.
    fn each(&self) -> impl Iterator<Item = Option<&Path>> {
        let built_in = self.scenes.is_empty().then_some(None);
        built_in.into_iter().chain(self.scenes.iter().map(|path| Some(path.as_path())))
    }
}

/// By how many threads.
#[derive(Debug, clap::Args)]
struct Threads {
    /// Worker threads; 0 is one a core.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
}

/// How often, and with which random numbers.
#[derive(Debug, clap::Args)]
struct Repeats {
    /// How often everything is measured; medians of fewer than 5 tell little.
    #[arg(long, value_name = "R", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Seed of the first repeat; the others have the next ones.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
}
