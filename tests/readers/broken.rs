//! No input may panic, hang or eat memory.

use super::bounded::{EACH, FREE, bounded, is_alone};
use super::mutate::{Random, WORDS};
use super::text;
use burnish::geometry::Ray;
use burnish::math::V3;
use burnish::scene::read::{self, Memory};
use burnish::scene::{SceneBuilder, builtin};
use std::path::Path;

/// A line for each error, and not very many.
fn is_short(message: &str) -> bool {
    message.lines().count() <= 21 && message.lines().all(|line| line.len() < 500)
}

#[test]
fn broken_files_are_errors() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                end_header\n";
    let binary = head.replace("ascii", "binary_little_endian");
    let long = "9".repeat(1 << 20);
    let garbage: String = (0..4000u32).map(|i| char::from((i * i % 251) as u8 | 1)).collect();
    let cases: Vec<(&str, String)> = vec![
        ("a.scn", String::new()),
        ("a.scn", "\u{feff}".into()),
        ("a.scn", "\n\n\n".into()),
        ("a.scn", "\0\0\0\0".into()),
        ("a.scn", garbage.clone()),
        ("a.scn", "s\0p\0h\0e\0r\0e\0".into()),
        ("a.scn", "sphere 0 0 0".into()),
        ("a.scn", "sphere 0;0;0;1".into()),
        ("a.scn", "sphere inf 0 0 1".into()),
        ("a.scn", format!("sphere {long} 0 0 1")),
        ("a.scn", "sphere 0 0 0 1e-999".into()),
        ("a.scn", "sphere 0 0 0 1e999".into()),
        ("a.scn", "box 0 0 0 1e300 1 1".into()),
        ("a.scn", "box 0 0 0 0 0 0".into()),
        ("a.scn", "cylinder 0 0 0 0 0 1e-200 1".into()),
        ("a.scn", "camera 0 0 0 -1".into()),
        ("a.scn", "camera 1e400 0 0 1".into()),
        ("a.scn", "camera 0 0 0 1 q".into()),
        ("a.scn", "camera 0 0 0 1 q 1e999 0 0 0".into()),
        ("a.scn", "screen 99999 99999".into()),
        ("a.scn", "screen -1 1".into()),
        ("a.scn", "screen 1e999 1".into()),
        ("a.scn", "brdf 1 1 1 1 1 1 -1".into()),
        ("a.scn", "brdf 1 1 1 1 1 1 1 1".into()),
        ("a.scn", "brdf 0xff 0 0 0 0 0 \u{fffd}".into()),
        ("a.scn", "light 1e999 0 0".into()),
        ("a.scn", "environment 1 1".into()),
        ("a.scn", "mesh ../../../../etc/passwd.ply 0 0 0 1".into()),
        ("a.scn", "mesh a.scn 0 0 0 1".into()),
        ("a.obj", String::new()),
        ("a.obj", garbage.clone()),
        ("a.obj", vertices.into()),
        ("a.obj", format!("{vertices}f 1 2 18446744073709551615")),
        ("a.obj", format!("{vertices}f 1 2 4294967299")),
        ("a.obj", format!("{vertices}f 1 2 -9223372036854775808")),
        ("a.obj", format!("{vertices}v {long} x 0\nf 1 2 3")),
        ("a.obj", "v 1e999 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3".into()),
        ("a.obj", "v 1e19 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 3".into()),
        ("a.obj", "v 1e39 0 0\nv 1e39 0 0\nv 1e39 1 0\nf 1 2 3".into()),
        ("a.obj", format!("{}\\", "v 0 0 0 \\\n".repeat(1000))),
        ("a.ply", garbage),
        ("a.ply", "ply".into()),
        ("a.ply", "ply\nend_header\n".into()),
        ("a.ply", head.into()),
        ("a.ply", head.replace("face 1", "face 99999999999999999999999")),
        ("a.ply", head.replace("face 1", "face 1000000000000")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 4294967296")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 1 0\n-3 0 1 2")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 1 0\n1e300 0 1 2")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 1 0\nnan 0 1 2")),
        ("a.ply", format!("{head}{}", "\n\r".repeat(100_000))),
        ("a.ply", head.replace("element face", "element tristrips").replace("face 1", "face 9")),
        ("a.ply", format!("{head}0 0 0\n1 0 0\n0 {long}x 0\n3 0 1 2")),
        ("a.ply", format!("{}{}", binary.replace("uchar int", "uint int"), "\u{7f}".repeat(80))),
        ("a.ply", format!("{}{}", binary.replace("uchar int", "float int"), "\u{7f}".repeat(80))),
        ("a.ply", format!("{}{}", binary.replace("uchar int", "char int"), "\u{7f}".repeat(80))),
        (
            "a.ply",
            format!("{}{}", binary.replace("uchar int", "double int64"), "\u{7f}".repeat(80)),
        ),
        (
            "a.ply",
            format!("{}{}", binary.replace("uchar int", "int64 uint64"), "\u{7f}".repeat(80)),
        ),
        ("a.ply", format!("{}{}", binary.replace("float z", "int64 z"), "\u{7f}".repeat(27))),
        ("a.ply", format!("{}{}", binary.replace("vertex 3", "vertex 1000000000"), "0".repeat(80))),
        ("a.stl", "solid".into()),
        ("a", "sphere 0 0 0 1".into()),
        ("", "sphere 0 0 0 1".into()),
    ];
    for (name, content) in cases {
        let start: String = content.chars().take(80).collect();
        let Err(error) = text(name, &content) else { panic!("{name} was read: {start}") };
        let message = error.to_string();
        assert!(is_short(&message), "{name}: too long a message on {start}: {message}");
        assert!(!message.contains(['\0', '\u{1b}', '\n']), "{message:?}");
    }
}

