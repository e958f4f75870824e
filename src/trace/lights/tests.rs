//! Every sampler against its own density, every choice against its own probability.

use super::importance::LightSampleContext;
use super::sample::cones;
use super::spherical_rectangle::SphericalRectangle;
use super::*;
use crate::brdf::{Alpha, BrdfParams, Roughness};
use crate::geometry::{Ray, Sphere, SurfacePoint, offset_origin};
use crate::math::simd::U32;
use crate::math::{Frame, V3};
use crate::scene::{MaterialId, Mesh, SceneBuilder};
use glam::{DAffine3, DVec3};

/// Numbers in [0, 1), ends included, in an order without pattern.
fn numbers(count: u32) -> impl Iterator<Item = [f32; 3]> {
    let ends = [0.0, f32::EPSILON / 2.0, 0.5, ALMOST_ONE];
    let corners = (0..64).map(move |i| [ends[i % 4], ends[i / 4 % 4], ends[i / 16]]);
    let between = (1..count).map(|i| {
        [0.754_877_7, 0.569_840_3, 0.430_159_7].map(|a: f64| (a * f64::from(i)).fract() as f32)
    });
    corners.chain(between.map(move |u| u.map(|x| x.min(ALMOST_ONE))))
}

fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn narrow(v: DVec3) -> V3 {
    V3::from(v.as_vec3().to_array())
}

fn params(kd: f32, ks: f32, alpha: f64) -> BrdfParams {
    let roughness = Alpha::from(Roughness::from_alpha(alpha).unwrap());
    BrdfParams { kd: Rgb::splat(kd), ks: Rgb::splat(ks), roughness }
}

/// At the camera's vertex or a later one.
fn context(p: V3, n: V3, event: u32) -> LightSampleContext {
    let frame = Frame::around(n);
    let wo = frame.to_local((n + V3::new(0.4, 0.3, 0.2)).normalize());
    LightSampleContext::new(p, frame, event == 0, &params(0.3, 0.5, 0.1), wo)
}

fn lamp(b: &mut SceneBuilder, x: f64) -> MaterialId {
    b.material(Material::light("lamp", [x, 2.0 * x, 0.5 * x]).unwrap())
}

/// Every shape, some of them hard, and `more` small ones of every kind.
fn lamps(more: u32, sky: f32) -> Scene {
    let v = DVec3::new;
    let mut b = SceneBuilder::new("lamps");
    let (dim, bright, faint) = (lamp(&mut b, 0.5), lamp(&mut b, 3.0), lamp(&mut b, 1e-4));
    b.cuboid(v(-3.0, 1.0, 2.0), v(1.0, 0.5, 0.1), dim).unwrap();
    b.sphere(v(0.0, 2.0, 3.0), 0.6, bright).unwrap();
    b.sphere(v(-1.4, 2.0, 0.0), 1e-3, bright).unwrap();
    b.cylinder(v(0.0, -2.0, 2.0), v(0.3, 0.0, 0.8), 0.3, dim).unwrap();
    // Two triangles that make no parallelogram, and a rectangle that is in no plane of the axes.
    let kite = Mesh {
        positions: vec![v(1.0, 0.0, 2.0), v(2.8, 0.1, 2.0), v(2.0, 0.6, 2.1), v(2.9, 0.4, 2.0)],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        ..Mesh::default()
    };
    b.mesh(&kite, DAffine3::IDENTITY, faint).unwrap();
    let (corner, a, c) = (v(-1.0, -1.5, 1.0), v(0.6, 0.8, 0.0), v(-0.4, 0.3, 0.5));
    let tilted = Mesh {
        positions: vec![corner, corner + a, corner + c, corner + a + c],
        triangles: vec![[0, 1, 2], [3, 2, 1]],
        ..Mesh::default()
    };
    b.mesh(&tilted, DAffine3::IDENTITY, dim).unwrap();
    for i in 0..more {
        let f = |x: f64| (x * f64::from(i + 1)).fract();
        let p = v(6.0 * f(0.618_034) - 3.0, 6.0 * f(0.754_878) - 3.0, 4.0 * f(0.569_84));
        let light = [dim, bright, faint][(i % 3) as usize];
        match i % 4 {
            0 => b.sphere(p, 0.03, light).unwrap(),
            1 => b.cuboid(p, v(0.1, 0.2, 0.0), light).unwrap(),
            2 => b.cuboid(p, v(0.0, 0.07, 0.07), light).unwrap(),
            _ => b.cylinder(p, v(0.1, 0.0, 0.1), 0.02, light).unwrap(),
        }
    }
    b.environment = [sky; 3];
    b.build()
}

