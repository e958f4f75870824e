//! Proofs of the formulas, with nothing left to chance: D, G and f against the textbook and
//! against the laws that they obey.

use super::code::Code;
use super::quadrature::gauss;
use super::reference::ReferenceBrdf;
use super::statistics::Random;
use super::{Proof, ProofWork};
use crate::brdf::{Alpha, BrdfParams, Roughness};
use crate::math::{Rgb, V3};
use std::f64::consts::{PI, TAU};

/// All of them, in the order in which they are shown.
pub(super) fn prove(work: &mut ProofWork) {
    let (code, roughness) = (work.code, work.roughness);
    let lobe = ReferenceBrdf::of_width(work.subject.model, roughness);
    work.add(normalisation(&code, roughness));
    work.add(distribution(&code, roughness, &lobe));
    work.add(limits(&code, roughness));
    work.add(range(&code, roughness));
    work.add(masking(&code, roughness, &lobe));
    let pairs = pairs(&lobe, if work.full { 200_000 } else { 4_000 });
    work.add(value(&code, roughness, &lobe, &pairs));
    work.add(reciprocity(&code, roughness, &pairs));
    work.add(horizon(&code, roughness, &pairs));
    work.add(frame(&code));
}

fn normalisation(code: &Code, roughness: Alpha) -> Proof {
    // With x = tan²: pi times the integral of D / (1 + x)², over the logarithm of x / alpha².
    let points = gauss(8);
    let a2 = f64::from(roughness.alpha).powi(2);
    let (low, panels) = (-30.0, 60);
    let mut sum = 0.0;
    for panel in 0..panels {
        for &[place, weight] in &points {
            let x = a2 * (low + f64::from(panel) + place).exp();
            let d = (code.d)(roughness, V3::new(x.sqrt() as f32, 0.0, 1.0));
            sum += weight * PI * f64::from(d) * x / ((1.0 + x) * (1.0 + x));
        }
    }
    let says = "D cos integrates to 1 over the hemisphere";
    Proof::at_most("normalisation of D", says, (sum - 1.0).abs(), 1e-5)
}

fn distribution(code: &Code, roughness: Alpha, lobe: &ReferenceBrdf) -> Proof {
    let worst = (0..2000).map(|i| {
        // Out to where D is 1e-30 of its peak, and to a normal within 1e-6 of the surface.
        let tan = lobe.alpha * 1e-3 * 1e9f64.powf(f64::from(i) / 2000.0);
        let phi = 2.4 * f64::from(i);
        let h = V3::new((tan * phi.cos()) as f32, (tan * phi.sin()) as f32, 1.0);
        relative((code.d)(roughness, h), lobe.d(across2(h)))
    });
    Proof::at_most("value of D", "D is the textbook's at every angle, relative", most(worst), 1e-4)
}

/// The squared distance from the axis.
fn across2(h: V3) -> f64 {
    f64::from(h.x).powi(2) + f64::from(h.y).powi(2)
}

fn limits(code: &Code, roughness: Alpha) -> Proof {
    let up = V3::new(0.0, 0.0, 1.0);
    let above = f64::from((code.g1_over_cos)(roughness, up)) - 1.0;
    let [least, _] = Roughness::ALPHA;
    let smooth = Alpha { alpha: least as f32, exponent: (2.0 / (least * least) - 2.0) as f32 };
    let smooth = (0..=80).map(|degrees| {
        let w = direction(f64::from(degrees).to_radians().cos(), 0.7);
        f64::from((code.g1_over_cos)(smooth, w) * w.z) - 1.0
    });
    let worst = most(smooth.map(f64::abs)).max(above.abs());
    let says = "G1 tends to 1 towards the normal and for a smooth surface";
    Proof::at_most("limits of G", says, worst, 1e-5)
}

fn range(code: &Code, roughness: Alpha) -> Proof {
    let outside = cosines().map(|cos| {
        let w = direction(cos, 0.3);
        let g = f64::from((code.g1_over_cos)(roughness, w) * w.z);
        (-g).max(g - 1.0).max(0.0)
    });
    // The rational form exceeds 1 by 6.1e-5 just below its joint, as printed.
    Proof::at_most("range of G", "G1 leaves [0, 1] by no more than this", most(outside), 1e-4)
}

