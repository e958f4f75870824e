//! What a reader has to tell about a file that it could read.

use crate::plain;
use std::fmt;
use std::path::PathBuf;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Its line, counted from 1; `None` where the remark is about the whole file.
    pub line: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", plain::path(&self.file))?;
        if let Some(line) = self.line { write!(f, ":{line}") } else { Ok(()) }
    }
}

/// Something that was read differently from how its author may have meant it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where.
    pub place: Place,
    /// What, why, and what to do about it, in one sentence.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)
    }
}

/// All that a reader has to tell: nothing is ever ignored in silence.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// In the order of the lines.
    pub warnings: Vec<Warning>,
    /// Facts that are not warnings, such as "lit by a uniform white environment".
    pub notes: Vec<String>,
}
