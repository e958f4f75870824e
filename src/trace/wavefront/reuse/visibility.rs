//! Which primary vertices see which reuse vertices.

use super::super::rays::each_lane;
use super::super::{PathBatch, lowest};
use super::{PrimaryVertices, Runs};
use crate::geometry::{
    NO_QUAD, PacketSlabs, Query, Rays, Shaft, ShaftLeaves, Stack, offset_origin,
};
use crate::math::V3;
use crate::math::simd::{Bits, Mask, Simd8, SimdWide};
use crate::math::soa::Soa3;
use crate::trace::lights::SHADOW_END;
use crate::trace::{RayCounts, Tracer};

impl PrimaryVertices {
    /// Lowest and highest corner of the box around the points of a run, and of those around each
    /// register's worth of them.
    #[inline(always)]
    fn bounds<P: SimdWide>(&self, run: &Runs, each: &mut Vec<[V3; 2]>) -> [V3; 2] {
        each.clear();
        let [infinite, nothing] = [f32::INFINITY, f32::NEG_INFINITY];
        for first in (0..run.len()).step_by(P::WIDTH) {
            let at = run.base + first;
            let there = !P::equal_bits(self.there.load::<P>(at), P::Bits::splat(0));
            let there = there & P::mask(lowest(run.len() - first));
            let p = self.point.p.load::<P>(at);
            let mut corners = [[0.0; 3]; 2];
            for (axis, x) in [p.x, p.y, p.z].into_iter().enumerate() {
                let mut lanes = [0.0; 16];
                P::select(there, x, P::splat(infinite)).store(&mut lanes);
                corners[0][axis] = lanes[..P::WIDTH].iter().copied().fold(infinite, f32::min);
                P::select(there, x, P::splat(nothing)).store(&mut lanes);
                corners[1][axis] = lanes[..P::WIDTH].iter().copied().fold(nothing, f32::max);
            }
            each.push(corners.map(V3::from));
        }
        let none = [V3::splat(infinite), V3::splat(nothing)];
        each.iter().fold(none, |[a, b], [c, d]| [a.min(*c), b.max(*d)])
    }
}

impl PrimaryVertices {
    /// The large quad that all points of a run are on; [`NO_QUAD`] if there is none.
    #[inline(always)]
    fn common_quad(&self, run: &Runs) -> u32 {
        let there = (run.base..run.end).filter(|&at| self.there.0[at] != 0);
        let quads = there.map(|at| self.point.quad.0[at]);
        quads.reduce(|a, b| if a == b { a } else { NO_QUAD }).unwrap_or(NO_QUAD)
    }
}

