//! `burnish report --rays`: what rays cost, by kind.

use super::Args;
use super::table::Table;
use crate::cli::{Failure, print, scene};
use burnish::measure::rays::{RayBench, TOGETHER};
use burnish::measure::speed::Spread;
use std::path::Path;

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes().into_iter().try_for_each(|path| measure(args, path))
}

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let scene = scene::load(path)?.scene;
    let bench = RayBench {
        rays: args.count,
        size: args.size.unwrap_or([640, 480]),
        repeats: args.speed.repeats,
        seed: args.speed.seed,
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
        scene.bvh().isa().name(),
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
