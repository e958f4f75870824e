//! Rays and shapes: the tree against brute force, no leaks, no self-hits, at any scale and place.

use crate::support::Random;
use crate::support::ball;
use burnish::geometry::{Hit, Query, Ray, offset_origin};
use burnish::math::V3;
use burnish::math::simd::Isa;
use burnish::scene::{Material, MaterialId, Mesh, Scene, SceneBuilder};
use glam::{DAffine3, DVec3};

fn clay(b: &mut SceneBuilder) -> MaterialId {
    b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 10.0).unwrap())
}

fn v3(p: DVec3) -> V3 {
    V3::from(p.as_vec3().to_array())
}

fn scene_of(mesh: &Mesh, placement: DAffine3) -> Scene {
    let mut b = SceneBuilder::new("mesh");
    let m = clay(&mut b);
    b.mesh(mesh, placement, m).unwrap();
    b.build()
}

/// Rays from points within a closed scene, aimed at its vertices, its edges, along the axes and
/// `random` times anywhere, and how many found nothing. Each is asked for its nearest hit and for
/// any hit, which is all that the tracer asks.
fn leaks(scene: &Scene, origins: u32, random: u32, r: &mut Random) -> (u64, u64) {
    let g = scene.geometry();
    let mut stack = scene.stack();
    let (mut rays, mut leaks) = (0, 0);
    let mut shoot = |o: V3, d: V3| {
        let ray = Ray { o, d };
        let nearest = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack).is_some();
        let any = scene.bvh().occluded(g, &ray, f32::INFINITY, &mut stack);
        rays += 1;
        leaks += u64::from(!(nearest && any));
    };
    for k in 0..origins {
        let o = if k == 0 {
            V3::default()
        } else {
            v3(DVec3::from_array(r.direction()) * r.within(0.0, 0.45))
        };
        for p in g.vertices().iter().map(|v| V3::from(v.position)) {
            shoot(o, p - o);
        }
        for t in 0..g.faces().len() {
            let [a, b, c] = g.corners(t);
            let f = r.unit();
            shoot(o, a + (b - a) * f - o);
            shoot(o, (b + c) * 0.5 - o);
            shoot(o, (c + a) * 0.5 - o);
        }
        for _ in 0..random {
            shoot(o, v3(DVec3::from_array(r.direction())));
        }
        for axis in [V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0), V3::new(0.0, 0.0, 1.0)] {
            shoot(o, axis);
            shoot(o, -axis);
        }
    }
    (rays, leaks)
}

/// From inside a closed mesh every ray hits, whatever it is aimed at: 10 million about each place.
#[test]
fn closed_meshes_leak_nothing() {
    let mut r = Random::new(1);
    for place in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
        let mut rays = 0;
        for scale in [1.0, 1e-6, 1e6] {
            let placement = DAffine3::from_translation(place * scale)
                * DAffine3::from_scale(DVec3::splat(scale));
            let ball = scene_of(&ball(5), placement);
            // The box's faces share no vertices, only their places.
            let mut b = SceneBuilder::new("box");
            let m = clay(&mut b);
            let corner = (place - DVec3::new(0.9, 0.7, 0.6)) * scale;
            b.cuboid(corner, DVec3::new(1.8, 1.4, 1.2) * scale, m).unwrap();
            for (scene, origins, random) in [(ball, 65, 20_000), (b.build(), 4000, 10)] {
                let (more, leaks) = leaks(&scene, origins, random, &mut r);
                assert_eq!(leaks, 0, "at {place}, scale {scale}");
                rays += more;
            }
        }
        assert!(rays >= 10_000_000, "{rays} rays at {place}");
    }
}

