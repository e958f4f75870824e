//! PLY in its three encodings.

use super::{Read, bare, message, open_bare, triangles, warnings};
use burnish::scene::Scene;
use burnish::scene::read::Memory;

fn ply(bytes: &[u8]) -> Read {
    bare(bytes, "m.ply", &Memory(&[]))
}

/// How the values of a file are written.
#[derive(Clone, Copy, Debug)]
enum Order {
    Ascii,
    Little,
    Big,
}

/// A PLY file in the making, one value at a time.
struct Writer {
    order: Order,
    bytes: Vec<u8>,
}

macro_rules! value {
    ($name:ident, $kind:ty) => {
        fn $name(&mut self, x: $kind) {
            match self.order {
                Order::Ascii => self.bytes.extend(format!("{x} ").bytes()),
                Order::Little => self.bytes.extend(x.to_le_bytes()),
                Order::Big => self.bytes.extend(x.to_be_bytes()),
            }
        }
    };
}

impl Writer {
    fn new(order: Order, header: &str) -> Writer {
        let format = match order {
            Order::Ascii => "ascii",
            Order::Little => "binary_little_endian",
            Order::Big => "binary_big_endian",
        };
        let text = format!("ply\nformat {format} 1.0\n{header}end_header\n");
        Writer { order, bytes: text.into_bytes() }
    }
    value!(byte, u8);
    value!(short, i16);
    value!(int, i32);
    value!(uint, u32);
    value!(long, i64);
    value!(ulong, u64);
    value!(float, f32);
    value!(double, f64);
    fn end(&mut self) {
        if let Order::Ascii = self.order {
            self.bytes.push(b'\n');
        }
    }
}

/// A pyramid with a square base: doubles and floats, a list between, an element in front.
fn pyramid(order: Order, corners: &str) -> Vec<u8> {
    let mut w = Writer::new(
        order,
        &format!(
            "comment caf\u{e9}\nobj_info none\nelement camera 1\nproperty list uint8 int16 views\n\
             property double focus\nelement vertex 5\nproperty float32 x\nproperty float64 y\n\
             property uchar red\nproperty int z\nelement face 5\nproperty short flag\n\
             property list uint8 {corners}\n"
        ),
    );
    w.byte(2);
    w.short(-7);
    w.short(8);
    w.double(0.125);
    w.end();
    for (x, y, z) in
        [(0.5, 0.25, 3), (-1.0, -1.0, 0), (1.0, -1.0, 0), (1.0, 1.0, 0), (-1.0, 1.0, 0)]
    {
        w.float(x);
        w.double(y);
        w.byte(255);
        w.int(z);
        w.end();
    }
    for face in [&[1, 2, 0][..], &[2, 3, 0], &[3, 4, 0], &[4, 1, 0], &[4, 3, 2, 1]] {
        w.short(-1);
        w.byte(face.len() as u8);
        for &i in face {
            match corners.split(' ').next() {
                Some("int") => w.int(i),
                Some("uint32") => w.uint(i as u32),
                Some("short") => w.short(i as i16),
                _ => w.byte(i as u8),
            }
        }
        w.end();
    }
    w.bytes
}

fn same(a: &Scene, b: &Scene) -> bool {
    triangles(a) == triangles(b) && a.geometry().vertices() == b.geometry().vertices()
}

#[test]
fn all_encodings_and_type_names_give_the_same_mesh() {
    let expected = ply(&pyramid(Order::Ascii, "int vertex_indices")).unwrap().0.build();
    assert_eq!(expected.counts().triangles, 6);
    for order in [Order::Ascii, Order::Little, Order::Big] {
        for corners in [
            "int vertex_indices",
            "uint32 vertex_index",
            "short vertex_index",
            "uint8 vertex_indices",
        ] {
            let (builder, report) = ply(&pyramid(order, corners)).unwrap();
            assert_eq!(warnings(&report), [""; 0]);
            assert_eq!(report.notes[0], "m.ply: not used: element camera, red, face flag");
            assert!(same(&builder.build(), &expected), "{order:?} {corners}");
        }
    }
}

