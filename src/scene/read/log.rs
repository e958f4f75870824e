//! What a reader says: warnings and notes while it goes on, one error when it cannot.

use crate::scene::{Place, Report, Warning};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file could not be read: where, what was expected there, and what was found.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{place}: {text}")]
pub struct ReadError {
    /// The file, and its line where one is to blame.
    pub place: Place,
    /// One sentence.
    pub text: String,
}

impl ReadError {
    /// About a file as a whole.
    pub(super) fn whole_file(file: &Path, text: String) -> ReadError {
        ReadError { place: Place { file: file.to_owned(), line: None }, text }
    }
}

/// A file of a million odd lines must not become a million warnings.
const MAX_WARNINGS: usize = 1000;

/// Collects what there is to tell about one file and those that it refers to.
pub(super) struct Log {
    file: PathBuf,
    report: Report,
    unlisted: usize,
}

impl Log {
    pub(super) fn new(file: &Path) -> Log {
        Log { file: file.to_owned(), report: Report::default(), unlisted: 0 }
    }

    fn place(&self, line: Option<usize>) -> Place {
        Place { file: self.file.clone(), line }
    }

    pub(super) fn error(&self, line: Option<usize>, text: impl Into<String>) -> ReadError {
        ReadError { place: self.place(line), text: text.into() }
    }

    pub(super) fn warn(&mut self, line: Option<usize>, text: impl Into<String>) {
        if self.report.warnings.len() < MAX_WARNINGS {
            let warning = Warning { place: self.place(line), text: text.into() };
            self.report.warnings.push(warning);
        } else {
            self.unlisted += 1;
        }
    }

    pub(super) fn note(&mut self, text: impl Into<String>) {
        self.report.notes.push(text.into());
    }

    /// A note that begins with the file's name.
    pub(super) fn note_on_file(&mut self, text: String) {
        self.note(format!("{}: {text}", self.file.display()));
    }

    /// Lets `read` tell about another file; its remarks are kept in order.
    pub(super) fn within<T>(&mut self, file: PathBuf, read: impl FnOnce(&mut Log) -> T) -> T {
        let outer = std::mem::replace(&mut self.file, file);
        let result = read(self);
        self.file = outer;
        result
    }

    pub(super) fn finish(mut self) -> Report {
        if self.unlisted > 0 {
            let text = format!("{} further warnings are not listed", self.unlisted);
            self.report.warnings.push(Warning { place: self.place(None), text });
        }
        self.report
    }
}

/// Counts what is not supported, by kind, so that each kind becomes one warning.
#[derive(Default)]
pub(super) struct Unsupported {
    kinds: HashMap<String, (usize, usize)>,
}

impl Unsupported {
    /// One more of this kind, on this line.
    pub(super) fn add(&mut self, kind: &str, line: usize) {
        match self.kinds.get_mut(kind) {
            Some((_, count)) => *count += 1,
            None => {
                self.kinds.insert(kind.to_owned(), (line, 1));
            }
        }
    }

    /// One warning a kind, at the line where it first occurs.
    pub(super) fn report(self, log: &mut Log) {
        let mut kinds: Vec<_> = self.kinds.into_iter().map(|(k, (line, n))| (line, k, n)).collect();
        kinds.sort_unstable();
        for (line, kind, count) in kinds {
            let times = if count > 1 { format!(" ({count} lines)") } else { String::new() };
            log.warn(Some(line), format!("{kind} is not supported and left out{times}"));
        }
    }
}