/// The plainest possible closest hit, in f64.
fn brute_force(scene: &Scene, ray: &Ray) -> Option<(f64, u32)> {
    let g = scene.geometry();
    let d3 = |v: V3| DVec3::new(v.x as f64, v.y as f64, v.z as f64);
    let (o, d) = (d3(ray.o), d3(ray.d));
    let mut best: Option<(f64, u32)> = None;
    let mut offer = |t: f64, id: u32| {
        if t > 0.0 && best.is_none_or(|(b, _)| t < b) {
            best = Some((t, id));
        }
    };
    for i in 0..g.faces().len() {
        let [a, b, c] = g.corners(i).map(d3);
        let (e, f) = (b - a, c - a);
        let p = d.cross(f);
        let det = e.dot(p);
        let s = (o - a) / det;
        let u = s.dot(p);
        let q = s.cross(e);
        let v = d.dot(q);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
            offer(f.dot(q), i as u32);
        }
    }
    for (i, s) in g.spheres.iter().enumerate() {
        let f = o - d3(s.centre);
        let (a, b) = (d.dot(d), f.dot(d));
        let disc = b * b - a * (f.dot(f) - (s.radius as f64).powi(2));
        if disc >= 0.0 {
            offer((-b - disc.sqrt()) / a, (g.faces().len() + i) as u32);
            offer((-b + disc.sqrt()) / a, (g.faces().len() + i) as u32);
        }
    }
    for (i, c) in g.cylinders.iter().enumerate() {
        let id = (g.faces().len() + g.spheres.len() + i) as u32;
        let n = d3(c.axis()).normalize();
        let (h, r) = (c.height as f64, c.radius as f64);
        let f = o - d3(c.base);
        let (dz, fz) = (d.dot(n), f.dot(n));
        let (dp, fp) = (d - n * dz, f - n * fz);
        let (a, b) = (dp.dot(dp), fp.dot(dp));
        let disc = b * b - a * (fp.dot(fp) - r * r);
        if disc >= 0.0 {
            for t in [(-b - disc.sqrt()) / a, (-b + disc.sqrt()) / a] {
                if (0.0..=h).contains(&(fz + t * dz)) {
                    offer(t, id);
                }
            }
        }
        for z in [0.0, h] {
            let t = (z - fz) / dz;
            if (fp + dp * t).length() <= r {
                offer(t, id);
            }
        }
    }
    best
}

fn jumble(r: &mut Random) -> Scene {
    let mut b = SceneBuilder::new("jumble");
    let m = clay(&mut b);
    let point =
        |r: &mut Random| DVec3::new(r.within(-3.0, 3.0), r.within(-2.0, 5.0), r.within(-1.0, 1.0));
    let mut soup = Mesh::default();
    for _ in 0..150 {
        let p = point(r);
        for _ in 0..3 {
            soup.positions.push(p + DVec3::from_array(r.direction()) * r.within(0.01, 1.0));
        }
        let n = soup.positions.len() as u32;
        soup.triangles.push([n - 3, n - 2, n - 1]);
    }
    b.mesh(&soup, DAffine3::IDENTITY, m).unwrap();
    for _ in 0..25 {
        let (p, q) = (point(r), DVec3::from_array(r.direction()) * r.within(0.1, 1.0));
        b.sphere(p, r.within(0.01, 0.5), m).unwrap();
        b.cylinder(p, q, r.within(0.01, 0.3), m).unwrap();
        b.cuboid(p, q, m).unwrap();
    }
    b.build()
}

fn some_ray(r: &mut Random) -> Ray {
    let o = DVec3::from_array(r.direction()) * r.within(0.0, 3.0);
    let length = 10f64.powf(r.within(-3.0, 3.0));
    Ray { o: v3(o), d: v3(DVec3::from_array(r.direction()) * length) }
}

