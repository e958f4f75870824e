//! `burnish report`: figures about the program itself. One file a kind of figure.

mod latency;

use super::{Failure, values};
use std::path::PathBuf;

/// Measures this program on this machine.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish report --latency
  burnish report --latency table.scn --size 1600x1200 --changes 200")]
pub(super) struct Args {
    /// From a change of roughness to the tone-mapped picture that shows it.
    #[arg(long, required = true)]
    latency: bool,
    /// Scene to render: a .scn, .obj or .ply file. The built-in scene without one.
    scene: Option<PathBuf>,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = values::size)]
    size: [u32; 2],
    /// How many changes.
    #[arg(long, value_name = "N", default_value_t = 200,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    changes: u32,
    /// Worker threads; 0 is one a core.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
}

/// Measures and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    latency::run(args)
}
