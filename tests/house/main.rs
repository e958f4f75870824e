//! The walls of the house: who may know whom, and the one place of each foreign crate. And its map: what pages for
//! readers name has to exist. Beside them what it is built of, and the models that it ships.

mod cycles;
mod dependencies;
mod hard_cases;
#[path = "../models/mod.rs"]
mod models;

use burnish::brdf::Model;
use burnish::scene::builtin::EXAMPLES;
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
const ONE_PLACE: [(&str, &[&str]); 31] = [
    (
        "obvhs",
        &[
            "src/geometry/accel/build.rs",
            "src/geometry/accel/clustering.rs",
            "src/geometry/accel/collapse.rs",
            "src/geometry/accel/top_boxes.rs",
            "src/geometry/accel/treelet.rs",
        ],
    ),
    ("tobj", &["src/scene/read/"]),
    ("ply_rs_bw", &["src/scene/read/ply"]),
    ("earcut::", &["src/scene/read/polygon.rs"]),
    ("png::", &["src/picture/files.rs"]),
    ("image::", &["src/picture/files.rs"]),
    ("exr::", &["src/picture/files.rs", "src/picture/exr_"]),
    ("skrifa", &["src/picture/letters.rs"]),
    ("ab_glyph_rasterizer", &["src/picture/letters.rs"]),
    ("epaint_default_fonts", &["src/picture/letters.rs"]),
    ("sha2::", &["src/scene/read/files.rs"]),
    ("memmap2", &["src/geometry/huge_pages.rs"]),
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
    ("unsafe ", &["src/math/simd/"]),
    // What a processor has, and what a system: all else is the same for every machine.
    ("target_arch", &["src/math/simd/"]),
    ("std::arch", &["src/math/simd/"]),
    ("target_os", &["src/cli/memory.rs", "src/geometry/huge_pages.rs", "src/viewer/mod.rs"]),
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
        let window =
            ["settings", "jobs/watch", "frame_times"].map(|f| format!("src/viewer/{f}.rs"));
        let may = ["src/scene/read/", "src/picture/", "src/cli/", "src/limits.rs"]
            .into_iter()
            .chain(window.iter().map(String::as_str))
            .any(|p| file.starts_with(p));
        let opens = |l: &&String| l.contains("std::fs") || l.contains("File::");
        assert!(may || !lines.iter().any(|l| opens(&l)), "{file} opens files");
    }
}

/// The parameters of `ui` in every panel, of which one that is not used may be called `_`.
const PANEL: [&str; 4] =
    ["&mut self", "ui: &mut Ui", "document: &mut Document", "actions: &mut Vec<Action>"];

/// The parameter lists of the functions called `ui` in a file's code.
fn parameters_of_ui(lines: &[String]) -> Vec<Vec<String>> {
    let text = lines.join(" ");
    let after = text.split("fn ui").skip(1).filter(|rest| rest.starts_with(['(', '<']));
    let list = |rest: &str| {
        let inside = rest.split_once('(').map_or("", |(_, inside)| inside);
        let inside = inside.split_once(')').map_or("", |(inside, _)| inside);
        inside.split(',').map(|p| p.trim().to_owned()).filter(|p| !p.is_empty()).collect()
    };
    after.map(list).collect()
}

fn is_panel(parameters: &[String]) -> bool {
    let is = |found: &String, due: &&str| {
        let unused = due.split_once(": ").map(|(_, due)| format!("_: {due}"));
        found == due || unused.as_ref() == Some(found)
    };
    parameters.len() == PANEL.len() && parameters.iter().zip(&PANEL).all(|(p, due)| is(p, due))
}

