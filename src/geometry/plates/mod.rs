//! The few large flat faces of a scene: tried one after the other by as many rays at a time as a
//! register holds. Walls, floors and boxes are met by nearly every ray, and a tree only delays that.
//!
//! A quick test decides where it is sure: by more than all roundings of its own and of the
//! [exact one](super::triangle). Rays that pass too near an edge, or through two faces at nearly the
//! same distance, are marked as open, and the exact test decides about them. So no hit depends on
//! the quick one.

mod pick;
#[cfg(test)]
mod tests;

use super::Geometry;
use super::offset::ROUNDING;
use crate::math::V3;
use crate::math::lanes::{Bits, Mask, Packet};

/// A plate that is none.
pub(crate) const NO_PLATE: u32 = u32::MAX;
/// Most plates of a scene.
const MOST: usize = 64;
/// Roundings of 1 + the origin's largest coordinate that decisions keep clear of, across a plane.
const CLEARANCE: f32 = 64.0;
/// What is this far to one side of a plate does not meet it: several times the clearance above for
/// points of the scene, whose coordinates are within 1, and their distance from the surface.
const ASIDE: f32 = 16.0 * CLEARANCE * ROUNDING;

/// A triangle, or two that make a convex quadrilateral.
#[derive(Clone, Debug)]
struct Plate {
    /// Unit normal and its product with the points of the plane.
    n: V3,
    d: f32,
    /// Inwards across each edge: unit, and its product with the edge's points. A triangle's last
    /// edge is there twice.
    edges: [(V3, f32); 4],
    /// Across the diagonal, towards the second triangle.
    diagonal: (V3, f32),
    triangles: [u32; 2],
    slenderness: f32,
}

/// All plates of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plates {
    plates: Vec<Plate>,
    /// The places of all of them.
    all: Vec<u32>,
    /// Those that bodies may lie behind, as seen from between surfaces: not on the convex hull.
    inner: Vec<u32>,
    /// The inner ones by component, for [`Plates::between`].
    shades: Box<Shades>,
    /// Triangles and their plates, by triangle.
    plate_of: Vec<(u32, u32)>,
}

/// Planes and bounds of plates: normal, its product with the points of the plane, lowest and
/// highest corner.
#[derive(Clone, Debug)]
struct Shades {
    n: [[f32; MOST]; 3],
    d: [f32; MOST],
    bounds: [[[f32; MOST]; 3]; 2],
}

