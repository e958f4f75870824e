//! The whole renderer against scenes whose answer is known, and against itself at other sizes and
//! places.

use burnish::brdf::Model;
use burnish::measure::exact::{CaseBudget, CaseVerdict, all, drawn};
use burnish::progressive::{Params, Snapshot, render};
use burnish::scene::{Camera, Material, Mesh, Scene, SceneBuilder};
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The group is the id without its number.
fn group(id: &str) -> &str {
    id.split(|c: char| c.is_ascii_digit()).next().unwrap()
}

#[test]
fn each_of_the_139_scenes_is_asked_or_left_out_with_a_reason() {
    let table = all().unwrap();
    let asked: BTreeSet<&str> = table.cases.iter().map(|c| c.id.as_str()).collect();
    let left_out: BTreeSet<&str> = table.left_out.iter().map(|l| l.id.as_str()).collect();
    assert_eq!(table.scenes, 139);
    assert_eq!(asked.union(&left_out).count(), 139);
    // Ks = 0 with a lobe five times, the cavity without an answer and the one without an error.
    let wholly = left_out.difference(&asked).copied().collect::<Vec<_>>().join(" ");
    assert_eq!(wholly, "ball10 cavity6 cavity7 dome10_0.01 dome10_0.1 dome10_0.5 dome10_1");
    assert!(table.left_out.iter().all(|l| l.reason.len() > 20));
    let groups: BTreeSet<&str> = asked.iter().map(|id| group(id)).collect();
    assert_eq!(groups.len(), 14, "{groups:?}");
    // Every one can be built, with a seed of its own.
    let seeds: BTreeSet<u64> = table.cases.iter().map(|c| c.params().unwrap().seed).collect();
    assert_eq!(seeds.len(), table.cases.len());
}

/// The answers that have a closed form, once more from the parameters beside them.
#[test]
fn closed_forms_of_the_table_are_what_they_say() {
    let text = include_str!("../../assets/exact_scenes.json");
    let rows: Vec<serde_json::Value> = serde_json::from_str(text).unwrap();
    let mut checked = BTreeMap::new();
    for row in &rows {
        let name = row["group"].as_str().unwrap();
        let get = |key: &str| row[key].as_f64().unwrap();
        let pair = |key: &str| [0, 1].map(|i| row[key][i].as_f64().unwrap());
        for (quantity, value) in row["expected"].as_object().unwrap() {
            let truth = match (name, quantity.as_str()) {
                ("furnace", "radiance") => get("emission") / (1.0 - get("rho")),
                ("furnace", depth) => {
                    let depth: i32 = depth.strip_prefix("depth_").unwrap().parse().unwrap();
                    get("emission") * (0..=depth).map(|k| get("rho").powi(k)).sum::<f64>()
                }
                ("plane_disk", _) => {
                    let (r2, h2) = (get("radius").powi(2), get("height").powi(2));
                    get("rho") * get("radiance") * r2 / (r2 + h2)
                }
                ("plane_sphere", _) if get("beta_deg") <= 60.0 => {
                    let f = (get("radius") / get("distance")).powi(2);
                    get("rho") * get("radiance") * f * get("beta_deg").to_radians().cos()
                }
                ("concentric", which) => {
                    // inner = e1 + r1 outer; outer = e2 + r2 (q² inner + (1 - q²) outer)
                    let ([r1, e1], [r2, e2]) = (pair("inner"), pair("outer"));
                    let q2 = get("radius").powi(2);
                    let outer = (e2 + r2 * q2 * e1) / (1.0 - r2 * (1.0 - q2) - r2 * q2 * r1);
                    if which == "outer" { outer } else { e1 + r1 * outer }
                }
                ("integrating", which) => {
                    let rho = get("rho");
                    let wall = rho * get("fraction") * get("emission") / (1.0 - rho);
                    if which == "wall" { wall } else { wall + get("emission") }
                }
                _ => continue,
            };
            let value = value.as_f64().unwrap();
            assert!((value / truth - 1.0).abs() < 1e-12, "{}: {value}, not {truth}", row["id"]);
            *checked.entry(name).or_insert(0) += 1;
        }
    }
    let counts: Vec<_> = checked.into_iter().collect();
    let expected = [
        ("concentric", 6),
        ("furnace", 34),
        ("integrating", 6),
        ("plane_disk", 3),
        ("plane_sphere", 6),
    ];
    assert_eq!(counts, expected);
}

