//! The walls of the house: who may know whom, and the one place of each foreign crate.

use std::fs;
use std::path::{Path, PathBuf};

/// The library's rooms with the rooms that each may name.
const MAY_KNOW: [(&str, &[&str]); 11] = [
    ("math", &[]),
    ("limits", &[]),
    ("plain", &[]),
    ("geometry", &["math"]),
    ("brdf", &["math"]),
    ("scene", &["geometry", "brdf", "math", "limits", "plain"]),
    ("film", &["math"]),
    ("trace", &["scene", "geometry", "brdf", "math"]),
    ("picture", &["limits", "plain"]),
    ("progressive", &["trace", "film", "scene", "picture", "brdf", "math", "limits", "plain"]),
    ("measure", &["progressive", "trace", "film", "scene", "geometry", "picture", "brdf", "math"]),
];

/// Foreign names with the only places that may use them.
const ONE_PLACE: [(&str, &[&str]); 28] = [
    (
        "obvhs",
        &[
            "src/geometry/bvh.rs",
            "src/geometry/pairing.rs",
            "src/geometry/parts.rs",
            "src/geometry/treelets.rs",
            "src/geometry/widen.rs",
        ],
    ),
    ("tobj", &["src/scene/read/"]),
    ("ply_rs_bw", &["src/scene/read/ply"]),
    ("earcut::", &["src/scene/read/polygon.rs"]),
    ("png::", &["src/picture/files.rs"]),
    ("image::", &["src/picture/files.rs"]),
    ("exr::", &["src/picture/files.rs", "src/picture/exr_"]),
    ("sha2::", &["src/scene/read/files.rs"]),
    ("memmap2", &["src/geometry/pages.rs"]),
    ("bytemuck", &["src/geometry/"]),
    ("rayon", &["src/progressive/work.rs", "src/geometry/", "src/scene/"]),
    ("crossbeam_channel", &["src/progressive/"]),
    ("egui", &["src/viewer/"]),
    ("eframe", &["src/viewer/"]),
    ("rfd::", &["src/viewer/jobs/browse.rs"]),
    ("clap", &["src/cli/"]),
    ("anstream", &["src/cli/talk.rs"]),
    ("anstyle", &["src/cli/talk.rs"]),
    // Intervals, and the chances of the proofs.
    ("statrs", &["src/film/interval.rs", "src/measure/check/statistics.rs"]),
    ("flip_rs", &["src/measure/flip.rs"]),
    ("plotters", &["src/measure/plot"]),
    ("unsafe ", &["src/math/lanes/"]),
    // What a processor has, and what a system: all else is the same for every machine.
    ("target_arch", &["src/math/lanes/"]),
    ("std::arch", &["src/math/lanes/"]),
    ("target_os", &["src/cli/memory.rs", "src/geometry/pages.rs", "src/viewer/mod.rs"]),
    ("dirs::", &["src/viewer/settings.rs"]),
    (
        "std::time::Instant",
        &[
            "src/progressive/",
            "src/measure/profile.rs",
            "src/measure/rays.rs",
            "src/measure/scaling.rs",
            "src/cli/",
            "src/viewer/",
        ],
    ),
    ("std::process::exit", &["src/main.rs", "src/cli/"]),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("tests") {
            continue;
        } else if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Every source file with its path from the project's folder and its lines of code: comments and
/// unit tests, which may look anywhere, are left out.
fn code() -> Vec<(String, Vec<String>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    sources(&root.join("src"), &mut paths);
    assert!(paths.len() > 40, "only {} files found", paths.len());
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(path).unwrap();
        let body = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let lines = body.lines().map(str::trim).filter(|l| !l.starts_with("//"));
        (name, lines.map(String::from).collect())
    };
    // Some modules keep their tests in a file beside them.
    paths.retain(|path| !path.ends_with("tests.rs"));
    paths.iter().map(read).collect()
}

#[test]
fn rooms_know_only_the_rooms_below_them() {
    let mut arrows = 0;
    for (file, lines) in code() {
        let Some(room) = file.strip_prefix("src/") else { continue };
        let room = room.split(['/', '.']).next().unwrap();
        let Some((_, allowed)) = MAY_KNOW.iter().find(|(name, _)| *name == room) else { continue };
        for line in lines {
            for found in line.split("crate::").skip(1) {
                let other = found.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
                arrows += 1;
                assert!(
                    other == room || allowed.contains(&other),
                    "{file}: {room} may not know {other}: {line}"
                );
            }
        }
    }
    assert!(arrows > 40, "only {arrows} uses found: has the way of naming changed?");
}

#[test]
fn every_foreign_crate_has_one_place() {
    for (name, places) in ONE_PLACE {
        let mut used = 0;
        for (file, lines) in code() {
            for line in lines.iter().filter(|l| l.contains(name)) {
                used += 1;
                assert!(places.iter().any(|p| file.starts_with(p)), "{file}: {line}");
            }
        }
        assert!(used > 0 || name == "std::process::exit", "{name} is used nowhere");
    }
}

/// The library opens files in its readers and its picture files alone, and what the system tells of
/// memory; so does the binary, but for
/// the tables and process figures of its subcommands, and what the window remembers, looks after and
/// tells of its work.
#[test]
fn files_are_opened_in_few_places() {
    for (file, lines) in code() {
        let window = ["settings", "jobs/watch", "effort"].map(|f| format!("src/viewer/{f}.rs"));
        let may = ["src/scene/read/", "src/picture/", "src/cli/", "src/limits.rs"]
            .into_iter()
            .chain(window.iter().map(String::as_str))
            .any(|p| file.starts_with(p));
        let opens = |l: &&String| l.contains("std::fs") || l.contains("File::");
        assert!(may || !lines.iter().any(|l| opens(&l)), "{file} opens files");
    }
}