#[test]
fn a_ply_alone_is_grey_and_lit() {
    let (builder, report) = open_bare("tests/data/leaf.ply".as_ref()).unwrap();
    assert_eq!((builder.environment, builder.camera, builder.shapes()), ([1.0; 3], None, 3));
    assert_eq!(
        report.notes[1..],
        [
            "a PLY file has no material: a glossy grey of Kd 0.3, Ks 0.2, alpha 0.25 is used",
            "normals: smooth over edges below 45 degrees for 3 triangles",
            "nothing in the file emits: lit by a uniform white environment of radiance 1",
        ]
    );
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                    property float z\n";
const FACE: &str = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

#[test]
fn numbers_as_other_programs_print_them() {
    let plain = ply(format!("{HEAD}{FACE}0 0 0\n1 0 0\n0.5 1 0\n3 0 1 2\n").as_bytes()).unwrap();
    let expected = plain.0.build();
    for body in [
        "0. 0 -0.0\r\n+1.0 0 0\r\n.5 1e0 0\r\n3 0 1 2\r\n",
        "\n0 0 0\n\n  1 0 0\n5.e-1 1 0\n\n3 0 1 2",
    ] {
        let (builder, report) = ply(format!("{HEAD}{FACE}{body}").as_bytes()).unwrap();
        assert_eq!(warnings(&report), [""; 0]);
        assert!(same(&builder.build(), &expected), "{body}");
    }
}

#[test]
fn normals_are_used_and_bad_ones_counted() {
    let head = HEAD.to_owned() + "property float nx\nproperty float ny\nproperty float nz\n" + FACE;
    let body = "0 0 0 0 3 4\n1 0 0 nan 0 0\n0 1 0 0 0 0\n3 0 1 2\n";
    let (builder, report) = ply((head + body).as_bytes()).unwrap();
    assert_eq!(
        warnings(&report),
        ["m.ply: the normal of 2 vertices is zero or not finite: that of the face is used"]
    );
    let scene = builder.build();
    let normals: Vec<[f32; 3]> = scene.geometry().vertices().iter().map(|v| v.normal).collect();
    assert_eq!(normals, [[0.0, 0.6, 0.8], [0.0; 3], [0.0; 3]]);
}

#[test]
fn what_is_left_over_or_left_out_is_told() {
    let face = FACE.replace("face 1", "face 4");
    let body = "0 0 0\n1 0 0\nnan 1 0\n3 0 1 2\n2 0 1\n3 0 1 7\n0\nmore\n";
    assert_eq!(
        message(ply(format!("{HEAD}{face}{body}").as_bytes())),
        "m.ply: nothing is left to show: 2 of 2 triangles are left out: 1 with a vertex that is \
         not finite or beyond 1e18, 1 with an index that names no vertex"
    );
    let body = body.replace("nan", "2");
    let (_, report) = ply(format!("{HEAD}{face}{body}").as_bytes()).unwrap();
    assert_eq!(
        warnings(&report),
        [
            "m.ply:17: this line and those after it belong to no element and are not used",
            "m.ply: 2 faces of fewer than three corners are left out",
            "m.ply: 1 of 2 triangles are left out: 1 with an index that names no vertex",
        ]
    );
    let body = "0 0 0 9\n1 0 0\n0 1 0 9 9\n3 0 1 2 0\n";
    let (_, report) = ply(format!("{HEAD}{FACE}{body}").as_bytes()).unwrap();
    let more =
        "this one first, have more values than it has properties; the last ones are not used";
    assert_eq!(
        warnings(&report),
        [
            format!("m.ply:10: 2 lines of the element `vertex`, {more}"),
            format!("m.ply:13: 1 lines of the element `face`, {more}"),
        ]
    );
    let mut bytes = pyramid(Order::Big, "int vertex_indices");
    bytes.extend([1, 2, 3]);
    let (_, report) = ply(&bytes).unwrap();
    assert_eq!(warnings(&report), ["m.ply: 3 bytes after the last element are not used"]);
}

#[test]
fn each_error_says_what_was_expected() {
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let good = format!("{HEAD}{FACE}{body}");
    let twice = " the PLY header declares two elements, or two properties of one element, of the \
                 same name";
    for (from, to, expected) in [
        (good.as_str(), "", " the file is empty"),
        ("ply\n", "plyx\n", "1: expected `ply` on the first line of a PLY file"),
        ("end_header\n", "", " expected a line `end_header` at the end of the PLY header"),
        (
            "float y",
            "real y",
            "5: expected a PLY header line such as `element vertex 8` or `property float x`, not \
             `property real y`",
        ),
        (
            "ascii",
            "utf8",
            "2: expected a PLY header line such as `element vertex 8` or `property float x`, not \
             `format utf8 1.0`",
        ),
        (
            "format ascii 1.0\n",
            "",
            " expected a line `format ascii 1.0`, `format binary_little_endian 1.0` or \
             `format binary_big_endian 1.0` in the PLY header",
        ),
        ("element vertex", "element point", " the PLY header declares no element `vertex`"),
        (
            "element face",
            "element strip",
            " the PLY header declares no element `face`, and no `tristrips`",
        ),
        (
            "float z",
            "float w",
            " the PLY header must declare the vertex properties x, y and z as single numbers",
        ),
        (
            "list uchar int",
            "int",
            " the PLY header must declare `property list uchar int vertex_indices`, or another list \
             of that name, for the element `face`",
        ),
        (
            "end_header",
            "property list uchar int vertex_index\nend_header",
            " the PLY header must declare one of vertex_indices and vertex_index, not both",
        ),
        ("float y", "float x", twice),
        ("element face 1", "element vertex 3\nelement face 1", twice),
        (
            "vertex 3",
            "vertex 18446744073709551615",
            " the PLY header announces 18446744073709551615 elements `vertex` of at least 6 bytes, \
                 but only 26 bytes follow: the file is cut short or its header wrong",
        ),
        ("face 1", "face 2", "13: expected 2 elements `face`; the file ends after 1 among them"),
        ("3 0 1 2\n", "", "12: expected 1 elements `face`; the file ends after 0 among them"),
        ("0 1 0", "0 1", "12: expected the values of `x y z` of an element `vertex`, not `0 1`"),
        (
            "3 0 1 2",
            "3 0 1 two",
            "13: expected the values of `vertex_indices` of an element `face`, not `3 0 1 \
             two`",
        ),
        (
            "3 0 1 2",
            "3 0 1 -2",
            " nothing is left to show: 1 of 1 triangles are left out: 1 with an index that names no \
             vertex",
        ),
        ("3 0 1 2", "3 0 1 0.5", "13: the vertex indices of a face must be whole numbers"),
        ("3 0 1 2", "3 0 1 nan", "13: the vertex indices of a face must be whole numbers"),
        ("3 0 1 2", "0", " the file has no faces, so there is nothing to show"),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from}");
        assert_eq!(message(ply(bad.as_bytes())), format!("m.ply:{expected}"), "{from:?} to {to:?}");
    }
}