#[test]
fn every_panel_has_one_form() {
    let mut panels = 0;
    for (file, lines) in code() {
        if !file.starts_with("src/viewer/panels/") {
            continue;
        }
        let has = |l: &&String| l.starts_with("impl Panel for ");
        let own = lines.iter().filter(has).count();
        assert!(own <= 1, "{file}: a panel has a file of its own");
        panels += own;
        let found = parameters_of_ui(&lines);
        let declared = usize::from(file.ends_with("/mod.rs"));
        assert_eq!(found.len(), own + declared, "{file}: `ui` is a panel's alone");
        for parameters in found {
            assert!(is_panel(&parameters), "{file}: fn ui({})", parameters.join(", "));
        }
    }
    assert!(panels >= 15, "only {panels} panels found");
}

#[test]
fn a_panel_is_told_from_what_is_none() {
    let of = |text: &str| parameters_of_ui(&text.lines().map(String::from).collect::<Vec<_>>());
    let right =
        "fn ui(\n&mut self,\nui: &mut Ui,\ndocument: &mut Document,\n_: &mut Vec<Action>,\n) {";
    assert!(is_panel(&of(right)[0]));
    for wrong in [
        "fn ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {",
        "fn ui(&mut self, ui: &mut Ui, document: &mut Document) -> Option<Action> {",
        "fn ui(ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {",
    ] {
        assert!(!is_panel(&of(wrong)[0]), "{wrong}");
    }
}

/// What `geometry` has for the rooms above it.
const GEOMETRY: [&str; 26] = [
    "Aabb",
    "Bvh",
    "Cylinder",
    "Face",
    "Geometry",
    "Hit",
    "HitSoa",
    "Kind",
    "NO_SURFACE",
    "PacketSlabs",
    "PointSoa",
    "PrimitiveRange",
    "Query",
    "Ray",
    "RaySoa",
    "SegmentSoa",
    "Sphere",
    "Stack",
    "SurfacePoint",
    "Vertex",
    "bent",
    "flat_surface",
    "intersect_spheres",
    "offset_origin",
    "shading_normal",
    "surface_left",
];
/// What they can ask of its `Bvh`, besides building and describing it: the first five are the door by
/// which rays go in, the next two the same for many single rays.
const BVH: [&str; 14] = [
    "closest",
    "occluded",
    "closest_packet",
    "occluded_packet",
    "visible",
    "closest_each",
    "occluded_each",
    "build",
    "bytes",
    "coincident",
    "depth",
    "settle_coincident",
    "stack",
    "surface_id",
];

/// Nobody outside knows that large quads, analytic shapes and the tree are separate things.
#[test]
fn geometry_has_one_door() {
    let sources = code();
    let mut uses = 0;
    for (file, lines) in sources.iter().filter(|(file, _)| !file.starts_with("src/geometry/")) {
        let text = lines.join(" ");
        for rest in text.split("geometry::").skip(1) {
            let list = rest.strip_prefix('{').and_then(|list| list.split('}').next());
            let one = || rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
            for name in list.unwrap_or_else(one).split(',') {
                let name = name.trim().split(" as ").next().unwrap();
                uses += 1;
                let known = name.is_empty() || GEOMETRY.contains(&name);
                assert!(known, "{file}: geometry has no {name} for others");
            }
        }
    }
    assert!(uses > 60, "only {uses} uses found: has the way of naming changed?");
    let mut found = Vec::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (file, _) in sources.iter().filter(|(f, _)| f.starts_with("src/geometry/accel/")) {
        let mut of_bvh = false;
        // With their indentation: functions have blocks of their own.
        for line in fs::read_to_string(root.join(file)).unwrap().lines() {
            if line.starts_with("impl") {
                of_bvh = line.starts_with("impl Bvh ");
            }
            let open = ["    pub fn ", "    pub(crate) fn "];
            let name = open.iter().find_map(|f| line.strip_prefix(f)).filter(|_| of_bvh);
            if let Some(name) = name {
                let name = name.split(['(', '<']).next().unwrap().to_owned();
                assert!(BVH.contains(&name.as_str()), "{file}: {name} is open to other rooms");
                found.push(name);
            }
        }
    }
    assert!(BVH.iter().all(|name| found.iter().any(|f| f == name)), "{found:?}");
}

