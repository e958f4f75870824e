//! Integrals of a lobe by deterministic quadrature, with no random number in them.
//!
//! The directional albedo is an integral over microfacet normals, in the variable `v`, the share of
//! `D cos` beyond a normal's angle, and the azimuth. Panels of Gauss points end wherever the
//! integrand bends: at the horizon, at the joint of the rational G1, at the scale on which G falls.

use super::reference::{KINK, ReferenceBrdf};
use crate::brdf::Model;
use std::f64::consts::{FRAC_PI_2, PI};

/// What a lobe reflects of light that comes from everywhere alike, seen from one angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Albedo {
    /// With F = 1.
    pub white: f64,
    /// With Schlick's `(1 - d)^5` alone in the place of F.
    pub rim: f64,
}

impl Albedo {
    /// Of a surface with a diffuse lobe and Schlick's F: `Kd + Ks white + (1 - Ks) rim`.
    pub fn of(&self, kd: f64, ks: f64) -> f64 {
        let specular = if ks > 0.0 { ks * self.white + (1.0 - ks) * self.rim } else { 0.0 };
        kd + specular
    }
}

/// Gauss points a panel.
#[derive(Clone, Copy, Debug)]
pub struct QuadratureGrid {
    angle: usize,
    azimuth: usize,
    /// Ten to minus this many is the share of normals left out.
    decades: i32,
}

impl QuadratureGrid {
    /// Errors below 1e-9 at every roughness and angle; some ten milliseconds.
    pub const FINE: QuadratureGrid = QuadratureGrid { angle: 32, azimuth: 24, decades: 14 };
    /// Errors below 2e-4; a fraction of a millisecond.
    pub const QUICK: QuadratureGrid = QuadratureGrid { angle: 6, azimuth: 6, decades: 7 };
}

/// The lobe's albedo for a viewer at this cosine, in 0..=1 and above 0.
pub fn albedo(lobe: &ReferenceBrdf, cos: f64, effort: QuadratureGrid) -> Albedo {
    let seen = SeenFrom { lobe, cos, sin: ((1.0 - cos) * (1.0 + cos)).sqrt() };
    let levels = levels(lobe);
    let edges = seen.panels(&levels, effort);
    let (in_angle, in_azimuth) = (soft_points(effort.angle), soft_points(effort.azimuth));
    let mut sum = Albedo::default();
    for pair in edges.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        for &[x, rest, weight] in &in_angle {
            let (v, beyond) = (from + (to - from) * x, (1.0 - to) + (to - from) * rest);
            let ring = seen.ring(tan2_of(lobe, v, beyond), &levels, &in_azimuth);
            sum.white += (to - from) * weight * ring.white;
            sum.rim += (to - from) * weight * ring.rim;
        }
    }
    let factor = lobe.g1(cos, seen.sin) / (cos * PI);
    Albedo { white: sum.white * factor, rim: sum.rim * factor }
}

/// The lobe from one viewer.
struct SeenFrom<'a> {
    lobe: &'a ReferenceBrdf,
    cos: f64,
    sin: f64,
}

