//! Curves as SVG: error over cost, both logarithmic, and a [BRDF over angle](lobe()).

mod lobe;

pub use lobe::{Style, lobe};

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// One coordinate system with its curves.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// What x is, with its unit.
    pub x: String,
    /// What y is, with its unit.
    pub y: String,
    /// What the thin upright lines are, in two lines of the legend.
    pub upright: [&'static str; 2],
    /// In the order of the legend.
    pub curves: Vec<PlotCurve>,
}

/// One line with its marks. Colour, mark and dashes each stand for one thing that curves differ in;
/// the numbers wrap around where there are more than can be told apart.
#[derive(Clone, Debug)]
pub struct PlotCurve {
    /// In the legend.
    pub label: String,
    /// Which of the colours.
    pub colour: usize,
    /// Which of the marks.
    pub mark: usize,
    /// Whether the last dot alone has a mark and an upright line: where there are hundreds.
    pub last_only: bool,
    /// Whether the line is broken.
    pub dashed: bool,
    /// In the order of x. Those with a coordinate that has no logarithm are left out.
    pub dots: Vec<Dot>,
}

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// What it cost, above 0.
    pub x: f64,
    /// What came of it, above 0.
    pub y: f64,
    /// The lowest and highest that were seen; drawn as a thin upright line.
    pub range: [f64; 2],
}

/// Blue, vermilion, green, purple, orange of Okabe and Ito, which the colour-blind tell apart.
const COLOURS: [RGBColor; 5] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];
/// Filled circle, open triangle, cross, open square.
const MARKS: usize = 4;

const WIDTH: u32 = 880;
const HEIGHT: u32 = 500;
const LEGEND: u32 = 200;
const LEGEND_LINE: i32 = 22;
const GREY: RGBColor = RGBColor(185, 185, 185);
const INK: RGBColor = RGBColor(40, 40, 40);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<PlotAxis, PlotAxis>>;
type Drawn = Result<(), String>;

/// The panels, one below the other. Grey lines fall with the root of the cost, as the error of
/// independent samples does: along one, efficiency is the same, and from one to the next it grows
/// tenfold.
///
/// The error is what the drawing library said.
pub fn log_log(panels: &[Panel]) -> Result<String, String> {
    let mut text = String::new();
    {
        let height = HEIGHT * panels.len().max(1) as u32;
        let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE).map_err(words)?;
        for (panel, area) in panels.iter().zip(root.split_evenly((panels.len().max(1), 1))) {
            draw_panel(panel, &root, &area)?;
        }
        root.present().map_err(words)?;
    }
    Ok(text)
}

fn words(e: impl std::fmt::Display) -> String {
    e.to_string()
}

fn draw_panel(panel: &Panel, root: &Area, area: &Area) -> Drawn {
    let (left, right) = area.split_horizontally(WIDTH - LEGEND);
    let dots = || panel.curves.iter().flat_map(|c| &c.dots).filter(|d| d.is_drawn());
    let [x, y] =
        [PlotAxis::over(dots().map(|d| d.x)), PlotAxis::over(dots().flat_map(|d| d.ends()))];
    let [x_logs, y_logs] = [x.logs.clone(), y.logs.clone()];
    let mut chart = ChartBuilder::on(&left)
        .caption(&panel.title, ("sans-serif", 17, &INK))
        .margin(14)
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d(x, y)
        .map_err(words)?;
    chart
        .configure_mesh()
        .x_desc(&panel.x)
        .y_desc(&panel.y)
        .label_style(("sans-serif", 13, &INK))
        .axis_desc_style(("sans-serif", 14, &INK))
        .axis_style(INK)
        .bold_line_style(BLACK.mix(0.13))
        .light_line_style(BLACK.mix(0.05))
        .draw()
        .map_err(words)?;
    draw_guides(&mut chart, &x_logs, &y_logs)?;
    for curve in &panel.curves {
        draw_curve(&mut chart, root, curve)?;
    }
    draw_legend(panel, &right)
}

