//! Where the files that a file refers to come from: the disk, or memory.

use super::text::{decode_names, raw};
use crate::limits::{Bytes, FILE_BYTES, READ_FACTOR, fits};
use crate::plain;
use crate::scene::examples;
use crate::scene::{Source, SourceFile};
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::ffi::OsString;
use std::fs;
use std::io::{Error, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Finds the models and material libraries that a scene or model names.
pub trait Files {
    /// The file's path, as messages are to show it, and its bytes. The error says why there is
    /// none, in words that can follow "cannot read NAME: ".
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error>;
}

/// Files on disk: beside the file that names them, else in the working directory. A model that is
/// in neither may be one of the shipped scenes', so that an edited copy of those can be anywhere.
/// At last a file beside counts whose name differs in capitals alone.
#[derive(Clone, Debug)]
pub struct Disk {
    folder: PathBuf,
    /// What folders hold, by names without capitals; listed once, when it is first asked for.
    listings: Arc<Mutex<HashMap<PathBuf, Listing>>>,
}

type Listing = HashMap<String, OsString>;

impl Disk {
    /// For what the file at `path` refers to.
    pub fn beside(path: &Path) -> Disk {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Disk { folder, listings: Arc::default() }
    }

    /// Where a file of this name is looked for, in this order.
    pub fn places(&self, name: &str) -> Vec<PathBuf> {
        let wanted = path_of(name);
        vec![self.folder.join(&wanted), wanted]
    }

    /// The file of this name, whatever its capitals and those of its folders.
    fn in_any_case(&self, name: &Path) -> Option<PathBuf> {
        let mut found = self.folder.clone();
        for component in name.components() {
            match component {
                Component::CurDir => {}
                Component::ParentDir => found.push(".."),
                Component::Normal(name) if found.join(name).exists() => found.push(name),
                Component::Normal(name) => {
                    let mut listings = self.listings.lock().ok()?;
                    let listing = listings.entry(found.clone()).or_insert_with(|| listing(&found));
                    found.push(listing.get(&without_capitals(name.as_encoded_bytes()))?);
                }
                Component::RootDir | Component::Prefix(_) => return None,
            }
        }
        Some(found)
    }
}

/// Of names that differ in capitals alone, the first in the order of their bytes counts.
fn listing(folder: &Path) -> Listing {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<OsString> = entries.map(|entry| entry.file_name()).collect();
    names.sort_unstable_by(|a, b| b.cmp(a));
    names.into_iter().map(|name| (without_capitals(name.as_encoded_bytes()), name)).collect()
}

fn without_capitals(name: &[u8]) -> String {
    decode_names(name).to_lowercase()
}

/// A name as its file had it, which need not be text.
fn path_of(name: &str) -> PathBuf {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt;
        OsString::from_vec(raw(name)).into()
    }
    #[cfg(not(unix))]
    {
        String::from_utf8_lossy(&raw(name)).into_owned().into()
    }
}

impl Files for Disk {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        let Some(path) = self.places(name).into_iter().find(|path| path.exists()) else {
            if let Some(bytes) = examples::model(name) {
                return Ok((PathBuf::from(name), Cow::Borrowed(bytes)));
            }
            if let Some(path) = self.in_any_case(&path_of(name)).filter(|path| path.is_file()) {
                let bytes = load(&path)?;
                return Ok((path, Cow::Owned(bytes)));
            }
            let text = "it is neither beside this file nor in the working directory";
            return Err(Error::new(ErrorKind::NotFound, text));
        };
        let bytes = load(&path)?;
        Ok((path, Cow::Owned(bytes)))
    }
}

/// Files in memory, as pairs of name and content. Capitals count only between names that differ
/// in nothing else.
///
/// The built-in scene brings its models this way.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'a>(pub &'a [(&'a str, &'a [u8])]);

