//! What a test needs of statistics, and the numbers that it draws.

use crate::math::simd::U32;
use crate::math::sobol::{Slot, Stream, pair};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Independent uniform numbers: the renderer's stream, of a new pixel each.
pub(super) struct Random {
    seed: u64,
    drawn: u32,
}

impl Random {
    pub(super) fn new(seed: u64) -> Random {
        Random { seed, drawn: 0 }
    }

    /// Two in [0, 1).
    pub(super) fn pair(&mut self) -> [f32; 2] {
        let stream = Stream::new(self.seed, U32(self.drawn & 0xffff), U32(self.drawn >> 16), 0);
        self.drawn = self.drawn.wrapping_add(1);
        pair(&stream, Slot::CAMERA)
    }

    /// One in [low, high).
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.pair()[0])
    }
}

/// Numbers with their mean, gathered one at a time (Welford).
#[derive(Clone, Copy, Default)]
pub(super) struct Mean {
    n: f64,
    pub mean: f64,
    squares: f64,
}

impl Mean {
    pub(super) fn of(values: impl IntoIterator<Item = f64>) -> Mean {
        let mut mean = Mean::default();
        for x in values {
            mean.n += 1.0;
            let d = x - mean.mean;
            mean.mean += d / mean.n;
            mean.squares += d * (x - mean.mean);
        }
        mean
    }

    fn variance_of_mean(&self) -> f64 {
        self.squares / (self.n - 1.0) / self.n
    }

    /// The chance of a mean at least this far from `expected`, by Student's t. A difference within
    /// `rounding` is none: numbers that hardly vary differ by their rounding alone.
    pub(super) fn chance(&self, expected: f64, rounding: f64) -> f64 {
        student(self.mean - expected, rounding, self.variance_of_mean(), self.n - 1.0)
    }

    /// The chance of two means at least this far apart (Welch).
    pub(super) fn chance_with(&self, o: &Mean, rounding: f64) -> f64 {
        let (a, b) = (self.variance_of_mean(), o.variance_of_mean());
        let freedom = (a + b).powi(2) / (a * a / (self.n - 1.0) + b * b / (o.n - 1.0));
        let freedom = if freedom.is_finite() { freedom } else { 1.0 };
        student(self.mean - o.mean, rounding, a + b, freedom)
    }
}

fn student(difference: f64, rounding: f64, variance: f64, freedom: f64) -> f64 {
    let beyond = (difference.abs() - rounding).max(0.0);
    if beyond == 0.0 {
        return 1.0;
    }
    // Not finite means not proved.
    let t = beyond / variance.sqrt();
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| 2.0 * student.sf(t))
}

/// Pearson's chi-square: the chance of counts at least this far from those expected. Cells that
/// expect fewer than five are pooled.
pub(super) fn chi_square(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut x2, mut cells) = (0.0, -1.0f64);
    let (mut few, mut few_expected) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            few += o;
            few_expected += e;
        } else {
            x2 += (o - e) * (o - e) / e;
            cells += 1.0;
        }
    }
    if few + few_expected > 0.0 {
        // A floor below which Pearson's statistic is no chi-square at all.
        x2 += (few - few_expected).powi(2) / few_expected.max(1.0);
        cells += 1.0;
    }
    ChiSquared::new(cells.max(1.0)).map_or(f64::NAN, |chi| chi.sf(x2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_are_those_of_the_tables() {
        // Student, 9 degrees of freedom: 4.781 is exceeded by one in a thousand.
        let mean = Mean::of((0..10).map(|i| f64::from(i % 2)));
        let se = mean.variance_of_mean().sqrt();
        assert!((mean.chance(0.5 + 4.781 * se, 0.0) - 1e-3).abs() < 1e-5);
        assert_eq!(mean.chance(0.5 + 1e-9, 1e-8), 1.0);
        // Chi-square, 3 degrees: 16.27.
        let off = (16.266f64 / 2.0 * 100.0).sqrt();
        let p = chi_square(&[100.0 + off, 100.0 - off, 100.0, 100.0], &[100.0; 4]);
        assert!((p - 1e-3).abs() < 1e-5, "{p}");
    }

    #[test]
    fn constants_that_differ_have_no_chance() {
        let (a, b) = (Mean::of([1.0; 8]), Mean::of([2.0; 8]));
        assert_eq!((a.chance(1.5, 0.0), a.chance_with(&b, 0.0)), (0.0, 0.0));
        assert_eq!(a.chance_with(&a, 0.0), 1.0);
    }
}
