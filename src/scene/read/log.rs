//! What a reader says: warnings and notes while it goes on, one error when it cannot.

use crate::plain;
use crate::scene::{Place, Report, Warning};
use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a file could not be read: where, what was expected there, and what was found.
///
/// A file with several errors is told of all of them, a line each when it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The file, and its line where one is to blame.
    pub place: Place,
    /// One sentence.
    pub text: String,
    /// What else is wrong, in the order of the lines, each a sentence about its place. Of very many
    /// the last one says how many are not listed.
    pub further: Vec<Fault>,
}

/// One of the further errors of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file, and its line where one is to blame.
    pub place: Place,
    /// One sentence.
    pub text: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)?;
        self.further.iter().try_for_each(|fault| write!(f, "\n{fault}"))
    }
}

impl std::error::Error for ReadError {}

impl ReadError {
    /// About a file as a whole.
    pub(super) fn whole_file(file: &Path, text: String) -> ReadError {
        let place = Place { file: file.to_owned(), line: None };
        ReadError { place, text, further: Vec::new() }
    }
}

/// Most errors of a file that are listed.
const MAX_ERRORS: usize = 20;

/// The errors of one file, while its reader goes on to find the others.
#[derive(Default)]
pub(super) struct Errors {
    found: Vec<ReadError>,
    unlisted: usize,
}

impl Errors {
    pub(super) fn add(&mut self, error: ReadError) {
        if self.found.len() < MAX_ERRORS {
            self.found.push(error);
        } else {
            self.unlisted += 1;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// All of them as one error about this file; `Ok` if there are none.
    pub(super) fn finish(self, log: &Log) -> Result<(), ReadError> {
        let mut found = self.found.into_iter();
        let Some(mut first) = found.next() else { return Ok(()) };
        for ReadError { place, text, further } in found {
            first.further.push(Fault { place, text });
            first.further.extend(further);
        }
        // A model may have brought some of its own.
        let most = MAX_ERRORS - 1;
        let unlisted = self.unlisted + first.further.len().saturating_sub(most);
        first.further.truncate(most);
        if unlisted > 0 {
            let plural = if unlisted == 1 { "error is" } else { "errors are" };
            let text = format!("{unlisted} further {plural} not listed");
            first.further.push(Fault { place: log.place(None), text });
        }
        Err(first)
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
        ReadError { place: self.place(line), text: text.into(), further: Vec::new() }
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
        self.note(format!("{}: {text}", plain::path(&self.file)));
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

/// Counts what is doubtful, by kind, so that each kind becomes one warning.
#[derive(Default)]
pub(super) struct Doubts {
    kinds: HashMap<String, Doubt>,
}

struct Doubt {
    line: usize,
    count: usize,
    unit: &'static str,
    text: String,
}

impl Doubts {
    /// One more of this kind, on this line. What the first says stands for all.
    pub(super) fn add(&mut self, kind: &str, line: usize, text: impl FnOnce() -> String) {
        self.add_one(kind, line, "lines", text);
    }

    /// Like [`Doubts::add`], where not lines are counted but things of this name.
    pub(super) fn add_one(
        &mut self,
        kind: &str,
        line: usize,
        unit: &'static str,
        text: impl FnOnce() -> String,
    ) {
        match self.kinds.get_mut(kind) {
            Some(doubt) => doubt.count += 1,
            None => {
                let doubt = Doubt { line, count: 1, unit, text: text() };
                self.kinds.insert(kind.to_owned(), doubt);
            }
        }
    }

    /// Something that is not supported.
    pub(super) fn unsupported(&mut self, kind: &str, line: usize) {
        self.add(kind, line, || format!("{kind} is not supported and left out"));
    }

    /// One warning a kind, at the line where it first occurs.
    pub(super) fn report(self, log: &mut Log) {
        let mut doubts: Vec<Doubt> = self.kinds.into_values().collect();
        doubts.sort_unstable_by(|a, b| (a.line, &a.text).cmp(&(b.line, &b.text)));
        for Doubt { line, count, unit, text } in doubts {
            let times = if count > 1 { format!(" ({count} {unit})") } else { String::new() };
            log.warn(Some(line), text + &times);
        }
    }
}
