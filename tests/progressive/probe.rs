//! One pixel taken apart: its parts add up, and they are those of the picture.

use burnish::brdf::{Erratum, Model};
use burnish::film::{Figure, student};
use burnish::progressive::{Params, PixelReport, Strategy, Technique, probe, render};
use burnish::scene::{Camera, Material, Scene, SceneBuilder};
use burnish::trace::{PathRecord, Scratch, Tracer};
use glam::DVec3;
use std::sync::Arc;

/// A floor, a wall, a metal ball and a lamp under a dim sky.
fn room() -> Arc<Scene> {
    let mut b = SceneBuilder::new("room");
    let wall = b.material(Material::reflecting("wall", [0.6, 0.5, 0.4], [0.04; 3], 100.0).unwrap());
    let metal = b.material(Material::reflecting("metal", [0.0; 3], [0.9; 3], 40.0).unwrap());
    let emitter = b.material(Material::light("lamp", [5.0, 5.0, 4.0]).unwrap());
    b.cuboid(DVec3::new(-4.0, -4.0, -2.5), DVec3::new(8.0, 8.0, 0.5), wall).unwrap();
    b.cuboid(DVec3::new(-4.0, 2.0, -2.5), DVec3::new(8.0, 0.5, 3.5), wall).unwrap();
    b.sphere(DVec3::new(0.5, 0.3, -1.2), 0.8, metal).unwrap();
    b.sphere(DVec3::new(-0.5, 0.5, 1.2), 0.4, emitter).unwrap();
    b.environment = [0.1, 0.15, 0.2];
    b.camera =
        Some(Camera::look_at(DVec3::new(0.2, -3.9, 0.4), DVec3::new(0.0, 1.0, -0.3), 0.6).unwrap());
    b.screen = [32, 24];
    Arc::new(b.build())
}

fn params(model: Model) -> Params {
    Params { model, ..Params::new(room()) }
}

fn plain(tracer: &Tracer, [x, y]: [u32; 2], pass: u64, scratch: &mut Scratch) -> [f32; 3] {
    tracer.sample(x, y, pass, scratch).into()
}

fn sum(path: &PathRecord) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let all = path.vertices.iter().flat_map(|v| [v.emitted, v.direct]);
    for found in all.chain(path.escape.map(|e| e.found)) {
        for (sum, c) in sum.iter_mut().zip(<[f32; 3]>::from(found)) {
            *sum += f64::from(c);
        }
    }
    sum
}

#[test]
fn a_record_has_the_sample_s_bits_and_its_parts_add_up_to_it() {
    let (mut vertices, mut escapes, mut lit) = (0, 0, 0);
    for model in Model::ALL {
        for strategy in Strategy::ALL {
            let params = Params { strategy, ..params(model) };
            let (tracer, [w, h]) = (params.tracer(), params.size);
            let mut scratch = tracer.scratch();
            for (i, pass) in (0..w * h).zip([0, 7, 1 << 18].into_iter().cycle()) {
                let pixel = [i % w, i / w];
                let path = tracer.record(pixel, pass, &mut scratch);
                let plain = plain(&tracer, pixel, pass, &mut scratch);
                assert_eq!(<[f32; 3]>::from(path.value), plain, "{model:?} {strategy:?} {pixel:?}");
                // Each of the sums loses half a unit in the last place of the largest.
                let terms = 2.0 * path.vertices.len() as f64 + 1.0;
                for (sum, value) in sum(&path).into_iter().zip(plain) {
                    let value = f64::from(value);
                    let rounding = terms * f64::from(f32::EPSILON) * value;
                    assert!((sum - value).abs() <= rounding, "{sum} and {value}");
                }
                vertices += path.vertices.len();
                escapes += usize::from(path.escape.is_some());
                lit += path.vertices.iter().filter(|v| v.light.is_some()).count();
            }
        }
    }
    assert!(vertices > 5_000 && escapes > 2_000 && lit > 1_000, "{vertices} {escapes} {lit}");
}

#[test]
fn a_mistake_made_on_purpose_is_recorded_too() {
    for erratum in [Erratum::GgxGSum, Erratum::DoubleDirect, Erratum::ClampSamples] {
        let params = Params { erratum: Some(erratum), ..params(Model::Ggx) };
        let tracer = params.tracer();
        let mut scratch = tracer.scratch();
        for i in 0..200 {
            let pixel = [i % 32, i / 32 * 4];
            let path = tracer.record(pixel, 3, &mut scratch);
            let plain = plain(&tracer, pixel, 3, &mut scratch);
            assert_eq!(<[f32; 3]>::from(path.value), plain, "{erratum:?} {pixel:?}");
        }
    }
}

fn assert_sum(parts: impl Iterator<Item = Figure>, whole: Figure) {
    let sum: f64 = parts.map(|f| f.value).sum();
    assert!((sum - whole.value).abs() <= 1e-5 * whole.value, "{sum}, not {}", whole.value);
}

