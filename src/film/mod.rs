//! Sums of samples, exact and apart for each replicate, so that a picture knows its error.
//!
//! Samples of one low-discrepancy sequence are not independent: their spread overstates the error
//! of their mean. The passes are therefore assigned in turn to a few independently randomised
//! replicates ([`REPLICATES`]), and the spread of the replicates' means is the error.
//!
//! Not all pixels need as many samples. The unit in which they may differ is a [cell](CELL), and
//! there the replicates: the first two have the same number, and the last two. Once numbers are chosen, a
//! pixel is the plain mean of its replicates' means. Dividing all of its samples by their number
//! would bring a bias: numbers are chosen by what samples say, and which replicates have many would
//! depend on what the others found.

mod error;
mod interval;
mod state;
mod sums;

pub use error::{DEGREES_OF_FREEDOM, ErrorEstimate, ErrorSums, Estimate, Figure, REL_MSE_FLOOR};
pub use interval::{CONFIDENCE, Interval, normal_score, ratio, student, tail};
pub use state::{FilmError, FilmState};

use crate::math::Rgb;
use crate::math::sobol::REPLICATES;
use sums::Sums;

/// Side in pixels of the cells of a film, each of which has numbers of samples of its own.
pub const CELL: usize = 8;

/// The sums of a rectangle of pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    width: usize,
    sums: Sums,
    /// Samples that each pixel of a cell has, by replicate; cells row by row.
    counts: Vec<[u64; REPLICATES]>,
    /// Whether numbers of samples were chosen: then replicates count alike, even where they happen to
    /// have what passes in turn would have given them.
    uneven: bool,
    /// What [`Film::note_spread`] has noted, by cell and half of the replicates.
    spreads: Vec<[Vec<f32>; 2]>,
    /// What [`Film::begin_plan`] has noted.
    plan: Option<Planned>,
    passes: u64,
    /// Whether there are samples of a pass that is not whole.
    open: bool,
    /// What to be when the next pass begins; `None` while the sums are good.
    retired: Option<Retired>,
}

/// The samples that there were when numbers were last chosen.
#[derive(Clone, Debug, PartialEq)]
struct Planned {
    /// Number of passes after which.
    from: u64,
    /// Of the first of each half of the replicates, by cell.
    before: Vec<[u64; 2]>,
}

/// Width, pixels and quantum of the film that is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Retired {
    width: usize,
    pixels: usize,
    quantum: i32,
}

impl Film {
    /// Whole passes so far.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Whether all of its samples are of whole passes.
    pub fn is_whole(&self) -> bool {
        !self.open
    }

    /// The quantum of the sums of samples of which the brightest emission is this, in W/(m² sr), as an
    /// exponent of two: every sample is rounded to a multiple of it, so that sums do not depend
    /// on the order of what is added. It is 2^-48 of that emission, or of 1 with none, and at most 2^-44
    /// unless the emission is beyond 2^47.
    pub fn quantum(brightest: f32) -> i32 {
        sums::quantum_for(brightest)
    }

    /// Bytes of memory of a pixel's sums after so many passes in which no sample is above the brightest
    /// emission: 96, or 192 once they outgrow 64 bits.
    pub(crate) fn pixel_bytes(brightest: f32, passes: u64) -> u64 {
        sums::pixel_bytes(brightest, passes.div_ceil(REPLICATES as u64)) as u64
    }

    /// Makes it an empty film of this many pixels in rows of `width`, for samples of which the
    /// brightest emission is 1, keeping its memory.
    pub fn clear(&mut self, width: usize, pixels: usize) {
        self.begin(Retired { width, pixels, quantum: -sums::BITS });
    }

    fn begin(&mut self, Retired { width, pixels, quantum }: Retired) {
        self.width = width.max(1);
        self.sums.clear(pixels, quantum);
        self.counts.clear();
        let rows = pixels.div_ceil(self.width);
        let cells = self.width.div_ceil(CELL) * rows.div_ceil(CELL);
        self.counts.resize(cells, [0; REPLICATES]);
        self.uneven = false;
        self.spreads.clear();
        self.spreads.resize(cells, Default::default());
        self.plan = None;
        self.passes = 0;
        self.open = false;
    }

