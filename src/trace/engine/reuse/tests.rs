//! Held against the formulas themselves, one pair at a time, in double precision where it matters.

use super::super::Bundle;
use super::{Firsts, Points, Seconds};
use crate::brdf::{Ggx, Lobes, Microfacet, Model, Phong};
use crate::geometry::{Ray, bent, offset_origin};
use crate::math::lanes::Isa;
use crate::math::{Frame, Rgb, V3};
use crate::progressive::Params;
use crate::scene::builtin::Example;
use crate::trace::lights::SHADOW_END;
use crate::trace::{Deal, Group, Hand, Part, Round, Scratch, Tracer};
use std::sync::Arc;

/// One surface point.
struct Point {
    p: V3,
    error: V3,
    ng: V3,
    frame: Frame,
    lobes: Lobes,
}

impl Points {
    fn one(&self, tracer: &Tracer, at: usize) -> Point {
        Point {
            p: self.p.get(at).into(),
            error: self.error.get(at).into(),
            ng: self.ng.get(at).into(),
            frame: Frame::around(V3::from(self.ns.get(at))),
            lobes: tracer.tables.materials.lobes(self.material.0[at]),
        }
    }
}

/// Whether `first` sees `second`, both on the sides that they are met from.
fn sees(tracer: &Tracer, first: &Point, second: &Point, scratch: &mut Scratch) -> bool {
    let w = second.p - first.p;
    let faces = first.ng.dot(w) > 0.0 && first.frame.n.dot(w) > 0.0 && second.ng.dot(w) < 0.0;
    let o = offset_origin(first.p, first.error, first.ng, w);
    let d = offset_origin(second.p, second.error, second.ng, -w) - o;
    let ray = Ray { o, d };
    let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
    faces && !bvh.occluded(geometry, &ray, SHADOW_END, &mut scratch.stack)
}

/// What one group's paths receive, by the formula at the head of the module.
fn naive<M: Microfacet>(
    tracer: &Tracer,
    firsts: &Firsts,
    seconds: &Seconds,
    [base, end]: [usize; 2],
    sees: &dyn Fn(usize, usize) -> bool,
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; end - base];
    let wide = |c: Rgb| <[f32; 3]>::from(c).map(f64::from);
    for entry in 0..seconds.count {
        let slot = seconds.slot.0[entry] as usize;
        if !(base..end).contains(&slot) {
            continue;
        }
        let second = seconds.point.one(tracer, entry);
        let directions = [&seconds.asked, &seconds.sampled]
            .map(|d| (V3::from(d.wi.get(entry)), f64::from(d.pdf.0[entry])));
        // Of each path: density by area of finding the point, what it carries from there, and BRDF
        // and density of either direction.
        let of = |i: usize| {
            let seen = firsts.there.0[i] != 0 && (i == slot || sees(i, entry));
            seen.then(|| {
                let first = firsts.point.one(tracer, i);
                let away = second.p - first.p;
                let wi = away.normalize();
                let geometry = f64::from(second.ng.dot(wi).abs()) / f64::from(away.length2());
                let local = first.frame.to_local(wi);
                let wo = first.frame.to_local(V3::from(firsts.wo.get(i)));
                let e = first.lobes.eval::<M>(wo, local);
                let carried = wide(e.f).map(|f| f * f64::from(local.z) * geometry);
                // Each viewer has a frame of his own there.
                let frame = Frame::around(bent(second.ng, second.frame.n, -wi).0);
                let there = directions.map(|(d, _)| {
                    let d = frame.to_local(second.frame.to_world(d));
                    if d.z <= 0.0 {
                        return ([0.0; 3], 0.0);
                    }
                    let e = second.lobes.eval::<M>(frame.to_local(-wi), d);
                    (wide(e.f).map(|f| f * f64::from(d.z)), f64::from(e.pdf))
                });
                (f64::from(e.pdf) * geometry, carried, there)
            })
        };
        let all: Vec<_> = (base..end).map(of).collect();
        let some = || all.iter().flatten();
        let shared = |which: usize| some().map(|s| s.0 * s.2[which].1).sum::<f64>();
        let density: f64 = some().map(|s| s.0).sum();
        let [light, emitted, reflected] = [&seconds.light, &seconds.emitted, &seconds.reflected]
            .map(|light| light[slot].map(f64::from));
        let emitted_pdf = f64::from(seconds.emitted_pdf[slot]);
        let [asked, sampled] = directions;
        for (sum, one) in sums.iter_mut().zip(&all) {
            let Some((_, carried, there)) = one else { continue };
            for c in 0..3 {
                let mut lo = 0.0;
                if light[c] > 0.0 {
                    let by = density * asked.1 + shared(0);
                    lo += there[0].0[c] * light[c] / by;
                }
                if sampled.1 > 0.0 {
                    let by = density * emitted_pdf + shared(1);
                    lo += there[1].0[c] * (emitted[c] / by + reflected[c] / shared(1));
                }
                sum[c] += carried[c] * lo;
            }
        }
    }
    sums
}

