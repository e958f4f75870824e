//! Where two pictures differ by more than their noise.
//!
//! Every pixel is asked whether the luminances of the two differ, by Student's t on their standard
//! errors. Of a million pixels fifty thousand would say so by chance at 95 %; which of them are
//! believed is therefore decided for all at once, by Benjamini and Hochberg's procedure
//! ("Controlling the false discovery rate", 1995, eq. 1): of the pixels that are called significant at
//! most 5 % are expected not to be, and where the pictures are the same up to noise there is not
//! one in 95 % of cases.
//!
//! The standard errors of the two are added as if the pictures were independent. Pictures traced
//! with common random numbers err alike, so that their difference has less noise than that: then the
//! answer errs to the side of "not significant".

use crate::film::{CONFIDENCE, DEGREES_OF_FREEDOM, tail};
use crate::picture::Picture;

/// A picture with what is known of its noise.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<'a> {
    /// Mean radiance.
    pub mean: &'a Picture,
    /// Standard error of every pixel and channel; `None` for a picture that is taken as exact.
    pub standard_error: Option<&'a Picture>,
}

/// What is known of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Luminance of the second picture less that of the first, over their mean: -2 to 2 for
    /// radiances of 0 and more; 0 where both are black.
    pub relative: f32,
    /// Whether that is more than noise.
    pub significant: bool,
}

/// The comparison of two pictures of one size.
#[derive(Clone, Debug)]
pub struct Significance {
    /// Row by row.
    pub pixels: Vec<Pixel>,
    /// The part of the pixels that are significantly brighter in the second picture.
    pub brighter: f64,
    /// The part that are significantly darker there.
    pub darker: f64,
    /// Standard errors from which on a difference is significant; infinite where none is.
    pub threshold: f64,
}

/// Luminance of linear Rec. 709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Scores are compared by their chances in steps of this; chances are rounded up.
const STEP: f64 = 1.0 / 64.0;
const STEPS: usize = 64 * 64;

impl Significance {
    /// Compares `b` with `a`. `None` where their sizes differ. Pixels that are not finite in one of
    /// them, and those whose noise is not known yet, are never significant.
    pub fn new(a: Noisy, b: Noisy) -> Option<Significance> {
        let size = |p: &Picture| (p.width, p.height, p.pixels.len());
        if size(a.mean) != size(b.mean) {
            return None;
        }
        let luminance = |p: &Picture, i: usize| weighed(p.pixels.get(i));
        // Channels err alike: their errors add up at most.
        let error =
            |of: Noisy, i: usize| of.standard_error.map_or(0.0, |p| weighed(p.pixels.get(i)));
        let known = |of: Noisy, i: usize| {
            let has =
                of.standard_error.is_none_or(|p| p.pixels.get(i).is_some_and(|e| *e != [0.0; 3]));
            // A pixel that is black in every replicate is known to be black as far as one knows.
            has || luminance(of.mean, i) == 0.0
        };
        let mut scores = Vec::with_capacity(a.mean.pixels.len());
        let mut pixels = Vec::with_capacity(a.mean.pixels.len());
        for i in 0..a.mean.pixels.len() {
            let [x, y] = [a, b].map(|of| luminance(of.mean, i));
            let noise = error(a, i).hypot(error(b, i));
            let score = match (y - x) / noise {
                score if score.is_finite() && known(a, i) && known(b, i) => score.abs(),
                // Two exact pictures differ or not.
                _ if noise == 0.0
                    && x != y
                    && (x - y).is_finite()
                    && known(a, i)
                    && known(b, i) =>
                {
                    f64::INFINITY
                }
                _ => 0.0,
            };
            let relative = (y - x) / (0.5 * (x + y));
            let relative = if relative.is_finite() { relative as f32 } else { 0.0 };
            scores.push(score);
            pixels.push(Pixel { relative, significant: false });
        }
        let threshold = threshold(&scores);
        let mut counts = [0usize; 2];
        for (pixel, score) in pixels.iter_mut().zip(scores) {
            pixel.significant = score >= threshold && pixel.relative != 0.0;
            counts[usize::from(pixel.relative > 0.0)] += usize::from(pixel.significant);
        }
        let part = |n: usize| n as f64 / pixels.len().max(1) as f64;
        let [darker, brighter] = counts.map(part);
        Some(Significance { pixels, brighter, darker, threshold })
    }
}

fn weighed(pixel: Option<&[f32; 3]>) -> f64 {
    let pixel = pixel.copied().unwrap_or_default();
    LUMINANCE.iter().zip(pixel).map(|(weight, x)| weight * f64::from(x)).sum()
}

/// The least score that is significant, by Benjamini and Hochberg: with chances in ascending order
/// p(1) to p(n), all up to the largest k with `p(k) <= k / n * (1 - CONFIDENCE)`.
fn threshold(scores: &[f64]) -> f64 {
    // How many scores are at least each step.
    let step = |score: f64| ((score / STEP) as usize).min(STEPS);
    let mut at_least = vec![0usize; STEPS + 2];
    for &score in scores {
        at_least[step(score)] += 1;
    }
    for i in (0..=STEPS).rev() {
        at_least[i] += at_least[i + 1];
    }
    let n = scores.len() as f64;
    let significant = |i: &usize| {
        let chance = 2.0 * tail(*i as f64 * STEP, DEGREES_OF_FREEDOM);
        at_least[*i] > 0 && chance <= at_least[*i] as f64 / n * (1.0 - CONFIDENCE)
    };
    // Chances fall with the score: the first step is the largest k.
    (1..=STEPS).find(significant).map_or(f64::INFINITY, |i| i as f64 * STEP)
}

#[cfg(test)]
mod tests;
