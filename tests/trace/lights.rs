//! Lights that are hard to sample: of any size as seen from where they shine, touching what they
//! light, behind it, without area, very many, very unequal.

use crate::support::Mean;
use burnish::brdf::{Model, Roughness};
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::{Camera, Material, MaterialId, Mesh, SceneBuilder};
use glam::{DAffine3, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Reflectance of the floor.
const KD: f64 = 0.8;

fn emitter(b: &mut SceneBuilder, radiance: f64) -> MaterialId {
    b.material(Material::light("lamp", [radiance; 3]).unwrap())
}

/// A scene with a diffuse floor at height 0, this far to each side.
fn floor(half: f64) -> SceneBuilder {
    let mut b = SceneBuilder::new("floor");
    let kd = b.material(Material::reflecting("floor", [KD; 3], [0.0; 3], 10.0).unwrap());
    let corner = DVec3::new(-half, -half, 0.0);
    b.cuboid(corner, DVec3::new(2.0 * half, 2.0 * half, 0.0), kd).unwrap();
    b.screen = [8, 8];
    b
}

/// Looks at a point of the floor through a very small window.
fn look(b: &mut SceneBuilder, eye: DVec3, target: DVec3) {
    b.camera = Some(Camera::look_at(eye, target, 1e-6).unwrap());
}

/// Light that comes straight from lamps; the error of the mean is that between seeds.
fn direct(b: &SceneBuilder, strategy: Strategy, passes: u64) -> Mean {
    let params =
        Params { max_depth: Some(1), strategy, ..Params::new(Arc::new(b.clone().build())) };
    let mut mean = Mean::default();
    for seed in 0..8 {
        let s = render(Params { seed: 500 + seed, ..params.clone() }, passes, 0).unwrap();
        assert_eq!((s.counts.nonfinite, s.counts.capped), (0, 0));
        let pixels = s.mean().pixels;
        mean.add(pixels.iter().map(|p| p[1] as f64).sum::<f64>() / pixels.len() as f64);
    }
    mean
}

/// Student with 7 degrees of freedom goes beyond 10 standard errors twice in a hundred thousand;
/// what does not vary at all is good to a few roundings.
fn assert_mean(case: &str, mean: Mean, expected: f64, relative: f64) {
    let off = (mean.mean - expected).abs();
    let noise = mean.standard_error().max(1e-6 * expected);
    assert!(
        off < 10.0 * noise && off < relative * expected,
        "{case}: {} +- {}, not {expected}",
        mean.mean,
        mean.standard_error()
    );
}

/// A sphere of radius R in the middle of the sky at distance d: irradiance pi L (R / d)² cos, from
/// a far spark to a ball that all but touches the floor, and touching it beside the point seen.
#[test]
fn a_sphere_lamp_of_any_apparent_size_has_its_form_factor() {
    for (radius, height, aside) in [
        (2e-6, 2.0, 0.0),
        (2e-6, 1.2, 1.6),
        (1e-3, 2.0, 0.5),
        (1.0, 1.5, 1.0),
        (1.0, 1.0 + 1e-3, 0.0),
        (1.0, 1.0 + 1e-5, 0.0),
        (1.0, 1.0, 0.3),
        (1.0, 1.0, 0.05),
    ] {
        let mut b = floor(3.0);
        let d2: f64 = height * height + aside * aside;
        // So bright that the floor is of radiance KD cos.
        let emitter = emitter(&mut b, d2 / (radius * radius));
        b.sphere(DVec3::new(aside, 0.0, height), radius, emitter).unwrap();
        // Below the ball's belly, from the far side: flat enough, and close enough to see nothing
        // but floor through the window.
        let gap: f64 = height - radius + 0.5 * aside * aside;
        let slope = (0.7 * (2.0 * gap).sqrt()).min(0.3);
        let back = if gap < 0.1 { 0.1 } else { 2.0 };
        look(&mut b, DVec3::new(-back, 0.0, back * slope), DVec3::ZERO);
        let expected = KD * height / d2.sqrt();
        for strategy in [Strategy::Mis, Strategy::LightOnly] {
            let case = format!("R {radius} h {height} x {aside} {strategy:?}");
            assert_mean(&case, direct(&b, strategy, 64), expected, 1e-3);
        }
    }
}

/// Whatever the shape of a lamp that closes around it, a floor gets pi L; so it does close to the
/// lamp's own surface, through which it passes.
#[test]
fn inside_a_lamp_all_directions_are_bright() {
    for shape in 0..3 {
        for half in [0.5, 3.0] {
            let mut b = floor(half);
            let emitter = emitter(&mut b, 3.0);
            match shape {
                0 => b.sphere(DVec3::new(0.0, 0.0, 0.2), 2.0, emitter).unwrap(),
                1 => b.cuboid(DVec3::splat(-2.0), DVec3::splat(4.0), emitter).unwrap(),
                _ => b.cylinder(DVec3::Z * -1.5, DVec3::Z * 4.0, 2.0, emitter).unwrap(),
            }
            for x in [0.0, 0.4, 1.9, 1.985] {
                if x > half {
                    continue;
                }
                look(&mut b, DVec3::new(-0.3, 0.0, 0.6), DVec3::new(x, 0.0, 0.0));
                for strategy in Strategy::ALL {
                    let case = format!("shape {shape}, floor {half}, at {x} {strategy:?}");
                    // A wall next to the point, asked by its area, is seldom asked where it is near.
                    if strategy == Strategy::LightOnly && shape > 0 && x > 1.0 {
                        continue;
                    }
                    assert_mean(&case, direct(&b, strategy, 256), KD * 3.0, 4e-3);
                }
            }
        }
    }
}

/// What is below the horizon gives exactly nothing, what is in it nothing that could be seen.
#[test]
fn lamps_below_the_horizon_give_nothing() {
    let v = DVec3::new;
    for (name, corner, side, least) in [
        ("below, face up", v(1.5, -1.0, -0.5), v(2.0, 2.0, 0.0), 0.0),
        ("below, upright", v(1.5, -1.0, -2.0), v(0.0, 2.0, 1.99), 0.0),
        ("in the plane", v(1.5, -1.0, 0.0), v(2.0, 2.0, 0.0), 1e-6),
    ] {
        let mut b = floor(1.0);
        let emitter = emitter(&mut b, 5.0);
        b.cuboid(corner, side, emitter).unwrap();
        look(&mut b, v(-1.0, 0.0, 2.0), DVec3::ZERO);
        for strategy in Strategy::ALL {
            let mean = direct(&b, strategy, 32).mean;
            assert!((0.0..=least).contains(&mean), "{name} {strategy:?}: {mean}");
        }
        // And the same lamps light the other side.
        if least == 0.0 {
            look(&mut b, v(-1.0, 0.0, -2.0), DVec3::ZERO);
            assert!(direct(&b, Strategy::Mis, 32).mean > 0.01, "{name}");
        }
    }
}

/// Triangles whose corners are one point in single precision are no lights: not a bit changes when
/// they are there, and alone they leave a black picture.
#[test]
fn lamps_without_area_are_left_out() {
    let far = DVec3::new(2.5, 2.0, 1.0);
    let speck = Mesh {
        positions: vec![far, far + DVec3::X * 1e-12, far + DVec3::Y * 1e-12],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let picture = |with_speck: bool, sky: f32| {
        let mut b = floor(3.0);
        let emitter = emitter(&mut b, 1e12);
        // The speck is within the bounds of this.
        let black = b.material(Material::reflecting("", [0.0; 3], [0.0; 3], 0.0).unwrap());
        b.sphere(far + DVec3::Z, 0.5, black).unwrap();
        if with_speck {
            assert_eq!(b.mesh(&speck, DAffine3::IDENTITY, emitter).unwrap().kept, 1);
        }
        b.environment = [sky; 3];
        look(&mut b, DVec3::new(-1.0, 0.0, 2.0), DVec3::ZERO);
        let s = render(Params::new(Arc::new(b.build())), 16, 0).unwrap();
        assert_eq!(s.counts.nonfinite, 0);
        s.mean()
    };
    assert_eq!(picture(true, 0.5), picture(false, 0.5));
    assert!(picture(true, 0.0).pixels.iter().all(|p| *p == [0.0; 3]));
}

/// Three hundred lamps of which one is a million times brighter: in sight, then behind a wall, so
/// that nearly every question goes to a lamp that cannot answer. The sum of the form factors is
/// exact both times.
#[test]
fn one_lamp_a_million_times_brighter_hides_no_other() {
    let (count, radius, distance) = (300, 0.06, 2.0);
    for walled in [false, true] {
        let mut b = floor(0.5);
        let (dim, bright) = (emitter(&mut b, 1.0), emitter(&mut b, 1e6));
        let mut expected = 0.0;
        for i in 0..count {
            // Evenly over the upper part of the sky, no two in a line.
            let z = 0.25 + 0.7 * (i as f64 + 0.5) / count as f64;
            let (sin, cos) = (TAU * 0.618_033_988_749_895 * i as f64).sin_cos();
            let r = (1.0f64 - z * z).sqrt();
            let at = DVec3::new(r * cos, r * sin, z) * distance;
            let chosen = i == 100;
            b.sphere(at, radius, if chosen { bright } else { dim }).unwrap();
            let seen = KD * (radius / distance).powi(2) * z;
            if chosen && walled {
                let side = DVec3::splat(2.4 * radius);
                let black = Material::reflecting("wall", [0.0; 3], [0.0; 3], 0.0).unwrap();
                let black = b.material(black);
                b.cuboid(at - side / 2.0, side, black).unwrap();
            } else {
                expected += seen * if chosen { 1e6 } else { 1.0 };
            }
        }
        look(&mut b, DVec3::new(0.3, -0.2, 1.2), DVec3::ZERO);
        let mean = direct(&b, Strategy::Mis, 512);
        assert_mean(&format!("walled: {walled}"), mean, expected, 0.02);
    }
}

/// Where one way to find light is hopeless the other is good, and both together are never much
/// worse than the better of the two (Veach 1997): a sharp lobe under a wide lamp, a dull one under
/// a small lamp, a sharp one under a small lamp.
#[test]
fn both_ways_together_are_as_good_as_the_better_one() {
    for (alpha, radius, better) in [
        (3e-3, 0.8, Some(Strategy::BsdfOnly)),
        (0.6, 0.01, Some(Strategy::LightOnly)),
        (0.02, 0.02, None),
    ] {
        let mut b = SceneBuilder::new("plate");
        let metal = b.material(Material::reflecting("metal", [0.0; 3], [0.9; 3], 10.0).unwrap());
        b.cuboid(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(4.0, 4.0, 0.0), metal).unwrap();
        let emitter = emitter(&mut b, 1.0 / (radius * radius));
        b.sphere(DVec3::new(0.0, 1.5, 1.5), radius, emitter).unwrap();
        // The mirror image of the lamp is in the middle.
        let eye = DVec3::new(0.0, -1.5, 1.5);
        b.camera = Some(Camera::look_at(eye, DVec3::ZERO, 0.05f64.max(0.6 * radius)).unwrap());
        b.screen = [48, 48];
        let scene = Arc::new(b.build());
        for model in Model::ALL {
            let rough = Roughness::from_alpha(alpha).unwrap();
            let [mis, light, bsdf] = Strategy::ALL.map(|strategy| {
                let p =
                    Params { model, strategy, max_depth: Some(1), ..Params::new(scene.clone()) };
                render(p.with_roughness(rough), 64, 0).unwrap().error.unwrap().rmse.value
            });
            let case = format!("{model:?} alpha {alpha} R {radius}: {mis} {light} {bsdf}");
            assert!(mis < 1.4 * light.min(bsdf), "{case}");
            match better {
                Some(Strategy::BsdfOnly) => assert!(light > 3.0 * bsdf, "{case}"),
                Some(_) => assert!(bsdf > 3.0 * light, "{case}"),
                None => {}
            }
        }
    }
}

/// A lamp of a given power is as bright from afar whatever it is cut into: one rectangle, and the
/// same of 2 x 5000 slivers in one mesh.
#[test]
fn a_lamp_of_many_slivers_is_the_lamp() {
    let mut whole = floor(2.0);
    let radiance = emitter(&mut whole, 2.0);
    let mut slivers = whole.clone();
    let (corner, side) = (DVec3::new(-0.5, -0.5, 1.0), DVec3::new(1.0, 1.0, 0.0));
    whole.cuboid(corner, side, radiance).unwrap();
    let mut mesh = Mesh::default();
    for i in 0..=5000u32 {
        let x = i as f64 / 5000.0;
        mesh.positions.extend([corner + DVec3::X * x, corner + DVec3::new(x, 1.0, 0.0)]);
        if i > 0 {
            let k = 2 * i;
            mesh.triangles.extend([[k - 2, k - 1, k], [k - 1, k + 1, k]]);
        }
    }
    slivers.mesh(&mesh, DAffine3::IDENTITY, radiance).unwrap();
    // A square of side 2 a at height h over the middle: four times a corner's form factor.
    let (a, h) = (0.5f64, 1.0f64);
    let leg = a / (a * a + h * h).sqrt();
    let corner_factor = 2.0 * leg * leg.atan() / TAU;
    let expected = KD * 2.0 * 4.0 * corner_factor;
    for (name, mut b) in [("whole", whole), ("slivers", slivers)] {
        look(&mut b, DVec3::new(-1.5, 0.0, 0.4), DVec3::ZERO);
        assert_mean(name, direct(&b, Strategy::Mis, 128), expected, 2e-3);
    }
}
