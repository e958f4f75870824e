//! Scenes drawn at random: the engine's pictures, as users get them, against the reference tracer's.

use burnish::math::simd::Isa;
use burnish::measure::random::{Budget, EmitterKind, RandomScene, Verdict, judge, run};
use burnish::scene::Scene;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Twenty of the scenes of `check --full`, four of each kind. A right program is found wrong in one
/// run of a million; the seeds are fixed.
#[test]
fn the_engine_agrees_with_the_reference_tracer() {
    let mut wrong = Vec::new();
    let summary = run(0..20, Budget::QUICK, &mut |o| {
        if o.verdict != Verdict::Agrees {
            wrong.push(format!(
                "seed {} {}: {:?} {:?}",
                o.seed,
                o.kind.name(),
                o.worst(),
                o.first()
            ));
        }
    })
    .unwrap();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!((summary.scenes, summary.nonfinite), (20, 0));
    assert!(summary.pooled_holds(), "{} +- {}", summary.pooled, summary.pooled_error);
    // A mean that hides the fault it looks for finds nothing.
    assert!(summary.pooled_error < 3e-3, "{}", summary.pooled_error);
}

/// What is drawn is what is wanted: every kind, scale, place, roughness, and instruction set.
#[test]
fn scenes_are_of_every_kind_size_and_place() {
    let scenes: Vec<RandomScene> = (0..100).map(|seed| RandomScene::draw(seed).unwrap()).collect();
    for kind in EmitterKind::ALL {
        assert_eq!(scenes.iter().filter(|s| s.kind == kind).count(), 20, "{kind:?}");
    }
    let of = |figure: &dyn Fn(&Scene) -> f64| {
        let mut all: Vec<f64> = scenes.iter().map(|s| figure(&s.params.scene)).collect();
        all.sort_by(f64::total_cmp);
        (all[0], all[99])
    };
    let size = |s: &Scene| (s.bounds()[1] - s.bounds()[0]).length();
    let (small, large) = of(&size);
    assert!(small < 1e-3 && large > 1e3, "{small} to {large}");
    let (near, far) = of(&|s| s.bounds()[0].length() / size(s));
    assert!(near < 2.0 && far > 1e4, "{near} to {far}");
    let alphas = |s: &RandomScene| {
        let all = s.params.scene.materials().iter().map(|m| m.roughness.alpha());
        all.collect::<Vec<_>>()
    };
    let alphas: Vec<f64> = scenes.iter().flat_map(alphas).collect();
    for (low, high) in [(1e-4, 1e-3), (1e-3, 1e-2), (1e-2, 0.1), (0.1, 1.0)] {
        let count = alphas.iter().filter(|a| (low..high).contains(*a)).count();
        assert!(count > 40, "{count} of {} from {low} to {high}", alphas.len());
    }
    let glows = |s: &&RandomScene| {
        let mut all = s.params.scene.materials().iter();
        all.any(|m| m.emits() && (m.kd[0] > 0.0 || m.ks[0] > 0.0))
    };
    assert!(scenes.iter().filter(glows).count() > 25);
    let has =
        |count: fn(&Scene) -> usize| scenes.iter().filter(|s| count(&s.params.scene) > 0).count();
    assert!(has(|s| s.counts().spheres) > 30 && has(|s| s.counts().cylinders) > 30);
    let sets: BTreeSet<&str> = scenes.iter().map(|s| s.isa.name()).collect();
    assert_eq!(sets.len(), Isa::available().len());
    let depths: BTreeSet<_> = scenes.iter().map(|s| s.params.max_depth).collect();
    assert!(depths.len() > 6, "{depths:?}");
    let groups: BTreeSet<_> = scenes.iter().map(|s| s.params.group).collect();
    assert_eq!(groups.len(), 6, "{groups:?}");
    // What a seed stands for does not change behind one's back.
    let again = RandomScene::draw(17).unwrap();
    assert_eq!(again.description, scenes[17].description);
}

/// The judge is not to be pleased by whatever comes: one surface a little darker is told.
#[test]
fn a_scene_that_was_changed_differs() {
    let mut found = 0;
    for seed in [3, 8, 13] {
        let mut scene = RandomScene::draw(seed).unwrap();
        for material in Arc::make_mut(&mut scene.reference.materials) {
            material.kd = material.kd.map(|c| 0.97 * c);
            material.ks = material.ks.map(|c| 0.97 * c);
        }
        found += usize::from(judge(&scene, Budget::QUICK).unwrap().verdict == Verdict::Differs);
    }
    assert_eq!(found, 3);
}