/// Places in the open, next to emitters, on an emitter, in one, and in an emitter's plane, with all kinds of
/// normals.
fn places(scene: &Scene) -> Vec<(V3, V3)> {
    let placement = scene.placement();
    let local = |x: f64, y: f64, z: f64| narrow(placement.to_local(DVec3::new(x, y, z)));
    let points = [
        local(0.3, -0.2, -1.0),
        local(0.1, 2.0, 2.3),
        local(0.0, 2.1, 3.0),
        local(-2.5, 1.2, 1.9999),
        local(-2.5, 1.2, 2.0),
        local(-2.4, 1.1, 1.7),
        local(4.0, 1.2, 2.1),
        local(-1.0, -0.7, 1.2),
        local(2.0, 0.2, 2.02),
        local(0.1, -2.0, 2.3),
    ];
    let normals = [[0.0, 0.0, 1.0], [0.0, 0.6, -0.8], [-0.48, 0.64, 0.6]].map(V3::from);
    points.into_iter().flat_map(|p| normals.map(|n| (p, n))).collect()
}

/// Of every light but the environment.
fn bounds(scene: &Scene) -> Vec<LightBounds> {
    let radiance = |m: u32| Rgb::from(scene.materials()[m as usize].emission).luminance();
    let brightest = scene.surfaces().iter().map(|s| radiance(s.material)).fold(0.0, f32::max);
    let of = |s: &crate::scene::Light| {
        let luminance = radiance(s.material) / brightest;
        let shapes = if luminance > 0.0 { record::of(scene.geometry(), s.shape) } else { vec![] };
        shapes.into_iter().map(|(shape, _)| shape.bound(luminance)).collect::<Vec<_>>()
    };
    scene.surfaces().iter().flat_map(of).collect()
}

/// However many lights there are, each is chosen as often as its probability says; no light that
/// could contribute is left out, and the probabilities sum to 1.
#[test]
fn lights_are_chosen_with_their_probabilities() {
    for (more, sky) in [(0, 0.0), (0, 0.2), (3, 0.2), (40, 0.0), (300, 0.3)] {
        let scene = lamps(more, sky);
        let lights = Lights::new(&scene, scene.materials(), false);
        let bounds = bounds(&scene);
        let beyond = usize::from(sky > 0.0);
        assert_eq!(lights.tree.is_some(), lights.count() > FEW);
        for (i, (p, n)) in places(&scene).into_iter().enumerate() {
            for event in [0, 3] {
                let to = context(p, n, event);
                let mut expected: Vec<f32> =
                    (0..bounds.len() as u32).map(|i| lights.probability(&to, U32(i))).collect();
                if beyond > 0 {
                    let density = warp::cosine_hemisphere_pdf(1.0);
                    expected.push(lights.environment_pdf(&to, 1.0) / density);
                }
                let sum: f64 = expected.iter().map(|&p| f64::from(p)).sum();
                // A node may promise what none of its lights can give.
                let most = 1.0 + 1e-4;
                assert!(sum < most && (sum > 2.0 - most || more > 16), "{more} {i} {event}: {sum}");
                for (light, (bound, probability)) in bounds.iter().zip(&expected).enumerate() {
                    let at_all = bound.estimate(&to) > 0.0;
                    assert_eq!(*probability > 0.0, at_all, "{more} {i} {event}: {light}");
                }
                let count = 20_000;
                let mut found = vec![0u32; expected.len()];
                for k in 0..count {
                    let number = (k as f32 + 0.5) / count as f32;
                    let chosen = lights.choose(&to, number);
                    if chosen.probability == 0.0 {
                        continue;
                    }
                    found[chosen.index.0 as usize] += 1;
                    let probability = expected[chosen.index.0 as usize];
                    assert!((chosen.probability / probability - 1.0).abs() < 1e-5);
                    assert!((0.0..1.0).contains(&chosen.rest));
                }
                for (light, (&found, &expected)) in found.iter().zip(&expected).enumerate() {
                    let off = (found as f32 - expected * count as f32).abs();
                    assert!(off < 1.0 + 2e-3 * found as f32, "{more} {i} {event}: {light} {off}");
                }
            }
        }
    }
}

