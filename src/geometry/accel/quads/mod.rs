//! The few large flat faces of a scene: tried by as many rays at a time as a register holds, those of
//! the hull as one, those that lie together only if a ray hits the box around them. Walls, floors
//! and boxes are hit by nearly every ray, and a tree only delays that.
//!
//! A quick test decides where it is sure: by more than all rounding errors of its own and of the
//! [exact one](crate::geometry::triangle). Rays that pass too near an edge, or through two faces at nearly the
//! same distance, are marked as open, and the exact test decides about them. So no hit depends on
//! the quick one.

mod hull;
mod quad;
mod select;
#[cfg(test)]
mod tests;

use crate::geometry::Geometry;
use crate::geometry::aabb::PacketSlabs;
use crate::geometry::accel::clusters::{self, Cluster};
use crate::geometry::ray_origin::UNIT_ROUNDOFF;
use crate::math::V3;
use crate::math::simd::{Bits, Mask, SimdWide};
use hull::Hull;
use quad::{Line, Quad, Sides, Strip, Way, dot};

/// A large quad that is none.
pub(super) const NO_QUAD: u32 = u32::MAX;
/// Most large quads of a scene.
pub(super) const MAX_QUADS: usize = 64;
/// Roundings of 1 + the origin's largest coordinate that decisions keep clear of, across a plane.
const CLEARANCE: f32 = 64.0;
/// What is this far to one side of a large quad does not hit it: several times the clearance above for
/// points of the scene, whose coordinates are within 1, and their distance from the surface.
const ASIDE: f32 = 16.0 * CLEARANCE * UNIT_ROUNDOFF;

/// All large quads of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Quads {
    quads: Vec<Quad>,
    /// Those on the convex hull, and the same as one, where that is faster.
    outer: Vec<u32>,
    hull: Option<Hull>,
    /// Those that bodies may lie behind, as seen from between surfaces: not on the convex hull.
    inner: Vec<u32>,
    /// The inner ones that lie together, and the rest of them.
    clusters: Vec<Cluster>,
    lone: Vec<u32>,
    /// The inner ones by component, for [`Quads::between`].
    planes: Box<QuadPlanes>,
    /// The places of large quads among the inner ones, as bits.
    bits: Vec<u64>,
    /// Triangles and their large quads, by triangle.
    quad_of: Vec<(u32, u32)>,
}

/// Planes and bounds of large quads: normal, its product with the points of the plane, lowest and
/// highest corner.
#[derive(Clone, Debug)]
struct QuadPlanes {
    n: [[f32; MAX_QUADS]; 3],
    d: [f32; MAX_QUADS],
    bounds: [[[f32; MAX_QUADS]; 3]; 2],
}

impl Default for QuadPlanes {
    fn default() -> QuadPlanes {
        let zero = [0.0; MAX_QUADS];
        QuadPlanes { n: [zero; 3], d: zero, bounds: [[zero; 3]; 2] }
    }
}

/// What as many rays hit.
pub(super) struct QuadHits<P: SimdWide> {
    /// Distance, roughly; what it was at the start where nothing was hit.
    pub(super) t: P,
    /// How roughly.
    pub(super) within: P,
    /// [`NO_QUAD`] for none.
    pub(super) quad: P::Bits,
    /// The triangle; without meaning where there is no large quad.
    pub(super) triangle: P::Bits,
    /// Where the exact test has to decide.
    pub(super) open: P::Mask,
}

impl Quads {
    /// Picks the large quads out of a scene.
    pub(super) fn new(geometry: &Geometry) -> Quads {
        let quads = select::pick(geometry);
        let mut quad_of: Vec<(u32, u32)> = (0..)
            .zip(&quads)
            .flat_map(|(at, quad)| quad.triangles.map(|triangle| (triangle, at)))
            .collect();
        quad_of.sort_unstable();
        quad_of.dedup();
        let places = 0..quads.len() as u32;
        let (outer, inner): (Vec<u32>, Vec<u32>) =
            places.partition(|&at| select::is_on_the_hull(geometry, &quads[at as usize]));
        let bounds_of = |corners: &mut dyn Iterator<Item = V3>| {
            let start = [f32::INFINITY, f32::NEG_INFINITY].map(V3::splat);
            corners.fold(start, |[low, high], p| [low.min(p), high.max(p)])
        };
        let bounds = |at: u32| {
            let corners = quads[at as usize].triangles.map(|i| geometry.corners(i as usize));
            bounds_of(&mut corners.into_iter().flatten())
        };
        let mut planes = Box::<QuadPlanes>::default();
        for (i, &at) in inner.iter().enumerate() {
            let Quad { n, d, .. } = &quads[at as usize];
            planes.d[i] = *d;
            let [low, high] = bounds(at);
            for axis in 0..3 {
                let of = |v: V3| [v.x, v.y, v.z][axis];
                planes.n[axis][i] = of(*n);
                planes.bounds[0][axis][i] = of(low) - ASIDE;
                planes.bounds[1][axis][i] = of(high) + ASIDE;
            }
        }
        let all = bounds_of(&mut geometry.vertices().iter().map(|v| V3::from(v.position)));
        let pieces: Vec<_> = inner.iter().map(|&at| (at, bounds(at))).collect();
        let (clusters, lone) = clusters::gather(&pieces, all);
        let hull = Hull::new(geometry, &quads, &outer);
        let mut bits = vec![0; quads.len()];
        (0..).zip(&inner).for_each(|(i, &at): (u32, _)| bits[at as usize] = 1 << i);
        Quads { quads, outer, hull, inner, clusters, lone, planes, bits, quad_of }
    }

