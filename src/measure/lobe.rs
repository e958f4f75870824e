//! Curves of a BRDF over angle, all models over each other: for plots and tables.
//!
//! Everything is in the plane of incidence. Angles are from the shading normal; those of light and
//! of microfacet normals are below 0 on the viewer's side and above 0 on the mirror's. Values are
//! those that the renderer itself computes, in single precision.

use super::check::quadrature::{QuadratureGrid, albedo};
use super::check::reference::ReferenceBrdf;
use crate::brdf::{BrdfParams, Microfacet, Model, ModelVisitor, Roughness, Terms};
use crate::math::{Rgb, V3};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// What is drawn over the angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// D of a microfacet normal, in 1/sr.
    D,
    /// G1 of a direction, no unit.
    G1,
    /// f of a direction to the light, in 1/sr.
    F,
    /// f times the light's cosine, in 1/sr: what a light from there contributes.
    #[default]
    FCos,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Quantity; 4] = [Quantity::D, Quantity::G1, Quantity::F, Quantity::FCos];

    /// As a formula has it.
    pub fn title(self) -> &'static str {
        match self {
            Quantity::D => "D",
            Quantity::G1 => "G1",
            Quantity::F => "f",
            Quantity::FCos => "f cos",
        }
    }

    /// What it is, with its unit.
    pub fn describe(self) -> &'static str {
        match self {
            Quantity::D => {
                "D, density of microfacet normals per area and solid angle, in 1/sr: the integral \
                 of D cos over the hemisphere is 1."
            }
            Quantity::G1 => {
                "G1, share of the microfacets facing a direction that are seen from it, 0 to 1, no \
                 unit."
            }
            Quantity::F => "f = Kd / pi + D G F / (4 cos_i cos_o), the BRDF's value in 1/sr.",
            Quantity::FCos => {
                "f cos_i in 1/sr: the BRDF times the cosine of the light's angle, which is what \
                 light from there contributes. Its integral over the hemisphere is the albedo."
            }
        }
    }

    /// Whether it depends on where the viewer is.
    pub fn has_viewer(self) -> bool {
        matches!(self, Quantity::F | Quantity::FCos)
    }
}

/// One channel of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Diffuse reflectance, 0 to 1.
    pub kd: f64,
    /// Specular reflectance at normal incidence, 0 to 1; 0 for no specular lobe.
    pub ks: f64,
    /// Roughness.
    pub roughness: Roughness,
}

impl Channel {
    /// The specular lobe alone with F = 1.
    pub fn white(roughness: Roughness) -> Channel {
        Channel { kd: 0.0, ks: 1.0, roughness }
    }

    fn params(&self) -> BrdfParams {
        let [kd, ks] = [self.kd, self.ks].map(|c| Rgb::splat(c as f32));
        BrdfParams { kd, ks, roughness: self.roughness.into() }
    }
}

/// A quantity of all models over the angle.
#[derive(Clone, Debug)]
pub struct LobeCurves {
    /// What.
    pub quantity: Quantity,
    /// Of what.
    pub channel: Channel,
    /// The viewer's angle in radians, 0 to [`LobeCurves::LIMIT`].
    pub theta_o: f64,
    /// Angles in radians, rising from -[`LobeCurves::LIMIT`] to [`LobeCurves::LIMIT`]. They are
    /// dense where the lobe is sharp.
    pub angles: Vec<f64>,
    /// The quantity at each, in the order of [`Model::ALL`].
    pub values: [Vec<f64>; Model::ALL.len()],
    /// Directional albedo at the viewer's angle, no unit, in the same order: the share of light from
    /// everywhere alike that leaves towards the viewer. Errors are below 2e-4.
    pub albedo: [f64; Model::ALL.len()],
}

/// The curves at this number of equally spaced angles, at least 2, and more where the lobe is sharp. Takes
/// about a millisecond.
pub fn lobe_curves(quantity: Quantity, channel: Channel, theta_o: f64, n: usize) -> LobeCurves {
    let theta_o = theta_o.clamp(0.0, LobeCurves::LIMIT);
    let angles = angles(quantity, channel.roughness.alpha(), theta_o, n.max(2));
    let values = Model::ALL
        .map(|model| angles.iter().map(|&a| value(model, quantity, channel, theta_o, a)).collect());
    let of = |model| {
        let lobe = ReferenceBrdf::new(model, channel.roughness);
        albedo(&lobe, theta_o.cos(), QuadratureGrid::QUICK).of(channel.kd, channel.ks)
    };
    LobeCurves { quantity, channel, theta_o, values, albedo: Model::ALL.map(of), angles }
}

