//! What the system refuses: memory, and room on the disk. A shell sets a limit first, as an
//! administrator would; then it becomes burnish.

use std::fs;
use std::process::{Command, Output};

fn limited(limit: &str, args: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_burnish");
    let script = format!("{limit}; exec \"$0\" \"$@\"");
    Command::new("sh").arg("-c").arg(script).arg(program).args(args).output().unwrap()
}

/// That it ended with code 1, and what it said.
fn refused(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    text
}

/// A limit on the size of files stands in for a full disk, which a test cannot have to itself: the
/// system refuses in the middle of writing, and the file that was there is untouched.
#[test]
fn a_disk_that_is_full_costs_neither_the_old_file_nor_a_word() {
    for name in ["a.png", "a.exr"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, "precious").unwrap();
        let args = ["render", "-o", path.to_str().unwrap(), "--size", "200x150", "--passes", "1"];
        let told = refused(&limited("trap '' XFSZ; ulimit -f 4", &args));
        assert!(told.contains(name) && told.contains("untouched"), "{told}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something is left behind");
    }
}

/// A picture larger than memory is refused before anything is rendered, with what it would need.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_larger_than_memory_is_refused_with_its_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let path = path.to_str().unwrap();
    let args = ["render", "-o", path, "--size", "32768x32768", "--passes", "1"];
    let told = refused(&limited("ulimit -v 4000000", &args));
    assert!(told.contains("32768x32768 pixels needs about 156 GiB of memory, and "), "{told}");
    assert!(told.contains("are free (under `ulimit -v`)"), "{told}");
    for size in ["65536x65536", "4294967296x1", "99999999999999999999x1"] {
        let output = limited(":", &["render", "-o", path, "--size", size]);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && told.contains("32768"), "{size}: {told}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Whatever memory there is, from 200 MB up: a scene is rendered, or refused with what it needs.
/// `timeout` ends with 124 what would hang.
#[cfg(target_os = "linux")]
#[test]
fn with_little_memory_a_scene_is_rendered_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let path = path.to_str().unwrap();
    let mut refusals = 0;
    for example in &burnish::scene::builtin::EXAMPLES {
        for megabytes in [200, 330, 600] {
            let program = env!("CARGO_BIN_EXE_burnish");
            let script = format!(
                "ulimit -v {}; exec timeout 900 \"$0\" render {} -o \"$1\" --passes 1 -q",
                megabytes * 1024,
                example.name
            );
            let output =
                Command::new("sh").arg("-c").arg(script).args([program, path]).output().unwrap();
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            let case = format!("{} with {megabytes} MiB: {:?} {told}", example.name, output.status);
            match output.status.code() {
                Some(0) => assert!(told.is_empty(), "{case}"),
                Some(1) => {
                    refusals += 1;
                    let numbers = told.contains("needs about") && told.contains("are free");
                    assert!(numbers && told.lines().count() == 1, "{case}");
                }
                _ => panic!("{case}"),
            }
        }
    }
    assert!(refusals > 0, "nothing was refused: the limits are too high to test anything");
}

/// A model is read once however often it is placed, and all its copies are counted before the first
/// is made.
#[cfg(target_os = "linux")]
#[test]
fn many_copies_of_a_large_model_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 50000\nproperty float x\n\
                    property float y\nproperty float z\nelement face 100000\n\
                    property list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for i in 0..50_000u32 {
        for x in [i % 250, i / 250, i % 251 % 7] {
            ply.extend((x as f32).to_le_bytes());
        }
    }
    for i in 0..100_000u32 {
        ply.push(3);
        for x in [i % 50_000, (i + 1) % 50_000, (i * 7 + 251) % 50_000] {
            ply.extend(x.to_le_bytes());
        }
    }
    fs::write(folder.path().join("m.ply"), ply).unwrap();
    let scene = folder.path().join("many.scn");
    let lines = (0..300).map(|i| format!("mesh m.ply {i} 0 0 1\n"));
    fs::write(&scene, format!("environment 1 1 1\n{}", lines.collect::<String>())).unwrap();
    let args = ["info", scene.to_str().unwrap()];
    let told = refused(&limited("ulimit -v 1048576", &args));
    assert!(told.contains("many.scn:2: mesh: m.ply with its 100000 triangles is placed 300 times"));
    assert!(told.contains("needs about") && told.lines().count() == 1, "{told}");
    // One of them is no trouble.
    fs::write(&scene, "environment 1 1 1\nmesh m.ply 0 0 0 1\n").unwrap();
    let output = limited("ulimit -v 1048576", &args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