/// The map for contributors.
const MAP: &str = include_str!("../../src/ARCHITECTURE.md");
const README: &str = include_str!("../../README.md");

/// The cells of a table's row.
fn cells(line: &str) -> Option<Vec<&str>> {
    let row = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(row.split('|').map(str::trim).collect())
}

/// What is set in code in a line of a page.
fn spans(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// A page's lines but for those of its blocks of code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut code = false;
    page.lines().filter(move |line| {
        let fence = line.starts_with("```");
        code ^= fence;
        !code && !fence
    })
}

#[test]
fn the_map_has_the_walls_as_they_are() {
    let rows: Vec<(&str, Vec<&str>)> = MAP
        .lines()
        .filter_map(cells)
        .filter(|cells| cells.len() == 4)
        .filter_map(|cells| Some((spans(cells[0]).next()?, spans(cells[3]).collect())))
        .collect();
    let walls: Vec<_> = MAY_KNOW.iter().map(|(room, may)| (*room, may.to_vec())).collect();
    assert_eq!(rows, walls);
}

/// Whether a line of code defines this name: an item, a variant or a field.
fn defines(line: &str, name: &str) -> bool {
    let ends = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
    let after = |word: &str| {
        line.match_indices(word).any(|(at, _)| {
            let rest = &line[at + word.len()..];
            let begins = at == 0 || ends(&line[at - 1..at]);
            begins && rest.strip_prefix(name).is_some_and(ends)
        })
    };
    let items = ["struct ", "enum ", "trait ", "type ", "fn ", "const ", "static ", "mod "];
    let bare = line.split_once(") ").map_or(line, |(_, rest)| rest).trim_start_matches("pub ");
    let rest = bare.strip_prefix(name);
    let is_field = rest.is_some_and(|r| r.starts_with(':') && !r.starts_with("::"));
    let is_variant = rest.is_some_and(|r| r.is_empty() || r.starts_with([',', '(', ' ']));
    items.iter().any(|item| after(item)) || is_field || is_variant
}

/// Whether the sources have a `Name`, or a `Type::member` in a file that is about the type.
fn is_there(sources: &[(String, Vec<String>)], name: &str) -> bool {
    let (of, member) = name.split_once("::").unwrap_or(("", name));
    sources.iter().any(|(_, lines)| {
        let is_about = |l: &String| {
            let heads = l.starts_with("impl") && l.split([' ', '<', '{']).any(|word| word == of);
            heads || defines(l, of)
        };
        lines.iter().any(|l| defines(l, member)) && (of.is_empty() || lines.iter().any(is_about))
    })
}

#[test]
fn the_map_names_only_what_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = code();
    let (mut paths, mut names) = (0, 0);
    for (line, span) in prose(MAP).flat_map(|line| spans(line).map(move |span| (line, span))) {
        let plain = |more: &str| span.chars().all(|c| c.is_alphanumeric() || more.contains(c));
        if plain("_/.-") && (span.contains('/') || span.ends_with(".rs")) {
            paths += 1;
            let found = [root.join(span), root.join("src").join(span)];
            assert!(found.iter().any(|path| path.exists()), "there is no {span}: {line}");
        } else if plain("_:") && span.starts_with(char::is_uppercase) && span != "NAME" {
            names += 1;
            assert!(is_there(&sources, span), "the sources have no {span}: {line}");
        }
    }
    assert!(paths > 60 && names > 60, "only {paths} paths and {names} names found");
}

#[test]
fn what_is_named_is_told_from_what_is_not() {
    let lines =
        ["pub(super) struct Door<'a> {", "wide: bool,", "Open,", "impl Door<'_> {", "fn ajar("];
    let sources = vec![("a.rs".to_owned(), lines.map(String::from).to_vec())];
    for name in ["Door", "Open", "Door::ajar", "Door::wide"] {
        assert!(is_there(&sources, name), "{name}");
    }
    for name in ["Doo", "Doors", "Door::aja", "Gate::ajar", "Shut"] {
        assert!(!is_there(&sources, name), "{name}");
    }
}

