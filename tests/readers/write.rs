//! Scenes written back as `.scn` text with their edits.

use crate::support::Random;
use burnish::brdf::Roughness;
use burnish::scene::builtin::EXAMPLES;
use burnish::scene::read::{Memory, open, parse_camera, read_scn};
use burnish::scene::write::{WriteError, scn};
use burnish::scene::{Camera, Material, Scene, SceneBuilder};
use glam::DVec3;
use std::fs;
use std::path::Path;

fn scene(text: &str) -> Scene {
    read_scn(text.as_bytes(), "test.scn".as_ref(), &Memory(&[])).unwrap().0.build()
}

/// Written without a change of size or camera.
fn with(scene: &Scene, materials: &[Material]) -> Result<String, WriteError> {
    scn(scene, materials, &scene.camera(), scene.screen(), "".as_ref())
}

fn reflecting(kd: [f64; 3], ks: [f64; 3], exponent: f64) -> Material {
    Material::reflecting("edited", kd, ks, exponent).unwrap()
}

/// Equal to the last bit, but for a roughness, which may be rounded.
fn assert_same_materials(read: &[Material], wanted: &[Material]) {
    assert_eq!(read.len(), wanted.len());
    for (read, wanted) in read.iter().zip(wanted) {
        assert_eq!((read.kd, read.ks), (wanted.kd, wanted.ks), "{}", wanted.name);
        assert_eq!(read.emission, wanted.emission, "{}", wanted.name);
        assert_eq!(read.name, wanted.name);
        if !wanted.emits() {
            let [a, b] = [read.roughness.alpha(), wanted.roughness.alpha()];
            assert!((a / b - 1.0).abs() < 2e-15 && a as f32 == b as f32, "{a} {b}");
        }
    }
}

/// Every number of every material somewhere else, within what it may be.
fn edited(materials: &[Material], random: &mut Random) -> Vec<Material> {
    let mut colour = || [(); 3].map(|()| random.within(0.0, 1.0));
    let mut edited = materials.to_vec();
    for material in &mut edited {
        let new = if material.emits() {
            Material::light("", colour().map(|c| 100.0 * c)).unwrap()
        } else {
            reflecting(colour(), colour(), 0.0)
        };
        *material = Material { name: material.name.clone(), ..new };
    }
    for material in edited.iter_mut().filter(|m| !m.emits()) {
        let alpha = 1e-4f64.powf(random.within(0.0, 1.0));
        material.roughness = Roughness::from_alpha(alpha).unwrap();
    }
    edited
}

#[test]
fn without_an_edit_a_scene_is_its_text() {
    for example in &EXAMPLES {
        let scene = example.read().unwrap().0.build();
        let text = scene.source().text.clone().unwrap();
        assert_eq!(with(&scene, scene.materials()).unwrap(), text, "{}", example.name);
    }
}

#[test]
fn shipped_scenes_come_back_with_all_their_edits_wherever_they_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.scn");
    let mut random = Random::new(5);
    for example in &EXAMPLES {
        let scene = example.read().unwrap().0.build();
        let materials = edited(scene.materials(), &mut random);
        let eye = DVec3::new(random.within(0.0, 1.0), -4.0, 1.0 / 3.0);
        let camera = Camera::look_at(eye, DVec3::ZERO, 0.31).unwrap();
        let text = scn(&scene, &materials, &camera, [333, 77], folder.path()).unwrap();
        fs::write(&path, &text).unwrap();
        let (builder, report) = open(&path).unwrap();
        assert_eq!(report.warnings, [], "{}", example.name);
        let back = builder.build();
        assert_same_materials(back.materials(), &materials);
        assert_eq!(back.camera(), camera);
        assert_eq!(back.screen(), [333, 77]);
        assert_eq!(back.counts(), scene.counts());
        assert_eq!(back.bounds(), scene.bounds());
        assert_eq!(back.environment(), scene.environment());
        assert_eq!(back.geometry().vertices(), scene.geometry().vertices());
        assert_eq!(back.geometry().faces(), scene.geometry().faces());
        // Only lines that say what was edited differ.
        let old = scene.source().text.clone().unwrap();
        assert_eq!(old.lines().count(), text.lines().count());
        for (old, new) in old.lines().zip(text.lines()) {
            let may = ["brdf", "light", "camera", "screen"].iter().any(|c| old.starts_with(c));
            assert!(may || old == new, "{old} became {new}");
        }
    }
}