fn draw_guides(chart: &mut Chart, x: &Range<f64>, y: &Range<f64>) -> Drawn {
    // In logarithms y = c - x / 2; neighbours are a decade apart in x.
    let first = 2.0 * y.start + x.start;
    let last = 2.0 * y.end + x.end;
    for decade in first.ceil() as i32..=last.floor() as i32 {
        let double = f64::from(decade);
        let [from, to] = [x.start.max(double - 2.0 * y.end), x.end.min(double - 2.0 * y.start)];
        if from < to {
            let ends = [from, to].map(|x| (10f64.powf(x), 10f64.powf((double - x) / 2.0)));
            let line = LineSeries::new(ends, GREY.stroke_width(1));
            chart.draw_series(line).map_err(words)?;
        }
    }
    Ok(())
}

fn draw_curve(chart: &mut Chart, root: &Area, curve: &PlotCurve) -> Drawn {
    let colour = COLOURS[curve.colour % COLOURS.len()];
    let drawn: Vec<&Dot> = curve.dots.iter().filter(|d| d.is_drawn()).collect();
    let line: Vec<_> = drawn.iter().map(|d| (d.x, d.y)).collect();
    let style = colour.stroke_width(2);
    if curve.dashed {
        chart.draw_series(DashedLineSeries::new(line.clone(), 7, 5, style)).map_err(words)?;
    } else {
        chart.draw_series(LineSeries::new(line.clone(), style)).map_err(words)?;
    }
    let marked = if curve.last_only { drawn.len().saturating_sub(1) } else { 0 };
    let bars = drawn[marked..].iter().map(|d| {
        let ends = d.ends().map(|y| (d.x, y));
        PathElement::new(ends.to_vec(), colour.mix(0.6).stroke_width(1))
    });
    chart.draw_series(bars).map_err(words)?;
    line[marked..]
        .iter()
        .try_for_each(|at| draw_mark(root, curve.mark, chart.backend_coord(at), colour))
}

/// A mark centred at a pixel of the area.
fn draw_mark(area: &Area, which: usize, (x, y): (i32, i32), colour: RGBColor) -> Drawn {
    let line = colour.stroke_width(2);
    let path = |corners: &[(i32, i32)]| -> Vec<(i32, i32)> {
        corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect()
    };
    let outline = |corners: &[(i32, i32)]| {
        area.draw(&Polygon::new(path(corners), WHITE.filled())).map_err(words)?;
        let closed = [corners, &corners[..1]].concat();
        area.draw(&PathElement::new(path(&closed), line)).map_err(words)
    };
    match which % MARKS {
        0 => area.draw(&Circle::new((x, y), 4, colour.filled())).map_err(words),
        1 => outline(&[(0, -6), (5, 4), (-5, 4)]),
        2 => {
            area.draw(&PathElement::new(path(&[(-4, -4), (4, 4)]), line)).map_err(words)?;
            area.draw(&PathElement::new(path(&[(-4, 4), (4, -4)]), line)).map_err(words)
        }
        _ => outline(&[(-4, -4), (4, -4), (4, 4), (-4, 4)]),
    }
}

fn draw_legend(panel: &Panel, area: &Area) -> Drawn {
    let top = 44;
    let style =
        ("sans-serif", 13, &INK).into_text_style(area).pos(Pos::new(HPos::Left, VPos::Center));
    for (row, curve) in panel.curves.iter().enumerate() {
        let y = top + row as i32 * LEGEND_LINE;
        let colour = COLOURS[curve.colour % COLOURS.len()];
        let parts: &[(i32, i32)] = if curve.dashed { &[(4, 14), (26, 36)] } else { &[(4, 36)] };
        for &(from, to) in parts {
            let line = PathElement::new(vec![(from, y), (to, y)], colour.stroke_width(2));
            area.draw(&line).map_err(words)?;
        }
        draw_mark(area, curve.mark, (20, y), colour)?;
        area.draw(&Text::new(curve.label.clone(), (44, y), style.clone())).map_err(words)?;
    }
    let y = top + panel.curves.len() as i32 * LEGEND_LINE + LEGEND_LINE / 2;
    let guide = PathElement::new(vec![(4, y - 5), (36, y + 5)], GREY.stroke_width(1));
    area.draw(&guide).map_err(words)?;
    let notes = [
        "slope -1/2: equal",
        "efficiency, tenfold from",
        "one line to the next",
        "",
        panel.upright[0],
        panel.upright[1],
    ];
    for (row, note) in notes.into_iter().enumerate() {
        let y = y + row as i32 * (LEGEND_LINE - 5);
        area.draw(&Text::new(note, (44, y), style.clone())).map_err(words)?;
    }
    Ok(())
}

