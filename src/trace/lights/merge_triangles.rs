//! Emitters are modelled as rectangles and stored as triangles: two that make a parallelogram are one
//! light.

use crate::geometry::Geometry;
use crate::math::V3;
use std::collections::HashMap;

/// How far the fourth corner may be from where the others put it, in parts of the shorter side, and
/// in the scene's units: less than what a surface point's own error bound allows for.
const FLAT: [f32; 2] = [2e-5, 2.0 * f32::EPSILON];

/// A flat light: points `corner + u a + v b`, over the unit square or its lower half.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlatLight {
    pub(super) corner: V3,
    pub(super) sides: [V3; 2],
    /// The triangles; a triangle alone is there twice.
    pub(super) triangles: [u32; 2],
}

impl FlatLight {
    pub(super) fn is_pair(&self) -> bool {
        self.triangles[0] != self.triangles[1]
    }

    /// Area of the whole parallelogram, or of the triangle.
    pub(super) fn area(&self) -> f32 {
        let whole = self.sides[0].cross(self.sides[1]).length();
        if self.is_pair() { whole } else { 0.5 * whole }
    }
}

/// The triangles of a range as flat lights, in order of their first triangles.
pub(super) fn merge_triangles(geometry: &Geometry, first: u32, count: u32) -> Vec<FlatLight> {
    // By side, whoever is still alone.
    let mut waiting: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
    let mut flats: Vec<FlatLight> = Vec::new();
    let mut place: HashMap<u32, usize> = HashMap::new();
    for triangle in first..first + count {
        let corners = geometry.corners(triangle as usize);
        let partner = (0..3).find_map(|i| {
            let other = *waiting.get(&side(corners[(i + 1) % 3], corners[(i + 2) % 3]))?;
            let pair = parallelogram(corners, i, geometry.corners(other as usize))?;
            Some((other, pair))
        });
        match partner {
            Some((other, (corner, sides))) => {
                forget(&mut waiting, geometry.corners(other as usize), other);
                let at = place[&other];
                flats[at] = FlatLight { corner, sides, triangles: [other, triangle] };
            }
            None => {
                let [a, b, c] = corners;
                place.insert(triangle, flats.len());
                let sides = [b - a, c - a];
                flats.push(FlatLight { corner: a, sides, triangles: [triangle; 2] });
                for i in 0..3 {
                    waiting.entry(side(corners[i], corners[(i + 1) % 3])).or_insert(triangle);
                }
            }
        }
    }
    flats
}

/// The same for both directions.
fn side(a: V3, b: V3) -> [[u32; 3]; 2] {
    let mut ends = [a, b].map(|p| <[f32; 3]>::from(p).map(f32::to_bits));
    ends.sort_unstable();
    ends
}

fn forget(waiting: &mut HashMap<[[u32; 3]; 2], u32>, corners: [V3; 3], triangle: u32) {
    for i in 0..3 {
        let key = side(corners[i], corners[(i + 1) % 3]);
        if waiting.get(&key) == Some(&triangle) {
            waiting.remove(&key);
        }
    }
}

/// Corner and sides of the parallelogram that a triangle makes with another across the side that
/// faces its corner `i`, if it makes one.
fn parallelogram(corners: [V3; 3], i: usize, other: [V3; 3]) -> Option<(V3, [V3; 2])> {
    let (a, b, c) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
    let far = other.into_iter().find(|p| *p != b && *p != c)?;
    let sides = [b - a, c - a];
    let off = (b + c - a - far).abs().max_component();
    let shorter = sides[0].length2().min(sides[1].length2()).sqrt();
    (off <= (FLAT[0] * shorter).min(FLAT[1])).then_some((a, sides))
}
