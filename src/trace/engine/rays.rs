//! What rays meet, and which lights are seen: plates by the register, the tree for the rest.

use super::{Bundle, Sums, lowest};
use crate::geometry::{Hit, NO_PLATE, Passing, Query, Ray, Stack};
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
            let mut others = (bvh.meets_tree(&passing, hits.t + hits.within) & live).bits() | open;
            if others == 0 {
                continue;
            }
            alone += u64::from(others.count_ones());
            let (mut t, mut within) = ([0.0; 16], [0.0; 16]);
            hits.t.store(&mut t);
            hits.within.store(&mut within);
            while others != 0 {
                let lane = others.trailing_zeros() as usize;
                others &= others - 1;
                let ray = paths.ray(at + lane);
                if open >> lane & 1 != 0 {
                    let hit = bvh.closest_with::<W>(geometry, &ray, f32::INFINITY, stack);
                    let plate = hit.map_or(NO_PLATE, |hit| plates.plate_of(hit.primitive));
                    met.set(at + lane, hit, plate);
                } else {
                    let (t, within) = (t[lane], within[lane]);
                    asked.push(at + lane, Query { ray, t_max: t + within }, t - within);
                }
            }
        }
        bvh.closest_each_but_plates::<W>(geometry, &asked.queries, stack, &mut asked.hits);
        for ((at, query), (hit, clear)) in asked.rays().zip(asked.hits.iter().zip(&asked.clear)) {
            match *hit {
                None => {}
                Some(hit) if hit.t < *clear => met.set(at, Some(hit), NO_PLATE),
                // Too close to the plate to tell.
                Some(_) => {
                    let hit = bvh.closest_with::<W>(geometry, &query.ray, f32::INFINITY, stack);
                    let plate = hit.map_or(NO_PLATE, |hit| plates.plate_of(hit.primitive));
                    met.set(at, hit, plate);
                }
            }
        }
        alone
    }

    #[inline(always)]
    pub(super) fn ask<W: Wide, P: Packet>(
        &self,
        bundle: &mut Bundle,
        stack: &mut Stack,
        sums: Sums,
    ) -> u64 {
        let mut alone = 0;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let Bundle { shadows, asked, radiance, seconds, .. } = bundle;
        let sums = match sums {
            Sums::Radiance => radiance,
            Sums::Asked => &mut seconds.light,
            Sums::Reflected => &mut seconds.reflected,
        };
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
            let tree = bvh.meets_tree(&passing, t_max).bits();
            let (open, mut lit) = (open.bits(), (live & !blocked).bits());
            let mut unsure = lit & (open | tree);
            alone += u64::from(unsure.count_ones());
            while unsure != 0 {
                let lane = unsure.trailing_zeros() as usize;
                unsure &= unsure - 1;
                let (o, d) = (shadows.o.get(at + lane), shadows.d.get(at + lane));
                let ray = Ray { o: o.into(), d: d.into() };
                let t_max = shadows.t_max.0[at + lane];
                if open >> lane & 1 == 0 {
                    asked.push(at + lane, Query { ray, t_max }, t_max);
                } else if bvh.occluded_with::<W>(geometry, &ray, t_max, stack) {
                    lit &= !(1 << lane);
                }
            }
            asked.lit.push(lit);
        }
        bvh.occluded_each_but_plates::<W>(geometry, &asked.queries, stack, &mut asked.occluded);
        for (&at, &occluded) in asked.at.iter().zip(&asked.occluded) {
            let (part, lane) = (at as usize / P::WIDTH, at as usize % P::WIDTH);
            asked.lit[part] &= !(u32::from(occluded) << lane);
        }
        for (at, &lit) in (0..).step_by(P::WIDTH).zip(&asked.lit) {
            let mut lit = lit;
            while lit != 0 {
                let place = at + lit.trailing_zeros() as usize;
                lit &= lit - 1;
                let light = shadows.light.get(place);
                let sum = &mut sums[shadows.slot.0[place] as usize];
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
        alone
    }
}

/// Rays that the tree is asked about, those of a bundle together, and its answers.
#[derive(Clone, Debug, Default)]
pub(super) struct Asked {
    /// Places in the bundle.
    at: Vec<u32>,
    queries: Vec<Query>,
    /// A hit nearer than this lies before all plates.
    clear: Vec<f32>,
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
    }
    #[inline(always)]
    fn push(&mut self, at: usize, query: Query, clear: f32) {
        self.at.push(at as u32);
        self.queries.push(query);
        self.clear.push(clear);
    }
    fn rays(&self) -> impl Iterator<Item = (usize, &Query)> {
        self.at.iter().map(|&at| at as usize).zip(&self.queries)
    }
}
