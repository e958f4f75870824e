//! The light that polished balls throw: paths that are reused and aim at where balls mirror lights find as much of it
//! as paths alone, which do neither.

use crate::support::{Mean, Random, vector};
use burnish::brdf::{Model, Roughness};
use burnish::progressive::{Params, render};
use burnish::scene::{Camera, Material, Scene, SceneBuilder};
use burnish::trace::ReuseGroup;
use glam::DVec3;
use std::sync::Arc;

/// A polished ball or two, one or two lamps, something in the way, and a camera that looks at the floor beside
/// the ball; all of it drawn.
fn drawn(r: &mut Random) -> Scene {
    let mut b = SceneBuilder::new("caustic");
    let colour = |r: &mut Random, most: f64| [0; 3].map(|_| r.within(0.2 * most, most));
    let surface = |r: &mut Random, kd: f64, ks: f64, alphas: [f64; 2]| {
        let (kd, ks) = (colour(r, kd), colour(r, ks));
        let alpha = r.within(alphas[0].ln(), alphas[1].ln()).exp();
        let roughness = Roughness::from_alpha(alpha).unwrap();
        Material { roughness, ..Material::reflecting("surface", kd, ks, 1.0).unwrap() }
    };
    let matt = r.unit() < 0.5;
    let floor = surface(r, 0.6, if matt { 0.0 } else { 0.3 }, [0.1, 0.6]);
    let floor = b.material(floor);
    let (centre, radius) = (DVec3::Z * r.within(0.4, 0.7), r.within(0.25, 0.4));
    let polished = surface(r, 0.0, 0.95, [0.01, 0.14]);
    let polished = b.material(polished);
    b.sphere(centre, radius, polished).unwrap();
    let lacquer = surface(r, 0.4, 0.1, [0.02, 0.1]);
    let lacquer = b.material(lacquer);
    b.sphere(DVec3::new(-0.9, r.within(-0.5, 0.5), 0.3), 0.3, lacquer).unwrap();
    b.cuboid(DVec3::new(-3.0, -3.0, -0.1), DVec3::new(6.0, 6.0, 0.1), floor).unwrap();
    let lamp = b.material(Material::light("lamp", [9.0, 8.0, 7.0]).unwrap());
    let at = DVec3::new(r.within(0.6, 2.0), r.within(-1.0, 1.5), r.within(0.5, 2.0));
    b.sphere(at, r.within(0.1, 0.3), lamp).unwrap();
    if r.unit() < 0.5 {
        b.cuboid(DVec3::new(-0.5, r.within(-2.0, -1.0), 2.0), DVec3::new(0.7, 0.5, 0.02), lamp)
            .unwrap();
    }
    // In the way of a part of the light that is aimed at.
    b.cuboid(DVec3::new(radius + 0.05, -0.1, 0.3), DVec3::new(0.05, 0.2, 0.5), floor).unwrap();
    b.environment = [r.within(0.0, 0.1) as f32; 3];
    let target = DVec3::new(r.within(0.2, 0.6), r.within(-0.4, 0.2), 0.0);
    let eye = target + DVec3::new(0.0, -1.2, 1.6) + vector(r, 0.3);
    b.camera = Some(Camera::look_at(eye, target, 0.7).unwrap());
    b.build()
}

/// The light of all four quarters and of all, over 12 drawn scenes: with reuse and without, it is the same to within 4.5
/// standard errors of the difference (60 comparisons), which are below 3 % of the light, and of the whole
/// below 1 %.
#[test]
fn aiming_at_highlights_changes_no_mean() {
    let mut r = Random::new(20_261_129);
    let mut offs = Mean::default();
    for i in 0..12 {
        let scene = Arc::new(drawn(&mut r));
        let model = Model::ALL[i % 3];
        let group = [ReuseGroup::Sixteen, ReuseGroup::SixtyFour][i / 3 % 2];
        let params = Params { size: [32, 24], model, ..Params::new(scene) };
        let mut found = Vec::new();
        for (group, seeds) in [(ReuseGroup::None, 192), (group, 64)] {
            let mut parts: Vec<Mean> = (0..5).map(|_| Mean::default()).collect();
            for seed in 0..seeds {
                let params = Params { seed, group: Some(group), ..params.clone() };
                let picture = render(params, 16, 1).unwrap();
                let mut sums = [0.0; 5];
                for (k, pixel) in picture.mean().pixels.iter().enumerate() {
                    let light = f64::from(pixel.iter().sum::<f32>());
                    sums[k % 32 / 16 + 2 * (k / 32 / 12)] += light;
                    sums[4] += light;
                }
                sums.into_iter().zip(&mut parts).for_each(|(sum, part)| part.add(sum));
                assert_eq!(picture.counts.nonfinite, 0);
            }
            found.push(parts);
        }
        let [apart, aimed] = found.try_into().ok().unwrap();
        for (part, (a, b)) in apart.iter().zip(&aimed).enumerate() {
            let error = a.standard_error().hypot(b.standard_error());
            let off = (a.mean - b.mean) / error;
            assert!(off.abs() < 4.5, "{i}, {part}: {} and {}: {off}", a.mean, b.mean);
            let bound = if part == 4 { 0.01 } else { 0.03 };
            assert!(error < bound * a.mean, "{i}, {part}: too noisy: {error} of {}", a.mean);
            offs.add(off);
        }
    }
    assert!(offs.mean.abs() < 0.6, "{} on the mean", offs.mean);
}
