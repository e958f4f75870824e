//! The BRDF against 50-digit values, and its own laws.

use crate::support::Random;
use burnish::brdf::{Alpha, BrdfParams, Microfacet, Model, ModelVisitor, Roughness, Terms};
use burnish::math::simd::{F32x8, Simd, Simd8};
use burnish::math::{Rgb, V3};
use std::collections::HashMap;

/// 666 rows a model made at 50 digits; tolerances are what single-precision inputs determine.
const ORACLE: &str = include_str!("../data/brdf_oracle.csv");

struct Ask {
    params: BrdfParams,
    wo: V3,
    wi: V3,
}
struct Answer {
    terms: Terms,
    f: f32,
    pdf: f32,
}
impl ModelVisitor for Ask {
    type Output = Answer;
    fn visit<M: Microfacet>(self) -> Answer {
        let e = self.params.eval::<M>(self.wo, self.wi);
        let terms = self.params.terms::<M>(self.wo, self.wi);
        Answer { terms, f: e.f.r, pdf: e.pdf }
    }
}

fn model(name: &str) -> Model {
    Model::ALL.into_iter().find(|m| m.name() == name).unwrap()
}

fn params(kd: f32, ks: f32, roughness: Alpha) -> BrdfParams {
    BrdfParams { kd: Rgb::splat(kd), ks: Rgb::splat(ks), roughness }
}

fn width(model: Model, parameter: f64) -> Alpha {
    let roughness = match model {
        Model::Phong => Roughness::from_exponent(parameter),
        _ => Roughness::from_alpha(parameter),
    };
    roughness.unwrap().into()
}

#[test]
fn every_oracle_row_is_met() {
    let mut lines = ORACLE.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let (mut checks, mut failures) = (0, Vec::new());
    for (number, line) in lines.enumerate() {
        let row: HashMap<&str, &str> = head.iter().copied().zip(line.split(',')).collect();
        let number_of = |k: &str| row.get(k).and_then(|v| v.parse::<f64>().ok());
        let get = |k: &str| number_of(k).unwrap();
        let m = model(row["model"]);
        let at = |p: &str| {
            V3::new(
                get(&format!("{p}_x")) as f32,
                get(&format!("{p}_y")) as f32,
                get(&format!("{p}_z")) as f32,
            )
        };
        let (kd, ks) = (get("Kd") as f32, get("Ks") as f32);
        // A param of 1e-4 is one f32 rounding below the range.
        let parameter = if m == Model::Phong { get("param") } else { get("param").max(1e-4) };
        let params = params(kd, ks, width(m, parameter));
        let a = m.visit(Ask { params, wo: at("wo"), wi: at("wi") });
        let pdf_specular = if m == Model::Phong { "pdf_D" } else { "pdf_vndf" };
        let mut values =
            vec![("D", a.terms.d), ("G1i", a.terms.g1i), ("G1o", a.terms.g1o), ("G", a.terms.g)];
        if ks > 0.0 {
            values.extend([
                ("F", a.terms.fresnel),
                ("spec", a.terms.specular),
                ("brdf", a.f),
                ("fcos", a.f * at("wi").z),
                ("pdf_cos", a.terms.pdf_diffuse),
                (pdf_specular, a.terms.pdf_specular),
            ]);
            let p = a.terms.p_specular;
            let mixture = p * a.terms.pdf_specular + (1.0 - p) * a.terms.pdf_diffuse;
            assert!((a.pdf - mixture).abs() <= 1e-6 * mixture, "row {number}: pdf of the mixture");
        }
        for (name, got) in values {
            let (got, expected) = (got as f64, number_of(name).unwrap_or(0.0));
            let tolerance = number_of(&format!("tol_{name}")).unwrap_or(3e-7);
            let density = ["D", "pdf_D", "pdf_vndf"].contains(&name);
            let absolute = get("abs_spec").max(1.2e-38).max(if density { 1e-30 } else { 0.0 });
            let ok = if row["class"] == "below" {
                got == 0.0
            } else if row["judge"] == "zero" && name == "spec" {
                got.abs() <= 1e-25
            } else if tolerance > 0.05 {
                got.is_finite() && got >= 0.0
            } else {
                (got - expected).abs() <= tolerance * expected.abs() + absolute
            };
            checks += 1;
            if !ok {
                failures.push(format!(
                    "row {number} {line:.60} {name}: {got:e}, not {expected:e} +- {tolerance:e}"
                ));
            }
        }
    }
    assert!(checks > 15_000, "{checks}");
    assert!(
        failures.is_empty(),
        "{} of {checks}:\n{}",
        failures.len(),
        failures[..failures.len().min(20)].join("\n")
    );
}

