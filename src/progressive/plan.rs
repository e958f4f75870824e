//! Adaptive sampling: how many samples each cell of the picture gets.
//!
//! The first passes give every pixel one sample each. From then on a pass is one sample a pixel on
//! the mean only: cells of [`CELL`] x [`CELL`] pixels get more or fewer, in proportion to the root of
//! their variance, which is what makes the relative error of the picture least (Neyman 1934).
//!
//! **No bias.** The number of samples of the first two replicates follows from samples of the last
//! two alone, and the reverse; each replicate's mean is therefore a mean over a number of samples
//! that has nothing to do with them (Kirk and Arvo, "Unbiased sampling techniques for image
//! synthesis", 1991). What half of the replicates says is taken when it has a number of samples that
//! is the same for all cells: 16, 64, 256 and so on over all replicates. So no number, and not even
//! which samples were looked at, follows from the half that it is for.
//!
//! **The same bits.** Which samples a pass adds follows from that, by sums in a fixed order, and from
//! nothing else: not from threads, nor from pauses. A picture of more passes has all samples of one
//! of fewer.

use super::TileGrid;
use crate::film::{CELL, Film};
use crate::trace::{PixelBatch, ReuseGroup, group_cell};
use std::ops::Range;

/// Passes of one sample a pixel.
pub(super) const UNIFORM: u64 = 16;
/// From one plan to the next the number of passes grows by this factor; so does the number of samples
/// by which variances are known.
const GROWTH: u64 = 4;
/// Fewest and most samples that a cell gets a pass: by the first plan, and by those after it. With the
/// fewest it has, at the end of each plan, at least the samples by which the next one is made.
const FIRST_RATES: [f64; 2] = [1.0 / 12.0, 16.0];
const RATES: [f64; 2] = [0.25, 16.0];
/// What a cell's variance counts for against the mean of those that touch it. With 0.7 and 0.9 the estimated
/// errors were up to 10 % less, but the true ones more, where few samples are bright: in cells that had
/// missed them, which then had too few samples.
const OWN: f64 = 0.5;

/// What is planned between two numbers of passes.
#[derive(Debug)]
pub(super) struct Plan {
    passes: Range<u64>,
    /// Tile by tile and cell by cell, of either half of the replicates.
    cells: Vec<[Rate; 2]>,
    /// Where the cells of each tile begin.
    starts: Vec<usize>,
}

/// Pairs of samples, one for each of two replicates.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// Those before.
    before: u64,
    /// Those that four passes add.
    rate: f64,
    /// In [0, 1): so that rounding errors even out between cells.
    start: f64,
}

impl Rate {
    /// How many there are after this many times four passes.
    fn after(&self, fours: u64) -> u64 {
        self.before + (self.rate * fours as f64 + self.start) as u64
    }
}

/// The number of passes at which the plan for this one ends.
pub(super) fn end_of_plan(pass: u64) -> u64 {
    let mut end = UNIFORM;
    while end <= pass {
        end = end.saturating_mul(GROWTH);
    }
    end
}

/// Whether half of the replicates, with this many samples each, has as many as are looked at.
pub(super) fn is_noted(samples: u64) -> bool {
    let samples = 4 * samples;
    samples >= UNIFORM && samples.is_power_of_two() && samples.ilog2() % 2 == UNIFORM.ilog2() % 2
}

/// The rectangle of pixels, columns and rows of the picture, that is this cell of a tile.
pub(super) fn cell_rect(grid: TileGrid, tile: usize, cell: usize) -> [Range<u32>; 2] {
    let rect = grid.rect(tile);
    let across = rect.width().div_ceil(CELL);
    let side = CELL as u32;
    let (x, y) = ((cell % across) as u32 * side, (cell / across) as u32 * side);
    let range = |from: u32, end: u32| from..(from + side).min(end);
    [range(rect.x0 + x, rect.x1), range(rect.y0 + y, rect.y1)]
}

/// The group that a pixel is in, in one of its own passes after the uniform ones.
pub(super) fn group_of(
    size: [u32; 2],
    seed: u64,
    pass: u64,
    group: ReuseGroup,
    pixel: [u32; 2],
) -> PixelBatch {
    let side = CELL as u32;
    let area = [0, 1].map(|axis: usize| {
        let start = pixel[axis] / side * side;
        start..(start + side).min(size[axis])
    });
    let mut batch = PixelBatch::default();
    group_cell(area, seed, pass, group, &mut batch);
    batch.group_of(pixel)
}

/// The number of passes at which the plan for this one begins; 0 while there is none.
pub(super) fn start_of_plan(pass: u64) -> u64 {
    if pass < UNIFORM { 0 } else { end_of_plan(pass) / GROWTH }
}

