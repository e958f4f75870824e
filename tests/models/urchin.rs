//! A sea urchin without its spines: a hollow, flattened ball with a hole above and one below, and
//! on it the knobs that carried the spines, in ten pairs of columns.
//!
//! `m` is the height on the ball as on Mercator's map, on which shapes stay what they are and grow
//! with the width of the parallel: as the knobs of an urchin do, large at the waist and small
//! towards the holes. `turn` counts around the axis.

use super::arithmetic::{cos_sin, exp};
use super::model::{Model, Point};
use std::f64::consts::TAU;

/// Points around the axis; a multiple of ten, so that all sectors are alike.
const AROUND: u32 = 290;
/// The map's upper and lower edge: where the holes are.
const EDGES: [f64; 2] = [2.35, -1.75];
/// Rows of points on the outside: as far from one another on the map as the points around.
const ROWS: u32 = 190;
/// Rows on each rim and inside.
const RIM: u32 = 8;
const INSIDE: u32 = 16;
/// Of the wall, in radii of the ball.
const THICKNESS: f64 = 0.045;
/// Half the height of the ball above its waist and below, in radii.
const FLAT: [f64; 2] = [0.66, 0.52];

/// A row of points around the axis.
struct Ring {
    m: f64,
    /// Below the outside, in radii of the ball.
    depth: f64,
    /// Whether it carries knobs, 0..=1.
    knobs: f64,
}

/// The urchin, one unit wide, standing on z = 0 with the smaller hole up.
pub(crate) fn urchin() -> Model {
    let mut model = Model::default();
    let rows: Vec<Vec<u32>> = rings()
        .iter()
        .map(|ring| (0..AROUND).map(|j| model.vertex(point(ring, j))).collect())
        .collect();
    // A ring of rings: down the outside, round the lower rim, up the inside, round the upper rim.
    for (i, a) in rows.iter().enumerate() {
        let b = &rows[(i + 1) % rows.len()];
        for j in 0..AROUND as usize {
            let k = (j + 1) % AROUND as usize;
            model.faces.push(vec![a[j], b[j], b[k], a[k]]);
        }
    }
    stand(&mut model.positions);
    model
}

fn rings() -> Vec<Ring> {
    let [top, bottom] = EDGES;
    let between = |a: f64, b: f64, i: u32, n: u32| a + (b - a) * f64::from(i) / f64::from(n);
    let mut rings = Vec::new();
    for i in 0..ROWS {
        let m = between(top, bottom, i, ROWS - 1);
        // Knobs end before the rims.
        let room = ((top - m).min(m - bottom) / 0.18).min(1.0);
        rings.push(Ring { m, depth: 0.0, knobs: room * room * (3.0 - 2.0 * room) });
    }
    rings.extend(rim(bottom, -1.0));
    for i in 0..INSIDE {
        rings.push(Ring { m: between(bottom, top, i, INSIDE - 1), depth: THICKNESS, knobs: 0.0 });
    }
    let mut upper = rim(top, 1.0);
    upper.reverse();
    rings.extend(upper);
    rings
}

/// Half a circle from the outside to the inside around the edge at `m`.
fn rim(m: f64, away: f64) -> Vec<Ring> {
    let half = THICKNESS / 2.0;
    let step = |i: u32| {
        let [c, s] = cos_sin(f64::from(i) / f64::from(2 * (RIM + 1)));
        Ring { m: m + away * s * half / parallel(m)[0], depth: half * (1.0 - c), knobs: 0.0 }
    };
    (1..=RIM).map(step).collect()
}

/// Radius and height of the parallel at `m` on a ball of radius 1.
fn parallel(m: f64) -> [f64; 2] {
    let (e, f) = (exp(m), exp(-m));
    [2.0 / (e + f), (e - f) / (e + f)]
}

fn point(ring: &Ring, j: u32) -> Point {
    let turn = f64::from(j) / f64::from(AROUND);
    let [c, s] = cos_sin(turn);
    let [radius, height] = parallel(ring.m);
    let flat = FLAT[usize::from(height < 0.0)];
    // Outward, across the flattened ball.
    let (out, up) = (radius, height / flat);
    let length = (out * out + up * up).sqrt();
    // Five broad ribs and five furrows, and what stands on them.
    let wave = 0.035 * cos_sin(5.0 * turn)[0];
    let raised = radius * (wave + ring.knobs * ornament(turn, ring.m)) - ring.depth;
    let r = radius + raised * out / length;
    [r * c, r * s, flat * height + raised * up / length]
}

/// Height of the knobs and seams at a place on the map, in radii of the parallel there.
fn ornament(turn: f64, m: f64) -> f64 {
    // Radians from the middle of the nearest broad rib: up to a tenth of a turn to both sides.
    let x = ((5.0 * turn + 0.5).fract() - 0.5) * TAU / 5.0;
    // The two columns of a pair are half a step apart.
    let stagger = if x < 0.0 { 0.5 } else { 0.0 };
    let x = x.abs();
    let column = |at: f64, radius: f64, step: f64, shift: f64| {
        let place = m / step + shift + stagger;
        let dm = (place - place.round()) * step;
        let dx = x - at;
        radius * knob((dx * dx + dm * dm) / (radius * radius))
    };
    let large = column(0.185, 0.165, 0.35, 0.0);
    let small = column(0.497, 0.085, 0.175, 0.25);
    // Beads along the seams between.
    let beads = column(0.372, 0.047, 0.0875, 0.0) + 0.8 * column(0.03, 0.047, 0.175, 0.25);
    let seam = |at: f64, width: f64| {
        let d = (x - at) / width;
        1.0 / (1.0 + d * d)
    };
    large + small + beads - 0.012 * seam(0.628, 0.02) - 0.008 * seam(0.0, 0.02)
}

/// Height of a knob over its radius, by the square of the distance from its middle in radii: a low
/// mound, and on it the ball on which the spine turned.
fn knob(d2: f64) -> f64 {
    let mound = (1.0 - d2).max(0.0);
    let ball = (1.0 - d2 / 0.12).max(0.0).sqrt();
    0.24 * mound * mound + 0.15 * ball
}

/// Moves and scales the points to stand on z = 0 with width 1.
fn stand(points: &mut [Point]) {
    let low = points.iter().fold(f64::INFINITY, |a, p| a.min(p[2]));
    let wide = points.iter().fold(0.0f64, |a, p| a.max(p[0] * p[0] + p[1] * p[1])).sqrt();
    for p in points {
        *p = [p[0] / (2.0 * wide), p[1] / (2.0 * wide), (p[2] - low) / (2.0 * wide)];
    }
}
