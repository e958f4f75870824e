//! Light transport against exact answers, and its strategies against each other.

use crate::support::Mean;
use burnish::brdf::{Model, Roughness};
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::{Camera, Material, Mesh, Scene, SceneBuilder};
use burnish::trace::ReuseGroup;
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

fn diffuse(kd: f64) -> Material {
    Material::reflecting("diffuse", [kd; 3], [0.0; 3], 10.0).unwrap()
}

fn camera(eye: DVec3, target: DVec3, ry: f64) -> Camera {
    Camera::look_at(eye, target, ry).unwrap()
}

/// Mean of a whole picture over independent seeds.
fn mean_of(params: &Params, passes: u64, seeds: u64) -> Mean {
    let mut mean = Mean::default();
    for seed in 0..seeds {
        let s = render(Params { seed: 1000 + seed, ..params.clone() }, passes, 0).unwrap();
        assert_eq!((s.counts.nonfinite, s.counts.capped), (0, 0));
        let pixels = s.mean().pixels;
        let sum: f64 = pixels.iter().flatten().map(|&c| c as f64).sum();
        mean.add(sum / (3 * pixels.len()) as f64);
    }
    mean
}

fn assert_mean(case: &str, mean: Mean, expected: f64, relative: f64) {
    let (sigmas, off) = (mean.sigmas(expected), mean.mean / expected - 1.0);
    assert!(
        sigmas < 4.5 && off.abs() < relative,
        "{case}: {} +- {}, not {expected} ({sigmas:.1} sigmas, {off:e})",
        mean.mean,
        mean.standard_error()
    );
}

/// All walls emit 1 and reflect rho: every direction carries 1 / (1 - rho).
#[test]
fn furnaces_of_every_shape_scale_and_place() {
    for (shape, scale, shift) in [
        (0, 1.0, 0.0),
        (0, 1e-6, 0.0),
        (0, 1e-46, 0.0),
        (0, 1e6, 1e6),
        (1, 1.0, 1e6),
        (1, 1e17, 0.0),
        (2, 1.0, 0.0),
    ] {
        for rho in [0.0, 0.5, 0.9] {
            let mut b = SceneBuilder::new("furnace");
            let wall = b.material(diffuse(rho).emitting([1.0; 3]).unwrap());
            let at = DVec3::new(1.0, -2.0, 0.5) * shift * scale;
            match shape {
                0 => b.sphere(at, scale, wall).unwrap(),
                1 => b.cuboid(at - scale, DVec3::splat(2.0 * scale), wall).unwrap(),
                _ => {
                    b.cylinder(at - DVec3::Z * scale, DVec3::Z * 2.0 * scale, scale, wall).unwrap()
                }
            }
            let eye = at + DVec3::new(0.1, 0.2, -0.3) * scale;
            b.camera = Some(camera(eye, eye + DVec3::X, 1.0));
            b.screen = [16, 16];
            let scene = Arc::new(b.build());
            let case = format!("shape {shape} scale {scale} rho {rho}");
            for depth in [None, Some(1), Some(3)] {
                let params = Params { max_depth: depth, ..Params::new(scene.clone()) };
                let expected = match depth {
                    None => 1.0 / (1.0 - rho),
                    Some(d) => (0..=d).map(|k| rho.powi(k as i32)).sum(),
                };
                assert_mean(&case, mean_of(&params, 64, 12), expected, 4e-3);
            }
        }
    }
}

