//! A trefoil knot: a round tube along the curve that winds three times around a ring's tube while it
//! goes twice around the ring.

use super::arithmetic::cos_sin;
use super::model::{Model, Point, cross, unit};

/// Points along the tube and around it.
const ALONG: u32 = 360;
const AROUND: u32 = 40;
/// Radius of the ring, where that of its tube is 1; the tube's half height; radius of the knot's own
/// tube, which comes nearest to itself at 0.7.
const RING: f64 = 2.0;
const HEIGHT: f64 = 1.25;
const THICK: f64 = 0.62;
/// Turn of the whole, in turns, so that it stands on two of its three arcs.
const STANCE: f64 = 7.0 / 12.0;

/// The knot, one unit high, standing on z = 0, seen best along y.
pub(crate) fn trefoil() -> Model {
    let mut model = Model::default();
    for i in 0..ALONG {
        ring(f64::from(i) / f64::from(ALONG), &mut model);
    }
    let at = |i: u32, j: u32| (i % ALONG) * AROUND + j % AROUND;
    for i in 0..ALONG {
        for j in 0..AROUND {
            model.faces.push(vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    stand(&mut model.positions);
    model
}

/// Adds the circle around the curve at `u` turns of its way.
fn ring(u: f64, model: &mut Model) {
    let ([c2, s2], [c3, s3]) = (cos_sin(2.0 * u), cos_sin(3.0 * u));
    let far = RING + c3;
    let centre = [far * c2, far * s2, HEIGHT * s3];
    let tangent =
        unit([-3.0 * s3 * c2 - 2.0 * far * s2, -3.0 * s3 * s2 + 2.0 * far * c2, 3.0 * HEIGHT * c3]);
    // Away from the middle of the ring's tube, made square to the tangent.
    let aside = unit(cross(tangent, [c2 * c3, s2 * c3, s3]));
    let out = cross(aside, tangent);
    for j in 0..AROUND {
        let [c, s] = cos_sin(f64::from(j) / f64::from(AROUND));
        let at = |k: usize| centre[k] + THICK * (c * out[k] + s * aside[k]);
        model.vertex(upright([at(0), at(1), at(2)]));
    }
}

/// The ring's plane upright, turned to its stance.
fn upright([x, y, z]: Point) -> Point {
    let [c, s] = cos_sin(STANCE);
    [x * c - y * s, -z, x * s + y * c]
}

/// Moves and scales the points to stand on z = 0 with height 1.
fn stand(points: &mut [Point]) {
    let low = points.iter().fold(f64::INFINITY, |a, p| a.min(p[2]));
    let high = points.iter().fold(f64::NEG_INFINITY, |a, p| a.max(p[2]));
    for p in points {
        *p = [p[0] / (high - low), p[1] / (high - low), (p[2] - low) / (high - low)];
    }
}
