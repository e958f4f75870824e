//! What rays meet, and which lights are seen: plates and the few spheres and cylinders by the
//! register, the tree for the rest.

use super::surface::Met;
use super::{ASKED, Bundle, RADIANCE, lowest};
use crate::geometry::{Bvh, Geometry, Hit, NO_PLATE, Passing, Query, Ray, Stack};
use crate::math::lanes::{Mask, Packet, Wide};
use crate::trace::Tracer;

impl Tracer {
    #[inline(always)]
    pub(super) fn trace<W: Wide, P: Packet>(
        &self,
        bundle: &mut Bundle,
        count: usize,
        stack: &mut Stack,
    ) -> u64 {
        let mut alone = 0;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let plates = bvh.plates();
        let Bundle { paths, met, asked, .. } = bundle;
        asked.clear();
        for at in (0..count).step_by(P::WIDTH) {
            let (o, d) = (paths.o.load::<P>(at), paths.d.load::<P>(at));
            let passing = Passing::new(o, d);
            let hits = plates.closest::<P>((o, d), &passing, paths.plate.load::<P>(at));
            met.on_plates::<P>(at, &hits);
            let live = P::mask(lowest(count - at));
            let open = (hits.open & live).bits();
            let (mut t, mut within) = ([0.0; 16], [0.0; 16]);
            hits.t.store(&mut t);
            hits.within.store(&mut within);
            // Of the quadrics the exact hits, as far as nothing else is known to be nearer.
            let (mut t_max, mut quadric) = ([0.0; 16], [NO_QUADRIC; 16]);
            (hits.t + hits.within).store(&mut t_max);
            let mut round = 0;
            if !bvh.quadrics().is_empty() {
                let ray = (o, d, hits.t + hits.within);
                let from = paths.plate.load::<P>(at);
                bvh.quadrics().may_meet(ray, &passing, from, live, &mut |primitive, lanes| {
                    for lane in each_lane(lanes & !open) {
                        let ray = paths.ray(at + lane);
                        let (t_max, quadric) = (&mut t_max[lane], &mut quadric[lane]);
                        // Of equally near ones the lowest, and they come in any order.
                        if let Some(t) = bvh.quadric(geometry, primitive, &ray, *t_max)
                            && (t < *t_max || primitive < *quadric)
                        {
                            (*t_max, *quadric) = (t, primitive);
                            round |= 1 << lane;
                        }
                    }
                });
            }
            let tree = (bvh.meets_tree(&passing, P::load(&t_max)) & live).bits() & !open;
            let others = open | tree;
            alone += u64::from(others.count_ones());
            for lane in each_lane(others | round) {
                let ray = paths.ray(at + lane);
                let (t, within) = (t[lane], within[lane]);
                let hit = Hit { t: t_max[lane], primitive: quadric[lane], b: [0.0; 2] };
                let hit = (hit.primitive != NO_QUADRIC).then_some(hit);
                if open >> lane & 1 != 0 {
                    met.find::<W>(at + lane, bvh, geometry, &ray, stack);
                } else if tree >> lane & 1 != 0 {
                    let query = Query { ray, t_max: t_max[lane] };
                    asked.push(at + lane, query, t - within, hit);
                } else {
                    met.settle::<W>(at + lane, hit, t - within, bvh, geometry, &ray, stack);
                }
            }
        }
        bvh.closest_each_in_tree::<W>(geometry, &asked.queries, stack, &mut asked.hits);
        for (i, (at, query)) in asked.rays().enumerate() {
            let rank = |hit: &Hit| (hit.t, hit.primitive);
            let both = [asked.hits[i], asked.quadrics[i]].into_iter().flatten();
            let hit = both.reduce(|a, b| if rank(&b) < rank(&a) { b } else { a });
            let clear = asked.clear[i];
            met.settle::<W>(at, hit, clear, bvh, geometry, &query.ray, stack);
        }
        alone
    }

