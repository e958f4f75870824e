//! The table on the terminal, and what its columns mean.

use super::measured::Measured;
use crate::cli::numbers::significant;
use crate::cli::values;
use burnish::measure::error::{
    ALL, MSE, MSE_TRIMMED, REFERENCE_NOISE, REL_MSE, REL_MSE_TRIMMED, REL_RMSE, SCALE_FREE, SMAPE,
};
use burnish::measure::flip;
use burnish::measure::speed::{Checkpoint, Fit, Spread, Summary};
use std::fmt::Write;

/// The last checkpoint of every variant: what it cost, how wrong it is.
pub(super) fn of(measured: &Measured) -> String {
    let Measured { scene, plan, truth, summaries, peak_mib, .. } = measured;
    let [width, height] = plan.base.size;
    let threads = values::worker_count(plan.threads);
    let mut text = format!(
        "{scene}, {width}x{height}, {threads} worker threads; medians of {} repeats, in brackets \
         the lowest and highest\nreference: {truth}",
        plan.repeats
    );
    if let Some(peak) = peak_mib {
        let _ = write!(text, "; peak memory of the program {peak:.0} MiB");
    }
    let known = summaries.iter().filter_map(|s| Some((s, s.checkpoints.last()?)));
    let rows: Vec<(&Summary, &Checkpoint)> = known.collect();
    let mut cost = Table::new(&[
        "",
        "passes",
        "seconds",
        "M rays/s",
        "relMSE",
        "rel. RMSE",
        "efficiency",
        "slope",
    ]);
    let mut other = Table::new(&[
        "",
        "MSE",
        "of 99.9 %",
        "relMSE of 99.9 %",
        "scale-free MSE",
        "SMAPE",
        "mean error",
        "FLIP",
        "HDR-FLIP",
    ]);
    for (summary, at) in rows {
        cost.row([
            summary.variant.title(),
            at.passes.to_string(),
            spread(at.seconds, |s| format!("{s:.3}")),
            format!("{:.2}", at.rays.median / at.seconds.median / 1e6),
            spread(at.error(REL_MSE), short),
            percent(at.error(REL_RMSE).median),
            spread(at.efficiency, short),
            slope(summary.slope),
        ]);
        let (mean, margin) = summary.mean_error;
        let margin = margin.map_or("?".into(), |m| format!("{:.3}", 100.0 * m));
        other.row([
            summary.variant.title(),
            short(at.error(MSE).median),
            short(at.error(MSE_TRIMMED).median),
            short(at.error(REL_MSE_TRIMMED).median),
            short(at.error(SCALE_FREE).median),
            short(at.error(SMAPE).median),
            format!("{:+.3} +- {margin} %", 100.0 * mean),
            short(summary.flip[0].median),
            short(summary.flip[1].median),
        ]);
    }
    let noise = rows_of_noise(summaries);
    format!("{text}{noise}\n\n{cost}\n{other}")
}

/// The share of the reference in each model's error.
fn rows_of_noise(summaries: &[Summary]) -> String {
    let mut text = String::new();
    let mut told = Vec::new();
    for summary in summaries {
        let model = summary.variant.model;
        let noise = summary.checkpoints.last().map(|c| c.error(REFERENCE_NOISE).median);
        if let Some(noise) = noise.filter(|n| *n > 0.0)
            && !told.contains(&model)
        {
            let start = if told.is_empty() { "\nits own relMSE, subtracted below:" } else { "," };
            let _ = write!(text, "{start} {} {}", model.title(), short(noise));
            told.push(model);
        }
    }
    text
}

/// What the columns are.
pub(super) fn legend() -> String {
    let mut text = String::from(
        "x picture, r reference, s standard error of r where it is known; means over pixels and \
         channels\n",
    );
    let mut line = |name: &str, formula: &str| {
        let _ = writeln!(text, "  {name:<22} {formula}");
    };
    for measure in ALL {
        line(measure.name, measure.formula);
    }
    line("FLIP", flip::FORMULA);
    line("HDR-FLIP", flip::HDR_FORMULA);
    line("efficiency", "1 / (relMSE seconds), in 1/s");
    line(
        "slope",
        "of ln relative RMSE over ln passes, mean of the repeats' fits +- its standard error",
    );
    line("mean error", "of the mean of all repeats, +- the 95 % Student interval of their spread");
    line("seconds", "of tracing alone; the repeats have seeds of their own");
    line("engine", "many paths at a time; all others by the reference tracer, one path at a time");
    text.trim_end().to_owned()
}

fn spread(s: Spread, show: impl Fn(f64) -> String) -> String {
    format!("{} ({}..{})", show(s.median), show(s.min), show(s.max))
}

fn slope(fit: Option<Fit>) -> String {
    match fit {
        None => "-".into(),
        Some(Fit { slope, standard_error: e }) if e.is_nan() => format!("{slope:.2}"),
        Some(Fit { slope, standard_error }) => format!("{slope:.2} +- {standard_error:.2}"),
    }
}

fn percent(value: f64) -> String {
    if value.is_nan() { "-".into() } else { format!("{:.2} %", 100.0 * value) }
}

fn short(value: f64) -> String {
    significant(value, 3)
}

/// Text in columns: the first to the left, numbers to the right.
pub(super) struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn new(header: &[&str]) -> Table {
        Table { rows: vec![header.iter().map(|h| h.to_string()).collect()] }
    }

    pub(super) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for row in &self.rows {
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                match column {
                    0 => write!(f, "{cell:<width$}")?,
                    _ => write!(f, "   {cell:>width$}")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
