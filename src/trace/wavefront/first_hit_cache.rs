//! What camera rays hit, kept for those that come to the same pixels of the same pass again: after
//! an edit of materials or lights they hit the same.

use super::hits::Hits;
use std::sync::OnceLock;

/// What the camera rays of one batch hit: nothing before it is traced, and the same for all whose
/// scene, camera, size, seed, pass and pixels are the same.
#[derive(Debug, Default)]
pub struct FirstHits(OnceLock<Box<[KeptHit]>>);

/// One ray's.
#[derive(Debug)]
struct KeptHit {
    t: f32,
    b: [f32; 2],
    primitive: u32,
    surface_id: u32,
}

impl FirstHits {
    /// Whether it was there, for `count` paths.
    pub(super) fn recall(&self, hits: &mut Hits, count: usize) -> bool {
        let Some(kept) = self.0.get().filter(|kept| kept.len() == count) else { return false };
        for (at, hit) in kept.iter().enumerate() {
            hits.found.put(at, hit.t, hit.b, hit.primitive, hit.surface_id);
        }
        true
    }

    /// Keeps what was hit.
    pub(super) fn keep(&self, hits: &Hits, count: usize) {
        let hit = |at: usize| {
            let (t, b, primitive, surface_id) = hits.found.of(at);
            KeptHit { t, b, primitive, surface_id }
        };
        // Another worker may have been there before: with the same.
        let _ = self.0.set((0..count).map(hit).collect());
    }
}
