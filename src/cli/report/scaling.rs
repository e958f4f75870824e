//! `burnish report scaling`: how the time of a path grows.

use super::table::Table;
use super::{Repeats, Threads};
use crate::cli::numbers::significant;
use crate::cli::{Failure, print, say, stats, values};
use burnish::measure::scaling::{Growth, Row, Scaling, ScalingError};
use burnish::measure::speed::Fit;

/// Measures the time of a path against the number of triangles, lights, pixels and threads, in scenes
/// made for it, and how it grows.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report scaling --largest 100000
  burnish report scaling --repeats 9")]
pub(super) struct Args {
    /// Most triangles; lights go up to a thousandth of it, pixels to a fifth. 100000 takes seconds,
    /// 10000000 minutes and 4 GB of memory.
    #[arg(long, value_name = "N", default_value_t = 10_000_000,
          value_parser = clap::value_parser!(u32).range(1000..=100_000_000))]
    largest: u32,
    #[command(flatten)]
    repeats: Repeats,
    #[command(flatten)]
    threads: Threads,
}

/// Measures and prints, table by table.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let scaling = Scaling {
        largest: args.largest,
        repeats: args.repeats.repeats,
        seed: args.repeats.seed,
        threads: args.threads.threads,
    };
    print(format_args!(
        "a ball with hills in a closed room, all diffuse; {} worker threads; medians of {} repeats, \
         in brackets the lowest and highest\n",
        values::worker_count(scaling.threads),
        scaling.repeats
    ))?;
    type Measure = fn(&Scaling) -> Result<Vec<Row>, ScalingError>;
    let tables: [(&str, Measure); 4] = [
        ("triangles", Scaling::triangles),
        ("lights", Scaling::lights),
        ("pixels", Scaling::pixels),
        ("threads", Scaling::threads),
    ];
    for (what, measure) in tables {
        say(format_args!("{what}"));
        let rows = measure(&scaling).map_err(Failure::new)?;
        print(table(what, &rows))?;
    }
    if let Some(peak) = stats::peak_mib() {
        print(format_args!("peak memory of the program {peak:.0} MiB"))?;
    }
    print(LEGEND)
}

const LEGEND: &str = "path         time of tracing over paths, all workers together
over log     path over what a law proportional to log n would give from the first row: at
             most 1 where the time grows at most with the logarithm
scene, tree  from shapes in memory to the scene, and the tree's part of it
bytes        of positions, normals, indices, materials and tree, for each triangle
power        p of the law n^p that fits best, +- its standard error
doubling     what each doubling of n adds, +- its standard error";

fn table(what: &str, rows: &[Row]) -> String {
    let last = match what {
        "threads" => vec!["speed-up"],
        "triangles" => vec!["over log", "scene s", "tree s", "bytes"],
        _ => vec![],
    };
    let header: Vec<&str> = [what, "path ns"].into_iter().chain(last).collect();
    let mut table = Table::new(&header);
    for row in rows {
        let [median, min, max] =
            [row.path.median, row.path.min, row.path.max].map(|t| significant(t, 3));
        let mut cells = vec![row.n.to_string(), format!("{median} ({min}..{max})")];
        let cost = row.scene;
        match what {
            "threads" => cells.push(format!("{:.2}", rows[0].path.median / row.path.median)),
            "triangles" => cells.extend([
                format!("{:.2}", row.over_logarithm(&rows[0])),
                significant(cost.build, 3),
                significant(cost.tree, 3),
                format!("{:.1}", cost.bytes),
            ]),
            _ => {}
        }
        table.row(cells);
    }
    let Growth { exponent, doubling } = Growth::of(rows);
    let fit = |fit: Option<Fit>, digits: usize| match fit {
        None => "-".into(),
        Some(Fit { slope, standard_error: e }) if !e.is_finite() => format!("{slope:+.digits$}"),
        Some(Fit { slope, standard_error: e }) => format!("{slope:+.digits$} +- {e:.digits$}"),
    };
    format!("{table}power {}, doubling {} ns\n", fit(exponent, 3), fit(doubling, 1))
}