impl SeenFrom<'_> {
    /// The edges of the panels in `v`, rising to 1: where light's lowest and highest direction on a
    /// ring of normals passes a level, and every decade.
    fn panels(&self, levels: &[f64], effort: QuadratureGrid) -> Vec<f64> {
        let viewer = self.sin.atan2(self.cos);
        let last = (FRAC_PI_2 + viewer) / 2.0;
        let least = 10f64.powi(-effort.decades - 1);
        let end = if last < FRAC_PI_2 * (1.0 - 1e-12) { self.share_beyond(last) } else { 0.0 };
        let end = end.max(least);
        let mut edges = vec![end, 1.0, 0.5, 0.9, 0.99];
        edges.extend((1..=effort.decades).map(|k| 10f64.powi(-k)));
        for level in levels {
            let z = level.acos();
            for angle in [(z - viewer) / 2.0, (z + viewer) / 2.0, (viewer - z) / 2.0] {
                if angle > 0.0 && angle <= last {
                    edges.push(self.share_beyond(angle));
                }
            }
        }
        edges.retain(|v| (end..=1.0).contains(v));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    /// The share of `D cos` of normals beyond this angle.
    fn share_beyond(&self, angle: f64) -> f64 {
        let (a2, tan2) = (self.lobe.alpha.powi(2), angle.tan().powi(2));
        match self.lobe.model {
            Model::Phong => angle.cos().powf(self.lobe.exponent + 2.0),
            Model::Beckmann => (-tan2 / a2).exp(),
            Model::Ggx => a2 / (a2 + tan2),
        }
    }

    /// The integral over half a ring of normals, by symmetry one side of the viewer's azimuth.
    fn ring(&self, tan2: f64, levels: &[f64], points: &[[f64; 3]]) -> Albedo {
        let cos = 1.0 / (1.0 + tan2).sqrt();
        let sin = tan2.sqrt() * cos;
        let mut sum = Albedo::default();
        let mut from = 0.0;
        // Light's cosine falls with the azimuth: from the highest level to the horizon.
        for level in levels.iter().rev() {
            let turn = ((level + self.cos) / (2.0 * cos) - self.cos * cos) / (self.sin * sin);
            // Where the ring or the viewer is at the pole, all of it is on one side.
            let inside = 2.0 * self.cos * cos * cos - self.cos > *level;
            let turn = if turn.is_nan() { if inside { -1.0 } else { 1.0 } } else { turn };
            let to = turn.clamp(-1.0, 1.0).acos();
            if to <= from {
                continue;
            }
            for &[x, _, weight] in points {
                let dot = self.cos * cos + self.sin * sin * (from + (to - from) * x).cos();
                let light = 2.0 * dot * cos - self.cos;
                if light > 0.0 {
                    let across = ((1.0 - light) * (1.0 + light)).max(0.0).sqrt();
                    let seen = self.lobe.g1(light, across) * dot / cos * weight * (to - from);
                    sum.white += seen;
                    sum.rim += seen * (1.0 - dot).max(0.0).powi(5);
                }
            }
            from = to;
        }
        sum
    }
}

/// Cosines of light between which the integrand is smooth, rising from the horizon.
fn levels(lobe: &ReferenceBrdf) -> Vec<f64> {
    let alpha = lobe.alpha;
    let at = |cot: f64| cot * alpha / (1.0 + (cot * alpha).powi(2)).sqrt();
    let joint = at(KINK);
    let mut levels = vec![0.0, joint];
    if alpha < 0.35 || lobe.model == Model::Ggx {
        levels.extend([0.1, 0.3, 1.0, 3.0, 10.0, 30.0].map(|cot| at(cot).min(0.999)));
    } else {
        levels.extend([joint / 4.0, joint / 2.0, (1.0 + joint) / 2.0]);
    }
    levels.sort_by(f64::total_cmp);
    levels
}

/// The squared tangent of the normal beyond which there is the share `v = 1 - rest`, both given so
/// that neither end loses its digits.
fn tan2_of(lobe: &ReferenceBrdf, v: f64, rest: f64) -> f64 {
    let a2 = lobe.alpha.powi(2);
    let ln_v = if rest < 0.5 { (-rest).ln_1p() } else { v.ln() };
    match lobe.model {
        Model::Phong => (-2.0 / (lobe.exponent + 2.0) * ln_v).exp_m1(),
        Model::Beckmann => -a2 * ln_v,
        Model::Ggx => a2 * rest / v,
    }
}

/// Gauss points of [0, 1] drawn towards both ends by `sin²`, which takes square-root ends away:
/// place, 1 - place, weight.
pub(super) fn soft_points(n: usize) -> Vec<[f64; 3]> {
    gauss(n)
        .iter()
        .map(|&[x, weight]| {
            let (sin, cos) = (FRAC_PI_2 * x).sin_cos();
            [sin * sin, cos * cos, weight * PI * sin * cos]
        })
        .collect()
}

/// The Gauss-Legendre rule of `n` points on [0, 1], place and weight: the roots of the Legendre
/// polynomial by Newton's method.
pub fn gauss(n: usize) -> Vec<[f64; 2]> {
    let value_and_slope = |x: f64| {
        let (mut before, mut p) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
        }
        (p, n as f64 * (x * p - before) / (x * x - 1.0))
    };
    let root = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..8 {
            let (p, slope) = value_and_slope(x);
            x -= p / slope;
        }
        let slope = value_and_slope(x).1;
        [(1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(root).collect()
}

/// The mean over a hemisphere of light that arrives alike from everywhere, `2 ∫ g(cos) cos dcos`,
/// by `n` points drawn towards grazing.
pub fn cosine_mean(n: usize, mut g: impl FnMut(f64) -> Albedo) -> Albedo {
    gauss(n).iter().fold(Albedo::default(), |sum, &[x, weight]| {
        let cos = x * x * (3.0 - 2.0 * x);
        let weight = 2.0 * cos * weight * 6.0 * x * (1.0 - x);
        let at = g(cos);
        Albedo { white: sum.white + weight * at.white, rim: sum.rim + weight * at.rim }
    })
}
