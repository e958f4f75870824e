//! A batch of rays together: what they hit first, and whether anything is in their way. Large quads
//! and the few spheres and cylinders are tried by as many rays at a time as a register holds, the tree
//! by those rays that the others have left undecided.

use super::NO_SURFACE;
use super::bvh::Bvh;
use super::quads::{NO_QUAD, QuadHits};
use super::ray::{Query, Ray};
use super::stack::Stack;
use crate::geometry::aabb::PacketSlabs;
use crate::geometry::triangle::resolve;
use crate::geometry::{Geometry, Hit};
use crate::math::simd::{Bits, MAX_WIDTH, Mask, Simd8, SimdWide, each_lane, first_lanes};
use crate::math::soa::{FOURFOLD, Soa, Soa3};

/// Rays `o + t d`, t > 0, one array a component.
pub(crate) struct RaySoa<'a> {
    /// Number of rays.
    pub(crate) count: usize,
    pub(crate) o: &'a Soa3,
    pub(crate) d: &'a Soa3,
    /// By [`Bvh::surface_id`] the surface that each leaves, which it does not hit again;
    /// [`NO_SURFACE`] for none.
    pub(crate) from: &'a Soa<u32>,
}

impl RaySoa<'_> {
    #[inline(always)]
    fn ray(&self, at: usize) -> Ray {
        Ray { o: self.o.get(at).into(), d: self.d.get(at).into() }
    }
}

/// Segments `o + t d`, 0 < t <= t_max, one array a component.
pub(crate) struct SegmentSoa<'a> {
    /// Number of segments.
    pub(crate) count: usize,
    pub(crate) o: &'a Soa3<FOURFOLD>,
    pub(crate) d: &'a Soa3<FOURFOLD>,
    pub(crate) t_max: &'a Soa<f32, FOURFOLD>,
    /// By [`Bvh::surface_id`] the surfaces where each begins and ends, which are not in its way.
    pub(crate) ends: [&'a Soa<u32, FOURFOLD>; 2],
}

/// What rays hit, one array a component.
#[derive(Clone, Debug, Default)]
pub(crate) struct HitSoa {
    pub(crate) t: Soa<f32>,
    /// Barycentric weights of a triangle's second and third vertex; 0 for other shapes.
    pub(crate) b: [Soa<f32>; 2],
    /// `u32::MAX` for nothing.
    pub(crate) primitive: Soa<u32>,
    /// [`Bvh::surface_id`] of the primitive.
    pub(crate) surface: Soa<u32>,
    /// All ones where distance and weights are still to be found, by [`HitSoa::resolve`].
    unresolved: Soa<u32>,
}