    /// Has the next pass begin an empty film of this many pixels in rows of `width`, its sums in
    /// multiples of 2^`quantum`. Costs nothing
    /// now: a large picture's sums are cleared tile by tile, by the workers that come to them.
    pub fn retire(&mut self, width: usize, pixels: usize, quantum: i32) {
        self.retired = Some(Retired { width, pixels, quantum });
        self.passes = 0;
        self.open = false;
    }

    /// Makes the film ready for a pass and returns the pass's number, from 0.
    pub fn begin_pass(&mut self) -> u64 {
        self.settle();
        self.open = true;
        self.passes
    }

    /// Clears it now, if that is still to be done.
    pub fn settle(&mut self) {
        if let Some(retired) = self.retired.take() {
            self.begin(retired);
        }
    }

    /// Adds the sample of the present pass to a pixel. Every pixel gets one; [`Film::end_pass`]
    /// then closes the pass.
    #[inline]
    pub fn add(&mut self, pixel: usize, sample: Rgb) {
        self.add_to(pixel, (self.passes % REPLICATES as u64) as usize, sample);
    }

    /// Counts the pass, of which every pixel has a sample.
    pub fn end_pass(&mut self) {
        let replicate = (self.passes % REPLICATES as u64) as usize;
        self.counts.iter_mut().for_each(|counts| counts[replicate] += 1);
        self.passes += 1;
        self.open = false;
    }

    /// Adds a sample of this replicate to a pixel. All of its cell get one, which
    /// [`Film::count_samples`] then counts.
    #[inline]
    pub fn add_to(&mut self, pixel: usize, replicate: usize, sample: Rgb) {
        self.sums.add(pixel, replicate, sample.into());
    }

    /// Counts a sample of this replicate for all pixels of a cell. From the first one on the film's
    /// replicates count alike.
    pub fn count_samples(&mut self, cell: usize, replicate: usize) {
        self.uneven = true;
        self.counts[cell][replicate] += 1;
    }

    /// Counts a pass in which cells got as many samples as each was to have, on the mean one.
    pub fn end_uneven_pass(&mut self) {
        self.passes += 1;
        self.open = false;
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.counts.len()
    }

    /// Samples that each pixel of a cell has.
    pub fn samples(&self, cell: usize) -> u64 {
        self.counts[cell].iter().sum()
    }

