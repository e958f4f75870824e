//! Which faces of a scene are large quads: the largest triangles, joined two by two where they make a
//! convex quadrilateral.

use super::{Line, MAX_QUADS, Quad, Sides, Strip};
use crate::geometry::ray_origin::UNIT_ROUNDOFF;
use crate::geometry::{Geometry, Kind};
use crate::math::V3;
use glam::DVec3;

/// Scenes of so few triangles are large quads altogether.
const FEW: usize = 128;
/// Otherwise triangles of at least this part of half the surface of the scene's box are.
const LARGE: f64 = 1.0 / 256.0;
/// A triangle's longest side squared over twice its area is at most this: of slender ones distances
/// are not known well enough.
const SLENDER: f64 = 512.0;
/// Corners of a four-sided large quad lie in its plane to within this.
pub(super) const FLAT: f64 = 4.0 * UNIT_ROUNDOFF as f64;

/// The large quads of a scene, in order of the larger of their triangles.
pub(super) fn pick(geometry: &Geometry) -> Vec<Quad> {
    let mut candidates = candidates(geometry);
    candidates.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangle.cmp(&b.triangle)));
    candidates.truncate(2 * MAX_QUADS);
    let mut quads = Vec::new();
    let mut used = vec![false; candidates.len()];
    for i in 0..candidates.len() {
        if used[i] || quads.len() == MAX_QUADS {
            continue;
        }
        used[i] = true;
        let partner = (i + 1..candidates.len()).find_map(|j| {
            let quad = (!used[j]).then(|| quad(&candidates[i], &candidates[j]))??;
            Some((j, quad))
        });
        quads.push(match partner {
            Some((j, quad)) => {
                used[j] = true;
                quad
            }
            None => alone(&candidates[i]),
        });
    }
    quads
}

struct Candidate {
    triangle: u32,
    corners: [DVec3; 3],
    /// Not normalised.
    normal: DVec3,
    area: f64,
    slenderness: f64,
}

fn candidates(geometry: &Geometry) -> Vec<Candidate> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for vertex in geometry.vertices() {
        let p = wide(V3::from(vertex.position));
        (low, high) = (low.min(p), high.max(p));
    }
    let size = (high - low).max(DVec3::ZERO);
    let box_area = size.x * size.y + size.y * size.z + size.z * size.x;
    let least = if geometry.faces().len() <= FEW { 0.0 } else { LARGE * box_area };
    let candidate = |triangle: usize| {
        let corners = geometry.corners(triangle).map(wide);
        let sides = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).length_squared());
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = 0.5 * normal.length();
        let slenderness = sides.into_iter().fold(0.0, f64::max) / (2.0 * area);
        let triangle = triangle as u32;
        let fits = area > 0.0 && area >= least && slenderness <= SLENDER;
        fits.then_some(Candidate { triangle, corners, normal, area, slenderness })
    };
    (0..geometry.faces().len()).filter_map(candidate).collect()
}

pub(super) fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

pub(super) fn narrow(v: DVec3) -> V3 {
    V3::from(v.as_vec3().to_array())
}

/// The line through two points of a plane, `n` its unit normal: inwards where the corners run
/// counter-clockwise about it.
fn edge(n: DVec3, a: DVec3, b: DVec3) -> Line {
    let m = n.cross(b - a).normalize();
    Line { m: narrow(m), c: m.dot(a) as f32 }
}

/// The strip between two edges, if they are parallel.
fn strip(n: DVec3, [a, b]: [DVec3; 2], far: [DVec3; 2]) -> Option<Strip> {
    let m = n.cross(b - a).normalize();
    let [near, other] = [[a, b], far].map(|ends| ends.map(|p| m.dot(p)));
    let (c, width) = (near[0], 0.5 * (other[0] + other[1]) - near[0]);
    let parallel = other.iter().all(|x| (x - c - width).abs() <= FLAT);
    let middle = Line { m: narrow(m), c: (c + 0.5 * width) as f32 };
    parallel.then_some(Strip { middle, half: (0.5 * width) as f32 })
}