/// What is left of the number that chose a light is uniform, whichever light it chose.
#[test]
fn the_rest_of_a_choice_is_uniform() {
    for more in [2, 60] {
        let scene = lamps(more, 0.3);
        let lights = Lights::new(&scene, scene.materials(), false);
        let (p, n) = places(&scene)[0];
        let to = context(p, n, 1);
        let mut rests = vec![Vec::new(); lights.count()];
        for k in 0..200_000 {
            let chosen = lights.choose(&to, (k as f32 + 0.5) / 200_000.0);
            rests[chosen.index.0 as usize].push(chosen.rest);
        }
        for rests in rests.iter().filter(|rests| rests.len() > 400) {
            let mean = rests.iter().sum::<f32>() / rests.len() as f32;
            assert!((mean - 0.5).abs() < 0.02, "{more}: {mean} of {}", rests.len());
        }
    }
}

/// The reflected light that a light really gives where nothing is in between, by its own density.
fn truth(
    lights: &Lights,
    g: &Geometry,
    to: &LightSampleContext,
    light: usize,
    brdf: &BrdfParams,
    wo: V3,
) -> f64 {
    let record = lights.records.record(light);
    let count = 512;
    let sum: f64 = numbers(count)
        .map(|[again, u, v]| {
            let sample = sample::sample::<f32>(g, &record, to, again, [u, v]);
            let wi = to.frame.to_local(sample.wi);
            if !sample.found || !sample.shadow_ray(to.p).hits || wi.z <= 0.0 || sample.pdf <= 0.0 {
                return 0.0;
            }
            let f = brdf.eval::<crate::brdf::Ggx>(wo, wi).f;
            f64::from((sample.radiance * f).luminance() * wi.z / sample.pdf)
        })
        .sum();
    sum / f64::from(count + 63)
}

/// Where a light gives any, it is asked: and those that give most are asked most. By the choice
/// the light of one sampled light has a far smaller variance than by power.
#[test]
fn estimates_follow_what_lights_give() {
    for more in [4, 200] {
        let scene = lamps(more, 0.0);
        let lights = Lights::new(&scene, scene.materials(), false);
        let bounds = bounds(&scene);
        let powers: Vec<f64> =
            bounds.iter().map(|b| f64::from(b.luminance) * f64::from(b.area)).collect();
        let power: f64 = powers.iter().sum();
        for (event, at_least) in [(0, 2.0), (1, 1.5)] {
            let (mut ours, mut by_power) = (0.0, 0.0);
            for (i, (p, n)) in places(&scene).into_iter().enumerate() {
                let brdf = params(0.3, if event == 0 { 0.5 } else { 0.0 }, 0.1);
                let frame = Frame::around(n);
                let wo = frame.to_local((n + V3::new(0.4, 0.3, 0.2)).normalize());
                let to = LightSampleContext::new(p, frame, event == 0, &brdf, wo);
                let (mut mean, mut a, mut b) = (0.0, 0.0, 0.0);
                for (light, own) in powers.iter().enumerate() {
                    let gives = truth(&lights, scene.geometry(), &to, light, &brdf, wo);
                    let probability = f64::from(lights.probability(&to, U32(light as u32)));
                    assert!(gives >= 0.0 && gives.is_finite());
                    if gives > 0.0 {
                        assert!(probability > 0.0, "{more} {i} {event}: {light} gives {gives}");
                        a += gives * gives / probability;
                        b += gives * gives / (own / power);
                    }
                    mean += gives;
                }
                if mean > 0.0 {
                    ours += a / (mean * mean) - 1.0;
                    by_power += b / (mean * mean) - 1.0;
                }
            }
            assert!(ours * at_least < by_power, "{more} {event}: {ours} {by_power}");
        }
    }
}

