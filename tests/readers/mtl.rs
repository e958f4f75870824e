//! MTL: materials, the files that bring them, and their names.

use super::obj::{TRIANGLE, obj};
use super::{Read, bare, open_bare, warnings};
use burnish::scene::read::Memory;
use burnish::scene::{Material, SceneBuilder};

/// A triangle of material `m`, which this MTL file describes.
fn with_mtl(mtl: &[u8]) -> Read {
    let obj = format!("mtllib m.mtl\nusemtl m\n{TRIANGLE}");
    bare(obj.as_bytes(), "m.obj", &Memory(&[("m.mtl", mtl)]))
}

pub(super) fn only_material(builder: &SceneBuilder) -> &Material {
    let [material] = builder.materials() else { panic!("{:?}", builder.materials()) };
    material
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
fn missing_materials_are_warnings() {
    let grey = "a glossy grey of Kd 0.3, Ks 0.2, alpha 0.25 is used";
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
        assert_eq!(only_material(&builder).kd, [0.3; 3]);
    }
    // Several files on one line, a name with spaces, and a material used before its file is named.
    let files = Memory(&[("a.mtl", b"newmtl a\nKd 1"), ("b c.mtl", b"newmtl b\nKd 1")]);
    let text = format!("usemtl b\n{TRIANGLE}mtllib a.mtl a.mtl\nmtllib b c.mtl");
    let (builder, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
    assert_eq!(warnings(&report), [""; 0]);
    assert_eq!(only_material(&builder).name, "b");
}

/// A fault costs the value that it stands in, or the material, and never the model.
#[test]
fn a_fault_costs_its_material_alone() {
    let colour = "expected three numbers, or one for all three channels";
    let (grey, flat) = ("0.5 0.5 0.5 is used", "there is no specular lobe");
    let half = [0.5; 3];
    let no = [0.0; 3];
    for (lines, kd, ks, expected) in [
        ("Kd 1 1", half, no, format!("m.mtl:2: Kd: {colour}, found 2: {grey}")),
        ("Kd", half, no, format!("m.mtl:2: Kd: {colour}, found 0: {grey}")),
        ("Kd red", half, no, format!("m.mtl:2: Kd: {colour}, not `red`: {grey}")),
        ("Kd 0,5 0 0\nKe 0 0 0", half, no, format!("m.mtl:2: Kd: {colour}, not `0,5`: {grey}")),
        ("Kd nan 0 0", half, no, format!("m.mtl:2: Kd must be finite, not NaN 0 0: {grey}")),
        (
            "Kd 0.5 0.25 0 1.0",
            [0.5, 0.25, 0.0],
            no,
            format!("m.mtl:2: Kd: {colour}: the first three are used"),
        ),
        (
            "Kd 1.00001 0.5 0",
            [1.0, 0.5, 0.0],
            no,
            "m.mtl:2: Kd must be from 0 to 1, not 1.00001 0.5 0: it is clamped".into(),
        ),
        (
            "Kd 0.5 -1e-9 0",
            [0.5, 0.0, 0.0],
            no,
            "m.mtl:2: Kd must be from 0 to 1, not 0.5 -0.000000001 0: it is clamped".into(),
        ),
        (
            "Kd 1.#INF 0 0",
            [1.0, 0.0, 0.0],
            no,
            "m.mtl:2: Kd must be from 0 to 1, not inf 0 0: it is clamped".into(),
        ),
        ("Kd .5\nKs 1 2", half, no, format!("m.mtl:3: Ks: {colour}, found 2: {flat}")),
        (
            "Kd .5\nKs -nan(ind)",
            half,
            no,
            format!("m.mtl:3: Ks must be finite, not NaN NaN NaN: {flat}"),
        ),
        (
            "Kd .5\nNs 9\nKs 2 .5 .5",
            half,
            [1.0, 0.5, 0.5],
            "m.mtl:4: Ks must be from 0 to 1, not 2 0.5 0.5: it is clamped".into(),
        ),
        (
            "Kd .5\nNs high",
            half,
            no,
            "m.mtl:3: Ns: expected one number, not `high`: 10 is used".into(),
        ),
        ("Kd .5\nNs", half, no, "m.mtl:3: Ns: expected one number, not nothing: 10 is used".into()),
        ("Kd .5\nNs 10 20", half, no, "m.mtl:3: Ns: expected one number: the first is used".into()),
        (
            "Kd .5\nKs 1\nNs 9\nillum 1",
            half,
            no,
            "m.mtl:5: `m` has illum 1, so no specular lobe: its Ks is not used".into(),
        ),
        (
            "illum 0 # constant\nKd .5\nKs 1",
            half,
            no,
            "m.mtl:2: `m` has illum 0, so no specular lobe: its Ks is not used".into(),
        ),
        (
            "Kd .1\nKd .5",
            half,
            no,
            "m.mtl:3: Kd is given again for the same material; this one counts".into(),
        ),
        (
            "Kd .5\n\0\u{1}",
            half,
            no,
            "m.mtl:3: `\\u{0}\\u{1}` is not supported and left out".into(),
        ),
        (
            "Kd .5 .5 .5\\\nKs 0",
            half,
            no,
            "m.mtl:2: the backslash at the end of this line continues nothing".into(),
        ),
    ] {
        let (builder, report) = with_mtl(format!("newmtl m\n{lines}").as_bytes()).unwrap();
        let expected = expected.replace("\\u{0}", "\\0");
        assert_eq!(warnings(&report), [expected], "{lines}");
        let material = only_material(&builder);
        assert_eq!((material.kd, material.ks), (kd, ks), "{lines}");
        assert!(!material.emits(), "{lines}");
    }
    for (lines, exponent) in [("Ns -1", 0.0), ("Ns 1e30", 2e8 - 2.0), ("Ns inf", 2e8 - 2.0)] {
        let (builder, report) = with_mtl(format!("newmtl m\nKd 0\n{lines}").as_bytes()).unwrap();
        let [told] = report.warnings.as_slice() else { panic!("{:?}", report.warnings) };
        assert!(told.text.starts_with("Ns must be from 0 to 199999998, not "), "{told}");
        let found = only_material(&builder).roughness.exponent();
        assert!((found - exponent).abs() <= 1e-6 * exponent, "{lines}: {found}");
    }
    for (lines, emission, told) in [
        ("Ke 0 -1 2", [0.0, 0.0, 2.0], "Ke must be from 0 to 1e18, not 0 -1 2: it is clamped"),
        ("Ke 1 2 nan", [0.0; 3], "Ke must be finite, not 1 2 NaN: nothing is emitted"),
        ("Ke inf", [0.0; 3], "Ke must be finite, not inf inf inf: nothing is emitted"),
        ("Ke 1e30", [1e18; 3], "Ke must be from 0 to 1e18, not 1000000000000000000000000000000 "),
    ] {
        let (builder, report) = with_mtl(format!("newmtl m\nKd 0\n{lines}").as_bytes()).unwrap();
        assert!(report.warnings[0].text.starts_with(told), "{}", report.warnings[0]);
        assert_eq!(only_material(&builder).emission, emission);
    }
}

/// Files that describe no material, and texture without colour.
#[test]
fn a_file_without_its_material_leaves_a_grey_one() {
    let none =
        "m.obj:2: no MTL file defines `m`: a glossy grey of Kd 0.3, Ks 0.2, alpha 0.25 is used";
    for (mtl, told) in [
        ("", "m.mtl:1: the file is empty"),
        ("\u{feff}", "m.mtl:1: the file is empty"),
        (" \r\n\r\n", "m.mtl:1: the file is empty"),
        ("# nothing", ""),
        ("Kd 1 1 1\nKs 0 0 0", "m.mtl:1: expected `newmtl` before `Kd`: it is not used (2 lines)"),
        (
            "newmtl\nKd 1 0 0",
            "m.mtl:1: newmtl: no name is given, so no face can have this material",
        ),
        (
            "newmtl # m\nKd 1 0 0",
            "m.mtl:1: newmtl: no name is given, so no face can have this material",
        ),
        ("newmtl M\nKd 1 0 0", ""),
    ] {
        let (builder, report) = with_mtl(mtl.as_bytes()).unwrap();
        assert_eq!(only_material(&builder).kd, [0.3; 3], "{mtl}");
        let expected: Vec<&str> = [none, told].into_iter().filter(|t| !t.is_empty()).collect();
        assert_eq!(warnings(&report), expected, "{mtl}");
    }
    // What stands before the first material or in one without a name costs no other.
    let (builder, report) = with_mtl(b"Kd 1 0 0\nnewmtl\nKd 0 1 0\nnewmtl m\nKd 0 0 1").unwrap();
    assert_eq!(only_material(&builder).kd, [0.0, 0.0, 1.0]);
    assert_eq!(report.warnings.len(), 2, "{:?}", report.warnings);
    for lines in ["map_Kd a.png", "MAP_KD -s 1 1 1 a.png\nKs 0 0 0", "map_Kd C:\\\nKe 0 0 0"] {
        let (builder, report) = with_mtl(format!("newmtl m\n{lines}").as_bytes()).unwrap();
        assert_eq!(only_material(&builder).kd, [0.5; 3], "{lines}");
        let told = warnings(&report);
        let expected = "m.mtl:1: `m` has map_Kd and no Kd: 0.5 0.5 0.5 is used".to_owned();
        assert!(told.contains(&expected), "{told:?}");
    }
}

#[test]
fn mtl_files_in_utf_16_are_read() {
    let text = "newmtl m\r\nKd 0.25 0.5 0.75\r\n";
    let units = || text.encode_utf16();
    let low: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
    let high: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
    let mut odd = [&b"\xff\xfe"[..], &low].concat();
    odd.push(b'x');
    for bytes in [
        [&b"\xff\xfe"[..], &low].concat(),
        [&b"\xfe\xff"[..], &high].concat(),
        [&b"\xef\xbb\xbf"[..], text.as_bytes()].concat(),
        low,
        high,
        odd,
    ] {
        let (builder, report) = with_mtl(&bytes).unwrap();
        assert_eq!(warnings(&report), [""; 0]);
        assert_eq!(only_material(&builder).kd, [0.25, 0.5, 0.75]);
    }
}

/// Two triangles whose materials have these names, and a file that defines them.
fn two_names(obj_names: [&[u8]; 2], mtl_names: [&[u8]; 2]) -> (SceneBuilder, Vec<String>) {
    let mut obj = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\n".to_vec();
    let mut mtl = Vec::new();
    let faces: [&[u8]; 2] = [b"f 1 2 3\n", b"f 2 4 5 3\n"];
    for ((name, face), (known, colour)) in
        obj_names.iter().zip(faces).zip(mtl_names.iter().zip([b"0.25\n", b"0.75\n"]))
    {
        obj.extend([b"usemtl ", *name, b"\n", face].concat());
        mtl.extend([b"newmtl ", *known, b"\nKd ", colour.as_slice()].concat());
    }
    let files = [("m.mtl", mtl.as_slice())];
    let (builder, report) = bare(&obj, "m.obj", &Memory(&files)).unwrap();
    (builder, warnings(&report))
}

/// Latin-1, cp1251, Shift-JIS, GBK, EUC-KR and broken names stay what they are, though the last
/// byte of a character may be a backslash; so do names with blanks, marks and quotes within.
#[test]
fn names_are_bytes() {
    let names: [[&[u8]; 2]; 13] = [
        [b"M\xe4dd", b"M\xf6dd"],
        [b"\xea\xf0", b"\xea\xf1"],
        [b"\x95\\", b"red"],
        [b"red", b"\x95\x5c"],
        [b"\x83\x5c", b"\x83\x5b"],
        [b"\xd5\x5c", b"\xd5\x5d"],
        [b"\xb0\xa1", b"\xb0\xa2"],
        ["Mädd".as_bytes(), b"M\xe4dd"],
        ["a\u{a0}".as_bytes(), b"a"],
        ["\u{10fee4}".as_bytes(), b"\xe4"],
        [b"a\\", b"a"],
        [b"red#1", b"red#2"],
        [b"Material #25", b"Material #26"],
    ];
    for pair in names {
        let (builder, told) = two_names(pair, pair);
        assert_eq!(told, [""; 0], "{pair:?}");
        assert_eq!(builder.shapes(), 3, "{pair:?}");
        let [first, second] = builder.materials() else { panic!("{:?}", builder.materials()) };
        assert_eq!((first.kd, second.kd), ([0.25; 3], [0.75; 3]), "{pair:?}");
    }
    let (builder, _) = two_names([b"M\xe4dd", b"red"], [b"M\xe4dd", b"red"]);
    assert_eq!(builder.materials()[0].name, "M\\xe4dd");
    // Groups and libraries are names, too.
    for line in [&b"g a\\"[..], b"o \x95\\", b"mtllib m.mtl", b"g a \\", b"# \\", b"usemtl b \\"] {
        let text = [b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", line, b"\nf 1 2 3\n"].concat();
        let files = Memory(&[("m.mtl", b"newmtl a\nmap_Kd a\\\nKd 0.25\nnewmtl b\\\nKd 1")]);
        let (builder, _) = bare(&text, "m.obj", &files).unwrap();
        assert_eq!(builder.shapes(), 1);
    }
}

/// `#` ends a name behind a blank, in OBJ and MTL.
#[test]
fn comments_follow_names_and_numbers() {
    let mtl = b"newmtl red # paint\nKd 0.8 0.1 0.1 # sRGB 231\nKs 0 0 0#none\nNs 10 # dull\n\
                newmtl red#2 #x\nKd .5";
    let text =
        format!("mtllib d.mtl # materials\n{TRIANGLE}usemtl red # the paint\nv 0 0 1\nf 1 2 4\n");
    let text = text.replacen("v 0", "usemtl red\t#\nv 0", 1) + "usemtl red#2\nf 1 3 4\n";
    let (builder, report) = bare(text.as_bytes(), "m.obj", &Memory(&[("d.mtl", mtl)])).unwrap();
    assert_eq!(warnings(&report), [""; 0]);
    let names: Vec<&str> = builder.materials().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "red#2"]);
    assert_eq!(builder.materials()[0].kd, [0.8, 0.1, 0.1]);
}