/// The edges between corners that run counter-clockwise about `n`.
fn sides(n: DVec3, [a, b, c, e]: [DVec3; 4]) -> Sides {
    match (strip(n, [a, b], [c, e]), strip(n, [b, c], [e, a])) {
        (Some(one), Some(other)) => Sides::Parallelogram([one, other]),
        (Some(one), None) => Sides::Trapezoid(one, [edge(n, b, c), edge(n, e, a)]),
        (None, Some(one)) => Sides::Trapezoid(one, [edge(n, a, b), edge(n, c, e)]),
        (None, None) => {
            Sides::Quadrilateral([edge(n, a, b), edge(n, b, c), edge(n, c, e), edge(n, e, a)])
        }
    }
}

fn plane(corners: &[DVec3], normal: DVec3) -> (DVec3, f64) {
    let n = normal.normalize();
    (n, corners.iter().map(|c| n.dot(*c)).sum::<f64>() / corners.len() as f64)
}

fn alone(candidate: &Candidate) -> Quad {
    let [a, b, c] = candidate.corners;
    let (n, d) = plane(&candidate.corners, candidate.normal);
    Quad {
        n: narrow(n),
        d: d as f32,
        sides: Sides::Triangle([edge(n, a, b), edge(n, b, c), edge(n, c, a)]),
        diagonal: None,
        triangles: [candidate.triangle; 2],
        slenderness: candidate.slenderness as f32,
    }
}

/// The convex quadrilateral of two triangles with a common side in one plane, if it is one.
fn quad(first: &Candidate, second: &Candidate) -> Option<Quad> {
    let [p, q] = [&first.corners, &second.corners];
    let lone = |these: &[DVec3; 3], those: &[DVec3; 3]| {
        let mut alone = (0..3).filter(|&i| !those.contains(&these[i]));
        alone.next().filter(|_| alone.next().is_none())
    };
    let (i, j) = (lone(p, q)?, lone(q, p)?);
    // Counter-clockwise about the first triangle's normal, the common side from b to e.
    let (a, b, e, c) = (p[i], p[(i + 1) % 3], p[(i + 2) % 3], q[j]);
    let corners = [a, b, c, e];
    let (n, d) = plane(&corners, first.normal);
    let flat = corners.iter().all(|corner| (n.dot(*corner) - d).abs() <= FLAT);
    let turns = |i: usize| {
        let [before, at, after] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        (at - before).cross(after - at).dot(n)
    };
    let convex = (0..4).all(|i| turns(i) > 1e-3 * first.area.min(second.area));
    if !flat || !convex {
        return None;
    }
    let Line { m, c: across } = edge(n, b, e);
    Some(Quad {
        n: narrow(n),
        d: d as f32,
        sides: sides(n, corners),
        diagonal: Some(Line { m: -m, c: -across }),
        triangles: [first.triangle, second.triangle],
        slenderness: first.slenderness.max(second.slenderness) as f32,
    })
}

/// Whether the whole scene is on one side of the large quad's plane.
pub(super) fn is_on_the_hull(geometry: &Geometry, quad: &Quad) -> bool {
    let (n, d) = (wide(quad.n), f64::from(quad.d));
    let (mut low, mut high) = (0.0f64, 0.0f64);
    let mut extend = |p: V3, by: f32| {
        let height = n.dot(wide(p)) - d;
        low = low.min(height - f64::from(by));
        high = high.max(height + f64::from(by));
    };
    for triangle in 0..geometry.faces().len() {
        geometry.corners(triangle).into_iter().for_each(|p| extend(p, 0.0));
    }
    for primitive in geometry.faces().len()..geometry.len() {
        match geometry.kind(primitive as u32) {
            Kind::Sphere(i) => extend(geometry.spheres[i].centre, geometry.spheres[i].radius),
            Kind::Cylinder(i) => {
                let cylinder = &geometry.cylinders[i];
                let reach = cylinder.radius + cylinder.height;
                extend(cylinder.base, reach);
            }
            Kind::Triangle(_) => {}
        }
    }
    low.max(-high) >= -FLAT
}
