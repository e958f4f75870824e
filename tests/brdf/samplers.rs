//! Every sampler against its own density.

use crate::support::{Mean, Random, chi_square_sigmas, erfc, ks_uniform};
use burnish::brdf::{
    Alpha, Beckmann, BrdfParams, FullNdf, Ggx, Microfacet, Model, ModelVisitor, Phong, Roughness,
};
use burnish::math::{Rgb, V3, warp};
use std::f64::consts::{PI, TAU};

const ALPHAS: [f64; 7] = [1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0];
const COSINES: [f64; 7] = [1.0, 0.95, 0.5, 0.1, 1e-3, 1e-5, 1e-7];
/// Below this probability a fixed-seed test counts as failed; some 300 are made.
const SIGNIFICANCE: f64 = 1e-5;

fn width(alpha: f64) -> Alpha {
    Roughness::from_alpha(alpha).unwrap().into()
}

fn viewer(cos: f64, phi: f64) -> V3 {
    let sin = (1.0 - cos * cos).sqrt();
    V3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32)
}

fn normals<M: Microfacet>(w: Alpha, wo: V3, seed: u64) -> Vec<[f64; 3]> {
    let mut r = Random::new(seed);
    (0..20_000)
        .map(|_| {
            let m = M::sample_wm(w, wo, r.pair());
            [m.x as f64, m.y as f64, m.z as f64]
        })
        .collect()
}

fn assert_uniform(name: &str, xs: Vec<f64>) {
    assert!(xs.iter().all(|x| (-1e-5..=1.0 + 1e-5).contains(x)), "{name}: outside [0, 1]");
    let p = ks_uniform(xs);
    assert!(p > SIGNIFICANCE, "{name}: p = {p:e}");
}

fn turn(y: f64, x: f64) -> f64 {
    (y.atan2(x) / TAU).rem_euclid(1.0)
}

#[test]
fn phong_normals_map_back_to_uniform_numbers() {
    for alpha in ALPHAS {
        let w = width(alpha);
        let ms = normals::<Phong>(w, viewer(0.5, 0.3), 1);
        // cos^(a+2), by way of the tangent, which single precision keeps.
        let cos = |m: &[f64; 3]| {
            let tan2 = (m[0] * m[0] + m[1] * m[1]) / (m[2] * m[2]);
            (-(w.exponent as f64 + 2.0) * 0.5 * tan2.ln_1p()).exp()
        };
        assert_uniform(&format!("phong {alpha} cos"), ms.iter().map(cos).collect());
        let phi = |m: &[f64; 3]| turn(m[1], m[0]);
        assert_uniform(&format!("phong {alpha} phi"), ms.iter().map(phi).collect());
    }
}

#[test]
fn ggx_visible_normals_map_back_to_uniform_numbers() {
    for alpha in ALPHAS {
        for cos in COSINES {
            let wo = viewer(cos, 0.7);
            let a = width(alpha).alpha as f64;
            let v = normalize([a * wo.x as f64, a * wo.y as f64, wo.z as f64]);
            let (mut heights, mut turns) = (Vec::new(), Vec::new());
            for m in normals::<Ggx>(width(alpha), wo, 2) {
                let n = normalize([m[0] / a, m[1] / a, m[2]]);
                let dot = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
                let c = [0, 1, 2].map(|k| 2.0 * dot * n[k] - v[k]);
                heights.push((2.0 * dot * n[2]) / (1.0 + v[2]));
                turns.push(turn(c[1], c[0]));
            }
            assert_uniform(&format!("ggx {alpha} {cos} height"), heights);
            assert_uniform(&format!("ggx {alpha} {cos} turn"), turns);
        }
    }
}

