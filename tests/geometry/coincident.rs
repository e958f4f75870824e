//! Surfaces that share a place: the emitter is in front, else the first, for every ray; and what is
//! told about it.

use crate::support::{Mean, Random, place, vector};
use burnish::brdf::Model;
use burnish::math::simd::Isa;
use burnish::progressive::{Params, Strategy, render};
use burnish::scene::{
    Camera, Coinciding, Material, MaterialId, Mesh, Report, Scene, SceneBuilder, Warning,
};
use burnish::trace::ReuseGroup;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A rectangle at this height above the plane z = 0, with a random place for its diagonal's start.
fn rectangle([x, y]: [[f64; 2]; 2], z: f64, turn: usize) -> Mesh {
    let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
    let positions = (0..4).map(|i| corners[(i + turn) % 4]).map(|[x, y]| DVec3::new(x, y, z));
    Mesh {
        positions: positions.collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn material(b: &mut SceneBuilder, name: &str, kd: f64, emission: f64) -> MaterialId {
    let material = Material::reflecting(name, [kd; 3], [0.0; 3], 0.0).unwrap();
    b.material(material.emitting([emission; 3]).unwrap())
}

fn mean(params: &Params, strategy: Strategy, group: ReuseGroup) -> Mean {
    let mut mean = Mean::default();
    for seed in 0..12 {
        let params = Params { strategy, group: Some(group), seed, ..params.clone() };
        let s = render(params, 32, 1).unwrap();
        assert_eq!(s.counts.nonfinite, 0);
        let pixels = s.mean().pixels;
        mean.add(pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64);
    }
    mean
}

/// Two means that differ by less than chance would have it once in a hundred thousand, and by less
/// than a part in a hundred.
fn assert_alike(case: &str, a: Mean, b: Mean) {
    let noise = a.standard_error().hypot(b.standard_error()).max(1e-6 * a.mean);
    let off = (a.mean - b.mean).abs();
    assert!(off < 6.0 * noise && off < 0.01 * a.mean + noise, "{case}: {} and {}", a.mean, b.mean);
}

/// The warnings of its load.
fn told(scene: &Scene) -> Vec<Warning> {
    let mut report = Report::default();
    scene.report(&mut report);
    report.warnings
}

fn with_any_isa(scene: &mut Scene, round: usize) {
    let sets = Isa::available();
    scene.set_isa(sets[round % sets.len()]);
}

/// A room, its lamp in the plane of the ceiling without a hole for it: the rooms of strategies and
/// tracers are one room, and it is the one whose lamp is a hair's breadth lower.
#[test]
fn a_lamp_in_the_plane_of_the_ceiling_is_in_front_of_it() {
    let mut apart = 0.0f64;
    for round in 0..16 {
        let mut r = Random::new(40 + round as u64);
        let to_world = place(&mut r);
        let scale = to_world.matrix3.determinant().cbrt();
        let size = [r.within(0.7, 1.6), r.within(0.7, 1.6), r.within(0.7, 1.6)];
        let emitter = [
            [size[0] * r.within(0.1, 0.4), size[0] * r.within(0.6, 0.9)],
            [size[1] * r.within(0.1, 0.4), size[1] * r.within(0.6, 0.9)],
        ];
        let (kd, turn) = (r.within(0.2, 0.8), (r.unit() * 4.0) as usize);
        let as_disk = round % 4 == 3;
        let order = round % 2;
        let scene = |lower: f64| {
            let mut b = SceneBuilder::new("room");
            let wall = material(&mut b, "wall", kd, 0.0);
            let bright = material(&mut b, "lamp", 0.4, 3.0);
            let [w, d, h] = size;
            let shapes = |b: &mut SceneBuilder, which: usize| {
                if which == 1 && as_disk {
                    // The cap of a cylinder that stands on the ceiling.
                    let at = DVec3::new(0.5 * w, 0.5 * d, h - lower);
                    let radius = 0.3 * w.min(d) * scale;
                    let axis = to_world.transform_vector3(DVec3::Z * 0.2);
                    b.cylinder(to_world.transform_point3(at), axis, radius, bright).unwrap();
                } else if which == 1 {
                    b.mesh(&rectangle(emitter, h - lower, turn), to_world, bright).unwrap();
                } else {
                    b.mesh(&rectangle([[0.0, w], [0.0, d]], h, 0), to_world, wall).unwrap();
                    b.mesh(&rectangle([[0.0, w], [0.0, d]], 0.0, 1), to_world, wall).unwrap();
                    let side = DVec3::new(0.0, d, 0.0);
                    let back = Mesh {
                        positions: vec![
                            side,
                            side + DVec3::X * w,
                            side + DVec3::new(w, 0.0, h),
                            side + DVec3::Z * h,
                        ],
                        triangles: vec![[0, 1, 2], [0, 2, 3]],
                        ..Mesh::default()
                    };
                    b.mesh(&back, to_world, wall).unwrap();
                }
            };
            shapes(&mut b, order);
            shapes(&mut b, 1 - order);
            let eye = to_world.transform_point3(DVec3::new(0.4 * w, -1.5 * d, 0.3 * h));
            let target = to_world.transform_point3(DVec3::new(0.5 * w, 0.5 * d, 0.6 * h));
            b.camera = Some(Camera::look_at(eye, target, 0.4).unwrap());
            b.screen = [24, 24];
            b.build()
        };
        // Of few digits, so that it is a little above or below the plane or across it.
        let digits = if round % 2 == 0 { 0.0 } else { r.within(-8e-7, 8e-7) };
        let mut flush = scene(digits);
        let pairs: usize = flush.coinciding().iter().map(|c| c.pairs).sum();
        assert!(pairs > 0 && flush.coinciding().len() == 1, "{round}: {:?}", flush.coinciding());
        assert_eq!(flush.coinciding()[0], Coinciding { front: 1, behind: 0, pairs });
        let said = told(&flush);
        assert!(said.len() == 1 && said[0].text.contains("`lamp`, which emits"), "{said:?}");
        with_any_isa(&mut flush, round);
        let lower = scene(1e-4);
        assert!(lower.coinciding().is_empty() && told(&lower).is_empty());
        let params = |scene: Scene| {
            let model = Model::ALL[round % 3];
            Params { model, max_depth: Some(3), ..Params::new(Arc::new(scene)) }
        };
        let (flush, lower) = (params(flush), params(lower));
        let shared = mean(&flush, Strategy::Mis, ReuseGroup::Sixteen);
        let case = |name| format!("{round}, disk {as_disk}, order {order}: {name}");
        assert_alike(&case("lower"), shared, mean(&lower, Strategy::Mis, ReuseGroup::Sixteen));
        assert_alike(&case("alone"), shared, mean(&flush, Strategy::Mis, ReuseGroup::None));
        let bsdf = mean(&flush, Strategy::BsdfOnly, ReuseGroup::None);
        assert_alike(&case("bsdf"), shared, bsdf);
        let light = mean(&flush, Strategy::LightOnly, ReuseGroup::None);
        assert_alike(&case("light"), shared, light);
        let reference = Params { reference: true, ..flush.clone() };
        assert_alike(&case("reference"), shared, mean(&reference, Strategy::Mis, ReuseGroup::None));
        apart = apart.max((light.mean / bsdf.mean - 1.0).abs());
    }
    assert!(apart < 0.02, "{apart}");
}

/// Lamps that overlap in one plane: what is covered is no light.
#[test]
fn lamps_that_overlap_count_once() {
    for round in 0..12 {
        let mut r = Random::new(70 + round as u64);
        let to_world = place(&mut r);
        let mut b = SceneBuilder::new("lamps");
        let floor = material(&mut b, "floor", 0.7, 0.0);
        let first = material(&mut b, "first", 0.0, 1.0);
        // Of one material by turns, and of two.
        let second = if round % 2 == 0 { first } else { material(&mut b, "second", 0.0, 4.0) };
        b.mesh(&rectangle([[-3.0, 3.0], [-3.0, 3.0]], 0.0, 0), to_world, floor).unwrap();
        let x = r.within(-0.2, 0.5);
        b.mesh(&rectangle([[-1.0, 0.7], [-0.8, 0.6]], 0.9, 1), to_world, first).unwrap();
        b.mesh(&rectangle([[x, x + 1.1], [-0.5, 0.9]], 0.9, 2), to_world, second).unwrap();
        let eye = to_world.transform_point3(DVec3::new(2.0, 1.0, 0.6));
        let target = to_world.transform_point3(DVec3::new(0.1, 0.05, 0.4));
        b.camera = Some(Camera::look_at(eye, target, 0.5).unwrap());
        b.screen = [16, 16];
        let mut scene = b.build();
        with_any_isa(&mut scene, round);
        assert!(scene.coinciding().iter().all(|c| c.front == first && c.behind == second));
        assert!(!scene.coinciding().is_empty());
        let params = Params { max_depth: Some(2), ..Params::new(Arc::new(scene)) };
        let shared = mean(&params, Strategy::Mis, ReuseGroup::Sixteen);
        for strategy in Strategy::ALL {
            let case = format!("{round} {}", strategy.name());
            assert_alike(&case, shared, mean(&params, strategy, ReuseGroup::None));
        }
    }
}

/// Where nothing emits, the first in the file is what is seen, from either side.
#[test]
fn of_surfaces_that_do_not_emit_the_first_is_seen() {
    for round in 0..60 {
        let mut r = Random::new(100 + round as u64);
        let to_world = place(&mut r);
        let mut b = SceneBuilder::new("decal");
        b.environment = [1.0; 3];
        // Black ones are seen to be black, white ones bright.
        let (first, second) = (0.0, r.within(0.5, 0.9));
        let under = material(&mut b, "first", first, 0.0);
        let over = material(&mut b, "second", second, 0.0);
        let z = r.within(-0.3, 0.3);
        b.mesh(&rectangle([[-0.6, 0.5], [-0.4, 0.7]], z, round), to_world, under).unwrap();
        b.mesh(&rectangle([[-0.9, 0.8], [-0.5, 0.9]], z, round / 4), to_world, over).unwrap();
        let at = to_world.transform_point3(DVec3::new(r.within(-0.5, 0.4), r.within(-0.3, 0.6), z));
        let mut towards = DVec3::from(r.direction());
        towards.z += 0.3f64.copysign(towards.z);
        let eye = at + to_world.transform_vector3(towards) * r.within(1.0, 30.0);
        b.camera = Some(Camera::look_at(eye, at, 1e-5).unwrap());
        b.screen = [32, 8];
        let mut scene = b.build();
        with_any_isa(&mut scene, round);
        assert_eq!(scene.coinciding()[0].front, 0);
        let params = Params::new(Arc::new(scene));
        for reference in [false, true] {
            let params = Params { reference, max_depth: Some(1), ..params.clone() };
            let pixels = render(params, 4, 1).unwrap().mean().pixels;
            assert!(pixels.iter().all(|p| p[1] == 0.0), "{round} {reference}: {:?}", pixels[0]);
        }
    }
}

/// Many surfaces in one place do not keep the search for long, and it says when it gives up.
#[test]
fn a_crowd_is_given_up_and_told() {
    let mut b = SceneBuilder::new("crowd");
    let emitter = material(&mut b, "lamp", 0.0, 1.0);
    let mut r = Random::new(1);
    let mut mesh = Mesh::default();
    for i in 0..20_000u32 {
        mesh.positions.extend((0..3).map(|_| vector(&mut r, 1.0)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    b.mesh(&mesh, DAffine3::IDENTITY, emitter).unwrap();
    let scene = b.build();
    let said = told(&scene);
    assert!(said.len() == 1 && said[0].text.contains("not all were compared"), "{said:?}");
}

/// Thousands of pairs of materials, with names of any length, are told of in lines that can be read.
#[test]
fn of_many_pairs_a_few_are_told_in_short_lines() {
    for lit in [false, true] {
        let mut b = SceneBuilder::new("pile");
        for i in 0..60 {
            let name = format!("{i} {}", "\u{202e}".repeat(1 + i));
            let material = material(&mut b, &name, 0.5, f64::from(u8::from(lit && i % 2 == 0)));
            let sides = [[0.0, 1.0], [0.0, 1.0 + i as f64]];
            b.mesh(&rectangle(sides, 0.0, 0), DAffine3::IDENTITY, material).unwrap();
        }
        let scene = b.build();
        let all = scene.coinciding().len();
        assert_eq!(all, 60 * 59 / 2);
        let mut report = Report::default();
        scene.report(&mut report);
        let lines = report.warnings.iter().map(|w| w.text.as_str());
        let lines: Vec<&str> = lines.chain(report.notes.iter().map(String::as_str)).collect();
        for line in &lines {
            assert!(line.len() < 500 && !line.chars().any(char::is_control), "{line}");
        }
        // Even ones emit: all pairs but those of two odd ones.
        let (dark, listed) = if lit { (30 * 29 / 2, 100) } else { (all, 0) };
        assert_eq!(report.warnings.len(), if lit { listed + 1 } else { 0 }, "{lines:?}");
        let rest = format!("{} more pairs of materials share a place", all - dark - listed);
        assert!(!lit || report.warnings[listed].text == rest, "{lines:?}");
        let [note] = &report.notes[..] else { panic!("{lines:?}") };
        let named = note.matches(" before ").count();
        assert!(
            named > 1 && note.ends_with(&format!("and {} more pairs of materials", dark - named))
        );
    }
}