impl Bvh {
    /// The nearest hits of some rays. Some distances and weights are left to [`HitSoa::resolve`].
    /// Returns how many rays have gone through the tree.
    #[inline(always)]
    pub(crate) fn closest_packet<W: Simd8, P: SimdWide>(
        &self,
        geometry: &Geometry,
        rays: &RaySoa,
        hits: &mut HitSoa,
        stack: &mut Stack,
    ) -> u64 {
        let mut tree_count = 0;
        let bvh = self;
        let mut tree_rays = std::mem::take(&mut stack.tree_rays);
        tree_rays.clear();
        for at in (0..rays.count).step_by(P::WIDTH) {
            let (o, d) = (rays.o.load::<P>(at), rays.d.load::<P>(at));
            let slabs = PacketSlabs::new(o, d);
            let quad_hits = self.quads.closest::<P>((o, d), &slabs, rays.from.load::<P>(at));
            hits.set_quads::<P>(at, &quad_hits);
            let live = P::mask(first_lanes(rays.count - at));
            let open = (quad_hits.open & live).bits();
            let (mut t, mut within) = ([0.0; MAX_WIDTH], [0.0; MAX_WIDTH]);
            quad_hits.t.store(&mut t);
            quad_hits.within.store(&mut within);
            // Of the analytic shapes the exact hits, as far as nothing else is known to be nearer.
            let (mut t_max, mut nearest_shape) = ([0.0; MAX_WIDTH], [NO_SHAPE; MAX_WIDTH]);
            (quad_hits.t + quad_hits.within).store(&mut t_max);
            let mut analytic = 0;
            if !self.analytic.is_empty() {
                let ray = (o, d, quad_hits.t + quad_hits.within);
                let from = rays.from.load::<P>(at);
                self.analytic.may_hit(ray, &slabs, from, live, &mut |primitive, lanes| {
                    for lane in each_lane(lanes & !open) {
                        let ray = rays.ray(at + lane);
                        let (t_max, nearest_shape) = (&mut t_max[lane], &mut nearest_shape[lane]);
                        // Of equally near ones the lowest, and they come in any order.
                        if let Some(t) = self.hit_analytic(geometry, primitive, &ray, *t_max)
                            && (t < *t_max || primitive < *nearest_shape)
                        {
                            (*t_max, *nearest_shape) = (t, primitive);
                            analytic |= 1 << lane;
                        }
                    }
                });
            }
            let tree = (self.may_hit_tree(&slabs, P::load(&t_max)) & live).bits() & !open;
            let others = open | tree;
            tree_count += u64::from(others.count_ones());
            for lane in each_lane(others | analytic) {
                let ray = rays.ray(at + lane);
                let (t, within) = (t[lane], within[lane]);
                let hit = Hit { t: t_max[lane], primitive: nearest_shape[lane], b: [0.0; 2] };
                let hit = (hit.primitive != NO_SHAPE).then_some(hit);
                if open >> lane & 1 != 0 {
                    hits.find::<W>(at + lane, bvh, geometry, &ray, stack);
                } else if tree >> lane & 1 != 0 {
                    let query = Query { ray, t_max: t_max[lane] };
                    tree_rays.push(at + lane, query, t - within, hit);
                } else {
                    hits.settle::<W>(at + lane, hit, t - within, bvh, geometry, &ray, stack);
                }
            }
        }
        self.closest_each_in_tree::<W>(geometry, &tree_rays.queries, stack, &mut tree_rays.hits);
        for (i, (at, query)) in tree_rays.rays().enumerate() {
            let rank = |hit: &Hit| (hit.t, hit.primitive);
            let both = [tree_rays.hits[i], tree_rays.analytic[i]].into_iter().flatten();
            let hit = both.reduce(|a, b| if rank(&b) < rank(&a) { b } else { a });
            let clear = tree_rays.clear[i];
            hits.settle::<W>(at, hit, clear, bvh, geometry, &query.ray, stack);
        }
        stack.tree_rays = tree_rays;
        tree_count
    }

    /// Which segments nothing is in the way of: a word of bits for each register of them, into
    /// `clear_lanes`. Returns how many have gone through the tree.
    #[inline(always)]
    pub(crate) fn occluded_packet<W: Simd8, P: SimdWide>(
        &self,
        geometry: &Geometry,
        segments: &SegmentSoa,
        clear_lanes: &mut Vec<u32>,
        stack: &mut Stack,
    ) -> u64 {
        let mut tree_count = 0;
        let mut tree_rays = std::mem::take(&mut stack.tree_rays);
        tree_rays.clear();
        clear_lanes.clear();
        for at in (0..segments.count).step_by(P::WIDTH) {
            let (o, d) = (segments.o.load::<P>(at), segments.d.load::<P>(at));
            let t_max = segments.t_max.load::<P>(at);
            let ends = [segments.ends[0].load::<P>(at), segments.ends[1].load::<P>(at)];
            let live = P::mask(first_lanes(segments.count - at));
            let between = (t_max.lt(P::splat(f32::INFINITY)) | !live).all();
            let slabs = PacketSlabs::new(o, d);
            let ray = (o, d, t_max);
            let [blocked, open] = self.quads.occluded::<P>(ray, &slabs, ends, live, between);
            let one = |lane: usize| {
                let (o, d) = (segments.o.get(at + lane), segments.d.get(at + lane));
                (Ray { o: o.into(), d: d.into() }, segments.t_max.0[at + lane])
            };
            let mut clear = live & !blocked;
            if !self.analytic.is_empty() && clear.any() {
                let (ray, live) = ((o, d, t_max), clear & !open);
                clear = clear & !self.analytic.occluded(geometry, ray, &slabs, ends, live);
            }
            let tree = self.may_hit_tree(&slabs, t_max).bits();
            let (open, mut visible) = (open.bits(), clear.bits());
            let unsure = visible & (open | tree);
            tree_count += u64::from(unsure.count_ones());
            for lane in each_lane(unsure) {
                let (ray, t_max) = one(lane);
                if open >> lane & 1 == 0 {
                    tree_rays.push(at + lane, Query { ray, t_max }, t_max, None);
                } else if self.occluded_with::<W>(geometry, &ray, t_max, stack) {
                    visible &= !(1 << lane);
                }
            }
            clear_lanes.push(visible);
        }
        self.occluded_each_in_tree::<W>(
            geometry,
            &tree_rays.queries,
            stack,
            &mut tree_rays.occluded,
        );
        for (&at, &occluded) in tree_rays.at.iter().zip(&tree_rays.occluded) {
            let (part, lane) = (at as usize / P::WIDTH, at as usize % P::WIDTH);
            clear_lanes[part] &= !(u32::from(occluded) << lane);
        }
        stack.tree_rays = tree_rays;
        tree_count
    }
}

