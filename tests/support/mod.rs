//! Oracles for the tests: slow, plain, and independent of the code under test.
#![allow(dead_code, missing_docs, unreachable_pub)] // each test file uses its own part

use burnish::scene::Mesh;
use glam::{DAffine3, DQuat, DVec3};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A small generator for test inputs (PCG, O'Neill 2014), unrelated to the renderer's streams.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        let mut r = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1));
        r.bits();
        r
    }
    pub fn bits(&mut self) -> u32 {
        let old = self.0;
        self.0 =
            old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((((old >> 18) ^ old) >> 27) as u32).rotate_right((old >> 59) as u32)
    }
    /// Uniform in [0, 1 - 2^-24].
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }
    pub fn pair(&mut self) -> [f32; 2] {
        [self.unit(), self.unit()]
    }
    /// Uniform in `[a, b)`.
    pub fn within(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.bits() as f64 / 4_294_967_296.0
    }
    /// A unit direction, uniform over the sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        let z = self.within(-1.0, 1.0);
        let phi = self.within(0.0, TAU);
        let r = (1.0 - z * z).sqrt();
        [r * phi.cos(), r * phi.sin(), z]
    }
}

/// A number with its standard error, gathered one sample at a time (Welford).
#[derive(Clone, Copy, Default)]
pub struct Mean {
    pub n: u64,
    pub mean: f64,
    squares: f64,
}

impl Mean {
    pub fn add(&mut self, x: f64) {
        self.n += 1;
        let d = x - self.mean;
        self.mean += d / self.n as f64;
        self.squares += d * (x - self.mean);
    }
    pub fn standard_error(&self) -> f64 {
        (self.squares / (self.n as f64 - 1.0) / self.n as f64).sqrt()
    }
    /// Distance to `expected` in standard errors, as rare as so many of a normal variable: a standard error
    /// from few samples is itself uncertain (Student's t to a normal one, Wallace 1959).
    pub fn sigmas(&self, expected: f64) -> f64 {
        let se = self.standard_error();
        let d = (self.mean - expected).abs();
        if se > 0.0 {
            let (n, t) = (self.n as f64 - 1.0, d / se);
            (n * (t * t / n).ln_1p()).sqrt() * (8.0 * n + 1.0) / (8.0 * n + 3.0)
        } else if d <= 1e-6 * expected.abs() {
            0.0
        } else {
            f64::INFINITY
        }
    }
}

/// Kolmogorov-Smirnov: the probability of a distance from uniform at least as large as seen.
pub fn ks_uniform(mut xs: Vec<f64>) -> f64 {
    xs.sort_by(f64::total_cmp);
    let n = xs.len() as f64;
    let d = xs.iter().enumerate().fold(0.0f64, |d, (i, &x)| {
        d.max((x - i as f64 / n).abs()).max(((i + 1) as f64 / n - x).abs())
    });
    let t = d * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    let sum: f64 = (1..=100)
        .map(|k| {
            let k = k as f64;
            (if k as i64 % 2 == 1 { 1.0 } else { -1.0 }) * (-2.0 * k * k * t * t).exp()
        })
        .sum();
    (2.0 * sum).clamp(0.0, 1.0)
}

/// Pearson's chi-square: how many standard normal deviations the statistic lies above its mean
/// (Wilson-Hilferty). Cells below five expected counts are pooled.
pub fn chi_square_sigmas(observed: &[f64], expected: &[f64]) -> f64 {
    let (mut x2, mut cells) = (0.0, 0);
    let (mut po, mut pe) = (0.0, 0.0);
    for (&o, &e) in observed.iter().zip(expected) {
        if e < 5.0 {
            po += o;
            pe += e;
        } else {
            x2 += (o - e) * (o - e) / e;
            cells += 1;
        }
    }
    if pe > 0.0 {
        x2 += (po - pe) * (po - pe) / pe.max(1e-3);
        cells += 1;
    }
    let k = (cells - 1) as f64;
    ((x2 / k).cbrt() - (1.0 - 2.0 / (9.0 * k))) / (2.0 / (9.0 * k)).sqrt()
}

/// The error function in f64: its series, and beyond 3 the continued fraction of erfc.
pub fn erfc(x: f64) -> f64 {
    if x < 0.0 {
        return 2.0 - erfc(-x);
    }
    if x > 3.0 {
        let k = (1..200).rev().fold(x, |tail, n| x + n as f64 * 0.5 / tail);
        return (-x * x).exp() / (k * std::f64::consts::PI.sqrt());
    }
    let (mut term, mut sum) = (x, x);
    for n in 1..200 {
        term *= -x * x / n as f64;
        sum += term / (2 * n + 1) as f64;
    }
    1.0 - sum * 2.0 / std::f64::consts::PI.sqrt()
}

/// A sphere of triangles: an octahedron, each face split into four `levels` times.
pub fn ball(levels: u32) -> Mesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut positions: Vec<DVec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for x in [0, 1] {
        for y in [2, 3] {
            for z in [4, 5] {
                triangles.push([x, y, z]);
            }
        }
    }
    split(&mut positions, &mut triangles, levels);
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Splits each triangle of a unit sphere into four, `levels` times.
pub fn split(positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>, levels: u32) {
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for &[a, b, c] in triangles.iter() {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        *triangles = finer;
    }
}

/// Uniform in a cube of this half side around the origin.
pub fn vector(r: &mut Random, size: f64) -> DVec3 {
    DVec3::new(r.within(-size, size), r.within(-size, size), r.within(-size, size))
}

/// A rotation, a scale from 1e-4 to 1e4, and an offset of up to 1e5 times that.
pub fn place(r: &mut Random) -> DAffine3 {
    let axis = DVec3::from(r.direction());
    let scale = 10f64.powf(r.within(-4.0, 4.0));
    let offset = vector(r, 1.0) * scale * 10f64.powf(r.within(-2.0, 5.0));
    let turn = DQuat::from_axis_angle(axis, r.within(0.0, TAU));
    DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, offset)
}
