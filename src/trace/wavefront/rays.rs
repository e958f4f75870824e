//! What rays hit, and which lights are seen: large quads and the few spheres and cylinders by the
//! register, the tree for the rest.

use super::hits::Hits;
use super::{FROM_LIGHT, PathBatch, RADIANCE, lowest};
use crate::geometry::{Bvh, Geometry, Hit, NO_QUAD, PacketSlabs, Query, Ray, Stack};
use crate::math::simd::{Mask, Simd8, SimdWide};
use crate::trace::Tracer;

impl Tracer {
    #[inline(always)]
    pub(super) fn trace<W: Simd8, P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        count: usize,
        stack: &mut Stack,
    ) -> u64 {
        let mut tree_count = 0;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let quads = bvh.quads();
        let PathBatch { paths, hits, tree_rays, .. } = batch;
        tree_rays.clear();
        for at in (0..count).step_by(P::WIDTH) {
            let (o, d) = (paths.o.load::<P>(at), paths.d.load::<P>(at));
            let slabs = PacketSlabs::new(o, d);
            let quad_hits = quads.closest::<P>((o, d), &slabs, paths.quad.load::<P>(at));
            hits.set_quads::<P>(at, &quad_hits);
            let live = P::mask(lowest(count - at));
            let open = (quad_hits.open & live).bits();
            let (mut t, mut within) = ([0.0; 16], [0.0; 16]);
            quad_hits.t.store(&mut t);
            quad_hits.within.store(&mut within);
            // Of the analytic shapes the exact hits, as far as nothing else is known to be nearer.
            let (mut t_max, mut nearest_shape) = ([0.0; 16], [NO_SHAPE; 16]);
            (quad_hits.t + quad_hits.within).store(&mut t_max);
            let mut analytic = 0;
            if !bvh.analytic().is_empty() {
                let ray = (o, d, quad_hits.t + quad_hits.within);
                let from = paths.quad.load::<P>(at);
                bvh.analytic().may_hit(ray, &slabs, from, live, &mut |primitive, lanes| {
                    for lane in each_lane(lanes & !open) {
                        let ray = paths.ray(at + lane);
                        let (t_max, nearest_shape) = (&mut t_max[lane], &mut nearest_shape[lane]);
                        // Of equally near ones the lowest, and they come in any order.
                        if let Some(t) = bvh.hit_analytic(geometry, primitive, &ray, *t_max)
                            && (t < *t_max || primitive < *nearest_shape)
                        {
                            (*t_max, *nearest_shape) = (t, primitive);
                            analytic |= 1 << lane;
                        }
                    }
                });
            }
            let tree = (bvh.may_hit_tree(&slabs, P::load(&t_max)) & live).bits() & !open;
            let others = open | tree;
            tree_count += u64::from(others.count_ones());
            for lane in each_lane(others | analytic) {
                let ray = paths.ray(at + lane);
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
        bvh.closest_each_in_tree::<W>(geometry, &tree_rays.queries, stack, &mut tree_rays.hits);
        for (i, (at, query)) in tree_rays.rays().enumerate() {
            let rank = |hit: &Hit| (hit.t, hit.primitive);
            let both = [tree_rays.hits[i], tree_rays.analytic[i]].into_iter().flatten();
            let hit = both.reduce(|a, b| if rank(&b) < rank(&a) { b } else { a });
            let clear = tree_rays.clear[i];
            hits.settle::<W>(at, hit, clear, bvh, geometry, &query.ray, stack);
        }
        tree_count
    }

    #[inline(always)]
    pub(super) fn trace_shadow_rays<W: Simd8, P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        stack: &mut Stack,
    ) -> u64 {
        let mut tree_count = 0;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let PathBatch { shadows, tree_rays, radiance, reuse, .. } = batch;
        tree_rays.clear();
        tree_rays.visible.clear();
        for at in (0..shadows.count).step_by(P::WIDTH) {
            let (o, d) = (shadows.o.load::<P>(at), shadows.d.load::<P>(at));
            let t_max = shadows.t_max.load::<P>(at);
            let ends = [shadows.quads[0].load::<P>(at), shadows.quads[1].load::<P>(at)];
            let live = P::mask(lowest(shadows.count - at));
            let between = (t_max.lt(P::splat(f32::INFINITY)) | !live).all();
            let slabs = PacketSlabs::new(o, d);
            let ray = (o, d, t_max);
            let [blocked, open] = bvh.quads().occluded::<P>(ray, &slabs, ends, live, between);
            let one = |lane: usize| {
                let (o, d) = (shadows.o.get(at + lane), shadows.d.get(at + lane));
                (Ray { o: o.into(), d: d.into() }, shadows.t_max.0[at + lane])
            };
            let mut clear = live & !blocked;
            if !bvh.analytic().is_empty() && clear.any() {
                let (ray, live) = ((o, d, t_max), clear & !open);
                clear = clear & !bvh.analytic().occluded(geometry, ray, &slabs, ends, live);
            }
            let tree = bvh.may_hit_tree(&slabs, t_max).bits();
            let (open, mut visible) = (open.bits(), clear.bits());
            let unsure = visible & (open | tree);
            tree_count += u64::from(unsure.count_ones());
            for lane in each_lane(unsure) {
                let (ray, t_max) = one(lane);
                if open >> lane & 1 == 0 {
                    tree_rays.push(at + lane, Query { ray, t_max }, t_max, None);
                } else if bvh.occluded_with::<W>(geometry, &ray, t_max, stack) {
                    visible &= !(1 << lane);
                }
            }
            tree_rays.visible.push(visible);
        }
        bvh.occluded_each_in_tree::<W>(
            geometry,
            &tree_rays.queries,
            stack,
            &mut tree_rays.occluded,
        );
        for (&at, &occluded) in tree_rays.at.iter().zip(&tree_rays.occluded) {
            let (part, lane) = (at as usize / P::WIDTH, at as usize % P::WIDTH);
            tree_rays.visible[part] &= !(u32::from(occluded) << lane);
        }
        for (at, &visible) in (0..).step_by(P::WIDTH).zip(&tree_rays.visible) {
            for lane in each_lane(visible) {
                let place = at + lane;
                let light = shadows.light.get(place);
                let slot = shadows.slot.0[place];
                let sums = match slot >> 16 {
                    RADIANCE => &mut *radiance,
                    FROM_LIGHT => &mut reuse.light,
                    _ => &mut reuse.reflected,
                };
                let sum = &mut sums[(slot & 0xffff) as usize];
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
        tree_count
    }
}

impl Hits {
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
        let quad = hit.map_or(NO_QUAD, |hit| bvh.number_of(hit.primitive));
        self.set(at, hit, quad);
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
                let quad = hit.map_or(NO_QUAD, |hit| bvh.number_of(hit.primitive));
                self.set(at, hit, quad);
            }
            // Too close to the large quad to tell.
            Some(_) => self.find::<W>(at, bvh, geometry, ray, stack),
        }
    }
}

