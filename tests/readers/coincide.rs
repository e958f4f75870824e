//! Shapes in the same place: the emitter is in front, or else the first in the file, and what is lost
//! of another material is told.

use super::{bare, text, warnings};
use burnish::scene::read::Memory;
use burnish::scene::{Scene, SceneCounts};

const MTL: &[u8] = b"newmtl floor\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n\
    newmtl back\nKd 0.3 0.3 0.3\n";

/// Reads an OBJ whose materials are those above: the scene, its warnings and its notes.
fn obj(faces: &str) -> (Scene, Vec<String>, Vec<String>) {
    let text = format!(
        "mtllib lamp.mtl\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nv -3 -3 0\nv 3 -3 0\nv 3 3 0\n\
         v -3 3 -0.0\n{faces}"
    );
    let files = Memory(&[("lamp.mtl", MTL)]);
    let (builder, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
    let told = warnings(&report);
    (builder.build(), told, report.notes)
}

/// Names of the materials of all triangles in the order of the file.
fn names(scene: &Scene) -> Vec<&str> {
    let faces = scene.geometry().faces().iter();
    faces.map(|face| scene.materials()[face.material as usize].name.as_str()).collect()
}

#[test]
fn a_lamp_in_the_place_of_another_face_shines_wherever_it_stands() {
    let told = |lost: &str, front: &str| {
        [format!(
            "m.obj:{lost}: 2 triangles of `back` (line {lost}) in the same place as of `lamp` \
             (line {front}): left out, for what emits is in front"
        )]
    };
    // The second face goes round the other way and begins elsewhere.
    let (scene, found, _) =
        obj("usemtl back\nf 3 2 1 4\nusemtl floor\nf 5 6 7 8\nusemtl lamp\nf 1 2 3 4\n");
    assert_eq!(found, told("10", "14"));
    assert_eq!(names(&scene), ["floor", "floor", "lamp", "lamp"]);
    assert_eq!(scene.counts().duplicates, 2);
    let (scene, found, _) = obj("usemtl lamp\nf 1 2 3 4\nusemtl back\nf 3 2 1 4\n");
    assert_eq!(found, told("12", "10"));
    assert_eq!(names(&scene), ["lamp"; 2]);
}

#[test]
fn of_faces_that_do_not_emit_the_first_stays() {
    let (scene, found, _) =
        obj("usemtl back\nf 1 2 3 4\nusemtl floor\nf 4 3 2\nf 5 6 7\nf 5 6 7\nf 7 6 5\nf 1 2 3\n");
    assert_eq!(
        found,
        ["m.obj:12: 1 triangle of `floor` (line 12) in the same place as of `back` (line 10): \
             left out, for the first in the file is in front"],
        "the other half is cut along the other diagonal: that is another triangle"
    );
    assert_eq!(names(&scene), ["back", "back", "floor", "floor"]);
    assert_eq!(scene.counts().duplicates, 3);
}

#[test]
fn what_is_lost_of_the_same_material_is_no_warning() {
    let (scene, found, _) = obj("usemtl floor\nf 5 6 7 8\nf 8 7 6 5\nf 5 6 7 8\n");
    // Fans from corners 5 and 8: one diagonal and the other.
    assert_eq!((found, scene.counts().triangles), (vec![], 4));
    assert_eq!(scene.counts().duplicates, 2);
}

fn scn(body: &str) -> (Scene, Vec<String>) {
    let head = "screen 8 8\ncamera 0 -6 1 0.4 x 85\nenvironment 0.1 0.1 0.1\n";
    let (builder, report) = text("s.scn", &format!("{head}{body}")).unwrap();
    let told = warnings(&report);
    (builder.build(), told)
}

#[test]
fn spheres_and_cylinders_that_coincide() {
    let (scene, told) =
        scn("# Wall\nbrdf 0.5 0.5 0.5 0 0 0 10\nsphere 0.25 0 -0.0 1\nsphere 3 0 0 1\n\
         cylinder 0.1 0.2 0.3 -0.0 0.4 1.1 0.5\nbox 0 0 0 1 1 1\n\
         # Lamp\nlight 5 5 5\nsphere 0.25 -0.0 0 1\nsphere 0.25 0 0 1.01\n\
         cylinder 0.1 0.6 1.4 0 -0.4 -1.1 0.5\nbox 1 1 1 -1 -1 -1\nsphere 0.25 0 0 1\n");
    let all = SceneCounts { triangles: 12, spheres: 3, cylinders: 1, duplicates: 14 + 1 };
    assert_eq!(scene.counts(), all);
    assert_eq!(
        told,
        ["s.scn:9: 12 triangles, 1 sphere, 1 cylinder of `Wall` (line 9) in the same place as of \
             `Lamp` (line 15): left out, for what emits is in front"]
    );
    let lit = scene.surfaces().iter();
    let lit = lit.filter(|s| scene.materials()[s.material as usize].emits()).count();
    assert_eq!(lit, 4, "a box, two spheres and a cylinder");
}

/// Random meshes, placed so that their doubles differ in the last digits of their coordinates.
#[test]
fn places_are_compared_as_the_tracer_has_them() {
    let leaf: &[u8] = include_bytes!("../data/leaf.ply");
    let files = Memory(&[("leaf.ply", leaf)]);
    let mut state = 7u64;
    let mut random = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1u32 << 24)
    };
    for _ in 0..30 {
        let turn = random() * 360.0;
        let [x, y, z] = [random() * 10.0, random() * 10.0, random()];
        let scene = format!(
            "brdf 0.5 0.5 0.5 0 0 0 10\nmesh leaf.ply {x} {y} {z} 0.7 z {turn}\nlight 1 1 1\n\
             mesh leaf.ply {x} {y} {z} 0.7 z {} z {}\n",
            turn - 100.0,
            100.0
        );
        let (builder, report) = bare(scene.as_bytes(), "s.scn", &files).unwrap();
        let scene = builder.build();
        assert_eq!(scene.counts().duplicates, 3, "{scene:?}");
        assert!(warnings(&report).iter().any(|w| w.starts_with("s.scn:2: 3 triangles of ")));
        assert!(names(&scene).iter().all(|name| name.starts_with("light")));
    }
}

#[test]
fn names_of_any_length_leave_lines_short() {
    let [first, second, third] = ["a", "b", "c"].map(|end| "\u{202e}".repeat(70) + end);
    let mtl = format!("newmtl {first}\nKd 1 0 0\nnewmtl {second}\nKd 0 1 0\n");
    let face = |name: &str| format!("usemtl {name}\nf 1 2 3\n");
    let faces = [&first, &second, &third].map(|name| face(name)).concat();
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let files = Memory(&[("m.mtl", mtl.as_bytes())]);
    let (_, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
    let found = warnings(&report);
    for told in ["in the same place as of", "no MTL file defines"] {
        let told = found.iter().find(|line| line.contains(told)).expect(told);
        assert!(told.len() < 500 && told.contains(r"\u{202e}") && told.contains('…'), "{told}");
    }
}
