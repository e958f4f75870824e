//! `burnish report rays`: what rays cost, by kind.

use super::table::Table;
use super::{Repeats, Scenes};
use crate::cli::{Failure, print, scene, values};
use burnish::measure::rays::{RayBench, TOGETHER};
use burnish::measure::speed::Spread;
use std::path::Path;

/// Measures rays a second on one thread: from the camera, scattered, towards lights.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report rays table.scn
  burnish report rays cornell --count 1000000")]
pub(super) struct Args {
    #[command(flatten)]
    scenes: Scenes,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = values::size)]
    size: [u32; 2],
    /// How many rays of each kind.
    #[arg(long, value_name = "N", default_value_t = 1 << 18,
          value_parser = clap::value_parser!(u64).range(1..=1 << 26))]
    count: u64,
    #[command(flatten)]
    repeats: Repeats,
}

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes.each().try_for_each(|path| measure(args, path))
}

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let scene = scene::load(path)?.scene;
    let bench = RayBench {
        rays: args.count as usize,
        size: args.size,
        repeats: args.repeats.repeats,
        seed: args.repeats.seed,
    };
    let together = format!("{TOGETHER} together");
    let mut table = Table::new(&["M rays/s", "rays", "hits", "one by one", &together]);
    for rate in bench.run(&scene) {
        table.row([
            rate.kind.name().into(),
            rate.rays.to_string(),
            format!("{:.1} %", 100.0 * rate.hits),
            millions(rate.alone),
            millions(rate.together),
        ]);
    }
    let counts = scene.counts();
    let [tree, shapes] = [scene.bvh().bytes(), scene.geometry().bytes()];
    let each = scene.geometry().len().max(1);
    let per = |bytes: usize| bytes as f64 / each as f64;
    print(format_args!(
        "{}, {} triangles, {} spheres, {} cylinders; {}, one thread; medians of {} repeats, in \
         brackets the lowest and highest\n{:.1} bytes a shape: {:.1} tree, {:.1} positions, \
         normals, indices, materials\n\n{table}",
        scene.name(),
        counts.triangles,
        counts.spheres,
        counts.cylinders,
        scene.isa().name(),
        bench.repeats,
        per(tree + shapes),
        per(tree),
        per(shapes),
    ))?;
    print(LEGEND)
}

const LEGEND: &str = "camera  nearest hit, in the order of the pixels
bounce  nearest hit, from what those meet, diffusely, shuffled
shadow  any hit, from there to points on lights, shuffled; without lights as bounce";

fn millions(rate: Spread) -> String {
    if rate.median.is_nan() {
        return "-".into();
    }
    let [median, min, max] = [rate.median, rate.min, rate.max].map(|r| r / 1e6);
    format!("{median:.2} ({min:.2}..{max:.2})")
}
