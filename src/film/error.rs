//! The error of a picture, from the spread of its replicates.
//!
//! Four replicates give a pixel's variance three degrees of freedom: too few to say much about that
//! pixel, plenty when many are summed. So two things are told, each by the means that suit it.
//!
//! *A pixel's standard error* is pooled over the pixels that touch it. Neighbours differ, but less
//! than three degrees do: measured on the shipped scenes with every path for itself the pooled 95 %
//! intervals hold the truth in 94 to 96 % of all pixels from 8 passes on, the others in 81 to 95 %.
//! Where paths share, the neighbours' errors are alike and their 27 degrees worth about half.
//!
//! *The picture's error* sums the plain variances, which are unbiased. Its relative form divides by
//! the pixel's radiance, and there lies a trap: a rare bright sample raises both, so that the error
//! seems least where it is largest (measured: 60 % of the truth at 16 passes). The radiance to
//! divide by is therefore drawn towards the neighbours' where it may be noise, see [`radiance2`].
//!
//! The limits are for the error of *this* picture, which is itself a random number: both the sum
//! of squared errors and the sum of their estimates are about chi-square distributed, so their
//! ratio has Fisher's distribution, with as many terms as effectively matter. Replicate means of
//! few samples have longer tails than the normal ones of that theory, and the count of terms is
//! itself taken from them: where a lamp's corner owns the error and all four replicates happen to
//! agree on it, it is neither in the sum nor in the count. Counting a quarter of the terms makes up
//! for most of it: the upper limit holds in 92 % of such pictures (64x48 pixels, one or two of them
//! owning a third of the error), in 97 % and more of others.

use super::Film;
use super::interval::{Interval, normal_quantile, ratio};
use crate::math::sobol::REPLICATES;

/// Degrees of freedom of a pixel's standard error, away from the edges of tiles: half of what nine
/// pixels have, for neighbours that share their paths err alike.
pub const DEGREES_OF_FREEDOM: f64 = 0.5 * 9.0 * SPREAD;
/// Those of one pixel's variance.
const SPREAD: f64 = (REPLICATES - 1) as f64;

/// What keeps relative errors of dark pixels finite: they are measured against `r² + 0.01`.
pub const REL_MSE_FLOOR: f64 = 0.01;

/// Fewer passes than this leave too much of the light unseen for its error to be known.
const LEAST_PASSES: u64 = 32;
/// With fewer effective terms two or three pixels own the error. Not more: whoever asks for many
/// terms chooses the pictures that have missed the pixels that matter.
const LEAST_TERMS: f64 = 5.0;
/// How much faster than normal ones the squares of replicate means, and their count, scatter. Tried
/// in its place: counting by the spread of single samples, which holds more often for a number more
/// a pixel, and by the spread of the replicates' sums, which is wider and holds no better.
const TAILS: f64 = 4.0;

/// Mean and error of a film's pixels at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Mean radiance of each pixel.
    pub mean: Vec<[f32; 3]>,
    /// Standard error of each mean, pooled over the neighbours; empty before every replicate has a
    /// pass. The 95 % interval is `mean ± student(DEGREES_OF_FREEDOM) * standard_error`.
    pub standard_error: Vec<[f32; 3]>,
    /// What the error of a whole picture is made of; empty before every replicate has a pass.
    pub sums: ErrorSums,
}

/// Sums over pixels of estimated squared errors. Those of a picture's tiles add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorSums {
    pixels: u64,
    relative: Sum,
    absolute: Sum,
}

/// Sum of the pixels' terms and of their squares; a term is itself the sum over the channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sum {
    terms: f64,
    squares: f64,
}

/// An estimated error with the interval that holds the true one of this picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// The estimate.
    pub value: f64,
    /// 95 % limits.
    pub interval: Interval,
}