/// Each within a second and the bytes that all files together explain.
#[test]
fn thousands_of_damaged_files_neither_panic_nor_hang() {
    const SEED: u64 = 20_260_101;
    if !is_alone(concat!(module_path!(), "::thousands_of_damaged_files_neither_panic_nor_hang")) {
        return;
    }
    let mut binary = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\n\
                       property double y\nproperty float z\nelement face 1\n\
                       property list ushort uint vertex_index\nproperty list uchar char tags\n\
                       end_header\n"
        .to_vec();
    for [x, y, z] in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        binary.extend(x.to_be_bytes());
        binary.extend(f64::from(y).to_be_bytes());
        binary.extend(z.to_be_bytes());
    }
    binary.extend([0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1, 9]);
    let mut wide = b"PLY\rformat binary_little_endian 1.0\r\relement tristrips 1\r\
                     property list double int64 vertex_indices\relement vertex 3\r\
                     property int64 x\rproperty uint64 y\rproperty float z\rend_header\r"
        .to_vec();
    wide.extend(3.0f64.to_le_bytes());
    [0i64, 1, 2].iter().for_each(|i| wide.extend(i.to_le_bytes()));
    for [x, y] in [[0i64, 0], [1, 0], [0, 1]] {
        wide.extend(x.to_le_bytes());
        wide.extend(y.to_le_bytes());
        wide.extend(0.0f32.to_le_bytes());
    }
    let wrapped = b"ply\n\rformat ascii 1.0\n\relement vertex 4\n\rproperty float x\n\r\
                    property float y\n\rproperty float z\n\relement tristrips 1\n\r\
                    property list int float vertex_indices\n\rend_header\n\r\
                    0 0 0 1\n\r0 0 0 1 0\n\r1 1 .5\n\r6 0 1 2 3\n\r-1 1\n\r";
    let good: [(&str, &[u8]); 7] = [
        ("workshop.scn", include_bytes!("../data/workshop.scn")),
        ("lamp.obj", include_bytes!("../data/lamp.obj")),
        ("lamp.mtl", include_bytes!("../data/lamp.mtl")),
        ("leaf.ply", include_bytes!("../data/leaf.ply")),
        ("binary.ply", &binary),
        ("wide.ply", &wide),
        ("wrapped.ply", wrapped),
    ];
    for (name, bytes) in good.into_iter().filter(|(name, _)| !name.ends_with(".mtl")) {
        read::read(bytes, name.as_ref(), &Memory(&good)).unwrap_or_else(|e| panic!("{e}"));
    }
    let mut random = Random(SEED);
    let mut read = [0, 0];
    for round in 0..6000 {
        let mut files = good;
        let victim = round % files.len();
        let bytes = random.mutate(files[victim].1, &WORDS);
        files[victim].1 = &bytes;
        // An MTL file is read by way of its model.
        let opened = if victim == 2 { 1 } else { victim };
        let (name, content) = files[opened];
        let most = FREE + EACH * files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
        let read_all = || read::read(content, name.as_ref(), &Memory(&files));
        match bounded(most, files[victim].1, SEED, read_all) {
            Ok((builder, report)) => {
                read[0] += 1;
                assert!(
                    builder.shapes() <= 100 + bytes.len(),
                    "{name}: {} shapes",
                    builder.shapes()
                );
                assert!(report.warnings.iter().all(|w| w.to_string().len() < 500));
            }
            Err(error) => {
                read[1] += 1;
                assert!(is_short(&error.to_string()), "{error}");
            }
        }
    }
    // Both ways are taken often, or the damage is too great or too small to test anything.
    assert!(read.iter().all(|&n| n > 1000), "{read:?}");
}