#[test]
fn beckmann_visible_normals_map_back_to_uniform_numbers() {
    for alpha in ALPHAS {
        for cos in COSINES {
            let wo = viewer(cos, -1.1);
            let a = width(alpha).alpha as f64;
            let v = [a * wo.x as f64, a * wo.y as f64, wo.z as f64];
            let across = v[0].hypot(v[1]);
            let (cp, sp) = if across > 0.0 { (v[0] / across, v[1] / across) } else { (1.0, 0.0) };
            let cot = (v[2] / across).min(1e12);
            let visible = |x: f64| erfc(-x) + (-x * x).exp() / cot / PI.sqrt();
            let all = visible(cot.min(20.0));
            let (mut xs, mut ys) = (Vec::new(), Vec::new());
            for m in normals::<Beckmann>(width(alpha), wo, 3) {
                let (sx, sy) = (-m[0] / m[2] / a, -m[1] / m[2] / a);
                xs.push(visible((sx * cp + sy * sp).min(cot)) / all);
                ys.push(erfc(-(sy * cp - sx * sp)) * 0.5);
            }
            assert_uniform(&format!("beckmann {alpha} {cos} x"), xs);
            assert_uniform(&format!("beckmann {alpha} {cos} y"), ys);
        }
    }
}

/// Normals drawn from D cos: the distribution functions of tan² are 1 - exp(-tan²/alpha²) and
/// tan² / (alpha² + tan²), whoever looks.
#[test]
fn normals_of_the_distribution_map_back_to_uniform_numbers() {
    for alpha in ALPHAS {
        let wo = viewer(0.1, 0.7);
        let a2 = (width(alpha).alpha as f64).powi(2);
        let tan2 = |m: &[f64; 3]| (m[0] * m[0] + m[1] * m[1]) / (m[2] * m[2]) / a2;
        let beckmann = normals::<FullNdf<Beckmann>>(width(alpha), wo, 9);
        let ggx = normals::<FullNdf<Ggx>>(width(alpha), wo, 10);
        let heights = beckmann.iter().map(|m| (-tan2(m)).exp()).collect();
        assert_uniform(&format!("all of beckmann {alpha} height"), heights);
        let heights = ggx.iter().map(|m| 1.0 / (1.0 + tan2(m))).collect();
        assert_uniform(&format!("all of ggx {alpha} height"), heights);
        for (name, ms) in [("beckmann", beckmann), ("ggx", ggx)] {
            let turns = ms.iter().map(|m| turn(m[1], m[0])).collect();
            assert_uniform(&format!("all of {name} {alpha} turn"), turns);
        }
    }
}

fn normalize(v: [f64; 3]) -> [f64; 3] {
    let n = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / n)
}

/// Histogram of sampled directions against the density integrated over each cell.
struct Directions {
    params: BrdfParams,
    wo: V3,
}

const RINGS: usize = 24;
const SECTORS: usize = 32;

impl ModelVisitor for Directions {
    /// Chi-square in standard deviations, and the integral of the density.
    type Output = (f64, f64);
    fn visit<M: Microfacet>(self) -> (f64, f64) {
        let n = 300_000;
        let mut observed = vec![0.0; RINGS * SECTORS + 1];
        let mut r = Random::new(4);
        for _ in 0..n {
            let s = self.params.sample::<M>(self.wo, r.unit(), r.pair());
            let cell = if s.pdf > 0.0 {
                let ring = (s.wi.z as f64 * RINGS as f64) as usize;
                let sector = turn(s.wi.y as f64, s.wi.x as f64) * SECTORS as f64;
                ring.min(RINGS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)
            } else {
                RINGS * SECTORS
            };
            observed[cell] += 1.0;
        }
        let fine = if self.params.roughness.alpha < 0.2 { 48 } else { 16 };
        let mut expected = vec![0.0; RINGS * SECTORS + 1];
        for (cell, sum) in expected[..RINGS * SECTORS].iter_mut().enumerate() {
            for i in 0..fine * fine {
                let z = (cell / SECTORS) as f64 + ((i / fine) as f64 + 0.5) / fine as f64;
                let phi = (cell % SECTORS) as f64 + ((i % fine) as f64 + 0.5) / fine as f64;
                let wi = viewer(z / RINGS as f64, phi / SECTORS as f64 * TAU);
                *sum += self.params.eval::<M>(self.wo, wi).pdf as f64;
            }
            *sum *= TAU / (RINGS * SECTORS * fine * fine) as f64 * n as f64;
        }
        let total: f64 = expected.iter().sum::<f64>() / n as f64;
        // What is missing went below the horizon.
        expected[RINGS * SECTORS] = (1.0 - total).max(0.0) * n as f64;
        (chi_square_sigmas(&observed, &expected), total)
    }
}