impl Plan {
    /// The plan that begins after this many passes, for films that have noted the numbers of samples
    /// that they then had.
    pub(super) fn new(grid: TileGrid, films: &[Film], pass: u64) -> Plan {
        let end = end_of_plan(pass);
        // The first two plans are made by the same samples: there are no others yet of all cells.
        let level = if pass <= UNIFORM { 0 } else { (pass / UNIFORM).ilog2() as usize / 2 - 1 };
        let across = grid.size[0].div_ceil(CELL as u32) as usize;
        let down = grid.size[1].div_ceil(CELL as u32) as usize;
        let mut starts = Vec::with_capacity(films.len());
        let mut places = Vec::new();
        let mut spreads = vec![[0.0; 2]; across * down];
        for (tile, film) in films.iter().enumerate() {
            starts.push(places.len());
            for cell in 0..film.cells() {
                let [xs, ys] = cell_rect(grid, tile, cell);
                let place = ys.start as usize / CELL * across + xs.start as usize / CELL;
                let area = (xs.len() * ys.len()) as f64;
                places.push((place, area, film.planned(cell)));
                spreads[place] = [0, 1].map(|half: usize| {
                    film.spreads(cell)[half].get(level).map_or(0.0, |&x| f64::from(x))
                });
            }
        }
        let mut cells = vec![[Rate { before: 0, rate: 1.0, start: 0.0 }; 2]; places.len()];
        for half in 0..2 {
            // By what the other half says.
            let deviation = |place: usize| {
                let (x, y) = (place % across, place / across);
                let (mut sum, mut count) = (0.0, 0.0);
                for row in y.saturating_sub(1)..(y + 2).min(down) {
                    for column in x.saturating_sub(1)..(x + 2).min(across) {
                        sum += spreads[row * across + column][1 - half];
                        count += 1.0;
                    }
                }
                (OWN * spreads[place][1 - half] + (1.0 - OWN) * sum / count).sqrt()
            };
            let wanted: Vec<(f64, f64, f64)> = places
                .iter()
                .map(|(place, area, before)| (deviation(*place), *area, (4 * before[half]) as f64))
                .collect();
            for (i, rate) in rates(&wanted, pass as f64, end as f64).into_iter().enumerate() {
                let start = ((2 * i + half) as f64 * 0.618_033_988_749_895).fract();
                let before = places[i].2[half];
                cells[i][half] = Rate { before, rate, start };
            }
        }
        Plan { passes: pass..end, cells, starts }
    }

    /// The passes that it is for.
    pub(super) fn passes(&self) -> Range<u64> {
        self.passes.clone()
    }

    /// Samples that each replicate of either half has in a cell of a tile after `passes` passes.
    pub(super) fn done(&self, tile: usize, cell: usize, passes: u64) -> [u64; 2] {
        let first = passes - (passes - self.passes.start) % 4;
        let pairs = |pass: u64| self.pairs(tile, cell, pass).1;
        match passes - first {
            0 => [pairs(first).start, pairs(first + 2).start],
            1 => [pairs(first).end, pairs(first + 2).start],
            2 => [pairs(first + 1).end, pairs(first + 2).start],
            _ => [pairs(first + 1).end, pairs(first + 2).end],
        }
    }

    /// The half of the replicates that gets samples in a pass, and the numbers of the pairs that a
    /// cell of a tile gets: pair `k` is of the passes `4 k + 2 half` and the one after it of a pixel.
    pub(super) fn pairs(&self, tile: usize, cell: usize, pass: u64) -> (usize, Range<u64>) {
        let since = pass - self.passes.start;
        let (fours, half) = (since / 4, (since % 4 / 2) as usize);
        let rate = &self.cells[self.starts[tile] + cell][half];
        let (from, to) = (rate.after(fours), rate.after(fours + 1));
        let middle = from + (to - from).div_ceil(2);
        (half, if since.is_multiple_of(2) { from..middle } else { middle..to })
    }
}