/// Builds what was read and sends rays through it: none may panic, and what is hit is somewhere.
fn build_and_trace(builder: SceneBuilder, random: &mut Random) -> u32 {
    let scene = builder.build();
    let (geometry, mut stack) = (scene.geometry(), scene.stack());
    let mut number = || random.below(2001) as f32 / 1000.0 - 1.0;
    let mut hits = 0;
    for _ in 0..20 {
        let (o, target) =
            (V3::new(3.0 * number(), 3.0 * number(), 3.0), V3::new(number(), number(), number()));
        let ray = Ray { o, d: target - o };
        let hit = scene.bvh().closest(geometry, &ray, f32::INFINITY, &mut stack);
        assert_eq!(scene.bvh().occluded(geometry, &ray, f32::INFINITY, &mut stack), hit.is_some());
        if let Some(hit) = hit {
            let p = geometry.surface(&ray, &hit).p;
            assert!(hit.t > 0.0 && p.abs().max_component() < 2.0, "{hit:?} {p:?}");
            hits += 1;
        }
    }
    hits
}

/// The shipped scenes and models, damaged: every one a scene that can be built and traced, or an
/// error in a few words. What is read is no more than the bytes explain, and read within a second.
#[test]
fn damaged_shipped_scenes_are_scenes_or_errors() {
    const SEED: u64 = 20_261_122;
    if !is_alone(concat!(module_path!(), "::damaged_shipped_scenes_are_scenes_or_errors")) {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
    let mut good: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "scn" || e == "ply"))
        .map(|path| {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, std::fs::read(path).unwrap())
        })
        .collect();
    good.sort();
    assert!(good.len() >= builtin::EXAMPLES.len() + 5, "{} files", good.len());
    let mut random = Random(SEED);
    let (mut read, mut hits, mut traced) = ([0, 0], 0, 0);
    for round in 0..6000 {
        let (name, whole) = &good[round % good.len()];
        // The large one is read thousands of times slower than the others.
        if whole.len() > 100_000 && round > 13 * good.len() {
            continue;
        }
        let bytes = random.mutate(whole, &WORDS);
        let files: Vec<(&str, &[u8])> = good
            .iter()
            .filter(|(_, bytes)| bytes.len() < 100_000)
            .map(|(n, b)| (n.as_str(), if n == name { &bytes } else { b.as_slice() }))
            .collect();
        let most = FREE + EACH * files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
        let most = most + EACH * bytes.len();
        match bounded(most, &bytes, SEED, || read::read(&bytes, name.as_ref(), &Memory(&files))) {
            Ok((builder, report)) => {
                read[0] += 1;
                let most = 20_000 + bytes.len();
                assert!(builder.shapes() <= most, "{name}: {} shapes", builder.shapes());
                assert!(report.warnings.iter().all(|w| w.to_string().len() < 500));
                hits += build_and_trace(builder, &mut random);
                traced += 20;
            }
            Err(error) => {
                read[1] += 1;
                assert!(is_short(&error.to_string()), "{error}");
            }
        }
    }
    assert!(read.iter().all(|&n| n > 500), "{read:?}");
    assert!(hits > traced / 50, "{hits} hits of {traced} rays");
}