/// A quantity at one angle in radians, for a viewer at `theta_o`.
pub fn value(model: Model, quantity: Quantity, channel: Channel, theta_o: f64, angle: f64) -> f64 {
    let at = Channel::params(&channel);
    model.visit(LobeValue { quantity, params: at, wo: towards(-theta_o), w: towards(angle) }).into()
}

/// All factors of the BRDF for a viewer at `theta_o` and a light at `theta_i`, in radians.
pub fn terms(model: Model, channel: Channel, theta_o: f64, theta_i: f64) -> Terms {
    struct All(BrdfParams, [V3; 2]);
    impl ModelVisitor for All {
        type Output = Terms;
        fn visit<M: Microfacet>(self) -> Terms {
            let All(params, [wo, wi]) = self;
            params.terms::<M>(wo, wi)
        }
    }
    model.visit(All(channel.params(), [towards(-theta_o), towards(theta_i)]))
}

struct LobeValue {
    quantity: Quantity,
    params: BrdfParams,
    wo: V3,
    w: V3,
}

impl ModelVisitor for LobeValue {
    type Output = f32;
    fn visit<M: Microfacet>(self) -> f32 {
        let LobeValue { quantity, params, wo, w } = self;
        match quantity {
            Quantity::D => M::d(params.roughness, w),
            Quantity::G1 => M::g1_over_cos(params.roughness, w) * w.z,
            Quantity::F => params.eval::<M>(wo, w).f.r,
            Quantity::FCos => params.eval::<M>(wo, w).f.r * w.z,
        }
    }
}

/// The direction at an angle, those above 0 towards x.
fn towards(angle: f64) -> V3 {
    let (sin, cos) = angle.sin_cos();
    V3::new(sin as f32, 0.0, cos as f32)
}

/// Equally spaced ones, and those at which the slope is a certain multiple of alpha.
fn angles(quantity: Quantity, alpha: f64, theta_o: f64, n: usize) -> Vec<f64> {
    const SIDE: i32 = 64;
    const FARTHEST: f64 = 6.0;
    let limit = LobeCurves::LIMIT;
    let step = 2.0 * limit / (n - 1) as f64;
    let mut angles: Vec<f64> = (0..n).map(|i| step * i as f64 - limit).collect();
    let slopes = (-SIDE..=SIDE).map(|i| (FARTHEST * f64::from(i) / f64::from(SIDE)).sinh());
    let normals = slopes.map(|slope| (alpha * slope).atan());
    match quantity {
        Quantity::D => angles.extend(normals),
        Quantity::G1 => {}
        // The half vector's angle is half the way from the viewer's to the light's.
        Quantity::F | Quantity::FCos => angles.extend(normals.map(|m| theta_o + 2.0 * m)),
    }
    angles.retain(|a| (-limit..=limit).contains(a));
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles
}

impl LobeCurves {
    /// Angles are at most this, in radians: 89.9 degrees.
    pub const LIMIT: f64 = FRAC_PI_2 * (89.9 / 90.0);

    /// The scale that holds all of the curves.
    pub fn axis(&self, log: bool) -> LobeAxis {
        let all = || self.values.iter().flatten().copied().filter(|v| v.is_finite());
        let most = all().fold(0.0, f64::max);
        if most <= 0.0 {
            return LobeAxis { low: if log { 0.1 } else { 0.0 }, high: 1.0, log };
        }
        if !log {
            return LobeAxis { low: 0.0, high: round_up(1.02 * most), log };
        }
        let high = most.log10().ceil();
        let least = all().filter(|v| *v > 0.0).fold(most, f64::min).log10().floor();
        let low = least.clamp(high - LobeAxis::DECADES, high - 1.0);
        LobeAxis { low: 10f64.powf(low), high: 10f64.powf(high), log }
    }

    /// A table of them with a head: angles in degrees, values in 1/sr, or without a unit for G1.
    pub fn csv(&self) -> String {
        let angle = if self.quantity == Quantity::D { "theta_m" } else { "theta_i" };
        let names = Model::ALL.map(Model::name).join(",");
        let mut text = format!("{angle}_degrees,{names}\n");
        for (i, angle) in self.angles.iter().enumerate() {
            let [a, b, c] = [0, 1, 2].map(|m| self.values[m][i]);
            let _ = writeln!(text, "{:.6},{a:e},{b:e},{c:e}", angle.to_degrees());
        }
        text
    }

    /// What is drawn, in a line: the quantity, the material and the viewer.
    pub fn caption(&self) -> String {
        let Channel { kd, ks, roughness } = self.channel;
        let mut text = format!("{}, alpha {:.4}", self.quantity.title(), roughness.alpha());
        if self.quantity.has_viewer() {
            let of = match (kd, ks) {
                (0.0, 1.0) => "F = 1".to_owned(),
                _ => format!("Kd {kd:.3}, Ks {ks:.3}"),
            };
            let _ = write!(text, ", {of}, viewer at {:.1}\u{b0}", self.theta_o.to_degrees());
        }
        text
    }
}