/// One edit of one number in texts of every style: nothing else of the line changes.
#[test]
fn a_changed_number_is_all_that_changes() {
    let shape = "sphere 0 0 0 1";
    for (line, edit, expected) in [
        ("brdf 0.10 .2 0.3  0 0 0  7", 0, "brdf 0.75 .2 0.3  0 0 0  7"),
        (
            "\tbrdf\t0.10 .2\t0.3 0 0 0 7 0 0 0 1.5  ",
            1,
            "\tbrdf\t0.10 0.75\t0.3 0 0 0 7 0 0 0 1.5  ",
        ),
        ("brdf 1 1 1 1 1 1 1", 2, "brdf 1 1 0.75 1 1 1 1"),
        ("light 1e2 3.0, 2", 1, "light 1e2 0.75 2"),
    ] {
        for end in ["\n", "\r\n", "\r"] {
            let place = |line: &str| {
                ["# A é", line, shape, "", "screen 8 6", "environment 1 1 1"].join(end)
            };
            let scene = scene(&place(line));
            let mut materials = scene.materials().to_vec();
            let light = materials[0].emits();
            let colour = if light { &mut materials[0].emission } else { &mut materials[0].kd };
            colour[edit] = 0.75;
            assert_eq!(with(&scene, &materials).unwrap(), place(expected));
        }
    }
}

#[test]
fn roughness_is_written_as_a_short_exponent() {
    let text = "brdf .5 .5 .5 .2 .2 .2 10\nsphere 0 0 0 1\nenvironment 1 1 1\n";
    let scene = scene(text);
    for (alpha, exponent) in [(0.1, "198"), (1.0, "0"), (1e-4, "199999998"), (0.5, "6")] {
        let mut materials = scene.materials().to_vec();
        materials[0].roughness = Roughness::from_alpha(alpha).unwrap();
        let expected = text.replace(" 10\n", &format!(" {exponent}\n"));
        assert_eq!(with(&scene, &materials).unwrap(), expected);
    }
}

#[test]
fn what_the_text_does_not_say_is_added() {
    let text = "sphere 0 0 0 1\nenvironment 1 1 1";
    let scene = scene(text);
    let mut materials = scene.materials().to_vec();
    materials[0].kd = [0.25; 3];
    let camera = Camera::look_at(DVec3::new(0.0, -9.0, 0.0), DVec3::ZERO, 0.2).unwrap();
    let all = scn(&scene, &materials, &camera, [20, 10], "".as_ref()).unwrap();
    let expected = format!(
        "# default\nbrdf 0.25 0.25 0.25  1 1 1  1\n{text}\nscreen 20 10\n{}\n",
        camera.scn_line()
    );
    assert_eq!(all, expected);
    assert_same_materials(self::scene(&all).materials(), &materials);

    // A camera that frames the scene does so for one shape of picture: it has to be said.
    let wide = scn(&scene, scene.materials(), &scene.camera(), [900, 10], "".as_ref()).unwrap();
    assert_eq!(self::scene(&wide).camera(), scene.camera());
    assert_eq!(with(&scene, scene.materials()).unwrap(), text);
}

#[test]
fn of_several_cameras_the_last_counts_and_is_replaced() {
    let first = "camera 0 -9 0 0.2 x 90";
    let text = format!("{first}\nsphere 0 0 0 1\n  camera  1 -9 0 0.2 x 90\nenvironment 1 1 1\n");
    let scene = scene(&text);
    let camera = Camera::look_at(DVec3::new(3.0, -9.0, 0.0), DVec3::ZERO, 0.2).unwrap();
    let written = scn(&scene, scene.materials(), &camera, scene.screen(), "".as_ref()).unwrap();
    assert!(
        written.starts_with(first) && written.contains(&format!("\n  {}\n", camera.scn_line()))
    );
    assert_eq!(self::scene(&written).camera(), camera);
}

#[test]
fn surfaces_become_lights_and_lights_surfaces_but_not_both() {
    let text =
        "# One\nbrdf .5 .5 .5 0 0 0 1\nsphere 0 0 0 1\n# Two\n light 1 1 1\nsphere 3 0 0 1\n";
    let scene = scene(text);
    let name = |name: &str, m: Material| Material { name: name.into(), ..m };
    let light = name("One", Material::light("", [2.0, 3.0, 4.0]).unwrap());
    let clay = name("Two", reflecting([0.5; 3], [0.25; 3], 30.0));
    let written = with(&scene, &[light.clone(), clay.clone()]).unwrap();
    assert!(written.contains("# One\nlight 2 3 4\n") && written.contains("# Two\n brdf 0.5"));
    assert_same_materials(self::scene(&written).materials(), &[light.clone(), clay]);
    // A lamp that is switched off stays one, and so does a surface that is black.
    let off = name("Two", Material::light("", [0.0; 3]).unwrap());
    let black = name("One", reflecting([0.0; 3], [0.0; 3], 1.0));
    let written = with(&scene, &[black, off]).unwrap();
    assert!(written.contains("\n light 0 0 0\n") && written.contains("\nbrdf 0 0 0 0 0 0 1\n"));

    let both = Material { kd: [0.5; 3], ..light };
    let error = with(&scene, &[both, scene.materials()[1].clone()]).unwrap_err();
    assert_eq!(error, WriteError::Both("One".to_owned()));
}

