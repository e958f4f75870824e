//! Surfaces that emit and reflect: a light that contains the shaded point, or lies in its plane,
//! gives it nothing, wherever rounding puts the point.
//!
//! Nothing here is at a round place: bodies are turned, scaled and moved at random.

use crate::support::{Random, ball, place, vector};
use burnish::brdf::{Model, Roughness};
use burnish::math::simd::Isa;
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::{Camera, Material, MaterialId, Mesh, Scene, SceneBuilder};
use burnish::trace::ReuseGroup;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;

const RADIANCE: f64 = 2.0;

/// The shapes of lights.
const BODIES: [&str; 9] = [
    "triangle",
    "rectangle",
    "parallelogram",
    "sphere",
    "cylinder",
    "disk",
    "box",
    "smooth mesh",
    "mesh of parts",
];

fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A convex body of about unit size in the builder, placed; a point of its surface and the normal
/// there, placed as well.
fn body(
    b: &mut SceneBuilder,
    what: &str,
    to_world: DAffine3,
    material: MaterialId,
    r: &mut Random,
) -> [DVec3; 2] {
    let scale = to_world.matrix3.determinant().cbrt();
    let on_triangle = |mesh: &Mesh, r: &mut Random| {
        let which = (r.unit() * mesh.triangles.len() as f32) as usize;
        let [p, q, s] = mesh.triangles[which].map(|i| mesh.positions[i as usize]);
        let (mut u, mut v) = (r.within(0.02, 0.98), r.within(0.02, 0.98));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let mut n = (q - p).cross(s - p).normalize();
        // Bodies are around the origin.
        if n.dot(p) < 0.0 {
            n = -n;
        }
        [p + (q - p) * u + (s - p) * v, n]
    };
    let cylinder = |b: &mut SceneBuilder, height: f64| {
        let base = to_world.transform_point3(DVec3::Z * (-0.5 * height));
        let axis = to_world.transform_vector3(DVec3::Z * height);
        b.cylinder(base, axis, 0.6 * scale, material).unwrap();
    };
    let [p, n] = match what {
        "sphere" => {
            b.sphere(to_world.translation, 0.7 * scale, material).unwrap();
            let n = DVec3::from(r.direction());
            [n * 0.7, n]
        }
        "cylinder" => {
            cylinder(b, 1.3);
            let phi = r.within(0.0, TAU);
            let n = DVec3::new(phi.cos(), phi.sin(), 0.0);
            [n * 0.6 + DVec3::Z * r.within(-0.6, 0.6), n]
        }
        "disk" => {
            cylinder(b, 0.013);
            let (phi, d) = (r.within(0.0, TAU), r.within(0.0, 0.59));
            [DVec3::new(phi.cos() * d, phi.sin() * d, 0.0065), DVec3::Z]
        }
        _ => {
            let [u, v] = [vector(r, 0.8), vector(r, 0.8)];
            let square = |u: DVec3, v: DVec3| {
                let corners = vec![-u - v, u - v, u + v, v - u];
                mesh(corners, vec![[0, 1, 2], [0, 2, 3]])
            };
            let shape = match what {
                "triangle" => mesh(vec![-u - v, u - v, v], vec![[0, 1, 2]]),
                "rectangle" => square(u, u.cross(v).normalize() * v.length()),
                "parallelogram" => square(u, v),
                "box" => {
                    let size = DVec3::new(0.5, 0.4, 0.7);
                    let at = |i: u32| {
                        let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                        DVec3::new(side(0), side(1), side(2)) * size
                    };
                    let sides: [[u32; 4]; 6] = [
                        [0, 1, 3, 2],
                        [4, 5, 7, 6],
                        [0, 1, 5, 4],
                        [2, 3, 7, 6],
                        [0, 2, 6, 4],
                        [1, 3, 7, 5],
                    ];
                    // Vertices of their own for every side: flat.
                    let positions = sides.iter().flatten().map(|&i| at(i)).collect();
                    let halves =
                        |i: u32| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]];
                    mesh(positions, (0..6).flat_map(halves).collect())
                }
                "smooth mesh" => ball(2),
                _ => ball(1),
            };
            // Each triangle a light of its own, or all of them one.
            if what == "mesh of parts" {
                for t in &shape.triangles {
                    let part = mesh(shape.positions.clone(), vec![*t]);
                    b.mesh(&part, to_world, material).unwrap();
                }
            } else {
                b.mesh(&shape, to_world, material).unwrap();
            }
            on_triangle(&shape, r)
        }
    };
    [to_world.transform_point3(p), to_world.transform_vector3(n).normalize()]
}

