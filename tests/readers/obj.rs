//! OBJ: its geometry.

use super::mtl::only_material;
use super::{Read, message, open_bare, text, triangles, warnings};
use glam::DVec3;

pub(super) const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

pub(super) fn obj(lines: &str) -> Read {
    text("m.obj", lines)
}

#[test]
fn a_lamp_with_materials_and_lights() {
    let (builder, report) = open_bare("tests/data/lamp.obj".as_ref()).unwrap();
    let mtl = "tests/data/lamp.mtl";
    assert_eq!(
        warnings(&report),
        [
            "tests/data/lamp.obj:21: `l` is not supported and left out".to_owned(),
            format!("{mtl}:8: `map_Kd` is not supported and left out (2 lines)"),
            format!("{mtl}:12: transparency (`d`) is not supported and left out"),
            format!("{mtl}:17: `illum` other than 0, 1 and 2 is not supported and left out"),
        ]
    );
    assert_eq!(report.notes, ["normals: smooth over edges below 45 degrees for 6 triangles"]);
    let [brass, paper, glow] = builder.materials() else { panic!("three materials") };
    assert_eq!(
        (brass.name.as_str(), brass.kd, brass.ks),
        ("brass", [0.2, 0.1, 0.05], [0.9, 0.7, 0.3])
    );
    assert_eq!(brass.roughness.exponent(), 250.0);
    assert_eq!((paper.kd, paper.ks, paper.emits()), ([0.7; 3], [0.0; 3], false));
    // A surface that emits still reflects.
    assert_eq!((glow.kd, glow.emission), ([0.1; 3], [10.0, 8.0, 6.0]));
    assert_eq!((builder.camera, builder.screen), (None, [640, 480]));
    assert_eq!((builder.environment, builder.is_lit()), ([0.0; 3], true));

    let scene = builder.build();
    assert_eq!(scene.counts().triangles, 6);
    // Both bulbs are faces of one object and material, though others stand between them.
    let counts: Vec<u32> = scene.surfaces().iter().map(|s| s.shape.count).collect();
    assert_eq!(counts, [2, 2, 2]);
    // The weight of the tip is joined from two lines.
    assert_eq!(scene.bounds()[1], DVec3::new(1.0, 1.0, 2.0));
}

#[test]
fn a_bare_model_that_emits_nothing_is_lit_by_a_white_environment() {
    let (builder, report) = obj(TRIANGLE).unwrap();
    assert_eq!((builder.environment, warnings(&report)), ([1.0; 3], vec![]));
    assert_eq!(
        report.notes,
        [
            "some faces have no material: a glossy grey of Kd 0.3, Ks 0.2, alpha 0.25 is used",
            "normals: smooth over edges below 45 degrees for 1 triangle",
            "nothing in the file emits: lit by a uniform white environment of radiance 1",
        ]
    );
    let grey = only_material(&builder);
    assert_eq!((grey.kd, grey.ks), ([0.3; 3], [0.2; 3]));
}

#[test]
fn each_obj_error_names_the_line() {
    let numbers = "expected three numbers, `v x y z`";
    for (lines, expected) in [
        ("v 0 0\n", format!("m.obj:5: {numbers}")),
        ("v 0 0 0,5\n", format!("m.obj:5: {numbers}, not `0,5`")),
        ("f 1 2 0", "m.obj:5: f: a vertex index counts from 1, not 0".into()),
        (
            "f 1 2 4\n\nf 1 2 9\nf 1 2 3",
            "m.obj:7: f: expected a vertex index from 1 to 3, not 9".into(),
        ),
        ("f -1 -2 -4", "m.obj:5: f: the vertex index -4 points before the first of 3".into()),
        ("f 1 2 a", "m.obj:5: f: expected a vertex index, not `a`".into()),
        ("f 1 2 //1", "m.obj:5: f: expected a vertex index, not ``".into()),
        (
            "f 1 2 99999999999999999999",
            "m.obj:5: f: expected a vertex index, not `99999999999999999999`".into(),
        ),
    ] {
        assert_eq!(message(obj(&format!("{TRIANGLE}{lines}"))), expected, "{lines}");
    }
    assert_eq!(message(obj("\n\u{1}\0\0")), "m.obj:2: expected text, found a zero byte");
    assert_eq!(message(obj("")), "m.obj: the file is empty");
    for lines in ["# nothing", "v 0 0 0\nv 1 0 0\nv 0 1 0", "v 0 0 0\nf 1\nf 1 1", "hello\nworld"] {
        assert_eq!(
            message(obj(lines)),
            "m.obj: the file has no faces, so there is nothing to show"
        );
    }
    assert_eq!(
        message(obj("v 0 0 0\nf 1 1 1")),
        "m.obj: nothing is left to show: 1 of 1 triangles are left out: 1 without area"
    );
}