/// Statements without the name they are to give: no material, told once.
#[test]
fn names_that_are_blank_are_no_names() {
    let files = Memory(&[("a.mtl", b"newmtl\nKd 1 0 0\nnewmtl red\nKd 0.75")]);
    for blank in ["usemtl", "usemtl ", "usemtl\t \r", "usemtl # none"] {
        let text = format!(
            "mtllib a.mtl\nmtllib\nmtllib \nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n{blank}\nf 1 2 3\n\
             usemtl red\nf 2 3 4\n{blank}\no\ng\n"
        );
        let (builder, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
        assert_eq!(
            warnings(&report),
            [
                "m.obj:2: mtllib: no name is given (2 lines)",
                "m.obj:8: usemtl: no name is given: the faces that follow have no material (2 \
                 lines)",
                "a.mtl:1: newmtl: no name is given, so no face can have this material",
            ]
        );
        let kd: Vec<f32> = builder.materials().iter().map(|m| m.kd[0]).collect();
        assert_eq!(kd, [0.3, 0.75]);
    }
}

/// Names of libraries as programs write them, all of them for the file beside the OBJ.
#[test]
fn libraries_are_found_by_what_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let sub = folder.path().join("Sub Folder");
    std::fs::create_dir(&sub).unwrap();
    std::fs::write(folder.path().join("paint.mtl"), "newmtl red\nKd 0.25\n").unwrap();
    std::fs::write(folder.path().join("two words.mtl"), "newmtl red\nKd 0.5\n").unwrap();
    std::fs::write(folder.path().join("number #7.mtl"), "newmtl red\nKd 0.125\n").unwrap();
    std::fs::write(sub.join("other.mtl"), "newmtl red\nKd 0.75\n").unwrap();
    let read_with = |line: &[u8]| {
        let path = folder.path().join("m.obj");
        let text = [b"mtllib ", line, b"\nusemtl red\n", TRIANGLE.as_bytes()].concat();
        std::fs::write(&path, text).unwrap();
        let (builder, report) = open_bare(&path).unwrap();
        (only_material(&builder).kd[0], warnings(&report))
    };
    for (kd, name) in [
        (0.25, "paint.mtl"),
        (0.25, ".\\paint.mtl"),
        (0.25, "\"paint.mtl\""),
        (0.25, "'paint.mtl'"),
        (0.25, "\".\\paint.mtl\" # quoted"),
        (0.25, "PAINT.MTL"),
        (0.25, "Paint.Mtl"),
        (0.25, "C:\\Users\\Ann Lee\\Models\\Paint.mtl"),
        (0.25, "\"C:\\Users\\Ann Lee\\Models\\paint.mtl\""),
        (0.25, "/home/ann/models/paint.mtl"),
        (0.25, "\\\\server\\share\\paint.mtl"),
        (0.25, "file:///C:/models/paint.mtl"),
        (0.25, "../elsewhere/paint.mtl"),
        (0.25, "  paint.mtl \t"),
        (0.25, "none/two words.mtl none/paint.mtl"),
        (0.25, "\"two words.mtl\" \"paint.mtl\""),
        (0.25, "two words.mtl paint.mtl"),
        (0.25, "paint.mtl#comment"),
        (0.25, "paint.mtl# a comment"),
        (0.5, "two words.mtl"),
        (0.125, "number #7.mtl"),
        (0.5, "TWO WORDS.mtl"),
        (0.5, "two%20words.mtl"),
        (0.5, "D:\\a b\\two words.mtl"),
        (0.5, "paint.mtl two words.mtl"),
        (0.75, "Sub Folder/other.mtl"),
        (0.75, "sub folder\\OTHER.mtl"),
        (0.75, "\"sub folder\\other.mtl\""),
    ] {
        let (found, told) = read_with(name.as_bytes());
        let again = |w: &String| w.ends_with("`red` is defined again; this one counts");
        assert!(told.iter().all(again), "{name}: {told:?}");
        assert_eq!(found, kd, "{name}");
    }
    for name in ["none.mtl", "..", "/", "\"", "\"\"", ".\\", "x/..", "Sub Folder", "\\", "%20"] {
        let (found, told) = read_with(name.as_bytes());
        assert_eq!(found, 0.3, "{name}");
        assert!(told.iter().any(|w| w.contains("mtllib: cannot read")), "{name}: {told:?}");
    }
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let name = b"M\xe4\x95\\.mtl";
        let path = folder.path().join(std::ffi::OsStr::from_bytes(name));
        std::fs::write(path, "newmtl red\nKd 0.125\n").unwrap();
        assert_eq!(read_with(name), (0.125, vec![]));
    }
}