#[test]
fn binary_files_that_end_early_or_lie() {
    for order in [Order::Little, Order::Big] {
        let good = pyramid(order, "int vertex_indices");
        for cut in 1..100 {
            let text = message(ply(&good[..good.len() - cut]));
            assert!(
                text.ends_with("the file ends among them")
                    || text.ends_with("the file is cut short or its header wrong"),
                "{cut}: {text}"
            );
        }
    }
    let mut bad = pyramid(Order::Little, "int vertex_indices");
    let last = bad.len() - 1;
    bad[last] = 0xff;
    let (builder, report) = ply(&bad).unwrap();
    assert_eq!(builder.shapes(), 5);
    assert_eq!(
        warnings(&report),
        ["m.ply: 1 of 6 triangles are left out: 1 with an index that names no vertex"]
    );
    // Elements without properties take no bytes, so any count of them fits.
    for format in ["ascii", "binary_little_endian"] {
        let header = format!(
            "ply\nformat {format} 1.0\nelement nothing 18446744073709551615\nelement vertex 0\n\
             property float x\nproperty float y\nproperty float z\n{FACE}"
        );
        let text = message(ply(header.replace("face 1", "face 0").as_bytes()));
        assert_eq!(text, "m.ply: the file has no faces, so there is nothing to show");
    }
}

