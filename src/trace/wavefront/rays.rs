//! Rays of a batch, and what they hit.

use super::PathBatch;
use crate::geometry::{RaySoa, Stack};
use crate::math::simd::{Kernel, Simd8, SimdWide};
use crate::trace::Tracer;

/// Finds what the first `count` rays hit, and fetches it.
pub(super) struct TraceRays<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    pub(super) count: usize,
    /// Whether all was hit before.
    pub(super) known: bool,
    pub(super) stack: &'a mut Stack,
}

impl Kernel for TraceRays<'_> {
    /// How many have gone through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        let TraceRays { tracer, batch, count, known, stack } = self;
        let PathBatch { paths, hits, .. } = batch;
        let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
        let rays = RaySoa { count, o: &paths.o, d: &paths.d, from: &paths.surface_id };
        let mut tree_rays = 0;
        if !known {
            tree_rays = bvh.closest_packet::<W, P>(geometry, &rays, &mut hits.found, stack);
        }
        hits.fetch::<W>(geometry, paths, count);
        if !known {
            hits.resolve::<P>(paths, count);
        }
        tree_rays
    }
}
