//! A wentletrap: the staircase shell, a tube that winds about an axis and grows as it goes, with
//! a thin rib wherever its mouth once rested.
//!
//! Growth is self-similar (a logarithmic spiral): after each turn the shell is a turned and
//! scaled copy of itself. `u` counts turns along the tube up to the mouth at 0, `v` turns around
//! it: 0 away from the axis, a quarter towards the tip.

use super::arithmetic::{cos_sin, exp};
use super::model::{Model, Point};

/// Natural logarithm of the growth in one turn.
const GROWTH: f64 = 0.4;
const TURNS: i32 = 7;
const RIBS_PER_TURN: i32 = 10;
/// Points around the tube.
const AROUND: u32 = 40;
/// Distances at the mouth, in radii of the tube: its centre from the axis and below the tip.
const FROM_AXIS: f64 = 1.04;
const BELOW_TIP: f64 = 4.55;
/// Radius of the inner wall.
const INNER: f64 = 0.84;
/// Places across a rib, in distances between ribs: close together where it is steep.
const ACROSS_RIB: [f64; 10] = [-0.2, -0.12, -0.07, -0.035, 0.0, 0.035, 0.07, 0.12, 0.2, 0.5];

/// A ring of points around the tube.
struct Ring {
    /// Where the tube stands, in turns.
    u: f64,
    /// Radius without ornament, in radii of the tube there.
    radius: f64,
    /// Height of the rib here, 0..=1.
    rib: f64,
}

/// The shell, one unit high, standing on z = 0 with the tip up, its mouth towards -y.
pub(crate) fn wentletrap() -> Model {
    let mut model = Model::default();
    let rings = rings();
    let first = model.vertex(axis_of_tube(rings[0].u));
    let rows: Vec<Vec<u32>> = rings
        .iter()
        .map(|ring| (0..AROUND).map(|j| model.vertex(point(ring, j))).collect())
        .collect();
    let last = model.vertex(axis_of_tube(rings[rings.len() - 1].u));

    let next = |j: usize| (j + 1) % AROUND as usize;
    for j in 0..AROUND as usize {
        model.faces.push(vec![first, rows[0][next(j)], rows[0][j]]);
        for pair in rows.windows(2) {
            let (a, b, k) = (&pair[0], &pair[1], next(j));
            model.faces.push(vec![a[j], b[k], b[j]]);
            model.faces.push(vec![a[j], a[k], b[k]]);
        }
        let end = &rows[rows.len() - 1];
        model.faces.push(vec![last, end[j], end[next(j)]]);
    }
    stand(&mut model.positions);
    model
}

/// Outside from the tip to the mouth, around the lip, and back along the inside.
fn rings() -> Vec<Ring> {
    let mut rings = Vec::new();
    // The tip: the tube closes in a dome.
    let start = -f64::from(TURNS);
    for [c, s] in [0.06, 0.12, 0.18].map(cos_sin) {
        rings.push(Ring { u: start - 0.13 * c, radius: s, rib: 0.0 });
    }
    let between = 1.0 / f64::from(RIBS_PER_TURN);
    for k in 0..TURNS * RIBS_PER_TURN {
        for across in ACROSS_RIB {
            let u = start + (f64::from(k) + 0.5 + across) * between;
            // The first turn and a half, hatched from the egg, is smooth.
            let age = ((u - start - 1.2) / 1.0).clamp(0.0, 1.0);
            rings.push(Ring { u, radius: 1.0, rib: rib(across) * age * age * (3.0 - 2.0 * age) });
        }
    }
    // The lip: a last, thicker rib that turns in. Each line is u, radius, rib.
    let lip = [
        (0.016, 1.00, 0.25),
        (0.026, 1.02, 0.75),
        (0.034, 1.03, 1.0),
        (0.042, 1.03, 1.05),
        (0.049, 1.02, 0.95),
        (0.053, 1.0, 0.7),
        (0.054, 0.98, 0.4),
        (0.052, 0.95, 0.15),
        (0.047, 0.91, 0.04),
        (0.038, 0.875, 0.0),
        (0.024, 0.85, 0.0),
    ];
    rings.extend(lip.map(|(u, radius, rib)| Ring { u, radius, rib }));
    // The inside, seen as far as light finds its way, then a floor across the tube.
    rings.extend((0..24).map(|k| Ring { u: -0.025 * f64::from(k), radius: INNER, rib: 0.0 }));
    rings.extend([0.55, 0.25].map(|radius| Ring { u: -0.58, radius, rib: 0.0 }));
    rings
}

/// Height of a rib at a distance from its crest, in distances between ribs.
fn rib(across: f64) -> f64 {
    let x = across / 0.1;
    let bell = 1.0 / (1.0 + x * x);
    bell * bell
}

/// The middle of the tube.
fn axis_of_tube(u: f64) -> Point {
    let s = exp(GROWTH * u);
    let [c, sin] = around_axis(u);
    [FROM_AXIS * s * c, FROM_AXIS * s * sin, -BELOW_TIP * s]
}

/// Direction from the shell's axis: winding clockwise seen from the tip, as nearly all shells do.
fn around_axis(u: f64) -> [f64; 2] {
    cos_sin(-u - 0.06)
}

fn point(ring: &Ring, j: u32) -> Point {
    let v = f64::from(j) / f64::from(AROUND);
    let [out, up] = cos_sin(v);
    // Ribs are high on the shoulder, where they end in a small point, and low at the seams.
    let shoulder = (v - 0.12) / 0.045;
    let crest = 0.14 + 0.15 * (1.0 + out) / 2.0 + 0.14 / (1.0 + shoulder * shoulder);
    let radius = ring.radius + crest * ring.rib;
    // Ribs lean: their lower ends lie further along the tube, their crests bend back.
    let u = ring.u - 0.02 * up - 0.012 * ring.rib * (1.0 + out) / 2.0;
    let s = exp(GROWTH * u);
    let [c, sin] = around_axis(u);
    let r = s * (FROM_AXIS + radius * out);
    [r * c, r * sin, s * (radius * up - BELOW_TIP)]
}

/// Moves and scales the points to stand on z = 0 with height 1.
fn stand(points: &mut [Point]) {
    let low = points.iter().fold(f64::INFINITY, |a, p| a.min(p[2]));
    let high = points.iter().fold(f64::NEG_INFINITY, |a, p| a.max(p[2]));
    for p in points {
        *p = [p[0] / (high - low), p[1] / (high - low), (p[2] - low) / (high - low)];
    }
}
