//! The `.scn` format.

use super::{Read, close, message, text, triangles, warnings};
use burnish::scene::read::{self, Memory};
use glam::DVec3;

fn scn(lines: &str) -> Read {
    text("s.scn", lines)
}

/// Text before and after that leaves nothing to warn of.
const QUIET: &str = "screen 4 3\ncamera 0 0 9 0.5\nlight 1 1 1\nsphere 0 0 5 1\n\
                     brdf 0.5 0.5 0.5 0 0 0 10\n";

#[test]
fn each_error_names_the_line_and_what_was_expected() {
    for (lines, expected) in [
        ("\nsphere 0 0 0", "2: sphere: r is missing; expected `sphere cx cy cz r`"),
        ("sphere", "1: sphere: cx is missing; expected `sphere cx cy cz r`"),
        ("\r\n\r\nsphere 0 zero 0 1", "3: sphere: expected a number for cy, not `zero`"),
        ("sphere 0 0 0 nan", "1: sphere: expected a number for r, not `nan`"),
        ("sphere 0 0 0 -1", "1: sphere: the radius must be above 0 and at most 1e18, not -1"),
        (
            "sphere 0 1e19 0 1",
            "1: sphere: coordinates must be finite and at most 1e18 in size, not 0 \
             10000000000000000000 0",
        ),
        ("box 0 0 0 1 0 -0.0", "1: box: a box needs at least two sides of a length other than 0"),
        (
            "cylinder 0 0 0 0 0 0 1",
            "1: cylinder: the axis must have a length above 0 and at most 1e18, not 0",
        ),
        (
            "screen 640.5 480",
            "1: screen: width and height must be whole numbers from 1 to 16384, not 640.5 480",
        ),
        (
            "screen 0 480",
            "1: screen: width and height must be whole numbers from 1 to 16384, not 0 480",
        ),
        ("camera 0 0 0", "1: camera: ry is missing; expected `camera x y z ry ORIENT`"),
        (
            "camera 0 0 0 0",
            "1: camera: ry, the tangent of half the vertical field of view, must be from \
             1e-6 to 1e4, not 0",
        ),
        ("camera 0 0 0 1 q 1 0 0", "1: camera: z is missing; expected `camera x y z ry ORIENT`"),
        ("camera 0 0 0 1 q 0 0 0 0", "1: camera: w x y z must be finite and not all 0"),
        ("camera 0 0 0 1 a 90 0 -0 0", "1: camera: ax ay az must be finite and not all 0"),
        ("camera 0 0 0 1 x up", "1: camera: expected a number for deg, not `up`"),
        ("camera 0 0 0 1 x 1e999", "1: camera: the angle deg must be a finite number of degrees"),
        (
            "brdf 0.5 0.5 0.5 0 0 0",
            "1: brdf: a_p is missing; expected `brdf Kd Kd Kd Ks Ks Ks a_p [Kt Kt Kt ior]`",
        ),
        (
            "brdf 0.5 0.5 0.5 0 0 0 10 0 0 0",
            "1: brdf: ior is missing; expected `brdf Kd Kd Kd Ks Ks Ks a_p [Kt Kt Kt ior]`",
        ),
        ("brdf 1.5 0 0 0 0 0 10", "1: brdf: Kd must be three numbers from 0 to 1, not 1.5 0 0"),
        ("brdf 0 0 0 0 -1 0 10", "1: brdf: Ks must be three numbers from 0 to 1, not 0 -1 0"),
        (
            "brdf 0 0 0 0 0 0 1e9",
            "1: brdf: Phong exponent a_p must be from 0 to 199999998, not 1000000000",
        ),
        (
            "light 1 -1 1",
            "1: light: emitted radiance must be three finite numbers of at least 0 (at most \
             1e18), not 1 -1 1",
        ),
        (
            "environment -1 0 0",
            "1: environment: emitted radiance must be three finite numbers of at least 0 \
             (at most 1e18), not -1 0 0",
        ),
        ("ambient 1 1", "1: ambient: b is missing; expected `ambient r g b`"),
        ("mesh", "1: mesh: FILE is missing; expected `mesh FILE tx ty tz s ORIENT`"),
        ("mesh a.ply 0 0 0 0", "1: mesh: the scale s must be from 1e-18 to 1e18 in size, not 0"),
        (
            "mesh a.ply 0 1e19 0 1",
            "1: mesh: coordinates must be finite and at most 1e18 in size, not 0 \
             10000000000000000000 0",
        ),
        ("mesh a.ply 0 0 0 1", "1: mesh: cannot read the model a.ply: there is no such file"),
        ("", " the file is empty"),
        ("# only\n\n# comments", " no command found; expected lines such as `sphere cx cy cz r`"),
        ("sphere 0 0 0 1\n\0", "2: expected text in UTF-8, found a zero byte"),
    ] {
        assert_eq!(message(scn(lines)), format!("s.scn:{expected}"), "{lines:?}");
    }
}