/// Looks at a point from a random place on the side of its normal, or on either side.
fn look(b: &mut SceneBuilder, [p, n]: [DVec3; 2], size: f64, both_sides: bool, r: &mut Random) {
    let mut towards = DVec3::from(r.direction());
    let side = if both_sides && r.unit() < 0.5 { -1.0 } else { 1.0 };
    if towards.dot(n) * side < 0.0 {
        towards = -towards;
    }
    let towards = (towards + n * (0.2 * side)).normalize();
    let eye = p + towards * (size * r.within(0.5, 3.0));
    b.camera = Some(Camera::look_at(eye, p, 1e-5).unwrap());
    b.screen = [32, 8];
}

fn finish(r: &mut Random, emission: f64) -> Material {
    let alpha = 10f64.powf(r.within(-4.0, 0.0));
    let material = Material::reflecting("surface", [0.6; 3], [0.3; 3], 10.0).unwrap();
    let roughness = Roughness::from_alpha(alpha).unwrap();
    Material { roughness, ..material }.emitting([emission; 3]).unwrap()
}

/// What a scene is traced by: every way that users have.
fn pictures(mut scene: Scene, model: Model, round: u64, each: &mut dyn FnMut(&str, [f64; 2])) {
    let sets = Isa::available();
    scene.set_isa(sets[round as usize % sets.len()]);
    let params = Params { model, seed: 77 + round, ..Params::new(Arc::new(scene)) };
    for (name, strategy, group) in [
        ("shared", Strategy::Mis, Some(ReuseGroup::ThirtyTwo)),
        ("alone", Strategy::Mis, Some(ReuseGroup::None)),
        ("lights", Strategy::LightOnly, Some(ReuseGroup::None)),
        ("bsdf", Strategy::BsdfOnly, Some(ReuseGroup::None)),
    ] {
        let s = render(Params { strategy, group, ..params.clone() }, 4, 1).unwrap();
        assert_eq!((s.counts.nonfinite, s.counts.capped), (0, 0));
        let pixels = s.mean().pixels;
        let ends = |[low, high]: [f64; 2], p: &[f32; 3]| {
            [low.min(f64::from(p[1])), high.max(f64::from(p[1]))]
        };
        each(name, pixels.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends));
    }
}

/// A convex body sees nothing of itself: its picture is its emission.
#[test]
fn a_convex_emitter_that_reflects_shows_its_emission_alone() {
    for (kind, what) in BODIES.into_iter().enumerate() {
        for round in 0..24 {
            let mut r = Random::new(1000 * kind as u64 + round);
            let mut b = SceneBuilder::new("emitter");
            let surface = finish(&mut r, RADIANCE);
            let surface = b.material(surface);
            let to_world = place(&mut r);
            let seen = body(&mut b, what, to_world, surface, &mut r);
            // Where the body lies in the scene decides how its points are rounded.
            if round % 2 == 1 {
                let dark =
                    b.material(Material::reflecting("dark", [0.0; 3], [0.0; 3], 0.0).unwrap());
                let scale = to_world.matrix3.determinant().cbrt();
                let away = seen[0] - seen[1] * (scale * r.within(3.0, 30.0));
                b.sphere(away, 0.1 * scale, dark).unwrap();
            }
            let flat = matches!(what, "triangle" | "rectangle" | "parallelogram");
            let size = to_world.matrix3.determinant().cbrt();
            look(&mut b, seen, size, flat, &mut r);
            let model = Model::ALL[round as usize % 3];
            pictures(b.build(), model, round, &mut |name, [low, high]| {
                let off = (low - RADIANCE).abs().max((high - RADIANCE).abs());
                assert!(off < 1e-5, "{what} {round} {name}: {low} to {high}");
            });
        }
    }
}

