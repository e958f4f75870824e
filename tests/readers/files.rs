//! Files on disk: found, named in messages, refused with a reason.

use super::{message, warnings};
use burnish::scene::read::{self, Files, Memory};
use std::borrow::Cow;
use std::cell::Cell;
use std::io::{Error, Write};
use std::path::{Path, PathBuf};

#[test]
fn a_scene_with_the_oddities_of_files_in_the_wild() {
    let (builder, report) = read::open("tests/data/workshop.scn".as_ref()).unwrap();
    let scene = "tests/data/workshop.scn";
    let opaque = "asks for transmission, which is not modelled: the surface is opaque";
    assert_eq!(
        warnings(&report),
        [
            format!("{scene}:4: camera: `2.9b` is read as 2.9"),
            format!("{scene}:7: sphere: `0,` is read as 0"),
            format!("{scene}:8: unknown command `ibl`: the line is not used"),
            format!(
                "{scene}:13: mesh: the shape statue.x is left out: files of this kind are not \
                 read, only .scn, .obj and .ply; a model can be converted: `assimp export \
                 statue.x statue.obj`"
            ),
            format!(
                "{scene}:16: mesh: `extra` and what follows is not used; expected `mesh FILE tx \
                 ty tz s ORIENT`"
            ),
            format!("{scene}:19: brdf: Kt 0.9 0.9 0.9 {opaque}"),
        ]
    );
    assert_eq!(
        report.notes,
        [
            "tests/data/leaf.ply: not used: confidence",
            "normals: smooth over edges below 45 degrees for 6 triangles",
        ]
    );
    let names: Vec<&str> = builder.materials().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["light, line 6", "brdf, line 9", "brdf, line 15", "brdf, line 19"]);
    assert_eq!((builder.screen, builder.name.as_str()), ([320, 240], "workshop.scn"));
    // Three spheres, a box, a cylinder and two leaves of three triangles.
    assert_eq!(builder.shapes(), 3 + 12 + 1 + 6);
}

#[test]
fn models_are_sought_beside_the_scene_then_in_the_working_directory() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.SCN");
    let write = |name: &Path, text: &str| {
        std::fs::File::create(name).unwrap().write_all(text.as_bytes()).unwrap()
    };
    // The tests run in the package's folder.
    write(&scene, "mesh tests/data/leaf.ply 0 0 0 1");
    assert_eq!(read::open(&scene).unwrap().0.shapes(), 3);

    std::fs::create_dir_all(folder.path().join("tests/data")).unwrap();
    let quad = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write(&folder.path().join("tests/data/leaf.ply"), quad);
    assert_eq!(read::open(&scene).unwrap().0.shapes(), 1);

    write(&scene, "light 1 1 1\nmesh none.ply 0 0 0 1");
    assert_eq!(
        message(read::open(&scene)),
        format!(
            "{}:2: mesh: cannot read the model none.ply: it is neither beside this file nor in \
             the working directory",
            scene.display()
        )
    );
    std::fs::create_dir(folder.path().join("folder.ply")).unwrap();
    write(&scene, "mesh folder.ply 0 0 0 1\n");
    assert!(message(read::open(&scene)).ends_with("the model folder.ply: it is a directory"));
}

#[test]
fn what_cannot_be_opened_is_named() {
    for (path, reason) in [
        ("tests/data", "this is a directory; expected a .scn, .obj or .ply file"),
        ("tests/data/none", "the name must end in .scn, .obj or .ply"),
        (
            "tests/data/statue.x",
            "files of this kind are not read, only .scn, .obj and .ply; a model can be converted: \
             `assimp export tests/data/statue.x tests/data/statue.obj`",
        ),
    ] {
        assert_eq!(message(read::open(path.as_ref())), format!("{path}: {reason}"));
    }
    let absent = message(read::open("tests/data/none.scn".as_ref()));
    assert!(absent.starts_with("tests/data/none.scn: cannot read the file: "), "{absent}");
    #[cfg(unix)]
    {
        // A device never ends.
        let folder = tempfile::tempdir().unwrap();
        let endless = folder.path().join("endless.obj");
        std::os::unix::fs::symlink("/dev/zero", &endless).unwrap();
        let text = message(read::open(&endless));
        assert!(text.ends_with("cannot read the file: it is not a regular file"), "{text}");
    }
}

