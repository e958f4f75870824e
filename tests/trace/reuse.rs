//! Paths that share: the same light with less noise, whichever pixels are traced together, on any instruction set.

use crate::support::Mean;
use burnish::brdf::Model;
use burnish::film::CELL;
use burnish::math::Rgb;
use burnish::math::simd::Isa;
use burnish::progressive::{Params, Replay, render};
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Material, Scene, SceneBuilder};
use burnish::trace::{Contribution, PixelBatch, PixelGrouping, ReuseGroup};
use glam::DVec3;
use std::sync::Arc;

const SHARED: [ReuseGroup; 3] =
    [ReuseGroup::Sixteen, ReuseGroup::SixtyFour, ReuseGroup::OneTwentyEight];

/// Glossy and diffuse bodies that touch, a lamp that also reflects, and a sky.
fn touching() -> Scene {
    bodies("touching", [0.1, 300.0], 1200.0)
}

/// The same with mirrors that see each other, and a floor whose lobe is weak.
fn mirrors() -> Scene {
    bodies("mirrors", [0.03, 12.0], 5000.0)
}

fn bodies(name: &str, [ks, exponent]: [f64; 2], sharp: f64) -> Scene {
    let mut b = SceneBuilder::new(name);
    let floor = Material::reflecting("floor", [0.5, 0.4, 0.3], [ks; 3], exponent).unwrap();
    let floor = b.material(floor);
    let wall = b.material(Material::reflecting("wall", [0.7, 0.7, 0.2], [0.0; 3], 1.0).unwrap());
    let metal = b.material(Material::reflecting("metal", [0.0; 3], [0.9; 3], sharp).unwrap());
    let emitter = Material {
        emission: [6.0, 5.0, 4.0],
        ..Material::reflecting("lamp", [0.3; 3], [0.2; 3], 40.0).unwrap()
    };
    let emitter = b.material(emitter);
    b.cuboid(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(4.0, 4.0, -0.1), floor).unwrap();
    b.cuboid(DVec3::new(-2.0, 1.0, 0.0), DVec3::new(4.0, 0.1, 2.0), wall).unwrap();
    b.cuboid(DVec3::new(-0.9, 0.2, 0.0), DVec3::new(0.5, 0.5, 0.7), metal).unwrap();
    b.sphere(DVec3::new(0.4, 0.3, 0.5), 0.5, metal).unwrap();
    b.sphere(DVec3::new(-0.2, -0.4, 0.15), 0.15, wall).unwrap();
    b.cylinder(DVec3::new(0.9, -0.3, 0.0), DVec3::Z * 0.4, 0.2, emitter).unwrap();
    b.environment = [0.1, 0.15, 0.2];
    let eye = DVec3::new(0.2, -2.4, 1.1);
    b.camera = Some(Camera::look_at(eye, DVec3::new(0.0, 0.3, 0.4), 0.5).unwrap());
    b.build()
}

fn scenes() -> Vec<Scene> {
    let shipped =
        ["shell", "cornell"].map(|name| Example::named(name).unwrap().read().unwrap().0.build());
    [touching(), mirrors()].into_iter().chain(shipped).collect()
}

fn hands(grouping: &PixelGrouping) -> Vec<PixelBatch> {
    let [columns, rows] = grouping.batches();
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let batch = |at| {
        let mut batch = PixelBatch::default();
        grouping.batch(at, &mut batch);
        batch
    };
    all.map(batch).collect()
}

