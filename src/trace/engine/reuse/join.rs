//! Which first points see which second points.

use super::super::{Bundle, lowest};
use super::{Firsts, Runs};
use crate::geometry::{Query, Ray, Stack, offset_origin};
use crate::math::V3;
use crate::math::columns::Columns3;
use crate::math::lanes::{Bits, Mask, Packet, Wide};
use crate::trace::lights::SHADOW_END;
use crate::trace::{Effort, Tracer};

impl Firsts {
    /// Corners of the box around the points of a run.
    #[inline(always)]
    fn bounds<P: Packet>(&self, run: &Runs) -> [V3; 2] {
        let mut low = V3::splat(P::splat(f32::INFINITY));
        let mut high = -low;
        for first in (0..run.len()).step_by(P::WIDTH) {
            let at = run.base + first;
            let there = !P::equal_bits(self.there.load::<P>(at), P::Bits::splat(0));
            let there = there & P::mask(lowest(run.len() - first));
            let p = self.point.p.load::<P>(at);
            low = V3::select(there, low.min(p), low);
            high = V3::select(there, high.max(p), high);
        }
        let fold = |x: P, of: fn(f32, f32) -> f32| {
            let mut lanes = [0.0; 16];
            x.store(&mut lanes);
            lanes[1..P::WIDTH].iter().fold(lanes[0], |a, b| of(a, *b))
        };
        let all = |v: V3<P>, of| V3::new(fold(v.x, of), fold(v.y, of), fold(v.z, of));
        [all(low, f32::min), all(high, f32::max)]
    }
}

impl Tracer {
    /// Finds which first points see which second points of their groups. Returns what was done for it.
    #[inline(always)]
    pub(in super::super) fn join<W: Wide, P: Packet>(
        &self,
        bundle: &mut Bundle,
        stack: &mut Stack,
    ) -> Effort {
        let Bundle { firsts, seconds, ends, .. } = bundle;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let mut later = std::mem::take(&mut seconds.later);
        let zero = P::splat(0.0);
        let mut effort = Effort::default();
        let mut run = Runs::new(ends);
        let mut bounds = [V3::default(); 2];
        seconds.seen.clear();
        for entry in 0..seconds.count {
            let slot = seconds.slot.0[entry] as usize;
            if run.reach(slot) {
                bounds = firsts.bounds::<P>(&run);
            }
            let mut seen = 1u128 << (slot - run.base);
            if !seconds.is_lit(slot) {
                seconds.seen.push(seen);
                continue;
            }
            let others = !seen;
            effort.pairs += run.len() as u64;
            let splat = |v: &Columns3| V3::from(v.get(entry)).splat_lanes::<P>();
            let p2 = splat(&seconds.point.p);
            let error2 = splat(&seconds.point.error);
            let ng2 = splat(&seconds.point.ng);
            let ns2 = splat(&seconds.point.ns);
            let plate2 = P::Bits::splat(seconds.point.plate.0[entry]);
            let between = bvh.plates().between::<P>(seconds.point.p.get(entry).into(), bounds);
            for first in (0..run.len()).step_by(P::WIDTH) {
                let at = run.base + first;
                let from = &firsts.point;
                let there = !P::equal_bits(firsts.there.load::<P>(at), P::Bits::splat(0));
                let (p1, ng1) = (from.p.load::<P>(at), from.ng.load::<P>(at));
                let w = p2 - p1;
                // Both sides of both surfaces, as each path asks of its own.
                let faces = ng1.dot(w).gt(zero)
                    & from.ns.load::<P>(at).dot(w).gt(zero)
                    & ng2.dot(w).lt(zero)
                    & ns2.dot(w).lt(zero);
                let others = (others >> first) as u32 & lowest(run.len() - first);
                let live = there & faces & P::mask(others);
                if !live.any() {
                    continue;
                }
                effort.joined += u64::from(live.bits().count_ones());
                let o = offset_origin(p1, from.error.load::<P>(at), ng1, w);
                let d = offset_origin(p2, error2, ng2, -w) - o;
                let ends = [from.plate.load::<P>(at), plate2];
                let t_max = P::splat(SHADOW_END);
                let [blocked, open] =
                    bvh.plates().occluded_by::<P>(between, o, d, t_max, ends, live);
                let clear = (live & !blocked).bits();
                let open = open.bits();
                let unsure = clear & (open | bvh.meets_tree(o, d, t_max).bits());
                let mut free = clear & !unsure;
                if unsure != 0 {
                    effort.alone += u64::from(unsure.count_ones());
                    let mut parts = [[0.0; 16]; 6];
                    for (x, part) in [o.x, o.y, o.z, d.x, d.y, d.z].into_iter().zip(&mut parts) {
                        x.store(part);
                    }
                    let mut unsure = unsure;
                    while unsure != 0 {
                        let lane = unsure.trailing_zeros() as usize;
                        unsure &= unsure - 1;
                        let part = |i: usize| {
                            V3::new(parts[i][lane], parts[i + 1][lane], parts[i + 2][lane])
                        };
                        let ray = Ray { o: part(0), d: part(3) };
                        if open >> lane & 1 == 0 {
                            let query = Query { ray, t_max: SHADOW_END };
                            later.push(((entry as u32, (first + lane) as u32), query));
                        } else if !bvh.occluded_with::<W>(geometry, &ray, SHADOW_END, stack) {
                            free |= 1 << lane;
                        }
                    }
                }
                seen |= u128::from(free) << first;
            }
            seconds.seen.push(seen);
            if later.pairs.len() >= ENOUGH {
                later.ask::<W>(self, stack, &mut seconds.seen);
            }
        }
        later.ask::<W>(self, stack, &mut seconds.seen);
        seconds.later = later;
        effort
    }
}

/// Rays between pairs that the tree is asked about together: so many, that they hide each other's
/// waiting, and no more than the nearest memory holds.
const ENOUGH: usize = 1024;

#[derive(Clone, Debug, Default)]
pub(super) struct Later {
    /// Entry, and place in the run.
    pairs: Vec<(u32, u32)>,
    queries: Vec<Query>,
    occluded: Vec<bool>,
}

impl Later {
    #[inline(always)]
    fn push(&mut self, (pair, query): ((u32, u32), Query)) {
        self.pairs.push(pair);
        self.queries.push(query);
    }

    /// Sets the bits of those that meet nothing.
    #[inline(always)]
    fn ask<W: Wide>(&mut self, tracer: &Tracer, stack: &mut Stack, seen: &mut [u128]) {
        let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
        bvh.occluded_each_but_plates::<W>(geometry, &self.queries, stack, &mut self.occluded);
        for (&(entry, place), &occluded) in self.pairs.iter().zip(&self.occluded) {
            seen[entry as usize] |= u128::from(!occluded) << place;
        }
        self.pairs.clear();
        self.queries.clear();
    }
}