#[test]
fn a_model_that_cannot_be_read_names_itself_and_the_scene() {
    let files = Memory(&[("bad.ply", b"plx")]);
    let scene = b"sphere 0 0 0 1\nmesh bad.ply 0 0 0 1";
    assert_eq!(
        message(read::read_scn(scene, "s.scn".as_ref(), &files)),
        "bad.ply:1: expected `ply` on the first line of a PLY file (a model of s.scn:2)"
    );
    let nested = message(read::read_scn(
        b"mesh s.scn 0 0 0 1",
        "s.scn".as_ref(),
        &Memory(&[("s.scn", b"mesh s.scn 0 0 0 1")]),
    ));
    assert_eq!(nested, "s.scn: a scene cannot be a part of another scene (a model of s.scn:1)");
}

#[test]
fn a_model_is_read_once_however_often_it_is_placed() {
    struct Counting(Cell<usize>);
    impl Files for Counting {
        fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
            self.0.set(self.0.get() + 1);
            Ok((name.into(), Cow::Borrowed(include_bytes!("../data/leaf.ply"))))
        }
    }
    let files = Counting(Cell::new(0));
    let scene: String = (0..50).map(|i| format!("mesh leaf.ply {i} 0 0 1\n")).collect();
    let (builder, report) = read::read_scn(scene.as_bytes(), "s.scn".as_ref(), &files).unwrap();
    assert_eq!((builder.shapes(), files.0.get(), report.notes.len()), (150, 1, 2));
}

/// A name need not be text, nor lie in the scene's folder.
#[cfg(unix)]
#[test]
fn names_are_bytes_and_lead_anywhere() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let odd = folder.path().join(OsStr::from_bytes(b"sc\xffne \x1b[2J.scn"));
    std::fs::write(&odd, "light 1 1 1\nsphere 0 0 0 1\n").unwrap();
    assert_eq!(read::open(&odd).unwrap().0.shapes(), 1);
    std::fs::write(&odd, "sphere 0 0 zero 1\n").unwrap();
    let text = message(read::open(&odd));
    assert!(text.ends_with("expected a number for cz, not `zero`"), "{text}");

    // Out of the folder and in again; what is found there is a model or an error, never a secret.
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    let scene = inner.join("s.scn");
    std::fs::copy("tests/data/leaf.ply", folder.path().join("leaf.ply")).unwrap();
    std::fs::write(&scene, "mesh ../inner/../leaf.ply 0 0 0 1\n").unwrap();
    assert_eq!(read::open(&scene).unwrap().0.shapes(), 3);
    std::fs::write(folder.path().join("secret.ply"), "the password is 12345\n").unwrap();
    std::fs::write(&scene, "mesh ../secret.ply 0 0 0 1\n").unwrap();
    let text = message(read::open(&scene));
    assert!(text.contains("expected `ply`") && !text.contains("12345"), "{text}");
    // Names without end, and names of nothing.
    let long = "a/".repeat(5000);
    for name in [long.as_str(), "..", "/", "\u{0}.ply"] {
        std::fs::write(&scene, format!("light 1 1 1\nsphere 0 0 0 1\nmesh {name} 0 0 0 1\n"))
            .unwrap();
        match read::open(&scene) {
            Ok((builder, report)) => {
                assert_eq!(builder.shapes(), 1);
                assert!(!report.warnings.is_empty(), "{name:.20} is left out in silence");
            }
            Err(error) => assert!(error.to_string().len() < 500, "{name:.20}: {error}"),
        }
    }
}