/// A bundle after a pass by the engine, with what its paths received by sharing.
fn traced<M: Microfacet>(tracer: &Tracer, hand: &Hand, scratch: &mut Scratch) -> Vec<[f32; 3]> {
    tracer.sample_hand::<M>(hand, Round::of(3), scratch, &mut |_, _| {});
    scratch.bundle.radiance.clone()
}

#[test]
fn every_group_gets_what_the_formula_says() {
    for (name, model) in
        [("cornell", Model::Ggx), ("plates", Model::Phong), ("default", Model::Ggx)]
    {
        let mut scene = Example::named(name).unwrap().read().unwrap().0.build();
        for isa in Isa::available() {
            scene.set_isa(isa);
            let shared = Arc::new(scene);
            let size = [64, 48];
            let params = Params { size, model, ..Params::new(shared.clone()) };
            let tracer = params.tracer();
            match model {
                Model::Ggx => compare::<Ggx>(&tracer, size),
                _ => compare::<Phong>(&tracer, size),
            }
            drop((params, tracer));
            scene = Arc::into_inner(shared).expect("nobody else holds it");
        }
    }
}

fn compare<M: Microfacet>(tracer: &Tracer, size: [u32; 2]) {
    let mut scratch = tracer.scratch();
    let mut visibility = tracer.scratch();
    let (mut lit, mut pairs) = (0, 0);
    for group in Group::ALL.into_iter().skip(1) {
        let deal = Deal::new(size, 9, 3, group);
        let mut hand = Hand { part: Part::Shared, ..Hand::default() };
        deal.bundle([1, 1], &mut hand);
        let found = traced::<M>(tracer, &hand, &mut scratch);
        let Bundle { firsts, seconds, .. } = &*scratch.bundle;
        let mut base = 0;
        for &end in &hand.ends {
            let end = end as usize;
            let entries: Vec<usize> = (0..seconds.count)
                .filter(|&e| (base..end).contains(&(seconds.slot.0[e] as usize)))
                .collect();
            for &entry in entries.iter().filter(|&&e| seconds.is_lit(seconds.slot.0[e] as usize)) {
                let second = seconds.point.one(tracer, entry);
                for i in (base..end).filter(|&i| firsts.there.0[i] != 0) {
                    let own = i == seconds.slot.0[entry] as usize;
                    let first = firsts.point.one(tracer, i);
                    // In one plane, as far as their errors tell, two points see each other by
                    // rounding, and carry nothing.
                    let (w, error) = (second.p - first.p, first.error + second.error);
                    let flat = |n: V3| n.dot(w).abs() <= 2.0 * n.abs().dot(error);
                    if flat(first.ng) || flat(second.ng) {
                        continue;
                    }
                    let truth = own || sees(tracer, &first, &second, &mut visibility);
                    let seen = seconds.seen[entry] >> (i - base) & 1 != 0;
                    assert_eq!(seen, truth, "pair of {i} and {entry}");
                    pairs += 1;
                }
            }
            let sees = |i: usize, entry: usize| seconds.seen[entry] >> (i - base) & 1 != 0;
            let truth = naive::<M>(tracer, firsts, seconds, [base, end], &sees);
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
}