/// Many at a time and alone, in every instruction set; among them rays that hit nothing, end
/// early, or are none.
#[test]
fn rays_in_company_hit_what_they_hit_alone() {
    let mut r = Random::new(12);
    let (mut found, mut blocked) = (Vec::new(), Vec::new());
    for round in 0..4 {
        let mut scene = jumble(&mut r);
        // No more than a few, and more than are ever on their way together.
        for count in [0, 1, 7, 33, 3000] {
            let mut queries: Vec<Query> =
                (0..count).map(|_| Query { ray: some_ray(&mut r), t_max: f32::INFINITY }).collect();
            for (n, query) in queries.iter_mut().enumerate() {
                match (n + round) % 13 {
                    0 => query.ray.d = V3::default(),
                    1 => query.t_max = f32::NAN,
                    2 => query.t_max = -1.0,
                    3 => query.t_max = 0.0,
                    4 => query.ray.o.x = f32::NAN,
                    5 | 6 => query.t_max = r.unit() / query.ray.d.length(),
                    _ => {}
                }
            }
            for isa in Isa::available() {
                scene.set_isa(isa);
                let (g, bvh) = (scene.geometry(), scene.bvh());
                let mut stack = scene.stack();
                bvh.closest_each(g, &queries, &mut stack, &mut found);
                bvh.occluded_each(g, &queries, &mut stack, &mut blocked);
                assert_eq!((found.len(), blocked.len()), (count, count));
                for ((Query { ray, t_max }, found), blocked) in
                    queries.iter().zip(&found).zip(&blocked)
                {
                    assert_eq!(*found, bvh.closest(g, ray, *t_max, &mut stack), "{ray:?} {t_max}");
                    assert_eq!(*blocked, found.is_some(), "{ray:?} {t_max}");
                }
                let hits = found.iter().flatten().count();
                assert!(count < 3000 || (20..2900).contains(&hits), "{hits}");
            }
        }
    }
}

#[test]
fn the_tree_agrees_with_brute_force_in_every_instruction_set() {
    let mut r = Random::new(2);
    let mut compared = 0;
    for _ in 0..8 {
        let mut scene = jumble(&mut r);
        for _ in 0..12_000 {
            let ray = some_ray(&mut r);
            let truth = brute_force(&scene, &ray);
            let mut answers: Vec<Option<Hit>> = Vec::new();
            for isa in Isa::available() {
                scene.set_isa(isa);
                let (g, bvh) = (scene.geometry(), scene.bvh());
                let mut stack = scene.stack();
                answers.push(bvh.closest(g, &ray, f32::INFINITY, &mut stack));
                assert_eq!(bvh.occluded(g, &ray, f32::INFINITY, &mut stack), answers[0].is_some());
                if let Some(hit) = answers[0] {
                    assert!(bvh.occluded(g, &ray, hit.t, &mut stack), "at its own distance");
                }
            }
            assert!(answers.windows(2).all(|w| w[0] == w[1]), "{answers:?}");
            match (truth, answers[0]) {
                (Some((t, id)), Some(hit)) => {
                    // A nearly equal distance may belong to another primitive.
                    let close = (hit.t as f64 - t).abs() <= 1e-4 * t + 1e-5 / ray.d.length() as f64;
                    assert!(close || hit.primitive == id, "{t} {id} {hit:?} {ray:?}");
                    compared += 1;
                }
                (None, None) => {}
                // Grazing hits within rounding may differ.
                _ => compared -= 50,
            }
        }
    }
    assert!(compared > 6000, "{compared}");
}

