//! Surfaces that coincide: which one of them is there.
//!
//! An emitter in the plane of the ceiling, a decal on a wall, a disk that stands on the floor: two
//! surfaces that share an area are hit at distances that differ by rounding alone, and which of them
//! a ray finds would be chance. **The rule, for every ray:** where surfaces coincide, one that emits
//! is in front; of several alike the one with the lowest primitive index, which is the first in the
//! file among triangles, among spheres and among cylinders. What is behind is not there: rays hit
//! the one in front, and no point of the one behind is sampled as a light. So sampling lights,
//! sampling the BRDF and both together have one mean.
//!
//! Pairs are [found](find) once, when the tree is built. Scenes without any, which is nearly all,
//! pay one test of a flag.

mod find;
mod overlap;

use super::accel::primitive_bounds;
use super::ray_origin::UNIT_ROUNDOFF;
use super::triangle::{self, ShearedRay, TrianglePack8};
use super::{Geometry, Hit, Kind, Ray};
use crate::math::V3;
use crate::math::simd::{F32x8, Simd8};
pub(crate) use find::find;
use overlap::APART;

/// How far from a surface a point that was computed on it may be, as a multiple of the largest
/// number that took part.
const NEAR: f32 = 96.0 * UNIT_ROUNDOFF;

/// What is in front of which primitives, where they coincide.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coincident {
    /// Primitives that have something in front of them, in order, and where in `fronts` theirs end.
    behind: Vec<(u32, u32)>,
    /// What is in front of each, the foremost first.
    fronts: Vec<u32>,
    /// A bit for the last digits of each of `behind`: nearly all hits are none of these.
    filter: [u64; 16],
    /// Surfaces are in each other's boxes in such numbers that the search was given up.
    pub(crate) given_up: bool,
}

impl Coincident {
    /// From pairs of the primitive in front and the one behind, in any order.
    fn from_pairs(mut pairs: Vec<[u32; 2]>, rank: &dyn Fn(u32) -> (bool, u32)) -> Coincident {
        pairs.sort_unstable_by_key(|&[front, behind]| (behind, rank(front)));
        pairs.dedup();
        let mut all = Coincident::default();
        for [front, behind] in pairs {
            all.fronts.push(front);
            all.filter[behind as usize / 64 % 16] |= 1 << (behind % 64);
            let end = all.fronts.len() as u32;
            match all.behind.last_mut() {
                Some(last) if last.0 == behind => last.1 = end,
                _ => all.behind.push((behind, end)),
            }
        }
        all
    }

