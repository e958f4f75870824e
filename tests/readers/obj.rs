//! OBJ and MTL.

use super::{Read, message, text, triangles, warnings};
use burnish::scene::read::{self, Memory};
use burnish::scene::{Material, SceneBuilder};
use glam::DVec3;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn obj(lines: &str) -> Read {
    text("m.obj", lines)
}

/// A triangle of material `m`, which this MTL file describes.
fn with_mtl(mtl: &[u8]) -> Read {
    let obj = format!("mtllib m.mtl\nusemtl m\n{TRIANGLE}");
    read::read(obj.as_bytes(), "m.obj".as_ref(), &Memory(&[("m.mtl", mtl)]))
}

fn only_material(builder: &SceneBuilder) -> &Material {
    let [material] = builder.materials() else { panic!("{:?}", builder.materials()) };
    material
}

#[test]
fn a_lamp_with_materials_and_lights() {
    let (builder, report) = read::open("tests/data/lamp.obj".as_ref()).unwrap();
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
fn a_model_that_emits_nothing_is_lit_by_a_white_environment() {
    let (builder, report) = obj(TRIANGLE).unwrap();
    assert_eq!((builder.environment, warnings(&report)), ([1.0; 3], vec![]));
    assert_eq!(
        report.notes,
        [
            "some faces have no material: a diffuse grey of Kd 0.5 is used",
            "normals: smooth over edges below 45 degrees for 1 triangle",
            "nothing in the file emits: lit by a uniform white environment of radiance 1",
        ]
    );
    let grey = only_material(&builder);
    assert_eq!((grey.kd, grey.ks), ([0.5; 3], [0.0; 3]));
}

#[test]
fn materials_as_people_write_them() {
    for (mtl, kd, exponent, expected) in [
        ("newmtl m\nKd 0.25 0.5 0.75\n", [0.25, 0.5, 0.75], 10.0, vec![]),
        ("\u{feff}newmtl\tm  \r\n\tKd\t0.25\r\n", [0.25; 3], 10.0, vec![]),
        ("newmtl m\nKd 0.25 0.5 \\\n0.75\nKs 0 0 0\nTr 0\nd 1.0", [0.25, 0.5, 0.75], 10.0, vec![]),
        ("newmtl m\n", [0.5; 3], 10.0, vec!["m.mtl:1: `m` has no Kd: 0.5 0.5 0.5 is used"]),
        ("newmtl m\nKe 1 1 1", [0.0; 3], 10.0, vec!["m.mtl:1: `m` has no Kd: 0 0 0 is used"]),
        (
            "newmtl m\nKd 1 1 1\nKs 1 1 1",
            [1.0; 3],
            10.0,
            vec!["m.mtl:1: `m` has Ks but no Ns: an exponent of 10 is used"],
        ),
        (
            "newmtl m\nKd 0 0 0\nNs 7\nnewmtl m\nKd 1 1 1\nNs 8",
            [1.0; 3],
            8.0,
            vec!["m.mtl:4: `m` is defined again; this one counts"],
        ),
        (
            "newmtl m\nKd spectral a.rfl 1\nKd 0 0 0\nPr 0.5\nbump b.png",
            [0.0; 3],
            10.0,
            vec![
                "m.mtl:2: `Kd` by a spectrum or CIE XYZ is not supported and left out",
                "m.mtl:4: `Pr` is not supported and left out",
                "m.mtl:5: `bump` is not supported and left out",
            ],
        ),
    ] {
        let (builder, report) = with_mtl(mtl.as_bytes()).unwrap();
        assert_eq!(warnings(&report), expected, "{mtl}");
        let material = only_material(&builder);
        assert_eq!((material.kd, material.roughness.exponent()), (kd, exponent), "{mtl}");
    }
}

#[test]
fn each_mtl_error_names_the_line_and_the_range() {
    let colour = "expected three numbers, or one for all three channels";
    for (mtl, expected) in [
        ("Kd 1 1 1", "m.mtl:1: expected `newmtl` before `Kd`".to_owned()),
        ("newmtl", "m.mtl:1: newmtl: expected the name of a material".into()),
        ("newmtl m\nKd 1 1", format!("m.mtl:2: Kd: {colour}, found 2")),
        ("newmtl m\nKe", format!("m.mtl:2: Ke: {colour}, found 0")),
        ("newmtl m\nKs 1 1 1 1", format!("m.mtl:2: Ks: {colour}, found 4")),
        ("newmtl m\n\nKs 0,5 0 0", format!("m.mtl:3: Ks: {colour}, not `0,5`")),
        ("newmtl m\nNs high", "m.mtl:2: Ns: expected one number, not `high`".into()),
        ("newmtl m\nKd 0 2 0", "m.mtl:2: Kd must be three numbers from 0 to 1, not 0 2 0".into()),
        (
            "newmtl m\nKd 0 0 0\nKs nan",
            "m.mtl:3: Ks must be three numbers from 0 to 1, not NaN NaN NaN".into(),
        ),
        (
            "newmtl m\nKd 0\nNs -1",
            "m.mtl:3: Ns: Phong exponent a_p must be from 0 to 199999998, not -1".into(),
        ),
        (
            "newmtl m\nKd 0\nKe 0 -1 0",
            "m.mtl:3: Ke: emitted radiance must be three finite numbers of at least 0 (at most \
             1e18), not 0 -1 0"
                .into(),
        ),
        ("newmtl m\n\0", "m.mtl:2: expected text in UTF-8, found a zero byte".into()),
    ] {
        assert_eq!(message(with_mtl(mtl.as_bytes())), expected);
    }
}

#[test]
fn missing_materials_are_warnings() {
    let grey = "a diffuse grey of Kd 0.5 is used";
    for (lines, expected) in [
        (
            "mtllib none.mtl\n",
            vec!["m.obj:1: mtllib: cannot read none.mtl: there is no such file".to_owned()],
        ),
        ("usemtl gold\n", vec![format!("m.obj:1: no MTL file defines `gold`: {grey}")]),
        (
            "mtllib a b.mtl\n",
            vec![
                "m.obj:1: mtllib: cannot read a: there is no such file".into(),
                "m.obj:1: mtllib: cannot read b.mtl: there is no such file".into(),
            ],
        ),
    ] {
        let (builder, report) = obj(&format!("{lines}{TRIANGLE}")).unwrap();
        assert_eq!(warnings(&report), expected);
        assert_eq!(only_material(&builder).kd, [0.5; 3]);
    }
    // Several files on one line, a name with spaces, and a material used before its file is named.
    let files = Memory(&[("a.mtl", b"newmtl a\nKd 1"), ("b c.mtl", b"newmtl b\nKd 1")]);
    let text = format!("usemtl b\n{TRIANGLE}mtllib a.mtl a.mtl\nmtllib b c.mtl");
    let (builder, report) = read::read(text.as_bytes(), "m.obj".as_ref(), &files).unwrap();
    assert_eq!(warnings(&report), ["a.mtl:1: `a` is defined again; this one counts"]);
    assert_eq!(only_material(&builder).name, "b");
}

#[test]
fn each_obj_error_names_the_line() {
    let numbers = "expected three numbers, `v x y z`";
    for (lines, expected) in [
        ("v 0 0\n", format!("m.obj:5: {numbers}")),
        ("v 0 0 0,5\n", format!("m.obj:5: {numbers}, not `0,5`")),
        ("vn 0 0\n", "m.obj:5: expected three numbers, `vn x y z`".into()),
        ("v 0 0 0 0", "m.obj:5: v: expected a weight other than 0, not `0`".into()),
        ("f 1 2 0", "m.obj:5: f: a vertex index counts from 1, not 0".into()),
        (
            "f 1 2 4\n\nf 1 2 9\nf 1 2 3",
            "m.obj:7: f: expected a vertex index from 1 to 3, not 9".into(),
        ),
        ("f -1 -2 -4", "m.obj:5: f: the vertex index -4 points before the first of 3".into()),
        ("f 1 2 a", "m.obj:5: f: expected a vertex index, not `a`".into()),
        ("f 1 2 //1", "m.obj:5: f: expected a vertex index, not ``".into()),
        (
            "f 1 2 3/1/1/1",
            "m.obj:5: f: expected a corner v, v/vt, v//vn or v/vt/vn, not `3/1/1/1`".into(),
        ),
        (
            "f 1 2 99999999999999999999",
            "m.obj:5: f: expected a vertex index, not `99999999999999999999`".into(),
        ),
        // This one makes the crate that reads OBJ overflow.
        (
            "vn 0 0 1\nf 1 2 3//6148914691236517206",
            "m.obj:6: f: expected a normal index from 1 to 1, not 6148914691236517206".into(),
        ),
        (
            "f 1 2 3//9223372036854775807",
            "m.obj:5: f: expected a normal index from 1 to 0, not 9223372036854775807".into(),
        ),
        (
            "f 1 2 3//-9223372036854775808",
            "m.obj:5: f: the normal index -9223372036854775808 points before the first of 0".into(),
        ),
        ("usemtl", "m.obj:5: usemtl: expected the name of a material".into()),
        ("mtllib ", "m.obj:5: mtllib: expected the name of a file".into()),
    ] {
        assert_eq!(message(obj(&format!("{TRIANGLE}{lines}"))), expected, "{lines}");
    }
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
    ] {
        let (builder, report) = obj(lines).unwrap();
        assert_eq!(warnings(&report), [""; 0], "{lines}");
        let expected = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
        assert_eq!(triangles(&builder.build()), expected, "{lines}");
    }
    for (lines, warning) in [
        ("v 5 5 5 1 0 0\n", "m.obj:5: a colour of a vertex is not supported and left out"),
        ("p 1\nl 1 2\np 2\n", "m.obj:5: `p` is not supported and left out (2 lines)"),
        ("f 1 2\nf 1\n", "m.obj: 2 faces of fewer than three corners are left out"),
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
        ["m.obj:6: f: the outline of 2 polygons, this one first, crosses itself: their triangles \
          may overlap or leave gaps"]
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