/// How far a picture is off, without a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// `mean((x - r)² / (r² + 0.01))` over pixels x and channels, r being the truth.
    pub rel_mse: Figure,
    /// Its square root, the relative error.
    pub relative: Figure,
    /// `sqrt(mean((x - r)²))`, in radiance.
    pub rmse: Figure,
    /// Pixels that effectively make up the relative error, as if all had the same share.
    pub terms: f64,
    /// False while the figures may be far off: under 32 passes, or while a handful of pixels owns
    /// the error because their bright samples are rare.
    pub reliable: bool,
}

impl Film {
    /// Mean and error now; `width` is that of the rectangle, whose pixels go row by row.
    pub fn estimate(&self, width: usize) -> Estimate {
        // What stays is set aside before what is soon given back, which would else leave holes between.
        let mut out = Estimate {
            mean: Vec::with_capacity(self.sums.len()),
            standard_error: Vec::with_capacity(self.sums.len()),
            sums: ErrorSums::default(),
        };
        let (means, variances) = self.moments();
        out.mean.extend(means.iter().map(|m| m.map(|m| m as f32)));
        let width = width.max(1);
        let height = means.len() / width;
        for (i, variance) in variances.iter().enumerate() {
            let (x, y) = (i % width, i / width);
            let mut around = Around::default();
            for row in y.saturating_sub(1)..(y + 2).min(height) {
                for k in row * width + x.saturating_sub(1)..row * width + (x + 2).min(width) {
                    if k != i {
                        around.add(&means[k], &variances[k]);
                    }
                }
            }
            let all = 1.0 / (around.pixels + 1.0);
            let pooled = |c: usize| ((variance[c] + around.variances[c]) * all).sqrt() as f32;
            out.standard_error.push(std::array::from_fn(pooled));
            out.sums.add_pixel(variance, radiance2(&means[i], variance, &around));
        }
        out
    }
}

/// Sums over the pixels that touch one.
#[derive(Default)]
struct Around {
    pixels: f64,
    means: [f64; 3],
    variances: [f64; 3],
}

impl Around {
    fn add(&mut self, mean: &[f64; 3], variance: &[f64; 3]) {
        self.pixels += 1.0;
        for c in 0..3 {
            self.means[c] += mean[c];
            self.variances[c] += variance[c];
        }
    }
}

/// The squared radiance that a pixel's error is measured against.
///
/// The mean of the neighbours, and as much of the pixel's difference from it as stands out of
/// twice the noise of both (shrinkage as of James and Stein 1961, variances known): a firefly then
/// counts against its surroundings, the rim of a lamp against itself. But at most the pixel's own
/// mean, less its noise: of the pixels that a rare sample could light, those that it did light are
/// too bright.
fn radiance2(mean: &[f64; 3], variance: &[f64; 3], around: &Around) -> [f64; 3] {
    let count = around.pixels.max(1.0);
    let near: [f64; 3] = std::array::from_fn(|c| around.means[c] / count);
    let noise: f64 = variance.iter().sum();
    let near_noise = around.variances.iter().sum::<f64>() / (count * count);
    let apart: f64 = (0..3).map(|c| (mean[c] - near[c]).powi(2)).sum();
    let signal = (apart - 2.0 * (noise + near_noise)).max(0.0);
    let kept =
        if around.pixels > 0.0 { signal / (signal + noise).max(f64::MIN_POSITIVE) } else { 1.0 };
    let own: f64 = mean.iter().map(|m| m * m).sum();
    let steady = own / (own + noise).max(f64::MIN_POSITIVE);
    std::array::from_fn(|c| {
        let drawn = near[c] + kept * (mean[c] - near[c]);
        (drawn * drawn).min(mean[c] * mean[c] * steady)
    })
}

