//! What camera rays met, kept for those that come to the same pixels of the same pass again: after
//! an edit of materials or lights they meet the same.

use super::surface::Met;
use std::sync::OnceLock;

/// What the camera rays of one bundle met: nothing before it is traced, and the same for all whose
/// scene, camera, size, seed, pass and pixels are the same.
#[derive(Debug, Default)]
pub struct FirstHits(OnceLock<Box<[FirstHit]>>);

/// One ray's.
#[derive(Debug)]
struct FirstHit {
    t: f32,
    b: [f32; 2],
    primitive: u32,
    plate: u32,
}

impl FirstHits {
    /// Whether it was there, for so many paths.
    pub(super) fn recall(&self, met: &mut Met, count: usize) -> bool {
        let Some(hits) = self.0.get().filter(|hits| hits.len() == count) else { return false };
        for (at, hit) in hits.iter().enumerate() {
            met.put(at, hit.t, hit.b, hit.primitive, hit.plate);
        }
        true
    }

    /// Keeps what was met.
    pub(super) fn keep(&self, met: &Met, count: usize) {
        let hit = |at: usize| {
            let (t, b, primitive, plate) = met.of(at);
            FirstHit { t, b, primitive, plate }
        };
        // Another worker may have been there before: with the same.
        let _ = self.0.set((0..count).map(hit).collect());
    }
}