    /// Whether nothing coincides.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.behind.is_empty()
    }

    /// Whether something may be in front of a primitive; false for certain, true by chance at times.
    #[inline(always)]
    pub(super) fn may_be_behind(&self, primitive: u32) -> bool {
        self.filter[primitive as usize / 64 % 16] >> (primitive % 64) & 1 != 0
    }

    /// What is in front of a primitive somewhere, the foremost first.
    pub(crate) fn fronts(&self, primitive: u32) -> &[u32] {
        let Ok(at) = self.behind.binary_search_by_key(&primitive, |(behind, _)| *behind) else {
            return &[];
        };
        let start = at.checked_sub(1).map_or(0, |before| self.behind[before].1);
        &self.fronts[start as usize..self.behind[at].1 as usize]
    }

    /// A bound on the error of surface points by which what leaves one of two surfaces that coincide
    /// is off both.
    pub(super) fn least_error(&self, geometry: &Geometry) -> f32 {
        let reach = |primitive: u32| {
            let [low, high] = primitive_bounds(geometry, primitive);
            low.abs().max(high.abs()).max_component()
        };
        let largest = self.pairs().flatten().map(reach).fold(0.0, f32::max);
        1.25 * APART as f32 * largest
    }

    /// All pairs: in front, behind.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.behind
            .iter()
            .flat_map(|&(behind, _)| self.fronts(behind).iter().map(move |&front| [front, behind]))
    }

    /// What is in front where a ray hit something.
    #[cold]
    #[inline(never)]
    pub(super) fn foremost(&self, geometry: &Geometry, ray: &Ray, hit: Hit) -> Hit {
        let fronts = self.fronts(hit.primitive);
        if fronts.is_empty() {
            return hit;
        }
        let p = ray.at(hit.t);
        let largest = p.abs().max_component().max(ray.o.abs().max_component()).max(1.0);
        let near = NEAR * largest;
        let is_triangle = matches!(geometry.kind(hit.primitive), Kind::Triangle(_));
        let sheared = ShearedRay::new(ray.o, ray.d);
        let met = |&front: &u32| match geometry.kind(front) {
            Kind::Triangle(_) => {
                let (t, b) = through(geometry, front, &sheared)?;
                // A cylinder's side is elsewhere.
                let here = is_triangle || off_plane(geometry, front, p) <= near;
                here.then_some(Hit { t, primitive: front, b })
            }
            _ => is_on(geometry, front, (p, is_triangle), near)
                .then_some(Hit { primitive: front, ..hit }),
        };
        fronts.iter().find_map(met).unwrap_or(hit)
    }

    /// Whether a point `p` of a primitive, where its normal is `ng`, is behind another one.
    pub(crate) fn is_behind(&self, geometry: &Geometry, primitive: u32, p: V3, ng: V3) -> bool {
        let is_triangle = matches!(geometry.kind(primitive), Kind::Triangle(_));
        let covers = |&front: &u32| match geometry.kind(front) {
            Kind::Triangle(_) => {
                let across = ShearedRay::new(p + ng, -ng);
                let here = is_triangle || off_plane(geometry, front, p) <= NEAR;
                here && through(geometry, front, &across).is_some()
            }
            // Spheres coincide as a whole.
            Kind::Sphere(_) => true,
            Kind::Cylinder(_) => is_on(geometry, front, (p, is_triangle), NEAR),
        };
        self.fronts(primitive).iter().any(covers)
    }
}

/// Distance and weights of a triangle that a ray passes through.
fn through(geometry: &Geometry, triangle: u32, ray: &ShearedRay) -> Option<(f32, [f32; 2])> {
    let pack = TrianglePack8::of(geometry, &[triangle]);
    let hits = triangle::intersect::<F32x8>(&pack, ray, f32::INFINITY)?;
    (hits.mask & 1 != 0).then(|| (hits.t.store()[0], hits.b.map(|b| b.store()[0])))
}

/// How far a point is from the plane of a triangle.
fn off_plane(geometry: &Geometry, triangle: u32, p: V3) -> f32 {
    let Kind::Triangle(i) = geometry.kind(triangle) else { return f32::INFINITY };
    let [a, b, c] = geometry.corners(i);
    (b - a).cross(c - a).normalize().dot(p - a).abs()
}

/// Whether a point is on a sphere or cylinder, to within `near`. Of what is `flat` no point is on a
/// cylinder's side: its cap would have a brim.
fn is_on(geometry: &Geometry, primitive: u32, (p, flat): (V3, bool), near: f32) -> bool {
    match geometry.kind(primitive) {
        Kind::Sphere(i) => {
            let sphere = &geometry.spheres[i];
            ((p - sphere.centre).length() - sphere.radius).abs() <= near
        }
        Kind::Cylinder(i) => {
            let cylinder = &geometry.cylinders[i];
            let (height, across) = cylinder.height_and_distance(p);
            let on_cap = height.abs().min((height - cylinder.height).abs()) <= near;
            let on_side = !flat && (across - cylinder.radius).abs() <= near;
            let within = height >= -near && height <= cylinder.height + near;
            (on_cap && across <= cylinder.radius) || (on_side && within)
        }
        Kind::Triangle(_) => false,
    }
}