#[test]
fn directions_follow_the_density_of_the_mixture() {
    for model in Model::ALL {
        for alpha in [0.1, 0.15, 0.3, 0.6, 1.0] {
            for cos in [0.999, 0.7, 0.3] {
                for (kd, ks) in [(0.5, 0.2), (0.0, 0.8), (0.6, 0.0)] {
                    let params = BrdfParams {
                        kd: Rgb::splat(kd),
                        ks: Rgb::splat(ks),
                        roughness: width(alpha),
                    };
                    let (sigmas, total) = model.visit(Directions { params, wo: viewer(cos, 0.4) });
                    let case = format!("{model:?} {alpha} {cos} {kd} {ks}");
                    assert!(sigmas < 4.5, "{case}: chi-square {sigmas} sigmas");
                    assert!(total < 1.0 + 1e-3, "{case}: density integrates to {total}");
                }
            }
        }
    }
}

#[test]
fn directions_of_the_distributions_normals_follow_their_density() {
    for alpha in [0.1, 0.15, 0.3, 0.6, 1.0] {
        for cos in [0.999, 0.7, 0.3] {
            let params =
                BrdfParams { kd: Rgb::BLACK, ks: Rgb::splat(0.8), roughness: width(alpha) };
            let directions = || Directions { params, wo: viewer(cos, 0.4) };
            let beckmann = directions().visit::<FullNdf<Beckmann>>();
            let ggx = directions().visit::<FullNdf<Ggx>>();
            for (name, (sigmas, total)) in [("beckmann", beckmann), ("ggx", ggx)] {
                let case = format!("{name} {alpha} {cos}");
                assert!(sigmas < 4.5, "{case}: chi-square {sigmas} sigmas");
                assert!(total < 1.0 + 1e-3, "{case}: density integrates to {total}");
            }
        }
    }
}

/// The value and density that come with a sample are those of its direction, and the mean weight
/// is the albedo found by asking in all directions alike.
struct Consistency {
    params: BrdfParams,
    wo: V3,
}

impl ModelVisitor for Consistency {
    type Output = (f64, Mean, Mean);
    fn visit<M: Microfacet>(self) -> Self::Output {
        let (mut worst, mut sampled, mut uniform) = (0.0f64, Mean::default(), Mean::default());
        let mut r = Random::new(5);
        for _ in 0..40_000 {
            let s = self.params.sample::<M>(self.wo, r.unit(), r.pair());
            if s.pdf > 0.0 {
                let e = self.params.eval::<M>(self.wo, s.wi);
                worst = worst
                    .max((s.pdf / e.pdf - 1.0).abs() as f64)
                    .max((s.f.r / e.f.r - 1.0).abs() as f64);
                sampled.add((s.f.r * s.wi.z / s.pdf) as f64);
            } else {
                sampled.add(0.0);
            }
            let wi = warp::cosine_hemisphere(r.pair());
            uniform.add(self.params.eval::<M>(self.wo, wi).f.r as f64 * PI);
        }
        (worst, sampled, uniform)
    }
}

#[test]
fn samples_carry_the_value_and_density_of_their_direction() {
    for model in Model::ALL {
        for (alpha, bound) in [(0.02, 2e-2), (0.1, 1e-3), (0.4, 3e-4), (1.0, 3e-4)] {
            for cos in [0.99, 0.5, 0.1] {
                let params = BrdfParams {
                    kd: Rgb::splat(0.4),
                    ks: Rgb::splat(0.3),
                    roughness: width(alpha),
                };
                let (worst, sampled, uniform) =
                    model.visit(Consistency { params, wo: viewer(cos, 2.0) });
                let case = format!("{model:?} {alpha} {cos}");
                assert!(worst < bound, "{case}: off by {worst}");
                if alpha >= 0.4 {
                    let se = sampled.standard_error().hypot(uniform.standard_error());
                    let sigmas = (sampled.mean - uniform.mean).abs() / se;
                    assert!(sigmas < 4.5, "{case}: albedo {} and {}", sampled.mean, uniform.mean);
                }
            }
        }
    }
}

