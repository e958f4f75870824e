//! Broken files by the thousand for every reader of the library: none may panic, hang, take more
//! memory than its size explains, or say what steers a terminal. Those of the command line and of the
//! window have the same beside them.
//!
//! A few in each test run; `BURNISH_FUZZ=1000000 cargo test --release --test fuzz -- --nocapture`
//! makes so many changes of each kind, and `BURNISH_FUZZ_SECONDS=60` as many as come in that time.

mod bombs;
#[path = "../support/bounded.rs"]
mod bounded;
mod experiment;
mod exr;
#[path = "../support/mutate.rs"]
mod mutate;
mod written;

use bounded::{EACH, FREE, bounded};
use burnish::picture::{Picture, Tone, read_exr_part, read_recipe, write_with_recipe};
use burnish::progressive::{Params, Recipe, render};
use burnish::scene::builtin::Example;
use burnish::scene::read::{self, Memory};
use mutate::{Random, WORDS, corpus, is_fit, try_all};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// One kind at a time: memory is counted for the whole process.
static TURN: Mutex<()> = Mutex::new(());

/// Does all on one thread, also what readers leave to others where files are large: most of the time would
/// else go by in handing over files of some hundred bytes.
fn on_one_thread(act: impl FnOnce() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(act);
}

/// A folder that is in memory where there is such a one: it is the readers that are tried and not the disk.
fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

const SCENE: &[u8] = include_bytes!("../data/workshop.scn");
const MODEL: &[u8] = include_bytes!("../data/lamp.obj");
const LIBRARY: &[u8] = include_bytes!("../data/lamp.mtl");
const LEAF: &[u8] = include_bytes!("../data/leaf.ply");

/// Reads a kind of file by the file named, which is the broken one or refers to it.
fn read_all(name: &'static str, by: &str, lines: &str, whole: &[u8], seed: u64) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let broken = corpus(lines);
    assert!(broken.len() >= 60, "{name}: {} files", broken.len());
    let files: Vec<Vec<u8>> = std::iter::once(whole.to_vec()).chain(broken).collect();
    let (mut read, mut refused, mut placed) = (0u64, 0u64, 0u64);
    let each = |bytes: &[u8], _: &mut Random| {
        let all = [
            ("workshop.scn", SCENE),
            ("lamp.obj", MODEL),
            ("lamp.mtl", LIBRARY),
            ("leaf.ply", LEAF),
        ];
        let all = all.map(|(known, good)| (known, if known == name { bytes } else { good }));
        let content = all.iter().find(|(known, _)| *known == by).unwrap().1;
        let input: usize = all.iter().map(|(_, bytes)| bytes.len()).sum();
        let most = FREE + EACH * input;
        let result = bounded(most, bytes, seed, || read::read(content, by.as_ref(), &Memory(&all)));
        match result {
            Ok((builder, report)) => {
                read += 1;
                assert!(builder.shapes() <= 100 + input, "{} shapes", builder.shapes());
                let all = report.warnings.iter().map(|w| w.to_string());
                for told in all.chain(report.notes.iter().cloned()) {
                    assert!(is_fit(&told), "{told:?}");
                }
            }
            Err(e) => {
                refused += 1;
                let told = e.to_string();
                assert!(is_fit(&told) && !told.is_empty(), "{told:?}");
                assert_eq!(e.place.file.extension(), Path::new(name).extension(), "{told}");
                placed += u64::from(e.place.line.is_some());
                // What has no line is about the file as a whole.
                let whole = ["empty", "no command", "to show", "no faces", "no vertices"];
                let whole = whole.iter().any(|word| told.contains(word));
                assert!(e.place.line.is_some() || whole || name.ends_with(".ply"), "{told}");
            }
        }
    };
    on_one_thread(|| {
        try_all(&files, 1, &WORDS, seed, each);
    });
    println!("{name}: {read} read, {refused} refused, {placed} of these with a line");
    assert!(read > 10 && (refused > 10 || by != name), "{name}: {read} read, {refused} refused");
}

#[test]
fn scenes() {
    read_all("workshop.scn", "workshop.scn", include_str!("corpus/scn.txt"), SCENE, 1);
}

#[test]
fn obj_models() {
    read_all("lamp.obj", "lamp.obj", include_str!("corpus/obj.txt"), MODEL, 2);
}

/// By way of the model that names it: a library alone is never an error.
#[test]
fn mtl_libraries() {
    read_all("lamp.mtl", "lamp.obj", include_str!("corpus/mtl.txt"), LIBRARY, 3);
}

#[test]
fn ply_models() {
    read_all("leaf.ply", "leaf.ply", include_str!("corpus/ply.txt"), LEAF, 4);
}

/// A recipe as burnish writes it.
fn recipe() -> String {
    let scene = Arc::new(Example::named("plates").unwrap().read().unwrap().0.build());
    let params = Params { size: [4, 3], ..Params::new(scene) };
    let snapshot = render(params.clone(), 1, 1).unwrap();
    serde_json::to_string_pretty(&Recipe::new(&params, &snapshot)).unwrap()
}