/// A lamp whose triangles have no area is not a lamp: that is said, and so is that the picture will
/// be black.
#[test]
fn a_lamp_without_area_is_told() {
    let files = Memory(&[("line.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")]);
    let scene = b"screen 4 3\ncamera 0 0 9 1\nlight 1 1 1\nmesh line.obj 0 0 0 1\n\
                  brdf .5 .5 .5 0 0 0 10\nsphere 0 0 0 1\n";
    let (builder, report) = read::read_scn(scene, "s.scn".as_ref(), &files).unwrap();
    assert!(!builder.is_lit());
    let told = warnings(&report);
    assert!(
        told.iter().any(|w| w.starts_with("s.scn:4:") && w.contains("without area")),
        "{told:?}"
    );
    assert!(told.iter().any(|w| w.contains("nothing emits light")), "{told:?}");
}

/// Numbers that single precision does not have: read in double, scaled before they are rounded.
#[test]
fn tiny_and_huge_shapes_keep_their_form() {
    for (radius, apart) in [("1e-46", "3e-46"), ("1e-300", "3e-300"), ("1e17", "3e17")] {
        let text = format!("light 1 1 1\nsphere 0 0 0 {radius}\nsphere {apart} 0 0 {radius}\n");
        let files = Memory(&[]);
        let (builder, _) = read::read_scn(text.as_bytes(), "s.scn".as_ref(), &files).unwrap();
        let scene = builder.build();
        let [a, b] = scene.geometry().spheres[..] else { panic!("two spheres") };
        let (r, d) = (a.radius, (b.centre - a.centre).length());
        assert!((d / r - 3.0).abs() < 1e-6 && (0.1..1.0).contains(&r), "{radius}: {r} {d}");
    }
}

/// What is read from elsewhere is told, by a path, by a link, or by the working directory; what is in
/// the scene's folder or below it is not.
#[test]
fn what_lies_outside_the_folder_of_the_scene_is_told() {
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("in");
    std::fs::create_dir_all(inner.join("below")).unwrap();
    let model = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for place in ["above.obj", "in/beside.obj", "in/below/deep.obj"] {
        std::fs::write(outer.path().join(place), model).unwrap();
    }
    let mut cases = vec![
        ("../above.obj", 1),
        ("beside.obj", 0),
        ("below/deep.obj", 0),
        ("below/../beside.obj", 0),
        ("../in/beside.obj", 0),
        ("tests/data/leaf.ply", 1),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../above.obj", inner.join("link.obj")).unwrap();
        cases.push(("link.obj", 1));
    }
    for (name, told) in cases {
        let scene = inner.join("s.scn");
        std::fs::write(&scene, format!("environment 1 1 1\nmesh {name} 0 0 0 1\n")).unwrap();
        let notes = read::open(&scene).unwrap().1.notes;
        let outside = notes.iter().filter(|note| note.contains("is not in the scene's folder"));
        assert_eq!(outside.count(), told, "{name}: {notes:?}");
    }
}

/// A library that is no library at all: what is in it is nobody's business.
#[test]
fn a_file_of_another_kind_is_not_quoted() {
    let secret = "root:x:0:0:root:/root:/bin/sh\nKEY=hunter2\n";
    let model = "mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    let files =
        [("l.mtl", secret.as_bytes()), ("m.obj", secret.as_bytes()), ("m.ply", secret.as_bytes())];
    let (_, report) = read::read(model.as_bytes(), "a.obj".as_ref(), &Memory(&files)).unwrap();
    let mut told: Vec<String> = warnings(&report);
    assert!(told.iter().any(|w| w.contains("l.mtl:1: expected `newmtl` before this")), "{told:?}");
    for name in ["m.obj", "m.ply"] {
        let scene = format!("environment 1 1 1\nmesh {name} 0 0 0 1\n");
        let error = read::read(scene.as_bytes(), "a.scn".as_ref(), &Memory(&files)).unwrap_err();
        told.push(error.to_string());
    }
    told.push(
        read::read(secret.as_bytes(), "s.scn".as_ref(), &Memory(&[])).unwrap_err().to_string(),
    );
    for text in told {
        assert!(!text.contains("root") && !text.contains("hunter2"), "{text}");
    }
}