/// A point of a light is asked for with the density with which it is known when hit, whatever the
/// shape and wherever from; that is what makes the weights of the two ways sum to 1.
#[test]
fn asked_and_met_have_one_density() {
    for (more, sky) in [(0, 0.1), (2, 0.0), (50, 0.1)] {
        let scene = lamps(more, sky);
        let (geometry, bvh) = (scene.geometry(), scene.bvh());
        let lights = Lights::new(&scene, scene.materials(), false);
        let mut stack = scene.stack();
        let (mut met, mut beyond, mut kinds) = (0, 0, [0; 3]);
        for (p, n) in places(&scene) {
            for event in [0, 1] {
                let to = context(p, n, event);
                let from = SurfacePoint { p, ng: n, ns: n, error: V3::splat(1e-7) };
                for [choice, u, v] in numbers(700) {
                    let sample = lights.sample::<f32>(bvh, geometry, &to, choice, [u, v]);
                    if !sample.found {
                        continue;
                    }
                    assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
                    assert!((sample.wi.length() - 1.0).abs() < 1e-5);
                    let o = offset_origin(from.p, from.error, from.ng, sample.wi);
                    let shadow = sample.shadow_ray(o);
                    let ray = Ray { o, d: sample.wi };
                    let hit = bvh.closest(geometry, &ray, f32::INFINITY, &mut stack);
                    let Some(hit) = hit.filter(|_| shadow.hits) else {
                        if shadow.t_max == f32::INFINITY {
                            let density = lights.environment_pdf(&to, sample.wi.dot(n));
                            let off = (density / sample.pdf - 1.0).abs();
                            assert!(off < 1e-4 || sample.wi.dot(n) < 0.02, "{off}");
                            beyond += 1;
                        }
                        continue;
                    };
                    let surface = geometry.surface(&ray, &hit);
                    let cos = surface.ng.dot(sample.wi).abs();
                    let distance = (surface.p - p).length();
                    // Another light may stand before the one that was asked; a grazing angle and a
                    // small distance magnify the last digit of the point.
                    let end = o + shadow.d * shadow.t_max.min(1e3);
                    let light = lights.choose::<f32>(&to, choice).index.0;
                    if lights.light_of(hit.primitive) != Some(light) {
                        continue;
                    }
                    // On a cylinder's rim another face may be hit.
                    let rim = v < 1e-6 && matches!(geometry.kind(hit.primitive), Kind::Cylinder(_));
                    let clear = cos > 0.02 && distance > 1e-2 && !rim;
                    if !clear || (end - surface.p).length() > 5e-6 {
                        continue;
                    }
                    let density = lights.pdf(&to, &[hit.primitive], hit.t, cos);
                    let ratio = density / sample.pdf;
                    assert!((ratio - 1.0).abs() < 3e-3, "{more} {event} {p:?}: {ratio} {hit:?}");
                    kinds[match geometry.kind(hit.primitive) {
                        Kind::Triangle(_) => 0,
                        Kind::Sphere(_) => 1,
                        Kind::Cylinder(_) => 2,
                    }] += 1;
                    met += 1;
                }
            }
        }
        assert!(met > 10_000 && kinds.iter().all(|&n| n > 500), "{met} {kinds:?}");
        assert!(sky == 0.0 || beyond > 1000, "{beyond}");
    }
}