/// A plane under a sphere lamp: irradiance pi L (R/d)² cos, exactly, while the lamp is above the
/// horizon.
#[test]
fn a_plane_under_a_sphere_receives_its_form_factor() {
    for (radius, height, aside) in
        [(0.5, 1.5, 0.0), (0.5, 2.0, 1.5), (1e-3, 3.0, 1.0), (0.9, 1.0, 0.0)]
    {
        let mut b = SceneBuilder::new("plane and sphere");
        let floor = b.material(diffuse(0.8));
        let emitter = b.material(Material::light("lamp", [3.0; 3]).unwrap());
        b.cuboid(DVec3::new(-3.0, -3.0, 0.0), DVec3::new(6.0, 6.0, 0.0), floor).unwrap();
        b.sphere(DVec3::new(aside, 0.0, height), radius, emitter).unwrap();
        // Looks at the origin from the side, through a very small window.
        b.camera = Some(camera(DVec3::new(-2.0, -0.4, 0.35), DVec3::ZERO, 1e-4));
        b.screen = [8, 8];
        let d2: f64 = aside * aside + height * height;
        let expected = 0.8 * 3.0 * radius * radius / d2 * height / d2.sqrt();
        let scene = Arc::new(b.build());
        let case = format!("R {radius} h {height} x {aside}");
        let params = Params { max_depth: Some(1), ..Params::new(scene) };
        assert_mean(&case, mean_of(&params, 64, 24), expected, 1e-3);
    }
}

fn lit_room(lamp_shape: usize) -> Arc<Scene> {
    let mut b = SceneBuilder::new("lit room");
    let wall = Material::reflecting("wall", [0.5, 0.4, 0.3], [0.1; 3], 20.0).unwrap();
    let wall = b.material(wall);
    let metal = b.material(Material::reflecting("metal", [0.0; 3], [0.8; 3], 60.0).unwrap());
    let emitter = b.material(Material::light("lamp", [2.0, 3.0, 4.0]).unwrap());
    b.cuboid(DVec3::new(-2.0, -2.0, -1.0), DVec3::new(4.0, 4.0, 0.0), wall).unwrap();
    b.cuboid(DVec3::new(-2.0, 2.0, -1.0), DVec3::new(4.0, 0.0, 3.0), wall).unwrap();
    b.sphere(DVec3::new(0.6, 0.5, -0.4), 0.6, metal).unwrap();
    match lamp_shape {
        0 => b.sphere(DVec3::new(-0.8, 0.3, 0.4), 0.7, emitter).unwrap(),
        1 => b
            .cylinder(DVec3::new(-0.9, 0.2, -0.5), DVec3::new(0.2, 0.3, 1.2), 0.4, emitter)
            .unwrap(),
        // Touches the floor and the wall.
        2 => b.cuboid(DVec3::new(-1.6, 1.0, -1.0), DVec3::new(0.9, 1.0, 0.9), emitter).unwrap(),
        3 => {
            // One light of two very unequal triangles.
            let v = DVec3::new;
            let mesh = Mesh {
                positions: vec![
                    v(-1.5, 0.0, 1.2),
                    v(1.0, 0.0, 1.2),
                    v(0.0, 1.8, 1.0),
                    v(1.1, 0.1, 1.2),
                ],
                triangles: vec![[0, 1, 2], [1, 3, 2]],
                ..Mesh::default()
            };
            b.mesh(&mesh, DAffine3::from_quat(DQuat::from_rotation_z(0.2)), emitter)
                .map(|_| ())
                .unwrap();
        }
        4 => b.environment = [0.6, 0.7, 0.8],
        5 => {
            // Forty of every kind, near and far, in view and out of it, and the environment.
            b.environment = [0.05, 0.1, 0.1];
            for i in 0..40 {
                let part = |x: f64| (x * f64::from(i + 1)).fract();
                let p = DVec3::new(part(0.618_034), part(0.754_878), part(0.569_84));
                let p = p * DVec3::new(3.2, 2.6, 1.8) + DVec3::new(-1.6, -0.9, -0.8);
                match i % 4 {
                    0 => b.sphere(p, 0.15, emitter).unwrap(),
                    1 => b.cuboid(p, DVec3::new(0.2, 0.3, 0.0), emitter).unwrap(),
                    2 => b.cuboid(p, DVec3::new(0.0, 0.2, 0.2), emitter).unwrap(),
                    _ => b.cylinder(p, DVec3::new(0.2, 0.0, 0.2), 0.06, emitter).unwrap(),
                }
            }
        }
        6 => {
            // A lamp as large as the floor and close to it.
            let (low, side) = (DVec3::new(-2.0, -2.0, -0.7), DVec3::new(1.5, 4.0, 0.0));
            b.cuboid(low, side, emitter).unwrap();
        }
        _ => {
            // A surface that emits and reflects, beside the environment.
            b.environment = [0.1, 0.1, 0.2];
            let glow = diffuse(0.7).emitting([1.0, 0.5, 0.2]).unwrap();
            let glow = b.material(glow);
            b.sphere(DVec3::new(-0.7, 0.4, -0.3), 0.7, glow).unwrap();
        }
    }
    b.camera = Some(camera(DVec3::new(0.1, -3.5, 0.6), DVec3::new(0.0, 0.5, -0.2), 0.5));
    b.screen = [32, 24];
    Arc::new(b.build())
}