/// The light over a quarter of the picture and in all of it: with and without sharing it is the same
/// to within 4.5 standard errors of the difference (some 70 comparisons), and the error of a pixel
/// is less than half.
#[test]
fn sharing_changes_the_noise_and_nothing_else() {
    let (size, passes) = ([48, 36], 96);
    for (i, scene) in scenes().into_iter().enumerate() {
        let scene = Arc::new(scene);
        for (j, group) in SHARED.into_iter().enumerate() {
            let model = Model::ALL[(i + j) % 3];
            // Behind a mirror there is an event less to come, where their number is limited.
            let max_depth = (scene.name() == "mirrors" && j == 1).then_some(2);
            let params = Params { size, model, max_depth, ..Params::new(scene.clone()) };
            let mut means = Vec::new();
            for group in [ReuseGroup::None, group] {
                // Passes of different seeds are independent, however alike the pixels of one are.
                let mut quarters: Vec<Mean> = (0..5).map(|_| Mean::default()).collect();
                let mut spread = 0.0;
                for seed in 0..passes {
                    let params = Params { seed, group: Some(group), ..params.clone() };
                    let picture = render(params, 4, 1).unwrap();
                    let mut sums = [0.0; 5];
                    for (k, pixel) in picture.mean().pixels.iter().enumerate() {
                        let light = f64::from(pixel.iter().sum::<f32>());
                        sums[k % 48 / 24 + 2 * (k / 48 / 18)] += light;
                        sums[4] += light;
                    }
                    sums.into_iter().zip(&mut quarters).for_each(|(sum, mean)| mean.add(sum));
                    let error = picture.error.unwrap();
                    spread += error.rel_mse.value;
                    assert_eq!((picture.counts.nonfinite, picture.group), (0, group));
                }
                means.push((quarters, spread));
            }
            let name = format!("{} {model:?} {group:?}", scene.name());
            let [(apart, noise), (shared, less)] = means.try_into().ok().unwrap();
            for (part, (a, b)) in apart.iter().zip(&shared).enumerate() {
                let error = a.standard_error().hypot(b.standard_error());
                let off = (a.mean - b.mean) / error;
                assert!(off.abs() < 4.5, "{name}, part {part}: {} and {}: {off}", a.mean, b.mean);
                assert!(error < 0.025 * a.mean, "{name}, part {part}: too noisy to tell");
            }
            assert!(less < 0.5 * noise || max_depth.is_some(), "{name}: {less} of {noise}");
        }
    }
}

/// What is each path's own and what is shared are all there is.
#[test]
fn the_parts_make_up_the_whole() {
    for scene in scenes() {
        let params = Params { size: [64, 48], ..Params::new(Arc::new(scene)) };
        let tracer = params.tracer();
        let mut scratch = tracer.scratch();
        for mut batch in hands(&PixelGrouping::new(params.size, 2, 5, ReuseGroup::ThirtyTwo)) {
            let [whole, own, shared] =
                [Contribution::Whole, Contribution::Own, Contribution::Shared].map(|part| {
                    batch.contribution = part;
                    tracer.samples_of(&batch, 5, &mut scratch)
                });
            for ((whole, own), shared) in whole.into_iter().zip(own).zip(shared) {
                let (sum, whole) = ((own + shared).luminance(), whole.luminance());
                assert!((sum - whole).abs() <= 1e-5 * (sum + whole), "{sum} {whole}");
            }
        }
    }
}

/// A group of paths gets the same bits alone as among others of its bundle.
#[test]
fn a_group_can_be_traced_again_alone() {
    let params = Params { size: [70, 50], ..Params::new(Arc::new(touching())) };
    for (model, group) in Model::ALL.into_iter().zip(SHARED) {
        let params = Params { model, ..params.clone() };
        let tracer = params.tracer();
        let mut scratch = tracer.scratch();
        for batch in hands(&PixelGrouping::new(params.size, 0, 7, group)) {
            let together = tracer.samples_of(&batch, 7, &mut scratch);
            let mut start = 0;
            for &end in &batch.ends {
                let places = start..end as usize;
                let pixels = batch.pixels[places.clone()].to_vec();
                let ends = vec![pixels.len() as u32];
                let alone = PixelBatch { pixels, ends, ..PixelBatch::default() };
                let again = tracer.samples_of(&alone, 7, &mut scratch);
                assert!(again == together[places], "{model:?} {group:?}");
                start = end as usize;
            }
        }
    }
}

/// AVX2 and AVX-512 give the same bits; the portable set all but a few of them within rounding, for
/// it may turn a decision.
#[test]
fn instruction_sets_agree() {
    for mut scene in scenes() {
        let mut found: Vec<Vec<Rgb>> = Vec::new();
        for isa in Isa::available() {
            scene.set_isa(isa);
            let shared = Arc::new(scene);
            let params = Params { size: [50, 40], ..Params::new(shared.clone()) };
            let tracer = params.tracer();
            let mut scratch = tracer.scratch();
            let mut all = Vec::new();
            for (pass, group) in (0..).zip(SHARED) {
                for batch in hands(&PixelGrouping::new(params.size, 0, pass, group)) {
                    all.extend(tracer.samples_of(&batch, pass, &mut scratch));
                }
            }
            found.push(all);
            drop((params, tracer));
            scene = Arc::into_inner(shared).expect("nobody else holds it");
        }
        assert!(found.iter().skip(1).all(|f| *f == found[1]), "{}", scene.name());
        let near = |(a, b): (&Rgb, &Rgb)| {
            (a.luminance() - b.luminance()).abs() <= 1e-2 * (a.luminance() + b.luminance()) + 1e-6
        };
        if let [portable, wide, ..] = found.as_slice() {
            let same = portable.iter().zip(wide).filter(|pair| near(*pair)).count();
            // A decision turned anywhere in a group is felt by all of it.
            assert!(same * 100 >= wide.len() * 80, "{}: {same} of {}", scene.name(), wide.len());
        }
    }
}