/// What flat lights of any size send to points close before them, their places and turns drawn at random,
/// is what the sum over their edges says in double precision (Lambert 1760): also where the distance
/// is not many rounding errors of the light's points.
#[test]
fn flat_lights_close_by_send_their_form_factor() {
    let v = DVec3::new;
    let mut drawn = numbers(4000).skip(64).flatten().map(f64::from);
    let mut next = || drawn.next().unwrap();
    let (mut worst, mut of_kinds) = (0.0f64, [0; 2]);
    for round in 0..40 {
        let triangle = round % 2 == 1;
        // A rectangle is sampled by its solid angle, however near; a triangle by its area.
        let size = if triangle { 10f64.powf(-3.0 * next()) } else { 1.0 };
        let height = if triangle { size * (0.5 + next()) } else { 10f64.powf(-1.0 - 3.0 * next()) };
        let angles = [next(), next(), next()].map(|x| 7.0 * x);
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]);
        let (a, c) = (turn * v(size, 0.0, 0.0), turn * v(0.0, size * (0.3 + next()), 0.0));
        let corner = v(next(), next(), next()) - 0.5 * (a + c);
        let mut b = SceneBuilder::new("close by");
        let (light, dark) = (
            lamp(&mut b, 1.0),
            b.material(Material::reflecting("dark", [0.0; 3], [0.0; 3], 1.0).unwrap()),
        );
        b.cuboid(v(-2.0, -2.0, -2.0), DVec3::splat(0.1), dark).unwrap();
        b.cuboid(v(2.0, 2.0, 2.0), DVec3::splat(0.1), dark).unwrap();
        let positions = vec![corner, corner + a, corner + c, corner + a + c];
        let faces = if triangle { vec![[0, 1, 2]] } else { vec![[0, 1, 2], [3, 2, 1]] };
        b.mesh(&Mesh { positions, triangles: faces, ..Mesh::default() }, DAffine3::IDENTITY, light)
            .unwrap();
        let scene = b.build();
        let lights = Lights::new(&scene, scene.materials(), false);
        assert_eq!(lights.count(), 1);
        // The corners as they are after rounding.
        let local = |p: DVec3| wide(narrow(scene.placement().to_local(p)));
        let mut corners = vec![local(corner), local(corner + a), local(corner + c)];
        if !triangle {
            corners.insert(2, local(corner + a + c));
        }
        let normal = turn * DVec3::Z;
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let p = narrow(middle - normal * height * scene.placement().scale());
        let to = context(p, narrow(normal), 1);
        let n = wide(to.frame.n).normalize();
        let rim: Vec<DVec3> = corners.iter().map(|&q| (q - wide(p)).normalize()).collect();
        let edge = |i: usize| {
            let (q, r) = (rim[i], rim[(i + 1) % rim.len()]);
            q.angle_between(r) * q.cross(r).normalize().dot(n)
        };
        let truth = ((0..rim.len()).map(edge).sum::<f64>() / 2.0).abs();
        let (mut sum, count) = (0.0, 40_000);
        for u in numbers(count).skip(64) {
            let geometry = (scene.bvh(), scene.geometry());
            let sample = lights.sample::<f32>(geometry.0, geometry.1, &to, u[2], [u[0], u[1]]);
            if sample.found {
                sum += f64::from(sample.wi.dot(to.frame.n).max(0.0) / sample.pdf);
            }
        }
        let off = sum / f64::from(count - 1) / truth - 1.0;
        worst = worst.max(off.abs());
        of_kinds[usize::from(triangle)] += 1;
        assert!(off.abs() < 1e-3, "{round}: size {size}, height {height}: {off:e}");
    }
    assert!(worst > 0.0 && of_kinds == [20, 20]);
}

