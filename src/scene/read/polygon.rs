//! Polygons of any form become triangles.
//!
//! A polygon is looked at along the normal of its mean plane (Newell's). Where a fan around the
//! first corner covers it once, that is taken; where a small one has another such corner, the fan
//! around that. Such fans leave out no corner, so neighbours of the polygon stay watertight. The
//! others are cut by ear clipping, which holds for every outline that does not cross itself.

mod crossing;

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// What became of one polygon.
pub(super) struct Triangles {
    /// Numbers of corners, three a triangle, turning as the polygon does.
    pub(super) indices: Vec<[u32; 3]>,
    /// True where the outline crosses or doubles itself, so that the triangles may overlap.
    pub(super) self_crossing: bool,
}

/// The sine below which two edges count as one line.
const FLAT: f64 = 1e-12;

/// Polygons up to this size are tried from every corner.
const FEW: usize = 8;

/// Ear clipping of an outline that crosses itself takes the cube of its corners; larger ones, and
/// bow ties, of which it would leave a half, become fans.
const FEW_CROSSING: usize = 64;

/// Triangles that cover the polygon with these corners. Corners that are not finite, and polygons
/// without area, give a fan whose triangles the scene then leaves out and counts.
pub(super) fn triangulate(corners: &[DVec3]) -> Triangles {
    let simple = |indices| Triangles { indices, self_crossing: false };
    if corners.len() <= 3 {
        return simple(fan(corners.len(), 0));
    }
    let Some((outline, has_side)) = flattened(corners) else {
        return simple(fan(corners.len(), 0));
    };
    let tried = if outline.len() <= FEW { outline.len() } else { 1 };
    if let Some(first) = (0..tried).find(|&first| has_side && fan_covers(&outline, first)) {
        return simple(fan(outline.len(), first));
    }
    let crosses = crossing::crosses(&outline);
    let crossed = || Triangles { indices: fan(outline.len(), 0), self_crossing: true };
    let odd = crosses || !has_side;
    if odd && (outline.len() == 4 || outline.len() > FEW_CROSSING) {
        return crossed();
    }
    let mut indices: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(outline.iter().map(|p| p.to_array()), &[], &mut indices);
    let mut covered = 0.0;
    let mut triangles = Vec::with_capacity(indices.len() / 3);
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| outline[i as usize]);
        let area = (b - a).perp_dot(c - a);
        covered += area.abs();
        triangles.push(if area < 0.0 { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] });
    }
    if triangles.is_empty() {
        return crossed();
    }
    let area: f64 = (1..outline.len() - 1).map(|i| turn(&outline, 0, i)).sum();
    // Of an outline that crosses itself, parts count negative or twice.
    let exact = (covered - area).abs() <= 1e-10;
    Triangles { indices: triangles, self_crossing: odd || !exact }
}

/// The fan around this corner of a polygon of `count` corners.
fn fan(count: usize, first: usize) -> Vec<[u32; 3]> {
    let corner = |i: usize| ((first + i) % count) as u32;
    (1..count.saturating_sub(1)).map(|i| [corner(0), corner(i), corner(i + 1)]).collect()
}

/// The polygon within its mean plane, of about unit size and turning left, and whether it has a
/// side at all: the halves of an eight cancel, and any plane then serves. `None` without a plane.
fn flattened(corners: &[DVec3]) -> Option<(Vec<DVec2>, bool)> {
    let origin = corners[0];
    let size = corners.iter().map(|&p| (p - origin).abs().max_element()).fold(0.0, f64::max);
    let local: Vec<DVec3> = corners.iter().map(|&p| (p - origin) / size).collect();
    if !local.iter().all(|p| p.is_finite()) {
        return None;
    }
    let (mut sum, mut largest, mut sizes) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for edge in local.windows(2) {
        let n = edge[0].cross(edge[1]);
        sum += n;
        sizes += n.length();
        if n.length() > largest.length() {
            largest = n;
        }
    }
    let has_side = sum.length() > FLAT * sizes;
    let normal = if has_side { sum } else { largest }.try_normalize()?;
    let (x, y) = normal.any_orthonormal_pair();
    let outline = local.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect();
    Some((outline, has_side))
}

/// Twice the signed area of the triangle of corner `first` and the edge that begins `i` further on.
fn turn(outline: &[DVec2], first: usize, i: usize) -> f64 {
    let corner = |i: usize| outline[(first + i) % outline.len()];
    (corner(i) - corner(0)).perp_dot(corner(i + 1) - corner(0))
}

/// True when the triangles of the fan around this corner all have area, turn the polygon's way and
/// go round less than once: then they cover it exactly.
fn fan_covers(outline: &[DVec2], first: usize) -> bool {
    let corner = |i: usize| outline[(first + i) % outline.len()] - outline[first];
    let mut angle = 0.0;
    for i in 1..outline.len() - 1 {
        let (a, b) = (corner(i), corner(i + 1));
        let sine = turn(outline, first, i);
        if sine <= FLAT * a.length_squared().max(b.length_squared()) {
            return false;
        }
        angle += sine.atan2(a.dot(b));
    }
    angle < TAU - 1e-9
}

#[cfg(test)]
mod tests;
