//! What the system refuses: memory, and room on the disk. A shell sets a limit first, as an
//! administrator would; then it becomes burnish.
#![cfg(unix)]

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
    assert!(told.contains("needs 132.0 GiB"), "{told}");
    for size in ["65536x65536", "4294967296x1", "99999999999999999999x1"] {
        let output = limited(":", &["render", "-o", path, "--size", size]);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && told.contains("32768"), "{size}: {told}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
