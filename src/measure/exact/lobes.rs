//! What a glossy surface at the origin sends towards a viewer, by quadrature of the textbook's BRDF
//! in double precision over the solid angle of an emitter, or over all of the sky.

use super::ExactError;
use super::glossy::Finish;
use crate::measure::check::quadrature::{QuadratureGrid, albedo, cosine_mean, gauss};
use crate::measure::check::reference::ReferenceBrdf;
use glam::DVec3;
use std::f64::consts::TAU;

/// A surface in the plane z = 0, seen at a cosine, azimuth 0.
pub(super) struct SeenLobe {
    lobe: ReferenceBrdf,
    kd: f64,
    ks: f64,
    wo: DVec3,
}

impl SeenLobe {
    pub(super) fn new(finish: &Finish, mu: f64) -> Result<SeenLobe, ExactError> {
        let lobe = ReferenceBrdf::new(finish.model, finish.roughness()?);
        let wo = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        Ok(SeenLobe { lobe, kd: finish.kd, ks: finish.ks, wo })
    }

    /// The BRDF times the cosine, for light from a unit direction; nothing from below. Without Ks
    /// there is no lobe.
    pub(super) fn of(&self, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        if self.ks == 0.0 {
            return self.kd / std::f64::consts::PI * wi.z;
        }
        self.lobe.f(self.kd, self.ks, self.wo.to_array(), wi.to_array()) * wi.z
    }

    /// Of light 1 from everywhere.
    pub(super) fn in_the_open(&self) -> f64 {
        albedo(&self.lobe, self.wo.z, QuadratureGrid::FINE).of(self.kd, self.ks)
    }

    /// The mean of that over the disc that a ball shows, by `points` cosines.
    pub(super) fn ball(&self, points: usize) -> f64 {
        let at = |cos: f64| albedo(&self.lobe, cos, QuadratureGrid::FINE);
        cosine_mean(points, at).of(self.kd, self.ks)
    }

    /// Of light 1 from a rectangle of these half-edges: panels halve towards where a mirror would
    /// show the viewer, so that a lobe of any width has its own.
    pub(super) fn rectangle(&self, centre: DVec3, [u, v]: [DVec3; 2], points: usize) -> f64 {
        let normal = u.cross(v);
        let area = normal.length();
        let normal = normal / area;
        let mirrored = DVec3::new(-self.wo.x, -self.wo.y, self.wo.z);
        let t = centre.dot(normal) / mirrored.dot(normal);
        let off = mirrored * t - centre;
        let peak = |edge: DVec3| {
            if t > 0.0 { (off.dot(edge) / edge.length_squared()).clamp(-1.0, 1.0) } else { 0.0 }
        };
        let rule = gauss(points);
        let (across, along) = (nodes(peak(u), &rule), nodes(peak(v), &rule));
        let mut sum = 0.0;
        for &[x, weight] in &across {
            let row: f64 = along
                .iter()
                .map(|&[y, weight]| {
                    let p = centre + u * x + v * y;
                    let r2 = p.length_squared();
                    let wi = p / r2.sqrt();
                    self.of(wi) * wi.dot(normal).abs() / r2 * weight
                })
                .sum();
            sum += row * weight;
        }
        sum * area
    }

    /// Of light 1 from a sphere: rings around its middle, in this number of panels both ways.
    pub(super) fn sphere(&self, towards: DVec3, sin_widest: f64, panels: usize) -> f64 {
        let (t1, t2) = towards.any_orthonormal_pair();
        let rule = gauss(16);
        let part = |i: usize, x: f64| (i as f64 + x) / panels as f64;
        let all: Vec<[f64; 2]> = (0..panels)
            .flat_map(|i| rule.iter().map(move |&[x, w]| [part(i, x), w / panels as f64]))
            .collect();
        let widest = sin_widest.asin();
        let mut sum = 0.0;
        for &[x, weight] in &all {
            let (sin, cos) = (x * widest).sin_cos();
            let ring: f64 = all
                .iter()
                .map(|&[y, weight]| {
                    let (s, c) = (y * TAU).sin_cos();
                    self.of(towards * cos + (t1 * c + t2 * s) * sin) * weight
                })
                .sum();
            sum += ring * sin * weight;
        }
        sum * widest * TAU
    }
}

/// Points and weights of panels of [-1, 1] that halve 25 times towards a place.
fn nodes(peak: f64, rule: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let steps = (0..26).map(|k| 2.0 * 0.5f64.powi(k));
    let mut edges: Vec<f64> = steps.flat_map(|step| [peak - step, peak + step]).collect();
    edges.extend([-1.0, 1.0, peak]);
    edges.retain(|x| (-1.0..=1.0).contains(x));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let panels = edges.windows(2);
    panels
        .flat_map(|pair| {
            let (from, width) = (pair[0], pair[1] - pair[0]);
            rule.iter().map(move |&[x, weight]| [from + width * x, width * weight])
        })
        .collect()
}
