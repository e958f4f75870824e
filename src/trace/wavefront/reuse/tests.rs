//! Held against the formulas themselves, one pair at a time, in double precision where it matters.

use super::super::PathBatch;
use super::{Points, PrimaryVertices, ReuseVertices};
use crate::brdf::{BrdfParams, Ggx, Microfacet, Model, Phong, Roughness};
use crate::geometry::{Ray, bent, offset_origin};
use crate::math::simd::Isa;
use crate::math::{Frame, Rgb, V3};
use crate::progressive::Params;
use crate::scene::builtin::Example;
use crate::trace::highlights;
use crate::trace::lights::SHADOW_END;
use crate::trace::{
    BatchOptions, Contribution, PixelBatch, PixelGrouping, ReuseGroup, Scratch, Tracer,
};
use std::sync::Arc;

/// One surface point.
struct Point {
    p: V3,
    error: V3,
    ng: V3,
    frame: Frame,
    params: BrdfParams,
    /// Whether its specular lobe is weak.
    weak: bool,
}

impl Points {
    fn one(&self, tracer: &Tracer, at: usize) -> Point {
        Point {
            p: self.p.get(at).into(),
            error: self.error.get(at).into(),
            ng: self.ng.get(at).into(),
            frame: Frame::around(V3::from(self.ns.get(at))),
            params: tracer.tables.materials.params(self.material.0[at]),
            weak: tracer.tables.materials.is_weak(self.material.0[at]),
        }
    }
}

/// Whether `first` sees `second`, both on the sides that they are hit from.
fn sees(tracer: &Tracer, first: &Point, second: &Point, scratch: &mut Scratch) -> bool {
    let w = second.p - first.p;
    let faces = first.ng.dot(w) > 0.0 && first.frame.n.dot(w) > 0.0 && second.ng.dot(w) < 0.0;
    let o = offset_origin(first.p, first.error, first.ng, w);
    let d = offset_origin(second.p, second.error, second.ng, -w) - o;
    let ray = Ray { o, d };
    let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
    faces && !bvh.occluded(geometry, &ray, SHADOW_END, &mut scratch.stack)
}

/// A first and a reuse vertex: density by area, what is carried between them, and BRDF times cosine
/// and density of both directions.
type Pair = (f64, [f64; 3], [([f64; 3], f64); 2]);

