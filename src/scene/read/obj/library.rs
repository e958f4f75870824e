//! The MTL files that an OBJ names, found by what may be meant, and their materials by name.

use super::lines::Name;
use super::mtl::{self, Entry};
use crate::scene::Material;
use crate::scene::read::ReadError;
use crate::scene::read::files::Files;
use crate::scene::read::log::{Doubts, Log};
use crate::scene::read::text::shown;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::{Error, ErrorKind};
use std::path::PathBuf;

/// All materials that the MTL files of a model define.
#[derive(Default)]
pub(super) struct Library {
    files: Vec<(PathBuf, Doubts)>,
    /// Materials with the number of their file.
    entries: Vec<(usize, Entry)>,
    /// Those of each name, in the order of the files.
    names: HashMap<String, Vec<usize>>,
    read: HashSet<PathBuf>,
}

/// The number of a material in its library.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Found(usize);

type FoundModel<'a> = Result<(PathBuf, Cow<'a, [u8]>), Error>;

impl Library {
    /// Reads these files, each once; one that cannot be found is a warning.
    pub(super) fn read(libraries: &[(usize, Name)], files: &dyn Files, log: &mut Log) -> Library {
        let mut all = Library::default();
        let mut seen = HashSet::new();
        for (line, name) in libraries {
            if seen.insert(name) {
                all.add_named(*line, name, files, log);
            }
        }
        all
    }

    /// A name may hold blanks, and a line several names.
    fn add_named(&mut self, line: usize, name: &Name, files: &dyn Files, log: &mut Log) {
        // Where there is no such file, the mark of a comment may belong to the name, or not.
        let uncommented = name.whole.split('#').next().unwrap_or_default().trim();
        let readings = [name.text.as_str(), &name.whole, uncommented];
        for reading in readings.into_iter().filter(|reading| !reading.is_empty()) {
            if let Ok((path, bytes)) = exact(reading, files) {
                return self.add(path, &bytes);
            }
        }
        let pieces = pieces(&name.text);
        if pieces.len() > 1 {
            for piece in pieces {
                self.add_piece(line, piece, files, log);
            }
        } else {
            self.add_piece(line, &name.text, files, log);
        }
    }

    /// One name, or several between blanks where none has the ending that tells them apart.
    fn add_piece(&mut self, line: usize, name: &str, files: &dyn Files, log: &mut Log) {
        let words: Vec<&str> = name.split_whitespace().collect();
        let several = |files: &dyn Files| {
            words.len() > 1 && words.iter().all(|word| exact(word, files).is_ok())
        };
        let hit = match exact(name, files) {
            Err(_) if several(files) => None,
            Err(e) => match by_file_name(name, files) {
                Ok(hit) => Some(Ok(hit)),
                Err(_) if words.len() > 1 => None,
                Err(_) => Some(Err(e)),
            },
            hit => Some(hit),
        };
        match hit {
            Some(Ok((path, bytes))) => self.add(path, &bytes),
            Some(Err(e)) => {
                log.warn(Some(line), format!("mtllib: cannot read {}: {e}", shown(name)));
            }
            None => words.iter().for_each(|word| self.add_piece(line, word, files, log)),
        }
    }

    fn add(&mut self, path: PathBuf, bytes: &[u8]) {
        if !self.read.insert(path.clone()) {
            return;
        }
        let mut doubts = Doubts::default();
        for entry in mtl::read(bytes, &mut doubts) {
            let of_name = self.names.entry(entry.name.text.clone()).or_default();
            let number = self.entries.len();
            // Told where it is looked for, unless it is the very same name.
            let again = of_name.iter().position(|&i| self.entries[i].1.name == entry.name);
            match again {
                Some(at) => {
                    if !entry.same_surface(&self.entries[of_name[at]].1) {
                        doubts.add_one("again", entry.line, "materials", || again_counts(&entry));
                    }
                    of_name[at] = number;
                }
                None => of_name.push(number),
            }
            self.entries.push((self.files.len(), entry));
        }
        self.files.push((path, doubts));
    }

