//! The letters X and Y: solid, one unit high, standing on z = 0 and facing -y, edges rounded.

use super::model::{Model, Point};

type Flat = [f64; 2];

const HEIGHT: f64 = 1.0;
const WIDTH: f64 = 0.84;
/// Of an arm, measured along x.
const STROKE: f64 = 0.29;
const DEPTH: f64 = 0.3;
/// Radius of the rounded edges.
const ROUND: f64 = 0.045;
/// Steps of a quarter-round.
const STEPS: u32 = 4;

/// The letter X.
pub(crate) fn x() -> Model {
    let (w, h, s) = (WIDTH, HEIGHT, STROKE);
    // Where an arm's edge, which crosses w - s on its way down, has gone `across`.
    let down = |across: f64| h - h * across / (w - s);
    let notch = w / 2.0 - s;
    let outline = [
        [0.0, h],
        [(w - s) / 2.0, h / 2.0],
        [0.0, 0.0],
        [s, 0.0],
        [w / 2.0, h - down(notch)],
        [w - s, 0.0],
        [w, 0.0],
        [(w + s) / 2.0, h / 2.0],
        [w, h],
        [w - s, h],
        [w / 2.0, down(notch)],
        [s, h],
    ];
    extruded(
        &outline,
        &[&[0, 1, 10, 11], &[1, 2, 3, 4], &[4, 5, 6, 7], &[7, 8, 9, 10], &[1, 4, 7, 10]],
    )
}

/// The letter Y.
pub(crate) fn y() -> Model {
    let (w, h, s) = (WIDTH, HEIGHT, STROKE);
    let stem = 0.85 * s;
    let fork = 0.46 * h;
    let (left, right) = ((w - stem) / 2.0, (w + stem) / 2.0);
    // The arms' inner edges run parallel to their outer ones.
    let notch = h - (h - fork) * (w / 2.0 - s) / left;
    let outline = [
        [0.0, h],
        [left, fork],
        [left, 0.0],
        [right, 0.0],
        [right, fork],
        [w, h],
        [w - s, h],
        [w / 2.0, notch],
        [s, h],
    ];
    extruded(&outline, &[&[0, 1, 7, 8], &[1, 2, 3, 4], &[4, 5, 6, 7], &[1, 4, 7]])
}

/// A solid from a counter-clockwise outline in (x, z) and its division into convex parts.
fn extruded(outline: &[Flat], parts: &[&[usize]]) -> Model {
    let count = outline.len();
    let at = |i: usize| outline[i % count];
    // Outward normal of the edge from corner i to the next.
    let outward = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        let (dx, dz) = (b[0] - a[0], b[1] - a[1]);
        let length = (dx * dx + dz * dz).sqrt();
        [dz / length, -dx / length]
    };
    // A corner moved so that both its edges move inwards by one unit.
    let mitre = |i: usize| {
        let (p, q) = (outward(i + count - 1), outward(i));
        let scale = -1.0 / (1.0 + p[0] * q[0] + p[1] * q[1]);
        [(p[0] + q[0]) * scale, (p[1] + q[1]) * scale]
    };
    let place = |i: usize, inset: f64, y: f64| -> Point {
        let (p, m) = (at(i), mitre(i % count));
        [p[0] + m[0] * inset - WIDTH / 2.0, y, p[1] + m[1] * inset]
    };

    let mut model = Model::default();
    for (y, facing) in [(-DEPTH / 2.0, -1.0), (DEPTH / 2.0, 1.0)] {
        for part in parts {
            let corner =
                |&i: &usize| model.vertex_with_normal(place(i, ROUND, y), [0.0, facing, 0.0]);
            let mut face: Vec<u32> = part.iter().map(corner).collect();
            if facing > 0.0 {
                face.reverse();
            }
            model.faces.push(face);
        }
    }
    // Each edge has its own vertices, so that corners stay sharp.
    for i in 0..count {
        let n = outward(i);
        let rows: Vec<[u32; 2]> = profile()
            .iter()
            .map(|&(inset, y, [out, along])| {
                let normal = [n[0] * out, along, n[1] * out];
                [i, i + 1].map(|k| model.vertex_with_normal(place(k, inset, y), normal))
            })
            .collect();
        for pair in rows.windows(2) {
            model.faces.push(vec![pair[0][0], pair[1][0], pair[1][1], pair[0][1]]);
        }
    }
    model
}

/// From the front face round to the back: inset, y, and the normal as (outward, along y).
fn profile() -> Vec<(f64, f64, [f64; 2])> {
    let quarter = (0..=STEPS).map(|k| {
        // Rational points of the circle, by the tangent of the half angle; 0 to tan(pi/8) twice
        // would be even steps, plain fractions are even enough.
        let t = f64::from(k) / f64::from(STEPS);
        let d = 1.0 + t * t;
        [2.0 * t / d, (1.0 - t * t) / d]
    });
    let front: Vec<_> = quarter
        .map(|[s, c]| ((1.0 - s) * ROUND, -DEPTH / 2.0 + (1.0 - c) * ROUND, [s, -c]))
        .collect();
    let back = front.iter().rev().map(|&(inset, y, [s, c])| (inset, -y, [s, -c]));
    front.iter().copied().chain(back).collect()
}