fn random_lobes(r: &mut Random, m: Model) -> BrdfParams {
    let alpha = 10f64.powf(r.within(-4.0, 0.0)).clamp(1e-4, 1.0);
    let exponent = Roughness::from_alpha(alpha).unwrap().exponent().clamp(0.0, 2e8 - 2.0);
    let w = width(m, if m == Model::Phong { exponent } else { alpha });
    params(r.unit(), r.unit(), w)
}

/// Directions of which many graze.
fn upper(r: &mut Random) -> V3 {
    let mut d = r.direction();
    if r.bits().is_multiple_of(4) {
        d[2] *= 10f64.powf(r.within(-7.0, 0.0));
    }
    let n = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    V3::new((d[0] / n) as f32, (d[1] / n) as f32, (d[2].abs() / n) as f32)
}

#[test]
fn reciprocal_to_two_ulp_finite_and_never_negative() {
    let mut r = Random::new(1);
    for i in 0..1_000_000 {
        let m = Model::ALL[i % 3];
        let l = random_lobes(&mut r, m);
        let (wi, wo) = (upper(&mut r), upper(&mut r));
        let a = m.visit(Ask { params: l, wo, wi });
        let b = m.visit(Ask { params: l, wo: wi, wi: wo });
        assert!(a.f.is_finite() && a.f >= 0.0 && a.pdf.is_finite() && a.pdf >= 0.0);
        assert!(a.pdf > 0.0 || a.f == 0.0, "{m:?} {wi:?} {wo:?}: never sampled, yet f = {}", a.f);
        assert!((a.f.to_bits() as i64 - b.f.to_bits() as i64).abs() <= 2, "{} {}", a.f, b.f);
    }
}

/// Directions that no formula was written for: below or in the surface, opposite, equal, longer
/// than 1 by a rounding, not numbers. Zero where either is not above the surface, a number always.
#[test]
fn odd_directions_give_zero_or_a_number() {
    let above_one = 1.0 + f32::EPSILON;
    let tilted = V3::new(0.6, 0.0, 0.8);
    let mut directions = vec![V3::default(), tilted, -tilted, V3::new(-0.6, 0.0, 0.8)];
    for z in [1.0, above_one, -1.0, 1e-12, f32::MIN_POSITIVE, 1e-45] {
        directions.push(V3::new(0.0, 0.0, z));
    }
    for z in [0.0, -0.0, 1e-45, 1e-12, -1e-12, 1e-7] {
        directions.extend([V3::new(1.0, 0.0, z), V3::new(-1.0, 0.0, z), V3::new(0.0, -1.0, z)]);
    }
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        directions.extend([V3::new(odd, 0.0, 0.8), V3::new(0.6, 0.0, odd)]);
    }
    for m in Model::ALL {
        for alpha in [1e-4, 0.03, 0.3, 1.0] {
            let l = params(0.5, 0.5, Roughness::from_alpha(alpha).unwrap().into());
            for &wo in &directions {
                for &wi in &directions {
                    let a = m.visit(Ask { params: l, wo, wi });
                    let case = format!("{m:?} {alpha} {wo:?} {wi:?}: {} {}", a.f, a.pdf);
                    let finite = |v: V3| v.x.is_finite() && v.y.is_finite() && v.z.is_finite();
                    if !(wo.z > 0.0 && wi.z > 0.0) {
                        assert_eq!((a.f, a.pdf), (0.0, 0.0), "{case}");
                    } else if finite(wo) && finite(wi) && wo.length() > 0.5 && wi.length() > 0.5 {
                        assert!(a.f.is_finite() && a.f >= 0.0, "{case}");
                        // Of two that are opposite to the last bit the density may be infinite.
                        assert!(a.pdf >= 0.0, "{case}");
                        assert!(a.pdf.is_finite() || (wo + wi).length2() == 0.0, "{case}");
                    }
                }
            }
        }
    }
}

/// Integrals over all microfacet normals, for one viewer: of `D cos`, of `D (wo.m)+`, and of the
/// density of the normals that are sampled.
struct Areas {
    roughness: Alpha,
    wo: V3,
}

struct Projected {
    all: f64,
    seen: f64,
    density: f64,
    g1: f64,
}

impl ModelVisitor for Areas {
    type Output = Projected;

