//! Shading normals that the viewer would see from behind: no black rims, no light made, the same
//! mean in both tracers and for all who share.

use crate::support::{Mean, Random, split};
use burnish::brdf::Model;
use burnish::progressive::{Params, render};
use burnish::scene::{Camera, Material, Mesh, Scene, SceneBuilder, Smooth};
use burnish::trace::ReuseGroup;
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

/// An icosahedron whose faces are split into four `levels` times, blown up to a ball.
fn icosphere(levels: u32) -> Mesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = Vec::new();
    for [a, b] in [[1.0, golden], [-1.0, golden], [1.0, -golden], [-1.0, -golden]] {
        positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(DVec3::from_array));
    }
    // Five neighbours at distance 2.
    let near = |i: usize, j: usize| (positions[i].distance(positions[j]) - 2.0).abs() < 1e-9;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    positions.iter_mut().for_each(|p| *p = p.normalize());
    split(&mut positions, &mut triangles, levels);
    let normals = positions.clone();
    Mesh { positions, normals, triangles, ..Mesh::default() }
}

/// A ball turned by chance, or an exact sphere, alone in white light or the only light.
fn alone(mesh: Option<&Mesh>, material: Material, sky: bool, turn: DQuat) -> Arc<Scene> {
    let mut b = SceneBuilder::new("ball");
    let material = b.material(material);
    match mesh {
        Some(mesh) => b.mesh(mesh, DAffine3::from_quat(turn), material).map(|_| ()).unwrap(),
        None => b.sphere(DVec3::ZERO, 1.0, material).unwrap(),
    }
    b.environment = [if sky { 1.0 } else { 0.0 }; 3];
    b.camera = Some(Camera::look_at(DVec3::new(0.0, -9.0, 0.0), DVec3::ZERO, 0.13).unwrap());
    Arc::new(b.build())
}

/// Red of all pixels.
fn picture(params: Params, passes: u64) -> Vec<f64> {
    let shown = render(params, passes, 0).unwrap();
    assert_eq!(shown.counts.nonfinite, 0);
    shown.mean().pixels.iter().map(|p| f64::from(p[0])).collect()
}

fn turn(random: &mut Random) -> DQuat {
    let axis = DVec3::from_array(random.direction());
    DQuat::from_axis_angle(axis, random.within(0.0, 6.0))
}

fn materials() -> [Material; 3] {
    [
        Material::reflecting("diffuse", [0.83; 3], [0.0; 3], 1.0).unwrap(),
        Material::reflecting("mirror", [0.0; 3], [0.9; 3], 9e5).unwrap(),
        Material::reflecting("both", [0.4; 3], [0.37; 3], 57.0).unwrap(),
    ]
}

fn glow() -> Material {
    Material::light("glow", [1.0; 3]).unwrap()
}

/// What is wholly inside the outline reflects most of what an exact ball would.
#[test]
fn coarse_smooth_balls_have_no_black_rims() {
    let mut random = Random::new(31);
    let size = [96, 96];
    for levels in 0..4 {
        let mesh = icosphere(levels);
        for (i, material) in materials().into_iter().enumerate() {
            let turn = turn(&mut random);
            let model = Model::ALL[(i + levels as usize) % 3];
            let params =
                Params { size, model, ..Params::new(alone(Some(&mesh), glow(), false, turn)) };
            let inside: Vec<bool> =
                picture(params, 16).into_iter().map(|covered| covered == 1.0).collect();
            for reference in [false, true] {
                let scene = alone(Some(&mesh), material.clone(), true, turn);
                let params = Params { size, model, reference, ..Params::new(scene) };
                let found = picture(params, 64);
                let mut seen: Vec<f64> =
                    found.into_iter().zip(&inside).filter(|(_, i)| **i).map(|(x, _)| x).collect();
                seen.sort_by(f64::total_cmp);
                assert!(seen.len() > 1500, "{}", seen.len());
                let (darkest, middle) = (seen[0], seen[seen.len() / 2]);
                let case = format!("{levels} {} {model:?} {reference}", material.name);
                println!("{case}: {darkest} {middle}");
                assert!(darkest > 0.5 * middle, "{case}: {darkest} of {middle}");
            }
        }
    }
}

/// What balls of 20 to 20,480 triangles reflect of white light, by the area that one sees of them,
/// goes to what the exact ball does, and light is never made.
#[test]
fn energy_of_finer_balls_goes_to_that_of_the_exact_one() {
    let size = [64, 64];
    let mut random = Random::new(32);
    for (i, material) in materials().into_iter().enumerate() {
        let model = Model::ALL[i];
        let mut reflectance = |mesh: Option<&Mesh>, seeds: u64| {
            let mut found = Mean::default();
            for seed in 0..seeds {
                let turn = turn(&mut random);
                let of = |material: &Material, sky| {
                    let scene = alone(mesh, material.clone(), sky, turn);
                    let sum: f64 = picture(Params { size, model, seed, ..Params::new(scene) }, 16)
                        .iter()
                        .sum();
                    sum / f64::from(size[0] * size[1])
                };
                // The same rays: what is not the ball is sky.
                let covered = of(&glow(), false);
                found.add((of(&material, true) - (1.0 - covered)) / covered);
            }
            found
        };
        let exact = reflectance(None, 24);
        let mut off = Vec::new();
        for levels in 0..6 {
            // What an icosahedron reflects depends on its turn; finer balls are alike from all sides.
            let found = reflectance(Some(&icosphere(levels)), if levels == 0 { 24 } else { 8 });
            let error = found.standard_error().hypot(exact.standard_error());
            println!("{} {levels}: {} of {} +- {error}", material.name, found.mean, exact.mean);
            // A mirror at a bent normal is seen less edge on than the ball's, and reflects less there.
            assert!(found.mean < exact.mean + 4.5 * error + 2e-3, "{} {levels}", material.name);
            off.push((found.mean / exact.mean - 1.0).abs());
            assert!(error < 1e-3, "{error}");
        }
        assert!(off[0] < 0.2 && off[2] < 0.05 && off[5] < 3e-3, "{}: {off:?}", material.name);
    }
}