/// The size of groups is selected by the parameters alone, and a group that was asked for is taken.
#[test]
fn the_size_of_group_is_part_of_the_picture() {
    let scene = Example::named("cornell").unwrap().read().unwrap().0.build();
    let params = Params { size: [60, 40], ..Params::new(Arc::new(scene)) };
    let chosen = render(params.clone(), 2, 1).unwrap();
    for threads in [2, 5] {
        let again = render(params.clone(), 2, threads).unwrap();
        assert_eq!((again.group, again.mean()), (chosen.group, chosen.mean()));
    }
    assert_ne!(chosen.group, ReuseGroup::None, "indirect light is worth sharing");
    for group in ReuseGroup::ALL {
        let given = render(Params { group: Some(group), ..params.clone() }, 2, 2).unwrap();
        assert_eq!(given.group, group);
        assert_eq!(given.mean() == chosen.mean(), group == chosen.group);
    }
    let direct = render(Params { max_depth: Some(1), ..params.clone() }, 2, 2).unwrap();
    assert_eq!(direct.group, ReuseGroup::None, "there is nothing to share");
    let reference = render(Params { reference: true, ..params }, 2, 2).unwrap();
    assert_eq!(reference.group, ReuseGroup::None);
}

/// A pixel of a picture is the mean of its samples, each traced again by itself.
#[test]
fn any_pixel_can_be_replayed() {
    let params = Params { size: [40, 30], seed: 3, ..Params::new(Arc::new(touching())) };
    for group in [None, Some(ReuseGroup::None), Some(ReuseGroup::ThirtyTwo)] {
        let params = Params { group, ..params.clone() };
        let picture = render(params.clone(), 4, 2).unwrap();
        for pixel in [[0, 0], [17, 12], [39, 29]] {
            let replays: Vec<Replay> =
                (0..4).map(|pass| Replay::new(&params, pixel, pass).unwrap()).collect();
            let own = |r: &Replay| <[f32; 3]>::from(r.samples[r.own].whole).map(f64::from);
            let mut mean = [0.0; 3];
            for replay in &replays {
                assert_eq!((replay.group, replay.pixels[replay.own]), (picture.group, pixel));
                mean.iter_mut().zip(own(replay)).for_each(|(mean, x)| *mean += x * 0.25);
            }
            let shown = picture.mean().pixels[(pixel[1] * 40 + pixel[0]) as usize];
            assert_eq!(shown, mean.map(|x| x as f32), "{group:?} {pixel:?}");
        }
    }
    assert_eq!(Replay::new(&params, [40, 0], 0), None);
}

/// So is one of a picture whose samples are planned. Where it is one cell there is nothing to choose,
/// and it has all passes in turn.
#[test]
fn a_pixel_of_a_planned_picture_can_be_replayed() {
    let passes = 24;
    let [width, height] = [CELL as u32, CELL as u32 - 1];
    let params = Params { size: [width, height], seed: 3, ..Params::new(Arc::new(mirrors())) };
    for group in
        [None, Some(ReuseGroup::None), Some(ReuseGroup::Sixteen), Some(ReuseGroup::OneTwentyEight)]
    {
        let params = Params { group, ..params.clone() };
        let picture = render(params.clone(), passes, 2).unwrap();
        assert!(picture.samples().iter().all(|&n| n == passes));
        for pixel in [[0, 0], [width - 3, 4], [width - 1, height - 1]] {
            let mut mean = [0.0; 3];
            for pass in 0..passes {
                let replay = Replay::new(&params, pixel, pass).unwrap();
                assert_eq!(replay.pixels[replay.own], pixel);
                let sample = <[f32; 3]>::from(replay.samples[replay.own].whole);
                mean.iter_mut().zip(sample).for_each(|(m, x)| *m += f64::from(x) / passes as f64);
            }
            let shown = picture.mean().pixels[(pixel[1] * width + pixel[0]) as usize];
            for (x, mean) in shown.into_iter().zip(mean) {
                assert!((f64::from(x) - mean).abs() <= 1e-6 * mean, "{group:?} {pixel:?}");
            }
        }
    }
}
