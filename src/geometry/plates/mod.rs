//! The few large flat faces of a scene: tried by as many rays at a time as a register holds, those of
//! the hull as one, those that lie together only if a ray meets the box around them. Walls, floors
//! and boxes are met by nearly every ray, and a tree only delays that.
//!
//! A quick test decides where it is sure: by more than all roundings of its own and of the
//! [exact one](super::triangle). Rays that pass too near an edge, or through two faces at nearly the
//! same distance, are marked as open, and the exact test decides about them. So no hit depends on
//! the quick one.

mod face;
mod hull;
mod pick;
#[cfg(test)]
mod tests;

use super::Geometry;
use super::clusters::{self, Cluster};
use super::extent::Passing;
use super::offset::ROUNDING;
use crate::math::V3;
use crate::math::lanes::{Bits, Mask, Packet};
use face::{Line, Plate, Sides, Strip, Way, dot};
use hull::Hull;

/// A plate that is none.
pub(crate) const NO_PLATE: u32 = u32::MAX;
/// Most plates of a scene.
pub(crate) const MOST_PLATES: usize = 64;
/// Roundings of 1 + the origin's largest coordinate that decisions keep clear of, across a plane.
const CLEARANCE: f32 = 64.0;
/// What is this far to one side of a plate does not meet it: several times the clearance above for
/// points of the scene, whose coordinates are within 1, and their distance from the surface.
const ASIDE: f32 = 16.0 * CLEARANCE * ROUNDING;

/// All plates of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plates {
    plates: Vec<Plate>,
    /// Those on the convex hull, and the same as one, where that is faster.
    outer: Vec<u32>,
    hull: Option<Hull>,
    /// Those that bodies may lie behind, as seen from between surfaces: not on the convex hull.
    inner: Vec<u32>,
    /// The inner ones that lie together, and the rest of them.
    clusters: Vec<Cluster>,
    lone: Vec<u32>,
    /// The inner ones by component, for [`Plates::between`].
    shades: Box<Shades>,
    /// The places of plates among the inner ones, as bits.
    bits: Vec<u64>,
    /// Triangles and their plates, by triangle.
    plate_of: Vec<(u32, u32)>,
}

/// Planes and bounds of plates: normal, its product with the points of the plane, lowest and
/// highest corner.
#[derive(Clone, Debug)]
struct Shades {
    n: [[f32; MOST_PLATES]; 3],
    d: [f32; MOST_PLATES],
    bounds: [[[f32; MOST_PLATES]; 3]; 2],
}

impl Default for Shades {
    fn default() -> Shades {
        let zero = [0.0; MOST_PLATES];
        Shades { n: [zero; 3], d: zero, bounds: [[zero; 3]; 2] }
    }
}

/// What as many rays met.
pub(crate) struct PlateHits<P: Packet> {
    /// Distance, roughly; what it was at the start where nothing was met.
    pub(crate) t: P,
    /// How roughly.
    pub(crate) within: P,
    /// [`NO_PLATE`] for none.
    pub(crate) plate: P::Bits,
    /// The triangle; without meaning where there is no plate.
    pub(crate) triangle: P::Bits,
    /// Where the exact test has to decide.
    pub(crate) open: P::Mask,
}