#[test]
fn events_and_techniques_each_add_up_to_all_of_the_light() {
    for model in Model::ALL {
        let params = params(model);
        for pixel in [[16, 12], [20, 15], [14, 4], [0, 0]] {
            let report = probe(&params, pixel, 512).unwrap();
            let total = report.total;
            assert!(report.samples == 512 && report.luminances.len() == 512);
            for c in 0..3 {
                assert_sum(report.by_event.iter().map(|p| p.rgb[c]), total.rgb[c]);
                assert_sum(report.by_technique.iter().map(|p| p.rgb[c]), total.rgb[c]);
            }
            assert_sum(report.by_event.iter().map(|p| p.luminance), total.luminance);
            let mean = report.luminances.iter().map(|&l| f64::from(l)).sum::<f64>() / 512.0;
            assert!((mean - total.luminance.value).abs() <= 1e-5 * mean);
            let brightest = report.luminances.iter().copied().fold(0.0, f32::max);
            assert_eq!(report.brightest.1.value.luminance(), brightest);
            assert_eq!(report.by_event[0], report.by_technique[Technique::Seen as usize]);
        }
    }
}

/// The picture's pixels are means of other, shared samples. Its replicates tell how far each is off,
/// with few degrees of freedom; so do the probe's randomisations. Over 48 pixels, of which neighbours
/// in the picture are not independent, at most one in five may be outside of the 95 % of their
/// difference: for 48 independent ones the chance of that is below 1e-4.
#[test]
fn its_mean_is_the_picture_s() {
    for model in Model::ALL {
        let params = params(model);
        let snapshot = render(params.clone(), 256, 1).unwrap();
        let (mean, error) = (snapshot.mean(), snapshot.standard_error());
        let reach = student((PixelReport::RANDOMISATIONS - 1) as f64);
        let pixels = (0..48).map(|i| [4 * (i % 8) + 1, 4 * (i / 8) + 2]);
        let mut outside = 0;
        for [x, y] in pixels.clone() {
            let figure = probe(&params, [x, y], 256).unwrap().total.rgb[1];
            let at = (y * 32 + x) as usize;
            let own = (figure.interval.high - figure.value) / reach;
            let both = own.hypot(f64::from(error.pixels[at][1]));
            let apart = (f64::from(mean.pixels[at][1]) - figure.value).abs();
            // Seen alone, a lamp or the sky has no error but rounding.
            outside += usize::from(apart > 1.96 * both + 1e-5 * figure.value);
        }
        assert!(outside <= 9, "{model:?}: {outside} of 48 pixels disagree");
    }
}

/// The true mean is inside of the intervals as often as they say: 95 % of 240, give or take three
/// standard deviations.
#[test]
fn its_intervals_keep_their_word() {
    let params = params(Model::Ggx);
    let (pixels, seeds): ([[u32; 2]; 6], _) =
        ([[16, 12], [20, 15], [18, 17], [3, 3], [28, 20], [10, 9]], 40);
    let mut inside = 0;
    for pixel in pixels {
        let truth = probe(&params, pixel, 1 << 16).unwrap().total.luminance.value;
        for seed in 1..=seeds {
            let other = Params { seed, ..params.clone() };
            let figure = probe(&other, pixel, 64).unwrap().total.luminance;
            inside += u32::from(figure.interval.contains(truth));
        }
    }
    let share = f64::from(inside) / (6.0 * seeds as f64);
    let deviation = (0.95f64 * 0.05 / (6.0 * seeds as f64)).sqrt();
    assert!((share - 0.95).abs() <= 3.0 * deviation, "{share}");
}

#[test]
fn lights_seen_directly_and_one_technique_alone_are_told_as_such() {
    // The lamp fills this pixel.
    let params = params(Model::Ggx);
    let middle = params.camera.project(DVec3::new(-0.5, 0.5, 1.2), DVec3::ZERO, [32, 24]).unwrap();
    let pixel = middle[0].map(|x| x as u32);
    let report = probe(&params, pixel, 64).unwrap();
    assert_eq!(report.by_technique[0].rgb.map(|f| f.value), [5.0, 5.0, 4.0]);
    assert_eq!(report.by_event.len(), 1);
    assert!(report.directions.is_empty(), "lamps do not scatter");
    for (strategy, none) in
        [(Strategy::LightOnly, Technique::Brdf), (Strategy::BsdfOnly, Technique::Light)]
    {
        let params = Params { strategy, ..params.clone() };
        let report = probe(&params, [20, 15], 256).unwrap();
        assert_eq!(report.by_technique[none as usize].luminance.value, 0.0);
        assert!(report.total.luminance.value > 0.0);
    }
    let shallow = Params { max_depth: Some(1), ..params.clone() };
    assert!(probe(&shallow, [20, 15], 256).unwrap().by_event.len() <= 2);
    assert!(probe(&params, [32, 0], 16).is_none(), "there is no such pixel");
}

/// Directions are in the local frame with the viewer at the left: a glossy surface sends most of
/// them to the right, and all of them are unit.
#[test]
fn directions_gather_about_the_mirror_s() {
    let params = params(Model::Beckmann);
    let report = probe(&params, [20, 15], 1024).unwrap();
    let first = report.first.unwrap();
    assert_eq!(params.materials[first.material as usize].name, "metal");
    assert!(first.theta_o > 0.1, "{}", first.theta_o);
    assert!(report.directions.len() > 900, "{}", report.directions.len());
    let unit = |d: &[f32; 3]| (d.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-4;
    assert!(report.directions.iter().all(unit));
    let mean = |c: usize| {
        let sum: f64 = report.directions.iter().map(|d| f64::from(d[c])).sum();
        sum / report.directions.len() as f64
    };
    assert!(mean(0) > 0.5 * first.theta_o.sin() && mean(1).abs() < 0.05, "{} {}", mean(0), mean(1));
}