/// What one group's paths receive, by the formula at the head of the module.
fn naive<M: Microfacet>(
    tracer: &Tracer,
    primary: &PrimaryVertices,
    reuse: &ReuseVertices,
    [base, end]: [usize; 2],
    sees: &dyn Fn(usize, usize) -> bool,
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; end - base];
    let wide = |c: Rgb| <[f32; 3]>::from(c).map(f64::from);
    for entry in 0..reuse.count {
        let slot = reuse.slot.0[entry] as usize;
        if !(base..end).contains(&slot) {
            continue;
        }
        let second = reuse.point.one(tracer, entry);
        let directions = [&reuse.light_dir, &reuse.bsdf_dir]
            .map(|d| (V3::from(d.wi.get(entry)), f64::from(d.pdf.0[entry])));
        let there = |i: usize| primary.there.0[i] != 0 && (i == slot || sees(i, entry));
        let towards = |i: usize| (second.p - primary.point.one(tracer, i).p).normalize();
        // Each viewer has a frame of his own there, and where that is another one the densities are
        // those of all: by the very numbers of the engine, for what is at the border is one or the other.
        let bends_for = |i: usize| {
            let back = primary.point.one(tracer, i).p - second.p;
            bent(second.ng, second.frame.n, back * (1.0 / back.length2()).sqrt()).1
        };
        let bends = second.frame.n != second.ng && (base..end).any(|i| there(i) && bends_for(i));
        // BRDF times cosine and density of both directions.
        let back = |wi: V3| {
            let frame = Frame::around(bent(second.ng, second.frame.n, -wi).0);
            directions.map(|(d, _)| {
                let d = frame.to_local(second.frame.to_world(d));
                if d.z <= 0.0 {
                    return ([0.0; 3], 0.0);
                }
                let e = second.params.eval::<M>(frame.to_local(-wi), d);
                (wide(e.f).map(|f| f * f64::from(d.z)), f64::from(e.pdf))
            })
        };
        // Of each path: density by area of finding the point, what it carries from there, and BRDF
        // and density of either direction.
        let of = |i: usize| {
            let first = primary.point.one(tracer, i);
            let wi = towards(i);
            let away = second.p - first.p;
            let geometry = f64::from(second.ng.dot(wi).abs()) / f64::from(away.length2());
            let local = first.frame.to_local(wi);
            let wo = first.frame.to_local(V3::from(primary.wo.get(i)));
            let e = first.params.eval::<M>(wo, local);
            let throughput = wide(e.f).map(|f| f * f64::from(local.z) * geometry);
            let pdf = first_pdf::<M>(tracer, primary, i, &first, wi);
            (f64::from(pdf) * geometry, throughput, back(wi))
        };
        let mut all: Vec<_> = (base..end).map(|i| there(i).then(|| of(i))).collect();
        // Of its own path all that was drawn is known, to more digits than can be found again.
        let first = primary.point.one(tracer, slot);
        let own = all[slot - base].as_mut().expect("it sees it");
        let pdf = first_pdf::<M>(tracer, primary, slot, &first, towards(slot));
        let geometry = own.0 / f64::from(pdf);
        own.0 = f64::from(primary.pdf.0[slot]) * geometry;
        own.1 = primary.beta.get(slot).map(|beta| f64::from(beta) * own.0);
        let own: Pair = *own;
        let some = || all.iter().flatten();
        let density: f64 = some().map(|s| s.0).sum();
        // Of a weak lobe the density with which its own path draws the direction.
        let mean = |which: usize| {
            if second.weak && !bends {
                return own.2[which].1;
            }
            some().map(|s| s.0 * s.2[which].1).sum::<f64>() / density
        };
        let [light, emitted, reflected] = [&reuse.light, &reuse.emitted, &reuse.reflected]
            .map(|light| light[slot].map(f64::from));
        let emitted_pdf = f64::from(reuse.emitted_pdf[slot]);
        let [light_dir, bsdf_dir] = directions;
        // What arrives by both directions, with these densities of sampling them.
        let sent = |back: &[([f64; 3], f64); 2], pdf: [f64; 2], c: usize| {
            let mut lo = 0.0;
            if light[c] > 0.0 {
                lo += back[0].0[c] * light[c] / (light_dir.1 + pdf[0]);
            }
            if bsdf_dir.1 > 0.0 {
                let way = emitted[c] / (emitted_pdf + pdf[1]) + reflected[c] / pdf[1];
                lo += back[1].0[c] * way;
            }
            lo
        };
        for c in 0..3 {
            for (sum, one) in sums.iter_mut().zip(&all) {
                let Some((_, throughput, back)) = one else { continue };
                sum[c] += throughput[c] * sent(back, [mean(0), mean(1)], c) / density;
            }
        }
    }
    for (i, sum) in (base..end).zip(&mut sums) {
        for (sum, throughput) in sum.iter_mut().zip(primary.throughput.get(i)) {
            *sum *= f64::from(throughput);
        }
    }
    sums
}

/// Density in 1/sr with which a path's primary vertex finds a direction that it carries anything from.
fn first_pdf<M: Microfacet>(
    tracer: &Tracer,
    primary: &PrimaryVertices,
    slot: usize,
    first: &Point,
    wi: V3,
) -> f32 {
    let wo = first.frame.to_local(V3::from(primary.wo.get(slot)));
    let e = first.params.eval::<M>(wo, first.frame.to_local(wi));
    let mut images = Vec::new();
    let chance = tracer.highlights.seen_from(first.p, first.frame.n, true, &mut images);
    match e.f.is_black() {
        true => 0.0,
        false => (1.0 - chance) * e.pdf + highlights::pdf(&images, wi),
    }
}

/// A batch after a pass by the engine, with what its paths received by sharing.
fn traced(tracer: &Tracer, pixel_batch: &PixelBatch, scratch: &mut Scratch) -> Vec<[f32; 3]> {
    tracer.sample_batch(pixel_batch, BatchOptions::of(3), scratch, &mut |_, _| {});
    scratch.batch.radiance.clone()
}

