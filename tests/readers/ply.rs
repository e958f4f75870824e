//! PLY in its three encodings.

use super::{Read, message, triangles, warnings};
use burnish::scene::Scene;
use burnish::scene::read::{self, Memory};

fn ply(bytes: &[u8]) -> Read {
    read::read(bytes, "m.ply".as_ref(), &Memory(&[]))
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
    let (builder, report) = read::open("tests/data/leaf.ply".as_ref()).unwrap();
    assert_eq!((builder.environment, builder.camera, builder.shapes()), ([1.0; 3], None, 3));
    assert_eq!(
        report.notes[1..],
        [
            "a PLY file has no material: a diffuse grey of Kd 0.5 is used",
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
        ("element face", "element strip", " the PLY header declares no element `face`"),
        (
            "float z",
            "float w",
            " the PLY header must declare the vertex properties x, y and z as single numbers",
        ),
        (
            "uchar int",
            "uchar float",
            " the PLY header must declare `property list uchar int vertex_indices`, or \
             another list of whole numbers of that name, for the element `face`",
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
        ("face 1", "face 2", " expected 2 elements `face`; the file ends after 1 among them"),
        ("3 0 1 2\n", "", " expected 1 elements `face`; the file ends after 0 among them"),
        ("0 1 0", "0 1", "12: expected the values of `x y z` of an element `vertex`, not `0 1`"),
        (
            "3 0 1 2",
            "3 0 1 two",
            "13: expected the values of `vertex_indices` of an element `face`, not `3 0 1 \
             two`",
        ),
        ("3 0 1 2", "3 0 1 -2", "13: the vertex indices of a face must not be negative"),
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
    assert_eq!(
        message(ply(&bad)),
        "m.ply: face number 5: the vertex indices of a face must not be negative"
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
            let (builder, report) = read::read(&bytes, "m.ply".as_ref(), &Memory(&[])).unwrap();
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