fn masking(code: &Code, roughness: Alpha, lobe: &ReferenceBrdf) -> Proof {
    let off = cosines().map(|cos| {
        let w = direction(cos, 1.1);
        let sin = across2(w).sqrt();
        let z = f64::from(w.z);
        relative((code.g1_over_cos)(roughness, w), lobe.g1(z, sin) / z)
    });
    // At the joint the two sides differ by 5.7e-5, and rounding decides.
    Proof::at_most("value of G", "G1 is the textbook's down to a cosine of 1e-7", most(off), 1e-4)
}

/// 1 to 1e-7.
fn cosines() -> impl Iterator<Item = f64> {
    let even = (1..=1000).map(|i| f64::from(i) / 1000.0);
    even.chain((0..=700).map(|i| 10f64.powf(-f64::from(i) / 100.0)))
}

fn value(code: &Code, roughness: Alpha, lobe: &ReferenceBrdf, pairs: &[[V3; 2]]) -> Proof {
    let off = pairs.iter().enumerate().map(|(i, &[wo, wi])| {
        let params = grey([0.0, 0.4][i % 2], [1.0, 0.3, 0.04][i % 3], roughness);
        let (kd, ks) = (f64::from(params.kd.r), f64::from(params.ks.r));
        let (got, expected) = (eval(code, &params, wo, wi).0, lobe.f(kd, ks, wide(wo), wide(wi)));
        // Where single precision has no number left for D there may be no light, at grazing cosines
        // however much the formula makes of it.
        let h = wo + wi;
        let faded = lobe.d(across2(h) / f64::from(h.z).powi(2)) < 1e-30;
        if faded && got >= 0.0 && f64::from(got) < expected { 0.0 } else { relative(got, expected) }
    });
    let says = "f is the textbook's, near the mirror, grazing, anywhere";
    Proof::at_most("value of f", says, most(off), 1e-4)
}

fn reciprocity(code: &Code, roughness: Alpha, pairs: &[[V3; 2]]) -> Proof {
    let params = grey(0.3, 0.5, roughness);
    let ulps = pairs.iter().map(|&[wo, wi]| {
        let [a, b] = [eval(code, &params, wo, wi).0, eval(code, &params, wi, wo).0];
        let finite = a.is_finite() && b.is_finite();
        let steps = i64::from(a.to_bits()) - i64::from(b.to_bits());
        if finite { steps.abs() as f64 } else { f64::NAN }
    });
    let says = "f of a pair and of the pair swapped, in units of the last place";
    Proof::at_most("reciprocity", says, most(ulps), 2.0)
}

fn horizon(code: &Code, roughness: Alpha, pairs: &[[V3; 2]]) -> Proof {
    let params = grey(0.3, 0.5, roughness);
    let under = |w: V3| V3::new(w.x, w.y, -w.z);
    let flat = |w: V3| V3::new(w.x, w.y, 0.0);
    let mut lit = 0;
    for &[wo, wi] in pairs {
        for (wo, wi) in [(wo, under(wi)), (under(wo), wi), (under(wo), under(wi)), (wo, flat(wi))] {
            lit += usize::from(eval(code, &params, wo, wi) != (0.0, 0.0));
        }
    }
    let mut random = Random::new(5);
    for i in 0..pairs.len() {
        let wo = direction(10f64.powf(-f64::from(i as u32 % 7)), 0.2);
        let brdf = (code.formulas.at_wo)(&params, wo);
        let sample = (code.formulas.sample)(&brdf, random.pair()[0], random.pair());
        let told_apart = sample.pdf > 0.0 && sample.wi.z <= 0.0;
        lit += usize::from(told_apart);
    }
    let says = "pairs with a direction below the surface that carry light";
    Proof::at_most("nothing below the horizon", says, lit as f64, 0.0)
}