/// All scenes but the slowest, to 1 %. Outside four standard errors is chance once in 16,000; the
/// seeds are fixed.
#[test]
fn scenes_with_known_answers_come_out_as_known() {
    let mut table = all().unwrap();
    // These take about a million paths, or paths of a hundred bounces, for 1 %.
    let slow = ["furnace3 radiance", "integrating2", "cavity4"];
    table.cases.retain(|c| !slow.iter().any(|s| format!("{} {}", c.id, c.quantity).starts_with(s)));
    assert_eq!(table.cases.len(), 179);
    let mut wrong = Vec::new();
    let summary = table
        .run(CaseBudget::QUICK, &mut |o| {
            if o.verdict != CaseVerdict::Agrees {
                wrong.push(format!(
                    "{} {}: {} +- {}, not {} ({:?}, {:?})",
                    o.case.id,
                    o.case.quantity,
                    o.mean,
                    o.standard_error,
                    o.case.expected,
                    o.verdict,
                    o.counts
                ));
            }
        })
        .unwrap();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!((summary.cases, summary.failed, summary.unresolved), (179, 0, 0));
    // The standard errors are true: squares of n standard normal numbers have the mean 1, with a
    // deviation of sqrt(2 / n).
    let (n, square) = (summary.noisy as f64, summary.mean_square);
    assert!(n > 140.0 && (square - 1.0).abs() < 4.5 * (2.0 / n).sqrt(), "{square} over {n}");
}

/// The judge is not to be pleased by whatever comes.
#[test]
fn a_wrong_answer_is_told_apart() {
    let table = all().unwrap();
    for id in ["furnace1", "plane_rect0", "dome3_0.5", "mirror2", "plates1", "cavity0"] {
        let mut case = table.cases.iter().find(|c| c.id == id).unwrap().clone();
        assert_eq!(case.run(CaseBudget::QUICK).unwrap().verdict, CaseVerdict::Agrees);
        for factor in [0.97, 1.03] {
            let truth = case.expected;
            case.expected *= factor;
            assert_eq!(case.run(CaseBudget::QUICK).unwrap().verdict, CaseVerdict::Differs, "{id}");
            case.expected = truth;
        }
    }
}

/// The answers that are computed here are those of the table, which were computed by others: what
/// both say their errors are holds.
#[test]
fn answers_computed_here_are_those_of_the_table() {
    let table = all().unwrap();
    for case in &table.cases {
        let known = case.known().unwrap().unwrap();
        let off = (known.value - case.expected).abs();
        let bound = known.error + case.error + 1e-9 * case.expected;
        assert!(off <= bound, "{} {}: {known:?}, not {}", case.id, case.quantity, case.expected);
        // A tenth of what scenes are judged by.
        assert!(known.error < 1e-4 * known.value, "{} {}: {known:?}", case.id, case.quantity);
    }
}

/// The first of the cases of `check --full` that are drawn at random, four of each group, to 1 %.
#[test]
fn scenes_drawn_at_random_come_out_as_known() {
    let mut wrong = Vec::new();
    let table = drawn(0..56).unwrap();
    let summary = table
        .run(CaseBudget::QUICK, &mut |o| {
            if o.verdict != CaseVerdict::Agrees {
                wrong.push(format!(
                    "{} {}: {} +- {}, not {} ({:?}), {}",
                    o.case.id,
                    o.case.quantity,
                    o.mean,
                    o.standard_error,
                    o.case.expected,
                    o.verdict,
                    o.case.description()
                ));
            }
        })
        .unwrap();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(summary.cases, 56);
}

