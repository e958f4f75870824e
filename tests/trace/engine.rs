//! The tracer that runs, held against the one that one reads.

use crate::support::{Mean, Random, ball};
use burnish::brdf::Model;
use burnish::math::Rgb;
use burnish::math::simd::Isa;
use burnish::progressive::Params;
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Material, Mesh, Scene, SceneBuilder};
use burnish::trace::{BatchOptions, PixelBatch};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Every shape, smooth and flat, every kind of light, diffuse, glossy and both, and what is in none
/// of the easy cases: many materials, and a mesh that is no plate.
fn everything() -> Scene {
    let mut b = SceneBuilder::new("everything");
    let mut materials = Vec::new();
    for i in 0..20 {
        let x = f64::from(i) / 20.0;
        let ks = if i % 3 == 0 { [0.0; 3] } else { [0.3, 0.5 * x, 0.4] };
        let kd = if i % 5 == 1 { [0.0; 3] } else { [0.5, 0.7 * x, 0.3] };
        materials.push(b.material(Material::reflecting(format!("{i}"), kd, ks, 1e4 * x).unwrap()));
    }
    b.cuboid(DVec3::splat(-2.0), DVec3::new(4.0, 4.0, 2.5), materials[4]).unwrap();
    let mut r = Random::new(4);
    let mut smooth = Mesh::default();
    for (i, &material) in materials.iter().enumerate() {
        let p = DVec3::new(r.within(-1.6, 1.6), r.within(-1.0, 1.6), r.within(-1.8, -0.6));
        match i % 3 {
            0 => b.sphere(p, 0.25, material).unwrap(),
            1 => b.cylinder(p, DVec3::new(0.1, 0.2, 0.5), 0.15, material).unwrap(),
            _ => b.cuboid(p, DVec3::splat(0.3), material).unwrap(),
        }
    }
    for i in 0..60 {
        let angle = f64::from(i) * 0.1;
        let (s, c) = angle.sin_cos();
        smooth.positions.push(DVec3::new(s, c, 0.1 * angle - 1.5) * 0.8);
        smooth.normals.push(DVec3::new(s, c, 0.3).normalize());
        if i >= 2 {
            smooth.triangles.push([i - 2, i - 1, i].map(|x| x as u32));
        }
    }
    b.mesh(&smooth, DAffine3::IDENTITY, materials[7]).unwrap();
    let emitter = b.material(Material::light("lamp", [5.0, 4.0, 3.0]).unwrap());
    let shiny = Material {
        emission: [2.0, 3.0, 4.0],
        ..Material::reflecting("shiny", [0.2; 3], [0.3; 3], 50.0).unwrap()
    };
    let shiny = b.material(shiny);
    b.sphere(DVec3::new(-1.0, 0.0, -0.2), 0.2, emitter).unwrap();
    b.cylinder(DVec3::new(1.0, 1.0, -0.3), DVec3::new(0.2, 0.0, 0.3), 0.1, shiny).unwrap();
    b.cuboid(DVec3::new(0.2, 0.3, 0.2), DVec3::new(0.4, 0.4, 0.0), emitter).unwrap();
    // Open above, so that the environment looks in.
    b.environment = [0.2, 0.25, 0.3];
    b.camera = Some(
        Camera::look_at(DVec3::new(0.1, -1.9, -0.4), DVec3::new(0.0, 1.0, -1.0), 0.8).unwrap(),
    );
    b.build()
}

fn scenes() -> Vec<Scene> {
    let shipped = ["shell", "cornell", "plates", "lights"]
        .map(|name| Example::named(name).unwrap().read().unwrap().0.build());
    std::iter::once(everything()).chain(shipped).collect()
}

fn all_pixels([width, height]: [u32; 2]) -> Vec<[u32; 2]> {
    (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).collect()
}

/// A pass of some pixels, by the engine or one by one, with the rays and the paths cut short.
fn pass(params: &Params, pixels: &[[u32; 2]], pass: u64, one_by_one: bool) -> (Vec<Rgb>, [u64; 2]) {
    let tracer = params.tracer();
    let mut scratch = tracer.scratch();
    let mut found = Vec::new();
    if one_by_one {
        found.extend(pixels.iter().map(|&[x, y]| tracer.sample(x, y, pass, &mut scratch)));
    } else {
        let pixels = &mut pixels.iter().copied();
        tracer.sample_each(pixels, pass, &mut scratch, &mut |c| found.push(c));
    }
    (found, [scratch.rays, scratch.capped])
}

fn near(a: Rgb, b: Rgb) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-3 * (a.abs() + b.abs()) + 1e-6;
    near(a.r, b.r) && near(a.g, b.g) && near(a.b, b.b)
}