#[test]
fn each_oddity_is_one_warning() {
    for (lines, expected) in [
        ("ambient 1 1 1", None),
        ("  # sphere\n\t\n#sphere 0", None),
        ("brdf 0 0 0 0 0 0 10 0 0 0 1.5\nsphere 0 0 0 1", None),
        // Of several in a row the last wins, and what no shape uses is not spoken of.
        ("brdf 0 0 0 0 0 0 10 1 1 1 1.5\nbrdf 0 0 0 0 0 0 10\nsphere 0 0 0 1", None),
        ("camera 0 0 0 .5e0 x +90. y 0 z -.0", Some("6: camera: this replaces the one of line 2")),
        ("screen 4 3", Some("6: screen: this replaces the one of line 1")),
        (
            "environment 1 1 1\nenvironment 0 0 0",
            Some("7: environment: this replaces the one of line 6"),
        ),
        ("sphere 0, 0 0 1", Some("6: sphere: `0,` is read as 0")),
        ("sphere 0 0 0 1e", Some("6: sphere: `1e` is read as 1")),
        (
            "sphere 0 0 0 1 # ball",
            Some("6: sphere: `#` and what follows is not used; expected `sphere cx cy cz r`"),
        ),
        ("torus 1 2", Some("6: unknown command `torus`: the line is not used")),
        ("Sphere 0 0 0 1", Some("6: unknown command `Sphere`: the line is not used")),
        ("\x1b[2J", Some("6: unknown command `\\u{1b}[2J`: the line is not used")),
        (
            "ambient 1 1 1 1",
            Some("6: ambient: `1` and what follows is not used; expected `ambient r g b`"),
        ),
        (
            "brdf 0 0 0 0 0 0 10 0 1 0 1.5\nsphere 0 0 0 1\nsphere 9 0 0 1",
            Some(
                "6: brdf: Kt 0 1 0 asks for transmission, which is not modelled: the surface is \
                 opaque",
            ),
        ),
        (
            "mesh m 0 0 0 1",
            Some("6: mesh: the shape m is left out: the name must end in .scn, .obj or .ply"),
        ),
    ] {
        let (_, report) = scn(&format!("{QUIET}{lines}")).unwrap();
        let expected: Vec<String> = expected.iter().map(|w| format!("s.scn:{w}")).collect();
        assert_eq!(warnings(&report), expected, "{lines:?}");
    }
}

#[test]
fn what_a_scene_leaves_out_gets_a_default_and_a_warning() {
    let (builder, report) = scn("sphere 0 0 0 1\nsphere 3 0 0 1").unwrap();
    assert_eq!(
        warnings(&report),
        [
            "s.scn:1: no `brdf` or `light` comes before this shape: Kd 1 0.5 0, Ks 1 1 1, a_p 1 is \
             used",
            "s.scn: no `screen W H`: the picture has 640 by 480 pixels",
            "s.scn: no `camera`: one that frames the whole scene is used",
            "s.scn: nothing emits light, so the picture will be black: put `light r g b` before a \
             shape, or add `environment r g b`",
        ]
    );
    assert_eq!((builder.screen, builder.camera, builder.is_lit()), ([640, 480], None, false));
    let [material] = builder.materials() else { panic!("one material") };
    assert_eq!((material.kd, material.ks), ([1.0, 0.5, 0.0], [1.0; 3]));
    assert_eq!(material.roughness.exponent(), 1.0);

    let (_, report) = scn("environment 1 1 1").unwrap();
    assert_eq!(warnings(&report)[2], "s.scn: there is no shape to see");
}

