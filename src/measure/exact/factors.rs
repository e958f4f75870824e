//! Form factors from a point with its normal along z: what part of a diffuse surface's view an emitter
//! fills, weighed with the cosine.

use crate::measure::check::quadrature::gauss;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Of a sphere whose middle is `beta` from the normal; the horizon may cut it. The integral of the
/// cosine over rings around the sphere's middle: the part of a ring above the horizon is known in
/// closed form, and panels end where rings begin or cease to be cut.
pub(super) fn sphere(radius: f64, distance: f64, beta: f64, points: usize) -> f64 {
    let widest = (radius / distance).asin();
    let cut = (FRAC_PI_2 - beta).abs().min(widest);
    let mut sum = 0.0;
    for [from, to] in [[0.0, cut], [cut, widest]] {
        for [x, weight] in gauss(points) {
            // Drawn towards both ends, where the cut goes like a square root.
            let (sin, cos) = (FRAC_PI_2 * x).sin_cos();
            let ring = from + (to - from) * sin * sin;
            let weight = (to - from) * weight * PI * sin * cos;
            let (along, across) = (ring.cos() * beta.cos(), ring.sin() * beta.sin());
            let turn = if along >= across {
                PI
            } else if along <= -across {
                0.0
            } else {
                (-along / across).acos()
            };
            sum += 2.0 * (along * turn + across * turn.sin()) * ring.sin() * weight;
        }
    }
    sum / PI
}

/// Of a polygon (Lambert 1760): the sum over its edges of the angle that each fills times the
/// upward part of the normal of its plane with the point. What is below the horizon is cut off.
pub(super) fn polygon(corners: &[DVec3]) -> f64 {
    let edges = |points: &[DVec3]| -> Vec<(DVec3, DVec3)> {
        let next = points.iter().cycle().skip(1);
        points.iter().copied().zip(next.copied()).collect()
    };
    let mut above = Vec::new();
    for (a, b) in edges(corners) {
        if a.z >= 0.0 {
            above.push(a);
        }
        if a.z * b.z < 0.0 {
            above.push(a + (b - a) * (a.z / (a.z - b.z)));
        }
    }
    let term = |(a, b): (DVec3, DVec3)| {
        let (a, b) = (a.normalize(), b.normalize());
        let normal = a.cross(b);
        let sin = normal.length();
        if sin > 0.0 { sin.atan2(a.dot(b)) * normal.z / sin } else { 0.0 }
    };
    (edges(&above).into_iter().map(term).sum::<f64>() / TAU).abs()
}

/// Of a disc parallel to the surface, with its middle `aside` of the normal (Howell, Mengüç, Daun
/// and Siegel, configuration B-13).
pub(super) fn disc(radius: f64, height: f64, aside: f64) -> f64 {
    let (r2, h2, a2) = (radius * radius, height * height, aside * aside);
    let sum = h2 + a2 + r2;
    0.5 * (1.0 - (h2 + a2 - r2) / (sum * sum - 4.0 * r2 * a2).sqrt())
}
