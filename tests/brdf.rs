//! The BRDF against 50-digit values, and its own laws.

mod support;

use burnish::brdf::{Lobes, Microfacet, Model, ModelVisitor, Roughness, Terms, Width};
use burnish::math::lanes::{F32x8, Lane, Wide};
use burnish::math::{Rgb, V3};
use std::collections::HashMap;
use support::Random;

/// 666 rows a model made at 50 digits; tolerances are what single-precision inputs determine.
const ORACLE: &str = include_str!("data/brdf_oracle.csv");

struct Ask {
    lobes: Lobes,
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
        let e = self.lobes.eval::<M>(self.wo, self.wi);
        let terms = self.lobes.terms::<M>(self.wo, self.wi);
        Answer { terms, f: e.f.r, pdf: e.pdf }
    }
}

fn model(name: &str) -> Model {
    Model::ALL.into_iter().find(|m| m.name() == name).unwrap()
}

fn lobes(kd: f32, ks: f32, width: Width) -> Lobes {
    Lobes { kd: Rgb::splat(kd), ks: Rgb::splat(ks), width }
}

fn width(model: Model, parameter: f64) -> Width {
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
        let lobes = lobes(kd, ks, width(m, parameter));
        let a = m.visit(Ask { lobes, wo: at("wo"), wi: at("wi") });
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

fn random_lobes(r: &mut Random, m: Model) -> Lobes {
    let alpha = 10f64.powf(r.within(-4.0, 0.0)).clamp(1e-4, 1.0);
    let exponent = Roughness::from_alpha(alpha).unwrap().exponent().clamp(0.0, 2e8 - 2.0);
    let w = width(m, if m == Model::Phong { exponent } else { alpha });
    lobes(r.unit(), r.unit(), w)
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
        let a = m.visit(Ask { lobes: l, wo, wi });
        let b = m.visit(Ask { lobes: l, wo: wi, wi: wo });
        assert!(a.f.is_finite() && a.f >= 0.0 && a.pdf.is_finite() && a.pdf >= 0.0);
        assert!((a.f.to_bits() as i64 - b.f.to_bits() as i64).abs() <= 2, "{} {}", a.f, b.f);
    }
}

#[test]
fn phong_and_beckmann_mask_alike() {
    let mut r = Random::new(2);
    for _ in 0..10_000 {
        let (wi, wo) = (upper(&mut r), upper(&mut r));
        let alpha = 10f64.powf(r.within(-3.9, -0.01));
        let w: Width = Roughness::from_alpha(alpha).unwrap().into();
        let l = lobes(0.5, 0.5, w);
        let p = Model::Phong.visit(Ask { lobes: l, wo, wi }).terms;
        let b = Model::Beckmann.visit(Ask { lobes: l, wo, wi }).terms;
        assert_eq!((p.g1i, p.g1o), (b.g1i, b.g1o));
    }
}

struct Sample {
    lobes: Lobes,
    wo: V3,
    choice: f32,
    u: [f32; 2],
}
impl ModelVisitor for Sample {
    type Output = (V3, f32, f32);
    fn visit<M: Microfacet>(self) -> (V3, f32, f32) {
        let s = self.lobes.sample::<M>(self.wo, self.choice, self.u);
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
                                let lobes = lobes(kd, ks, w);
                                let (wi, f, pdf) = m.visit(Sample { lobes, wo, choice, u: [u, v] });
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
    let w: Width = Roughness::from_alpha(0.3).unwrap().into();
    let (wo, wi) = (V3::new(0.6, 0.0, 0.8), V3::new(-0.48, 0.6, 0.64));
    let l = Lobes { kd: Rgb::new(0.5, 0.0, 0.25), ks: Rgb::BLACK, width: w };
    let f = l.eval::<burnish::brdf::Ggx>(wo, wi).f;
    assert_eq!((f.g, f.b), (0.0, f.r * 0.5));
    let black = m_visit_black(w, wo, wi);
    assert_eq!(black, (0.0, 0.0));
}

fn m_visit_black(w: Width, wo: V3, wi: V3) -> (f32, f32) {
    let a = Model::Beckmann.visit(Ask { lobes: lobes(0.0, 0.0, w), wo, wi });
    let s =
        Model::Beckmann.visit(Sample { lobes: lobes(0.0, 0.0, w), wo, choice: 0.5, u: [0.3, 0.7] });
    (a.f, s.1)
}

/// The eight-lane instance gives the bits of the scalar one.
#[test]
fn lanes_agree_with_scalars() {
    struct Wider {
        lobes: [Lobes; 8],
        wo: [V3; 8],
        u: [[f32; 3]; 8],
    }
    fn gather(f: impl Fn(usize) -> f32) -> F32x8 {
        F32x8::load(&std::array::from_fn(f))
    }
    impl ModelVisitor for &Wider {
        type Output = ([f32; 8], [f32; 8]);
        fn visit<M: Microfacet>(self) -> Self::Output {
            let rgb = |f: &dyn Fn(&Lobes) -> Rgb| {
                Rgb::new(
                    gather(|i| f(&self.lobes[i]).r),
                    gather(|i| f(&self.lobes[i]).g),
                    gather(|i| f(&self.lobes[i]).b),
                )
            };
            let lobes = Lobes {
                kd: rgb(&|l| l.kd),
                ks: rgb(&|l| l.ks),
                width: Width {
                    alpha: gather(|i| self.lobes[i].width.alpha),
                    exponent: gather(|i| self.lobes[i].width.exponent),
                },
            };
            let wo = V3::new(
                gather(|i| self.wo[i].x),
                gather(|i| self.wo[i].y),
                gather(|i| self.wo[i].z),
            );
            let u = |k: usize| gather(|i| self.u[i][k]);
            let s = lobes.sample::<M>(wo, u(0), [u(1), u(2)]);
            assert_eq!(<F32x8 as Lane>::WIDTH, 8);
            (s.f.r.store(), s.pdf.store())
        }
    }
    let mut r = Random::new(3);
    for i in 0..3000 {
        let m = Model::ALL[i % 3];
        let w = Wider {
            lobes: std::array::from_fn(|_| random_lobes(&mut r, m)),
            wo: std::array::from_fn(|_| upper(&mut r)),
            u: std::array::from_fn(|_| [r.unit(), r.unit(), r.unit()]),
        };
        let (f, pdf) = m.visit(&w);
        for k in 0..8 {
            let (choice, u) = (w.u[k][0], [w.u[k][1], w.u[k][2]]);
            let (_, f1, p1) = m.visit(Sample { lobes: w.lobes[k], wo: w.wo[k], choice, u });
            assert_eq!((f[k].to_bits(), pdf[k].to_bits()), (f1.to_bits(), p1.to_bits()));
        }
    }
}
