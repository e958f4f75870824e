//! Sums of samples, in f64 and apart for each replicate, so that a picture knows its error.
//!
//! Samples of one low-discrepancy sequence are not independent: their spread overstates the error
//! of their mean. The passes are therefore dealt in turn to a few independently randomised
//! replicates ([`REPLICATES`]), and the spread of the replicates' means is the error.

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

/// Mean and error of a film's pixels at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Mean radiance of each pixel.
    pub mean: Vec<[f32; 3]>,
    /// Standard error of each mean; empty before every replicate has a pass.
    pub standard_error: Vec<[f32; 3]>,
    /// Sum over pixels and channels of `variance / (mean² + 0.01)`, where there is an error.
    pub rel_mse_sum: f64,
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

    /// Mean and error now.
    ///
    /// With n_r passes in replicate r, N in all, and replicate means m_r: the mean is
    /// `sum n_r m_r / N` and its variance is estimated by
    /// `sum (n_r / N)² (m_r - mean)² * R / (R - 1)`, which is exact where all n_r are equal.
    pub fn estimate(&self) -> Estimate {
        let n = self.passes as f64;
        let per_mean = if n > 0.0 { 1.0 / n } else { 0.0 };
        let known = self.passes >= REPLICATES as u64;
        let mut out = Estimate {
            mean: Vec::with_capacity(self.sums.len()),
            standard_error: Vec::with_capacity(if known { self.sums.len() } else { 0 }),
            rel_mse_sum: 0.0,
        };
        let r = REPLICATES as u64;
        let count = |k: u64| (self.passes / r + u64::from(k < self.passes % r)) as f64;
        let shares: [f64; REPLICATES] = std::array::from_fn(|k| count(k as u64) * per_mean);
        for sums in &self.sums {
            let mean: [f64; 3] =
                std::array::from_fn(|c| sums.iter().map(|s| s[c]).sum::<f64>() * per_mean);
            out.mean.push(mean.map(|m| m as f32));
            if !known {
                continue;
            }
            let variance: [f64; 3] = std::array::from_fn(|c| {
                // (n_r / N)(m_r - mean) = S_r / N - share * mean
                let spread = |k: usize| sums[k][c] * per_mean - shares[k] * mean[c];
                let squares: f64 = (0..REPLICATES).map(|k| spread(k) * spread(k)).sum();
                squares * REPLICATES as f64 / (REPLICATES as f64 - 1.0)
            });
            out.standard_error.push(variance.map(|v| v.sqrt() as f32));
            for c in 0..3 {
                out.rel_mse_sum += variance[c] / (mean[c] * mean[c] + 0.01);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_million_equal_passes_keep_their_mean() {
        let mut film = Film::default();
        film.clear(1);
        for _ in 0..10_000_000 {
            film.add(0, Rgb::splat(0.1));
            film.end_pass();
        }
        let e = film.estimate();
        assert!((e.mean[0][0] as f64 - 0.1).abs() < 1e-8);
        assert!(e.standard_error[0][0] < 1e-9);
    }

    #[test]
    fn the_error_is_that_of_the_replicates() {
        let mut film = Film::default();
        film.clear(1);
        // Replicate means 1, 2, 3, 6: mean 3, variance of the mean = 14 / (4 * 3).
        for x in [1.0, 2.0, 3.0, 6.0, 1.0, 2.0, 3.0, 6.0] {
            film.add(0, Rgb::splat(x));
            film.end_pass();
        }
        let e = film.estimate();
        assert_eq!(e.mean[0], [3.0; 3]);
        assert!((e.standard_error[0][1] as f64 - (14.0f64 / 12.0).sqrt()).abs() < 1e-6);
        assert!((e.rel_mse_sum - 3.0 * (14.0 / 12.0) / 9.01).abs() < 1e-12);
    }

    #[test]
    fn there_is_no_error_before_every_replicate_has_a_pass() {
        let mut film = Film::default();
        film.clear(2);
        for _ in 0..REPLICATES - 1 {
            film.add(0, Rgb::splat(1.0));
            film.end_pass();
        }
        assert!(film.estimate().standard_error.is_empty());
    }
}