impl Plates {
    /// Picks the plates out of a scene.
    pub(crate) fn new(geometry: &Geometry) -> Plates {
        let plates = pick::pick(geometry);
        let mut plate_of: Vec<(u32, u32)> = (0..)
            .zip(&plates)
            .flat_map(|(at, plate)| plate.triangles.map(|triangle| (triangle, at)))
            .collect();
        plate_of.sort_unstable();
        plate_of.dedup();
        let places = 0..plates.len() as u32;
        let (outer, inner): (Vec<u32>, Vec<u32>) =
            places.partition(|&at| pick::is_on_the_hull(geometry, &plates[at as usize]));
        let bounds_of = |corners: &mut dyn Iterator<Item = V3>| {
            let start = [f32::INFINITY, f32::NEG_INFINITY].map(V3::splat);
            corners.fold(start, |[low, high], p| [low.min(p), high.max(p)])
        };
        let bounds = |at: u32| {
            let corners = plates[at as usize].triangles.map(|i| geometry.corners(i as usize));
            bounds_of(&mut corners.into_iter().flatten())
        };
        let mut shades = Box::<Shades>::default();
        for (i, &at) in inner.iter().enumerate() {
            let Plate { n, d, .. } = &plates[at as usize];
            shades.d[i] = *d;
            let [low, high] = bounds(at);
            for axis in 0..3 {
                let of = |v: V3| [v.x, v.y, v.z][axis];
                shades.n[axis][i] = of(*n);
                shades.bounds[0][axis][i] = of(low) - ASIDE;
                shades.bounds[1][axis][i] = of(high) + ASIDE;
            }
        }
        let all = bounds_of(&mut geometry.vertices().iter().map(|v| V3::from(v.position)));
        let pieces: Vec<_> = inner.iter().map(|&at| (at, bounds(at))).collect();
        let (clusters, lone) = clusters::gather(&pieces, all);
        let hull = Hull::new(geometry, &plates, &outer);
        let mut bits = vec![0; plates.len()];
        (0..).zip(&inner).for_each(|(i, &at): (u32, _)| bits[at as usize] = 1 << i);
        Plates { plates, outer, hull, inner, clusters, lone, shades, bits, plate_of }
    }

