//! Each erratum does what its text says, by as much as its formula gives, and the right renderer
//! does not.

use crate::support::{Mean, Random};
use burnish::brdf::{
    Alpha, BrdfParams, Erratum, Formulas, Microfacet, Model, ModelVisitor, Normals, Roughness,
};
use burnish::math::{Rgb, V3};
use burnish::measure::errata::{Bench, Effect};
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Material, Mesh, Scene, SceneBuilder};
use glam::{DAffine3, DVec3};
use std::f64::consts::{LN_10, PI, TAU};
use std::sync::Arc;

fn material(kd: f64, ks: f64, alpha: f64) -> Material {
    let exponent = Roughness::from_alpha(alpha).unwrap().exponent();
    Material::reflecting("plate", [kd; 3], [ks; 3], exponent).unwrap()
}

/// A direction `degrees` from z, towards x.
fn at(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// A square plate at the origin, tilted towards x, with a narrow view of its middle from 20 units
/// away in the direction `eye`; its normal is z at a tilt of 0.
fn plate(material: Material, tilt: f64, eye: DVec3) -> SceneBuilder {
    let mut b = SceneBuilder::new("plate");
    let material = b.material(material);
    let (x, y) = (at(90.0 + tilt) * 4.0, DVec3::Y * 4.0);
    let mesh = Mesh {
        positions: vec![-x - y, x - y, x + y, -x + y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    b.mesh(&mesh, DAffine3::IDENTITY, material).unwrap();
    b.camera = Some(Camera::look_at(eye * 20.0, DVec3::ZERO, 1e-3).unwrap());
    b.screen = [8, 8];
    b
}

/// A ball of this colour in this direction, 10 units away.
fn emitter(b: &mut SceneBuilder, towards: DVec3, radius: f64, radiance: [f64; 3]) {
    let emitter = b.material(Material::light("lamp", radiance).unwrap());
    b.sphere(towards * 10.0, radius, emitter).unwrap();
}

fn direct(b: SceneBuilder) -> Params {
    Params { max_depth: Some(1), ..Params::new(Arc::new(b.build())) }
}

fn mean(params: &Params, passes: u64) -> [f64; 3] {
    let s = render(params.clone(), passes, 0).unwrap();
    assert_eq!(s.counts.nonfinite, 0);
    let pixels = s.mean().pixels;
    let sum = |c: usize| pixels.iter().map(|p| p[c] as f64).sum::<f64>() / pixels.len() as f64;
    [0, 1, 2].map(sum)
}

/// How many times brighter an erratum makes a grey picture.
fn factor(params: &Params, erratum: Erratum, passes: u64) -> f64 {
    let wrong = Params { erratum: Some(erratum), seed: 1, ..params.clone() };
    mean(&wrong, passes)[0] / mean(params, passes)[0]
}

/// The factor, with another seed and no erratum instead: what must come out as 1.
fn without(params: &Params, passes: u64) -> f64 {
    let again = Params { seed: 1, ..params.clone() };
    mean(&again, passes)[0] / mean(params, passes)[0]
}

fn close(what: &str, found: f64, expected: f64, relative: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off < relative, "{what}: {found}, not {expected}");
}

fn everything() -> Arc<Scene> {
    let mut b = plate(material(0.5, 0.2, 0.3), 0.0, at(60.0));
    let metal = b.material(material(0.0, 0.8, 0.1));
    b.sphere(DVec3::new(0.0, 0.0, 0.4), 0.5, metal).unwrap();
    b.cylinder(DVec3::new(-1.0, 0.5, -0.5), DVec3::new(0.3, 0.2, 1.5), 0.3, metal).unwrap();
    emitter(&mut b, at(-40.0), 1.0, [4.0, 3.0, 2.0]);
    emitter(&mut b, at(-100.0), 1.0, [2.0, 3.0, 4.0]);
    b.environment = [0.2, 0.3, 0.4];
    b.camera = Some(Camera::look_at(at(70.0) * 6.0, DVec3::ZERO, 0.4).unwrap());
    b.screen = [40, 30];
    Arc::new(b.build())
}

/// The tracer that can err is the one that does not: with a mistake that concerns another model
/// the bits are the same, and so are they with one that has nothing to act on.
#[test]
fn an_erratum_about_something_else_changes_no_bit() {
    let scene = everything();
    for model in Model::ALL {
        let right = Params { model, ..Params::new(scene.clone()) };
        let picture = render(right.clone(), 4, 0).unwrap().mean();
        for erratum in Erratum::ALL {
            let wrong = Params { erratum: Some(erratum), ..right.clone() };
            assert!(wrong != right);
            let s = render(wrong, 4, 0).unwrap();
            assert_eq!((s.counts.nonfinite, s.counts.capped), (0, 0), "{erratum:?} {model:?}");
            // Two lights and the environment are asked by turns anyhow.
            let same = s.mean() == picture;
            assert_eq!(same, !erratum.concerns(model), "{erratum:?} {model:?}");
        }
    }
    for strategy in [Strategy::LightOnly, Strategy::BsdfOnly] {
        let right = Params { strategy, ..Params::new(scene.clone()) };
        let wrong = Params { erratum: Some(Erratum::DoubleDirect), ..right.clone() };
        // It runs through the reference, which adds the same samples in another order.
        let [right, wrong] = [right, wrong].map(|p| render(p, 4, 0).unwrap().mean().pixels);
        let near = |(a, b): (&[f32; 3], &[f32; 3])| {
            (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-4 * (a[c] + b[c]))
        };
        let same = right.iter().zip(&wrong).filter(|pair| near(*pair)).count();
        assert!(same * 100 >= right.len() * 99, "{strategy:?}: {same} of {}", right.len());
    }
    let phong = Params { model: Model::Phong, ..Params::new(scene) };
    let drawn = Params { normals: Normals::Distribution, ..phong.clone() };
    assert!(render(phong, 4, 0).unwrap().mean() == render(drawn, 4, 0).unwrap().mean());
}

/// A smooth metal in a white world, seen at 75 degrees: (2 / (1 + sec 75°))² is 0.17.
#[test]
fn ggx_g_sum_darkens_a_smooth_metal_by_its_formula() {
    for degrees in [0.0, 45.0, 75.0f64] {
        let mut b = plate(material(0.0, 1.0, 0.01), 0.0, at(degrees));
        b.environment = [1.0; 3];
        let params = direct(b);
        let cos = degrees.to_radians().cos();
        let g1 = 2.0 / (1.0 + (1.0 / cos.powi(2) + 1e-4).sqrt());
        close("wrong", factor(&params, Erratum::GgxGSum, 64), g1 * g1, 0.02);
        close("right", without(&params, 64), 1.0, 0.02);
    }
}

/// The integral of D cos, by the midpoint rule in the tangent.
struct Normalisation(Alpha);
impl ModelVisitor for Normalisation {
    type Output = f64;
    fn visit<M: Microfacet>(self) -> f64 {
        let n = 20_000;
        let each = |i: usize| {
            let theta = (i as f64 + 0.5) / n as f64 * PI / 2.0;
            let h = V3::new(theta.sin() as f32, 0.0, theta.cos() as f32);
            M::d(self.0, h) as f64 * theta.cos() * theta.sin()
        };
        (0..n).map(each).sum::<f64>() * TAU * PI / 2.0 / n as f64
    }
}

#[test]
fn ggx_d_alpha_is_not_normalised_and_dims_the_middle_of_highlights() {
    for alpha in [0.1, 0.5] {
        let roughness: Alpha = Roughness::from_alpha(alpha).unwrap().into();
        let integral = |e| Model::Ggx.visit_with(Normals::Visible, e, Normalisation(roughness));
        close("right", integral(None), 1.0, 1e-3);
        close("wrong", integral(Some(Erratum::GgxDAlpha)), 0.25, 1e-3);
    }
    // a_g² / a_b⁴ in place of 1 / a_g².
    let mut b = plate(material(0.0, 0.5, 0.3), 0.0, at(30.0));
    emitter(&mut b, at(-30.0), 0.05, [1.0; 3]);
    let params = Params { strategy: Strategy::LightOnly, ..direct(b) };
    close("highlight", factor(&params, Erratum::GgxDAlpha, 64), 1.0 / 16.0, 0.01);
    close("right", without(&params, 64), 1.0, 0.01);
}

/// What samples find in a narrow cone, over what is there: the sampled density over the claimed.
fn found_in_cone(formulas: &Formulas, params: &BrdfParams, wo: V3, towards: V3) -> Mean {
    let mut r = Random::new(7);
    let brdf = (formulas.at_wo)(params, wo);
    let narrow = 0.995; // 5.7 degrees
    let mut there = Mean::default();
    let frame = burnish::math::Frame::around(towards);
    for _ in 0..20_000 {
        let wi = frame.to_world(burnish::math::warp::cone(r.pair(), 1.0 - narrow));
        there.add(((formulas.eval)(&brdf, wi).f.r * wi.z) as f64 * TAU * (1.0 - narrow as f64));
    }
    let mut found = Mean::default();
    for _ in 0..800_000 {
        let s = (formulas.sample)(&brdf, r.unit(), r.pair());
        let inside = s.pdf > 0.0 && s.wi.dot(towards) > narrow;
        let weight = if inside { (s.f.r * s.wi.z / s.pdf) as f64 } else { 0.0 };
        found.add(weight / there.mean);
    }
    found
}

fn direction(degrees: f64) -> V3 {
    V3::from(at(degrees).as_vec3().to_array())
}

fn specular(alpha: f64) -> BrdfParams {
    let roughness = Roughness::from_alpha(alpha).unwrap().into();
    BrdfParams { kd: Rgb::BLACK, ks: Rgb::splat(0.8), roughness }
}

/// Sampled width 0.66 alpha: ln 10 = 2.3 times too often at the peak.
#[test]
fn beckmann_log10_is_too_often_at_the_peak() {
    let params = specular(0.4);
    let of = |erratum, normals| {
        let formulas = Formulas::of(Model::Beckmann, normals, erratum);
        found_in_cone(&formulas, &params, direction(30.0), direction(-30.0)).mean
    };
    // Within 5.7 degrees of the mirror direction the half vector stays within 2.9 degrees:
    // the ratio falls off by exp(-tan²/alpha² (ln 10 - 1)), at most 2 %.
    close("wrong", of(Some(Erratum::BeckmannLog10), Normals::Visible), LN_10, 0.03);
    close("right", of(None, Normals::Distribution), 1.0, 0.03);
    close("right", of(None, Normals::Visible), 1.0, 0.03);
}

/// q/p = (a_p + 1) / ((a_p + 2) cos) at a microfacet normal of this cosine.
#[test]
fn phong_exponent_is_wrong_by_the_cosine() {
    let params = specular(0.5f64.sqrt()); // a_p = 2
    let formulas = |e| Formulas::of(Model::Phong, Normals::Visible, e);
    for (viewer, light) in [(20.0, -20.0), (70.0, 50.0)] {
        let (wo, wi) = (direction(viewer), direction(light));
        let expected = 0.75 / ((viewer + light) / 2.0f64).to_radians().cos();
        let wrong = found_in_cone(&formulas(Some(Erratum::PhongExponent)), &params, wo, wi);
        let right = found_in_cone(&formulas(None), &params, wo, wi);
        for (m, is, is_not) in [(wrong, expected, 1.0), (right, 1.0, expected)] {
            let case = format!("{} +- {}, not {is}", m.mean, m.standard_error());
            assert!(m.sigmas(is) < 4.5 && m.sigmas(is_not) > 4.5, "{case}");
        }
    }
}

/// A thin plate lit from below shines as one lit from above.
#[test]
fn below_horizon_lets_light_through_a_thin_plate() {
    let lit = |towards: f64| {
        let mut b = plate(material(0.8, 0.0, 0.5), 0.0, at(20.0));
        emitter(&mut b, at(towards), 1.0, [3.0; 3]);
        direct(b)
    };
    let (above, below) = (lit(-30.0), lit(-150.0));
    assert_eq!(mean(&below, 64), [0.0; 3]);
    // Asked for: a diffuse lobe never draws a direction below.
    let wrong =
        Params { erratum: Some(Erratum::BelowHorizon), strategy: Strategy::LightOnly, ..below };
    close("through", mean(&wrong, 64)[0], mean(&above, 64)[0], 0.01);
}

/// Walter's rational form at a < 0: -1.57 at -0.3, -2.41 at -0.5, -1.04 at -1.
#[test]
fn below_horizon_makes_g_negative_for_the_rational_models_alone() {
    struct G1(Alpha, V3);
    impl ModelVisitor for G1 {
        type Output = f64;
        fn visit<M: Microfacet>(self) -> f64 {
            (M::g1_over_cos(self.0, self.1) * self.1.z.abs()) as f64
        }
    }
    let roughness: Alpha = Roughness::from_alpha(0.5).unwrap().into();
    for (a, expected) in [(-0.3, -1.574), (-0.5, -2.413), (-1.0, -1.041)] {
        // a = cot / alpha
        let w = direction(90.0 + (-a * 0.5f64).atan().to_degrees());
        for model in [Model::Phong, Model::Beckmann] {
            let wrong = Some(Erratum::BelowHorizon);
            close(
                "G1",
                model.visit_with(Normals::Visible, wrong, G1(roughness, w)),
                expected,
                2e-3,
            );
        }
    }
    let (wo, wi) = (direction(60.0), direction(-100.0));
    for model in Model::ALL {
        let f = |erratum| {
            let formulas = Formulas::of(model, Normals::Visible, erratum);
            (formulas.eval)(&(formulas.at_wo)(&specular(0.5), wo), wi).f.r
        };
        assert_eq!(f(None), 0.0);
        let wrong = f(Some(Erratum::BelowHorizon));
        assert!(wrong.is_finite() && (wrong < 0.0) == (model != Model::Ggx), "{model:?} {wrong}");
    }
}

/// A polished plate tilted by 2 degrees reflects a lamp four degrees from where it should.
#[test]
fn lobe_frame_pole_loses_the_reflection_of_a_plate_tilted_a_little() {
    for (tilt, stays) in [(2.0, false), (5.0, true)] {
        let mut b = plate(material(0.0, 1.0, 0.002), tilt, at(30.0 + tilt));
        emitter(&mut b, at(-30.0 + tilt), 0.3, [1.0; 3]);
        let params = Params { strategy: Strategy::BsdfOnly, ..direct(b) };
        close("right", mean(&params, 64)[0], 1.0, 0.05);
        let factor = factor(&params, Erratum::LobeFramePole, 64);
        assert!(if stays { (factor - 1.0).abs() < 0.01 } else { factor < 0.02 }, "{factor}");
    }
}

/// Lacquer at grazing: the same albedo, with several times the variance.
#[test]
fn constant_lobe_choice_costs_noise_alone() {
    let params = BrdfParams { kd: Rgb::splat(0.9), ks: Rgb::splat(0.03), ..specular(0.3) };
    let wo = direction(84.0);
    for model in Model::ALL {
        let albedo = |erratum| {
            let formulas = Formulas::of(model, Normals::Visible, erratum);
            let brdf = (formulas.at_wo)(&params, wo);
            let (mut r, mut mean) = (Random::new(8), Mean::default());
            for _ in 0..200_000 {
                let s = (formulas.sample)(&brdf, r.unit(), r.pair());
                mean.add(if s.pdf > 0.0 { (s.f.r * s.wi.z / s.pdf) as f64 } else { 0.0 });
            }
            mean
        };
        let (right, wrong) = (albedo(None), albedo(Some(Erratum::ConstantLobeChoice)));
        let [a, b] = [right, wrong].map(|m| m.standard_error());
        let sigmas = (right.mean - wrong.mean).abs() / a.hypot(b);
        assert!(sigmas < 4.5, "{model:?}: {} and {}", right.mean, wrong.mean);
        assert!((b / a).powi(2) > 2.0, "{model:?}: variance times {}", (b / a).powi(2));
    }
}

#[test]
fn double_direct_is_1_8_times_direct_light() {
    let mut b = plate(material(0.8, 0.0, 0.5), 0.0, at(20.0));
    emitter(&mut b, at(-30.0), 3.0, [3.0; 3]);
    let params = direct(b);
    close("wrong", factor(&params, Erratum::DoubleDirect, 256), 1.8, 0.01);
    close("right", without(&params, 256), 1.0, 0.01);
}

/// The same scene in other units, at powers of two: the right picture has the same bits.
#[test]
fn shadow_tolerance_depends_on_the_unit_of_length() {
    let scene = |unit: f64| {
        let mut b = SceneBuilder::new("unit");
        let (wall, emitter) = (material(0.8, 0.0, 0.5), Material::light("lamp", [3.0; 3]).unwrap());
        let (wall, emitter) = (b.material(wall), b.material(emitter));
        b.cuboid(DVec3::new(-2.0, -2.0, -0.1) * unit, DVec3::new(4.0, 4.0, 0.1) * unit, wall)
            .unwrap();
        b.cuboid(DVec3::new(0.4, 0.2, 1.7) * unit, DVec3::new(0.5, 0.5, 0.1) * unit, emitter)
            .unwrap();
        let (eye, target) = (DVec3::new(0.3, -1.0, 1.0), DVec3::new(0.1, 0.3, 0.0));
        b.camera = Some(Camera::look_at(eye * unit, target * unit, 0.2).unwrap());
        b.screen = [16, 12];
        Params { strategy: Strategy::LightOnly, ..direct(b) }
    };
    let scenes = [2f64.powi(-10), 8.0, 1024.0].map(scene);
    assert_eq!(mean(&scenes[0], 16), mean(&scenes[2], 16));
    let [small, middle, large] = scenes.map(|p| factor(&p, Erratum::ShadowTolerance, 64));
    close("in small units", small, 1.0, 0.01);
    // At last only those hits count that round to the very point.
    assert!(large < 0.3 && (large..0.95).contains(&middle), "{middle} and {large}");
}

#[test]
fn clamp_samples_never_exceeds_one() {
    let mut b = plate(material(0.8, 0.0, 0.5), 0.0, at(20.0));
    emitter(&mut b, at(-30.0), 3.0, [20.0, 2.0, 0.5]);
    b.camera = Some(Camera::look_at(at(60.0) * 20.0, at(-20.0) * 3.0, 0.4).unwrap());
    let right = Params::new(Arc::new(b.build()));
    let wrong = Params { erratum: Some(Erratum::ClampSamples), ..right.clone() };
    let greatest = |p: Params| {
        let pixels = render(p, 32, 0).unwrap().mean().pixels;
        pixels.into_iter().flatten().fold(0.0, f32::max)
    };
    assert!(greatest(right.clone()) > 15.0);
    assert_eq!(greatest(wrong.clone()), 1.0);
    let ([r, _, b], [clamped_r, _, clamped_b]) = (mean(&right, 32), mean(&wrong, 32));
    assert!(clamped_r < 0.5 * r);
    close("what never exceeds 1", clamped_b, b, 0.02);
}

/// A red, a green and a blue lamp in a row, asked for: 3/2, nothing, 3/2. Two lamps are right.
#[test]
fn first_and_last_light_forgets_the_middle_one() {
    let lit = |emitters: &[(f64, [f64; 3])]| {
        let mut b = plate(material(0.8, 0.0, 0.5), 0.0, at(20.0));
        for &(degrees, radiance) in emitters {
            emitter(&mut b, at(degrees), 1.0, radiance);
        }
        Params { strategy: Strategy::LightOnly, ..direct(b) }
    };
    let (red, green, blue) = ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]);
    for (emitters, factors) in [
        (vec![(-50.0, red), (-30.0, green), (-10.0, blue)], [1.5, 0.0, 1.5]),
        (vec![(-50.0, red), (-30.0, green)], [1.0, 1.0, f64::NAN]),
        (vec![(-50.0, green)], [f64::NAN, 1.0, f64::NAN]),
    ] {
        let right = lit(&emitters);
        let wrong = Params { erratum: Some(Erratum::FirstAndLastLight), ..right.clone() };
        let (right, wrong) = (mean(&right, 256), mean(&wrong, 256));
        for c in 0..3 {
            if factors[c].is_nan() {
                assert_eq!((right[c], wrong[c]), (0.0, 0.0));
            } else {
                let found = wrong[c] / right[c];
                assert!((found - factors[c]).abs() < 0.01, "{emitters:?}: {found}");
            }
        }
    }
}

