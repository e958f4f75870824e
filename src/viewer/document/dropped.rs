//! Files that were dropped on the window together: which are meant.

use std::path::{Path, PathBuf};

/// File name extensions that can be opened, the likeliest first. Files that an .obj or a .scn names are read with it.
const SCENES: [&str; 3] = ["scn", "obj", "ply"];
/// Files that are read with a scene, if that names them: nothing is missed where they are dropped too.
const PARTS: [&str; 1] = ["mtl"];

/// Files sorted by what is done with them.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Dropped {
    /// The scene to open.
    pub(crate) scene: Option<PathBuf>,
    /// The picture to compare with.
    pub(crate) picture: Option<PathBuf>,
    /// Names of the others.
    pub(crate) left: Vec<String>,
}

impl Dropped {
    /// A file by itself is opened whatever it is: the reader says what is wrong with it.
    pub(crate) fn sorted(mut files: Vec<PathBuf>) -> Dropped {
        if files.len() == 1 {
            return Dropped { scene: files.pop(), ..Dropped::default() };
        }
        let mut take = |wanted: &str| {
            let place = files.iter().position(|file| is(file, wanted))?;
            Some(files.remove(place))
        };
        let scene = SCENES.iter().find_map(|kind| take(kind));
        let picture = take("exr");
        let name = |file: &PathBuf| {
            file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
        };
        let read_with =
            |file: &&PathBuf| scene.is_some() && PARTS.iter().any(|part| is(file, part));
        let left = files.iter().filter(|file| !read_with(file)).map(name).collect();
        Dropped { scene, picture, left }
    }
}

fn is(file: &Path, kind: &str) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case(kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_is_opened_whatever_comes_with_it() {
        let sorted = |files: &[&str]| {
            let Dropped { scene, picture, left } =
                Dropped::sorted(files.iter().map(PathBuf::from).collect());
            let text = |path: Option<PathBuf>| path.map(|p| p.display().to_string());
            (text(scene).unwrap_or_default(), text(picture).unwrap_or_default(), left.join(" "))
        };
        let row = |a: &str, b: &str, c: &str| (a.to_owned(), b.to_owned(), c.to_owned());
        assert_eq!(sorted(&[]), row("", "", ""));
        assert_eq!(sorted(&["/a/x.pdf"]), row("/a/x.pdf", "", ""));
        assert_eq!(sorted(&["/a/x.mtl", "/a/x.obj"]), row("/a/x.obj", "", ""));
        assert_eq!(sorted(&["x.OBJ", "y.ply", "z.scn"]), row("z.scn", "", "x.OBJ y.ply"));
        assert_eq!(sorted(&["a.exr", "x.ply", "b.EXR"]), row("x.ply", "a.exr", "b.EXR"));
        assert_eq!(sorted(&["a.mtl", "b.txt"]), row("", "", "a.mtl b.txt"));
    }
}