impl Tracer {
    /// Finds which primary vertices see which reuse vertices of their groups. Returns what was done for it.
    #[inline(always)]
    pub(in super::super) fn find_visibility<W: Simd8, P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        stack: &mut Stack,
    ) -> RayCounts {
        let PathBatch { primary, reuse, ends, .. } = batch;
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let mut pending = std::mem::take(&mut reuse.pending);
        let mut leaves = std::mem::take(&mut pending.leaves);
        let zero = P::splat(0.0);
        let mut counts = RayCounts::default();
        let mut run = Runs::new(ends);
        let mut bounds = [V3::default(); 2];
        let mut floor = 0;
        let has_others = bvh.has_others();
        let any_lead = P::mask(if self.max_depth == u32::MAX { u32::MAX } else { 0 });
        reuse.seen.clear();
        reuse.seen.resize(reuse.count, 0);
        for at in 0..reuse.count {
            let entry = reuse.order[at] as usize;
            let slot = reuse.slot.0[entry] as usize;
            if run.reach(slot) {
                bounds = primary.bounds::<P>(&run, &mut pending.boxes);
                floor = bvh.quads().bit_of(primary.common_quad(&run));
            }
            let mut seen = 1u128 << (slot - run.base);
            if !reuse.is_lit(slot) {
                reuse.seen[entry] = seen;
                continue;
            }
            let others = !seen;
            let lead = P::Bits::splat(primary.lead.0[slot]);
            counts.pairs += run.len() as u64;
            let splat = |v: &Soa3| V3::from(v.get(entry)).splat_lanes::<P>();
            let p2 = splat(&reuse.point.p);
            let error2 = splat(&reuse.point.error);
            let ng2 = splat(&reuse.point.ng);
            let plate2 = P::Bits::splat(reuse.point.quad.0[entry]);
            let mut between = bvh.quads().between::<P>(reuse.point.p.get(entry).into(), bounds);
            // What the point is on is in nobody's way, nor is what all of the others are on.
            between &= !(bvh.quads().bit_of(reuse.point.quad.0[entry]) | floor);
            // What may be between the point and any of the others.
            let (mut round, mut parts) = (0, 0);
            if has_others {
                let shaft = Shaft::new(bounds, reuse.point.p.get(entry).into());
                round = bvh.analytic().within::<W>(&shaft);
                round &= !bvh.analytic().bit_of(reuse.point.quad.0[entry]);
                parts = bvh.top_boxes_within::<W>(&shaft);
            }
            for first in (0..run.len()).step_by(P::WIDTH) {
                let at = run.base + first;
                let from = &primary.point;
                let there = !P::equal_bits(primary.there.load::<P>(at), P::Bits::splat(0));
                let alike = P::equal_bits(primary.lead.load::<P>(at), lead);
                let there = there & (alike | any_lead);
                let (p1, ng1) = (from.p.load::<P>(at), from.ng.load::<P>(at));
                let w = p2 - p1;
                // The sides of both surfaces, as each path asks of its own. The second one's shading
                // normal is bent for whoever looks.
                let faces = ng1.dot(w).gt(zero)
                    & from.ns.load::<P>(at).dot(w).gt(zero)
                    & ng2.dot(w).lt(zero);
                let others = (others >> first) as u32 & lowest(run.len() - first);
                let live = there & faces & P::mask(others);
                if !live.any() {
                    continue;
                }
                let traced = u64::from(live.bits().count_ones());
                counts.visibility_rays += traced;
                counts.visibility_tests +=
                    traced * u64::from(round.count_ones() + parts.count_ones());
                let o = offset_origin(p1, from.error.load::<P>(at), ng1, w);
                let d = offset_origin(p2, error2, ng2, -w) - o;
                let ends = [from.quad.load::<P>(at), plate2];
                let t_max = P::splat(SHADOW_END);
                let [blocked, open] =
                    bvh.quads().occluded_by::<P>(between, o, d, t_max, ends, live);
                let mut clear = live & !blocked;
                if round != 0 {
                    let (ray, live) = ((o, d, t_max), clear & !open);
                    clear = clear & !bvh.analytic().occluded_by(geometry, round, ray, ends, live);
                }
                let clear = clear.bits();
                let open = open.bits() & clear;
                let slabs = PacketSlabs::new(o, d);
                let through_tree = match parts {
                    0 => 0,
                    _ => bvh.may_hit_top_boxes(parts, &slabs, t_max).bits() & clear & !open,
                };
                let mut free = clear & !(open | through_tree);
                if open | through_tree != 0 {
                    counts.tree_rays += u64::from(open.count_ones());
                    counts.pair_rays += u64::from(through_tree.count_ones());
                    let rays = Rays::new(o, d);
                    for lane in each_lane(open) {
                        let ray = rays.get(lane);
                        let blocked = bvh.occluded_with::<W>(geometry, &ray, SHADOW_END, stack);
                        free |= u32::from(!blocked) << lane;
                    }
                    let together = through_tree.count_ones() >= SHAFT_RAYS && {
                        let p2 = reuse.point.p.get(entry).into();
                        let shaft = Shaft::new(pending.boxes[first / P::WIDTH], p2);
                        bvh.look_up::<W>(&shaft, stack, &mut leaves)
                    };
                    if together {
                        let rays = (&rays, &slabs);
                        free |= through_tree
                            & !bvh.occluded_by::<W, P>(
                                geometry,
                                rays,
                                SHADOW_END,
                                through_tree,
                                &leaves,
                            );
                    } else {
                        for lane in each_lane(through_tree) {
                            let query = Query { ray: rays.get(lane), t_max: SHADOW_END };
                            pending.push(((entry as u32, (first + lane) as u32), query));
                        }
                    }
                }
                seen |= u128::from(free) << first;
            }
            reuse.seen[entry] = seen;
            if pending.pairs.len() >= PENDING_RAYS {
                pending.trace::<W>(self, stack, &mut reuse.seen);
            }
        }
        pending.trace::<W>(self, stack, &mut reuse.seen);
        pending.leaves = leaves;
        reuse.pending = pending;
        counts
    }
}

/// So many rays of a register's worth, and one shaft is looked up for all of them.
const SHAFT_RAYS: u32 = 7;

/// Rays between pairs that the tree is asked about together: so many, that they hide each other's
/// waiting, and no more than the nearest memory holds.
const PENDING_RAYS: usize = 1024;

#[derive(Clone, Debug, Default)]
pub(super) struct PendingRays {
    /// Entry, and place in the run.
    pairs: Vec<(u32, u32)>,
    queries: Vec<Query>,
    occluded: Vec<bool>,
    /// Around the primary vertices of a run, a register's worth each.
    boxes: Vec<[V3; 2]>,
    /// What lies between those and a reuse vertex.
    leaves: ShaftLeaves,
}

impl PendingRays {
    #[inline(always)]
    fn push(&mut self, (pair, query): ((u32, u32), Query)) {
        self.pairs.push(pair);
        self.queries.push(query);
    }

    /// Sets the bits of those that hit nothing.
    #[inline(always)]
    fn trace<W: Simd8>(&mut self, tracer: &Tracer, stack: &mut Stack, seen: &mut [u128]) {
        let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
        bvh.occluded_each_in_tree::<W>(geometry, &self.queries, stack, &mut self.occluded);
        for (&(entry, place), &occluded) in self.pairs.iter().zip(&self.occluded) {
            seen[entry as usize] |= u128::from(!occluded) << place;
        }
        self.pairs.clear();
        self.queries.clear();
    }
}
