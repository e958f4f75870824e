//! Rays on their way through the tree together, each with its own stack.

use super::node::END;
use super::slabs::Slabs;
use crate::geometry::Hit;
use crate::geometry::triangle::ShearedRay;
use crate::math::simd::{Bits, Mask, Simd8};

/// Rays of a group; there are two, and while one is tested, memory fetches what the other needs.
pub(super) const GROUP: usize = 16;
/// No hit.
pub(super) const NOTHING: u32 = u32::MAX;
/// Places of a stack below the first that is used: they say that nothing is left.
const FLOOR: usize = 8;

/// A ray on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct InFlightRay {
    pub(super) slabs: Slabs,
    pub(super) sheared: ShearedRay,
    pub(super) best: Hit,
    /// Which query it is.
    pub(super) query: u32,
    /// What it stands before.
    pub(super) word: u32,
    /// The lowest place of its stack.
    pub(super) floor: usize,
    /// Behind the highest one that is taken.
    pub(super) top: usize,
}

/// Memory for rays on their way.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    pub(super) flights: Box<[InFlightRay; 2 * GROUP]>,
    /// Entry distances, with the last four bits of no meaning.
    pub(super) enter: Box<[f32]>,
    pub(super) words: Box<[u32]>,
}

impl Streams {
    pub(super) fn new(depth: usize) -> Streams {
        // The floor, what each level leaves behind, and eight places that may be written beyond.
        let room = (FLOOR + 7 * depth + 1 + 8).next_multiple_of(8);
        let flight = |who| InFlightRay { floor: who * room + FLOOR, ..InFlightRay::default() };
        Streams {
            flights: Box::new(std::array::from_fn(flight)),
            enter: vec![f32::NEG_INFINITY; 2 * GROUP * room].into(),
            words: vec![END; 2 * GROUP * room].into(),
        }
    }
}

impl InFlightRay {
    /// Goes on to what was put aside last, or to the end if anything was hit.
    #[inline(always)]
    pub(super) fn pop_any(&mut self, words: &[u32]) {
        let found = self.best.primitive != NOTHING;
        let last = if found { self.floor } else { self.top }.saturating_sub(1);
        self.word = words[last];
        self.top = last.max(self.floor);
    }

    /// Goes on to what was put aside last and does not lie beyond the best hit by now.
    #[inline(always)]
    pub(super) fn pop<W: Simd8>(&mut self, distances: &[f32], words: &[u32]) {
        // Down to the floor, which lies beyond no hit.
        while let Some((low, Some(last))) = self
            .top
            .checked_sub(8)
            .map(|low| (low, distances.get(low..).and_then(|above| above.first_chunk())))
        {
            let known = W::from_bits(W::load(last).to_bits() & W::Bits::splat(!15));
            let mask = known.le(W::splat(self.best.t)).bits();
            if mask != 0 {
                let place = low + mask.ilog2() as usize;
                self.word = words[place];
                self.top = place.max(self.floor);
                return;
            }
            self.top = low;
        }
    }
}