#[test]
fn lights_are_black_and_each_shape_is_one() {
    let (builder, _) = scn(
        "light 5 6 7\nsphere 0 0 0 1\nbox 3 0 0 1 1 1\ncylinder 9 0 0 0 0 1 1\nlight 1 1 1\nbrdf 0 \
         0 0 .5 .5 .5 10\nsphere 20 0 0 1",
    )
    .unwrap();
    let [light, surface] = builder.materials() else { panic!("two materials") };
    assert_eq!((light.kd, light.ks, light.emission), ([0.0; 3], [0.0; 3], [5.0, 6.0, 7.0]));
    assert!(!surface.emits());
    let scene = builder.build();
    let lit = scene.surfaces().iter().filter(|s| s.material == 0).count();
    assert_eq!((lit, scene.surfaces().len()), (3, 4));
}

#[test]
fn the_environment_lights_a_scene() {
    let (builder, report) = scn("screen 4 3\ncamera 0 0 9 1\nenvironment 1 2 3\n\
                                 brdf 0 0 0 0 0 0 10\nsphere 0 0 0 1")
    .unwrap();
    assert_eq!((builder.environment, warnings(&report)), ([1.0, 2.0, 3.0], vec![]));
}

#[test]
fn line_ends_marks_and_foreign_bytes_are_harmless() {
    let plain = format!("{QUIET}# caf\u{e9}\nbox 0 0 0 1 1 1");
    let (expected, _) = scn(&plain).unwrap();
    let latin: Vec<u8> = plain.chars().map(|c| c as u8).collect();
    for bytes in [
        plain.replace('\n', "\r\n").into_bytes(),
        plain.replace('\n', "\r").into_bytes(),
        format!("\u{feff}{plain}\n\n").into_bytes(),
        plain.replace(' ', "\t  ").into_bytes(),
        latin,
    ] {
        let (builder, report) = read::read_scn(&bytes, "s.scn".as_ref(), &Memory(&[])).unwrap();
        assert_eq!(warnings(&report), [""; 0]);
        assert_eq!((builder.shapes(), builder.camera), (expected.shapes(), expected.camera));
    }
}

