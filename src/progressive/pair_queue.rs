//! The pairs of samples that cells get in a pass as is planned for them, batch by batch.

use super::TileRect;
use super::plan::{self, Plan};
use crate::film::{CELL, Film};
use crate::math::Rgb;
use crate::math::soa::BATCH;
use crate::math::sobol::REPLICATES;
use crate::trace::{PixelBatch, ReuseGroup, group_cell};
use std::ops::Range;

// A batch has room for any pair.
const _: () = assert!(2 * CELL * CELL <= BATCH);

/// The pairs of samples that a tile is to get in a pass, in their order, and those of the batch that is
/// being traced. A pair is a sample of all pixels of a cell for either replicate of a half.
#[derive(Default)]
pub(super) struct PairQueue {
    pairs: Vec<SamplePair>,
    /// How many of them have been in a batch.
    taken: usize,
    /// Of the batch, in the order of its pixels.
    pub(super) samples: Vec<Rgb>,
}

/// Pair `number` of a cell is of the passes `4 number + 2 half` and the one after it of its pixels.
#[derive(Clone, Copy)]
struct SamplePair {
    cell: usize,
    half: usize,
    number: u64,
}

impl PairQueue {
    /// Those of a pass that a tile's film does not have: pairs are numbered throughout, and after an
    /// interruption it may have some.
    pub(super) fn fill(&mut self, tile: usize, film: &Film, plan: &Plan, pass: u64) {
        self.pairs.clear();
        self.taken = 0;
        for cell in 0..film.cells() {
            let (half, numbers) = plan.pairs(tile, cell, pass);
            let counted = film.counts(cell)[2 * half];
            let left = numbers.start.max(counted)..numbers.end;
            self.pairs.extend(left.map(|number| SamplePair { cell, half, number }));
        }
    }

    /// Puts as many of the next pairs as it has room for into an empty batch. Returns which; none if
    /// there are none left.
    pub(super) fn next(
        &mut self,
        area: &dyn Fn(usize) -> [Range<u32>; 2],
        seed: u64,
        group: ReuseGroup,
        batch: &mut PixelBatch,
    ) -> Range<usize> {
        let first = self.taken;
        batch.clear();
        while let Some(&pair) = self.pairs.get(self.taken) {
            let area = area(pair.cell);
            if batch.pixels.len() + 2 * area[0].len() * area[1].len() > BATCH {
                break;
            }
            for replicate in [2 * pair.half, 2 * pair.half + 1] {
                let own_pass = REPLICATES as u64 * pair.number + replicate as u64;
                group_cell(area.clone(), seed, own_pass, group, batch);
            }
            self.taken += 1;
        }
        first..self.taken
    }

    /// Adds these pairs of the batch, whose samples are there, to a tile's film, and notes the variances of
    /// cells where they are to be. Returns how many samples are not finite.
    pub(super) fn add(
        &self,
        these: Range<usize>,
        batch: &PixelBatch,
        rect: TileRect,
        film: &mut Film,
    ) -> u64 {
        let pairs = &self.pairs[these];
        let mut found = batch.pixels.iter().zip(&self.samples);
        let (mut start, mut ends, mut nonfinite) = (0, batch.passes.iter(), 0);
        for &SamplePair { cell, half, number } in pairs {
            for replicate in [2 * half, 2 * half + 1] {
                let end = ends.next().map_or(start, |(end, _)| *end as usize);
                for ([x, y], sample) in found.by_ref().take(end - start) {
                    let pixel = (y - rect.y0) as usize * rect.width() + (x - rect.x0) as usize;
                    match sample.is_finite() {
                        true => film.add_to(pixel, replicate, *sample),
                        false => nonfinite += 1,
                    }
                }
                film.count_samples(cell, replicate);
                start = end;
            }
            if plan::is_noted(number + 1) {
                film.note_spread(cell, half);
            }
        }
        nonfinite
    }
}
