//! The roughness at which one model comes nearest to another.
//!
//! The models share the name alpha, but not what it does: at one alpha GGX's tails are longer than
//! Beckmann's. To compare shapes and not widths, one asks for the alpha that makes some property of
//! the two lobes equal. Which property that is is a choice; what then remains is the difference of the
//! shapes.

use super::check::quadrature::gauss;
use super::check::reference::ReferenceBrdf;
use super::energy::LobeEnergy;
use crate::brdf::{Model, Roughness};

/// What is to be equal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Criterion {
    /// The mean slope of the microfacets, `E[tan]` of the angle between `wm` and the normal under
    /// `D cos`.
    #[default]
    MeanSlope,
    /// The angle from the normal at which D is half of its largest value.
    HalfWidth,
    /// The albedo of the lobe with F = 1, its mean over the hemisphere weighed with the cosine.
    Albedo,
}

impl Criterion {
    /// All of them, the default first.
    pub const ALL: [Criterion; 3] = [Criterion::MeanSlope, Criterion::HalfWidth, Criterion::Albedo];

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Criterion::MeanSlope => "Mean slope",
            Criterion::HalfWidth => "Half-width",
            Criterion::Albedo => "Albedo",
        }
    }

    /// What it measures of a lobe: grows with the roughness (albedo falls).
    pub fn of(self, model: Model, roughness: Roughness) -> f64 {
        match self {
            Criterion::MeanSlope => mean_slope(&ReferenceBrdf::new(model, roughness)),
            Criterion::HalfWidth => half_width(&ReferenceBrdf::new(model, roughness)),
            Criterion::Albedo => 1.0 - LobeEnergy::of(model, roughness).loss(),
        }
    }
}

/// A match, and how good it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Of the other model.
    pub roughness: Roughness,
    /// Half of the integral of `|D1 - D2| cos`: the part of the microfacet area that faces elsewhere,
    /// 0 to 1.
    pub remains: f64,
}

/// The roughness of `to` with the property that `from` has at `roughness`. `None` where no roughness
/// has it.
pub fn match_roughness(from: (Model, Roughness), to: Model, criterion: Criterion) -> Option<Match> {
    let wanted = criterion.of(from.0, from.1);
    let exceeds = |alpha: f64| {
        let roughness = Roughness::from_alpha(alpha).ok()?;
        let found = criterion.of(to, roughness);
        Some(if criterion == Criterion::Albedo { found < wanted } else { found > wanted })
    };
    let [mut low, mut high] = Roughness::ALPHA;
    if from.0 == to {
        (low, high) = (from.1.alpha(), from.1.alpha());
    } else if exceeds(low)? || !exceeds(high)? {
        return None;
    }
    // In the logarithm: to 1e-7 of alpha, what single precision tells apart.
    while high / low > 1.0 + 1e-7 {
        let middle = (low * high).sqrt();
        if exceeds(middle)? { high = middle } else { low = middle }
    }
    let roughness = Roughness::from_alpha((low * high).sqrt().clamp(low, high)).ok()?;
    let [a, b] = [ReferenceBrdf::new(from.0, from.1), ReferenceBrdf::new(to, roughness)];
    let remains = 0.5 * over_slopes(&a, &b, |tan, x, y| (x - y).abs() * slope_area(tan));
    Some(Match { roughness, remains })
}

/// `2 pi tan / (1 + tan²)²`: the solid angle of slopes from tan to tan + dtan, with the cosine.
fn slope_area(tan: f64) -> f64 {
    2.0 * std::f64::consts::PI * tan / (1.0 + tan * tan).powi(2)
}

fn mean_slope(lobe: &ReferenceBrdf) -> f64 {
    over_slopes(lobe, lobe, |tan, d, _| tan * d * slope_area(tan))
}

/// The integral over all slopes of a function of the slope and of D of two lobes.
fn over_slopes(a: &ReferenceBrdf, b: &ReferenceBrdf, f: impl Fn(f64, f64, f64) -> f64) -> f64 {
    // Panels by factors of 2 from far below either width to far above: what lies outside is below
    // 1e-8 of the area.
    let (low, high) = (1e-5 * a.alpha.min(b.alpha), 1e9);
    let points = gauss(12);
    let mut sum = 0.0;
    let mut from = 0.0;
    let mut to = low;
    while from < high {
        for [x, weight] in &points {
            let tan = from + (to - from) * x;
            sum += weight * (to - from) * f(tan, a.d(tan * tan), b.d(tan * tan));
        }
        (from, to) = (to, 2.0 * to);
    }
    sum
}

