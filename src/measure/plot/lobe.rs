//! Curves of a BRDF over angle, as SVG.

use super::{Area, COLOURS, Drawn, GREY, INK, words};
use crate::brdf::Model;
use crate::measure::lobe::{LobeAxis, LobeCurves, Quantity};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const SIZE: (u32, u32) = (720, 480);
/// Left, top, right and bottom of the plot.
const PLACE: [i32; 4] = [80, 44, 700, 420];

/// How curves over angle are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Around the surface's point instead of over a line of angles.
    pub polar: bool,
    /// Equal ratios of values equally far apart.
    pub log: bool,
}

/// All models' curves in one coordinate system, as an SVG file's text.
///
/// The error is what the drawing library said.
pub fn lobe(curves: &LobeCurves, style: Style) -> Result<String, String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(words)?;
        let axis = curves.axis(style.log);
        let plot = Plot { area: &root, curves, axis };
        plot.words(&curves.caption(), (PLACE[0], 22), HPos::Left, 17)?;
        if style.polar {
            plot.polar()?
        } else {
            plot.cartesian()?
        }
        plot.legend()?;
        root.present().map_err(words)?;
    }
    Ok(text)
}

struct Plot<'a, 'b> {
    area: &'a Area<'b>,
    curves: &'a LobeCurves,
    axis: LobeAxis,
}

impl Plot<'_, '_> {
    fn words(&self, text: &str, at: (i32, i32), side: HPos, size: i32) -> Drawn {
        let style = ("sans-serif", size, &INK).into_text_style(self.area);
        let style = style.pos(Pos::new(side, VPos::Center));
        self.area.draw(&Text::new(text.to_owned(), at, style)).map_err(words)
    }

    fn line(&self, points: Vec<(i32, i32)>, style: impl Into<ShapeStyle>) -> Drawn {
        self.area.draw(&PathElement::new(points, style)).map_err(words)
    }

    fn cartesian(&self) -> Drawn {
        let [left, top, right, bottom] = PLACE;
        let x = |degrees: f64| left + ((degrees + 90.0) / 180.0 * f64::from(right - left)) as i32;
        let y = |share: f64| bottom - (share * f64::from(bottom - top)).round() as i32;
        for degrees in (-90..=90).step_by(30) {
            let at = x(f64::from(degrees));
            self.line(vec![(at, top), (at, bottom)], GREY.stroke_width(1))?;
            self.words(&format!("{degrees}\u{b0}"), (at, bottom + 16), HPos::Center, 13)?;
        }
        for tick in self.axis.ticks() {
            let at = y(self.axis.share(tick));
            self.line(vec![(left, at), (right, at)], GREY.stroke_width(1))?;
            self.words(&super::number(tick), (left - 8, at), HPos::Right, 13)?;
        }
        let about = match self.curves.quantity {
            Quantity::D => "angle of the microfacet normal",
            Quantity::G1 => "angle of the direction",
            Quantity::F | Quantity::FCos => "angle of the light; the viewer is at the left",
        };
        self.words(about, ((left + right) / 2, bottom + 38), HPos::Center, 14)?;
        self.each(|angle, share| (x(angle.to_degrees()), y(share)))
    }

    fn polar(&self) -> Drawn {
        let [left, top, right, bottom] = PLACE;
        let centre = ((left + right) / 2, bottom);
        let radius = f64::from((bottom - top).min((right - left) / 2));
        let at = |angle: f64, share: f64| {
            let (sin, cos) = angle.sin_cos();
            let along = |x: f64| (share * radius * x).round() as i32;
            (centre.0 + along(sin), centre.1 - along(cos))
        };
        let arc = |share: f64| (-90..=90).map(move |d| at(f64::from(d).to_radians(), share));
        for tick in self.axis.ticks().into_iter().skip(1) {
            let share = self.axis.share(tick);
            self.line(arc(share).collect(), GREY.stroke_width(1))?;
            let (x, y) = at(std::f64::consts::FRAC_PI_2, share);
            self.words(&super::number(tick), (x, y + 16), HPos::Center, 13)?;
        }
        for degrees in (-90..=90).step_by(30) {
            let end = at(f64::from(degrees).to_radians(), 1.0);
            self.line(vec![centre, end], GREY.stroke_width(1))?;
        }
        if self.curves.quantity.has_viewer() {
            let eye = at(-self.curves.theta_o, 1.0);
            self.line(vec![centre, eye], INK.stroke_width(1))?;
            self.words("viewer", (eye.0 - 6, eye.1 - 8), HPos::Right, 13)?;
        }
        self.each(at)
    }

    /// Draws every model's curve by where an angle and a share of the scale are.
    fn each(&self, at: impl Fn(f64, f64) -> (i32, i32)) -> Drawn {
        for (m, values) in self.curves.values.iter().enumerate() {
            let points = self.curves.angles.iter().zip(values);
            let points = points.map(|(&angle, &value)| at(angle, self.axis.share(value)));
            self.line(points.collect(), COLOURS[m].stroke_width(2))?;
        }
        Ok(())
    }

    fn legend(&self) -> Drawn {
        for (m, model) in Model::ALL.into_iter().enumerate() {
            let x = PLACE[0] + 200 * m as i32;
            self.line(vec![(x, 468), (x + 24, 468)], COLOURS[m].stroke_width(2))?;
            let text = format!("{}, albedo {:.4}", model.title(), self.curves.albedo[m]);
            self.words(&text, (x + 32, 468), HPos::Left, 13)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::Roughness;
    use crate::measure::lobe::{Channel, lobe_curves};

    #[test]
    fn every_style_draws_three_curves_and_names_them() {
        let roughness = Roughness::from_alpha(0.2).unwrap();
        for quantity in Quantity::ALL {
            let curves = lobe_curves(quantity, Channel::white(roughness), 0.7, 91);
            for (polar, log) in [(false, false), (false, true), (true, false), (true, true)] {
                let text = lobe(&curves, Style { polar, log }).unwrap();
                assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
                for colour in ["#0072B2", "#D55E00", "#009E73"] {
                    let lines = text.split("<polyline").filter(|l| l.contains(colour));
                    assert_eq!(lines.count(), 2, "{quantity:?}: curve and legend of {colour}");
                }
                for model in Model::ALL {
                    assert!(text.contains(&format!("{}, albedo 0.", model.title())), "{text}");
                }
                assert!(!text.contains("NaN"));
            }
        }
    }
}