#[test]
fn every_group_gets_what_the_formula_says() {
    for (name, model, weak) in [
        ("cornell", Model::Ggx, false),
        ("plates", Model::Phong, false),
        ("shell", Model::Ggx, false),
        ("default", Model::Ggx, false),
        ("gallery", Model::Phong, false),
        ("shell", Model::Ggx, true),
        ("cornell", Model::Phong, true),
    ] {
        let mut scene = Example::named(name).unwrap().read().unwrap().0.build();
        for isa in Isa::available() {
            scene.set_isa(isa);
            let shared = Arc::new(scene);
            let size = [64, 48];
            let mut params = Params { size, model, ..Params::new(shared.clone()) };
            if weak {
                for material in Arc::make_mut(&mut params.materials) {
                    let dim = material.ks == [0.0; 3];
                    material.ks = if dim { material.kd.map(|kd| 0.05 * kd) } else { material.ks };
                    material.roughness = Roughness::from_alpha(0.3).unwrap();
                }
            }
            let tracer = params.tracer();
            let aiming = match model {
                Model::Ggx => compare::<Ggx>(&tracer, size),
                _ => compare::<Phong>(&tracer, size),
            };
            let polished = ["default", "gallery"].contains(&name);
            assert!(!polished || aiming > 100, "{name}: {aiming} aim at highlights");
            drop((params, tracer));
            scene = Arc::into_inner(shared).expect("nobody else holds it");
        }
    }
}

/// Returns how many of the primary vertices aim at highlights.
fn compare<M: Microfacet>(tracer: &Tracer, size: [u32; 2]) -> usize {
    let mut scratch = tracer.scratch();
    let mut visibility = tracer.scratch();
    let (mut lit, mut pairs, mut aiming) = (0, 0, 0);
    for group in ReuseGroup::ALL.into_iter().skip(1) {
        let grouping = PixelGrouping::new(size, 9, 3, group);
        let mut pixel_batch =
            PixelBatch { contribution: Contribution::Shared, ..PixelBatch::default() };
        grouping.batch([1, 1], &mut pixel_batch);
        let found = traced(tracer, &pixel_batch, &mut scratch);
        let PathBatch { primary, reuse, .. } = &*scratch.batch;
        let mut base = 0;
        for &end in &pixel_batch.ends {
            let end = end as usize;
            let entries: Vec<usize> = (0..reuse.count)
                .filter(|&e| (base..end).contains(&(reuse.slot.0[e] as usize)))
                .collect();
            for &entry in entries.iter().filter(|&&e| reuse.is_lit(reuse.slot.0[e] as usize)) {
                let second = reuse.point.one(tracer, entry);
                for i in (base..end).filter(|&i| primary.there.0[i] != 0) {
                    let own = i == reuse.slot.0[entry] as usize;
                    let first = primary.point.one(tracer, i);
                    // In one plane, as far as their errors tell, two points see each other by
                    // rounding, and carry nothing.
                    let (w, error) = (second.p - first.p, first.error + second.error);
                    let flat = |n: V3| n.dot(w).abs() <= 2.0 * n.abs().dot(error);
                    if flat(first.ng) || flat(second.ng) {
                        continue;
                    }
                    let truth = own || sees(tracer, &first, &second, &mut visibility);
                    let seen = reuse.seen[entry] >> (i - base) & 1 != 0;
                    assert_eq!(seen, truth, "pair of {i} and {entry}");
                    pairs += 1;
                }
            }
            for i in (base..end).filter(|&i| primary.there.0[i] != 0) {
                let first = primary.point.one(tracer, i);
                let (p, n) = (first.p, first.frame.n);
                let chance = tracer.highlights.seen_from(p, n, true, &mut Vec::new());
                aiming += usize::from(chance > 0.0);
            }
            let sees = |i: usize, entry: usize| reuse.seen[entry] >> (i - base) & 1 != 0;
            let truth = naive::<M>(tracer, primary, reuse, [base, end], &sees);
            for (i, truth) in (base..end).zip(truth) {
                for (x, truth) in found[i].into_iter().zip(truth) {
                    // Lobes are sharp: of a direction's rounding a thousandfold arrives at D.
                    let bound = 2e-3 * truth + 1e-6;
                    assert!((f64::from(x) - truth).abs() <= bound, "{i}: {x} is not {truth}");
                    lit += usize::from(truth > 0.0);
                }
            }
            base = end;
        }
    }
    assert!(lit > 1000 && pairs > 10_000, "{lit} {pairs}");
    aiming
}
