//! The files that a command writes: none of those that it reads, none twice, and none in vain.

use super::{Failure, misused};
use burnish::picture::check_writable;
use burnish::plain;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Which file a path names, however it is written: links followed, and by the file system's own
/// number where it is there, as other names of it may be.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Which {
    #[cfg(unix)]
    Numbered(u64, u64),
    Named(PathBuf),
}

fn which(path: &Path) -> Which {
    #[cfg(unix)]
    if let Ok(about) = fs::metadata(path) {
        use std::os::unix::fs::MetadataExt;
        return Which::Numbered(about.dev(), about.ino());
    }
    let own = || fs::canonicalize(path).ok();
    // What is not there yet is in a folder that is.
    let beside = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
        Some(folder.join(path.file_name()?))
    };
    Which::Named(own().or_else(beside).unwrap_or_else(|| path.to_path_buf()))
}

/// Ends the program where two of these are one file; each has a word for what it is.
pub(super) fn are_distinct<'a>(outputs: impl IntoIterator<Item = &'a PathBuf>) {
    let mut seen: HashMap<Which, &Path> = HashMap::new();
    for path in outputs {
        if let Some(other) = seen.insert(which(path), path) {
            let (one, two) = (plain::path(other), plain::path(path));
            misused(if one == two {
                format!("{one} is to be written twice")
            } else {
                format!("{one} and {two} are one file: it would be written twice")
            });
        }
    }
}

/// Whether none of the outputs is one of the files that are read. A device, which may be both, is no
/// file to be lost, and refused elsewhere.
pub(super) fn are_no_inputs<'a, 'b>(
    outputs: impl IntoIterator<Item = &'a PathBuf>,
    inputs: impl IntoIterator<Item = &'b Path>,
) -> Result<(), Failure> {
    let inputs: HashMap<Which, &'b Path> =
        inputs.into_iter().filter(|path| path.exists()).map(|path| (which(path), path)).collect();
    for path in outputs {
        if let Some(input) = inputs.get(&which(path)) {
            return Err(Failure::new(format_args!(
                "{}: would be written over {}, which is read; choose another name",
                plain::path(path),
                plain::path(input)
            )));
        }
    }
    Ok(())
}

/// Whether all can be written: known before the work, not after.
pub(super) fn can_be_written<'a>(
    outputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    outputs.into_iter().try_for_each(|path| check_writable(path).map_err(Failure::new))
}

/// Writes one thing after the other, whether or not others fail: all failures as one.
#[derive(Default)]
pub(super) struct Failures(Vec<String>);

impl Failures {
    /// Goes on after a failure, which is told in the end.
    pub(super) fn add(&mut self, text: impl ToString) {
        self.0.push(text.to_string());
    }

    /// Notes how it went.
    pub(super) fn note(&mut self, result: Result<(), Failure>) {
        if let Err(Failure(text)) = result {
            self.0.extend(text);
        }
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        if self.0.is_empty() { Ok(()) } else { Err(Failure::new(self.0.join("\n"))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_itself_by_every_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "").unwrap();
        fs::write(at("b"), "").unwrap();
        fs::create_dir(at("sub")).unwrap();
        assert_eq!(which(&at("a")), which(&at("./a")));
        assert_eq!(which(&at("a")), which(&at("sub/../a")));
        assert_ne!(which(&at("a")), which(&at("b")));
        // Not yet there.
        assert_eq!(which(&at("new")), which(&at("sub/../new")));
        assert_ne!(which(&at("new")), which(&at("sub/new")));
        assert_ne!(which(&at("new")), which(&at("newer")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("a"), at("link")).unwrap();
            fs::hard_link(at("a"), at("hard")).unwrap();
            assert_eq!(which(&at("a")), which(&at("link")));
            assert_eq!(which(&at("a")), which(&at("hard")));
            let clash = are_no_inputs(&[at("hard")], [at("a").as_path()]).unwrap_err();
            assert!(clash.0.unwrap().contains("would be written over"));
        }
        assert!(are_no_inputs(&[at("b"), at("new")], [at("a").as_path()]).is_ok());
    }
}