/// The same random numbers and the same decisions: nearly every sample is the same but for the
/// order of its sums. Where rounding has turned a decision (in less than one of 500), it has done so without a bias.
#[test]
fn the_engine_finds_what_the_reference_finds() {
    let size = [48, 36];
    let pixels = all_pixels(size);
    for (i, mut scene) in scenes().into_iter().enumerate() {
        for (j, isa) in Isa::available().into_iter().enumerate() {
            scene.set_isa(isa);
            let shared = Arc::new(scene);
            let model = Model::ALL[(i + j) % 3];
            let params = Params { model, size, ..Params::new(shared.clone()) };
            let (mut same, mut all, mut difference) = (0, 0, Mean::default());
            for number in 0..4 {
                let (engine, [rays, capped]) = pass(&params, &pixels, number, false);
                let (reference, [truth, _]) = pass(&params, &pixels, number, true);
                assert_eq!((engine.len(), capped), (pixels.len(), 0));
                assert!(rays.abs_diff(truth) * 200 < truth, "{rays} rays, not {truth}");
                for (a, b) in engine.into_iter().zip(reference) {
                    assert!(a.is_finite() && b.is_finite());
                    all += 1;
                    same += usize::from(near(a, b));
                    let sum = a.luminance() + b.luminance() + 0.1;
                    difference.add(f64::from((a.luminance() - b.luminance()) / sum));
                }
            }
            let name = format!("{} {isa:?} {model:?}", params.scene.name());
            assert!(same * 1000 >= all * 998, "{name}: {same} of {all} are the same");
            assert!(
                difference.mean.abs() <= 4.0 * difference.standard_error() + 1e-6,
                "{name}: {} +- {}",
                difference.mean,
                difference.standard_error()
            );
            drop(params);
            scene = Arc::into_inner(shared).expect("nobody else holds it");
        }
    }
}

/// A pixel's sample is its own: the same bits alone, backwards, and among however many others.
#[test]
fn no_path_depends_on_its_neighbours() {
    let params = Params { size: [50, 40], ..Params::new(Arc::new(everything())) };
    let pixels = all_pixels(params.size);
    for model in Model::ALL {
        let params = Params { model, ..params.clone() };
        let (together, [rays, _]) = pass(&params, &pixels, 5, false);
        let backwards: Vec<_> = pixels.iter().copied().rev().collect();
        let (mut back, [rays_back, _]) = pass(&params, &backwards, 5, false);
        back.reverse();
        assert!(back == together && rays == rays_back, "{model:?}");
        for (i, &pixel) in pixels.iter().enumerate().step_by(37) {
            assert_eq!(pass(&params, &[pixel], 5, false).0, [together[i]], "{model:?} {pixel:?}");
        }
    }
}

/// AVX2 and AVX-512 differ in how much they do at a time and in nothing else.
#[test]
fn the_wide_sets_give_the_same_bits() {
    let pixels = all_pixels([40, 30]);
    for mut scene in scenes() {
        let mut found: Vec<Vec<Rgb>> = Vec::new();
        for isa in Isa::available().into_iter().filter(|isa| *isa != Isa::Portable) {
            scene.set_isa(isa);
            let shared = Arc::new(scene);
            let params = Params { size: [40, 30], ..Params::new(shared.clone()) };
            found.push((0..3).flat_map(|n| pass(&params, &pixels, n, false).0).collect());
            drop(params);
            scene = Arc::into_inner(shared).expect("nobody else holds it");
        }
        assert!(found.windows(2).all(|w| w[0] == w[1]), "{}", scene.name());
    }
}

/// A lamp in front of nothing, from near enough that most pixels have none of its edges.
fn lamp_alone() -> Scene {
    let mut b = SceneBuilder::new("lamp alone");
    let emitter = b.material(Material::light("lamp", [3.0, 2.0, 1.0]).unwrap());
    b.sphere(DVec3::ZERO, 1.0, emitter).unwrap();
    b.camera = Some(Camera::look_at(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO, 0.4).unwrap());
    b.build()
}