/// Light sampling alone, BSDF sampling alone and both together have one mean, for every shape of lamp and
/// every model. Small pictures do not keep two cores busy, so that there are two threads with half of the lamps each.
#[test]
fn light_only_bsdf_only_and_mis_agree() {
    std::thread::scope(|threads| {
        for first in [0, 1] {
            threads.spawn(move || (first..8).step_by(2).for_each(strategies_agree));
        }
    });
}

fn strategies_agree(emitter: usize) {
    let scene = lit_room(emitter);
    for model in Model::ALL {
        let of = |strategy| {
            let params = Params { strategy, model, ..Params::new(scene.clone()) };
            mean_of(&params, 96, 8)
        };
        let [mis, light, bsdf] = [Strategy::Mis, Strategy::LightOnly, Strategy::BsdfOnly].map(of);
        for (name, other) in [("light only", light), ("BSDF only", bsdf)] {
            let se = mis.standard_error().hypot(other.standard_error());
            let (d, case) = (other.mean - mis.mean, format!("lamp {emitter} {model:?} {name}"));
            assert!(
                d.abs() < 4.5 * se && d.abs() < 0.02 * mis.mean,
                "{case}: {} against {} +- {se}",
                other.mean,
                mis.mean
            );
        }
        assert!(mis.standard_error() < 3e-3 * mis.mean, "too noisy to tell");
    }
}

/// Inside a closed box, in a white environment, there is not one photon.
#[test]
fn no_light_leaks_into_a_closed_box() {
    for turn in [0.0, 0.3] {
        let mut b = SceneBuilder::new("closed box");
        let wall = b.material(diffuse(0.95));
        let mut cube = Mesh::default();
        for i in 0..8 {
            let bit = |k: u32| (i >> k & 1) as f64 * 2.0 - 1.0;
            cube.positions.push(DVec3::new(bit(0), bit(1), bit(2)));
        }
        for [a, b, c, d] in
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
        {
            cube.triangles.extend([[a, b, c], [a, c, d]]);
        }
        b.mesh(
            &cube,
            DAffine3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, turn, 2.0 * turn, turn)),
            wall,
        )
        .unwrap();
        b.environment = [1e6; 3];
        // Into a corner, where three walls meet.
        b.camera = Some(camera(DVec3::new(-0.1, 0.2, 0.1), DVec3::new(1.0, 1.0, 1.0), 1.2));
        b.screen = [320, 320];
        let params = Params { max_depth: Some(20), ..Params::new(Arc::new(b.build())) };
        let s = render(params, 16, 0).unwrap();
        assert!(s.counts.rays > 10_000_000, "{}", s.counts.rays);
        assert!(s.mean().pixels.iter().all(|p| *p == [0.0; 3]));
    }
}