impl ErrorEstimate {
    /// The error of `coarser`, the mean radiance of a picture whose samples are some of those of `finer`,
    /// of which this is the error; both of as many pixels.
    ///
    /// The square of what they are apart is measured, that of the finer one is estimated, and they add up:
    /// of independent samples s and n of them, `E|x_n - r|² = E|x_n - x_s|² + E|x_s - r|²`. So a picture of
    /// a few passes has an error that can be relied on, which its own replicates do not yet give. The limits
    /// are those of the finer picture and of the product of the two differences, whose mean is 0.
    pub fn of_coarser(&self, coarser: &[[f32; 3]], finer: &[[f32; 3]]) -> ErrorEstimate {
        let (mut relative, mut absolute) = (0.0, 0.0);
        for (x, r) in coarser.iter().flatten().zip(finer.iter().flatten()) {
            let [x, r] = [*x, *r].map(f64::from);
            let square = (x - r) * (x - r);
            relative += square / (r * r + REL_MSE_FLOOR);
            absolute += square;
        }
        let values = 3.0 * coarser.len().min(finer.len()).max(1) as f64;
        let terms = (self.terms / TAILS).max(1.0);
        let rel_mse = self.rel_mse.beyond(relative / values, terms);
        let rmse = self.rmse.map(|e| e * e).beyond(absolute / values, terms).map(f64::sqrt);
        ErrorEstimate { rel_mse, relative: rel_mse.map(f64::sqrt), rmse, ..*self }
    }
}

impl ErrorSums {
    fn add_pixel(&mut self, variance: &[f64; 3], radiance2: [f64; 3]) {
        self.pixels += 1;
        self.relative.add((0..3).map(|c| variance[c] / (radiance2[c] + REL_MSE_FLOOR)).sum());
        self.absolute.add(variance.iter().sum());
    }

    /// Takes in the sums of other pixels.
    pub fn add(&mut self, other: &ErrorSums) {
        self.pixels += other.pixels;
        for (sum, o) in [(&mut self.relative, other.relative), (&mut self.absolute, other.absolute)]
        {
            sum.terms += o.terms;
            sum.squares += o.squares;
        }
    }

    /// The error of a picture of this many pixels after `passes` passes; `None` while that of some
    /// pixel is not known.
    pub fn estimate(&self, pixels: u64, passes: u64) -> Option<ErrorEstimate> {
        if self.pixels < pixels || pixels == 0 {
            return None;
        }
        let rel_mse = self.relative.figure(pixels);
        let terms = self.relative.effective(pixels);
        Some(ErrorEstimate {
            rel_mse,
            relative: rel_mse.map(f64::sqrt),
            rmse: self.absolute.figure(pixels).map(f64::sqrt),
            terms,
            reliable: passes >= LEAST_PASSES && terms >= LEAST_TERMS,
        })
    }
}

impl Sum {
    fn add(&mut self, term: f64) {
        self.terms += term;
        self.squares += term * term;
    }

    /// How many equal terms would scatter as much: `(sum mu)² / sum mu²`, where an estimate of mu
    /// with d degrees of freedom has a mean square of `mu² (1 + 2 / d)`.
    fn effective(&self, pixels: u64) -> f64 {
        if self.squares <= 0.0 {
            return pixels as f64;
        }
        ((1.0 + 2.0 / SPREAD) * self.terms * self.terms / self.squares).clamp(1.0, pixels as f64)
    }

    fn figure(&self, pixels: u64) -> Figure {
        let value = self.terms / (3.0 * pixels as f64);
        let terms = (self.effective(pixels) / TAILS).max(1.0);
        let interval = ratio(terms, SPREAD * terms).map(|f| value * f);
        Figure { value, interval }
    }
}