    /// Samples that each pixel of a cell has, by replicate.
    pub fn counts(&self, cell: usize) -> [u64; REPLICATES] {
        self.counts[cell]
    }

    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        let notes: usize = self.spreads.iter().flatten().map(|notes| 4 * notes.capacity()).sum();
        self.sums.bytes()
            + self.counts.capacity() * size_of::<[u64; REPLICATES]>()
            + self.spreads.capacity() * size_of::<[Vec<f32>; 2]>()
            + notes
    }

    /// The pixels of a cell.
    fn pixels_of(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, across) = (self.width, self.width.div_ceil(CELL));
        let (x, y) = (cell % across * CELL, cell / across * CELL);
        let rows = y..(y + CELL).min(self.sums.len().div_ceil(width));
        rows.flat_map(move |y| y * width + x..y * width + (x + CELL).min(width))
    }

    /// Half of the squared relative difference of the means of two replicates, summed over the channels,
    /// on the mean of a cell's pixels. The radiance that a pixel's difference is held against is its
    /// own, as these two have it, but at least the cell's mean: a rare bright sample is measured
    /// against its surroundings.
    fn spread(&self, cell: usize, half: usize) -> f64 {
        let [a, b] = [2 * half, 2 * half + 1];
        let counts = self.counts[cell];
        let mean = |sums: &[[f64; 3]; REPLICATES], r: usize, c: usize| {
            sums[r][c] / counts[r].max(1) as f64
        };
        let pixels: Vec<[[f64; 3]; REPLICATES]> =
            self.pixels_of(cell).map(|pixel| self.sums.radiance(pixel)).collect();
        let mut light = [0.0; 3];
        for sums in &pixels {
            for (c, light) in light.iter_mut().enumerate() {
                *light += 0.5 * (mean(sums, a, c) + mean(sums, b, c)) / pixels.len() as f64;
            }
        }
        let mut sum = 0.0;
        for sums in &pixels {
            for (c, light) in light.iter().enumerate() {
                let [x, y] = [mean(sums, a, c), mean(sums, b, c)];
                let radiance = (0.5 * (x + y)).max(*light);
                sum += 0.5 * (x - y) * (x - y) / (radiance * radiance + REL_MSE_FLOOR);
            }
        }
        sum / pixels.len().max(1) as f64
    }

    /// Notes what half of the replicates, the first two (0) or the last two (1), says now about the
    /// variance of a cell: see [`Film::spreads`].
    pub fn note_spread(&mut self, cell: usize, half: usize) {
        let spread = self.spread(cell, half);
        self.spreads[cell][half].push(spread as f32);
    }

    /// What was noted of a cell by either half, in the order in which it was: the mean over its pixels
    /// of the relative variance of a replicate's mean, summed over the channels.
    pub fn spreads(&self, cell: usize) -> &[Vec<f32>; 2] {
        &self.spreads[cell]
    }

    /// Notes, when numbers of samples are chosen after `pass` passes, how many there are.
    pub fn begin_plan(&mut self, passes: u64) {
        let before = self.counts.iter().map(|counts| [counts[0], counts[2]]).collect();
        self.plan = Some(Planned { from: passes, before });
    }

    /// After how many passes numbers of samples were last chosen.
    pub fn planned_at(&self) -> Option<u64> {
        self.plan.as_ref().map(|plan| plan.from)
    }

    /// The samples that each pixel of a cell then had of one of the first two and of one of the last two
    /// replicates; none before numbers are chosen.
    pub fn planned(&self, cell: usize) -> [u64; 2] {
        self.plan.as_ref().map_or([0; 2], |plan| plan.before[cell])
    }

    /// What all samples so far say: mean and variance of the mean of every pixel and channel.
    ///
    /// While all samples are of passes assigned to the replicates in turn, n_r in replicate r, N in all, and replicate means m_r: the mean is `sum n_r m_r / N` and its variance is
    /// estimated by `sum (n_r / N)² (m_r - mean)² * R / (R - 1)`, which is exact where all n_r are
    /// equal. Afterwards both are the same with 1 / R in place of n_r / N, and the variance is exact
    /// again, whatever the replicates' own variances are. Before every replicate has a pass there are
    /// no variances.
    fn moments(&self) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let shares = |counts| Shares::new(counts, !self.uneven);
        let shares: Vec<Shares> = self.counts.iter().map(shares).collect();
        let across = self.width.div_ceil(CELL);
        let mut means = Vec::with_capacity(self.sums.len());
        let mut variances = Vec::with_capacity(self.sums.len());
        let known = self.passes >= REPLICATES as u64;
        let width = self.width.max(1);
        for start in (0..self.sums.len()).step_by(width) {
            let shares = &shares[start / width / CELL * across..][..across];
            for pixel in start..(start + width).min(self.sums.len()) {
                let sums = self.sums.radiance(pixel);
                let Shares { per_sum, part, in_turn } = &shares[(pixel - start) / CELL];
                let mean: [f64; 3] = std::array::from_fn(|c| match in_turn {
                    true => (0..REPLICATES).map(|r| sums[r][c]).sum::<f64>() * per_sum[0],
                    false => (0..REPLICATES).map(|r| sums[r][c] * per_sum[r]).sum(),
                });
                means.push(mean);
                if !known {
                    continue;
                }
                variances.push(std::array::from_fn(|c| {
                    // share (m_r - mean) = S_r share / n_r - share * mean
                    let spread = |r: usize| sums[r][c] * per_sum[r] - part[r] * mean[c];
                    let squares: f64 = (0..REPLICATES).map(|r| spread(r) * spread(r)).sum();
                    squares * REPLICATES as f64 / (REPLICATES as f64 - 1.0)
                }));
            }
        }
        (means, variances)
    }
}

/// How the sums of the replicates make up a mean.
struct Shares {
    /// What each sum is multiplied by.
    per_sum: [f64; REPLICATES],
    /// The parts that the replicates' means have of the whole mean.
    part: [f64; REPLICATES],
    /// Whether every sample has the same weight.
    in_turn: bool,
}

impl Shares {
    fn new(counts: &[u64; REPLICATES], in_turn: bool) -> Shares {
        let all: u64 = counts.iter().sum();
        if in_turn {
            let per_mean = if all > 0 { 1.0 / all as f64 } else { 0.0 };
            return Shares {
                per_sum: [per_mean; REPLICATES],
                part: counts.map(|n| n as f64 * per_mean),
                in_turn,
            };
        }
        let part = 1.0 / REPLICATES as f64;
        Shares {
            per_sum: counts.map(|n| part / n.max(1) as f64),
            part: [part; REPLICATES],
            in_turn,
        }
    }
}