impl Files for Memory<'_> {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        let exact = self.0.iter().find(|(known, _)| *known == name);
        let in_any_case = || self.0.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        match exact.or_else(in_any_case) {
            Some((known, bytes)) => Ok((PathBuf::from(known), Cow::Borrowed(bytes))),
            None => Err(Error::new(ErrorKind::NotFound, "there is no such file")),
        }
    }
}

/// Remembers what was read, for [`Source::files`].
pub(super) struct FileRecorder<'a> {
    files: &'a dyn Files,
    seen: RefCell<Vec<SourceFile>>,
    names: RefCell<HashSet<String>>,
    /// The folder of the scene's own file, links followed; `None` where there is none.
    folder: Option<PathBuf>,
    /// What was read from elsewhere.
    outside: RefCell<Vec<PathBuf>>,
}

impl<'a> FileRecorder<'a> {
    /// Begins with a scene's own file.
    pub(super) fn new(own: &Path, bytes: &[u8], files: &'a dyn Files) -> FileRecorder<'a> {
        let name = own.file_name().unwrap_or(own.as_os_str()).to_string_lossy();
        let own = record(&name, own.to_owned(), bytes);
        let folder = fs::canonicalize(&own.path).ok();
        let folder = folder.and_then(|path| path.parent().map(Path::to_owned));
        let (names, outside) = (RefCell::default(), RefCell::default());
        FileRecorder { files, seen: RefCell::new(vec![own]), names, folder, outside }
    }

    /// A scene is one folder's affair; where it reaches beyond, who opens it is to know.
    fn note_outside(&self, path: &Path) {
        let place = fs::canonicalize(path).ok();
        if let (Some(folder), Some(place)) = (&self.folder, place)
            && !place.starts_with(folder)
        {
            self.outside.borrow_mut().push(path.to_owned());
        }
    }

    /// Which files are elsewhere, for the report.
    pub(super) fn remarks(&self) -> Vec<String> {
        const MOST: usize = 8;
        let outside = self.outside.borrow();
        let note = |path: &PathBuf| format!("{}: is not in the scene's folder", plain::path(path));
        let mut notes: Vec<String> = outside.iter().take(MOST).map(note).collect();
        if outside.len() > MOST {
            notes
                .push(format!("{} more files are not in the scene's folder", outside.len() - MOST));
        }
        notes
    }

    pub(super) fn finish(self) -> Source {
        Source { files: self.seen.into_inner(), ..Source::default() }
    }
}

impl Files for FileRecorder<'_> {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        let (path, bytes) = self.files.find(name)?;
        // Those that are in the program or in memory as well.
        room_to_read(bytes.len() as u64)?;
        if self.names.borrow_mut().insert(name.to_owned()) {
            self.seen.borrow_mut().push(record(name, path.clone(), &bytes));
            self.note_outside(&path);
        }
        Ok((path, bytes))
    }
}

fn record(name: &str, path: PathBuf, bytes: &[u8]) -> SourceFile {
    let digest = Sha256::digest(bytes);
    let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    SourceFile { name: name.to_owned(), path, bytes: bytes.len() as u64, sha256 }
}

/// All bytes of a regular file. Pipes and devices, which may never end, are refused.
pub(super) fn load(path: &Path) -> Result<Vec<u8>, Error> {
    let about = fs::metadata(path)?;
    let refuse = |text: &str| Err(Error::new(ErrorKind::InvalidInput, text));
    if about.is_dir() {
        return refuse("it is a directory");
    }
    if !about.is_file() {
        return refuse("it is not a regular file");
    }
    if about.len() > FILE_BYTES {
        return refuse(&format!("it is larger than {}", Bytes(FILE_BYTES)));
    }
    room_to_read(about.len())?;
    fs::read(path)
}

/// Whether there is the memory to read this number of bytes.
fn room_to_read(bytes: u64) -> Result<(), Error> {
    let what = || format!("to read its {}", Bytes(bytes));
    fits(bytes.saturating_mul(READ_FACTOR), what)
        .map_err(|e| Error::new(ErrorKind::OutOfMemory, e.to_string()))
}