/// Shading normals that have nothing to do with the faces may darken, never let light in.
#[test]
fn normals_that_lie_let_no_light_in() {
    let mut b = SceneBuilder::new("closed box");
    let wall = Material::reflecting("wall", [0.5; 3], [0.5; 3], 20.0).unwrap();
    let wall = b.material(wall);
    let mut r = crate::support::Random::new(8);
    let mut cube = Mesh::default();
    let n = 8u32;
    for face in 0..6usize {
        let first = cube.positions.len() as u32;
        for i in 0..(n + 1) * (n + 1) {
            let mut p = DVec3::splat(if face < 3 { 1.0 } else { -1.0 });
            p[(face + 1) % 3] = (i % (n + 1)) as f64 / n as f64 * 2.0 - 1.0;
            p[(face + 2) % 3] = (i / (n + 1)) as f64 / n as f64 * 2.0 - 1.0;
            cube.positions.push(p);
            cube.normals.push(DVec3::from_array(r.direction()));
        }
        for i in 0..n * n {
            let a = first + i / n * (n + 1) + i % n;
            cube.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        }
    }
    b.mesh(&cube, DAffine3::from_quat(DQuat::from_rotation_z(0.3)), wall).unwrap();
    b.environment = [1e6; 3];
    b.camera = Some(camera(DVec3::new(-0.1, 0.2, 0.1), DVec3::new(1.0, 1.0, 1.0), 2.0));
    b.screen = [96, 96];
    for model in Model::ALL {
        let inside = Params { model, ..Params::new(Arc::new(b.clone().build())) };
        let s = render(inside, 16, 0).unwrap();
        assert!(s.mean().pixels.iter().all(|p| *p == [0.0; 3]), "{model:?}");
        // From outside it is lit, and no sample is lost.
        let mut outside = b.clone();
        outside.camera = Some(camera(DVec3::splat(4.0), DVec3::ZERO, 0.5));
        let s = render(Params { model, ..Params::new(Arc::new(outside.build())) }, 16, 0).unwrap();
        assert_eq!(s.counts.nonfinite, 0);
        assert!(s.mean().pixels.iter().any(|p| p[0] > 1e5 && p[0] < 9e5), "{model:?}");
    }
}

/// Kd 1 and a lobe on top: every bounce gives back more than it gets. Such a room is read and
/// rendered; the series grows faster than a white room's, which adds 1 a bounce, and without a
/// limit it has no sum, but every path ends. Each sample is a number: where the gain is so large that
/// a path of hundreds of bounces would leave their range, it ends before, and is counted.
#[test]
fn a_room_that_gains_light_ends_and_stays_finite() {
    for (ks, least, grows) in [(0.04, 5.1, false), (0.5, 6.0, true), (1.0, 6.0, true)] {
        let mut b = SceneBuilder::new("gain");
        let wall = Material::reflecting("wall", [1.0; 3], [ks; 3], 6.0).unwrap();
        let wall = b.material(wall.emitting([1.0; 3]).unwrap());
        b.sphere(DVec3::ZERO, 1.0, wall).unwrap();
        b.camera = Some(camera(DVec3::new(0.1, 0.0, 0.0), DVec3::X, 1.0));
        b.screen = [16, 16];
        let scene = Arc::new(b.build());
        for model in Model::ALL {
            let of = |max_depth, group| {
                let params = Params { model, max_depth, group, ..Params::new(scene.clone()) };
                render(params, 64, 0).unwrap()
            };
            let mean = |s: &burnish::progressive::Snapshot| {
                s.mean().pixels.iter().map(|p| p[0] as f64).sum::<f64>() / 256.0
            };
            let case = format!("{model:?} Ks {ks}");
            let short = of(Some(4), None);
            assert_eq!(short.counts.nonfinite, 0, "{case}");
            assert!(mean(&short) > least, "{case}: {}, a white room has 5", mean(&short));
            for group in [ReuseGroup::None, ReuseGroup::Sixteen, ReuseGroup::OneTwentyEight] {
                let endless = of(None, Some(group));
                assert!(endless.counts.rays < 1000 * endless.counts.paths, "{case}");
                assert!(mean(&endless).is_finite() && mean(&endless) > 10.0, "{case}");
                // What has grown too far ends, counted, before it leaves the range of numbers.
                let (lost, ended) = (endless.counts.nonfinite, endless.counts.capped);
                assert!(lost == 0, "{case}, {group:?}: {lost} of 16,384 samples");
                // Where it grows by 3 % a bounce few get that far.
                assert!(ended <= 164 || grows, "{case}, {group:?}: {ended} of 16,384 paths");
                assert!(ended > 0 || !grows || ks < 1.0, "{case}, {group:?}: none ended");
            }
        }
    }
}