/// Inside a closed box in a bright world it is dark, however small the box.
#[test]
fn fixed_epsilon_leaks_through_small_walls() {
    for (side, leaks) in [(4e-4, true), (4.0, false)] {
        let mut b = SceneBuilder::new("box");
        let wall = b.material(material(0.8, 0.1, 0.5));
        b.cuboid(DVec3::splat(-side / 2.0), DVec3::splat(side), wall).unwrap();
        b.environment = [1.0; 3];
        b.camera = Some(Camera::look_at(at(20.0) * side * 0.2, DVec3::ZERO, 1.0).unwrap());
        b.screen = [32, 32];
        let right = Params::new(Arc::new(b.build()));
        let wrong = Params { erratum: Some(Erratum::FixedEpsilon), ..right.clone() };
        assert_eq!(mean(&right, 16), [0.0; 3]);
        let leaked = mean(&wrong, 16)[0];
        assert!(if leaks { leaked > 0.05 } else { leaked < 1e-3 }, "side {side}: {leaked}");
    }
}

/// However the normals are drawn and light is found, the mean is the same.
#[test]
fn both_ways_to_draw_normals_agree() {
    let scene = everything();
    for model in [Model::Beckmann, Model::Ggx] {
        for strategy in Strategy::ALL {
            let of = |normals| {
                let mut m = Mean::default();
                for seed in 0..16 {
                    let p = Params { model, strategy, normals, seed, ..Params::new(scene.clone()) };
                    m.add(mean(&p, 64).iter().sum::<f64>() / 3.0);
                }
                m
            };
            let (a, b) = (of(Normals::Visible), of(Normals::Distribution));
            let se = a.standard_error().hypot(b.standard_error());
            let case = format!("{model:?} {strategy:?}: {} and {} +- {se}", a.mean, b.mean);
            assert!((a.mean - b.mean).abs() < 4.5 * se && se < 0.01 * a.mean, "{case}");
            assert!(a.mean != b.mean, "{case}");
        }
    }
}

/// What a mistake does is told from pairs of pictures that have their noise in common: with one that
/// the scene hardly notices, both are as noisy, and their difference is not.
#[test]
fn right_and_wrong_pictures_have_their_noise_in_common() {
    let (builder, _) = Example::named("shell").unwrap().read().unwrap();
    let base = Params { size: [32, 24], ..Params::new(Arc::new(builder.build())) };
    let bench = Bench { base, passes: 16, pairs: 4, threads: 0 };
    let pictures = |erratum| bench.pictures(Model::Ggx, erratum).unwrap();
    let effect = Effect::between(&pictures(Some(Erratum::FixedEpsilon)), &pictures(None));
    assert!((0.9..1.1).contains(&effect.noise_ratio), "{effect:?}");
    assert!(effect.margin.unwrap() < 0.002, "{effect:?}");
}

/// The page of the errata has each by its name, in the program's order.
#[test]
fn the_page_lists_every_erratum() {
    let page = include_str!("../../src/measure/errata.md");
    let name = |line: &str| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned());
    let listed: Vec<String> =
        page.lines().filter_map(name).filter(|name| !name.starts_with("--")).collect();
    assert_eq!(listed, Erratum::ALL.map(Erratum::name));
}
