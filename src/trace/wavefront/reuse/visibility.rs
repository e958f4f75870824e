//! Which primary vertices see which reuse vertices.

use super::super::PathBatch;
use super::Runs;
use crate::geometry::{PointSoa, Stack};
use crate::math::V3;
use crate::math::simd::{Bits, Kernel, Mask, Simd8, SimdWide, first_lanes};
use crate::trace::lights::SHADOW_END;
use crate::trace::{RayCounts, Tracer};

/// Finds which primary vertices see which reuse vertices of their groups.
pub(in super::super) struct FindVisibility<'a> {
    pub(in super::super) tracer: &'a Tracer,
    pub(in super::super) batch: &'a mut PathBatch,
    pub(in super::super) stack: &'a mut Stack,
}

impl Kernel for FindVisibility<'_> {
    /// What was done for it.
    type Output = RayCounts;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> RayCounts {
        let FindVisibility { tracer, batch, stack } = self;
        let PathBatch { primary, reuse, ends, .. } = batch;
        let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
        let from = &primary.point;
        let points = PointSoa {
            p: &from.p,
            error: &from.error,
            surface: &from.surface_id,
            there: &primary.there,
        };
        let mut group = bvh.visible(geometry, points, SHADOW_END, stack);
        let zero = P::splat(0.0);
        let mut pairs = 0;
        let mut run = Runs::new(ends);
        let any_lead = P::mask(if tracer.max_depth == u32::MAX { u32::MAX } else { 0 });
        reuse.seen.clear();
        reuse.seen.resize(reuse.count, 0);
        for at in 0..reuse.count {
            let entry = reuse.order[at] as usize;
            let slot = reuse.slot.0[entry] as usize;
            if run.reach(slot) {
                group.enter::<P>(run.base..run.end);
            }
            let mut seen = 1u128 << (slot - run.base);
            if !reuse.is_lit(slot) {
                reuse.seen[entry] = seen;
                continue;
            }
            let others = !seen;
            let lead = P::Bits::splat(primary.lead.0[slot]);
            pairs += run.len() as u64;
            let to = &reuse.point;
            let point = [&to.p, &to.error, &to.ng].map(|v| V3::from(v.get(entry)));
            let target = group.target::<W, P>(point, to.surface_id.0[entry]);
            for first in (0..run.len()).step_by(P::WIDTH) {
                let at = run.base + first;
                let there = !P::equal_bits(primary.there.load::<P>(at), P::Bits::splat(0));
                let alike = P::equal_bits(primary.lead.load::<P>(at), lead);
                let there = there & (alike | any_lead);
                let (p1, ng1) = (from.p.load::<P>(at), from.ng.load::<P>(at));
                let w = target.p - p1;
                // The sides of both surfaces, as each path has them. The second one's shading normal is
                // bent for each viewer.
                let faces = ng1.dot(w).gt(zero)
                    & from.ns.load::<P>(at).dot(w).gt(zero)
                    & target.ng.dot(w).lt(zero);
                let others = (others >> first) as u32 & first_lanes(run.len() - first);
                let live = there & faces & P::mask(others);
                if !live.any() {
                    continue;
                }
                let free = group.sees::<W, P>(&target, entry as u32, at, [p1, ng1, w], live);
                seen |= u128::from(free) << first;
            }
            reuse.seen[entry] = seen;
            group.decide::<W>(&mut reuse.seen, false);
        }
        group.decide::<W>(&mut reuse.seen, true);
        let counts = group.end();
        RayCounts {
            pairs,
            visibility_rays: counts.rays,
            visibility_tests: counts.tests,
            pair_rays: counts.pair_rays,
            tree_rays: counts.tree_rays,
            ..RayCounts::default()
        }
    }
}
