//! `burnish report errata`: what each mistake does to the picture of a scene.

use super::table::Table;
use super::{Repeats, Scenes, Threads};
use crate::cli::numbers::significant;
use crate::cli::{Failure, print, say, scene, values};
use burnish::brdf::{Erratum, Model};
use burnish::measure::errata::{Bench, Effect};
use burnish::picture::Picture;
use burnish::progressive::{Params, Session};
use std::path::Path;

/// Measures what each mistake on purpose does: the same passes with it and without, and the difference.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report errata --passes 256 --repeats 8
  burnish report errata shell --size 160x120")]
pub(super) struct Args {
    #[command(flatten)]
    scenes: Scenes,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = values::size)]
    size: [u32; 2],
    /// Passes of each picture.
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: u64,
    #[command(flatten)]
    repeats: Repeats,
    #[command(flatten)]
    threads: Threads,
}

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes.each().try_for_each(|path| measure(args, path))?;
    print(LEGEND)
}

const LEGEND: &str = "x with the erratum, r without; means over pixels and channels
  change      mean(x) / mean(r) - 1, +- the 95 % Student interval of its spread over the pairs
  rel. RMSE   sqrt(mean((x - r)^2 / (r^2 + 0.01))) of the means over all pairs, noise subtracted
  noise       the root of what was subtracted
  noise of x  times that of r at the same passes, as a deviation relative to r";

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let loaded = scene::load(path)?;
    let params = Params::new(loaded.scene.clone());
    let (size, threads) = (args.size, args.threads.threads);
    let bench = Bench {
        base: Params { size, seed: args.repeats.seed, ..params },
        passes: args.passes,
        pairs: args.repeats.repeats,
        threads,
    };
    let mut table = Table::new(&["erratum", "model", "change", "rel. RMSE", "noise", "noise of x"]);
    let pictures = |model, erratum| bench.pictures(model, erratum).map_err(Failure::new);
    for model in Model::ALL {
        say(format_args!("{}: the right pictures", model.title()));
        let right: Vec<Picture> = pictures(model, None)?;
        for erratum in Erratum::ALL.into_iter().filter(|e| measured_with(*e, model)) {
            say(format_args!("{}: {}", model.title(), erratum.name()));
            let effect = Effect::between(&pictures(model, Some(erratum))?, &right);
            table.row(row(erratum, model, effect));
        }
    }
    let [width, height] = size;
    print(format_args!(
        "{}, {width}x{height}, {} pairs of pictures of {} passes, {} worker threads\n\n{table}",
        loaded.scene.name(),
        bench.pairs,
        bench.passes,
        values::worker_count(threads)
    ))
}

/// One model is enough for most: GGX where it does not matter. Of what is below the horizon GGX's
/// G and the rational one make different things.
fn measured_with(erratum: Erratum, model: Model) -> bool {
    let both = erratum == Erratum::BelowHorizon && model == Model::Beckmann;
    both || model == erratum.model().unwrap_or(Model::Ggx)
}

fn row(erratum: Erratum, model: Model, e: Effect) -> [String; 6] {
    let percent = |x: f64| format!("{} %", significant(100.0 * x, 3));
    let margin = e.margin.map_or("?".into(), |m| format!("{:.3}", 100.0 * m));
    [
        erratum.name().into(),
        model.title().into(),
        format!("{:+.3} +- {margin} %", 100.0 * e.change),
        percent(e.rel_rmse),
        percent(e.noise),
        format!("x {:.2}", e.noise_ratio),
    ]
}