/// A lacquered floor, a metal ball and a rough post under a lamp, `scale` times as large and
/// `shift` of its sizes away.
fn still_life(scale: f64, shift: DVec3) -> Arc<Scene> {
    let at = |x: f64, y: f64, z: f64| (DVec3::new(x, y, z) + shift) * scale;
    let along = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale;
    let mut b = SceneBuilder::new("still life");
    let mut finish = |kd: f64, ks: f64, exponent: f64| {
        b.material(Material::reflecting("", [kd; 3], [ks; 3], exponent).unwrap())
    };
    let (floor, ball, post) =
        (finish(0.4, 0.1, 50.0), finish(0.0, 0.7, 400.0), finish(0.3, 0.4, 10.0));
    let emitter = b.material(Material::light("lamp", [4.0; 3]).unwrap());
    b.cuboid(at(-2.0, -2.0, 0.0), along(4.0, 4.0, 0.0), floor).unwrap();
    b.sphere(at(-0.4, 0.1, 0.5), 0.5 * scale, ball).unwrap();
    b.cylinder(at(0.7, 0.4, 0.0), along(0.1, 0.2, 0.9), 0.25 * scale, post).unwrap();
    let corner = |x: f64, y: f64| at(x, y, 1.8 + 0.2 * x);
    let mesh = Mesh {
        positions: vec![corner(-0.5, -0.6), corner(0.6, -0.6), corner(0.6, 0.3), corner(-0.5, 0.3)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    b.mesh(&mesh, DAffine3::IDENTITY, emitter).unwrap();
    b.environment = [0.1; 3];
    b.camera = Some(Camera::look_at(at(0.4, -3.0, 1.4), at(0.1, 0.0, 0.4), 0.35).unwrap());
    b.screen = [64, 48];
    Arc::new(b.build())
}

/// Means over blocks of eight by eight pixels and the variances of those, from the spread of
/// pictures: pixels of one picture share, so their errors are alike.
fn blocks(pictures: &[Snapshot]) -> Vec<(f64, f64)> {
    let count = pictures.len() as f64;
    let means: Vec<Vec<f64>> = pictures
        .iter()
        .map(|s| {
            let mut means = vec![0.0; 48];
            for (i, pixel) in s.mean().pixels.iter().enumerate() {
                let (x, y) = (i % 64, i / 64);
                means[y / 8 * 8 + x / 8] += pixel[0] as f64 / 64.0;
            }
            means
        })
        .collect();
    let of = |block: usize| {
        let mean = means.iter().map(|m| m[block]).sum::<f64>() / count;
        let squares: f64 = means.iter().map(|m| (m[block] - mean).powi(2)).sum();
        (mean, squares / (count * (count - 1.0)))
    };
    (0..48).map(of).collect()
}

#[test]
fn a_glossy_scene_is_the_same_at_any_size_and_place() {
    for model in Model::ALL {
        let picture = |scale: f64, shift: DVec3, seed: u64| {
            let scene = still_life(scale, shift);
            let pictures: Vec<Snapshot> = (0..16)
                .map(|i| {
                    let params =
                        Params { model, seed: 100 * seed + i, ..Params::new(scene.clone()) };
                    let s = render(params, 8, 0).unwrap();
                    assert_eq!((s.counts.nonfinite, s.counts.capped), (0, 0));
                    s
                })
                .collect();
            blocks(&pictures)
        };
        let here = picture(1.0, DVec3::ZERO, 1);
        let total = |blocks: &[(f64, f64)]| blocks.iter().map(|b| b.0).sum::<f64>();
        let far = DVec3::new(1.0, -0.7, 0.4) * 1e6;
        for (scale, shift) in
            [(1e-6, DVec3::ZERO), (1e6, DVec3::ZERO), (1.0, far), (1e6, far), (1e-6, -far)]
        {
            let there = picture(scale, shift, 2);
            let case = format!("{model:?}, scale {scale}, shift {shift}");
            let mut squares = 0.0;
            for (a, b) in here.iter().zip(&there) {
                let (off, variance) = (b.0 - a.0, a.1 + b.1);
                // The sky and the lamp have no noise.
                squares += if off == 0.0 { 0.0 } else { off * off / variance };
                // Some blocks are a fifth as bright as others, and have their noise.
                assert!(off.abs() < 0.1 * a.0, "{case}: a block of {} became {}", a.0, b.0);
            }
            // Squares of Student's number with 30 degrees of freedom: 1.07 on the mean, with a
            // deviation of 1.6; touching blocks share, so that 48 count for some twenty.
            assert!(squares / 48.0 < 1.07 + 4.5 * 1.6 / 20.0f64.sqrt(), "{case}: {squares}");
            let off = total(&there) / total(&here) - 1.0;
            assert!(off.abs() < 0.005, "{case}: the whole differs by {off:e}");
        }
    }
}