fn frame(code: &Code) -> Proof {
    let sphere = (0..2000u32).map(|i| {
        let z = 1.0 - (f64::from(i) + 0.5) / 1000.0;
        (z, 2.4 * f64::from(i))
    });
    // Around both poles: within rounding, within a lobe's roughness, within degrees.
    let poles = (0..240u32).map(|i| {
        let tilt = 10f64.powf(-f64::from(i / 2 % 30) / 4.0 - 0.5);
        (if i % 2 == 0 { tilt.cos() } else { -tilt.cos() }, f64::from(i))
    });
    let off = sphere.chain(poles).map(|(z, phi)| {
        let n = direction(z, phi);
        let f = (code.frame)(n);
        let products = [
            f.s.dot(f.s) - 1.0,
            f.t.dot(f.t) - 1.0,
            f.s.dot(f.t),
            f.s.cross(f.t).dot(f.n) - 1.0,
            f.s.dot(n),
            f.t.dot(n),
            (f.n - n).length(),
        ];
        most(products.iter().map(|x| f64::from(x.abs())))
    });
    let says = "a lobe's axes are unit, square, and about its normal, poles included";
    Proof::at_most("frame", says, most(off), 1e-6)
}

/// Pairs of directions above the surface: a third reflected at normals drawn from the lobe, a third
/// anywhere, a third with one or both grazing down to a cosine of 1e-6.
fn pairs(lobe: &ReferenceBrdf, count: usize) -> Vec<[V3; 2]> {
    let mut random = Random::new(4);
    let mut pairs = Vec::with_capacity(count);
    while pairs.len() < count {
        let kind = pairs.len() % 3;
        let graze = |random: &mut Random| 10f64.powf(random.within(-6.0, 0.0));
        let low = kind == 2 && pairs.len() % 2 == 0;
        let cos = if low { graze(&mut random) } else { random.within(0.01, 1.0) };
        let wo = direction(cos, random.within(0.0, TAU));
        let wi = if kind == 0 {
            let share = random.within(0.0, 1.0);
            let tan = lobe.alpha * (share / (1.0 - share)).sqrt();
            let phi = random.within(0.0, TAU);
            mirrored(wide(wo), [tan * phi.cos(), tan * phi.sin(), 1.0])
        } else {
            let cos = if kind == 2 { graze(&mut random) } else { random.within(0.01, 1.0) };
            direction(cos, random.within(0.0, TAU))
        };
        if wi.z > 0.0 {
            pairs.push([wo, wi]);
        } else {
            // Its place is taken by a pair of mirror images.
            pairs.push([wo, V3::new(-wo.x, -wo.y, wo.z)]);
        }
    }
    pairs
}

/// `wo` reflected at a normal of any length.
fn mirrored(wo: [f64; 3], m: [f64; 3]) -> V3 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let twice = 2.0 * dot(wo, m) / dot(m, m);
    V3::from([0, 1, 2].map(|k| (twice * m[k] - wo[k]) as f32))
}

/// A direction of this cosine to z.
pub(super) fn direction(cos: f64, phi: f64) -> V3 {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    V3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32)
}

/// Grey lobes.
pub(super) fn grey(kd: f32, ks: f32, roughness: Alpha) -> BrdfParams {
    BrdfParams { kd: Rgb::splat(kd), ks: Rgb::splat(ks), roughness }
}

/// f and density.
fn eval(code: &Code, params: &BrdfParams, wo: V3, wi: V3) -> (f32, f32) {
    let brdf = (code.formulas.at_wo)(params, wo);
    let e = (code.formulas.eval)(&brdf, wi);
    (e.f.r, e.pdf)
}

fn wide(w: V3) -> [f64; 3] {
    [w.x, w.y, w.z].map(f64::from)
}

/// How far off, relative to what is expected; what single precision cannot hold at all may be 0.
fn relative(got: f32, expected: f64) -> f64 {
    let off = (f64::from(got) - expected).abs();
    if off <= 1e-30 { 0.0 } else { off / expected.abs() }
}

/// The largest; not a number if any is not.
pub(super) fn most(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most, x| if x > most || x.is_nan() { x } else { most })
}