/// Samples a pass for each of some cells, of which the deviation, the area and the samples so far are
/// given: so that at the end numbers are in proportion to the deviations, as far as may be, and one a
/// pixel on the mean.
fn rates(cells: &[(f64, f64, f64)], pass: f64, end: f64) -> Vec<f64> {
    let [least, most] = if pass <= UNIFORM as f64 { FIRST_RATES } else { RATES };
    let rate = |scale: f64, &(deviation, _, samples): &(f64, f64, f64)| {
        ((end * scale * deviation - samples) / (end - pass)).clamp(least, most)
    };
    let whole: f64 = cells.iter().map(|cell| cell.1).sum();
    let mean =
        |scale: f64| cells.iter().map(|cell| rate(scale, cell) * cell.1).sum::<f64>() / whole;
    let largest = cells.iter().map(|cell| cell.0).fold(0.0, f64::max);
    let mean_deviation = cells.iter().map(|cell| cell.0 * cell.1).sum::<f64>() / whole;
    if !(mean_deviation > 1e-12 * largest && largest < f64::INFINITY) {
        return vec![1.0; cells.len()];
    }
    // The mean grows with the scale; by halving, a fixed number of times.
    let (mut low, mut high) = (0.0, 1e3 / mean_deviation);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if mean(middle) < 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let scale = 0.5 * (low + high);
    // Where bounds are in the way of a mean of one, that is restored.
    let found = mean(scale);
    cells.iter().map(|cell| rate(scale, cell) / found).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::math::numbers::Numbers;

    #[test]
    fn plans_follow_each_other_and_look_at_samples_that_are_there() {
        assert_eq!(
            [0, 15, 16, 63, 64, 255, 256].map(end_of_plan),
            [16, 16, 64, 64, 256, 256, 1024]
        );
        assert_eq!([0, 15, 16, 63, 64, 255, 256].map(start_of_plan), [0, 0, 16, 16, 64, 64, 256]);
        let noted: Vec<u64> = (0..2000).filter(|&n| is_noted(n)).collect();
        assert_eq!(noted, [4, 16, 64, 256, 1024]);
        // With the fewest samples that a cell may get it has those by which the next plan is made.
        let (mut samples, mut pass, mut noted) = (16.0, 16, 16.0);
        while pass < 1 << 30 {
            let end = end_of_plan(pass);
            let [least, _] = if pass == 16 { FIRST_RATES } else { RATES };
            samples += least * (end - pass) as f64;
            if pass > 16 {
                noted *= 4.0;
            }
            // One pair may still be missing.
            assert!(samples - 4.0 >= noted, "{samples} at {end}, {noted} looked at");
            pass = end;
        }
    }

    /// Rates are one on the mean over the pixels, within their bounds, and lead to numbers in
    /// proportion to the deviations.
    #[test]
    fn rates_lead_to_numbers_in_proportion_to_deviations() {
        let mut numbers = Numbers(4);
        for round in 0..200 {
            let spread = 10f64.powf(numbers.next() * if round % 2 == 0 { 0.5 } else { 4.0 });
            let cells: Vec<(f64, f64, f64)> = (0..100)
                .map(|_| (spread.powf(numbers.next()), 1.0 + 255.0 * numbers.next(), 16.0))
                .collect();
            let found = rates(&cells, 16.0, 64.0);
            let whole: f64 = cells.iter().map(|cell| cell.1).sum();
            let mean = cells.iter().zip(&found).map(|(c, r)| c.1 * r).sum::<f64>() / whole;
            assert!((mean - 1.0).abs() < 1e-9, "{mean}");
            let free = |r: f64| r > 1.01 * FIRST_RATES[0] && r < 0.99 * FIRST_RATES[1];
            let mut ratios = cells
                .iter()
                .zip(&found)
                .filter(|(_, r)| free(**r))
                .map(|(c, r)| (16.0 + 48.0 * r) / c.0);
            let first = ratios.next().unwrap();
            assert!(ratios.all(|ratio| (ratio / first - 1.0).abs() < 1e-6));
        }
        for alike in [0.0, 1.0, f64::NAN] {
            assert_eq!(rates(&[(alike, 1.0, 16.0); 4], 16.0, 64.0), [1.0; 4]);
        }
    }

    /// Films of noise, one cell ten times as noisy as the others: it gets more samples, each half by
    /// what the other says; passes add what they should, and pairs come one after the other.
    #[test]
    fn a_noisy_cell_gets_more_and_pairs_come_in_order() {
        let grid = TileGrid { size: [70, 40] };
        let mut numbers = Numbers(8);
        let mut films = vec![Film::default(); grid.len()];
        for (tile, film) in films.iter_mut().enumerate() {
            let rect = grid.rect(tile);
            film.clear(rect.width(), rect.area());
            for _ in 0..UNIFORM {
                for pixel in 0..rect.area() {
                    let noisy = tile == 1 && pixel % 32 < 16 && pixel / 32 < 16;
                    // Only the last two replicates see the noise.
                    let noisy = noisy && film.passes() % 4 >= 2;
                    let noise = if noisy { 1.0 } else { 0.1 };
                    film.add(pixel, Rgb::splat(1.0 + noise * (numbers.next() - 0.5) as f32));
                }
                film.end_pass();
            }
            for cell in 0..film.cells() {
                (0..2).for_each(|half| film.note_spread(cell, half));
            }
            film.begin_plan(UNIFORM);
        }
        let plan = Plan::new(grid, &films, UNIFORM);
        assert_eq!(plan.passes(), 16..64);
        let mut pixels = 0.0;
        let mut counts = Vec::new();
        for (tile, film) in films.iter().enumerate() {
            for cell in 0..film.cells() {
                let mut next = [4u64; 2];
                for pass in 16..64 {
                    let (half, pairs) = plan.pairs(tile, cell, pass);
                    assert_eq!((half as u64, pairs.start), (pass % 4 / 2, next[half]));
                    next[half] = pairs.end;
                }
                let [xs, ys] = cell_rect(grid, tile, cell);
                pixels += (xs.len() * ys.len()) as f64 * (2 * (next[0] + next[1])) as f64;
                counts.push(((tile, cell), next));
            }
        }
        let mean = pixels / (70.0 * 40.0);
        assert!((mean / 64.0 - 1.0).abs() < 0.02, "{mean} samples a pixel");
        let noisy = counts.iter().find(|(place, _)| *place == (1, 0)).unwrap().1;
        let quiet = counts.iter().find(|(place, _)| *place == (2, 1)).unwrap().1;
        assert!(noisy[0] > 3 * quiet[0], "{noisy:?} {quiet:?}");
        // The first two replicates look quiet everywhere.
        assert!(noisy[1] < 2 * quiet[1], "{noisy:?} {quiet:?}");
    }

    /// Two cells of which one has rare bright samples, planned and sampled to 64 passes, many times
    /// over: the mean of all pictures is the truth, and the estimated variances are those that the
    /// pictures have. Weighing the replicates by their numbers of samples would not be: where few
    /// bright samples were found there are fewer samples, and they would count for less.
    #[test]
    fn no_bias_comes_of_choosing_numbers_by_samples() {
        const RUNS: usize = 40_000;
        const RARE: f64 = 0.03;
        let grid = TileGrid { size: [2 * CELL as u32, 1] };
        let mut numbers = Numbers(21);
        let (mut means, mut pooled, mut estimated) = (Vec::new(), Vec::new(), 0.0);
        for _ in 0..RUNS {
            let mut films = [Film::default()];
            films[0].clear(2 * CELL, 2 * CELL);
            // All pixels of a cell alike, so that one picture has one number.
            let mut draw = |cell: usize| {
                let bright = cell == 0 && numbers.next() < RARE;
                Rgb::splat(if bright { (1.0 / RARE) as f32 } else { f32::from(cell == 1) })
            };
            let mut sums = [0.0; 2];
            for _ in 0..UNIFORM {
                for (cell, sum) in sums.iter_mut().enumerate() {
                    let sample = draw(cell);
                    *sum += f64::from(sample.r);
                    (0..CELL).for_each(|x| films[0].add(CELL * cell + x, sample));
                }
                films[0].end_pass();
            }
            for cell in 0..2 {
                (0..2).for_each(|half| films[0].note_spread(cell, half));
            }
            films[0].begin_plan(UNIFORM);
            let plan = Plan::new(grid, &films, UNIFORM);
            for pass in 16..64 {
                for (cell, sum) in sums.iter_mut().enumerate() {
                    let (half, pairs) = plan.pairs(0, cell, pass);
                    for _ in pairs {
                        for replicate in [2 * half, 2 * half + 1] {
                            let sample = draw(cell);
                            *sum += f64::from(sample.r);
                            (0..CELL)
                                .for_each(|x| films[0].add_to(CELL * cell + x, replicate, sample));
                            films[0].count_samples(cell, replicate);
                        }
                    }
                }
                films[0].end_uneven_pass();
            }
            let found = films[0].estimate(2 * CELL);
            means.push(f64::from(found.mean[0][0]));
            // Away from the other cell nothing else is pooled into it.
            estimated += f64::from(found.standard_error[0][0]).powi(2) / RUNS as f64;
            pooled.push(sums[0] / films[0].samples(0) as f64);
        }
        let moments = |x: &[f64]| {
            let mean = x.iter().sum::<f64>() / RUNS as f64;
            let variance = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (RUNS - 1) as f64;
            (mean, variance, (variance / RUNS as f64).sqrt())
        };
        let (mean, variance, error) = moments(&means);
        assert!((mean - 1.0).abs() < 4.0 * error, "{mean} +- {error}");
        // A variance of variances with long tails: 5 % are 4 sigma of it.
        assert!((estimated / variance - 1.0).abs() < 0.05, "{estimated} {variance}");
        let (mean, _, error) = moments(&pooled);
        assert!((mean - 1.0).abs() > 4.0 * error, "pooled: {mean} +- {error}");
    }
}
