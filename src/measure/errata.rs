//! What a mistake does to a picture: the same passes with it and without.
//!
//! Pictures are rendered in pairs of one seed, right ones too by the reference tracer, so that much
//! of their noise is the same and falls out of the difference; pairs have seeds of their own. Of R
//! pairs with pixels `x_k` and `r_k` and `d_k = x_k - r_k`, every figure below follows, the
//! differences' own noise subtracted.
//!
#![doc = include_str!("errata.md")]

use super::error::mean_margin;
use crate::brdf::{Erratum, Model};
use crate::picture::Picture;
use crate::progressive::{Params, ParamsError, render};

/// Effects of mistakes on one scene.
#[derive(Clone, Debug)]
pub struct Bench {
    /// What is rendered, but for model, seed and erratum. Its seed is that of the first pair.
    pub base: Params,
    /// Passes of each picture.
    pub passes: u64,
    /// How many pairs; at least 2, or nothing is known of the noise.
    pub pairs: u32,
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// What one mistake does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// `mean(x) / mean(r) - 1`: the picture as a whole, brighter or darker.
    pub change: f64,
    /// Half the 95 % Student interval of that, from the spread of the pairs; `None` for one pair.
    pub margin: Option<f64>,
    /// `sqrt(mean((x - r)² / (r² + 0.01)))` of the means over all pairs, noise subtracted; 0 where
    /// the noise is the larger.
    pub rel_rmse: f64,
    /// The root of what was subtracted: an effect below it is not seen.
    pub noise: f64,
    /// How many times larger the noise of a wrong picture is than that of a right one, each
    /// relative to `r`: their variances' ratio is this squared.
    pub noise_ratio: f64,
}

impl Bench {
    /// One picture a pair, with an erratum or right.
    pub fn pictures(
        &self,
        model: Model,
        erratum: Option<Erratum>,
    ) -> Result<Vec<Picture>, ParamsError> {
        let seeds = (0..u64::from(self.pairs)).map(|k| self.base.seed.wrapping_add(k));
        let picture = |seed| {
            // Pairs have the same random numbers, so that noise falls out of their difference.
            let uniform = true;
            let params =
                Params { model, erratum, seed, uniform, reference: true, ..self.base.clone() };
            Ok(render(params, self.passes, self.threads)?.mean())
        };
        seeds.map(picture).collect()
    }
}

impl Effect {
    /// From pictures of one size, pair by pair.
    pub fn between(wrong: &[Picture], right: &[Picture]) -> Effect {
        let pairs = wrong.len().min(right.len());
        let mean = |p: &Picture| {
            let sum: f64 = p.pixels.iter().flatten().map(|&c| f64::from(c)).sum();
            sum / (3 * p.pixels.len().max(1)) as f64
        };
        let changes: Vec<f64> =
            wrong.iter().zip(right).map(|(x, r)| mean(x) / mean(r) - 1.0).collect();
        let pixels = right.first().map_or(0, |p| p.pixels.len());
        let [mut squares, mut noise, mut of_wrong, mut of_right] = [0.0; 4];
        for pixel in 0..pixels {
            for channel in 0..3 {
                let value = |p: &Picture| f64::from(p.pixels[pixel][channel]);
                let (x, r) = (wrong.iter().map(value), right.iter().map(value));
                let d = spread(x.clone().zip(r.clone()).map(|(x, r)| x - r), pairs);
                let (x, r) = (spread(x, pairs), spread(r, pairs));
                let scale = 1.0 / (r.mean * r.mean + 0.01);
                squares += d.mean * d.mean * scale;
                noise += d.variance / pairs as f64 * scale;
                of_wrong += x.variance * scale;
                of_right += r.variance * scale;
            }
        }
        let values = (3 * pixels).max(1) as f64;
        Effect {
            change: changes.iter().sum::<f64>() / pairs.max(1) as f64,
            margin: mean_margin(&changes),
            rel_rmse: ((squares - noise).max(0.0) / values).sqrt(),
            noise: (noise / values).sqrt(),
            noise_ratio: (of_wrong / of_right).sqrt(),
        }
    }
}

/// Of a few numbers.
struct EffectSpread {
    mean: f64,
    /// NaN for fewer than two.
    variance: f64,
}

fn spread(values: impl Iterator<Item = f64> + Clone, n: usize) -> EffectSpread {
    let mean = values.clone().sum::<f64>() / n as f64;
    let squares: f64 = values.map(|v| (v - mean).powi(2)).sum();
    EffectSpread { mean, variance: squares / (n as f64 - 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures of 2000 values: a mean with noise of this deviation, from a fixed recurrence.
    fn noisy(mean: f32, deviation: f32, pairs: u32, salt: u32) -> Vec<Picture> {
        let mut state = salt;
        let mut unit = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut value = move || mean + deviation * 12f32.sqrt() * (unit() - 0.5);
        let picture = |_| {
            let pixels = (0..2000).map(|_| [value(), value(), value()]).collect();
            Picture { width: 50, height: 40, pixels }
        };
        (0..pairs).map(picture).collect()
    }

    #[test]
    fn a_known_bias_comes_out_and_the_noise_does_not() {
        for (bias, ratio) in [(0.2f32, 1.0f32), (0.02, 2.0), (0.0, 3.0)] {
            let right = noisy(1.0, 0.1, 8, 1);
            let wrong = noisy(1.0 + bias, 0.1 * ratio, 8, 2);
            let e = Effect::between(&wrong, &right);
            let expected = f64::from(bias);
            assert!((e.change - expected).abs() < 2.0 * e.margin.unwrap() + 1e-4, "{e:?}");
            assert!((e.rel_rmse - expected / 1.01f64.sqrt()).abs() < 0.01, "{e:?}");
            assert!((e.noise_ratio / f64::from(ratio) - 1.0).abs() < 0.02, "{e:?}");
        }
    }

    #[test]
    fn what_is_the_same_has_no_effect_at_all() {
        let right = noisy(1.0, 0.1, 4, 1);
        let e = Effect::between(&right, &right);
        assert_eq!((e.change, e.margin, e.rel_rmse, e.noise), (0.0, Some(0.0), 0.0, 0.0));
        assert_eq!(e.noise_ratio, 1.0);
        assert!(Effect::between(&right[..1], &right[..1]).margin.is_none());
    }
}
