//! A model opened by itself: which side is up, and what it stands on.

use super::{Read, triangles, warnings};
use burnish::scene::read::{self, Memory, ReadOptions};
use burnish::scene::write::scn;
use burnish::scene::{Axis, ModelStage, SceneBuilder};
use glam::DVec3;

/// A pyramid of base 2x2 and height 3, its tip along this axis of the file.
fn pyramid(tip: Axis) -> String {
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let back = tip.rotation().inverse();
    let point = |p: [f64; 3]| {
        let p = (back * DVec3::from_array(p)).round();
        format!("v {} {} {}\n", p.x, p.y, p.z)
    };
    let vertices: String = corners.into_iter().chain([[0.0, 0.0, 3.0]]).map(point).collect();
    vertices + "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
}

fn obj(text: &str, up: Option<Axis>) -> Read {
    let options = ReadOptions { up, bare: false };
    read::read_with_options(text.as_bytes(), "m.obj".as_ref(), &Memory(&[]), options)
}

/// The height of the model alone.
fn height(builder: SceneBuilder) -> f64 {
    let [low, high] = builder.build().focus();
    high.z - low.z
}

#[test]
fn a_model_stands_on_its_foot_and_the_report_says_so() {
    for (tip, why) in [(Axis::Y, "the custom of such files"), (Axis::Z, "its larger foot")] {
        let (builder, mut report) = obj(&pyramid(tip), None).unwrap();
        assert_eq!((builder.source.up, warnings(&report)), (Some(tip), vec![]));
        // Its base and the ground are two surfaces.
        builder.clone().build().report(&mut report);
        assert!(!report.notes.iter().any(|note| note.contains("share a place")), "{report:?}");
        let note = format!("its axis {} points up, by {why}; another can be chosen", tip.name());
        assert!(report.notes.contains(&note), "{:?}", report.notes);
        assert!((height(builder) - 3.0).abs() < 1e-12, "{tip:?}");
    }
}

#[test]
fn every_axis_can_be_chosen_to_point_up() {
    for tip in Axis::ALL {
        for up in Axis::ALL {
            let (builder, report) = obj(&pyramid(tip), Some(up)).unwrap();
            assert_eq!(builder.source.up, Some(up));
            assert!(!report.notes.iter().any(|note| note.contains("points up")));
            let along = up.name().trim_start_matches('-') == tip.name().trim_start_matches('-');
            let expected = if along { 3.0 } else { 2.0 };
            let scene = builder.build();
            let [low, high] = scene.focus();
            assert!((high.z - low.z - expected).abs() < 1e-12, "{tip:?} {up:?}");
            // The tip is above where the axis is its own, below where it is the opposite.
            let corner = |z: f64| {
                let all = triangles(&scene).into_iter().take(6).flatten();
                all.filter(|p| (p.z - z).abs() < 1e-3).count()
            };
            assert!(up != tip || corner(high.z) < corner(low.z), "{tip:?} {up:?}");
            assert!(!along || up == tip || corner(high.z) > corner(low.z), "{tip:?} {up:?}");
        }
    }
}