impl Default for Shades {
    fn default() -> Shades {
        let zero = [0.0; MOST];
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
        let all: Vec<u32> = (0..plates.len() as u32).collect();
        let hides = |&&i: &&u32| !pick::is_on_the_hull(geometry, &plates[i as usize]);
        let inner: Vec<u32> = all.iter().filter(hides).copied().collect();
        let mut shades = Box::<Shades>::default();
        for (i, &at) in inner.iter().enumerate() {
            let Plate { n, d, triangles, .. } = &plates[at as usize];
            shades.d[i] = *d;
            let corners = triangles.map(|triangle| geometry.corners(triangle as usize));
            for axis in 0..3 {
                let of = |v: V3| [v.x, v.y, v.z][axis];
                shades.n[axis][i] = of(*n);
                let along = || corners.iter().flatten().map(|corner| of(*corner));
                shades.bounds[0][axis][i] = along().fold(f32::INFINITY, f32::min) - ASIDE;
                shades.bounds[1][axis][i] = along().fold(f32::NEG_INFINITY, f32::max) + ASIDE;
            }
        }
        Plates { plates, all, inner, shades, plate_of }
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
            let load = |rows: &[[f32; MOST]; 3]| {
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

    /// The triangles that belong to plates, in order.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> {
        self.plate_of.iter().map(|(triangle, _)| *triangle)
    }

    /// The plate that a primitive belongs to, or [`NO_PLATE`].
    pub(crate) fn plate_of(&self, primitive: u32) -> u32 {
        let found = self.plate_of.binary_search_by_key(&primitive, |(triangle, _)| *triangle);
        found.map_or(NO_PLATE, |i| self.plate_of[i].1)
    }

    /// The nearest plates that rays meet, but for the one each leaves from.
    #[inline(always)]
    pub(crate) fn closest<P: Packet>(&self, o: V3<P>, d: V3<P>, from: P::Bits) -> PlateHits<P> {
        let (clearance, zero) = ([clearance(o), d.length()], P::splat(0.0));
        let mut hits = PlateHits {
            t: P::splat(f32::INFINITY),
            within: P::splat(0.0),
            plate: P::Bits::splat(NO_PLATE),
            triangle: P::Bits::splat(0),
            open: P::mask(0),
        };
        for (at, plate) in (0..).zip(&self.plates) {
            let met = plate.meet(o, d, clearance);
            let own = P::equal_bits(from, P::Bits::splat(at));
            let [most, least] = met.depth(hits.t);
            let outside = own | most.lt(zero);
            if outside.all() {
                continue;
            }
            let nearer = least.gt(zero) & !own;
            let (m, c) = plate.diagonal;
            let second = dot(m, met.x) - P::splat(c);
            let known = outside | (nearer & second.abs().gt(met.band));
            hits.open = hits.open | !known;
            let [a, b] = plate.triangles.map(P::Bits::splat);
            let triangle = P::select_bits(second.gt(zero), b, a);
            hits.t = P::select(nearer, met.t, hits.t);
            hits.within = P::select(nearer, met.within, hits.within);
            hits.plate = P::select_bits(nearer, P::Bits::splat(at), hits.plate);
            hits.triangle = P::select_bits(nearer, triangle, hits.triangle);
        }
        hits
    }

    /// Which of the rays certainly meet a plate before `t_max`, other than the ones they leave from
    /// and go to, and which may. `between` says that all of them run from surface to surface.
    #[inline(always)]
    pub(crate) fn occluded<P: Packet>(
        &self,
        o: V3<P>,
        d: V3<P>,
        t_max: P,
        [from, to]: [P::Bits; 2],
        mut live: P::Mask,
        between: bool,
    ) -> [P::Mask; 2] {
        let clearance = [clearance(o), d.length()];
        let candidates = if between { &self.inner } else { &self.all };
        let mut shadow = Shadow { blocked: P::mask(0), open: P::mask(0) };
        for &at in candidates {
            live = live & !self.shade(at, &mut shadow, (o, d, t_max), [from, to], clearance);
            if !live.any() {
                break;
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
        let clearance = [clearance(o), d.length()];
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
        clearance: [P; 2],
    ) -> P::Mask {
        let met = self.plates[at as usize].meet(o, d, clearance);
        let this = P::Bits::splat(at);
        let own = P::equal_bits(from, this) | P::equal_bits(to, this);
        let [most, least] = met.depth(t_max);
        let outside = own | most.lt(P::splat(0.0));
        let inside = least.gt(P::splat(0.0)) & !own;
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

/// A ray and a plate.
struct Meeting<P> {
    x: V3<P>,
    t: P,
    /// How far off the distance may be.
    within: P,
    /// How far inside the point is.
    inside: P,
    /// How far off that may be.
    band: P,
}

impl<P: Packet> Meeting<P> {
    /// How far within the edges, ahead of the ray's start and before `t_max` it is, by the least of
    /// the three: at most, and at least. Of a ray along the plane neither is above or below 0.
    #[inline(always)]
    fn depth(&self, t_max: P) -> [P; 2] {
        let before = t_max - self.t;
        let most = (self.inside + self.band).min(self.t + self.within).min(before + self.within);
        let least = (self.inside - self.band).min(self.t - self.within).min(before - self.within);
        [most, least]
    }
}

impl Plate {
    #[inline(always)]
    fn meet<P: Packet>(&self, o: V3<P>, d: V3<P>, [clearance, length]: [P; 2]) -> Meeting<P> {
        let inverse = dot(self.n, d).recip();
        let t = (P::splat(self.d) - dot(self.n, o)) * inverse;
        let x = V3::new(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y), d.z.mul_add(t, o.z));
        let [a, b, c, e] = &self.edges;
        let ab = across(a, x).min(across(b, x));
        let ce = across(c, x).min(across(e, x));
        // By so much in distances, which are in units of the ray's length; across the plane a unit
        // of distance is that length at most.
        let roughly = clearance * inverse.abs();
        let within = roughly * P::splat(self.slenderness);
        Meeting { x, t, within, inside: ab.min(ce), band: roughly * length }
    }
}

#[inline(always)]
fn dot<P: Packet>(n: V3, v: V3<P>) -> P {
    let y = v.y.mul_add(P::splat(n.y), v.x * P::splat(n.x));
    v.z.mul_add(P::splat(n.z), y)
}

#[inline(always)]
fn across<P: Packet>((m, c): &(V3, f32), x: V3<P>) -> P {
    dot(*m, x) - P::splat(*c)
}

/// Roundings are in proportion to the largest number that took part.
#[inline(always)]
fn clearance<P: Packet>(o: V3<P>) -> P {
    (o.abs().max_component() + P::splat(1.0)) * P::splat(CLEARANCE * ROUNDING)
}