#[test]
fn leaving_a_convex_shape_never_meets_it_again() {
    let mut r = Random::new(3);
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [0.0, 1e4, 1e6] {
            for shape in 0..8 {
                let mut b = SceneBuilder::new("convex");
                let m = clay(&mut b);
                let at = DVec3::new(0.3, -0.7, 0.2) * scale + DVec3::splat(shift * scale);
                match shape {
                    0 => b.sphere(at, 0.7 * scale, m).unwrap(),
                    1 => b.cylinder(at, DVec3::new(0.3, 0.5, 0.8) * scale, 0.2 * scale, m).unwrap(),
                    2 => b.cuboid(at, DVec3::new(1.0, 0.3, 2.0) * scale, m).unwrap(),
                    3 => {
                        let place = DAffine3::from_translation(at)
                            * DAffine3::from_scale(DVec3::splat(scale));
                        b.mesh(&ball(3), place, m).map(|_| ()).unwrap();
                    }
                    // Flat, through the very middle of the scene, across each axis.
                    4 => b.cuboid(at, DVec3::new(0.0, 1.0, 0.8) * scale, m).unwrap(),
                    5 => b.cuboid(at, DVec3::new(0.7, 0.0, 1.0) * scale, m).unwrap(),
                    6 => b.cuboid(at, DVec3::new(1.0, 0.9, 0.0) * scale, m).unwrap(),
                    // Slender: a hundred times as long as wide.
                    _ => b.cuboid(at, DVec3::new(0.01, 1.0, 0.3) * scale, m).unwrap(),
                }
                let scene = b.build();
                let g = scene.geometry();
                let mut stack = scene.stack();
                for _ in 0..28_000 {
                    let o = v3(DVec3::from_array(r.direction()) * 3.0);
                    let aim = v3(DVec3::from_array(r.direction()) * r.within(0.0, 0.9));
                    let ray = Ray { o, d: aim - o };
                    let Some(hit) = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack) else {
                        continue;
                    };
                    let s = g.surface(&ray, &hit);
                    let ng = if s.ng.dot(ray.d) > 0.0 { -s.ng } else { s.ng };
                    // Half of the directions graze.
                    let mut d = v3(DVec3::from_array(r.direction()));
                    let up = d.dot(ng);
                    let graze =
                        if r.bits().is_multiple_of(2) { 10f32.powf(-4.0 * r.unit()) } else { 1.0 };
                    d = d + ng * (up.abs() * graze - up);
                    // What rounding has turned inwards does not leave.
                    if ng.dot(d) <= 0.0 {
                        continue;
                    }
                    let away = Ray { o: offset_origin(s.p, s.error, ng, d), d };
                    let again = scene.bvh().closest(g, &away, f32::INFINITY, &mut stack);
                    assert!(
                        again.is_none(),
                        "shape {shape} scale {scale} shift {shift}: {again:?}"
                    );
                }
            }
        }
    }
}

/// Long thin triangles lose digits in their weights, not in where they are.
#[test]
fn leaving_a_slender_shape_never_meets_it_again() {
    let mut r = Random::new(5);
    for width in [1e-1, 1e-2, 1e-3, 1e-4] {
        let mut b = SceneBuilder::new("slender");
        let m = clay(&mut b);
        b.cuboid(DVec3::ZERO, DVec3::new(width, 1.0, 1.0), m).unwrap();
        let scene = b.build();
        let g = scene.geometry();
        let mut stack = scene.stack();
        for _ in 0..200_000 {
            // Onto one of the narrow faces.
            let mut across = || r.within(-0.5 * width, 0.5 * width);
            let (x, y) = (across(), across());
            let o = v3(DVec3::new(x, 3.0, r.within(-1.0, 1.0)));
            let ray = Ray { o, d: v3(DVec3::new(y, 0.0, r.within(-0.5, 0.5))) - o };
            let hit = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack).unwrap();
            let s = g.surface(&ray, &hit);
            let ng = if s.ng.dot(ray.d) > 0.0 { -s.ng } else { s.ng };
            let d = v3(DVec3::from_array(r.direction()));
            let d = if ng.dot(d) > 0.0 { d } else { -d };
            let away = Ray { o: offset_origin(s.p, s.error, ng, d), d };
            let again = scene.bvh().closest(g, &away, f32::INFINITY, &mut stack);
            assert!(again.is_none(), "width {width}: {again:?} {d:?}");
        }
    }
}

/// A point where the parts of a shape meet: an edge, a corner, a cylinder's seam.
fn seam(g: &burnish::geometry::Geometry, r: &mut Random) -> V3 {
    if let Some(cylinder) = g.cylinders.first() {
        let (sin, cos) = (r.unit() * std::f32::consts::TAU).sin_cos();
        return cylinder.cap_point(cos, sin, r.bits().is_multiple_of(2));
    }
    match g.faces().len() as u32 {
        0 => v3(DVec3::from_array(r.direction())),
        n => {
            let [a, b, _] = g.corners((r.bits() % n) as usize);
            a + (b - a) * [0.0, r.unit()][(r.bits() % 2) as usize]
        }
    }
}