impl HitSoa {
    /// Takes down the large quads that rays hit, if any.
    #[inline(always)]
    fn set_quads<P: SimdWide>(&mut self, at: usize, hits: &QuadHits<P>) {
        let none = P::Bits::splat(u32::MAX);
        let missed = P::equal_bits(hits.quad, P::Bits::splat(NO_QUAD));
        self.t.store(at, hits.t);
        self.primitive.store::<P>(at, P::select_bits(missed, none, hits.triangle));
        self.surface.store::<P>(at, hits.quad);
        self.unresolved.store::<P>(at, P::select_bits(missed, P::Bits::splat(0), none));
    }

    /// Takes down what one ray hit.
    #[inline(always)]
    fn set(&mut self, at: usize, hit: Option<Hit>, surface: u32) {
        let Hit { t, primitive, b } =
            hit.unwrap_or(Hit { t: f32::INFINITY, primitive: u32::MAX, b: [0.0; 2] });
        self.put(at, t, b, primitive, surface);
    }

    /// Takes down a hit by its numbers.
    #[inline(always)]
    pub(crate) fn put(&mut self, at: usize, t: f32, b: [f32; 2], primitive: u32, surface: u32) {
        self.t.0[at] = t;
        self.primitive.0[at] = primitive;
        self.b[0].0[at] = b[0];
        self.b[1].0[at] = b[1];
        self.surface.0[at] = surface;
        self.unresolved.0[at] = 0;
    }

    /// The numbers of a hit, once all are found.
    pub(crate) fn of(&self, at: usize) -> (f32, [f32; 2], u32, u32) {
        let b = [self.b[0].0[at], self.b[1].0[at]];
        (self.t.0[at], b, self.primitive.0[at], self.surface.0[at])
    }

    /// Finds distances and weights where they are not known yet; the shapes have to be there.
    #[inline(always)]
    pub(crate) fn resolve<P: SimdWide>(&mut self, rays: &RaySoa, corners: [&Soa3; 3]) {
        for at in (0..rays.count).step_by(P::WIDTH) {
            let unresolved = !P::equal_bits(self.unresolved.load::<P>(at), P::Bits::splat(0));
            if !unresolved.any() {
                continue;
            }
            let [a, b, c] = corners;
            let corners = [a.load::<P>(at), b.load::<P>(at), c.load::<P>(at)];
            let (o, d) = (rays.o.load::<P>(at), rays.d.load::<P>(at));
            let (t, b) = resolve(o, d, corners, unresolved);
            self.t.store(at, P::select(unresolved, t, self.t.load::<P>(at)));
            for (column, b) in self.b.iter_mut().zip(b) {
                column.store(at, P::select(unresolved, b, column.load::<P>(at)));
            }
        }
    }

    /// Takes down what a ray hits, by the exact tests alone.
    #[inline(always)]
    fn find<W: Simd8>(
        &mut self,
        at: usize,
        bvh: &Bvh,
        geometry: &Geometry,
        ray: &Ray,
        stack: &mut Stack,
    ) {
        let hit = bvh.closest_with::<W>(geometry, ray, f32::INFINITY, stack);
        let surface = hit.map_or(NO_SURFACE, |hit| bvh.surface_id(hit.primitive));
        self.set(at, hit, surface);
    }

    /// Takes down the nearest hit besides the large quads, if it lies before them; those at which it does
    /// not were taken down before. `clear` is the distance before which no large quad is hit.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn settle<W: Simd8>(
        &mut self,
        at: usize,
        hit: Option<Hit>,
        clear: f32,
        bvh: &Bvh,
        geometry: &Geometry,
        ray: &Ray,
        stack: &mut Stack,
    ) {
        match hit {
            None => {}
            Some(hit) if hit.t < clear => {
                let hit = bvh.in_front(geometry, ray, Some(hit));
                let surface = hit.map_or(NO_SURFACE, |hit| bvh.surface_id(hit.primitive));
                self.set(at, hit, surface);
            }
            // Too close to the large quad to tell.
            Some(_) => self.find::<W>(at, bvh, geometry, ray, stack),
        }
    }
}

/// No analytic shape: after all primitives.
const NO_SHAPE: u32 = u32::MAX;
