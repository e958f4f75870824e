//! The scenes that were opened last.

use std::path::{Path, PathBuf};

/// Files, the last opened first, each once.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Recent(Vec<PathBuf>);

impl Recent {
    /// Largest number that is remembered.
    const MOST: usize = 10;

    /// As they were remembered.
    pub(crate) fn new(paths: impl IntoIterator<Item = PathBuf>) -> Recent {
        let mut recent = Recent::default();
        for path in paths {
            if recent.0.len() < Self::MOST && !recent.0.contains(&path) {
                recent.0.push(path);
            }
        }
        recent
    }

    /// Puts a file that was opened in front.
    pub(crate) fn add(&mut self, path: &Path) {
        // By the working directory of today it would not be found tomorrow.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        self.0.retain(|p| *p != path);
        self.0.insert(0, path);
        self.0.truncate(Self::MOST);
    }

    pub(crate) fn paths(&self) -> &[PathBuf] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_are_kept_the_last_first_and_each_once() {
        let mut recent = Recent::default();
        for i in 0..12 {
            recent.add(Path::new(&format!("/scenes/{i}.scn")));
        }
        recent.add(Path::new("/scenes/5.scn"));
        let names: Vec<String> = recent.paths().iter().map(|p| p.display().to_string()).collect();
        let expected = [5, 11, 10, 9, 8, 7, 6, 4, 3, 2].map(|i| format!("/scenes/{i}.scn"));
        assert_eq!(names, expected);
        let twice = recent.paths().iter().chain(recent.paths()).cloned();
        assert_eq!(Recent::new(twice), recent);
    }

    #[test]
    fn a_path_is_remembered_from_the_root() {
        let mut recent = Recent::default();
        recent.add(Path::new("table.scn"));
        assert!(recent.paths()[0].is_absolute());
    }
}