#[test]
fn syntax_that_other_programs_write() {
    for lines in [
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        "\u{feff}v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -3 -2 -1\r\n",
        "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        "v\t0\t0\t0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf\t1/1\t2/1/\t3/1",
        "# C:\\\nv 0 0 0\nv 1 0 0\nv 0 \\\n 1 0\nf 1 \\\n2 \\\n3",
        "v 0 0 0 1\nv 2 0 0 2\nv 0 1 0\ns off\nf 1 2 3",
        "V 0 0 0\nV 1 0 0\nV 0 1 0\nF 1 2 3",
        "v 0 0 0\n\u{feff}v 1 0 0\nv 0 1 0\nf 1 2 3",
    ] {
        let (builder, report) = obj(lines).unwrap();
        assert_eq!(warnings(&report), [""; 0], "{lines}");
        let expected = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
        assert_eq!(triangles(&builder.build()), expected, "{lines}");
    }
    for (lines, warning) in [
        ("v 5 5 5 1 0 0\n", "m.obj:5: a colour of a vertex is not supported and left out"),
        ("p 1\nl 1 2\np 2\n", "m.obj:5: `p` is not supported and left out (2 lines)"),
        ("f 1 2\nf 1\nf", "m.obj:5: f: a face of fewer than three corners is left out (3 faces)"),
        (
            "v 0 0 0 0\nv 1 1 1 inf\nv 1 1 1 nan\nv 1 1 1 red\n",
            "m.obj:5: v: expected a weight other than 0, not `0`: none is used (4 lines)",
        ),
        ("vt 0 0\u{1a}\0\0", "m.obj: 3 bytes after the text are not used"),
        (
            "v 0 0 0\\\nv 1 1 1\n",
            "m.obj:5: the backslash at the end of this line continues nothing",
        ),
    ] {
        let (builder, report) = obj(&format!("{TRIANGLE}{lines}")).unwrap();
        assert_eq!((warnings(&report)[0].as_str(), builder.shapes()), (warning, 1));
    }
}

fn area(scene: &burnish::scene::Scene) -> f64 {
    triangles(scene).iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum()
}

/// An L of area 3 from any first corner, either way round, with indices of every kind, faces before
/// vertices, normals or not, in a plane or hardly.
#[test]
fn concave_polygons_are_cut_by_their_shape() {
    let corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    for first in 0..6 {
        for lift in [0.0, 0.01] {
            let mut vertices = String::new();
            for i in 0..6 {
                let [x, y] = corners[(first + i) % 6];
                vertices += &format!("v {x} {y} {}\n", lift * (i % 2) as f64);
            }
            for faces in [
                "f 1 2 3 4 5 6",
                "f 6 5 4 3 2 1",
                "f -6 -5 -4 -3 -2 -1",
                "vn 0 0 1\nvt 0 0\nf 1/1/1 2/1/1 3/1/1 4/1/1 5/1/1 6/1/1",
                "f 1// 2/ 3 4 5 6",
            ] {
                let (builder, report) = obj(&format!("{vertices}{faces}\n")).unwrap();
                assert_eq!(warnings(&report), [""; 0]);
                let found = area(&builder.build());
                assert!((found - 3.0).abs() < 0.1 * lift + 1e-6, "{first} {faces}: {found}");
            }
            let (builder, _) = obj(&format!("f 1 2 3 4 5 6\n{vertices}")).unwrap();
            assert!((area(&builder.build()) - 3.0).abs() < 0.1 * lift + 1e-6);
        }
    }
    // Weights divide before the outline is looked at.
    let weighted = "v 0 0 0\nv 4 0 0 2\nv 2 1 0\nv 3 3 0 3\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n";
    assert!((area(&obj(weighted).unwrap().0.build()) - 3.0).abs() < 1e-6);
}