/// Light that bounces about inside a closed shape meets a wall every time, half of the time aimed
/// at the corners and seams themselves.
#[test]
fn what_is_inside_a_convex_shape_stays_inside() {
    let mut r = Random::new(9);
    for shape in 0..5 {
        for (scale, shift) in [(1.0, 0.0), (1e-6, 1e4), (1e6, 1e6)] {
            let mut b = SceneBuilder::new("convex");
            let m = clay(&mut b);
            let at = DVec3::splat(shift * scale);
            let mesh = DAffine3::from_translation(at) * DAffine3::from_scale(DVec3::splat(scale));
            match shape {
                0 => b.sphere(at, 0.7 * scale, m).unwrap(),
                1 => b.cylinder(at, DVec3::Z * scale, 0.5 * scale, m).unwrap(),
                2 => b.cylinder(at, DVec3::new(0.3, 0.5, 0.8) * scale, 0.02 * scale, m).unwrap(),
                3 => b.cuboid(at, DVec3::new(1.0, 0.3, 2.0) * scale, m).unwrap(),
                _ => b.mesh(&ball(2), mesh, m).map(|_| ()).unwrap(),
            }
            let scene = b.build();
            let g = scene.geometry();
            let mut stack = scene.stack();
            for path in 0..2000 {
                let mut ray = Ray { o: V3::default(), d: v3(DVec3::from_array(r.direction())) };
                for bounce in 0..100 {
                    let hit = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack);
                    let hit = hit.unwrap_or_else(|| {
                        panic!("shape {shape} scale {scale} path {path}, {bounce}: {ray:?}")
                    });
                    let s = g.surface(&ray, &hit);
                    let ng = if s.ng.dot(ray.d) > 0.0 { -s.ng } else { s.ng };
                    let random = v3(DVec3::from_array(r.direction()));
                    let mut d = [random, seam(g, &mut r) - s.p][(r.bits() % 2) as usize];
                    if ng.dot(d) <= 0.0 {
                        d = [-d, ng][(ng.dot(d) == 0.0) as usize];
                    }
                    ray = Ray { o: offset_origin(s.p, s.error, ng, d), d };
                }
            }
        }
    }
}

#[test]
fn plates_a_ten_thousandth_apart_shadow_each_other() {
    let mut b = SceneBuilder::new("plates");
    let m = clay(&mut b);
    b.cuboid(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(2.0, 2.0, 0.0), m).unwrap();
    b.cuboid(DVec3::new(-1.0, -1.0, 1e-4), DVec3::new(2.0, 2.0, 0.0), m).unwrap();
    let scene = b.build();
    let g = scene.geometry();
    let mut stack = scene.stack();
    let mut r = Random::new(4);
    for _ in 0..100_000 {
        let d = V3::new(0.2 * (r.unit() - 0.5), 0.2 * (r.unit() - 0.5), 1.0);
        let from = V3::new(r.unit() - 0.5, r.unit() - 0.5, -0.9);
        let up = Ray { o: from, d };
        let hit = scene.bvh().closest(g, &up, f32::INFINITY, &mut stack).unwrap();
        let s = g.surface(&up, &hit);
        let through = Ray { o: offset_origin(s.p, s.error, s.ng, d), d };
        let second = scene.bvh().closest(g, &through, f32::INFINITY, &mut stack).unwrap();
        let gap = second.t * d.z;
        assert!((gap - 1e-4).abs() < 5e-6, "{gap}");
    }
}