/// A reflecting patch gets nothing from lights in its own plane, nor from below it.
#[test]
fn lights_in_the_plane_of_a_surface_do_not_light_it() {
    for round in 0..96 {
        let mut r = Random::new(5000 + round);
        let mut b = SceneBuilder::new("one plane");
        let patch = finish(&mut r, 0.0);
        let patch = b.material(patch);
        let emitter = finish(&mut r, RADIANCE);
        let emitter = b.material(emitter);
        let to_world = place(&mut r);
        let scale = to_world.matrix3.determinant().cbrt();
        // A rectangle around the middle, and lamps that share its plane beside and around it.
        let (x, y) = (r.within(0.1, 0.9), r.within(0.1, 0.9));
        let square = |low: [f64; 2], high: [f64; 2]| {
            let corner = |u: f64, v: f64| DVec3::new(u, v, 0.0);
            let corners = vec![
                corner(low[0], low[1]),
                corner(high[0], low[1]),
                corner(high[0], high[1]),
                corner(low[0], high[1]),
            ];
            mesh(corners, vec![[0, 1, 2], [0, 2, 3]])
        };
        b.mesh(&square([-x, -y], [x, y]), to_world, patch).unwrap();
        let gap = if round % 3 == 0 { 0.0 } else { r.within(0.0, 0.5) };
        let reach = r.within(0.2, 4.0);
        for emitters in [
            square([x + gap, -reach], [x + gap + reach, reach]),
            square([-x - gap - reach, -reach], [-x - gap, reach]),
            mesh(
                vec![
                    DVec3::new(-x, y + gap, 0.0),
                    DVec3::new(x, y + gap, 0.0),
                    DVec3::new(0.0, y + gap + reach, 0.0),
                ],
                vec![[0, 1, 2]],
            ),
        ] {
            b.mesh(&emitters, to_world, emitter).unwrap();
        }
        // A disk: the cap of a cylinder in the ground; and a ball that touches the plane.
        let at = DVec3::new(0.0, -y - gap - 0.4, 0.0);
        let base = to_world.transform_point3(at - DVec3::Z * 0.7);
        b.cylinder(base, to_world.transform_vector3(DVec3::Z * 0.7), 0.3 * scale, emitter).unwrap();
        let ball = to_world.transform_point3(DVec3::new(-0.9 * x, -y - gap - 0.4, -0.25));
        b.sphere(ball, 0.25 * scale, emitter).unwrap();
        let p = DVec3::new(r.within(-x, x), r.within(-y, y), 0.0);
        let n = to_world.transform_vector3(DVec3::Z).normalize();
        look(&mut b, [to_world.transform_point3(p), n], scale, false, &mut r);
        let model = Model::ALL[round as usize % 3];
        pictures(b.build(), model, round, &mut |name, [low, high]| {
            assert!(low >= 0.0 && high < 1e-5, "{round} {name}: {low} to {high}");
        });
    }
}

/// The two plates of the report of this fault: the lower one emits and reflects, the upper one
/// reflects. By Nyström's method, to ten digits.
#[test]
fn plates_that_face_each_other_at_no_round_distance() {
    for round in 0..12 {
        let mut r = Random::new(9000 + round);
        for (look_up, expected) in [(false, 2.015_469_83), (true, 0.158_604_12)] {
            let mut b = SceneBuilder::new("plates");
            let grey = |kd: f64, emission: f64| {
                let m = Material::reflecting("plate", [kd; 3], [0.0; 3], 0.0).unwrap();
                m.emitting([emission; 3]).unwrap()
            };
            let lower = b.material(grey(0.7, RADIANCE));
            let upper = b.material(grey(0.5, 0.0));
            let to_world = if round == 0 { DAffine3::IDENTITY } else { place(&mut r) };
            for (height, material) in [(0.0, lower), (1.3, upper)] {
                let corner = |x: f64, y: f64| DVec3::new(x, y, height);
                let corners = vec![
                    corner(-0.5, -0.5),
                    corner(0.5, -0.5),
                    corner(0.5, 0.5),
                    corner(-0.5, 0.5),
                ];
                let plate = mesh(corners, vec![[0, 1, 2], [0, 2, 3]]);
                b.mesh(&plate, to_world, material).unwrap();
            }
            let eye = to_world.transform_point3(DVec3::new(0.1, 0.05, 0.6));
            let target = DVec3::Z * if look_up { 1.3 } else { 0.0 };
            let target = to_world.transform_point3(target);
            b.camera = Some(Camera::look_at(eye, target, 1e-5).unwrap());
            b.screen = [128, 8];
            let params = Params::new(Arc::new(b.build()));
            for group in [ReuseGroup::ThirtyTwo, ReuseGroup::None] {
                let mut mean = crate::support::Mean::default();
                for seed in 0..16 {
                    let params = Params { group: Some(group), seed, ..params.clone() };
                    let pixels = render(params, 16, 1).unwrap().mean().pixels;
                    let sum: f64 = pixels.iter().map(|p| f64::from(p[1])).sum();
                    mean.add(sum / pixels.len() as f64);
                }
                let sigmas = mean.sigmas(expected);
                let off = (mean.mean / expected - 1.0).abs();
                assert!(
                    sigmas < 8.0 && off < 4e-3,
                    "{round} up {look_up} {group:?}: {} for {expected}, {sigmas} sigmas",
                    mean.mean
                );
            }
        }
    }
}

/// The matrix of [`place`] keeps shapes: what is drawn here is drawn elsewhere alike.
#[test]
fn places_are_similarities() {
    let mut r = Random::new(3);
    for _ in 0..100 {
        let m: DMat3 = place(&mut r).matrix3;
        let scale = m.determinant().cbrt();
        assert!((1e-4..=1e4).contains(&scale));
        let off = (m.transpose() * m * DMat3::from_diagonal(DVec3::splat(scale.powi(-2))))
            - DMat3::IDENTITY;
        assert!(off.to_cols_array().iter().all(|x| x.abs() < 1e-12));
    }
}