impl Figure {
    /// The mean square of what is `apart` from something that has this one, both of so many terms.
    fn beyond(self, apart: f64, terms: f64) -> Figure {
        let product = 2.0 * (apart * self.value / terms).sqrt();
        let margin = normal_quantile() * product;
        let Interval { low, high } = self.interval;
        let interval =
            Interval { low: (apart + low - margin).max(0.0), high: apart + high + margin };
        Figure { value: apart + self.value, interval }
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Figure {
        Figure { value: f(self.value), interval: self.interval.map(f) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    fn film(pixels: &[&[f32]]) -> Film {
        let mut film = Film::default();
        film.clear(pixels.len(), pixels.len());
        for pass in 0..pixels[0].len() {
            for (i, samples) in pixels.iter().enumerate() {
                film.add(i, Rgb::splat(samples[pass]));
            }
            film.end_pass();
        }
        film
    }

    #[test]
    fn ten_million_equal_passes_keep_their_mean() {
        let mut film = Film::default();
        film.clear(1, 1);
        for _ in 0..10_000_000 {
            film.add(0, Rgb::splat(0.1));
            film.end_pass();
        }
        let e = film.estimate(1);
        assert!((e.mean[0][0] as f64 - 0.1).abs() < 1e-8);
        assert!(e.standard_error[0][0] < 1e-9);
    }

    #[test]
    fn a_lonely_pixel_has_the_error_of_its_replicates() {
        // Replicate means 1, 2, 3, 6: mean 3, variance of the mean = 14 / (4 * 3).
        let e = film(&[&[1.0, 2.0, 3.0, 6.0, 1.0, 2.0, 3.0, 6.0]]).estimate(1);
        assert_eq!(e.mean[0], [3.0; 3]);
        let variance = 14.0f64 / 12.0;
        assert!((e.standard_error[0][1] as f64 - variance.sqrt()).abs() < 1e-6);
        let error = e.sums.estimate(1, 8).unwrap();
        assert!((error.rmse.value - variance.sqrt()).abs() < 1e-12);
        // The pixel's own radiance less its noise: 27 / (27 + 3 variance) of 9.
        let against = 9.0 * 27.0 / (27.0 + 3.0 * variance) + 0.01;
        assert!((error.rel_mse.value - variance / against).abs() < 1e-12);
        assert!(error.relative.interval.contains(error.relative.value) && !error.reliable);
    }

    #[test]
    fn standard_errors_are_pooled_over_touching_pixels_of_the_rectangle() {
        let (still, shaken): (&[f32], &[f32]) = (&[2.0; 4], &[1.0, 2.0, 3.0, 6.0]);
        // Four pixels in a row; the first alone is noisy.
        let e = film(&[shaken, still, still, still]).estimate(4);
        let variance = 14.0f64 / 12.0;
        let expected = [variance / 2.0, variance / 3.0, 0.0, 0.0].map(f64::sqrt);
        for (found, expected) in e.standard_error.iter().zip(expected) {
            assert!((found[0] as f64 - expected).abs() < 1e-6, "{found:?} {expected}");
        }
        // The same pixels as a square all touch each other.
        let e = film(&[shaken, still, still, still]).estimate(2);
        assert!(
            e.standard_error.iter().all(|s| (s[2] as f64 - (variance / 4.0).sqrt()).abs() < 1e-6)
        );
    }

    /// One bright sample in a dim neighbourhood counts against the neighbourhood, a bright steady
    /// pixel against itself.
    #[test]
    fn a_firefly_is_measured_against_its_neighbours() {
        let dim: &[f32] = &[0.3; 4];
        let relative = |middle: &[f32]| {
            let pixels: Vec<&[f32]> = (0..9).map(|i| if i == 4 { middle } else { dim }).collect();
            film(&pixels).estimate(3).sums.estimate(9, 4).unwrap().rel_mse.value * 27.0
        };
        // Mean 10, variance of the mean 100.
        let firefly = relative(&[0.0, 0.0, 40.0, 0.0]);
        assert!((firefly / (3.0 * 100.0 / 0.1) - 1.0).abs() < 1e-6, "{firefly}");
        // Mean 10, variance of the mean 0.04 * 5 / 3.
        let steady = relative(&[9.4, 10.2, 10.6, 9.8]);
        let variance = (0.36 + 0.04 + 0.36 + 0.04) / 12.0;
        assert!((steady / (3.0 * variance / 100.0) - 1.0).abs() < 0.02, "{steady}");
    }

    #[test]
    fn what_a_coarser_picture_is_apart_adds_up_with_the_finer_one_s_error() {
        let finer = film(&[&[1.0, 2.0, 3.0, 6.0], &[0.2, 0.4, 0.4, 0.2]]).estimate(2);
        let error = finer.sums.estimate(2, 4).unwrap();
        let same = error.of_coarser(&finer.mean, &finer.mean);
        assert!((same.rel_mse.value / error.rel_mse.value - 1.0).abs() < 1e-12);
        let coarser = [[2.5; 3], [0.3, 0.3, 0.6]];
        let found = error.of_coarser(&coarser, &finer.mean);
        // 0.25 / 9.01 in three channels, 0.09 / 0.1 in one, over six of them.
        let apart = (3.0 * 0.25 / 9.01 + 0.09 / 0.1) / 6.0;
        assert!((found.rel_mse.value - error.rel_mse.value - apart).abs() < 1e-6);
        let squared = |e: &ErrorEstimate| e.rmse.value.powi(2);
        assert!((squared(&found) - squared(&error) - (3.0 * 0.25 + 0.09) / 6.0).abs() < 1e-6);
        let Interval { low, high } = found.rel_mse.interval;
        assert!(low < found.rel_mse.value && high > apart + error.rel_mse.interval.high);
        let none = ErrorEstimate { rel_mse: error.rel_mse.map(|_| 0.0), ..error };
        assert!(
            (none.of_coarser(&coarser, &finer.mean).rel_mse.interval.high - apart).abs() < 1e-6
        );
    }

    #[test]
    fn there_is_no_error_before_every_replicate_has_a_pass() {
        let e = film(&[&[1.0; REPLICATES - 1], &[1.0; REPLICATES - 1]]).estimate(2);
        assert!(e.standard_error.is_empty());
        assert_eq!(e.sums.estimate(2, 3), None);
    }

    #[test]
    fn tiles_add_up_and_a_missing_one_is_missed() {
        let a = film(&[&[1.0, 2.0, 3.0, 6.0]]).estimate(1).sums;
        let mut nine = a;
        (0..8).for_each(|_| nine.add(&a));
        assert_eq!(nine.estimate(10, 16), None);
        let (one, nine) = (a.estimate(1, 16).unwrap(), nine.estimate(9, 16).unwrap());
        assert!((one.rmse.value - nine.rmse.value).abs() < 1e-12);
        assert!(nine.rmse.interval.high < one.rmse.interval.high);
    }

    /// Pixels of noise whose deviations range over two decades, cubes of normal numbers in every
    /// tenth: the interval holds the error that this picture really has in 95 % of pictures or
    /// more (2000 pictures: 4 sigma are 2 %), though mostly no wider than a factor of two and a half.
    #[test]
    fn the_interval_holds_the_error_of_this_picture() {
        let mut state = 7u64;
        let mut normal = || {
            let sum: f64 = (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 40) as f64 / 16_777_216.0
                })
                .sum();
            sum - 6.0
        };
        let (pictures, mut held, mut narrow) = (2000, 0, 0);
        for _ in 0..pictures {
            let (mut sum, mut truth) = (Sum::default(), 0.0);
            for pixel in 0..100 {
                let deviation = 10f64.powf(pixel as f64 / 50.0);
                let long_tailed = |x: f64| if pixel % 10 == 0 { x * x * x } else { x };
                let replicates: [f64; REPLICATES] =
                    std::array::from_fn(|_| deviation * long_tailed(normal()));
                let mean = replicates.iter().sum::<f64>() / REPLICATES as f64;
                let squares: f64 = replicates.iter().map(|r| (r - mean).powi(2)).sum();
                sum.add(squares / (SPREAD * REPLICATES as f64));
                truth += mean * mean;
            }
            let figure = sum.figure(100);
            held += figure.interval.contains(truth / 300.0) as i32;
            narrow += (figure.interval.high < 6.25 * figure.value) as i32;
        }
        assert!(held >= pictures * 93 / 100 && narrow > pictures * 7 / 10, "{held} {narrow}");
    }
}