impl Dot {
    fn is_drawn(&self) -> bool {
        [self.x, self.y].iter().all(|v| *v > 0.0 && v.is_finite())
    }

    /// The ends of the upright line, at least as far as there are logarithms.
    fn ends(&self) -> [f64; 2] {
        self.range.map(|v| if v > 0.0 && v.is_finite() { v } else { self.y })
    }
}

/// A logarithmic axis. Labels stand at 1, 10, 100, at 1, 3, 10 or at 1, 2, 5, 10, as there is room;
/// faint lines at all multiples of a power of ten.
struct PlotAxis {
    /// Its ends, as decadic logarithms.
    logs: Range<f64>,
}

impl PlotAxis {
    /// From the lowest to the highest, with a margin; never empty.
    fn over(values: impl Iterator<Item = f64>) -> PlotAxis {
        let nothing = f64::INFINITY..f64::NEG_INFINITY;
        let seen =
            values.map(f64::log10).fold(nothing, |range, v| range.start.min(v)..range.end.max(v));
        if seen.start > seen.end {
            return PlotAxis { logs: -1.0..0.0 };
        }
        let margin = (0.06 * (seen.end - seen.start)).max(0.1);
        PlotAxis { logs: seen.start - margin..seen.end + margin }
    }

    /// These multiples of the powers of ten, as far as they are on the axis.
    fn multiples(&self, factors: &[u32]) -> Vec<f64> {
        let decades = self.logs.start.floor() as i32..=self.logs.end.ceil() as i32;
        let value = |decade: i32, factor: &u32| f64::from(*factor) * 10f64.powi(decade);
        let all = decades.flat_map(|d| factors.iter().map(move |f| value(d, f)));
        all.filter(|v| self.logs.contains(&v.log10())).collect()
    }
}

impl Ranged for PlotAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value.log10() - self.logs.start) / (self.logs.end - self.logs.start);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let span = self.logs.end - self.logs.start;
        self.multiples(match span {
            _ if hint.weight().allow_light_points() => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            _ if span < 1.7 => &[1, 2, 5],
            _ if span < 3.4 => &[1, 3],
            _ => &[1],
        })
    }

    fn range(&self) -> Range<f64> {
        10f64.powf(self.logs.start)..10f64.powf(self.logs.end)
    }
}

impl ValueFormatter<f64> for PlotAxis {
    fn format(value: &f64) -> String {
        number(*value)
    }
}

/// A round number, short: 0.03, 1, 500, 1e6.
fn number(value: f64) -> String {
    let decade = (value.log10() + 1e-9).floor();
    if (-3.0..5.0).contains(&decade) {
        let digits = if decade < 0.0 { -decade as usize } else { 0 };
        format!("{value:.digits$}")
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of which the last alone is marked, and its limits drawn.
    #[test]
    fn a_curve_of_many_points_has_one_mark() {
        let dot = |i: u32| {
            let x = f64::from(i);
            Dot { x, y: 1.0 / x.sqrt(), range: [0.9 / x.sqrt(), 1.1 / x.sqrt()] }
        };
        let circles = |last_only| {
            let label = "one".to_owned();
            let dots = (1..=300).map(dot).collect();
            let curve = PlotCurve { label, colour: 0, mark: 0, last_only, dashed: false, dots };
            let [title, x, y] = ["title", "seconds", "error in %"].map(str::to_owned);
            let panel = Panel { title, x, y, upright: ["95 %", "limits"], curves: vec![curve] };
            let text = log_log(&[panel]).unwrap();
            assert!(text.contains("95 %") && !text.contains("NaN"));
            text.matches("<circle").count()
        };
        // One more in the legend.
        assert_eq!([circles(false), circles(true)], [301, 2]);
    }

    #[test]
    fn labels_are_short_and_right() {
        for (value, label) in [
            (1.0, "1"),
            (0.03, "0.03"),
            (0.5, "0.5"),
            (200.0, "200"),
            (1e-3, "0.001"),
            (2e-5, "2e-5"),
            (1e6, "1e6"),
        ] {
            assert_eq!(number(value), label);
        }
    }
}
