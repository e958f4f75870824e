//! What the program is built of: licences, sources, crates that stand twice, and crates that nothing uses.
//!
//! The rules are those of `.cargo/deny.toml`. `cargo deny` and `cargo machete`, where they are installed, look
//! more closely (`.ci/audit.sh`); these tests need nothing but cargo.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

const RULES: &str = include_str!("../../.cargo/deny.toml");
const LOCK: &str = include_str!("../../Cargo.lock");
const MANIFEST: &str = include_str!("../../Cargo.toml");

/// What stands between quotes in a list of the rules; of tables, their crates.
fn rules(section: &str, list: &str) -> Vec<String> {
    let section = RULES.split(&format!("[{section}]\n")).nth(1).unwrap();
    let body = section.split(&format!("\n{list} = [")).nth(1).unwrap();
    let lines = body.lines().take_while(|line| *line != "]");
    lines
        .filter(|line| !line.trim().starts_with('#'))
        .filter_map(|line| Some(line.split('"').nth(1)?.to_owned()))
        .collect()
}

/// Each package of the lock file: name, version, source.
fn packages() -> Vec<[String; 3]> {
    let value = |block: &str, key: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(&format!("{key} = \"")));
        line.map_or(String::new(), |line| line.trim_end_matches('"').to_owned())
    };
    let blocks = LOCK.split("[[package]]\n").skip(1);
    blocks.map(|block| ["name", "version", "source"].map(|key| value(block, key))).collect()
}

#[test]
fn every_crate_comes_from_the_registry() {
    let address = "https://github.com/rust-lang/crates.io-index";
    assert!(RULES.contains(&format!("allow-registry = [\"{address}\"]")));
    let registry = format!("registry+{address}");
    let packages = packages();
    assert!(packages.len() > 100, "{}", packages.len());
    for [name, _, source] in packages {
        assert!(source == registry || name == "burnish", "{name} comes from {source:?}");
    }
}

#[test]
fn crates_that_stand_twice_are_known() {
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for [name, version, _] in packages() {
        versions.entry(name).or_default().push(version);
    }
    let mut older = BTreeSet::new();
    for (name, mut all) in versions {
        let number = |v: &String| -> Vec<u64> {
            v.split(['.', '-', '+']).filter_map(|part| part.parse().ok()).collect()
        };
        all.sort_by_key(number);
        all.pop();
        older.extend(all.into_iter().map(|version| format!("{name}@{version}")));
    }
    let known: BTreeSet<String> = rules("bans", "skip").into_iter().collect();
    let new: Vec<_> = older.difference(&known).collect();
    assert!(new.is_empty(), "{new:?} stand beside newer ones: keep to one, or say who wants them");
    let gone: Vec<_> = known.difference(&older).collect();
    assert!(gone.is_empty(), "{gone:?} no longer stand twice: take them from the list");
}

#[test]
fn no_crate_is_banned() {
    let banned = rules("bans", "deny");
    assert!(banned.len() > 5);
    for [name, ..] in packages() {
        assert!(!banned.contains(&name), "{name}");
    }
}

/// Whether these allow what an SPDX expression asks for. `AND` binds more than `OR`.
fn allows(allowed: &[String], expression: &str) -> bool {
    let mut expression = expression.replace('/', " OR ");
    // Brackets from the inside out: what one of them allows stands for a licence that all do.
    while let Some(end) = expression.find(')') {
        let start = expression[..end].rfind('(').unwrap();
        let inside = allows(allowed, &expression[start + 1..end]);
        expression.replace_range(start..=end, if inside { &allowed[0] } else { "none" });
    }
    let one = |licence: &str| allowed.iter().any(|a| a == licence.trim());
    expression.split(" OR ").any(|all| all.split(" AND ").all(one))
}

#[test]
fn expressions_of_licences_are_read() {
    let allowed = ["MIT", "Apache-2.0 WITH LLVM-exception", "Zlib"].map(str::to_owned);
    for (expression, expected) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("GPL-3.0/MIT", true),
        ("GPL-3.0 AND MIT", false),
        ("Zlib AND MIT", true),
        ("(GPL-3.0 OR MIT) AND Zlib", true),
        ("(GPL-3.0 OR LGPL-3.0) AND Zlib", false),
        ("Zlib AND (MIT AND (Zlib OR GPL-3.0))", true),
        ("Apache-2.0 WITH LLVM-exception", true),
        ("Apache-2.0", false),
        ("", false),
    ] {
        assert_eq!(allows(&allowed, expression), expected, "{expression}");
    }
}

/// Of all that is built here, by what cargo has of it.
#[cfg(target_os = "linux")]
#[test]
fn every_licence_is_allowed() {
    let platform = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let output = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline", "--locked", "--filter-platform"])
        .arg(platform)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let allowed = rules("licenses", "allow");
    let packages = all["packages"].as_array().unwrap();
    assert!(packages.len() > 50 && allowed.len() > 8, "{}", packages.len());
    for package in packages {
        let (name, licence) = (&package["name"], package["license"].as_str().unwrap_or("none"));
        let name = name.as_str().unwrap();
        let excepted =
            RULES.contains(&format!("{{ crate = \"{name}\", allow = [\"{licence}\"] }}"));
        assert!(allows(&allowed, licence) || excepted, "{name}: {licence}");
    }
}

fn sources(folder: &Path, all: &mut String) {
    let entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    for path in entries {
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|e| e == "rs") {
            all.push_str(&fs::read_to_string(&path).unwrap());
        }
    }
}

/// A crate is used where its name stands before `::`, or alone in a `use`.
#[test]
fn every_dependency_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [mut code, mut tests] = [String::new(), String::new()];
    sources(&root.join("src"), &mut code);
    sources(&root.join("tests"), &mut tests);
    tests.push_str(&code);
    let (mut section, mut seen) = ("", 0);
    for line in MANIFEST.lines() {
        if line.starts_with('[') {
            section = line.trim_matches(['[', ']']);
            continue;
        }
        let Some((name, _)) = line.split_once(" = ") else { continue };
        if !section.ends_with("dependencies") || name.starts_with('#') {
            continue;
        }
        seen += 1;
        let name = name.replace('-', "_");
        let place = if section.ends_with("dev-dependencies") { &tests } else { &code };
        let used = [format!("{name}::"), format!("use {name};"), format!("{name} as ")];
        assert!(used.iter().any(|text| place.contains(text)), "nothing uses {name}");
    }
    assert!(seen > 25, "{seen} dependencies");
}
