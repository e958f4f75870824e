//! Passes that give cells as many samples as is planned for them.

use super::epoch::{Epoch, Own};
use super::plan::{self, Plan};
use super::{Counts, TileRect};
use crate::film::Film;
use crate::math::Rgb;
use crate::math::soa::BATCH;
use crate::math::sobol::REPLICATES;
use crate::trace::{BatchOptions, PixelBatch, ReuseGroup, group_cell};
use std::mem::take;
use std::ops::Range;

/// The pairs of samples that a tile is to get in a pass, in their order, and those of the batch that is
/// being traced. A pair is a sample of all pixels of a cell for either replicate of a half.
#[derive(Default)]
pub(super) struct PairQueue {
    pairs: Vec<Pair>,
    /// How many of them have been in a batch.
    taken: usize,
    /// Of the batch, in the order of its pixels.
    samples: Vec<Rgb>,
}

/// Pair `number` of a cell is of the passes `4 number + 2 half` and the one after it of its pixels.
#[derive(Clone, Copy)]
struct Pair {
    cell: usize,
    half: usize,
    number: u64,
}

impl Pair {
    /// The replicates that its samples are of.
    fn replicates(self) -> [usize; 2] {
        [2 * self.half, 2 * self.half + 1]
    }
}

impl PairQueue {
    /// Those of a pass that a tile's film does not have: pairs are numbered throughout, and after an
    /// interruption it may have some.
    fn fill(&mut self, tile: usize, film: &Film, plan: &Plan, pass: u64) {
        self.pairs.clear();
        self.taken = 0;
        for cell in 0..film.cells() {
            let (half, numbers) = plan.pairs(tile, cell, pass);
            let counted = film.counts(cell)[2 * half];
            let left = numbers.start.max(counted)..numbers.end;
            self.pairs.extend(left.map(|number| Pair { cell, half, number }));
        }
    }

    /// Puts as many of the next pairs as it has room for into an empty batch. Returns which; none if
    /// there are none left.
    fn next(
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
            for replicate in pair.replicates() {
                let own_pass = REPLICATES as u64 * pair.number + replicate as u64;
                group_cell(area.clone(), seed, own_pass, group, batch);
            }
            self.taken += 1;
        }
        first..self.taken
    }
}

impl Epoch {
    /// Traces what a tile is to get in its next pass, and adds it. Returns the number of samples, and
    /// whether the pass is whole: not if half-way the picture was not `wanted` for now, for a noisy
    /// tile has many batches. The next call then goes on with what is left.
    pub(super) fn uneven_pass(
        &self,
        index: usize,
        film: &mut Film,
        plan: &Plan,
        group: ReuseGroup,
        Own { scratch, batch, pairs }: &mut Own,
        wanted: &dyn Fn() -> bool,
    ) -> (u64, bool) {
        let (rect, pass) = (self.grid.rect(index), film.begin_pass());
        let area = |cell| plan::cell_rect(self.grid, index, cell);
        let (mut paths, mut nonfinite) = (0, 0);
        pairs.fill(index, film, plan, pass);
        let whole = loop {
            let these = pairs.next(&area, self.params.seed, group, batch);
            if these.is_empty() {
                break true;
            }
            if !wanted() {
                break false;
            }
            let samples = &mut pairs.samples;
            samples.clear();
            let put = &mut |_, sample| samples.push(sample);
            self.tracer.sample_batch(batch, BatchOptions::of(0), scratch, put);
            paths += batch.pixels.len() as u64;
            let mut found = batch.pixels.iter().copied().zip(samples.iter().copied());
            for &pair in &pairs.pairs[these] {
                nonfinite += add_pair(film, rect, pair, &area(pair.cell), &mut found);
            }
        };
        if whole {
            film.end_uneven_pass();
        }
        let (rays, capped) = (take(&mut scratch.rays), take(&mut scratch.capped));
        self.count(Counts { paths, rays, nonfinite, capped });
        (paths, whole)
    }
}

/// Adds a pair, whose samples come next, and notes the variance of its cell where it is to be. Returns how
/// many samples are not finite.
fn add_pair(
    film: &mut Film,
    rect: TileRect,
    pair: Pair,
    area: &[Range<u32>; 2],
    found: &mut impl Iterator<Item = ([u32; 2], Rgb)>,
) -> u64 {
    let Pair { cell, half, number } = pair;
    let mut nonfinite = 0;
    for replicate in pair.replicates() {
        for ([x, y], sample) in found.by_ref().take(area[0].len() * area[1].len()) {
            let pixel = (y - rect.y0) as usize * rect.width() + (x - rect.x0) as usize;
            match sample.is_finite() {
                true => film.add_to(pixel, replicate, sample),
                false => nonfinite += 1,
            }
        }
        film.count_samples(cell, replicate);
    }
    if plan::is_noted(number + 1) {
        film.note_spread(cell, half);
    }
    nonfinite
}
