//! Images where mirrors have them, of the size that they have, and the sampler against its density.

use super::*;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Numbers in [0, 1) without a pattern.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn direction(&mut self) -> DVec3 {
        let (z, phi) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    }
}

fn narrow(v: DVec3) -> V3 {
    V3::from(v.as_vec3().to_array())
}

fn wide(v: V3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// A ball, a light and a point that faces the ball.
struct Case {
    pair: MirroredLight,
    p: V3,
    n: V3,
}

fn case(numbers: &mut Numbers) -> Case {
    let centre = numbers.direction() * numbers.next();
    let radius = numbers.between(0.05, 0.5);
    let away = |numbers: &mut Numbers, most: f64| {
        centre + numbers.direction() * radius * numbers.between(1.05, most)
    };
    let (light, p) = (away(numbers, 20.0), away(numbers, 4.0));
    let disc = LightDisc {
        centre: narrow(light),
        radius: (radius * numbers.between(0.1, 2.0)) as f32,
        intensity: numbers.between(0.1, 1.0) as f32,
    };
    let pair = MirroredLight {
        centre: narrow(centre),
        radius: radius as f32,
        ks: numbers.between(0.3, 1.0) as f32,
        blur: BLUR * numbers.between(0.0, 0.1) as f32,
        light: disc,
    };
    let n = (centre - p).normalize() + 0.5 * numbers.direction();
    Case { pair, p: narrow(p), n: narrow(n.normalize()) }
}

impl Case {
    fn image(&self, pair: &MirroredLight) -> Image<f32> {
        pair.image(self.p, self.n, 1e-3, true)
    }

    /// Where a direction from the point hits the ball, and the direction that it is mirrored in there.
    fn mirrored(&self, d: DVec3) -> Option<[DVec3; 2]> {
        let (away, radius) = (wide(self.pair.centre) - wide(self.p), f64::from(self.pair.radius));
        let along = away.dot(d);
        let depth = radius * radius - (away - d * along).length_squared();
        let hit = (depth > 0.0 && along > 0.0).then(|| d * (along - depth.sqrt()))?;
        let normal = (hit - away) / radius;
        Some([wide(self.p) + hit, d - normal * (2.0 * normal.dot(d))])
    }
}

#[test]
fn the_axis_is_mirrored_into_the_light() {
    let mut numbers = Numbers(1);
    let (mut off, mut seen) = (Vec::new(), 0);
    for _ in 0..4000 {
        let case = case(&mut numbers);
        let image = case.image(&case.pair);
        if image.chance == 0.0 {
            continue;
        }
        seen += 1;
        let to_light = |hit: DVec3| (wide(case.pair.light.centre) - hit).normalize();
        // Near the horizon of the ball the axis may just miss it.
        if let Some([hit, d]) = case.mirrored(wide(image.axis)) {
            off.push(to_light(hit).angle_between(d));
        }
    }
    off.sort_by(f64::total_cmp);
    let at = |part: f64| off[(off.len() as f64 * part) as usize];
    assert!(seen > 1500 && off.len() > seen * 95 / 100, "{} of {seen}", off.len());
    assert!(at(0.5) < 1e-3 && at(0.95) < 0.05, "{} {}", at(0.5), at(0.95));
}

/// The image of a light that is moved a little moves by its size there as the beam has it.
#[test]
fn images_are_as_large_as_mirrors_make_them() {
    let mut numbers = Numbers(2);
    let mut ratios = [const { Vec::new() }; 2];
    for _ in 0..2000 {
        let mut case = case(&mut numbers);
        (case.pair.blur, case.pair.light.radius) = (0.0, 1e-3 * case.pair.radius);
        let image = case.image(&case.pair);
        let Some([hit, _]) = case.mirrored(wide(image.axis)).filter(|_| image.chance > 0.0) else {
            continue;
        };
        // The light's disc lies across the beam.
        let beam = (wide(case.pair.light.centre) - hit).normalize();
        let t = wide(image.across[1]).normalize();
        for (ratios, (along, which)) in ratios.iter_mut().zip([(beam.cross(t), 0), (t, 1)]) {
            let ends = [-1.0, 1.0].map(|side| {
                let mut moved = case.pair;
                let by = along * f64::from(10.0 * case.pair.light.radius) * side;
                moved.light.centre = narrow(wide(moved.light.centre) + by);
                wide(case.image(&moved).axis)
            });
            let size = 0.05 * ends[0].angle_between(ends[1]);
            ratios.push(size / f64::from(image.half[which]));
        }
    }
    for ratios in &mut ratios {
        ratios.sort_by(f64::total_cmp);
        let at = |part: f64| ratios[(ratios.len() as f64 * part) as usize];
        assert!(ratios.len() > 800, "{}", ratios.len());
        let [low, middle, high] = [0.1, 0.5, 0.9].map(at);
        assert!((middle - 1.0).abs() < 0.02 && low > 0.8 && high < 1.25, "{low} {middle} {high}");
    }
}

/// Integral of a density times `h` over all directions around the axis of an image, by the midpoint rule.
fn integral(images: &[Image<f32>], about: &Image<f32>, h: &dyn Fn(DVec3) -> f64) -> f64 {
    let (rings, parts) = (400, 192);
    let frame = Frame::around(about.axis);
    let scale = f64::from(about.half[0].max(about.half[1]));
    let mut sum = 0.0;
    for ring in 0..rings {
        // Finer where the density is large.
        let at = |i: f64| {
            let v = i / f64::from(rings);
            (scale * v / (1.0 - v * v)).atan().min(FRAC_PI_2)
        };
        let (from, to) = (at(f64::from(ring)), at(f64::from(ring) + 1.0));
        let theta = at(f64::from(ring) + 0.5);
        let weight = (from.cos() - to.cos()) * TAU / f64::from(parts);
        for part in 0..parts {
            let phi = TAU * (f64::from(part) + 0.5) / f64::from(parts);
            let (s, t, n) = (wide(frame.s), wide(frame.t), wide(frame.n));
            let d = (s * phi.cos() + t * phi.sin()) * theta.sin() + n * theta.cos();
            sum += f64::from(pdf(images, narrow(d))) * h(d) * weight;
        }
    }
    sum
}

#[test]
fn directions_are_drawn_with_the_density_that_is_told() {
    let mut numbers = Numbers(3);
    let mut tried = 0_u32;
    let mut sums = [0.0; 2];
    while tried < 40 {
        let case = case(&mut numbers);
        let image = case.image(&case.pair);
        if image.chance == 0.0 {
            continue;
        }
        tried += 1;
        let images = [image];
        let chance = f64::from(image.chance);
        let whole = integral(&images, &image, &|_| 1.0);
        assert!((whole / chance - 1.0).abs() < 2e-3, "{whole} for {chance}");
        let (axis, s) = (wide(image.axis), wide(image.across[0]));
        let within = |d: DVec3| f64::from(u8::from(s.dot(d).abs() < 0.7 * axis.dot(d)));
        let side = |d: DVec3| f64::from(u8::from(wide(image.across[1]).dot(d) > 0.4 * axis.dot(d)));
        let tests: [&dyn Fn(DVec3) -> f64; 2] = [&within, &side];
        let count = 4000;
        let mut means = [0.0; 2];
        for _ in 0..count {
            let choice = (numbers.next() * chance) as f32;
            let u = [numbers.next() as f32, numbers.next() as f32];
            let d = wide(sample(
                &images,
                choice.min(image.chance * 0.999_999),
                u.map(|u| u.min(1.0 - f32::EPSILON)),
            ));
            assert!((d.length() - 1.0).abs() < 1e-6);
            for (mean, test) in means.iter_mut().zip(tests) {
                *mean += test(d) / f64::from(count);
            }
        }
        for ((mean, test), sum) in means.into_iter().zip(tests).zip(&mut sums) {
            let truth = integral(&images, &image, test) / whole;
            let sigma = (truth * (1.0 - truth) / f64::from(count)).sqrt();
            let z = (mean - truth) / sigma;
            assert!(z.abs() < 4.5, "{mean} for {truth}: {z}");
            *sum += z;
        }
    }
    // Of all cases together, so that a small difference of all would be seen: 0.004 in a mean.
    let all = sums.map(|sum| sum / f64::from(tried).sqrt());
    assert!(all.iter().all(|z| z.abs() < 3.5), "{all:?}");
}