const TRIANGLE: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
    end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn models_are_found_from_the_folder_that_is_written_to() {
    let folder = tempfile::tempdir().unwrap();
    let [here, there] = ["here", "there"].map(|name| folder.path().join(name));
    fs::create_dir_all(here.join("models")).unwrap();
    fs::create_dir(&there).unwrap();
    fs::write(here.join("models/t.ply"), TRIANGLE).unwrap();
    let text = "mesh models/t.ply 0 0 0 1\nmesh   models/t.ply  1 0 0 2 z 9\nenvironment 1 1 1\n";
    fs::write(here.join("a.scn"), text).unwrap();
    let scene = open(&here.join("a.scn")).unwrap().0.build();
    let write =
        |folder: &Path| scn(&scene, scene.materials(), &scene.camera(), scene.screen(), folder);
    assert_eq!(write(&here).unwrap(), text);
    fs::write(there.join("b.scn"), write(&there).unwrap()).unwrap();
    assert_eq!(open(&there.join("b.scn")).unwrap().0.build().counts(), scene.counts());

    let spaced = folder.path().join("a space");
    fs::rename(&here, &spaced).unwrap();
    let scene = open(&spaced.join("a.scn")).unwrap().0.build();
    let write =
        |folder: &Path| scn(&scene, scene.materials(), &scene.camera(), scene.screen(), folder);
    assert_eq!(write(&spaced).unwrap(), text);
    let error = write(&there).unwrap_err();
    assert!(matches!(&error, WriteError::Space(path) if path.ends_with("t.ply")), "{error}");
}

#[test]
fn a_model_alone_becomes_a_scene_if_one_material_is_all_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("t.ply"), TRIANGLE).unwrap();
    let scene = open(&at("t.ply")).unwrap().0.build();
    let red = Material { name: "grey".into(), ..reflecting([0.5, 0.0, 0.0], [0.1; 3], 55.0) };
    let camera = scene.camera();
    // After the model's own material come those of its stage.
    let materials = [&[red][..], &scene.materials()[1..]].concat();
    let text = scn(&scene, &materials, &camera, [40, 30], folder.path()).unwrap();
    fs::write(at("t.scn"), text).unwrap();
    let (builder, report) = open(&at("t.scn")).unwrap();
    assert_eq!(report.warnings, []);
    let back = builder.build();
    assert_same_materials(back.materials(), &materials);
    assert_eq!(back.camera(), camera);
    assert_eq!((back.counts(), back.environment()), (scene.counts(), scene.environment()));

    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n";
    fs::write(at("a.obj"), obj).unwrap();
    fs::write(at("a.mtl"), "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n").unwrap();
    let scene = open(&at("a.obj")).unwrap().0.build();
    assert_eq!(with(&scene, scene.materials()), Err(WriteError::OwnMaterials("a.obj".into())));
    let names: Vec<_> = scene.source().files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["a.obj", "a.mtl"]);

    let built = SceneBuilder::new("by calls").build();
    assert_eq!(with(&built, &[]), Err(WriteError::NoFile));
}

/// The digest is that of another program.
#[test]
fn files_are_known_by_their_sha_256() {
    let models = [("a.ply", TRIANGLE.as_bytes())];
    let text = b"mesh a.ply 0 0 0 1\nmesh a.ply 2 0 0 1\n";
    let files = read_scn(text, "/some/x.scn".as_ref(), &Memory(&models)).unwrap().0.source.files;
    let about: Vec<_> = files.iter().map(|file| (file.name.as_str(), file.bytes)).collect();
    assert_eq!(about, [("x.scn", 38), ("a.ply", TRIANGLE.len() as u64)]);
    let digest = "87a915a3ee5bad9d88ffe8305038c0838de13562c5ecf2c43ad351e742b9bd2a";
    assert_eq!(scene("environment 1 1 1\n").source().files[0].sha256, digest);
}

/// Ten thousand cameras, written and read: no bit is lost.
#[test]
fn a_camera_line_is_exact() {
    let mut random = Random::new(8);
    for _ in 0..10_000 {
        let [eye, target] = [(); 2].map(|()| DVec3::from_array(random.direction()));
        let camera = Camera::look_at(eye * random.within(0.1, 9.0), target, 0.3).unwrap();
        assert_eq!(parse_camera(&camera.scn_line()), Ok(camera));
    }
}