#[test]
fn the_last_rotation_acts_first() {
    let axes = |orient: &str| {
        let (builder, _) = scn(&format!("camera 1 2 3 0.25 {orient}")).unwrap();
        let camera = builder.camera.unwrap();
        assert_eq!((camera.eye, camera.ry), (DVec3::new(1.0, 2.0, 3.0), 0.25));
        camera.axes()
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    for (orient, expected) in [
        ("", [x, y, z]),
        ("x 90", [x, z, -y]),
        ("y 90", [-z, y, x]),
        ("z 90", [y, -x, z]),
        ("z 90 x 90", [y, z, x]),
        ("x 90 z 90", [z, -x, -y]),
        ("q 5 0 0 5 q 0.1 0.1 0 0", [y, z, x]),
        ("a 90 0 0 7 a 90 1e-200 0 0", [y, z, x]),
        ("x 360 y -720 z 1080", [x, y, z]),
    ] {
        for (got, wanted) in axes(orient).into_iter().zip(expected) {
            assert!((got - wanted).length() < 1e-12, "{orient}: {got} is not {wanted}");
        }
    }
    // The quaternion of the course scenes, 0.04 % off, looks at the middle of the table.
    let [right, up, back] = axes("q 0.416981 0.279589 0.480987 0.718247");
    let eye = DVec3::new(5.553228, 2.942755, 2.900874);
    assert!((right.cross(up) - back).length() < 1e-12 && (back.length() - 1.0).abs() < 1e-12);
    assert!(eye.normalize().dot(back) > 0.99, "{back}");
}

#[test]
fn a_camera_line_reads_back() {
    let (builder, _) = scn("camera 0.1 -2 3e5 0.2 q 0.4169 0.2795 0.4809 0.7182 x 12").unwrap();
    let camera = builder.camera.unwrap();
    let again = scn(&camera.scn_line()).unwrap().0.camera.unwrap();
    assert_eq!((again.eye, again.ry), (camera.eye, camera.ry));
    assert!(again.orientation.dot(camera.orientation) > 1.0 - 1e-15);
}

#[test]
fn a_mesh_is_scaled_and_rotated_before_it_is_moved() {
    let triangle = b"v 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3\nusemtl not looked for\nmtllib none.mtl";
    let files = Memory(&[("t.obj", triangle)]);
    let scene = b"mesh t.obj 10 0 5 2 z 90 x 90\nmesh t.obj 0 0 0 -1\n";
    let (builder, report) = read::read_scn(scene, "s.scn".as_ref(), &files).unwrap();
    assert!(!warnings(&report).iter().any(|w| w.contains("mtl")), "{report:?}");
    let scene = builder.build();
    let expected = [
        // x 90 takes Y to Z, then z 90 takes X to Y; twice as large; moved.
        [DVec3::new(10.0, 2.0, 5.0), DVec3::new(10.0, 2.0, 7.0), DVec3::new(10.0, 4.0, 5.0)],
        [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(-1.0, -1.0, 0.0), DVec3::new(-2.0, 0.0, 0.0)],
    ];
    for (got, wanted) in triangles(&scene).into_iter().zip(expected) {
        for (p, q) in got.into_iter().zip(wanted) {
            assert!(close(p, q), "{p} is not {q}");
        }
    }
}

#[test]
fn triangles_that_cannot_be_used_are_counted() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nvn 0 0 0\nvn 0 0 1\n\
                f 1//2 2//2 3//1\nf 1//2 1//2 2//2\nf 1//2 2//2 4//2";
    let files = Memory(&[("t.obj", obj)]);
    let scene = format!("{QUIET}mesh t.obj 0 0 0 1");
    let (_, report) = read::read_scn(scene.as_bytes(), "s.scn".as_ref(), &files).unwrap();
    assert_eq!(
        warnings(&report),
        ["s.scn:6: mesh t.obj: 2 of 3 triangles are left out: 1 without area, 1 with a vertex \
             that \
          is not finite or beyond 1e18; the normal of 1 vertices is zero or not finite: that of \
          the face is used"]
    );
}

#[test]
fn a_million_odd_lines_are_not_a_million_warnings() {
    let (_, report) = scn(&format!("{QUIET}{}", "torus\n".repeat(100_000))).unwrap();
    assert_eq!(report.warnings.len(), 1001);
    assert_eq!(report.warnings[1000].to_string(), "s.scn: 99000 further warnings are not listed");
}

#[test]
fn a_material_is_called_by_the_comment_right_above_it() {
    let (builder, _) =
        scn("# The lamp\nlight 1 1 1\nsphere 0 0 5 1\n# Brass\n\nbrdf 0 0 0 0.9 0.7 0.4 300\n\
         sphere 0 0 0 1\n#  Lacquer, dark \nbrdf 0.1 0.1 0.1 0 0 0 10\nsphere 3 0 0 1\n")
        .unwrap();
    let names: Vec<&str> = builder.materials().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["The lamp", "brdf, line 6", "Lacquer, dark"]);
}

/// Kind: a name in quotes, with blanks or without.
#[test]
fn a_quoted_name_is_the_name_between_the_quotes() {
    let triangle: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files = Memory(&[
        ("t.obj", triangle),
        ("my model.obj", triangle),
        ("it's.obj", triangle),
        ("m/t.obj", triangle),
    ]);
    for (line, warning) in [
        ("mesh \"t.obj\" 0 0 0 1", None),
        ("mesh 't.obj' 0 0 0 1 x 90", None),
        ("mesh \u{201c}t.obj\u{201d} 0 0 0 1", None),
        ("mesh  \"my model.obj\"\t0 0 0 1", None),
        ("mesh 'my model.obj' 0 0 0 1", None),
        ("mesh 'it's.obj' 0 0 0 1", None),
        ("mesh \"it's.obj\" 0 0 0 1", None),
        ("mesh m\\t.obj 0 0 0 1", None),
        ("mesh \"m\\t.obj\" 0 0 0 1", None),
        ("mesh \"t.obj 0 0 0 1", Some("`\"t.obj` is read as `t.obj`")),
        ("mesh t.obj\" 0 0 0 1", Some("`t.obj\"` is read as `t.obj`")),
    ] {
        let scene = format!("{QUIET}{line}");
        let (builder, report) =
            read::read_scn(scene.as_bytes(), "s.scn".as_ref(), &files).expect(line);
        assert_eq!(builder.shapes(), 2, "{line}");
        let expected: Vec<String> = warning.iter().map(|w| format!("s.scn:6: mesh: {w}")).collect();
        assert_eq!(warnings(&report), expected, "{line}");
    }
    let text = message(read::read_scn(b"mesh my model.obj 0 0 0 1", "s.scn".as_ref(), &files));
    assert_eq!(
        text,
        "s.scn:1: mesh: expected a number for tx, not `model.obj`; a name with blanks stands in \
         quotes"
    );
}

