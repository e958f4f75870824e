//! Broken experiments: bytes, texts and single sums changed. What is still taken for one has to go on.

use super::bounded::{EACH, FREE, bounded};
use super::mutate::{Random, is_fit, try_all};
use super::{TURN, folder};
use burnish::picture::{ReadTables, Table, read_exr, read_tables, write_with_tables};
use burnish::progressive::{Experiment, Options, Params, Session, State};
use burnish::scene::Scene;
use burnish::scene::builtin::Example;
use std::path::Path;
use std::sync::{Arc, PoisonError, mpsc};

const TEXTS: [&str; 2] = ["burnish", "burnish experiment"];

fn scene() -> Arc<Scene> {
    Arc::new(Example::named("plates").unwrap().read().unwrap().0.build())
}

/// Experiments of a few passes, of a plan among them.
fn write(scene: &Arc<Scene>, uniform: bool, passes: u64, path: &Path) {
    let params = Params { size: [18, 5], uniform, ..Params::new(scene.clone()) };
    let session = Session::with_options(params, passes, Options::headless(1), || {}).unwrap();
    session.snapshots().iter().find(|s| s.state == State::Done).unwrap();
    let (tell, told) = mpsc::channel();
    let to = path.to_path_buf();
    session.visit_experiment(move |experiment| tell.send(experiment.save(&to)).unwrap());
    told.recv().unwrap().unwrap();
}

/// The same tables and texts in a file again.
fn write_tables(path: &Path, picture: &Path, read: &ReadTables) {
    let fills: Vec<_> = read
        .tables
        .iter()
        .map(|table| {
            move |channel: usize, [x, y]: [u32; 2], numbers: &mut [u32]| {
                let start = (y * table.size[0] + x) as usize;
                numbers.copy_from_slice(&table.channels[channel].1[start..start + numbers.len()]);
            }
        })
        .collect();
    let table = |(table, fill): (&'_ burnish::picture::ReadTable, _)| {
        let names = table.channels.iter().map(|(name, _)| name.clone()).collect();
        (table.name.clone(), table.size, names, fill)
    };
    let all: Vec<_> = read.tables.iter().zip(&fills).map(table).collect();
    let tables: Vec<Table> = all
        .iter()
        .map(|(name, size, names, fill)| {
            let channels: &Vec<String> = names;
            Table { name, size: *size, channels: channels.clone(), fill: *fill }
        })
        .collect();
    let texts: Vec<(&str, &str)> =
        TEXTS.into_iter().zip(&read.texts).map(|(n, t)| (n, t.as_deref().unwrap())).collect();
    write_with_tables(path, &read_exr(picture).unwrap(), &texts, &tables).unwrap();
}

/// Reads it, and has what is read go on; whether there was something.
fn use_all(path: &Path, bytes: &[u8], scene: &Arc<Scene>, seed: u64) -> bool {
    let most = 3 * burnish::limits::EXR_FREE_BYTES as usize + FREE + EACH * bytes.len();
    match bounded(most, bytes, seed, || Experiment::read(path).map_err(|e| e.to_string())) {
        Ok(read) => {
            let refused = read.clone().merge(&read).unwrap_err().to_string();
            assert!(is_fit(&refused), "{refused:?}");
            let _ = read.picture();
            let wanted = read.passes() + 2;
            if wanted > 200 {
                return true;
            }
            let options = Options::headless(1);
            match Session::with_experiment(read, scene.clone(), wanted, options, || {}) {
                Ok(session) => {
                    let over = |s: &burnish::progressive::Snapshot| s.state != State::Running;
                    let over = session.snapshots().iter().find(over).unwrap();
                    assert_eq!((over.state, over.passes), (State::Done, wanted));
                }
                Err(e) => assert!(is_fit(&e.to_string()), "{e}"),
            }
            true
        }
        Err(told) => {
            assert!(is_fit(&told) && told.contains("x.exr: "), "{told:?}");
            false
        }
    }
}

#[test]
fn experiments() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = folder();
    let (path, good) = (folder.path().join("x.exr"), folder.path().join("good.exr"));
    let scene = scene();
    let (mut read, mut refused) = (0, 0);
    let mut count = |is_read: bool| if is_read { read += 1 } else { refused += 1 };
    let kinds = [(true, 3), (false, 3), (false, 16), (false, 40), (false, 64)];
    let mut files = Vec::new();
    for (uniform, passes) in kinds {
        write(&scene, uniform, passes, &path);
        files.push(std::fs::read(&path).unwrap());
    }
    // Bytes of the file.
    try_all(&files, kinds.len(), &["\"", "[", "-1", "1e999", ","], 8, |bytes, _| {
        std::fs::write(&path, bytes).unwrap();
        count(use_all(&path, bytes, &scene, 8));
    });
    // Of a file that is whole, a number of a table or some of a text.
    try_all(&files, kinds.len(), &[], 9, |_, random: &mut Random| {
        let bytes = &files[random.below(files.len())];
        std::fs::write(&good, bytes).unwrap();
        let mut read = read_tables(&good, &TEXTS).unwrap();
        if random.below(2) == 0 {
            let text = read.texts[random.below(4).min(1)].as_mut().unwrap();
            let words =
                ["-1", "0", "1", "7", "40", "4294967296", "18446744073709551615", "null", "[]"];
            // In place of a number: anything else is seldom a text of its kind.
            let digits: Vec<usize> =
                text.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| i).collect();
            let at = digits[random.below(digits.len())];
            text.replace_range(at..at + 1, words[random.below(words.len())]);
        } else {
            let table = random.below(read.tables.len());
            let channels = &mut read.tables[table].channels;
            let channel = random.below(channels.len());
            let numbers = &mut channels[channel].1;
            let (at, bit) = (random.below(numbers.len()), random.below(33));
            numbers[at] = if bit == 32 { u32::MAX } else { numbers[at] ^ (1 << bit) };
        }
        write_tables(&path, &good, &read);
        let bytes = std::fs::read(&path).unwrap();
        count(use_all(&path, &bytes, &scene, 9));
    });
    println!("experiments: {read} read, {refused} refused");
    assert!(read > 10 && refused > 10, "{read} read, {refused} refused");
}