/// A library that is named again is neither read nor told again, however it is called.
#[test]
fn a_library_is_read_once() {
    use std::cell::Cell;
    struct Counting<'a>(Memory<'a>, Cell<usize>);
    impl burnish::scene::read::Files for Counting<'_> {
        fn find(
            &self,
            name: &str,
        ) -> Result<(std::path::PathBuf, std::borrow::Cow<'_, [u8]>), std::io::Error> {
            self.1.set(self.1.get() + 1);
            self.0.find(name)
        }
    }
    let memory = Memory(&[("a.mtl", b"newmtl m\nKd 0.25\n"), ("b.mtl", b"newmtl m\nKd 0.250")]);
    let files = Counting(memory, Cell::new(0));
    let text = "usemtl m\nmtllib a.mtl\n".repeat(1000) + TRIANGLE;
    let (builder, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
    assert_eq!((warnings(&report), files.1.get()), (vec![], 1));
    assert_eq!(only_material(&builder).kd, [0.25; 3]);
    // In other words, and another file that says the same.
    for line in ["mtllib A.MTL", "mtllib \"a.mtl\"", "mtllib a.mtl a.mtl", "mtllib b.mtl"] {
        let text = format!("mtllib a.mtl\n{line}\nusemtl m\n{TRIANGLE}");
        let (_, report) = bare(text.as_bytes(), "m.obj", &files).unwrap();
        assert_eq!(warnings(&report), [""; 0], "{line}");
    }
}
