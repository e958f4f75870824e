//! `--csv`: every checkpoint of every repeat, a row each.

use super::measured::Measured;
use crate::cli::{Failure, values};
use burnish::measure::error::{ALL, Measure};
use burnish::picture::replace_file;
use std::io;
use std::path::Path;

/// Columns before and after those of the measures. FLIP is known in the last row of a curve alone;
/// the memory is that of the whole program when the scene was done.
const BEFORE: [&str; 14] = [
    "scene",
    "width",
    "height",
    "threads",
    "reference",
    "model",
    "strategy",
    "normals",
    "tracer",
    "repeat",
    "seed",
    "passes",
    "seconds",
    "rays",
];
const AFTER: [&str; 5] = ["efficiency", "flip", "hdr_flip", "nonfinite", "peak_mib"];

/// Writes the table of all scenes.
pub(super) fn write(path: &Path, all: &[Measured]) -> Result<(), Failure> {
    replace_file(path, |sink| {
        let mut table = csv::Writer::from_writer(sink);
        let measures = ALL.iter().map(|m: &Measure| m.column);
        table.write_record(BEFORE.into_iter().chain(measures).chain(AFTER))?;
        for measured in all {
            rows(measured, &mut table)?;
        }
        table.flush()
    })
    .map_err(Failure::new)
}

fn rows<W: io::Write>(measured: &Measured, table: &mut csv::Writer<W>) -> io::Result<()> {
    let Measured { scene, plan, truth, experiment, peak_mib, .. } = measured;
    let [width, height] = plan.base.size;
    for run in &experiment.runs {
        for (index, point) in run.points.iter().enumerate() {
            let last = index + 1 == run.points.len();
            let flip = run.flip.map(|f| f.filter(|_| last).map_or(String::new(), number));
            let before = [
                scene.clone(),
                width.to_string(),
                height.to_string(),
                values::worker_count(plan.threads).to_string(),
                truth.clone(),
                run.variant.model.name().into(),
                run.variant.strategy.name().into(),
                run.variant.normals.name().into(),
                if run.variant.engine { "engine" } else { "reference" }.into(),
                run.repeat.to_string(),
                run.seed.to_string(),
                point.passes.to_string(),
                number(point.seconds),
                point.rays.to_string(),
            ];
            let [flip, hdr_flip] = flip;
            let after = [
                number(point.efficiency()),
                flip,
                hdr_flip,
                point.nonfinite.to_string(),
                peak_mib.map_or(String::new(), |m| format!("{m:.1}")),
            ];
            table.write_record(before.into_iter().chain(point.errors.map(number)).chain(after))?;
        }
    }
    Ok(())
}

/// With all its digits; empty for what is not a number.
fn number(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:e}") }
}