/// An L of area 3 from any first corner, and outlines that cross themselves, in every encoding.
#[test]
fn polygons_are_cut_by_their_shape() {
    let corners = [[0u8, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    for first in 0..6u8 {
        for (format, crossed) in
            [("ascii", false), ("binary_little_endian", false), ("binary_big_endian", true)]
        {
            let mut bytes = format!(
                "ply\nformat {format} 1.0\nelement vertex 6\nproperty uchar x\nproperty uchar y\n\
                 property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\n\
                 end_header\n"
            )
            .into_bytes();
            let mut order: Vec<u8> = (0..6).map(|i| (first + i) % 6).collect();
            if crossed {
                order.swap(0, 3);
            }
            let vertices = corners.iter().map(|[x, y]| vec![*x, *y, 0]);
            for line in vertices.chain([[vec![6], order].concat()]) {
                if format == "ascii" {
                    let words: Vec<String> = line.iter().map(u8::to_string).collect();
                    bytes.extend((words.join(" ") + "\n").bytes());
                } else {
                    bytes.extend(line);
                }
            }
            let (builder, report) = bare(&bytes, "m.ply", &Memory(&[])).unwrap();
            let told = warnings(&report).join("\n");
            assert_eq!(told.contains("of 1 polygons, of face 1 first, crosses itself"), crossed);
            if !crossed {
                assert_eq!(told, "");
                let area: f64 = triangles(&builder.build())
                    .iter()
                    .map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length())
                    .sum();
                assert!((area - 3.0).abs() < 1e-6, "{first}: {area}");
            }
        }
    }
}

const ORDERS: [Order; 3] = [Order::Ascii, Order::Little, Order::Big];

/// Kinds: CR alone, LF CR and blank lines in the header, in ASCII and in binary, whose first value
/// may look like a line end; keywords and names in capitals.
#[test]
fn headers_end_their_lines_in_any_way_and_shout() {
    let expected = ply(&pyramid(Order::Ascii, "int vertex_indices")).unwrap().0.build();
    for order in ORDERS {
        let plain = pyramid(order, "int vertex_indices");
        let at = plain.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let (head, payload) = plain.split_at(at);
        let head = String::from_utf8(head.to_vec()).unwrap();
        for end in ["\n", "\r\n", "\r", "\n\r", "\r\r\n"] {
            for shout in [false, true] {
                let head = if shout { head.to_uppercase() } else { head.clone() };
                let blank = head.replacen("\n", "\n\n", 1).replace("float64", "float64_t");
                for head in [&head, &blank.replace("\nELEMENT", "\n\n \t\nELEMENT")] {
                    let mut bytes = head.replace('\n', end).into_bytes();
                    match order {
                        Order::Ascii => {
                            let text = String::from_utf8(payload.to_vec()).unwrap();
                            bytes.extend(text.replace('\n', end).into_bytes());
                        }
                        _ => bytes.extend(payload),
                    }
                    let (builder, report) =
                        ply(&bytes).unwrap_or_else(|e| panic!("{order:?} {end:?} {head}: {e}"));
                    assert_eq!(warnings(&report), [""; 0]);
                    assert!(same(&builder.build(), &expected), "{order:?} {end:?} {head}");
                }
            }
        }
    }
    // Values that begin with what could be a part of a line's end.
    for end in ["\n", "\r\n", "\r", "\n\r"] {
        for first in [*b"\n\0\0\0", *b"\r\0\0\0", *b"\r\n\0\0", *b"\n\r\0\0", *b"\n\n\0\0"] {
            let head = HEAD.replace("ascii", "binary_little_endian") + FACE;
            let mut bytes = head.replace('\n', end).into_bytes();
            bytes.extend(first);
            for x in [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
                bytes.extend(x.to_le_bytes());
            }
            bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
            let (builder, report) =
                ply(&bytes).unwrap_or_else(|e| panic!("{end:?} {first:?}: {e}"));
            assert_eq!((builder.shapes(), warnings(&report)), (1, vec![]), "{end:?} {first:?}");
        }
    }
}

#[test]
fn the_line_of_an_error_counts_lines_however_they_end() {
    let bad = format!("{HEAD}{FACE}0 0 0\n1 0 0\n0 x 0\n3 0 1 2\n");
    for end in ["\n", "\r\n", "\r", "\n\r"] {
        let text = message(ply(bad.replace('\n', end).as_bytes()));
        assert!(text.starts_with("m.ply:12: "), "{end:?}: {text}");
    }
}

/// Kind: what a header may hold that plays no part.
#[test]
fn comments_and_unused_properties_may_be_anything() {
    let head = HEAD
        .replace("ply\n", "ply\ncomment x\n")
        .replace("element", "obj_info num_cols 512\nobj_info\ncomment\ncomment \n\nelement");
    let face =
        FACE.replace("end_header", "comment TextureFile a b.png\nCOMMENT caf\u{e9}\nend_header");
    let extra = "property float quality-1\nproperty list uchar float caf\u{e9}.tags\n\
                 property uchar red\nproperty uchar red\n";
    let body = "0 0 0 1 2 9 9 1 1\n1 0 0 .5 0 300 1\n0 1 0 nan 1 x -1 0x1f\n3 0 1 2\n";
    let (builder, report) = ply(format!("{head}{extra}{face}{body}").as_bytes()).unwrap();
    assert_eq!(builder.shapes(), 1);
    let told = |n, name, count| {
        format!(
            "m.ply:{n}: {count} values of `{name}` of the element `vertex`, on this line first, \
             are not of the type that the header declares; they are not used"
        )
    };
    assert_eq!(
        warnings(&report),
        [told(23, "red", 2), told(24, "caf\u{e9}.tags", 1), told(24, "red", 1)]
    );
    assert_eq!(report.notes[0], "m.ply: not used: quality-1, caf\u{e9}.tags, red, red");
}

/// Kind: values of unused properties that their type cannot hold.
#[test]
fn unused_values_out_of_range_are_told() {
    for (kind, value, odd) in [
        ("uchar", "-1", true),
        ("uchar", "256", true),
        ("uchar", "0.5", true),
        ("char", "128", true),
        ("ushort", "65536", true),
        ("int", "2147483648", true),
        ("int64", "9223372036854775807", false),
        ("float", "1.#QNAN", false),
        ("float", "red", true),
        ("double", "-nan(ind)", false),
    ] {
        let head = format!("{HEAD}property {kind} red\n{FACE}");
        let body = format!("0 0 0 {value}\n1 0 0 1\n0 1 0 {value}\n3 0 1 2\n");
        let (builder, report) = ply(format!("{head}{body}").as_bytes()).unwrap();
        assert_eq!(builder.shapes(), 1);
        let text = "m.ply:11: 2 values of `red` of the element `vertex`, on this line first, are \
                    not of the type that the header declares; they are not used";
        let expected: &[&str] = if odd { &[text] } else { &[] };
        assert_eq!(warnings(&report), expected, "{kind} {value}");
    }
    // What is used counts as it stands.
    let head = HEAD.replace("float", "int") + &FACE.replace("uchar int", "uchar char");
    let body = "0 0 0\n1.5 0 0\n0 3e9 0\n3.0 0 1.0 2\n";
    let (builder, report) = ply(format!("{head}{body}").as_bytes()).unwrap();
    assert_eq!(warnings(&report), [""; 0]);
    let [triangle] = triangles(&builder.build())[..] else { panic!("one triangle") };
    assert!((triangle[2].y - 3e9).abs() < 1e3, "{triangle:?}");
}

/// Kind: every spelling of what is no number.
#[test]
fn numbers_that_are_none_are_read_in_every_spelling() {
    for token in [
        "nan",
        "-nan",
        "NaN",
        "-nan(ind)",
        "nan(snan)",
        "-1.#IND",
        "1.#QNAN",
        "1.#QNAN0",
        "1.#INF",
        "-1.#INF00",
        "1.#SNAN",
        "inf",
        "-Infinity",
        "INF",
        "1e999",
    ] {
        let head = HEAD.to_owned() + "property float nx\nproperty float ny\nproperty float nz\n";
        let body = format!("0 0 0 0 0 1\n1 0 0 0 {token} 1\n0 1 0 0 0 1\n3 0 1 2\n");
        let (builder, report) = ply(format!("{head}{FACE}{body}").as_bytes()).unwrap();
        assert_eq!((builder.shapes(), warnings(&report).len()), (1, 1), "{token}: {report:?}");
        assert!(warnings(&report)[0].contains("the normal of 1 vertices"), "{token}");

        let body = format!("0 0 0\n1 0 0\n0 1 0\n{token} 1 0\n3 0 1 2\n3 0 1 3\n");
        let head = HEAD.replace("vertex 3", "vertex 4") + &FACE.replace("face 1", "face 2");
        let (builder, report) = ply(format!("{head}{body}").as_bytes()).unwrap();
        assert_eq!(builder.shapes(), 1, "{token}");
        assert!(warnings(&report)[0].contains("1 with a vertex that is not finite"), "{token}");
    }
}

/// Kinds: whole numbers of 64 bits, and lists of other numbers than small whole ones.
#[test]
fn numbers_of_every_type_are_read_in_every_place() {
    let expected = ply(&pyramid(Order::Ascii, "int vertex_indices")).unwrap().0.build();
    for order in ORDERS {
        for length in ["uchar", "int", "uint64", "int64", "float", "double", "short"] {
            for index in ["int64", "uint64", "float", "double", "uint", "char"] {
                let mut w = Writer::new(
                    order,
                    &format!(
                        "element face 5\nproperty uint64 flag\nproperty list {length} {index} \
                         vertex_indices\nproperty list double int64 tags\nelement vertex 5\n\
                         property double x\nproperty uint64 id\nproperty float y\n\
                         property int64 z\n"
                    ),
                );
                for face in [&[1, 2, 0][..], &[2, 3, 0], &[3, 4, 0], &[4, 1, 0], &[4, 3, 2, 1]] {
                    w.ulong(u64::MAX);
                    let n = face.len();
                    match length {
                        "uchar" => w.byte(n as u8),
                        "int" => w.int(n as i32),
                        "uint64" => w.ulong(n as u64),
                        "int64" => w.long(n as i64),
                        "float" => w.float(n as f32),
                        "double" => w.double(n as f64),
                        _ => w.short(n as i16),
                    }
                    for &i in face {
                        match index {
                            "int64" => w.long(i),
                            "uint64" => w.ulong(i as u64),
                            "float" => w.float(i as f32),
                            "double" => w.double(i as f64),
                            "uint" => w.uint(i as u32),
                            _ => w.byte(i as u8),
                        }
                    }
                    w.double(2.0);
                    w.long(-1);
                    w.long(i64::MIN);
                    w.end();
                }
                for (x, y, z) in
                    [(0.5, 0.25, 3), (-1.0, -1.0, 0), (1.0, -1.0, 0), (1.0, 1.0, 0), (-1.0, 1.0, 0)]
                {
                    w.double(x);
                    w.ulong(7);
                    w.float(y);
                    w.long(z);
                    w.end();
                }
                let (builder, report) =
                    ply(&w.bytes).unwrap_or_else(|e| panic!("{order:?} {length} {index}: {e}"));
                assert_eq!(warnings(&report), [""; 0]);
                assert!(same(&builder.build(), &expected), "{order:?} {length} {index}");
                // Cut anywhere, it is an error.
                for cut in [1, 9, 50] {
                    assert!(
                        matches!(order, Order::Ascii)
                            || ply(&w.bytes[..w.bytes.len() - cut]).is_err()
                    );
                }
            }
        }
    }
}

/// Kind: elements wrapped over lines, or several on one.
#[test]
fn values_may_be_on_any_lines_if_all_are_used_up() {
    let plain = format!("{HEAD}{FACE}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let expected = ply(plain.as_bytes()).unwrap().0.build();
    for (body, line) in [
        ("0 0 0\n1 0 0\n0 1 0\n3 0\n1 2\n", 13),
        ("0\n0\n0\n1\n0\n0\n0\n1\n0\n3\n0\n1\n2\n", 10),
        ("0 0 0 1 0 0 0 1 0 3 0 1 2", 10),
        ("0 0 0 1\n0 0 0 .5e1\n0 3 0 1 2", 10),
        ("0 0 0\n1 0 0\n0 1 0 3 0 1 2", 12),
        ("0 0 0\r1 0\r\r0 0 1 0\r3 0 1 2", 11),
    ] {
        let (builder, report) = ply(format!("{HEAD}{FACE}{body}").as_bytes()).expect(body);
        let [warning] = &warnings(&report)[..] else { panic!("{body}: {report:?}") };
        assert!(warning.starts_with(&format!("m.ply:{line}: from here on")), "{body}: {warning}");
        assert_eq!(builder.shapes(), 1);
        assert!(body.contains(".5e1") || same(&builder.build(), &expected), "{body}");
    }
    // One too few or too many would shift what follows: that is no mesh.
    for (body, line) in [
        ("0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 11),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 13),
        ("0 0 0\n1 0\n0 0 1 0\n3 0 1 2 7\n", 11),
        ("0 0 0 1 0 0 0 1 0 3 0 1", 10),
    ] {
        let text = message(ply(format!("{HEAD}{FACE}{body}").as_bytes()));
        assert!(text.starts_with(&format!("m.ply:{line}: expected")), "{body}: {text}");
    }
}

/// Kind: strips of triangles, which -1 ends.
#[test]
fn strips_are_unrolled() {
    let strip = |order: Order, kind: &str, name: &str, indices: &[i64], more: &str| {
        let header = format!(
            "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
             element {name} 1\nproperty list int {kind} vertex_indices\n{more}"
        );
        let mut w = Writer::new(order, &header);
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.0, 2.0)] {
            w.float(x);
            w.float(y);
            w.float(0.0);
            w.end();
        }
        w.int(indices.len() as i32);
        for &i in indices {
            match kind {
                "uint" => w.uint(i as u32),
                "short" => w.short(i as i16),
                "uchar" => w.byte(i as u8),
                "float" => w.float(i as f32),
                "int64" => w.long(i),
                _ => w.int(i as i32),
            }
        }
        w.end();
        w.bytes
    };
    let corners = |bytes: &[u8]| {
        let (builder, report) = ply(bytes).unwrap();
        let corners: Vec<[[i32; 2]; 3]> = triangles(&builder.build())
            .iter()
            .map(|t| t.map(|p| [p.x.round() as i32, p.y.round() as i32]))
            .collect();
        (corners, warnings(&report))
    };
    let [a, b, c, d, e] = [[0, 0], [1, 0], [0, 1], [1, 1], [0, 2]];
    // Every other triangle is turned, so that all face one way.
    let whole = vec![[a, b, c], [c, b, d], [c, d, e]];
    for order in ORDERS {
        for kind in ["int", "uint", "short", "uchar", "float", "int64"] {
            for name in ["tristrips", "TriStrips", "tristrip"] {
                let bytes = strip(order, kind, name, &[0, 1, 2, 3, 4, -1], "");
                assert_eq!(corners(&bytes), (whole.clone(), vec![]), "{order:?} {kind} {name}");
            }
            // Each strip begins anew; a corner that comes twice is a way, not a triangle.
            let bytes = strip(order, kind, "tristrips", &[0, 1, 2, -1, 1, 3, 2, -1, -1], "");
            assert_eq!(corners(&bytes), (vec![[a, b, c], [b, d, c]], vec![]), "{order:?} {kind}");
            let bytes = strip(order, kind, "tristrips", &[0, 1, 2, 2, 3, 3, 4], "");
            assert_eq!(corners(&bytes).0.len(), 1);
            let bytes = strip(order, kind, "tristrips", &[0, 1, 2, -1, 3, 4, -1, 1], "");
            let told = "m.ply: 2 strips of fewer than three corners are left out".to_owned();
            assert_eq!(corners(&bytes), (vec![[a, b, c]], vec![told]), "{order:?} {kind}");
        }
        // Beside faces, of which there may be none.
        let more = "element face 0\nproperty list uchar int vertex_indices\n";
        assert_eq!(corners(&strip(order, "int", "tristrips", &[0, 1, 2, 3, 4], more)).0, whole);
    }
    let text = message(ply(&strip(Order::Ascii, "int", "tristrips", &[0, 1, -1, 2, 3], "")));
    assert_eq!(text, "m.ply: the file has no faces, so there is nothing to show");
}

/// Kind: geometry that is left out.
#[test]
fn geometry_that_is_left_out_is_a_warning() {
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0 1\n1 2\n";
    for (element, warns) in [
        ("edge 2\nproperty int vertex1\nproperty int vertex2", true),
        ("Edge 2\nproperty int a\nproperty int b", true),
        ("range_grid 2\nproperty list uchar int vertex_indices", true),
        ("wire 2\nproperty int vertex_a\nproperty int b", true),
        ("material 2\nproperty int ambient_red\nproperty int b", false),
        ("multi_texture_face 2\nproperty uchar tx\nproperty list uchar float tex_coord", false),
    ] {
        let name = element.split(' ').next().unwrap().to_ascii_lowercase();
        let body = if element.contains("list") {
            body.replace("0 1\n1 2\n", "1 1 0\n1 1 0\n")
        } else {
            body.to_owned()
        };
        let body = if element.contains("vertex_indices") {
            body.replace("1 1 0\n", "1 2\n")
        } else {
            body
        };
        let face = FACE.replace("end_header", &format!("element {element}\nend_header"));
        let (builder, report) = ply(format!("{HEAD}{face}{body}").as_bytes()).expect(element);
        assert_eq!(builder.shapes(), 1);
        let text = format!(
            "m.ply:9: 2 elements `{name}` are left out: of geometry only faces and tristrips are \
             shown"
        );
        assert_eq!(warnings(&report), if warns { vec![text] } else { vec![] }, "{element}");
        let noted = report.notes[0].contains(&format!("element {name}"));
        assert_eq!(noted, !warns, "{element}: {:?}", report.notes);
    }
}

/// Kind: only the first of several errors is told.
#[test]
fn all_errors_of_an_ascii_file_are_told() {
    let head = HEAD.replace("vertex 3", "vertex 60");
    let body = "0 0 0\n".repeat(10) + &"0 zero 0\n".repeat(50) + "3 0 1 0.5\n";
    let error = ply(format!("{head}{FACE}{body}").as_bytes()).unwrap_err();
    assert_eq!(error.place.line, Some(20));
    let text = error.to_string();
    assert_eq!(text.lines().count(), 21, "{text}");
    assert!(text.lines().nth(19).unwrap().starts_with("m.ply:39: "), "{text}");
    assert!(text.ends_with("\nm.ply: 31 further errors are not listed"), "{text}");
}
