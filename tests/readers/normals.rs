//! Normals: given ones are used, others are made, and the report says by which rule.

use super::{text, warnings};
use burnish::scene::Scene;

const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\n\
    v -1 1 1\n";
const FACES: &str = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn read(name: &str, file: &str) -> (Scene, Vec<String>) {
    let (builder, report) = text(name, file).unwrap();
    assert_eq!(warnings(&report), [""; 0]);
    (builder.build(), report.notes)
}

fn is_flat(scene: &Scene) -> bool {
    scene.geometry().vertices().iter().all(|v| v.normal == [0.0; 3])
}

#[test]
fn a_cube_of_shared_corners_is_flat_where_nothing_is_said() {
    let (scene, notes) = read("m.obj", &format!("{CUBE}{FACES}"));
    assert!(is_flat(&scene));
    let told = "normals: smooth over edges below 45 degrees for 12 triangles";
    assert!(notes.iter().any(|note| note == told), "{notes:?}");
    let mut ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
                   property float z\nelement face 6\nproperty list uchar int vertex_indices\n\
                   end_header\n"
        .to_owned();
    for line in CUBE.lines() {
        ply += &format!("{}\n", &line[2..]);
    }
    for line in FACES.lines() {
        let corners = line.split_whitespace().skip(1).map(|i| i.parse::<u32>().unwrap() - 1);
        let corners: Vec<String> = corners.map(|i| i.to_string()).collect();
        ply += &format!("4 {}\n", corners.join(" "));
    }
    let (scene, notes) = read("m.ply", &ply);
    assert!(is_flat(&scene));
    assert!(notes.iter().any(|note| note == told), "{notes:?}");
}

#[test]
fn given_normals_are_used_and_told() {
    let (scene, notes) = read("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\n");
    assert!(scene.geometry().vertices().iter().all(|v| v.normal == [0.0, 0.6, 0.8]));
    assert!(notes.iter().any(|note| note == "normals: given for 1 triangle"), "{notes:?}");
}

#[test]
fn what_an_obj_says_of_smoothing_is_done() {
    for (said, flat, told) in [
        ("s off", true, "flat (`s off`)"),
        ("s 0", true, "flat (`s off`)"),
        ("s 1", false, "smooth within groups (`s N`)"),
    ] {
        let (scene, notes) = read("m.obj", &format!("{CUBE}{said}\n{FACES}"));
        assert_eq!(is_flat(&scene), flat, "{said}");
        let told = format!("normals: {told} for 12 triangles");
        assert!(notes.contains(&told), "{notes:?}");
        assert_eq!(scene.geometry().vertices().len(), 8, "corners are shared");
    }
    // Two sides in one group, the others flat.
    let mixed = FACES.replacen("f", "s 3\nf", 1).replace("f 1 2 6 5", "s off\nf 1 2 6 5");
    let (scene, notes) = read("m.obj", &format!("{CUBE}{mixed}"));
    let told =
        "normals: smooth within groups (`s N`) for 4 triangles, flat (`s off`) for 8 triangles";
    assert!(notes.iter().any(|note| note == told), "{notes:?}");
    assert!(is_flat(&scene), "the two sides of the group have no corner in common");
}