/// The lanes of a mask.
#[inline(always)]
pub(super) fn each_lane(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        let some = mask != 0;
        mask &= mask.wrapping_sub(1);
        some.then_some(lane)
    })
}

/// No analytic shape: after all primitives.
const NO_SHAPE: u32 = u32::MAX;

/// Rays that the tree is asked about, those of a batch together, and its answers.
#[derive(Clone, Debug, Default)]
pub(super) struct TreeRays {
    /// Places in the batch.
    at: Vec<u32>,
    queries: Vec<Query>,
    /// A hit nearer than this lies before all large quads.
    clear: Vec<f32>,
    /// The nearest analytic shape.
    analytic: Vec<Option<Hit>>,
    hits: Vec<Option<Hit>>,
    occluded: Vec<bool>,
    /// A register's worth of places each: who sees the light.
    visible: Vec<u32>,
}

impl TreeRays {
    fn clear(&mut self) {
        self.at.clear();
        self.queries.clear();
        self.clear.clear();
        self.analytic.clear();
    }
    #[inline(always)]
    fn push(&mut self, at: usize, query: Query, clear: f32, nearest_shape: Option<Hit>) {
        self.analytic.push(nearest_shape);
        self.at.push(at as u32);
        self.queries.push(query);
        self.clear.push(clear);
    }
    fn rays(&self) -> impl Iterator<Item = (usize, &Query)> {
        self.at.iter().map(|&at| at as usize).zip(&self.queries)
    }
}