/// Means with and without further rays agree in every quarter of the picture, while the error falls;
/// without them samples are those of [`Tracer::sample_each`].
#[test]
fn looking_further_for_lamps_changes_the_noise_and_nothing_else() {
    let (size, seeds) = ([24, 20], 600);
    let shipped =
        ["shell", "plates"].map(|name| Example::named(name).unwrap().read().unwrap().0.build());
    let bounds = [0.3, 0.95, 0.96, 0.6];
    let scenes = [lamp_alone(), everything()].into_iter().chain(shipped);
    for (i, (scene, bound)) in scenes.zip(bounds).enumerate() {
        let model = Model::ALL[i % 3];
        let params = Params { model, size, ..Params::new(Arc::new(scene)) };
        let name = params.scene.name().to_owned();
        let batch = PixelBatch { pixels: all_pixels(size), ..PixelBatch::default() };
        let mut found = Vec::new();
        for split in [false, true] {
            let mut quarters: Vec<Mean> = (0..4).map(|_| Mean::default()).collect();
            let mut pixels: Vec<Mean> = batch.pixels.iter().map(|_| Mean::default()).collect();
            for seed in 0..seeds {
                let params = Params { seed, ..params.clone() };
                let tracer = params.tracer();
                let mut scratch = tracer.scratch();
                let mut sums = [0.0; 4];
                let mut samples = vec![0.0; pixels.len()];
                for number in 0..4 {
                    let round = BatchOptions { split, ..BatchOptions::of(number) };
                    let mut traced = Vec::new();
                    let put = &mut |_, c| traced.push(c);
                    tracer.sample_batch(&batch, round, &mut scratch, put);
                    if !split && seed == 0 {
                        assert!(traced == pass(&params, &batch.pixels, number, false).0, "{name}");
                    }
                    for (at, c) in traced.into_iter().enumerate() {
                        assert!(c.is_finite());
                        samples[at] += f64::from(c.luminance()) / 4.0;
                        sums[at % 24 / 12 + 2 * (at / 24 / 10)] += f64::from(c.luminance());
                    }
                }
                sums.into_iter().zip(&mut quarters).for_each(|(sum, mean)| mean.add(sum));
                samples.into_iter().zip(&mut pixels).for_each(|(x, mean)| mean.add(x));
            }
            let error = |m: &Mean| m.standard_error().powi(2) / (m.mean * m.mean + 0.01);
            found.push((quarters, pixels.iter().map(error).sum::<f64>()));
        }
        let [(plain, noise), (looked, less)] = found.try_into().ok().unwrap();
        for (a, b) in plain.iter().zip(&looked) {
            let error = a.standard_error().hypot(b.standard_error());
            assert!((a.mean - b.mean).abs() <= 4.5 * error, "{name}: {} {}", a.mean, b.mean);
            assert!(error < 0.04 * a.mean, "{name}: too noisy to tell: {error} {}", a.mean);
        }
        assert!(less < bound * noise, "{name}: {less} of {noise}");
    }
}

/// Depth limits cut where the reference cuts, and a scene may have nothing in it at all.
#[test]
fn limits_and_empty_scenes_are_as_in_the_reference() {
    let scene = Arc::new(everything());
    let pixels = all_pixels([30, 20]);
    for max_depth in [1, 2, 5] {
        let params =
            Params { size: [30, 20], max_depth: Some(max_depth), ..Params::new(scene.clone()) };
        let (engine, [rays, _]) = pass(&params, &pixels, 0, false);
        let (reference, [truth, _]) = pass(&params, &pixels, 0, true);
        let same = engine.iter().zip(&reference).filter(|(a, b)| near(**a, **b)).count();
        assert!(same * 100 >= pixels.len() * 97, "{max_depth}: {same}");
        assert!(rays.abs_diff(truth) * 200 < truth, "{max_depth}: {rays} rays, not {truth}");
    }
    for light in [[0.0; 3], [1.0, 2.0, 3.0]] {
        let mut b = SceneBuilder::new("nothing");
        b.environment = light;
        let params = Params { size: [30, 20], ..Params::new(Arc::new(b.build())) };
        let (found, counts) = pass(&params, &pixels, 0, false);
        assert!(found.iter().all(|c| *c == Rgb::from(light)));
        assert_eq!(counts, [pixels.len() as u64, 0]);
    }
}

/// A closed black body under a bright sky, seen from inside through ten million rays at its corners,
/// along its edges and anywhere: whatever gets out is light. The camera's picture is so narrow that
/// its rays pass within a few roundings of the point aimed at.
#[test]
fn closed_meshes_leak_nothing_through_the_engine() {
    let size = [32, 32];
    let pixels = all_pixels(size);
    let mut random = Random::new(12);
    let mut rays = 0;
    for at in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
        for (shape, mesh) in [ball(1), ball(4)].iter().enumerate() {
            let mut b = SceneBuilder::new("closed");
            let black = b.material(Material::reflecting("black", [0.0; 3], [0.0; 3], 1.0).unwrap());
            b.mesh(mesh, DAffine3::from_translation(at), black).unwrap();
            if shape == 0 {
                b.cuboid(at - DVec3::splat(0.3), DVec3::splat(0.6), black).unwrap();
            }
            b.environment = [1.0; 3];
            let scene = Arc::new(b.build());
            let corner = |i: usize, k: usize| at + mesh.positions[mesh.triangles[i][k] as usize];
            for aim in 0..2500 {
                let i = random.bits() as usize % mesh.triangles.len();
                let [u, v] = random.pair().map(f64::from);
                let target = match aim % 4 {
                    0 => corner(i, 0),
                    1 => corner(i, 0).lerp(corner(i, 1), u),
                    _ => corner(i, 0).lerp(corner(i, 1), u).lerp(corner(i, 2), v),
                };
                let eye = at + DVec3::from_array(random.direction()) * 0.7;
                let narrow = if aim % 8 < 4 { 1e-6 } else { 1e-4 };
                let camera = Camera::look_at(eye, target, narrow).unwrap();
                let params = Params { camera, size, ..Params::new(scene.clone()) };
                let (found, [traced, _]) = pass(&params, &pixels, aim, false);
                rays += traced;
                assert!(found.iter().all(|c| c.is_black()), "{shape} at {at}: aimed at {target}");
            }
        }
    }
    assert!(rays >= 10_000_000, "{rays}");
}