/// Kind: advice that does not fit the file.
#[test]
fn advice_fits_the_file() {
    const NOT: &str = "files of this kind are not read, only .scn, .obj and .ply";
    for (name, advice) in [
        ("a.fbx", "; a model can be converted: `assimp export a.fbx a.obj`"),
        ("\"a b.fbx\"", "; a model can be converted: `assimp export 'a b.fbx' 'a b.obj'`"),
        (
            "\"it's.STL\"",
            "; a model can be converted: `assimp export 'it'\\''s.STL' 'it'\\''s.obj'`",
        ),
        ("a.exr", "; this is a picture; `burnish info a.exr` tells what it is"),
        ("a.JPG", "; this is a picture"),
        ("a.mtl", "; this is a material library: open the .obj that names it"),
        ("a.ply.gz", "; it is packed: unpack it first"),
        ("a.txt", ""),
    ] {
        let (_, report) = scn(&format!("{QUIET}mesh {name} 0 0 0 1")).unwrap();
        let name = name.trim_matches('"');
        let expected = format!("s.scn:6: mesh: the shape {name} is left out: {NOT}{advice}");
        assert_eq!(warnings(&report), [expected]);
    }
    // Nothing may be copied into a shell that is not the file's name.
    let long = format!("{}.fbx", "x".repeat(100));
    let (_, report) = scn(&format!("{QUIET}mesh {long} 0 0 0 1")).unwrap();
    assert!(warnings(&report)[0].ends_with("a model can be converted by `assimp export`"));
    for name in ["\"a.ply\"", "'a.obj'"] {
        let text = message(read::open(name.as_ref()));
        assert!(!text.contains("assimp") && text.contains("quote"), "{text}");
    }
}

/// Kind: only the first of several errors is told.
#[test]
fn all_errors_of_a_scene_are_told() {
    let files = Memory(&[("bad.ply", b"plx")]);
    let scene = b"sphere 0 0 0\nscreen 4 3\nlight 1 -1 1\nmesh bad.ply 0 0 0 1\n\
                  mesh bad.ply 1 0 0 1\nmesh none.obj 0 0 0 1\nbox 0 0 0 1 1 one\n";
    let error = read::read_scn(scene, "s.scn".as_ref(), &files).unwrap_err();
    assert_eq!((error.place.line, error.further.len()), (Some(1), 4));
    let text = error.to_string();
    let places: Vec<&str> = text.lines().map(|line| line.split(": ").next().unwrap()).collect();
    // A model that cannot be read is told once, however often it is placed.
    assert_eq!(places, ["s.scn:1", "s.scn:3", "bad.ply:1", "s.scn:6", "s.scn:7"], "{text}");

    let text = message(scn(&"sphere 0 0 0\n".repeat(1000)));
    assert_eq!(text.lines().count(), 21);
    assert!(text.ends_with("\ns.scn: 980 further errors are not listed"), "{text}");
    assert!(text.lines().nth(19).unwrap().starts_with("s.scn:20: "), "{text}");
    assert_eq!(message(scn(&"sphere 0 0 0\n".repeat(20))).lines().count(), 20);
    let text = message(scn(&"sphere 0 0 0\n".repeat(21)));
    assert!(text.ends_with("\ns.scn: 1 further error is not listed"), "{text}");
}
