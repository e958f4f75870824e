//! The models beside the scenes, and the scene of many lights, are made by the programs in this folder.
//!
//! The test compares them with the files byte for byte, so neither can change without the other.
//! To write the files anew: `BURNISH_WRITE_ASSETS=1 cargo test --release --test house models`.

mod arithmetic;
mod knot;
mod lanterns;
mod letters;
mod model;
mod shell;
mod urchin;

use self::model::Model;
use std::path::PathBuf;

fn models() -> [(&'static str, Model); 5] {
    [
        ("knot.ply", knot::trefoil()),
        ("letter-x.ply", letters::x()),
        ("letter-y.ply", letters::y()),
        ("urchin.ply", urchin::urchin()),
        ("wentletrap.ply", shell::wentletrap()),
    ]
}

fn asset(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/scenes").join(name)
}

#[test]
fn files_are_what_their_programs_make() {
    let write = std::env::var_os("BURNISH_WRITE_ASSETS").is_some_and(|v| v == "1");
    let mut files = models().map(|(name, model)| (name, model.ply(name))).to_vec();
    files.push(("lights.scn", lanterns::lights().into_bytes()));
    for (name, made) in files {
        if write {
            std::fs::write(asset(name), &made).unwrap();
        }
        let held = std::fs::read(asset(name)).unwrap();
        let first = made.iter().zip(&held).position(|(a, b)| a != b);
        assert!(
            first.is_none() && made.len() == held.len(),
            "{name}: made {} bytes, the file has {}, first difference at {first:?}",
            made.len(),
            held.len()
        );
    }
}

#[test]
fn models_are_solid_and_face_outwards() {
    for (name, model) in models() {
        assert_eq!(model.open_edges(), 0, "{name} has edges without a neighbour");
        assert!(model.volume() > 0.0, "{name} is inside out: volume {}", model.volume());
    }
}

#[test]
fn letters_normals_agree_with_their_faces() {
    for (name, model) in [("X", letters::x()), ("Y", letters::y())] {
        let worst = model.least_agreement();
        // A quarter-round in four steps turns by 22.5 degrees a step: never more than that off.
        assert!(worst > 0.92, "{name}: a normal is {worst} (cosine) from its face");
    }
}

#[test]
fn the_shell_is_detailed_and_its_points_are_distinct() {
    let shell = shell::wentletrap();
    assert!((20_000..=60_000).contains(&shell.count()), "{} triangles", shell.count());
    assert_eq!(shell.flat_faces(), 0, "faces without area");
}

#[test]
fn the_knot_is_smooth_and_does_not_touch_itself() {
    let knot = knot::trefoil();
    assert!((20_000..=40_000).contains(&knot.count()), "{} triangles", knot.count());
    assert_eq!(knot.flat_faces(), 0, "faces without area");
    // Rings that are a quarter of the way or more from each other leave a gap.
    let rings: Vec<&[model::Point]> = knot.positions.chunks(40).collect();
    let near = |a: &model::Point, b: &model::Point| {
        let d = model::minus(*a, *b);
        model::dot(d, d).sqrt()
    };
    for (i, a) in rings.iter().enumerate() {
        for b in rings.iter().skip(i + 60).take(240) {
            let gap = a.iter().flat_map(|p| b.iter().map(move |q| near(p, q)));
            let gap = gap.fold(f64::INFINITY, f64::min);
            assert!(gap > 0.01, "ring {i}: {gap}");
        }
    }
}

#[test]
fn the_urchin_is_a_large_model() {
    let urchin = urchin::urchin();
    assert!((120_000..=140_000).contains(&urchin.count()), "{} triangles", urchin.count());
    assert_eq!(urchin.flat_faces(), 0, "faces without area");
}
