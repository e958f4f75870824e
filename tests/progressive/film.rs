//! Sums of samples: long, spread out, in parts.

use crate::support::Random;
use burnish::film::{CELL, Film};
use burnish::math::Rgb;
use burnish::math::simd::U32;
use burnish::math::sobol::{REPLICATES, Slot, Stream};
use burnish::progressive::{Counts, Session};

fn film(samples: impl Iterator<Item = f32>) -> Film {
    let mut film = Film::default();
    film.clear(1, 1);
    for sample in samples {
        film.begin_pass();
        film.add(0, Rgb::new(sample, 2.0 * sample, 0.0));
        film.end_pass();
    }
    film
}

/// Of long tails: the logarithm is normal with a deviation of 2.
fn lognormal(r: &mut Random) -> f32 {
    let normal: f64 = (0..12).map(|_| r.within(0.0, 1.0)).sum::<f64>() - 6.0;
    (2.0 * normal).exp() as f32
}

/// The sum in f64 with the lost digits carried along (Neumaier 1974).
fn exact_mean(samples: &[f32]) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for x in samples.iter().map(|&x| x as f64) {
        let next = sum + x;
        lost += if sum.abs() >= x.abs() { (sum - next) + x } else { (x - next) + sum };
        sum = next;
    }
    (sum + lost) / samples.len() as f64
}

/// 100,000 passes of long-tailed samples, where sums in single precision are off by 1e-5.
#[test]
fn the_mean_is_that_of_a_sum_that_loses_nothing() {
    for seed in 0..5 {
        let mut r = Random::new(seed);
        let samples: Vec<f32> = (0..100_000).map(|_| lognormal(&mut r)).collect();
        let mean = film(samples.iter().copied()).estimate(1).mean[0];
        let exact = exact_mean(&samples);
        // The mean is told in f32: half a rounding.
        assert!((mean[0] as f64 / exact - 1.0).abs() < 6.1e-8, "{} {exact}", mean[0]);
        assert_eq!((mean[1], mean[2]), (2.0 * mean[0], 0.0));
    }
}

/// A spread of a thousandth of the mean: sums of squares in f32 would be off by more than half.
#[test]
fn a_small_spread_about_a_large_mean_is_kept() {
    let mut r = Random::new(6);
    let samples: Vec<f32> = (0..4096).map(|_| (1000.0 + r.within(-1.0, 1.0)) as f32).collect();
    let estimate = film(samples.iter().copied()).estimate(1);
    let parts: Vec<f64> = (0..REPLICATES)
        .map(|k| {
            let part: Vec<f32> = samples.iter().copied().skip(k).step_by(REPLICATES).collect();
            exact_mean(&part)
        })
        .collect();
    let mean = parts.iter().sum::<f64>() / REPLICATES as f64;
    let squares: f64 = parts.iter().map(|p| (p - mean).powi(2)).sum();
    let expected = (squares / (REPLICATES * (REPLICATES - 1)) as f64).sqrt();
    let found = estimate.standard_error[0][0] as f64;
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

/// Passes in two films, the even ones and the odd ones, are together the film of all.
#[test]
fn two_halves_sum_to_the_whole() {
    let mut r = Random::new(7);
    for passes in [2usize, 64, 1001] {
        let samples: Vec<f32> = (0..passes).map(|_| lognormal(&mut r)).collect();
        let of = |skip| samples.iter().copied().skip(skip).step_by(2);
        let mean = |f: &Film| f.estimate(1).mean[0][0] as f64;
        let (even, odd, all) = (film(of(0)), film(of(1)), film(samples.iter().copied()));
        assert_eq!(even.passes() + odd.passes(), all.passes());
        let sum = mean(&even) * even.passes() as f64 + mean(&odd) * odd.passes() as f64;
        let off = sum / (mean(&all) * all.passes() as f64) - 1.0;
        assert!(off.abs() < 2e-7, "{passes} passes: {off}");
    }
}

/// 4,294,967,296 samples are an hour's work: nothing that counts them may be narrower than 64 bits,
/// and their numbers go on being new.
#[test]
fn counts_have_64_bits_and_the_sequence_does_not_begin_again() {
    let Counts { paths, rays, nonfinite, capped } = Counts::default();
    let counts: [u64; 4] = [paths, rays, nonfinite, capped];
    let passes: u64 = Film::default().passes();
    assert_eq!((counts, passes), ([0; 4], 0));
    assert!(Session::MAX_PASSES > u64::from(u32::MAX));

    let numbers = |pass: u64| -> Vec<[u32; 2]> {
        let stream = Stream::new(3, U32(10), U32(20), pass);
        (0..8).map(|event| stream.pair_bits(Slot::light(event)).map(|b| b.0)).collect()
    };
    // One, and at the turns of the 16 bits of an index and of the 32 bits of a pass.
    let far = [5, (1 << 18) + 5, (1 << 32) - 3, (1 << 32) + 5, (1 << 33) + 5, (1 << 40) + 5];
    for (i, &a) in far.iter().enumerate() {
        for &b in &far[..i] {
            let (x, y) = (numbers(a), numbers(b));
            assert!(x.iter().zip(&y).all(|(x, y)| x != y), "passes {a} and {b} are alike");
        }
    }
}

/// Once replicates have different numbers of samples, each counts as much as the others: the mean is
/// that of their means, and so is its variance.
#[test]
fn uneven_replicates_count_alike() {
    let mut film = Film::default();
    let width = CELL + 4;
    film.clear(width, width);
    // Replicates of the first cell's pixels: 1; 2, 4; 3; 6, 6, 6.
    let samples: [&[f32]; REPLICATES] = [&[1.0], &[2.0, 4.0], &[3.0], &[6.0, 6.0, 6.0]];
    for (replicate, samples) in samples.into_iter().enumerate() {
        for &x in samples {
            (0..CELL).for_each(|pixel| film.add_to(pixel, replicate, Rgb::splat(x)));
            film.count_samples(0, replicate);
        }
    }
    // As passes in turn would have it, but chosen: 1, 5; 3, 3; 8; 4.
    let samples: [&[f32]; REPLICATES] = [&[1.0, 5.0], &[3.0, 3.0], &[8.0], &[4.0]];
    for (replicate, samples) in samples.into_iter().enumerate() {
        for &x in samples {
            (CELL..width).for_each(|pixel| film.add_to(pixel, replicate, Rgb::splat(x)));
            film.count_samples(1, replicate);
        }
    }
    (0..REPLICATES).for_each(|_| film.end_uneven_pass());
    assert_eq!((film.cells(), film.samples(0), film.samples(1)), (2, 7, 6));
    let found = film.estimate(width);
    assert_eq!(found.mean[3], [(1.0 + 3.0 + 3.0 + 6.0) / 4.0; 3]);
    assert_eq!(found.mean[CELL + 1], [(3.0 + 3.0 + 8.0 + 4.0) / 4.0; 3]);
    let squares: f64 = [1.0, 3.0, 3.0, 6.0].iter().map(|m: &f64| (m - 3.25).powi(2)).sum();
    let expected = (squares / 12.0).sqrt();
    assert!((f64::from(found.standard_error[3][0]) - expected).abs() < 1e-6);
}