/// The type that a line of code declares outside of functions.
fn declared_type(line: &str) -> Option<&str> {
    let bare = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.strip_prefix(' ')?,
        None => line,
    };
    let rest = ["struct ", "enum ", "trait ", "type ", "union "];
    let rest = rest.iter().find_map(|item| bare.strip_prefix(item))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

/// Within a room a type's name stands for one type, and it has no other meaning in a room that may
/// be named from there. The command line and the window are not looked at: each subcommand has its
/// `Args`, each panel its `Question`.
#[test]
fn no_type_name_has_two_meanings() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut types: Vec<(String, &str, String)> = Vec::new();
    for (file, _) in code() {
        let room = file.trim_start_matches("src/").split(['/', '.']).next().unwrap();
        let Some((room, _)) = MAY_KNOW.iter().find(|(name, _)| *name == room) else { continue };
        let text = fs::read_to_string(root.join(&file)).unwrap();
        let body = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let names = body.lines().filter_map(declared_type).map(String::from);
        types.extend(names.map(|name| (name, *room, file.clone())));
    }
    assert!(types.len() > 300, "only {} types found", types.len());
    let knows = |a: &str, b: &str| MAY_KNOW.iter().any(|(r, may)| *r == a && may.contains(&b));
    for (i, (name, room, file)) in types.iter().enumerate() {
        for (_, other, there) in types[..i].iter().filter(|t| t.0 == *name) {
            let near = room == other || knows(room, other) || knows(other, room);
            assert!(!near, "{name} is a type in {there} and another one in {file}");
        }
    }
}

/// Words that the code once had for what the field calls otherwise, as names.
const OLD_WORDS: [&str; 44] = [
    "plate",
    "plates",
    "Plate",
    "Plates",
    "lamp",
    "lamps",
    "Lamp",
    "quadric",
    "quadrics",
    "Quadric",
    "Quadrics",
    "twig",
    "twigs",
    "Twig",
    "Traveller",
    "traveller",
    "Deal",
    "deal",
    "Hand",
    "hand",
    "bundle",
    "bundles",
    "Bundle",
    "Asked",
    "asked",
    "lookers",
    "Firsts",
    "Seconds",
    "matt",
    "Lobes",
    "Lane",
    "Packet",
    "Sheared",
    "Passing",
    "Extent",
    "far_first",
    "pilot",
    "Outlet",
    "Wrong",
    "NO_PLATE",
    "MOST_PLATES",
    "ROUNDING",
    "Pages",
    "Leaving",
];

/// Code without comments and without what stands in quotation marks.
fn without_strings(lines: &[String]) -> String {
    let bare = lines.iter().map(|line| line.split(" // ").next().unwrap());
    let text = bare.collect::<Vec<_>>().join("\n").replace("\\\\", "").replace("\\\"", "");
    text.replace("'\"'", "").split('"').step_by(2).collect()
}