/// A room of coarse smooth bodies, many seen from the side by each other: what their normals are
/// bent for differs from viewer to viewer.
fn coarse_room(seed: u64, kind: usize) -> Arc<Scene> {
    let mut random = Random::new(seed);
    let mut b = SceneBuilder::new("coarse room");
    let wall = b.material(Material::reflecting("wall", [0.6, 0.7, 0.5], [0.0; 3], 1.0).unwrap());
    let (kd, ks) = [([0.8; 3], [0.0; 3]), ([0.0; 3], [0.9, 0.8, 0.7]), ([0.3; 3], [0.4; 3])][kind];
    let exponent = [1.0, 70.0, 2500.0][kind];
    let body = b.material(Material::reflecting("body", kd, ks, exponent).unwrap());
    let emitter = b.material(Material::light("lamp", [9.0, 8.0, 7.0]).unwrap());
    b.cuboid(DVec3::splat(-2.0), DVec3::new(4.0, 4.0, 3.1), wall).unwrap();
    for i in 0..9 {
        let mut mesh = icosphere(i % 2);
        mesh.normals.clear();
        mesh.smoothing = vec![Smooth::Group(1); mesh.triangles.len()];
        let at = DVec3::new(
            -1.2 + 1.1 * f64::from(i % 3) + random.within(-0.2, 0.2),
            0.1 + 0.6 * f64::from(i / 3),
            -1.4 + random.within(0.0, 0.9),
        );
        let size = random.within(0.35, 0.55);
        let place =
            DAffine3::from_scale_rotation_translation(DVec3::splat(size), turn(&mut random), at);
        b.mesh(&mesh, place, body).unwrap();
    }
    b.cuboid(DVec3::new(-1.9, -0.3, 1.0), DVec3::new(1.1, 0.9, 0.0), emitter).unwrap();
    b.sphere(DVec3::new(1.3, -0.7, 0.2), 0.21, emitter).unwrap();
    b.environment = [0.2, 0.3, 0.4];
    let eye = DVec3::new(0.1, -1.9, 0.2);
    b.camera = Some(Camera::look_at(eye, DVec3::new(0.0, 0.5, -0.9), 0.7).unwrap());
    Arc::new(b.build())
}

/// Means over the nine regions of a picture: reference, engine, and engine with shared paths agree to
/// within 4.5 standard errors (162 comparisons in the three tests below) and 2 %. `share` is the part of the renders
/// that are made: what is less noisy is told apart to within 0.8 % by fewer.
fn one_mean_for_all_who_look(kind: usize, model: Model, share: f64) {
    let (size, regions) = ([30u32, 24], 9);
    let scene = coarse_room(40 + kind as u64, kind);
    let of = |reference: bool, group: ReuseGroup, seeds: f64| {
        let mut means: Vec<Mean> = (0..regions).map(|_| Mean::default()).collect();
        for seed in 0..(seeds * share) as u64 {
            let group = Some(group);
            let params =
                Params { size, model, seed, reference, group, ..Params::new(scene.clone()) };
            // One thread: other tests keep the other cores busy.
            let shown = render(params, 16, 1).unwrap();
            assert_eq!(shown.counts.nonfinite, 0);
            let mut sums = vec![0.0; regions];
            for (k, pixel) in shown.mean().pixels.iter().enumerate() {
                let (x, y) = (k as u32 % size[0], k as u32 / size[0]);
                let region = (x * 3 / size[0] + 3 * (y * 3 / size[1])) as usize;
                sums[region] += f64::from(pixel.iter().sum::<f32>());
            }
            means.iter_mut().zip(sums).for_each(|(mean, sum)| mean.add(sum));
        }
        means
    };
    let reference = of(true, ReuseGroup::None, 160.0);
    for (name, found) in [
        ("alone", of(false, ReuseGroup::None, 100.0)),
        ("sixteen", of(false, ReuseGroup::Sixteen, 80.0)),
        ("many", of(false, ReuseGroup::OneTwentyEight, 80.0)),
    ] {
        for (region, (a, b)) in reference.iter().zip(&found).enumerate() {
            let error = a.standard_error().hypot(b.standard_error());
            let off = b.mean / a.mean - 1.0;
            let sigmas = (b.mean - a.mean) / error;
            let case = format!("{kind} {name} {region}: {} {off:+.4} {sigmas:.1}", a.mean);
            println!("{case} {:.4}", error / a.mean);
            assert!(sigmas.abs() < 4.5 && off.abs() < 0.02, "{case}");
            assert!(error < 8e-3 * a.mean, "{case}: too noisy to tell");
        }
    }
}

#[test]
fn bent_normals_of_dull_bodies_have_one_mean_for_all_who_look() {
    one_mean_for_all_who_look(0, Model::Ggx, 0.5);
}

#[test]
fn bent_normals_of_glossy_bodies_have_one_mean_for_all_who_look() {
    one_mean_for_all_who_look(1, Model::Ggx, 0.5);
}

#[test]
fn bent_normals_of_sharp_and_dull_bodies_have_one_mean_for_all_who_look() {
    one_mean_for_all_who_look(2, Model::Beckmann, 1.0);
}
