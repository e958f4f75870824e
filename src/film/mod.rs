//! Sums of samples, in f64 and apart for each replicate, so that a picture knows its error.
//!
//! Samples of one low-discrepancy sequence are not independent: their spread overstates the error
//! of their mean. The passes are therefore dealt in turn to a few independently randomised
//! replicates ([`REPLICATES`]), and the spread of the replicates' means is the error.

mod error;
mod interval;

pub use error::{DEGREES_OF_FREEDOM, ErrorEstimate, ErrorSums, Estimate, Figure, REL_MSE_FLOOR};
pub use interval::{CONFIDENCE, Interval, normal_score, ratio, student};

use crate::math::Rgb;
use crate::math::sequence::REPLICATES;

/// The sums of a rectangle of pixels.
#[derive(Clone, Debug, Default)]
pub struct Film {
    sums: Vec<[[f64; 3]; REPLICATES]>,
    passes: u64,
    /// Pixels to become when the next pass begins; `None` while the sums are good.
    retired: Option<usize>,
}

impl Film {
    /// Whole passes so far.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Makes it an empty film of this many pixels, keeping its memory.
    pub fn clear(&mut self, pixels: usize) {
        self.sums.clear();
        self.sums.resize(pixels, [[0.0; 3]; REPLICATES]);
        self.passes = 0;
    }

    /// Has the next pass begin an empty film of this many pixels. Costs nothing now: a large
    /// picture's sums are cleared tile by tile, by the workers that come to them.
    pub fn retire(&mut self, pixels: usize) {
        self.retired = Some(pixels);
        self.passes = 0;
    }

    /// Makes the film ready for a pass and returns the pass's number, from 0.
    pub fn begin_pass(&mut self) -> u64 {
        if let Some(pixels) = self.retired.take() {
            self.clear(pixels);
        }
        self.passes
    }

    /// Adds the sample of the present pass to a pixel. Every pixel gets one; [`Film::end_pass`]
    /// then closes the pass.
    #[inline]
    pub fn add(&mut self, pixel: usize, sample: Rgb) {
        let sum = &mut self.sums[pixel][(self.passes % REPLICATES as u64) as usize];
        sum[0] += sample.r as f64;
        sum[1] += sample.g as f64;
        sum[2] += sample.b as f64;
    }

    /// Counts the pass.
    pub fn end_pass(&mut self) {
        self.passes += 1;
    }

    /// What all passes so far say: mean and variance of the mean of every pixel and channel.
    ///
    /// With n_r passes in replicate r, N in all, and replicate means m_r: the mean is
    /// `sum n_r m_r / N` and its variance is estimated by
    /// `sum (n_r / N)² (m_r - mean)² * R / (R - 1)`, which is exact where all n_r are equal. Before
    /// every replicate has a pass there are no variances.
    fn moments(&self) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let per_mean = if self.passes > 0 { 1.0 / self.passes as f64 } else { 0.0 };
        let r = REPLICATES as u64;
        let count = |k: u64| (self.passes / r + u64::from(k < self.passes % r)) as f64;
        let shares: [f64; REPLICATES] = std::array::from_fn(|k| count(k as u64) * per_mean);
        let mean = |sums: &[[f64; 3]; REPLICATES]| -> [f64; 3] {
            std::array::from_fn(|c| sums.iter().map(|s| s[c]).sum::<f64>() * per_mean)
        };
        let means: Vec<_> = self.sums.iter().map(mean).collect();
        if self.passes < r {
            return (means, Vec::new());
        }
        let variance = |(sums, mean): (&[[f64; 3]; REPLICATES], &[f64; 3])| -> [f64; 3] {
            std::array::from_fn(|c| {
                // (n_r / N)(m_r - mean) = S_r / N - share * mean
                let spread = |k: usize| sums[k][c] * per_mean - shares[k] * mean[c];
                let squares: f64 = (0..REPLICATES).map(|k| spread(k) * spread(k)).sum();
                squares * REPLICATES as f64 / (REPLICATES as f64 - 1.0)
            })
        };
        let variances = self.sums.iter().zip(&means).map(variance).collect();
        (means, variances)
    }
}