/// A scale of values, from its low end to its high one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeAxis {
    /// 0, or above 0 where it is logarithmic.
    pub low: f64,
    /// Above `low`.
    pub high: f64,
    /// Whether equal ratios are equally far apart.
    pub log: bool,
}

impl LobeAxis {
    /// Most decades that are shown.
    const DECADES: f64 = 6.0;

    /// Where a value is from the low end, 0, to the high one, 1; values beyond are at the ends.
    pub fn share(&self, value: f64) -> f64 {
        let share = if self.log {
            let [low, high] = [self.low, self.high].map(f64::log10);
            (value.max(f64::MIN_POSITIVE).log10() - low) / (high - low)
        } else {
            (value - self.low) / (self.high - self.low)
        };
        share.clamp(0.0, 1.0)
    }

    /// Round values from the low end to the high one, both included where they are round.
    pub fn ticks(&self) -> Vec<f64> {
        if !self.log {
            // The high end is 1, 2 or 5 of a power of ten.
            let parts = if leading(self.high) == 2 { 4 } else { 5 };
            return (0..=parts).map(|i| self.high * f64::from(i) / f64::from(parts)).collect();
        }
        let [low, high] = [self.low, self.high].map(|v| v.log10().round() as i32);
        (low..=high).map(|decade| 10f64.powi(decade)).collect()
    }
}

/// 1, 2 or 5 of a power of ten, at least `x`.
fn round_up(x: f64) -> f64 {
    let decade = 10f64.powf(x.log10().floor());
    let rounded = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * decade >= x);
    rounded.unwrap_or(10.0) * decade
}

/// The first digit of a round number.
fn leading(x: f64) -> u32 {
    let decade = (x.log10() + 1e-9).floor();
    (x / 10f64.powf(decade)).round() as u32
}

#[cfg(test)]
mod tests {
    use super::super::check::quadrature::gauss;
    use super::*;
    use std::f64::consts::PI;

    fn rough(alpha: f64) -> Roughness {
        Roughness::from_alpha(alpha).unwrap()
    }

    /// Every value of the curves against the textbook's formulas in double precision. Single
    /// precision directions leave slopes an error of about 1e-7, which a distribution of width
    /// alpha makes 1e-7 / alpha of its exponent, times its slope there.
    #[test]
    fn curves_are_the_textbook_s() {
        for alpha in [0.02, 0.141, 0.7] {
            for degrees in [0.0f64, 30.0, 75.0] {
                let (theta_o, roughness) = (degrees.to_radians(), rough(alpha));
                let channel = Channel { kd: 0.3, ks: 0.2, roughness };
                for quantity in Quantity::ALL {
                    let curves = lobe_curves(quantity, channel, theta_o, 91);
                    for (model, values) in Model::ALL.iter().zip(&curves.values) {
                        let lobe = ReferenceBrdf::new(*model, roughness);
                        let wo = [-theta_o.sin(), 0.0, theta_o.cos()];
                        for (&angle, &found) in curves.angles.iter().zip(values) {
                            let (sin, cos) = angle.sin_cos();
                            let f = lobe.f(0.3, 0.2, wo, [sin, 0.0, cos]);
                            let expected = match quantity {
                                Quantity::D => lobe.d((sin / cos).powi(2)),
                                Quantity::G1 => lobe.g1(cos, sin.abs()),
                                Quantity::F => f,
                                Quantity::FCos => f * cos,
                            };
                            let peak = values.iter().fold(0.0, |a: f64, &b| a.max(b));
                            let error = (found - expected).abs();
                            assert!(
                                error <= 2e-4 * expected + 1e-6 * peak,
                                "{model:?} {quantity:?} {alpha} {degrees} at {angle}: {found}, \
                                 not {expected}"
                            );
                        }
                    }
                }
            }
        }
    }

    /// By the trapezoid rule on the curve's own angles: it is dense enough to be drawn.
    #[test]
    fn d_of_the_curve_integrates_to_one() {
        for alpha in [1e-3, 0.05, 0.4, 1.0] {
            let curves = lobe_curves(Quantity::D, Channel::white(rough(alpha)), 0.0, 361);
            for (model, values) in Model::ALL.iter().zip(&curves.values) {
                let ring = |i: usize| {
                    let (sin, cos) = curves.angles[i].sin_cos();
                    PI * values[i] * cos * sin.abs()
                };
                let sum: f64 = (1..values.len())
                    .map(|i| {
                        (curves.angles[i] - curves.angles[i - 1]) * (ring(i) + ring(i - 1)) / 2.0
                    })
                    .sum();
                // Of GGX at 1e-3, 3e-5 of the normals are beyond the angles that are dense.
                assert!((sum - 1.0).abs() < 4e-3, "{model:?} at {alpha}: {sum}");
            }
        }
    }