/// What the camera sees of a light is its radiance, without any noise, from both sides.
#[test]
fn a_light_seen_directly_is_exact() {
    let mut b = SceneBuilder::new("lamp");
    let emitter = b.material(Material::light("lamp", [1.5, 0.25, 1e6]).unwrap());
    b.cuboid(DVec3::new(-9.0, 1.0, -9.0), DVec3::new(18.0, 0.0, 18.0), emitter).unwrap();
    b.screen = [9, 7];
    for eye in [DVec3::ZERO, DVec3::Y * 2.0] {
        b.camera = Some(camera(eye, DVec3::Y, 0.8));
        let s = render(Params::new(Arc::new(b.clone().build())), 5, 0).unwrap();
        assert!(s.mean().pixels.iter().all(|p| *p == [1.5, 0.25, 1e6]));
    }
}

/// In a perfectly white room throughput never falls and no sample is lost: roulette alone ends
/// paths. One camera ray, 8 rays for certain; then event k is left with the chance 1 - 2 / (k + 64),
/// so that event m is reached with 70 * 71 / ((m + 62) (m + 63)). Summed up to the cap of 1000
/// events that is 74.3 rays without shadow rays, and 0.44 % of the paths meet the cap.
#[test]
fn a_white_room_ends_by_roulette_as_expected() {
    let mut b = SceneBuilder::new("white room");
    let wall = b.material(diffuse(1.0).emitting([1e-3; 3]).unwrap());
    b.sphere(DVec3::ZERO, 1.0, wall).unwrap();
    b.camera = Some(camera(DVec3::new(0.1, 0.0, 0.0), DVec3::X, 1.0));
    b.screen = [16, 16];
    let params = Params { strategy: Strategy::BsdfOnly, ..Params::new(Arc::new(b.build())) };
    let s = render(params, 256, 0).unwrap();
    assert_eq!(s.counts.nonfinite, 0);
    let reached = |m: f64| 70.0 * 71.0 / ((m + 62.0) * (m + 63.0));
    let expected = 9.0 + (9..=1000).map(|m| reached(m as f64)).sum::<f64>();
    let rays = s.counts.rays as f64 / s.counts.paths as f64;
    // A path's count has a standard deviation of about 150: 0.6 for the mean of 65,536.
    assert!((rays - expected).abs() < 2.6, "{rays} rays a path, not {expected}");
    let (capped, expected) = (s.counts.capped as f64, reached(1000.0) * s.counts.paths as f64);
    assert!((capped - expected).abs() < 4.5 * expected.sqrt(), "{capped} capped, not {expected}");
}

#[test]
fn the_model_and_the_roughness_change_the_picture() {
    let scene = lit_room(0);
    let picture = |model, alpha| {
        let p = Params { model, ..Params::new(scene.clone()) };
        render(p.with_roughness(Roughness::from_alpha(alpha).unwrap()), 16, 0).unwrap().mean()
    };
    let ggx = picture(Model::Ggx, 0.3);
    assert_ne!(ggx, picture(Model::Beckmann, 0.3));
    assert_ne!(ggx, picture(Model::Phong, 0.3));
    assert_ne!(ggx, picture(Model::Ggx, 0.31));
}