    /// Which of the inner plates may be met on the way from a point to any point of a box, given by
    /// its corners: bit `i` for the `i`th of them. Coordinates are those of surfaces of the scene.
    #[inline(always)]
    pub(crate) fn between<P: Packet>(&self, p: V3, [low, high]: [V3; 2]) -> u64 {
        let (p_lanes, half) = (p.splat_lanes::<P>(), 0.5);
        let middle = ((low + high) * half).splat_lanes::<P>();
        let reach = ((high - low) * half).splat_lanes::<P>();
        let (lowest, highest) = (low.min(p).splat_lanes::<P>(), high.max(p).splat_lanes::<P>());
        let aside = P::splat(ASIDE);
        let Shades { n, d, bounds } = &*self.shades;
        let mut found = 0;
        for at in (0..self.inner.len()).step_by(P::WIDTH) {
            let load = |rows: &[[f32; MOST_PLATES]; 3]| {
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

    /// The bit that [`Plates::between`] has for a plate, if it has one.
    #[inline(always)]
    pub(crate) fn bit_of(&self, plate: u32) -> u64 {
        self.bits.get(plate as usize).copied().unwrap_or(0)
    }

    /// The triangles that belong to plates, in order.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> {
        self.plate_of.iter().map(|(triangle, _)| *triangle)
    }

    /// The plate that a primitive belongs to, if any.
    pub(super) fn plate_of(&self, primitive: u32) -> Option<u32> {
        let found = self.plate_of.binary_search_by_key(&primitive, |(triangle, _)| *triangle);
        found.ok().map(|i| self.plate_of[i].1)
    }

    /// The nearest plates that rays meet, but for the one each leaves from.
    #[inline(always)]
    pub(crate) fn closest<P: Packet>(
        &self,
        (o, d): (V3<P>, V3<P>),
        passing: &Passing<P>,
        from: P::Bits,
    ) -> PlateHits<P> {
        let clearance = clearance(o, d);
        let mut hits = PlateHits {
            t: P::splat(f32::INFINITY),
            within: P::splat(0.0),
            plate: P::Bits::splat(NO_PLATE),
            triangle: P::Bits::splat(0),
            open: P::mask(0),
        };
        let outer = match &self.hull {
            Some(hull) if hull.take(&self.plates, &mut hits, (o, d), from, clearance) => &[],
            _ => &self.outer[..],
        };
        for &at in outer.iter().chain(&self.lone) {
            self.take_nearer(at, &mut hits, (o, d), from, clearance);
        }
        for cluster in &self.clusters {
            if passing.meet(&cluster.extent, hits.t + hits.within).any() {
                for &at in &cluster.members {
                    self.take_nearer(at, &mut hits, (o, d), from, clearance);
                }
            }
        }
        hits
    }

    /// Takes one plate down where it is nearer. There are no short cuts where lanes differ: a wrong
    /// guess costs more than a plate.
    #[inline(always)]
    fn take_nearer<P: Packet>(
        &self,
        at: u32,
        hits: &mut PlateHits<P>,
        (o, d): (V3<P>, V3<P>),
        from: P::Bits,
        clearance: P,
    ) {
        let (plate, zero) = (&self.plates[at as usize], P::splat(0.0));
        let way = plate.way(o, d, clearance);
        if P::WIDTH == 1 && way.is_off(hits.t).any() {
            return;
        }
        let x = way.point(o, d);
        let own = P::equal_bits(from, P::Bits::splat(at));
        let [most, least] = way.depth(plate.sides.inside(x), hits.t);
        let outside = own | most.lt(zero);
        let nearer = least.gt(zero) & !own;
        let [a, b] = plate.triangles.map(P::Bits::splat);
        let (mut known, mut triangle) = (outside | nearer, a);
        if let Some(diagonal) = &plate.diagonal {
            let second = diagonal.across(x);
            known = outside | (nearer & second.abs().gt(way.band));
            triangle = P::select_bits(second.gt(zero), b, a);
        }
        hits.open = hits.open | !known;
        hits.t = P::select(nearer, way.t, hits.t);
        hits.within = P::select(nearer, way.within, hits.within);
        hits.plate = P::select_bits(nearer, P::Bits::splat(at), hits.plate);
        hits.triangle = P::select_bits(nearer, triangle, hits.triangle);
    }

    /// Which of the rays certainly meet a plate before `t_max`, other than the ones they leave from
    /// and go to, and which may. `between` says that all of them run from surface to surface.
    #[inline(always)]
    pub(crate) fn occluded<P: Packet>(
        &self,
        (o, d, t_max): (V3<P>, V3<P>, P),
        passing: &Passing<P>,
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
            if !(passing.meet(&cluster.extent, t_max) & live).any() {
                continue;
            }
            for &at in &cluster.members {
                live = live & !self.shade(at, &mut shadow, (o, d, t_max), ends, clearance);
            }
        }
        [shadow.blocked, shadow.open & !shadow.blocked]
    }

    /// [`Plates::occluded`] from surface to surface by those of the inner plates alone that
    /// [`Plates::between`] has found.
    #[inline(always)]
    pub(crate) fn occluded_by<P: Packet>(
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

    /// Adds the shadow of one plate; returns the rays that certainly meet it.
    #[inline(always)]
    fn shade<P: Packet>(
        &self,
        at: u32,
        shadow: &mut Shadow<P>,
        (o, d, t_max): (V3<P>, V3<P>, P),
        [from, to]: [P::Bits; 2],
        clearance: P,
    ) -> P::Mask {
        let plate = &self.plates[at as usize];
        let way = plate.way(o, d, clearance);
        let zero = P::splat(0.0);
        if P::WIDTH == 1 && way.is_off(t_max).any() {
            return P::mask(0);
        }
        let this = P::Bits::splat(at);
        let own = P::equal_bits(from, this) | P::equal_bits(to, this);
        let [most, least] = way.depth(plate.sides.inside(way.point(o, d)), t_max);
        let outside = own | most.lt(zero);
        let inside = least.gt(zero) & !own;
        shadow.blocked = shadow.blocked | inside;
        shadow.open = shadow.open | !(outside | inside);
        inside
    }
}

/// Rays that certainly meet a plate, and those that may.
struct Shadow<P: Packet> {
    blocked: P::Mask,
    open: P::Mask,
}

/// What decisions keep clear of, for a ray straight across a plane: roundings are in proportion to
/// the largest number that took part. Distances along the ray are in units of its length, and that
/// is taken to be at least 1, so that one bound serves for these and for those across.
#[inline(always)]
fn clearance<P: Packet>(o: V3<P>, d: V3<P>) -> P {
    let one = P::splat(1.0);
    let largest = o.abs().max_component() + one;
    largest * d.length().max(one) * P::splat(CLEARANCE * ROUNDING)
}
