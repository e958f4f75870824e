//! Rays of a batch: what they hit, and which light samples are visible.

use super::{FROM_LIGHT, PathBatch, RADIANCE};
use crate::geometry::{RaySoa, SegmentSoa, Stack};
use crate::math::simd::{Simd8, SimdWide, each_lane};
use crate::trace::Tracer;

impl Tracer {
    /// Finds what the first `count` rays hit. Returns how many have gone through the tree.
    #[inline(always)]
    pub(super) fn trace<W: Simd8, P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        count: usize,
        stack: &mut Stack,
    ) -> u64 {
        let PathBatch { paths, hits, .. } = batch;
        let rays = RaySoa { count, o: &paths.o, d: &paths.d, from: &paths.surface_id };
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        bvh.closest_packet::<W, P>(geometry, &rays, &mut hits.found, stack)
    }

    /// Adds the light of those shadow rays that nothing is in the way of. Returns how many have gone
    /// through the tree.
    #[inline(always)]
    pub(super) fn trace_shadow_rays<W: Simd8, P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        stack: &mut Stack,
    ) -> u64 {
        let PathBatch { shadows, visible, radiance, reuse, .. } = batch;
        let [from, to] = &shadows.surface_ids;
        let segments = SegmentSoa {
            count: shadows.count,
            o: &shadows.o,
            d: &shadows.d,
            t_max: &shadows.t_max,
            ends: [from, to],
        };
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let tree_count = bvh.occluded_packet::<W, P>(geometry, &segments, visible, stack);
        for (at, &lanes) in (0..).step_by(P::WIDTH).zip(&*visible) {
            for lane in each_lane(lanes) {
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
