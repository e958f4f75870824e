//! The procedure against one that is written down as the paper has it, and against renders.

use super::*;
use crate::brdf::{Model, Roughness};
use crate::progressive::{Params, Snapshot, render};
use crate::scene::{Camera, Material, SceneBuilder};
use glam::DVec3;
use std::sync::Arc;

/// Numbers in [0, 1) (Numerical Recipes' linear congruence is good enough for a test's input).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Sorted, as in the paper.
fn by_the_book(scores: &[f64]) -> usize {
    let mut chances: Vec<f64> =
        scores.iter().map(|&s| 2.0 * tail((s / STEP).floor() * STEP, DEGREES_OF_FREEDOM)).collect();
    chances.sort_by(f64::total_cmp);
    let n = chances.len() as f64;
    let good = |(i, p): (usize, &f64)| (*p <= (i + 1) as f64 / n * 0.05).then_some(i + 1);
    chances.iter().enumerate().filter_map(good).max().unwrap_or(0)
}

#[test]
fn the_table_of_steps_gives_what_sorting_gives() {
    let mut next = numbers(3);
    for n in [1usize, 2, 10, 1000] {
        for strength in [0.0, 1.0, 4.0, 30.0] {
            let scores: Vec<f64> = (0..n).map(|_| next() * (1.0 + strength * next())).collect();
            let limit = threshold(&scores);
            let found = scores.iter().filter(|&&s| s >= limit).count();
            assert_eq!(found, by_the_book(&scores), "{n} scores, {strength}");
        }
    }
}

fn one(value: f32) -> Picture {
    Picture { width: 1, height: 1, pixels: vec![[value; 3]] }
}

#[test]
fn exact_pictures_differ_or_not() {
    let compare = |a: f32, b: f32| {
        let (a, b) = (one(a), one(b));
        let exact = |mean| Noisy { mean, standard_error: None };
        let s = Significance::new(exact(&a), exact(&b)).unwrap();
        (s.pixels[0].significant, s.brighter, s.darker)
    };
    assert_eq!(compare(1.0, 1.0), (false, 0.0, 0.0));
    assert_eq!(compare(1.0, 1.5), (true, 1.0, 0.0));
    assert_eq!(compare(1.5, 0.0), (true, 0.0, 1.0));
    assert_eq!(compare(f32::NAN, 1.0), (false, 0.0, 0.0));
    assert_eq!(compare(f32::INFINITY, 1.0), (false, 0.0, 0.0));
    // Without a pass in every replicate nothing is known.
    let (a, b) = (one(1.0), one(2.0));
    let unknown = one(0.0);
    let a = Noisy { mean: &a, standard_error: Some(&unknown) };
    let s = Significance::new(a, Noisy { mean: &b, standard_error: None }).unwrap();
    assert_eq!(s.brighter, 0.0);
    let wide = Picture::black(2, 1);
    assert!(Significance::new(a, Noisy { mean: &wide, standard_error: None }).is_none());
}

/// A room with a glossy ball, a diffuse one, and a small emitter: sharp highlights, caustics, shadows.
fn room(model: Model, alpha: f64, seed: u64) -> Params {
    let mut b = SceneBuilder::new("room");
    let wall = Material::reflecting("wall", [0.6, 0.5, 0.4], [0.0; 3], 1.0).unwrap();
    let wall = b.material(wall);
    b.cuboid(DVec3::new(-3.0, -3.0, -1.0), DVec3::new(6.0, 6.0, 4.0), wall).unwrap();
    let metal = Material::reflecting("metal", [0.05; 3], [0.8, 0.7, 0.5], 60.0).unwrap();
    let metal = b.material(metal);
    b.sphere(DVec3::new(0.7, 0.3, 0.0), 0.9, metal).unwrap();
    b.sphere(DVec3::new(-1.2, 0.8, -0.4), 0.6, wall).unwrap();
    let emitter = b.material(Material::light("lamp", [40.0; 3]).unwrap());
    b.sphere(DVec3::new(-1.7, -0.6, 2.2), 0.2, emitter).unwrap();
    b.camera = Some(Camera::look_at(DVec3::new(0.0, -2.9, 0.6), DVec3::Y, 1.1).unwrap());
    b.screen = [120, 90];
    let params = Params { model, seed, ..Params::new(Arc::new(b.build())) };
    params.with_roughness(Roughness::from_alpha(alpha).unwrap())
}

fn compare(a: &Snapshot, b: &Snapshot) -> Significance {
    let [means, errors] = [Snapshot::mean, Snapshot::standard_error].map(|of| [of(a), of(b)]);
    let noisy = |i: usize| Noisy { mean: &means[i], standard_error: Some(&errors[i]) };
    Significance::new(noisy(0), noisy(1)).unwrap()
}

/// The same picture with other noise: whatever is called significant is wrong. Over all of these at
/// most one pixel of a thousand may be.
#[test]
fn other_noise_is_no_difference() {
    let (mut called, mut pixels) = (0usize, 0usize);
    for (model, alpha) in [(Model::Ggx, 0.2), (Model::Beckmann, 0.05), (Model::Phong, 0.5)] {
        for passes in [8, 40, 150] {
            let [a, b] = [1, 2].map(|seed| render(room(model, alpha, seed), passes, 0).unwrap());
            assert!(
                a.mean().pixels.iter().all(|p| p[1] > 0.0),
                "a room without light shows nothing"
            );
            let s = compare(&a, &b);
            called += s.pixels.iter().filter(|p| p.significant).count();
            pixels += s.pixels.len();
        }
    }
    assert!(called as f64 <= 1e-3 * pixels as f64, "{called} of {pixels}");
}

/// Another model changes the highlights, and both directions are found.
#[test]
fn another_model_is_a_difference() {
    let [a, b] = [Model::Beckmann, Model::Ggx].map(|m| render(room(m, 0.2, 1), 200, 0).unwrap());
    let s = compare(&a, &b);
    assert!(s.brighter > 0.005 && s.darker > 0.002, "{} and {}", s.brighter, s.darker);
    let back = compare(&b, &a);
    assert_eq!([s.brighter, s.darker], [back.darker, back.brighter]);
}