    /// Over the logarithm of the tangent, by the midpoint rule; around the normal exactly.
    fn visit<M: Microfacet>(self) -> Projected {
        let (z, across) = (self.wo.z as f64, (self.wo.x as f64).hypot(self.wo.y as f64));
        let factor = M::pdf_factor(self.roughness, self.wo);
        let mut sums = Projected { all: 0.0, seen: 0.0, density: 0.0, g1: 0.0 };
        let (low, high, steps) = (-12.0, 26.0, 60_000);
        let step = (high - low) / steps as f64;
        for k in 0..steps {
            let tan = (low + (k as f64 + 0.5) * step).exp() * self.roughness.alpha as f64;
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            let sin = tan * cos;
            // d(theta) = cos sin d(ln tan).
            let ring = sin * sin * cos * step;
            let d = M::d(self.roughness, V3::new(sin as f32, 0.0, cos as f32));
            sums.all += d as f64 * cos * std::f64::consts::TAU * ring;
            // wo.m = a + b cos(phi), which is above 0 up to an angle of `end` on both sides.
            let (a, b) = (z * cos, across * sin);
            let end = if a >= b { std::f64::consts::PI } else { (-a / b).acos() };
            let facing = 2.0 * (a * end + b * end.sin());
            sums.seen += d as f64 * facing * ring;
            // The density of wi is that of m over 4 wo.m; cos_over_dot stands for cos / wo.m.
            let visible = M::pdf_wi(factor, d, 0.0) as f64;
            let whole = M::pdf_wi(factor, d, 1.0) as f64 - visible;
            sums.density += 4.0 * (visible * facing + whole * cos * 2.0 * end) * ring;
        }
        sums.g1 = M::g1_over_cos(self.roughness, self.wo) as f64 * z;
        sums
    }
}

/// A rough surface's facets have the area of the flat one when projected along its normal, and of
/// those that a viewer sees when projected along his view: `int D cos = 1` for every D, and
/// `int D G1(wo) (wo.m)+ = cos` where G1 is Smith's for that D. GGX's is, Beckmann's is a rational
/// fit within 0.32 %. The densities of what is sampled integrate to 1 with no such allowance.
#[test]
fn projected_areas_are_those_of_the_flat_surface() {
    for m in Model::ALL {
        for alpha in [1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0] {
            let w: Alpha = Roughness::from_alpha(alpha).unwrap().into();
            for cos in [1.0, 0.9, 0.5, 0.1, 1e-2, 1e-4] {
                let wo = V3::new((1.0f64 - cos * cos).sqrt() as f32, 0.0, cos as f32);
                let p = m.visit(Areas { roughness: w, wo });
                let case = format!("{m:?} {alpha} {cos}");
                assert!((p.all - 1.0).abs() < 2e-5, "{case}: int D cos = {}", p.all);
                let seen = p.seen * p.g1 / wo.z as f64 - 1.0;
                match m {
                    Model::Ggx => assert!(seen.abs() < 2e-5, "{case}: off by {seen}"),
                    Model::Beckmann => {
                        assert!((-3.1e-3..3.2e-3).contains(&seen), "{case}: off by {seen}");
                    }
                    // The mask of another distribution: too little is masked, up to 77 %.
                    Model::Phong => {
                        assert!((-3.3e-3..0.78).contains(&seen), "{case}: off by {seen}")
                    }
                }
                if m == Model::Phong {
                    // Normals that face away from the viewer are drawn, too, and are lost.
                    assert!(p.density < 1.0 + 2e-5 && p.density > 0.45, "{case}: {}", p.density);
                } else {
                    assert!((p.density - 1.0).abs() < 5e-5, "{case}: density {}", p.density);
                }
            }
        }
    }
}

#[test]
fn phong_and_beckmann_mask_alike() {
    let mut r = Random::new(2);
    for _ in 0..10_000 {
        let (wi, wo) = (upper(&mut r), upper(&mut r));
        let alpha = 10f64.powf(r.within(-3.9, -0.01));
        let w: Alpha = Roughness::from_alpha(alpha).unwrap().into();
        let l = params(0.5, 0.5, w);
        let p = Model::Phong.visit(Ask { params: l, wo, wi }).terms;
        let b = Model::Beckmann.visit(Ask { params: l, wo, wi }).terms;
        assert_eq!((p.g1i, p.g1o), (b.g1i, b.g1o));
    }
}

struct Sample {
    params: BrdfParams,
    wo: V3,
    choice: f32,
    u: [f32; 2],
}
impl ModelVisitor for Sample {
    type Output = (V3, f32, f32);
    fn visit<M: Microfacet>(self) -> (V3, f32, f32) {
        let s = self.params.sample::<M>(self.wo, self.choice, self.u);
        (s.wi, s.f.r, s.pdf)
    }
}