    /// The material of this name; `None` if no file defines it.
    pub(super) fn find(&mut self, name: &Name) -> Option<Found> {
        let of_name = self.names.get(&name.text)?;
        let whole = of_name.iter().find(|&&i| self.entries[i].1.name == *name);
        let &number = whole.or(of_name.last())?;
        let (file, entry) = &self.entries[number];
        let others = of_name.iter().any(|&i| !self.entries[i].1.same_surface(entry));
        if whole.is_none() && others {
            self.files[*file].1.add_one("again", entry.line, "materials", || again_counts(entry));
        }
        Some(Found(number))
    }

    /// That material.
    pub(super) fn material(&mut self, found: Found, log: &mut Log) -> Result<Material, ReadError> {
        let (file, entry) = &self.entries[found.0];
        let (path, doubts) = &mut self.files[*file];
        log.within(path.clone(), |log| entry.material(doubts, log))
    }

    /// Tells what was doubtful in the files.
    pub(super) fn report(self, log: &mut Log) {
        for (path, doubts) in self.files {
            log.within(path, |log| doubts.report(log));
        }
    }
}

fn again_counts(entry: &Entry) -> String {
    format!("`{}` is defined again; this one counts", shown(&entry.name.text))
}

/// The file of this name, as it is, without quotes, with the folders of another system, or with
/// what stands for blanks in addresses.
fn exact<'a>(name: &str, files: &'a dyn Files) -> FoundModel<'a> {
    first(&spellings(name), files)
}

/// The file of this name in whatever folder.
fn by_file_name<'a>(name: &str, files: &'a dyn Files) -> FoundModel<'a> {
    let last = |name: &String| name.rsplit('/').next().unwrap_or_default().trim().to_owned();
    let mut names: Vec<String> = spellings(name).iter().map(last).collect();
    names.retain(|name| !matches!(name.as_str(), "" | "." | ".."));
    first(&names, files)
}

fn first<'a>(names: &[String], files: &'a dyn Files) -> FoundModel<'a> {
    let mut error = Error::new(ErrorKind::NotFound, "there is no such file");
    for (i, name) in names.iter().enumerate() {
        match files.find(name) {
            Ok(hit) => return Ok(hit),
            // That there is something, but no file, says more than that there is nothing.
            Err(e) if i == 0 || e.kind() != ErrorKind::NotFound => error = e,
            Err(_) => {}
        }
    }
    Err(error)
}

fn spellings(name: &str) -> Vec<String> {
    let plain = unquoted(name);
    let mut all = vec![name.to_owned(), plain.to_owned(), plain.replace('\\', "/")];
    if let Some(slashed) = all.last().filter(|name| name.contains("%20")) {
        all.push(slashed.replace("%20", " "));
    }
    all.dedup();
    all
}

fn unquoted(name: &str) -> &str {
    let quote = |c: char| matches!(c, '"' | '\'');
    match name.chars().next() {
        Some(c) if quote(c) && name.len() > 1 => {
            name[1..].strip_suffix(c).unwrap_or(&name[1..]).trim()
        }
        _ => name.strip_suffix(quote).unwrap_or(name),
    }
}

/// The names in a line: in quotes, or each up to its ending.
fn pieces(names: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = names.trim();
    while !rest.is_empty() {
        let quoted = rest.chars().next().filter(|c| matches!(c, '"' | '\''));
        let end = match quoted.and_then(|c| rest[1..].find(c)) {
            Some(close) => close + 2,
            None => name_end(rest),
        };
        pieces.push(rest[..end].trim());
        rest = rest[end..].trim_start();
    }
    pieces
}

/// Where the first name ends: after an ending that a blank follows.
fn name_end(names: &str) -> usize {
    const ENDING: &str = ".mtl";
    let lower = names.to_ascii_lowercase();
    let ends = lower.match_indices(ENDING).map(|(at, _)| at + ENDING.len());
    ends.into_iter()
        .find(|&end| names[end..].starts_with(|c: char| c.is_whitespace()))
        .unwrap_or(names.len())
}