    #[inline(always)]
    pub(super) fn ask<W: Wide, P: Packet>(&self, bundle: &mut Bundle, stack: &mut Stack) -> u64 {
        let mut alone = 0;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let Bundle { shadows, asked, radiance, seconds, .. } = bundle;
        asked.clear();
        asked.lit.clear();
        for at in (0..shadows.count).step_by(P::WIDTH) {
            let (o, d) = (shadows.o.load::<P>(at), shadows.d.load::<P>(at));
            let t_max = shadows.t_max.load::<P>(at);
            let ends = [shadows.plates[0].load::<P>(at), shadows.plates[1].load::<P>(at)];
            let live = P::mask(lowest(shadows.count - at));
            let between = (t_max.lt(P::splat(f32::INFINITY)) | !live).all();
            let passing = Passing::new(o, d);
            let ray = (o, d, t_max);
            let [blocked, open] = bvh.plates().occluded::<P>(ray, &passing, ends, live, between);
            let one = |lane: usize| {
                let (o, d) = (shadows.o.get(at + lane), shadows.d.get(at + lane));
                (Ray { o: o.into(), d: d.into() }, shadows.t_max.0[at + lane])
            };
            let mut clear = live & !blocked;
            if !bvh.quadrics().is_empty() && clear.any() {
                let (ray, live) = ((o, d, t_max), clear & !open);
                clear = clear & !bvh.quadrics().occluded(geometry, ray, &passing, ends, live);
            }
            let tree = bvh.meets_tree(&passing, t_max).bits();
            let (open, mut lit) = (open.bits(), clear.bits());
            let unsure = lit & (open | tree);
            alone += u64::from(unsure.count_ones());
            for lane in each_lane(unsure) {
                let (ray, t_max) = one(lane);
                if open >> lane & 1 == 0 {
                    asked.push(at + lane, Query { ray, t_max }, t_max, None);
                } else if bvh.occluded_with::<W>(geometry, &ray, t_max, stack) {
                    lit &= !(1 << lane);
                }
            }
            asked.lit.push(lit);
        }
        bvh.occluded_each_in_tree::<W>(geometry, &asked.queries, stack, &mut asked.occluded);
        for (&at, &occluded) in asked.at.iter().zip(&asked.occluded) {
            let (part, lane) = (at as usize / P::WIDTH, at as usize % P::WIDTH);
            asked.lit[part] &= !(u32::from(occluded) << lane);
        }
        for (at, &lit) in (0..).step_by(P::WIDTH).zip(&asked.lit) {
            for lane in each_lane(lit) {
                let place = at + lane;
                let light = shadows.light.get(place);
                let slot = shadows.slot.0[place];
                let sums = match slot >> 16 {
                    RADIANCE => &mut *radiance,
                    ASKED => &mut seconds.light,
                    _ => &mut seconds.reflected,
                };
                let sum = &mut sums[(slot & 0xffff) as usize];
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
        alone
    }
}

impl Met {
    /// Takes down what a ray meets, by the exact tests alone.
    #[inline(always)]
    fn find<W: Wide>(
        &mut self,
        at: usize,
        bvh: &Bvh,
        geometry: &Geometry,
        ray: &Ray,
        stack: &mut Stack,
    ) {
        let hit = bvh.closest_with::<W>(geometry, ray, f32::INFINITY, stack);
        let plate = hit.map_or(NO_PLATE, |hit| bvh.number_of(hit.primitive));
        self.set(at, hit, plate);
    }

    /// Takes down the nearest hit besides the plates, if it lies before them; those at which it does
    /// not were taken down before. `clear` is the distance before which no plate is met.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn settle<W: Wide>(
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
                let plate = hit.map_or(NO_PLATE, |hit| bvh.number_of(hit.primitive));
                self.set(at, hit, plate);
            }
            // Too close to the plate to tell.
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

/// No quadric: after all primitives.
const NO_QUADRIC: u32 = u32::MAX;

/// Rays that the tree is asked about, those of a bundle together, and its answers.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked {
    /// Places in the bundle.
    at: Vec<u32>,
    queries: Vec<Query>,
    /// A hit nearer than this lies before all plates.
    clear: Vec<f32>,
    /// The nearest quadric.
    quadrics: Vec<Option<Hit>>,
    hits: Vec<Option<Hit>>,
    occluded: Vec<bool>,
    /// A register's worth of places each: who sees the light.
    lit: Vec<u32>,
}

impl Asked {
    fn clear(&mut self) {
        self.at.clear();
        self.queries.clear();
        self.clear.clear();
        self.quadrics.clear();
    }
    #[inline(always)]
    fn push(&mut self, at: usize, query: Query, clear: f32, quadric: Option<Hit>) {
        self.quadrics.push(quadric);
        self.at.push(at as u32);
        self.queries.push(query);
        self.clear.push(clear);
    }
    fn rays(&self) -> impl Iterator<Item = (usize, &Query)> {
        self.at.iter().map(|&at| at as usize).zip(&self.queries)
    }
}
