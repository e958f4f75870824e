//! The walls of a scene, all at once: of the large quads on its convex hull a ray from within can hit
//! those alone that lie in the plane by which it leaves.
//!
//! Which plane that is takes no division: of distances `h` to planes and speeds `a` towards them it
//! is the one of the least `h / a`. Its large quad's edges are then looked up, and tried once instead of
//! those of all large quads. Where another plane is about as near the exact test decides.

use super::select::{FLAT, narrow, wide};
use super::{Line, Quad, QuadHits, Way, dot};
use crate::geometry::Geometry;
use crate::math::V3;
use crate::math::gather_table::GatherTable;
use crate::math::record::{RecordField, gather_record};
use crate::math::simd::{Bits, Mask, SimdWide, U32};
use glam::DVec3;

/// Most planes.
const FACETS: usize = 8;
/// Of fewer large quads it is faster to try each.
const LEAST: usize = 4;
/// In place of a facet's number.
const NONE: u32 = u32::MAX;
/// A ray that comes no nearer to a plane than by this, for each unit of distance and way, does not
/// leave by it.
const SLOWEST: f32 = 1e-6;
/// What points of a plane are in front of it, at least.
const LEAST_HEIGHT: f32 = 1e-20;
/// Less than any distance.
const FAR_OUT: f32 = -1e30;

/// The planes of a convex hull that have large quads in them.
#[derive(Clone, Debug)]
pub(super) struct Hull {
    /// Outward normals and their products with the points of the planes.
    facets: Vec<(V3, f32)>,
    /// One large quad of each facet.
    first: GatherTable<QuadRecord, { QuadRecord::NUMBERS }>,
    /// Facets and the other large quads in them.
    others: Vec<(u32, u32)>,
}

gather_record! {
    /// A large quad, to be looked up.
    struct QuadRecord {
        edges: [Line; 4],
        diagonal: Line,
        slenderness: f32,
        quad: u32,
        triangles: [u32; 2],
    }
}

fn record(at: u32, quad: &Quad) -> QuadRecord {
    // Of a lone triangle every point is on the near side.
    let none = Line { m: V3::default(), c: -FAR_OUT };
    QuadRecord {
        edges: quad.sides.lines(),
        diagonal: quad.diagonal.unwrap_or(none),
        slenderness: quad.slenderness,
        quad: U32(at),
        triangles: quad.triangles.map(U32),
    }
}

impl Hull {
    /// Of the large quads with these numbers, all on the hull, if it pays.
    pub(super) fn new(geometry: &Geometry, quads: &[Quad], outer: &[u32]) -> Option<Hull> {
        if outer.len() < LEAST {
            return None;
        }
        let centre = geometry.vertices().iter().map(|v| wide(V3::from(v.position))).sum::<DVec3>()
            / geometry.vertices().len().max(1) as f64;
        let (mut facets, mut first, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for &at in outer {
            let quad = &quads[at as usize];
            let corners = quad.triangles.map(|i| geometry.corners(i as usize));
            let within = |(n, d): &(V3, f32)| {
                let height = |p: &V3| (wide(*n).dot(wide(*p)) - f64::from(*d)).abs();
                corners.iter().flatten().all(|p| height(p) <= FLAT)
            };
            if let Some(facet) = facets.iter().position(within) {
                others.push((facet as u32, at));
                continue;
            }
            if facets.len() == FACETS {
                return None;
            }
            let n = wide(quad.n);
            let outwards = if n.dot(centre) > f64::from(quad.d) { -1.0 } else { 1.0 };
            facets.push((narrow(n * outwards), quad.d * outwards as f32));
            first.push(record(at, quad));
        }
        Some(Hull { facets, first: GatherTable::new(first), others })
    }

    /// Takes down what rays hit of the hull, before anything else; false, and nothing is done, if
    /// any of them starts outside.
    #[inline(always)]
    pub(super) fn take<P: SimdWide>(
        &self,
        quads: &[Quad],
        hits: &mut QuadHits<P>,
        (o, d): (V3<P>, V3<P>),
        from: P::Bits,
        clearance: P,
    ) -> bool {
        let zero = P::splat(0.0);
        let (mut a, mut h) = ([zero; FACETS], [zero; FACETS]);
        let (mut fastest, mut height) = (P::splat(SLOWEST), P::splat(1.0));
        let (mut facet, mut lowest) = (P::Bits::splat(NONE), P::splat(f32::INFINITY));
        for (k, (n, distance)) in self.facets.iter().enumerate() {
            (a[k], h[k]) = (dot(*n, d), P::splat(*distance) - dot(*n, o));
            lowest = h[k].min(lowest);
            let above = h[k].max(P::splat(LEAST_HEIGHT));
            let sooner = (a[k] * height).gt(fastest * above);
            fastest = P::select(sooner, a[k], fastest);
            height = P::select(sooner, above, height);
            facet = P::select_bits(sooner, P::Bits::splat(k as u32), facet);
        }
        if !lowest.ge(-clearance).all() {
            return false;
        }
        let inverse = fastest.recip();
        let (t, band) = (height * inverse, clearance * inverse);
        let way = Way { t, within: band, band };
        let x = way.point(o, d);
        // How far within the other planes it is there.
        let mut rest = P::splat(f32::INFINITY);
        for k in 0..self.facets.len() {
            let left = (-a[k]).mul_add(t, h[k]);
            let this = P::equal_bits(facet, P::Bits::splat(k as u32));
            rest = P::select(this, rest, left.min(rest));
        }
        let found = self.first.get::<P>(facet);
        let mut inside = found.edges[0].each_across(x);
        for edge in &found.edges[1..] {
            inside = edge.each_across(x).min(inside);
        }
        let mut second = found.diagonal.each_across(x);
        let mut within = band * found.slenderness;
        let (mut quad, [mut near, mut far]) = (found.quad, found.triangles);
        // The next best of a facet's large quads.
        let mut next = P::splat(FAR_OUT);
        for &(there, at) in &self.others {
            let this = P::equal_bits(facet, P::Bits::splat(there));
            let other = &quads[at as usize];
            let depth = P::select(this, other.sides.inside(x), P::splat(FAR_OUT));
            let better = depth.gt(inside);
            next = next.max(depth.min(inside));
            inside = inside.max(depth);
            let beyond = match &other.diagonal {
                Some(diagonal) => diagonal.across(x),
                None => P::splat(FAR_OUT),
            };
            second = P::select(better, beyond, second);
            within = P::select(better, band * P::splat(other.slenderness), within);
            quad = P::select_bits(better, P::Bits::splat(at), quad);
            near = P::select_bits(better, P::Bits::splat(other.triangles[0]), near);
            far = P::select_bits(better, P::Bits::splat(other.triangles[1]), far);
        }
        let leaves = !P::equal_bits(facet, P::Bits::splat(NONE));
        let own = P::equal_bits(from, quad);
        let met = leaves & !own & inside.gt(band) & t.gt(within);
        let missed = !leaves | own | inside.lt(-band);
        let clear = rest.gt(band + band) & (next.lt(-band) | !leaves);
        let known = clear & (missed | (met & second.abs().gt(band)));
        hits.open = hits.open | !known;
        hits.t = P::select(met, t, hits.t);
        hits.within = P::select(met, within, hits.within);
        hits.quad = P::select_bits(met, quad, hits.quad);
        let triangle = P::select_bits(second.gt(zero), far, near);
        hits.triangle = P::select_bits(met, triangle, hits.triangle);
        true
    }
}