/// Rectangles near, far, almost edge on, from before a corner, an edge and the middle: the solid
/// angle is that of two triangles in double precision, all directions are within it, and equal
/// parts of it get equal numbers of them.
#[test]
fn rectangles_are_filled_evenly_by_solid_angle() {
    // Of a triangle (van Oosterom and Strackee 1983).
    let triangle = |p: [DVec3; 3]| {
        let [a, b, c] = p.map(DVec3::normalize);
        2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    for (w, h) in [(1.0, 1.0), (1.5, 0.3), (0.05, 0.9)] {
        for (x, y) in [(0.5, 0.5), (0.1, 0.4), (0.0, 0.0), (-0.4, 0.5), (1.3, 1.2), (0.7, -0.2)] {
            for z in [0.01, 0.1, -0.5, 1.0] {
                let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, x, z);
                let (a, b, n) = (turn * DVec3::X * w, turn * DVec3::Y * h, turn * DVec3::Z);
                let corner = turn * DVec3::new(-x * w, -y * h, z);
                let name = format!("{w} {h} from {x} {y} {z}");
                let p = V3::new(0.3, -0.2, 0.1);
                let at = |u: f64, v: f64| corner + a * u + b * v;
                let patch = |u: [f64; 2], v: [f64; 2]| {
                    let [q, r, s, t] =
                        [at(u[0], v[0]), at(u[1], v[0]), at(u[1], v[1]), at(u[0], v[1])];
                    triangle([q, r, s]) + triangle([q, s, t])
                };
                let whole = patch([0.0, 1.0], [0.0, 1.0]);
                if whole < 0.02 {
                    continue;
                }
                let glossy = SphericalRectangle::new(
                    p + narrow(corner),
                    [narrow(a), narrow(b)],
                    narrow(n),
                    p,
                );
                let off = (f64::from(glossy.solid_angle) / whole - 1.0).abs();
                assert!(off < 3e-5, "{name}: {} of {whole}", glossy.solid_angle);
                let towards = narrow(n * z.signum());
                const CELLS: usize = 6;
                let mut found = [[0.0; CELLS]; CELLS];
                let count = 256;
                for i in 0..count * count {
                    let u = [i % count, i / count].map(|i| (i as f32 + 0.5) / count as f32);
                    let d = wide(glossy.sample(u, towards)) - corner;
                    let (s, t) = (d.dot(a) / (w * w), d.dot(b) / (h * h));
                    assert!(d.dot(n).abs() < 1e-5, "{name}: {}", d.dot(n));
                    let inside = -1e-5..=1.0 + 1e-5;
                    assert!(inside.contains(&s) && inside.contains(&t), "{name}: {s} {t}");
                    let cell = |s: f64| ((s * CELLS as f64) as usize).min(CELLS - 1);
                    found[cell(s)][cell(t)] += 1.0 / f64::from(count * count);
                }
                for (i, column) in found.iter().enumerate() {
                    for (j, found) in column.iter().enumerate() {
                        let part = |i: usize| [i, i + 1].map(|i| i as f64 / CELLS as f64);
                        let expected = patch(part(i), part(j)) / whole;
                        // Stratified numbers leave an error only along the cells' edges.
                        assert!((found - expected).abs() < 4e-3, "{name}: {found} {expected}");
                    }
                }
            }
        }
    }
}

/// From a spark to a ball whose surface is a hundredth of a millionth of its radius away.
#[test]
fn the_cone_of_a_sphere_is_known_at_every_size() {
    let ratios = [1e-6, 1e-4, 1e-3, 0.03, 0.5, 0.9, 0.99, 1.0 - 1e-3, 1.0 - 1e-5, 1.0 - 1e-7];
    for ratio in ratios {
        for towards in [DVec3::X, DVec3::new(0.3, -0.8, 0.5).normalize()] {
            let centre = narrow(towards * 0.7);
            let sphere = Sphere { centre, radius: (0.7 * ratio) as f32 };
            let (p, radius) = (V3::default(), f64::from(sphere.radius));
            // 1 - cos as 2 sin²(half the angle), for distances as far off as their rounding.
            let exact = |off: f64| {
                let sin = (radius / (wide(centre).length() * (1.0 + off))).min(1.0);
                2.0 * (sin.asin() / 2.0).sin().powi(2)
            };
            let (axis, found, outside) = cones(centre, sphere.radius, p);
            if !outside {
                assert!(ratio > 1.0 - 1e-6, "{ratio}: taken for inside");
                continue;
            }
            let (low, high) = (exact(1.5e-7) * (1.0 - 1e-6), exact(-1.5e-7) * (1.0 + 1e-6));
            let found = f64::from(found);
            assert!((low..=high).contains(&found), "{ratio}: {low} {found} {high}");
            let record = LightShape::Sphere(sphere).record(0, Rgb::splat(1.0), NO_SURFACE, 0.0);
            let to = context(p, V3::new(0.0, 0.0, 1.0), 1);
            let g = Geometry::default();
            for [u, v, _] in numbers(4000) {
                let sample = sample::sample::<f32>(&g, &record, &to, 0.5, [u, v]);
                let known = sample::pdf(&record, p, 1.0, 1.0);
                assert!((sample.pdf / known - 1.0).abs() < 1e-6, "{ratio}");
                assert!((sample.wi.length() - 1.0).abs() < 1e-6, "{ratio}: {:?}", sample.wi);
                let off = f64::from(0.5 * (sample.wi - axis).length2());
                assert!(off < found * (1.0 + 1e-4) + 1e-13, "{ratio}: {off} {found}");
                // The shadow ray ends on the near side of the sphere.
                let shadow = sample.shadow_ray(p);
                let t = f64::from(shadow.t_max);
                assert!(shadow.hits && (0.0..0.7 * (1.0 + 1e-6)).contains(&t), "{ratio}: {t}");
            }
        }
    }
}