#[test]
fn types_and_words_are_told_from_what_is_not() {
    for (line, name) in [
        ("pub(super) struct Door<'a> {", Some("Door")),
        ("type Key = u32;", Some("Key")),
        ("pub trait Open: Sized {", Some("Open")),
        ("structure();", None),
        ("    struct Inner;", None),
    ] {
        assert_eq!(declared_type(line), name, "{line}");
    }
    let lines = [r#"let a = "a plate"; // plate"#, r#"let quote = '"';"#, "let lamp = 1;"];
    let code = without_strings(&lines.map(String::from));
    assert!(!code.contains("plate") && code.contains("lamp"), "{code}");
}

#[test]
fn old_words_do_not_come_back() {
    let library = code().into_iter().filter(|(file, _)| !file.starts_with("src/viewer/"));
    for (file, lines) in library {
        let code = without_strings(&lines);
        let mut words = code.split(|c: char| !c.is_alphanumeric() && c != '_');
        let old = words.find(|word| OLD_WORDS.contains(word));
        assert!(old.is_none(), "{file} has the name {}", old.unwrap());
    }
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
}

/// The name by which a page is linked to at this heading.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text.chars().filter(|&c| c.is_alphanumeric() || " -_".contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn links_between_pages_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = vec![root.join("README.md")];
    for folder in ["src", "tests", "assets", "screenshots"] {
        pages(&root.join(folder), &mut all);
    }
    let mut links = 0;
    for page in &all {
        let text = fs::read_to_string(page).unwrap();
        let prose = prose(&text).collect::<Vec<_>>().join(" ");
        for link in prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.contains("://") {
                continue;
            }
            links += 1;
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let to = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(to.exists(), "{}: {link} leads nowhere", page.display());
            if !place.is_empty() {
                let text = fs::read_to_string(&to).unwrap();
                let has = text.lines().filter(|l| l.starts_with('#')).any(|l| anchor(l) == place);
                assert!(has, "{}: {link}: no such heading", page.display());
            }
        }
    }
    assert!(links > 15, "only {links} links found");
}

/// Names of test programs that a text tells cargo to run: the words after `--test`.
fn told_to_run(text: &str) -> impl Iterator<Item = &str> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let after = text.split("--test").skip(1).filter_map(|rest| rest.strip_prefix([' ', '=']));
    after.map(move |rest| rest.split(|c| !is_name(c)).next().unwrap()).filter(|n| !n.is_empty())
}

/// Whether cargo makes a program of this name from the folder of tests.
fn is_test_program(name: &str) -> bool {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    tests.join(name).join("main.rs").exists() || tests.join(name).with_extension("rs").exists()
}

/// Every file of text below a folder that is not among pictures and models.
fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let kind = path.extension().and_then(|e| e.to_str());
        if path.is_dir() {
            texts(&path, found);
        } else if matches!(kind, None | Some("md" | "rs" | "sh" | "toml")) {
            found.push(path);
        }
    }
}

#[test]
fn commands_run_tests_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = vec![root.join("README.md"), root.join("Cargo.toml")];
    for folder in ["src", "tests", "assets", ".ci", ".cargo"] {
        texts(&root.join(folder), &mut all);
    }
    // This file names some that do not exist.
    all.retain(|path| !path.ends_with("tests/house/main.rs"));
    let mut named = 0;
    for path in &all {
        let bytes = fs::read(path).unwrap();
        for name in told_to_run(&String::from_utf8_lossy(&bytes)) {
            named += 1;
            assert!(is_test_program(name), "{}: --test {name} is none", path.display());
        }
    }
    assert!(named > 15, "only {named} found");
}

#[test]
fn a_command_with_a_test_is_told_from_what_is_none() {
    let text = "`cargo test --test fuzz bombs`, --tests --test=cli --test a-b.";
    assert_eq!(told_to_run(text).collect::<Vec<_>>(), ["fuzz", "cli", "a-b"]);
    assert!(is_test_program("house") && is_test_program("stress"));
    // A folder of modules, and a program of earlier days.
    assert!(!is_test_program("support") && !is_test_program("transport"));
}

#[test]
fn the_readme_is_short_and_knows_every_scene_and_model() {
    assert!(README.lines().count() < 200, "the README is to be read: details go to other pages");
    let first: Vec<&str> = README.lines().filter_map(cells).map(|cells| cells[0]).collect();
    let at = |name: &str| {
        first.iter().position(|&cell| cell == name).unwrap_or_else(|| panic!("{name}"))
    };
    let scenes = EXAMPLES.each_ref().map(|scene| at(&format!("`{}`", scene.name)));
    assert!(scenes.is_sorted_by(|a, b| a + 1 == *b), "as the program lists them: {scenes:?}");
    assert!(Model::ALL.map(|model| at(model.title())).is_sorted());
}