/// Directional albedos E1 of the lobe with F = 1 and E5 of the one with F = (1 - cos)^5, by
/// quadrature to 1e-12: a lobe of any Ks has `Ks E1 + (1 - Ks) E5`.
const ALBEDOS: &str = include_str!("../data/albedo.csv");

/// Albedos of three channels by sampling: the mean weights of independent sets of samples.
struct Albedo {
    params: BrdfParams,
    wo: V3,
    strata: usize,
    seed: u64,
}

const SETS: u64 = 16;

impl ModelVisitor for Albedo {
    type Output = [Mean; 3];
    /// Each set has one sample in every cell of a grid over the unit square, and lobes chosen by
    /// a golden-ratio sequence: fewer samples do, and sets stay independent of each other.
    fn visit<M: Microfacet>(self) -> [Mean; 3] {
        let brdf = self.params.at_wo::<M>(self.wo);
        let (mut r, n) = (Random::new(self.seed), self.strata);
        let mut means = [Mean::default(); 3];
        for _ in 0..SETS {
            let (shift, mut sums) = (r.unit() as f64, [0.0; 3]);
            for cell in 0..n * n {
                let within = |place: usize, x: f32| (place as f32 + x) / n as f32;
                let u = [within(cell % n, r.unit()), within(cell / n, r.unit())];
                let u = u.map(|u| u.min(1.0 - f32::EPSILON / 2.0));
                let choice = (shift + 0.618_033_988_749_895 * cell as f64).fract() as f32;
                let s = brdf.sample::<M>(choice.min(1.0 - f32::EPSILON / 2.0), u);
                // What fell below the horizon found nothing, and counts.
                if s.pdf > 0.0 {
                    let weight = s.wi.z as f64 / s.pdf as f64;
                    for (sum, f) in sums.iter_mut().zip([s.f.r, s.f.g, s.f.b]) {
                        *sum += f as f64 * weight;
                    }
                }
            }
            for (mean, sum) in means.iter_mut().zip(sums) {
                mean.add(sum / (n * n) as f64);
            }
        }
        means
    }
}

/// Every row of the table, for a lobe alone and for every fifteenth also with a diffuse one,
/// both in three channels that differ: the one that is sampled least may not suffer.
#[test]
fn albedos_by_sampling_are_those_of_the_table() {
    let (mut checks, mut worst) = (0, 0.0f64);
    for (row, line) in ALBEDOS.lines().skip(1).enumerate() {
        let (name, numbers) = line.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|x| x.parse().unwrap()).collect();
        let [parameter, cos, e1, e5] = numbers[..] else { panic!("{line}") };
        let model = Model::ALL.into_iter().find(|m| m.name() == name).unwrap();
        let roughness = match model {
            Model::Phong => Roughness::from_exponent(parameter).unwrap(),
            _ => Roughness::from_alpha(parameter).unwrap(),
        };
        let alone = ([0.0; 3], [1.0, 0.5, 0.04]);
        let mixed = ([0.2, 0.0, 0.7], [0.04, 0.9, 0.3]);
        for (kd, ks) in if row % 15 == 0 { vec![alone, mixed] } else { vec![alone] } {
            let rgb = |c: [f32; 3]| Rgb::new(c[0], c[1], c[2]);
            let params = BrdfParams { kd: rgb(kd), ks: rgb(ks), roughness: roughness.into() };
            let means = |strata| {
                let wo = viewer(cos, 0.9);
                model.visit(Albedo { params, wo, strata, seed: 100 + row as u64 })
            };
            // Phong's normals are drawn whoever looks, which costs noise.
            let noisy = |found: &[Mean; 3]| found.iter().any(|m| m.standard_error() > 2.2e-4);
            let mut found = means(32);
            for strata in [64, 160] {
                if noisy(&found) {
                    found = means(strata);
                }
            }
            for (c, mean) in found.into_iter().enumerate() {
                let (kd, ks) = (kd[c] as f64, ks[c] as f64);
                let expected = kd + ks * e1 + (1.0 - ks) * e5;
                let off = mean.mean - expected;
                let case = format!("{line}, Kd {kd} Ks {ks}: {} not {expected}", mean.mean);
                // Student with 15 degrees of freedom: beyond 8 once in a million. What one sample in
                // ten thousand loses below the horizon has longer tails.
                let noise = mean.standard_error().max(3e-5);
                assert!(off.abs() < 8.0 * noise, "{case} +- {noise}");
                assert!(off.abs() < 1e-3, "{case}");
                worst = worst.max(off.abs());
                checks += 1;
            }
        }
    }
    assert!(checks > 2200 && worst > 0.0, "{checks} {worst}");
}