#[test]
fn polygons_that_cross_themselves_are_counted() {
    let text = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 3 2 4\nf 1 2 3 4\nf 4 3 2 1\n";
    let (builder, report) = obj(text).unwrap();
    let counts = builder.build().counts();
    assert!(counts.triangles + counts.duplicates >= 4);
    assert_eq!(
        warnings(&report),
        ["m.obj:6: f: the outline of this polygon crosses itself: its triangles may overlap or \
          leave gaps (2 polygons)"]
    );
}

#[test]
fn convex_polygons_become_fans() {
    let corners: String = (0..1000).map(|i| format!("v {} {} 0\n", i, i * i)).collect();
    let face: String = (1..=1000).map(|i| format!(" {i}")).collect();
    let scene = obj(&format!("{corners}f{face}\n")).unwrap().0.build();
    assert_eq!(scene.counts().triangles, 998);
    let first = triangles(&scene)[0][0];
    assert!(triangles(&scene).iter().all(|t| t[0] == first));
}

#[test]
fn normals_are_smooth_across_parts_and_flat_where_they_are_missing() {
    let roof = "v 0 0 0.3\nv 0 1 0.3\nv 1 0 0\nv 1 1 0\nv -1 0 0\nv -1 1 0\nvt 0 0\nvt 1 1\n";
    let normals = |faces: &str| {
        let (builder, report) = obj(&format!("{roof}{faces}")).unwrap();
        let scene = builder.build();
        let geometry = scene.geometry();
        let of_corner = |i: u32| geometry.vertices()[i as usize].normal;
        let all: Vec<[f32; 3]> =
            geometry.faces().iter().flat_map(|face| face.vertices).map(of_corner).collect();
        (all, warnings(&report))
    };
    // The ridge is shared and not sharp: two objects, two materials and a texture seam do not cut it.
    let (smooth, _) = normals("o a\nf 1/1 3/1 4/1 2/1\no b\nusemtl other\nf 1/2 2/2 6/2 5/2");
    let up = |n: &[f32; 3]| n[0].abs() < 1e-6 && n[1].abs() < 1e-6;
    assert_eq!(smooth.iter().filter(|n| up(n)).count(), 6, "{smooth:?}");
    // Given normals count, and corners without one use the face's, which is written as zero.
    let (mixed, said) = normals("vn 0 0 2\nf 1//1 3//1 4\nf 1 4 2");
    assert_eq!(mixed.iter().filter(|n| **n == [0.0, 0.0, 1.0]).count(), 2, "{mixed:?}");
    assert_eq!(mixed.iter().filter(|n| **n == [0.0; 3]).count(), 4, "{mixed:?}");
    assert_eq!(
        said,
        ["m.obj: the normal of 3 vertices is zero or not finite: that of the face is used"]
    );
}

/// `#` begins a comment on every statement, with a blank before it or, behind numbers, without.
#[test]
fn comments_may_follow_every_statement() {
    for lines in [
        "v 0 0 0 # corner A\nv 1 0 0 #B\nv 0 1 0\t# C\nf 1 2 3 # all",
        "v 0 0 0#1\nv 1 0 0#2\nv 0 1 0 #\nf 1 2 3#end",
        "v 0 0 0 1 # no colour 1 2\nv 1 0 0\nv 0 1 0\ns off # flat\nf 1/1 2/1 3/1 # f 4 5 6",
        "v 0 0 0 # C:\\\nv 1 0 0\nv 0 1 0\nf 1 2 \\ # goes on\n3 # here",
        "g a # group\no b # object\nvt 0 0 # texture\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n#end",
    ] {
        let (builder, report) = obj(lines).unwrap();
        assert_eq!(warnings(&report), [""; 0], "{lines}");
        let expected = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
        assert_eq!(triangles(&builder.build()), expected, "{lines}");
    }
}

fn corner_normals(builder: burnish::scene::SceneBuilder) -> Vec<[f32; 3]> {
    let scene = builder.build();
    let geometry = scene.geometry();
    let of_corner = |i: u32| geometry.vertices()[i as usize].normal;
    geometry.faces().iter().flat_map(|face| face.vertices).map(of_corner).collect()
}