/// In radians.
fn half_width(lobe: &ReferenceBrdf) -> f64 {
    // At the normal; where alpha is near 1 Beckmann's D grows from there before it falls.
    let (mut low, mut high) = (0.0, 0.5 * std::f64::consts::PI);
    let d = |angle: f64| lobe.d(angle.tan().powi(2));
    let most = (0..=900).map(|i| d(high * f64::from(i) / 900.0)).fold(0.0, f64::max).max(d(0.0));
    // The last angle at which it is half of that: from there on it falls.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if d(middle) > 0.5 * most { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn rough(alpha: f64) -> Roughness {
        Roughness::from_alpha(alpha).unwrap()
    }

    /// Alphas over the whole range that materials have, none of them round.
    fn alphas() -> impl Iterator<Item = f64> {
        (0..12).map(|i| 2e-4 * 1.9f64.powi(i) * (1.0 + 0.031 * f64::from(i)))
    }

    #[test]
    fn mean_slopes_have_their_closed_forms() {
        for alpha in alphas() {
            let of = |model| Criterion::MeanSlope.of(model, rough(alpha));
            let close = |found: f64, expected: f64| {
                assert!((found / expected - 1.0).abs() < 1e-6, "{alpha}: {found}, {expected}");
            };
            close(of(Model::Beckmann), 0.5 * PI.sqrt() * alpha);
            close(of(Model::Ggx), 0.5 * PI * alpha);
        }
    }

    #[test]
    fn half_widths_have_their_closed_forms() {
        for alpha in alphas() {
            let tan = |model| Criterion::HalfWidth.of(model, rough(alpha)).tan();
            // a² (1 + t²) / (a² + t²) = sqrt(1/2), and cos^a_p = 1/2.
            let k = 0.5f64.sqrt();
            let ggx = alpha * ((1.0 - k) / (k - alpha * alpha)).sqrt();
            if alpha * alpha < 0.5 {
                assert!((tan(Model::Ggx) / ggx - 1.0).abs() < 1e-8, "{alpha}");
            }
            let exponent = rough(alpha).exponent();
            let phong = (2f64.powf(2.0 / exponent) - 1.0).sqrt();
            assert!((tan(Model::Phong) / phong - 1.0).abs() < 1e-6, "{alpha}");
        }
    }

    #[test]
    fn a_match_has_the_property_and_leads_back() {
        for criterion in Criterion::ALL {
            for alpha in [0.0137, 0.093, 0.31] {
                for from in Model::ALL {
                    for to in Model::ALL {
                        let there = match_roughness((from, rough(alpha)), to, criterion).unwrap();
                        let [a, b] = [(from, rough(alpha)), (to, there.roughness)]
                            .map(|(m, r)| criterion.of(m, r));
                        // Albedos are known to 5e-5.
                        let bound = if criterion == Criterion::Albedo { 1e-4 } else { 1e-6 };
                        assert!(
                            (a / b - 1.0).abs() < bound,
                            "{criterion:?} {from:?} {to:?}: {a}, {b}"
                        );
                        assert_eq!(there.remains == 0.0, from == to);
                        assert!((0.0..0.7).contains(&there.remains), "{}", there.remains);
                        let back = match_roughness((to, there.roughness), from, criterion).unwrap();
                        let again = back.roughness.alpha() / alpha - 1.0;
                        let bound = if criterion == Criterion::Albedo { 0.05 } else { 1e-5 };
                        assert!(again.abs() < bound, "{criterion:?} {from:?} {to:?}: {again}");
                    }
                }
            }
        }
    }

    /// Where one lobe is as wide as the other can never be there is no match, and no hang.
    #[test]
    fn what_no_roughness_has_is_not_matched() {
        let widest = (Model::Ggx, rough(1.0));
        assert_eq!(match_roughness(widest, Model::Beckmann, Criterion::MeanSlope), None);
    }
}