/// u at its extremes, in every model, at every roughness and viewer angle: a sample is finite,
/// of unit length and above the surface, or has density zero.
#[test]
fn extreme_random_numbers_give_no_nonsense() {
    let top = 1.0 - f32::EPSILON / 2.0;
    let edges = [0.0, f32::EPSILON / 2.0, 0.25, 0.5, 0.75, 1.0 - 1e-6, top];
    for m in Model::ALL {
        for alpha in [1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0] {
            for z in [1.0f32, 0.999_999_9, 0.9, 0.1, 1e-3, 1e-5, 1e-7, 1e-12] {
                let wo = V3::new(
                    (1.0 - z * z).max(0.0).sqrt() * 0.6,
                    -(1.0 - z * z).max(0.0).sqrt() * 0.8,
                    z,
                );
                for (kd, ks) in [(0.5, 0.5), (0.0, 1.0), (0.5, 0.0), (0.0, 0.0)] {
                    for choice in edges {
                        for u in edges {
                            for v in edges {
                                let w = Roughness::from_alpha(alpha).unwrap().into();
                                let params = params(kd, ks, w);
                                let (wi, f, pdf) =
                                    m.visit(Sample { params, wo, choice, u: [u, v] });
                                let case = format!("{m:?} {alpha} {z} {kd} {ks} {choice} {u} {v}");
                                assert!(pdf.is_finite() && pdf >= 0.0, "{case}: pdf {pdf}");
                                assert!(f.is_finite() && f >= 0.0, "{case}: f {f}");
                                if pdf > 0.0 {
                                    assert!(wi.z > 0.0, "{case}: wi.z {}", wi.z);
                                    assert!((wi.length() - 1.0).abs() < 1e-5, "{case}: {wi:?}");
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A channel with Kd = 0 takes nothing from the diffuse lobe; Kd = Ks = 0 is black and ends paths.
#[test]
fn empty_lobes_give_exactly_nothing() {
    let w: Alpha = Roughness::from_alpha(0.3).unwrap().into();
    let (wo, wi) = (V3::new(0.6, 0.0, 0.8), V3::new(-0.48, 0.6, 0.64));
    let l = BrdfParams { kd: Rgb::new(0.5, 0.0, 0.25), ks: Rgb::BLACK, roughness: w };
    let f = l.eval::<burnish::brdf::Ggx>(wo, wi).f;
    assert_eq!((f.g, f.b), (0.0, f.r * 0.5));
    let black = m_visit_black(w, wo, wi);
    assert_eq!(black, (0.0, 0.0));
}

fn m_visit_black(w: Alpha, wo: V3, wi: V3) -> (f32, f32) {
    let a = Model::Beckmann.visit(Ask { params: params(0.0, 0.0, w), wo, wi });
    let s = Model::Beckmann.visit(Sample {
        params: params(0.0, 0.0, w),
        wo,
        choice: 0.5,
        u: [0.3, 0.7],
    });
    (a.f, s.1)
}

/// The eight-lane instance gives the bits of the scalar one.
#[test]
fn lanes_agree_with_scalars() {
    struct Wider {
        params: [BrdfParams; 8],
        wo: [V3; 8],
        u: [[f32; 3]; 8],
    }
    fn gather(f: impl Fn(usize) -> f32) -> F32x8 {
        F32x8::load(&std::array::from_fn(f))
    }
    impl ModelVisitor for &Wider {
        type Output = ([f32; 8], [f32; 8]);
        fn visit<M: Microfacet>(self) -> Self::Output {
            let rgb = |f: &dyn Fn(&BrdfParams) -> Rgb| {
                Rgb::new(
                    gather(|i| f(&self.params[i]).r),
                    gather(|i| f(&self.params[i]).g),
                    gather(|i| f(&self.params[i]).b),
                )
            };
            let params = BrdfParams {
                kd: rgb(&|l| l.kd),
                ks: rgb(&|l| l.ks),
                roughness: Alpha {
                    alpha: gather(|i| self.params[i].roughness.alpha),
                    exponent: gather(|i| self.params[i].roughness.exponent),
                },
            };
            let wo = V3::new(
                gather(|i| self.wo[i].x),
                gather(|i| self.wo[i].y),
                gather(|i| self.wo[i].z),
            );
            let u = |k: usize| gather(|i| self.u[i][k]);
            let s = params.sample::<M>(wo, u(0), [u(1), u(2)]);
            assert_eq!(<F32x8 as Simd>::WIDTH, 8);
            (s.f.r.store(), s.pdf.store())
        }
    }
    let mut r = Random::new(3);
    for i in 0..3000 {
        let m = Model::ALL[i % 3];
        let w = Wider {
            params: std::array::from_fn(|_| random_lobes(&mut r, m)),
            wo: std::array::from_fn(|_| upper(&mut r)),
            u: std::array::from_fn(|_| [r.unit(), r.unit(), r.unit()]),
        };
        let (f, pdf) = m.visit(&w);
        for k in 0..8 {
            let (choice, u) = (w.u[k][0], [w.u[k][1], w.u[k][2]]);
            let (_, f1, p1) = m.visit(Sample { params: w.params[k], wo: w.wo[k], choice, u });
            assert_eq!((f[k].to_bits(), pdf[k].to_bits()), (f1.to_bits(), p1.to_bits()));
        }
    }
}