#[test]
fn odd_geometry_builds_and_answers() {
    let nowhere = Ray { o: V3::default(), d: V3::new(f32::NAN, 0.0, 1.0) };
    // Nothing at all.
    let scene = SceneBuilder::new("empty").build();
    let mut stack = scene.stack();
    let ray = Ray { o: V3::new(0.0, 0.0, -5.0), d: V3::new(0.0, 0.0, 1.0) };
    assert!(scene.bvh().closest(scene.geometry(), &ray, 1e9, &mut stack).is_none());
    // A material that is not there.
    let mut b = SceneBuilder::new("no material");
    let told = b.sphere(DVec3::ZERO, 1.0, 0).unwrap_err().to_string();
    assert!(told.contains("no material 0"), "{told}");
    assert!(b.cylinder(DVec3::ZERO, DVec3::Z, 1.0, 7).is_err());
    assert!(b.cuboid(DVec3::ZERO, DVec3::ONE, u32::MAX).is_err());
    assert_eq!((b.shapes(), b.is_lit()), (0, false));
    // One triangle; broken ones are dropped and counted.
    let mut b = SceneBuilder::new("one");
    let m = clay(&mut b);
    let x = |x: f64| DVec3::new(x, 0.0, 0.0);
    let mesh = Mesh {
        positions: vec![x(0.0), x(1.0), DVec3::Y, x(2.0), x(f64::NAN), x(1e30), x(1.0)],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 4, 2], [0, 5, 2], [0, 1, 99], [1, 6, 2]],
        ..Mesh::default()
    };
    let c = b.mesh(&mesh, DAffine3::IDENTITY, m).unwrap();
    assert_eq!((c.kept, c.degenerate, c.out_of_range, c.bad_index), (1, 2, 2, 1));
    let scene = b.build();
    assert!(scene.bvh().closest(scene.geometry(), &nowhere, 1e9, &mut stack).is_none());
    // A hundred thousand copies of one triangle.
    let mut b = SceneBuilder::new("copies");
    let m = clay(&mut b);
    let triangles = vec![[0, 1, 2]; 100_000];
    let mesh = Mesh { positions: vec![x(0.0), x(1.0), DVec3::Y], triangles, ..Mesh::default() };
    b.mesh(&mesh, DAffine3::IDENTITY, m).unwrap();
    let scene = b.build();
    assert_eq!((scene.counts().triangles, scene.counts().duplicates), (1, 99_999));
    // NaN, infinite and null rays hit nothing.
    let g = scene.geometry();
    let mut stack = scene.stack();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for k in 0..3 {
            let mut v = [0.1, 0.2, 1.0];
            v[k] = bad;
            let rays = [
                Ray { o: V3::new(0.0, 0.0, -1.0), d: V3::from(v) },
                Ray { o: V3::from(v), d: V3::new(0.0, 0.0, 1.0) },
            ];
            for ray in rays {
                assert!(scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack).is_none());
                assert!(!scene.bvh().occluded(g, &ray, f32::INFINITY, &mut stack));
            }
        }
    }
    let still = Ray { o: V3::default(), d: V3::default() };
    assert!(scene.bvh().closest(g, &still, f32::INFINITY, &mut stack).is_none());
}

/// A plate cut into 2000 triangles a million times as long as wide: a ray at it hits one of them.
/// Where along the needle is known to a tenth of its length only: the products that tell it are
/// nearly equal.
#[test]
fn needles_are_hit_and_nothing_falls_between_them() {
    let (count, width) = (1000u32, 1e-6);
    for turn in
        [DAffine3::IDENTITY, DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7)]
    {
        let mut mesh = Mesh::default();
        for i in 0..=count {
            let y = width * (i as f64 - 0.5 * count as f64);
            mesh.positions.extend([DVec3::new(-0.5, y, 0.0), DVec3::new(0.5, y, 0.0)]);
            if i > 0 {
                let k = 2 * i;
                mesh.triangles.extend([[k - 2, k - 1, k], [k - 1, k + 1, k]]);
            }
        }
        let scene = scene_of(&mesh, turn);
        assert_eq!(scene.counts().triangles, 2000);
        let (g, placement) = (scene.geometry(), scene.placement());
        let mut stack = scene.stack();
        let local = |p: DVec3| v3(placement.to_local(turn.transform_point3(p)));
        let mut r = Random::new(6);
        for _ in 0..100_000 {
            let half = 0.5 * width * count as f64 - 3e-6;
            let aim = DVec3::new(r.within(-0.49, 0.49), r.within(-half, half), 0.0);
            let mut from = DVec3::from_array(r.direction());
            from.z = (0.2 + from.z.abs()).copysign(from.z);
            let (o, target) = (local(from), local(aim));
            let hit = scene.bvh().closest(g, &Ray { o, d: target - o }, f32::INFINITY, &mut stack);
            let hit = hit.unwrap_or_else(|| panic!("{aim} was missed from {from}"));
            assert!((hit.t - 1.0).abs() < 0.1, "{aim} from {from}: met at {}", hit.t);
        }
    }
}