#[test]
fn warps_stay_in_range_at_the_ends_of_theirs() {
    let top = 1.0 - f32::EPSILON / 2.0;
    for u in [0.0, f32::MIN_POSITIVE, f32::EPSILON / 2.0, 0.25, 0.5, 0.75, 1.0 - 1e-6, top] {
        for v in [0.0, f32::MIN_POSITIVE, f32::EPSILON / 2.0, 0.25, 0.5, 0.75, 1.0 - 1e-6, top] {
            let d = warp::cosine_hemisphere([u, v]);
            assert!(d.z > 0.0 && (d.length() - 1.0).abs() < 1e-6, "{u} {v}: {d:?}");
            assert!(warp::cosine_hemisphere_pdf(d.z) > 0.0, "{u} {v}");
            let [x, y] = warp::disc([u, v]);
            assert!(x * x + y * y <= 1.0 + 1e-6, "{u} {v}: {x} {y}");
            let [a, b] = warp::triangle([u, v]);
            assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0, "{u} {v}: {a} {b}");
            for wide in [2.0, 1.0, 1e-3, 1e-7, 1e-12, 1e-30] {
                let d = warp::cone([u, v], wide);
                assert!((d.length() - 1.0).abs() < 1e-6 && 1.0 - d.z <= wide * (1.0 + 1e-6) + 6e-8);
                assert!(warp::cone_pdf(wide).is_finite());
            }
        }
    }
}

#[test]
fn warps_follow_their_densities() {
    let mut r = Random::new(6);
    let n = 50_000;
    let us: Vec<[f32; 2]> = (0..n).map(|_| r.pair()).collect();
    let map = |f: &dyn Fn([f32; 2]) -> f64| us.iter().map(|&u| f(u)).collect::<Vec<f64>>();
    assert_uniform("hemisphere z²", map(&|u| (warp::cosine_hemisphere(u).z as f64).powi(2)));
    assert_uniform(
        "hemisphere turn",
        map(&|u| {
            let d = warp::cosine_hemisphere(u);
            turn(d.y as f64, d.x as f64)
        }),
    );
    assert_uniform("disc r²", map(&|u| warp::disc(u).map(|x| (x as f64).powi(2)).iter().sum()));
    for wide in [2.0f32, 1.0, 1e-3, 1e-7, 1e-12] {
        let name = format!("cone {wide}");
        assert_uniform(
            &name,
            map(&|u| {
                let d = warp::cone(u, wide);
                // 1 - cos from the sine, which narrow cones keep.
                let sin2 = (d.x as f64).powi(2) + (d.y as f64).powi(2);
                let h =
                    if d.z > 0.5 { sin2 / (1.0 + (1.0 - sin2).sqrt()) } else { 1.0 - d.z as f64 };
                h / wide as f64
            }),
        );
        let pdf = warp::cone_pdf(wide) as f64;
        assert!((pdf * TAU * wide as f64 - 1.0).abs() < 1e-6, "{name}: pdf {pdf}");
    }
    // A triangle's area below b1 is 1 - (1 - b1)², and given b1 the rest is even.
    assert_uniform("triangle b1", map(&|u| 1.0 - (1.0 - warp::triangle(u)[0] as f64).powi(2)));
    assert_uniform(
        "triangle b2",
        map(&|u| {
            let [a, b] = warp::triangle(u).map(f64::from);
            b / (1.0 - a).max(1e-12)
        }),
    );
}
