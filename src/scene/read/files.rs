//! Where the files that a file refers to come from: the disk, or memory.

use crate::scene::{Source, SourceFile, builtin};
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::cell::RefCell;
use std::fs;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Finds the models and material libraries that a scene or model names.
pub trait Files {
    /// The file's path, as messages are to show it, and its bytes. The error says why there is
    /// none, in words that can follow "cannot read NAME: ".
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error>;
}

/// Files on disk: beside the file that names them, else in the working directory. A model that is
/// in neither may be one of the shipped scenes', so that an edited copy of those can be anywhere.
#[derive(Clone, Debug)]
pub struct Disk {
    folder: PathBuf,
}

impl Disk {
    /// For what the file at `path` refers to.
    pub fn beside(path: &Path) -> Disk {
        Disk { folder: path.parent().unwrap_or(Path::new("")).to_owned() }
    }
}

impl Files for Disk {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        let candidates = [self.folder.join(name), PathBuf::from(name)];
        let Some(path) = candidates.into_iter().find(|path| path.exists()) else {
            if let Some(bytes) = builtin::model(name) {
                return Ok((PathBuf::from(name), Cow::Borrowed(bytes)));
            }
            let text = "it is neither beside this file nor in the working directory";
            return Err(Error::new(ErrorKind::NotFound, text));
        };
        let bytes = load(&path)?;
        Ok((path, Cow::Owned(bytes)))
    }
}

/// Files in memory, as pairs of name and content.
///
/// The built-in scene brings its models this way.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'a>(pub &'a [(&'a str, &'a [u8])]);

impl Files for Memory<'_> {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        match self.0.iter().find(|(known, _)| *known == name) {
            Some((_, bytes)) => Ok((PathBuf::from(name), Cow::Borrowed(bytes))),
            None => Err(Error::new(ErrorKind::NotFound, "there is no such file")),
        }
    }
}

/// Remembers what was read, for [`Source::files`].
pub(super) struct Recorder<'a> {
    files: &'a dyn Files,
    seen: RefCell<Vec<SourceFile>>,
}

impl<'a> Recorder<'a> {
    /// Begins with a scene's own file.
    pub(super) fn new(own: &Path, bytes: &[u8], files: &'a dyn Files) -> Recorder<'a> {
        let name = own.file_name().unwrap_or(own.as_os_str()).to_string_lossy();
        let own = record(&name, own.to_owned(), bytes);
        Recorder { files, seen: RefCell::new(vec![own]) }
    }

    pub(super) fn finish(self) -> Source {
        Source { files: self.seen.into_inner(), ..Source::default() }
    }
}

impl Files for Recorder<'_> {
    fn find(&self, name: &str) -> Result<(PathBuf, Cow<'_, [u8]>), Error> {
        let (path, bytes) = self.files.find(name)?;
        let mut seen = self.seen.borrow_mut();
        if !seen.iter().skip(1).any(|file| file.name == name) {
            seen.push(record(name, path.clone(), &bytes));
        }
        Ok((path, bytes))
    }
}

fn record(name: &str, path: PathBuf, bytes: &[u8]) -> SourceFile {
    let digest = Sha256::digest(bytes);
    let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    SourceFile { name: name.to_owned(), path, bytes: bytes.len() as u64, sha256 }
}

/// A gigabyte of text is about thirty million triangles; more would not fit into memory as a scene.
const MAX_BYTES: u64 = 4 << 30;

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
    if about.len() > MAX_BYTES {
        return refuse("it is larger than 4 GiB");
    }
    fs::read(path)
}