#[test]
fn a_model_without_lights_is_put_on_a_stage() {
    let (builder, report) = read::open("tests/data/leaf.ply".as_ref()).unwrap();
    assert_eq!(warnings(&report), [""; 0]);
    let notes = &report.notes;
    assert!(notes.iter().any(|n| n == "nothing in the file emits: put on a stage with two lights"));
    assert!(builder.camera.is_some());
    let own = &builder.materials()[0];
    assert!(own.ks.iter().all(|&ks| ks > 0.0), "glossy, so that models and roughness act: {own:?}");
    let scene = builder.build();
    let counts = scene.counts();
    assert_eq!((counts.triangles, counts.spheres, counts.cylinders), (3, 2, 1));
    let lights = scene.materials().iter().filter(|m| m.emits()).count();
    assert_eq!((scene.materials().len(), lights), (1 + ModelStage::MATERIALS, 2));
    let ([low, high], [all_low, all_high]) = (scene.focus(), scene.bounds());
    assert!(all_low.cmplt(low).all() && high.cmplt(all_high).all());
    let stage = scene.stage().unwrap();
    // What the camera sees in the middle of the picture is the model, at its foot the ground.
    let seen = |pixel| scene.pick(&scene.camera(), [640, 480], pixel);
    assert_eq!(seen([320.0, 475.0]), Some(1));
    assert_eq!((stage.floor, stage.centre), (low.z, (low + high) * 0.5));
    assert!((0..480).any(|y| seen([320.0, y as f32]) == Some(0)));
    // The picture has no sky in it: ground as far as one sees.
    assert!([[1.0, 1.0], [639.0, 1.0]].into_iter().all(|p| seen(p).is_some()));
}

#[test]
fn a_model_with_lights_is_turned_and_nothing_else() {
    let (builder, report) = read::open("tests/data/lamp.obj".as_ref()).unwrap();
    assert!(report.notes.iter().all(|note| !note.contains("stage")), "{:?}", report.notes);
    assert!(builder.camera.is_none() && builder.source.up.is_some());
    let scene = builder.build();
    assert_eq!((scene.stage(), scene.counts().triangles), (None, 6));
    assert_eq!(scene.focus(), scene.bounds());
}

#[test]
fn a_scene_is_z_up_whatever_is_asked() {
    let text = "light 1 1 1\nsphere 0 0 5 1\n";
    let read = |up| {
        let options = ReadOptions { up, bare: false };
        read::read_with_options(text.as_bytes(), "a.scn".as_ref(), &Memory(&[]), options).unwrap()
    };
    let (asked, plain) = (read(Some(Axis::X)), read(None));
    assert_eq!((asked.0.source.up, asked.1), (None, plain.1));
    assert_eq!(asked.0.build().bounds(), plain.0.build().bounds());
}

/// Where no stage can be, there is light all the same.
#[test]
fn a_model_too_large_for_a_stage_is_lit() {
    let huge = "v -9e17 0 0\nv 9e17 0 0\nv 0 9e17 0\nf 1 2 3\n";
    let (builder, report) = obj(huge, None).unwrap();
    assert_eq!((builder.environment, builder.shapes()), ([1.0; 3], 1));
    let white = "nothing in the file emits: lit by a uniform white environment of radiance 1";
    assert!(report.notes.iter().any(|note| note == white), "{:?}", report.notes);
}

#[test]
fn a_stage_is_written_down_with_its_model() {
    let folder = tempfile::tempdir().unwrap();
    for tip in [Axis::Y, Axis::NegX, Axis::Z] {
        let path = folder.path().join("p.obj");
        std::fs::write(&path, pyramid(tip)).unwrap();
        let options = ReadOptions { up: Some(tip), bare: false };
        let files = read::Disk::beside(&path);
        let scene = read::open_with_options(&path, &files, options).unwrap().0.build();
        let (materials, camera) = (scene.materials(), scene.camera());
        let text = scn(&scene, materials, &camera, scene.screen(), folder.path()).unwrap();
        let written = folder.path().join("p.scn");
        std::fs::write(&written, text).unwrap();
        let (builder, report) = read::open(&written).unwrap();
        assert_eq!(warnings(&report), [""; 0]);
        let back = builder.build();
        assert_eq!(back.counts(), scene.counts());
        assert_eq!((back.bounds(), back.camera()), (scene.bounds(), camera));
        assert_eq!(triangles(&back), triangles(&scene));
        assert_eq!(back.environment(), scene.environment());
        let colours = |s: &burnish::scene::Scene| -> Vec<_> {
            s.materials().iter().map(|m| (m.name.clone(), m.kd, m.ks, m.emission)).collect()
        };
        assert_eq!(colours(&back), colours(&scene));
    }
}
