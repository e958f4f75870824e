//! The curves for a file.

use super::Row;
use crate::viewer::document::errors::{History, name};
use burnish::brdf::Model;
use burnish::measure::plot::{Dot, Panel, PlotCurve};
use burnish::progressive::Params;

/// Colours tell models apart, marks materials and methods, dashes the true error from the estimated.
pub(super) fn panel(rows: &[Row], shown: &Params) -> Panel {
    let [width, height] = shown.size;
    let mut curves = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let Some(curve) = row.curve else { continue };
        let name = name(&row.params, shown);
        let mark = if row.is_like(shown) { 0 } else { 1 + i.saturating_sub(Model::ALL.len()) };
        let colour = Model::ALL.iter().position(|m| *m == row.params.model).unwrap_or(0);
        for (history, dashed) in [(&curve.estimated, false), (&curve.truth, true)] {
            let dots = dots(history);
            if !dots.is_empty() {
                let label = if dashed { format!("{name}, true") } else { name.clone() };
                curves.push(PlotCurve { label, colour, mark, last_only: true, dashed, dots });
            }
        }
    }
    Panel {
        title: format!("{}, {width}x{height}", shown.scene.name()),
        x: "seconds of tracing".into(),
        y: "relative error in %".into(),
        upright: ["upright: 95 % limits", "of the newest estimate"],
        curves,
    }
}

fn dots(history: &History) -> Vec<Dot> {
    let dot = |p: &crate::viewer::document::errors::Point| Dot {
        x: p.seconds,
        y: 100.0 * p.error,
        range: [100.0 * p.limits.low, 100.0 * p.limits.high],
    };
    history.points().iter().map(dot).collect()
}