#[test]
fn recipes() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let broken = corpus(include_str!("corpus/recipe.txt"));
    assert!(broken.len() >= 60);
    let whole = recipe().into_bytes();
    // Most of the text is the scene's: half of the changes are to go elsewhere.
    let mut short: serde_json::Value = serde_json::from_slice(&whole).unwrap();
    short["scene"]["text"] = "sphere 0 0 0 1\n".into();
    let short = serde_json::to_vec_pretty(&short).unwrap();
    let mut files: Vec<Vec<u8>> = vec![whole, short];
    files.extend(broken);
    let words = ["null", "-1", "1e999", "\"", "{", "[", "4294967296", "\\u001b", ",", ":", "{}"];
    let (mut read, mut refused) = (0, 0);
    try_all(&files, 2, &words, 5, |bytes, _| {
        let text = String::from_utf8_lossy(bytes);
        let most = FREE + EACH * bytes.len();
        let result = bounded(most, bytes, 5, || {
            let recipe = Recipe::parse(&text).map_err(|e| e.to_string())?;
            recipe.arguments();
            recipe.scene_text().map_err(|e| e.to_string()).map(drop)
        });
        match result {
            Ok(()) => read += 1,
            Err(told) => {
                refused += 1;
                assert!(is_fit(&told), "{told:?}");
            }
        }
    });
    println!("recipes: {read} read, {refused} refused");
    assert!(read > 10 && refused > 10, "{read} read, {refused} refused");
}

/// Reads a picture file, which has to be on disk.
fn read_pictures(kind: &str, files: Vec<Vec<u8>>, most: usize, seed: u64) {
    assert!(files.len() >= 60, "{} files", files.len());
    let folder = folder();
    let path = folder.path().join(format!("x.{kind}"));
    let (mut read, mut refused) = (0, 0);
    let each = |bytes: &[u8], random: &mut Random| {
        std::fs::write(&path, bytes).unwrap();
        let part = ["", "part 1", "beauty"].get(random.below(6)).copied();
        let most = most + EACH * bytes.len();
        let result = bounded(most, bytes, seed, || {
            let recipe = read_recipe(&path).map_err(|e| e.to_string()).map(drop);
            let pixels = || read_exr_part(&path, part).map_err(|e| e.to_string()).map(drop);
            [recipe, if kind == "exr" { pixels() } else { Ok(()) }]
        });
        for result in result {
            match result {
                Ok(()) => read += 1,
                Err(told) => {
                    refused += 1;
                    assert!(is_fit(&told), "{told:?}");
                    assert!(told.contains(&format!("x.{kind}: ")), "{told}");
                }
            }
        }
    };
    on_one_thread(|| {
        try_all(&files, 2, &[], seed, each);
    });
    println!("{kind}: {read} read, {refused} refused");
    assert!(read > 10 && refused > 10, "{kind}: {read} read, {refused} refused");
}

/// What a file of no length may claim, packed and unpacked, and the picture made of it.
#[test]
fn exr_pictures() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder();
    let mut files = Vec::new();
    let path = folder.path().join("own.exr");
    let picture = Picture { width: 5, height: 4, pixels: vec![[0.5, 1.0, f32::NAN]; 20] };
    write_with_recipe(&path, &picture, Tone::default(), &recipe()).unwrap();
    files.push(std::fs::read(&path).unwrap());
    files.extend(exr::files());
    files.extend(written::whole().into_iter().map(|written| written.bytes));
    let most = 3 * burnish::limits::EXR_FREE_BYTES as usize;
    read_pictures("exr", files, most, 6);
}

/// Scanlines and tiles in every compression, several parts and windows that are off are read; deep ones are
/// refused as what they are.
#[test]
fn pictures_of_other_programs_are_read() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder();
    let path = folder.path().join("other.exr");
    for written::Written { bytes, exact, what } in written::whole() {
        std::fs::write(&path, &bytes).unwrap();
        let read = read_exr_part(&path, None).unwrap_or_else(|e| panic!("{what}: {e}"));
        let Picture { width, height, pixels } = read.picture;
        if exact {
            assert_eq!([width, height], [7, 5], "{what}");
            let wanted = (0..35).map(|i| (i % 7 + 8 * (i / 7)) as f32);
            let wanted: Vec<[f32; 3]> = wanted.map(|red| [red, 0.5 * red, 0.25 * red]).collect();
            assert_eq!(pixels, wanted, "{what}");
        }
    }
    for bytes in exr::deep_files() {
        std::fs::write(&path, bytes).unwrap();
        let told = read_exr_part(&path, None).unwrap_err().to_string();
        assert!(told.contains("other.exr: ") && told.contains("deep"), "{told}");
    }
}

#[test]
fn png_pictures() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let most = 8 * burnish::limits::TEXT_BYTES;
    read_pictures("png", exr::png_files(&recipe()), most, 7);
}