    /// Which of the inner large quads may be hit on the way from a point to any point of a box, given by
    /// its corners: bit `i` for the `i`th of them. Coordinates are those of surfaces of the scene.
    #[inline(always)]
    pub(super) fn between<P: SimdWide>(&self, p: V3, [low, high]: [V3; 2]) -> u64 {
        let (p_lanes, half) = (p.splat_lanes::<P>(), 0.5);
        let middle = ((low + high) * half).splat_lanes::<P>();
        let reach = ((high - low) * half).splat_lanes::<P>();
        let (lowest, highest) = (low.min(p).splat_lanes::<P>(), high.max(p).splat_lanes::<P>());
        let aside = P::splat(ASIDE);
        let QuadPlanes { n, d, bounds } = &*self.planes;
        let mut found = 0;
        for at in (0..self.inner.len()).step_by(P::WIDTH) {
            let load = |rows: &[[f32; MAX_QUADS]; 3]| {
                V3::new(P::load(&rows[0][at..]), P::load(&rows[1][at..]), P::load(&rows[2][at..]))
            };
            let (n, d) = (load(n), P::load(&d[at..]));
            let (height, centre) = (n.dot(p_lanes) - d, n.dot(middle) - d);
            let spread = n.abs().dot(reach);
            let above = height.min(centre - spread).gt(aside);
            let below = height.max(centre + spread).lt(-aside);
            let (from, to) = (load(&bounds[0]), load(&bounds[1]));
            let apart = from.x.gt(highest.x)
                | from.y.gt(highest.y)
                | from.z.gt(highest.z)
                | to.x.lt(lowest.x)
                | to.y.lt(lowest.y)
                | to.z.lt(lowest.z);
            let may = !(above | below | apart);
            let some = self.inner.len() - at;
            let there = if some >= P::WIDTH { u64::MAX } else { (1 << some) - 1 };
            let lanes = if P::WIDTH == 32 { u64::MAX } else { (1 << P::WIDTH) - 1 };
            found |= (u64::from(may.bits()) & there & lanes) << at;
        }
        found
    }

    /// The bit that [`Quads::between`] has for a large quad, if it has one.
    #[inline(always)]
    pub(super) fn bit_of(&self, quad: u32) -> u64 {
        self.bits.get(quad as usize).copied().unwrap_or(0)
    }