    /// The renderer's f cos, summed over the hemisphere by a product rule, is the albedo told.
    #[test]
    fn the_albedo_is_the_integral_of_f_cos() {
        struct Sum(BrdfParams, V3, V3);
        impl ModelVisitor for Sum {
            type Output = f32;
            fn visit<M: Microfacet>(self) -> f32 {
                self.0.eval::<M>(self.1, self.2).f.r * self.2.z
            }
        }
        let points = gauss(200);
        for degrees in [0.0f64, 40.0, 70.0] {
            let channel = Channel { kd: 0.25, ks: 0.6, roughness: rough(0.5) };
            let theta_o = degrees.to_radians();
            let curves = lobe_curves(Quantity::FCos, channel, theta_o, 91);
            for (model, told) in Model::ALL.into_iter().zip(curves.albedo) {
                let mut sum = 0.0;
                for &[u, weight_u] in &points {
                    let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
                    for &[v, weight_v] in &points {
                        let (y, x) = (PI * v).sin_cos();
                        let wi = V3::new((sin * x) as f32, (sin * y) as f32, cos as f32);
                        let found = model.visit(Sum(channel.params(), towards(-theta_o), wi));
                        let solid_angle = FRAC_PI_2 * weight_u * 2.0 * PI * weight_v * sin;
                        sum += f64::from(found) * solid_angle;
                    }
                }
                assert!((sum - told).abs() < 3e-4, "{model:?} at {degrees}: {sum}, not {told}");
            }
        }
    }

    #[test]
    fn the_albedo_is_that_of_the_energy_figures() {
        let roughness = rough(0.3);
        let curves = lobe_curves(Quantity::FCos, Channel::white(roughness), 0.5, 91);
        for (model, told) in Model::ALL.into_iter().zip(curves.albedo) {
            let lobe = ReferenceBrdf::new(model, roughness);
            let fine = albedo(&lobe, 0.5f64.cos(), QuadratureGrid::FINE).white;
            assert!((told - fine).abs() < 2e-4, "{model:?}: {told}, not {fine}");
        }
    }

    #[test]
    fn the_factors_make_up_the_value() {
        let channel = Channel { kd: 0.1, ks: 0.4, roughness: rough(0.2) };
        for model in Model::ALL {
            let (o, i) = (0.6, 0.9);
            let t = terms(model, channel, o, i);
            let product = f64::from(t.d * t.g * t.fresnel) / (4.0 * o.cos() * i.cos());
            let f = value(model, Quantity::F, channel, o, i);
            assert!((product + 0.1 / PI - f).abs() < 1e-5 * f, "{model:?}");
        }
    }

    #[test]
    fn scales_hold_their_curves_and_have_round_ends() {
        let curves = lobe_curves(Quantity::F, Channel::white(rough(0.141)), 0.7, 181);
        let most = curves.values.iter().flatten().fold(0.0, |a: f64, &b| a.max(b));
        let linear = curves.axis(false);
        assert!(linear.low == 0.0 && linear.high >= most && linear.high < 3.0 * most);
        assert_eq!((linear.share(0.0), linear.share(linear.high)), (0.0, 1.0));
        let log = curves.axis(true);
        assert!(log.high >= most && log.high < 10.1 * most && log.low > 0.0);
        assert!((log.share((log.low * log.high).sqrt()) - 0.5).abs() < 1e-12);
        for axis in [linear, log] {
            let ticks = axis.ticks();
            assert!(ticks.len() >= 2 && ticks.windows(2).all(|t| t[0] < t[1]), "{ticks:?}");
            assert!((ticks[ticks.len() - 1] / axis.high - 1.0).abs() < 1e-9, "{ticks:?}");
        }
        assert_eq!([0.3, 1.0, 1.2, 4.0, 70.0].map(round_up), [0.5, 1.0, 2.0, 5.0, 100.0]);
        let nothing = Channel { kd: 0.0, ks: 0.0, roughness: rough(0.1) };
        for log in [false, true] {
            let axis = lobe_curves(Quantity::F, nothing, 0.0, 9).axis(log);
            assert!(axis.low < axis.high);
        }
    }

    #[test]
    fn a_table_has_a_line_for_every_angle() {
        let curves = lobe_curves(Quantity::G1, Channel::white(rough(0.5)), 0.0, 5);
        let text = curves.csv();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "theta_i_degrees,phong,beckmann,ggx");
        assert_eq!(lines.len(), 1 + 5);
        let middle: Vec<f64> = lines[3].split(',').map(|x| x.parse().unwrap()).collect();
        assert_eq!(middle, [0.0, 1.0, 1.0, 1.0], "nothing is hidden straight on");
    }
}
