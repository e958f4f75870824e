//! What camera rays met, from one edit to the next: only another scene, camera, size or seed changes
//! that.

use super::Params;
use crate::scene::{Camera, Scene};
use crate::trace::{Deal, FirstHits, Group};
use std::sync::Arc;

/// Most samples of a round that is kept: those of the largest take about 40 MB.
const MOST: u64 = 1 << 21;
/// Previews of different coarseness, the first pass, and what a change of their groups leaves.
const ROUNDS: usize = 4;

/// First hits of the first pass and of the previews before it.
#[derive(Default)]
pub(super) struct FirstHitCache {
    of: Option<(Arc<Scene>, Camera, [u32; 2], u64)>,
    rounds: Vec<Round>,
}

struct Round {
    block: u32,
    group: Group,
    /// Of each bundle, row by row.
    bundles: Vec<FirstHits>,
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
            self.rounds.clear();
        }
    }

    /// What is kept of the first pass over blocks of so many pixels a side, dealt like this: one a
    /// bundle, or nothing where it would be too much.
    pub(super) fn round(&mut self, block: u32, group: Group, deal: &Deal) -> &[FirstHits] {
        let [columns, rows] = deal.bundles().map(|n| n as usize);
        let samples = |(_, _, [width, height], _): &(_, _, [u32; 2], _)| {
            u64::from(width.div_ceil(block)) * u64::from(height.div_ceil(block))
        };
        if self.of.as_ref().is_none_or(|of| samples(of) > MOST) {
            return &[];
        }
        let known = self.rounds.iter().position(|r| (r.block, r.group) == (block, group));
        let at = known.unwrap_or_else(|| {
            if self.rounds.len() == ROUNDS {
                self.rounds.remove(0);
            }
            let mut bundles = Vec::new();
            bundles.resize_with(columns * rows, FirstHits::default);
            self.rounds.push(Round { block, group, bundles });
            self.rounds.len() - 1
        });
        &self.rounds[at].bundles
    }
}