    /// The triangles that belong to large quads, in order.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> {
        self.quad_of.iter().map(|(triangle, _)| *triangle)
    }

    /// The large quad that a primitive belongs to, if any.
    pub(super) fn quad_of(&self, primitive: u32) -> Option<u32> {
        let found = self.quad_of.binary_search_by_key(&primitive, |(triangle, _)| *triangle);
        found.ok().map(|i| self.quad_of[i].1)
    }

    /// The nearest large quads that rays hit, but for the one each leaves from.
    #[inline(always)]
    pub(super) fn closest<P: SimdWide>(
        &self,
        (o, d): (V3<P>, V3<P>),
        slabs: &PacketSlabs<P>,
        from: P::Bits,
    ) -> QuadHits<P> {
        let clearance = clearance(o, d);
        let mut hits = QuadHits {
            t: P::splat(f32::INFINITY),
            within: P::splat(0.0),
            quad: P::Bits::splat(NO_QUAD),
            triangle: P::Bits::splat(0),
            open: P::mask(0),
        };
        let outer = match &self.hull {
            Some(hull) if hull.take(&self.quads, &mut hits, (o, d), from, clearance) => &[],
            _ => &self.outer[..],
        };
        for &at in outer.iter().chain(&self.lone) {
            self.take_nearer(at, &mut hits, (o, d), from, clearance);
        }
        for cluster in &self.clusters {
            if slabs.may_hit(&cluster.aabb, hits.t + hits.within).any() {
                for &at in &cluster.members {
                    self.take_nearer(at, &mut hits, (o, d), from, clearance);
                }
            }
        }
        hits
    }

    /// Takes one large quad down where it is nearer. There are no short cuts where lanes differ: a wrong
    /// guess costs more than a large quad.
    #[inline(always)]
    fn take_nearer<P: SimdWide>(
        &self,
        at: u32,
        hits: &mut QuadHits<P>,
        (o, d): (V3<P>, V3<P>),
        from: P::Bits,
        clearance: P,
    ) {
        let (quad, zero) = (&self.quads[at as usize], P::splat(0.0));
        let way = quad.way(o, d, clearance);
        if P::WIDTH == 1 && way.is_off(hits.t).any() {
            return;
        }
        let x = way.point(o, d);
        let own = P::equal_bits(from, P::Bits::splat(at));
        let [most, least] = way.depth(quad.sides.inside(x), hits.t);
        let outside = own | most.lt(zero);
        let nearer = least.gt(zero) & !own;
        let [a, b] = quad.triangles.map(P::Bits::splat);
        let (mut known, mut triangle) = (outside | nearer, a);
        if let Some(diagonal) = &quad.diagonal {
            let second = diagonal.across(x);
            known = outside | (nearer & second.abs().gt(way.band));
            triangle = P::select_bits(second.gt(zero), b, a);
        }
        hits.open = hits.open | !known;
        hits.t = P::select(nearer, way.t, hits.t);
        hits.within = P::select(nearer, way.within, hits.within);
        hits.quad = P::select_bits(nearer, P::Bits::splat(at), hits.quad);
        hits.triangle = P::select_bits(nearer, triangle, hits.triangle);
    }

    /// Which of the rays certainly hit a large quad before `t_max`, other than the ones they leave from
    /// and go to, and which may. `between` says that all of them run from surface to surface.
    #[inline(always)]
    pub(super) fn occluded<P: SimdWide>(
        &self,
        (o, d, t_max): (V3<P>, V3<P>, P),
        slabs: &PacketSlabs<P>,
        ends: [P::Bits; 2],
        mut live: P::Mask,
        between: bool,
    ) -> [P::Mask; 2] {
        let clearance = clearance(o, d);
        let mut shadow = Shadow { blocked: P::mask(0), open: P::mask(0) };
        let outer = if between { &[] } else { &self.outer[..] };
        for &at in self.lone.iter().chain(outer) {
            live = live & !self.shade(at, &mut shadow, (o, d, t_max), ends, clearance);
        }
        for cluster in &self.clusters {
            if !(slabs.may_hit(&cluster.aabb, t_max) & live).any() {
                continue;
            }
            for &at in &cluster.members {
                live = live & !self.shade(at, &mut shadow, (o, d, t_max), ends, clearance);
            }
        }
        [shadow.blocked, shadow.open & !shadow.blocked]
    }

    /// [`Quads::occluded`] from surface to surface by those of the inner large quads alone that
    /// [`Quads::between`] has found.
    #[inline(always)]
    pub(super) fn occluded_by<P: SimdWide>(
        &self,
        mut which: u64,
        o: V3<P>,
        d: V3<P>,
        t_max: P,
        ends: [P::Bits; 2],
        mut live: P::Mask,
    ) -> [P::Mask; 2] {
        let clearance = clearance(o, d);
        let mut shadow = Shadow { blocked: P::mask(0), open: P::mask(0) };
        while which != 0 && live.any() {
            let at = self.inner[which.trailing_zeros() as usize];
            which &= which - 1;
            live = live & !self.shade(at, &mut shadow, (o, d, t_max), ends, clearance);
        }
        [shadow.blocked, shadow.open & !shadow.blocked]
    }

    /// Adds the shadow of one large quad; returns the rays that certainly hit it.
    #[inline(always)]
    fn shade<P: SimdWide>(
        &self,
        at: u32,
        shadow: &mut Shadow<P>,
        (o, d, t_max): (V3<P>, V3<P>, P),
        [from, to]: [P::Bits; 2],
        clearance: P,
    ) -> P::Mask {
        let quad = &self.quads[at as usize];
        let way = quad.way(o, d, clearance);
        let zero = P::splat(0.0);
        if P::WIDTH == 1 && way.is_off(t_max).any() {
            return P::mask(0);
        }
        let this = P::Bits::splat(at);
        let own = P::equal_bits(from, this) | P::equal_bits(to, this);
        let [most, least] = way.depth(quad.sides.inside(way.point(o, d)), t_max);
        let outside = own | most.lt(zero);
        let inside = least.gt(zero) & !own;
        shadow.blocked = shadow.blocked | inside;
        shadow.open = shadow.open | !(outside | inside);
        inside
    }
}

/// Rays that certainly hit a large quad, and those that may.
struct Shadow<P: SimdWide> {
    blocked: P::Mask,
    open: P::Mask,
}

/// What decisions keep clear of, for a ray straight across a plane: rounding errors are in proportion to
/// the largest number that took part. Distances along the ray are in units of its length, and that
/// is taken to be at least 1, so that one bound serves for these and for those across.
#[inline(always)]
fn clearance<P: SimdWide>(o: V3<P>, d: V3<P>) -> P {
    let one = P::splat(1.0);
    let largest = o.abs().max_component() + one;
    largest * d.length().max(one) * P::splat(CLEARANCE * UNIT_ROUNDOFF)
}