/// Normals that are named and not there: the face's own, which is written as zero, and counted.
#[test]
fn normals_that_are_not_there_are_the_face_s() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 1 1\n";
    let told = "f: a corner names a normal that is not there: the face's own is used";
    for (faces, missing, line) in [
        ("f 1/1/0 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/0", vec![0, 5], 6),
        ("f 1//0 2//0 3//0\nf 1//0 3//0 4//0", vec![0, 1, 2, 3, 4, 5], 6),
        ("f 1//1 2//1 3//1\n\nf 1//2 3//-2 4//99999999999999999999", vec![3, 4, 5], 8),
        ("f 1//1 2//1 3//1\nf 1//x 3//-9223372036854775808 4//1", vec![3, 4], 7),
        ("f 1//9223372036854775807 2//6148914691236517206 3//1\nf 1//1 3//1 4//1", vec![0, 1], 6),
        ("f 1//0 2//-0 3//1 4//1", vec![0, 1, 3], 6),
    ] {
        let (builder, report) = obj(&format!("{square}{faces}\n")).unwrap();
        let counted = warnings(&report);
        assert!(counted[0].starts_with(&format!("m.obj:{line}: {told}")), "{counted:?}");
        let found = corner_normals(builder);
        assert_eq!(found.len(), 6);
        for (i, normal) in found.iter().enumerate() {
            assert_eq!(*normal == [0.0; 3], missing.contains(&i), "{faces}: {i}");
        }
    }
    // No normal at all in the file, and lines that are none.
    let (builder, report) = obj(&format!("{}f 1//1 2//1 3//1 4//1\n", &square[..32])).unwrap();
    assert!(warnings(&report)[0].ends_with("the face's own is used (4 corners)"));
    assert!(corner_normals(builder).iter().all(|n| *n == [0.0; 3]));
    let (builder, report) =
        obj(&format!("{square}vn 0 0\nvn up\nvn\nvn 0 0 1\nf 1//4 2//5 3//2\n")).unwrap();
    assert_eq!(
        warnings(&report)[0],
        "m.obj:6: expected three numbers, `vn x y z`: the face's own is used (3 lines)"
    );
    assert_eq!(corner_normals(builder), [[0.0; 3], [0.0, 0.0, 1.0], [0.0; 3]]);
}

/// Numbers that are none, as C libraries print them: a normal falls back to the face's, a triangle
/// with such a corner is left out, and both are counted.
#[test]
fn what_is_no_number_is_read_in_every_spelling() {
    for odd in [
        "nan",
        "-nan",
        "-nan(ind)",
        "NAN(0x7fffff)",
        "-1.#IND",
        "1.#QNAN",
        "1.#QNAN0",
        "1.#SNAN",
        "-1.#IND000",
        "inf",
        "-inf",
        "1.#INF",
        "-1.#INF00",
        "Infinity",
        "1.#J",
        "1e999",
        "-NaN",
        "nan(snan)",
        "1.#IND",
        "INFINITY",
        "-1.#IND00e+000",
    ] {
        let normal = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvn {odd} {odd} 0 # {odd}\n");
        let (builder, report) = obj(&format!("{normal}f 1//1 2//1 3//2\n")).unwrap();
        assert_eq!(
            warnings(&report),
            ["m.obj: the normal of 1 vertices is zero or not finite: that of the face is used"],
            "{odd}"
        );
        assert_eq!(corner_normals(builder)[2], [0.0; 3]);
        let vertex = format!("{TRIANGLE}v 0 {odd} 0#{odd}\nf 1 2 4\n");
        let (builder, report) = obj(&vertex).unwrap();
        assert_eq!(builder.shapes(), 1);
        assert_eq!(
            warnings(&report),
            ["m.obj: 1 of 2 triangles are left out: 1 with a vertex that is not finite or beyond \
              1e18"],
            "{odd}"
        );
    }
}

/// A million lines of each doubt are one warning each, in a moment.
#[test]
fn a_million_doubts_are_few_warnings() {
    let doubts = "v 0 0 0 0\nvn x\ns x\nusemtl\nmtllib\nf 1\nf 1//0 2//9 3/1/1/1\nodd\n\
                  f 1 2 3\\\nv 0 0 0 \\\n1\n";
    let text = TRIANGLE.to_owned() + &doubts.repeat(100_000);
    let (builder, report) = obj(&text).unwrap();
    assert!(builder.shapes() > 0);
    assert!((5..20).contains(&report.warnings.len()), "{:?}", warnings(&report));
}
