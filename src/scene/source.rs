//! Where a scene came from: enough to tell it from any other, and to write it down again.

use super::{Axis, MaterialId};
use std::path::PathBuf;

/// The files that a scene was read from. Empty for a scene built by calls.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// What the command line calls it, if it is one of the program's own
    /// [`EXAMPLES`](super::builtin::EXAMPLES).
    pub example: Option<&'static str>,
    /// The text of a `.scn` file without its byte order mark; `None` for a model alone.
    pub text: Option<String>,
    /// The axis of a model alone that was turned to point up; `None` for other scenes.
    pub up: Option<Axis>,
    /// The scene's own file, then each model and material library that it names, once, in the
    /// order in which they were read.
    pub files: Vec<SourceFile>,
    /// The line of `text` that says what each material is; `None` for the one that shapes have
    /// before any such line.
    pub lines: Vec<Option<usize>>,
}

/// A file that a scene was read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// As the scene calls it; the scene's own file without its folders.
    pub name: String,
    /// Where it was found; its name for one in memory.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// SHA-256 of its bytes, in lower-case hexadecimal digits.
    pub sha256: String,
}

impl Source {
    /// The line that says what a material is.
    pub fn line(&self, material: MaterialId) -> Option<usize> {
        self.lines.get(material as usize).copied().flatten()
    }
}