/// Boxes of one centre tell a builder nothing: 100,000 triangles and 2000 spheres inside each other
/// still make a tree, and the ray finds the outermost one.
#[test]
fn a_hundred_thousand_shapes_of_one_centre_make_a_tree() {
    let mut mesh = Mesh::default();
    for i in 0..100_000 {
        let a = 0.1 + 0.9 * i as f64 / 100_000.0;
        let n = mesh.positions.len() as u32;
        mesh.positions.extend([[-a, -a], [a, -a], [0.0, a]].map(|[x, y]| DVec3::new(x, y, 0.0)));
        mesh.triangles.push([n, n + 1, n + 2]);
    }
    let mut b = SceneBuilder::new("nested");
    let m = clay(&mut b);
    b.mesh(&mesh, DAffine3::IDENTITY, m).unwrap();
    for i in 0..2000 {
        b.sphere(DVec3::ZERO, 0.3 + 1e-5 * i as f64, m).unwrap();
    }
    let scene = b.build();
    assert_eq!((scene.counts().triangles, scene.counts().duplicates), (100_000, 0));
    // Nested boxes pair up unevenly; listed by size they once made 14,285 levels.
    assert!(scene.bvh().depth() < 400, "{} levels", scene.bvh().depth());
    let g = scene.geometry();
    let mut stack = scene.stack();
    let mut hit = |x: f32, y: f32| {
        let ray = Ray { o: V3::new(x, y, 2.0), d: V3::new(0.0, 0.0, -1.0) };
        scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack)
    };
    // In the middle the largest sphere; beside it, of all the triangles in one plane that are large
    // enough, the first.
    assert_eq!(hit(0.0, 0.0).unwrap().primitive, 100_000 + 1999);
    for x in [0.4f32, 0.55, 0.9] {
        let first = hit(x, -0.95 * x).unwrap();
        let a = g.corners(first.primitive as usize)[1].x;
        let before = g.corners(first.primitive as usize - 1)[1].x;
        let reaches = |a: f32| x <= a * (0.5 + 0.475 * x / a) && 0.95 * x <= a;
        assert!(reaches(a * 1.001) && !reaches(before * 0.999), "{x}: {before} {a}");
    }
}

/// Along an axis two of the three slabs divide 0 by 0 when the ray runs in a side of their box. A
/// wall of squares at round coordinates, and rays exactly on its lines: all hit.
#[test]
fn rays_along_the_axes_and_in_the_sides_of_boxes_hit() {
    let cells = 16;
    for axis in 0..3 {
        let mut b = SceneBuilder::new("wall");
        let m = clay(&mut b);
        let place = |u: f64, v: f64, w: f64| {
            let mut p = DVec3::ZERO;
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (w, u, v);
            p
        };
        let at = |i: i32| (i - cells / 2) as f64 / 8.0;
        for i in 0..cells {
            for j in 0..cells {
                b.cuboid(place(at(i), at(j), 0.0), place(0.125, 0.125, 0.0), m).unwrap();
            }
        }
        let mut scene = b.build();
        for isa in Isa::available() {
            scene.set_isa(isa);
            let g = scene.geometry();
            let mut stack = scene.stack();
            for i in 0..=2 * cells {
                for j in 0..=2 * cells {
                    for (side, zero) in [(1.0, 0.0), (-1.0, 0.0), (1.0, -0.0), (-1.0, -0.0)] {
                        let o =
                            v3(place((i - cells) as f64 / 16.0, (j - cells) as f64 / 16.0, side));
                        let d = v3(place(zero, zero, -side));
                        let ray = Ray { o, d };
                        let hit = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack);
                        assert!(hit.is_some_and(|h| h.t == 1.0), "{i} {j}: {ray:?} {hit:?}");
                        assert!(scene.bvh().occluded(g, &ray, f32::INFINITY, &mut stack));
                        // In the plane of the wall there is nothing to hit, and nothing to wait for.
                        let along = Ray {
                            o: v3(place(-3.0, at(j / 2), 0.0)),
                            d: v3(place(1.0, zero, zero)),
                        };
                        if let Some(hit) = scene.bvh().closest(g, &along, f32::INFINITY, &mut stack)
                        {
                            assert!(hit.t.is_finite(), "{hit:?}");
                        }
                    }
                }
            }
        }
    }
}