/// From inside and from the surface itself all directions are asked alike.
#[test]
fn inside_a_sphere_the_cone_is_everything() {
    let sphere = Sphere { centre: V3::new(0.25, 0.5, -0.5), radius: 0.25 };
    let record = LightShape::Sphere(sphere).record(0, Rgb::splat(1.0), NO_SURFACE, 0.0);
    for x in [0.25, 0.3, 0.375, 0.5] {
        let p = V3::new(x, 0.5, -0.5);
        assert!((sample::pdf(&record, p, 1.0, 1.0) * 4.0 * PI - 1.0).abs() < 1e-6);
        let (to, g) = (context(p, V3::new(0.0, 0.0, 1.0), 1), Geometry::default());
        let mut upwards = 0;
        for [u, v, _] in numbers(4000) {
            let sample = sample::sample::<f32>(&g, &record, &to, 0.5, [u, v]);
            assert!((sample.pdf * 4.0 * PI - 1.0).abs() < 1e-6);
            upwards += i32::from(sample.wi.y > 0.0);
            let shadow = sample.shadow_ray(p);
            if shadow.hits {
                assert!(shadow.t_max > 0.0 && shadow.t_max <= 0.5, "at {x}: {}", shadow.t_max);
            } else {
                // From the surface, outwards.
                assert!(x == 0.5 && sample.wi.x >= -1e-6, "at {x}: missed {:?}", sample.wi);
            }
        }
        assert!((1900..2200).contains(&upwards), "{upwards}");
    }
}

/// A box is six lights, a kite two, and a grid of rectangles one light a rectangle.
#[test]
fn two_triangles_that_make_a_parallelogram_are_one_light() {
    let scene = lamps(0, 0.0);
    let lights = Lights::new(&scene, scene.materials(), false);
    assert_eq!(lights.count(), 6 + 1 + 1 + 1 + 2 + 1);
    let mut b = SceneBuilder::new("grid");
    let light = lamp(&mut b, 1.0);
    let mut mesh = Mesh::default();
    for i in 0..30u32 {
        let (x, y) = (f64::from(i % 6), f64::from(i / 6));
        mesh.positions.push(DVec3::new(x, y + 0.3 * x, 0.1 * x));
        if x < 5.0 && y < 4.0 {
            mesh.triangles.extend([[i, i + 1, i + 7], [i, i + 7, i + 6]]);
        }
    }
    b.mesh(&mesh, DAffine3::IDENTITY, light).unwrap();
    let scene = b.build();
    let lights = Lights::new(&scene, scene.materials(), false);
    assert_eq!((lights.count(), lights.light_of.len()), (20, 40));
    let area: f32 = bounds(&scene).iter().map(|b| b.area).sum();
    let whole: f32 = (0..40).map(|i| area_of(scene.geometry(), i)).sum();
    assert!((area / whole - 1.0).abs() < 1e-5);
}
