//! What camera rays met, from one edit to the next: only another scene, camera, size or seed changes
//! that.

use super::Params;
use crate::scene::{Camera, Scene};
use crate::trace::{FirstHits, PixelGrouping, ReuseGroup};
use std::sync::Arc;

/// Most samples of a round that is kept: those of the largest take about 40 MB.
const MOST: u64 = 1 << 21;
/// Previews of different coarseness, the first pass, and what a change of their groups leaves.
const PASSES: usize = 4;

/// First hits of the first pass and of the previews before it.
#[derive(Default)]
pub(super) struct FirstHitCache {
    of: Option<(Arc<Scene>, Camera, [u32; 2], u64)>,
    passes: Vec<CachedPass>,
}

struct CachedPass {
    block: u32,
    group: ReuseGroup,
    /// Of each batch, row by row.
    batches: Vec<FirstHits>,
}

impl FirstHitCache {
    /// Forgets what is of no use to these parameters.
    pub(super) fn renew(&mut self, params: &Params) {
        let Params { scene, camera, size, seed, .. } = params;
        let is_same = self.of.as_ref().is_some_and(|(of, view, sides, number)| {
            Arc::ptr_eq(of, scene) && (view, sides, number) == (camera, size, seed)
        });
        if !is_same {
            self.of = Some((scene.clone(), *camera, *size, *seed));
            self.passes.clear();
        }
    }

    /// What is kept of the first pass over blocks of `block` pixels a side, grouped like this: one a
    /// batch, or nothing where it would be too much.
    pub(super) fn pass(
        &mut self,
        block: u32,
        group: ReuseGroup,
        grouping: &PixelGrouping,
    ) -> &[FirstHits] {
        let [columns, rows] = grouping.batches().map(|n| n as usize);
        let samples = |(_, _, [width, height], _): &(_, _, [u32; 2], _)| {
            u64::from(width.div_ceil(block)) * u64::from(height.div_ceil(block))
        };
        if self.of.as_ref().is_none_or(|of| samples(of) > MOST) {
            return &[];
        }
        let known = self.passes.iter().position(|r| (r.block, r.group) == (block, group));
        let at = known.unwrap_or_else(|| {
            if self.passes.len() == PASSES {
                self.passes.remove(0);
            }
            let mut batches = Vec::new();
            batches.resize_with(columns * rows, FirstHits::default);
            self.passes.push(CachedPass { block, group, batches });
            self.passes.len() - 1
        });
        &self.passes[at].batches
    }
}
