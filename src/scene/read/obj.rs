//! OBJ and its MTL, by `tobj`.
//!
//! `tobj` names no line in its errors, panics on some indices, loses a vertex to a byte order mark,
//! cuts all polygons into fans, and splits shared vertices by texture coordinates, which would cut
//! smooth normals along every seam. So each statement is checked here first, and `tobj` is given
//! only those that matter, with absolute indices and normals on every corner or none, and polygons
//! as triangles. It unifies pairs of vertex and normal.
//!
//! Only what would make the geometry a guess is an error: coordinates that are no numbers, and
//! vertices that are not there.

mod library;
mod lines;
mod mtl;
mod shape;

use super::ReadError;
use super::files::Files;
use super::log::{Doubts, Log};
use super::text::{decode_names, shown};
use super::{GREY_IS, grey};
use crate::scene::{MaterialId, Mesh, SceneBuilder};
use library::Library;
use lines::{Name, statements};
use std::collections::HashMap;
use std::ops::Range;

/// What an OBJ file holds.
pub(super) struct ObjModel {
    /// The whole file as one mesh, its triangles ordered by part.
    pub(super) mesh: Mesh,
    parts: Vec<ObjPart>,
    /// The MTL files it names, with the line.
    libraries: Vec<(usize, Name)>,
}

impl ObjModel {
    /// The line that gives each part its material.
    pub(super) fn lines(&self) -> impl Iterator<Item = Option<usize>> {
        self.parts.iter().map(|part| part.material.as_ref().map(|(_, line)| *line))
    }
}

/// All faces of one object or group that have the same material.
struct ObjPart {
    /// Name and line of the `usemtl`.
    material: Option<(Name, usize)>,
    triangles: Range<usize>,
}

/// Reads the geometry, and the names of the materials but not those themselves.
pub(super) fn read(bytes: &[u8], log: &mut Log) -> Result<ObjModel, ReadError> {
    if bytes.is_empty() {
        return Err(log.error(None, "the file is empty"));
    }
    let text = decode_names(bytes);
    let mut shape = shape::Shape::default();
    // What old systems mark and fill the end of a file with.
    let body = text.trim_end_matches(['\0', '\u{1a}']);
    for statement in statements(body) {
        shape.statement(&statement).map_err(|text| log.error(Some(statement.line), text))?;
    }
    // A file of another kind, with the ending that compilers give theirs.
    if let (true, Some(at)) = (shape.is_empty(), text.find('\0')) {
        let line = super::text::lines(&text[..at]).count();
        return Err(log.error(Some(line), "expected text, found a zero byte"));
    }
    let filling = text.len() - body.len();
    if filling > 0 {
        log.warn(None, format!("{filling} bytes after the text are not used"));
    }
    shape.finish(log)
}

/// Adds the materials of a model that is opened by itself: each part with its material's number.
pub(super) fn materials(
    model: &ObjModel,
    files: &dyn Files,
    builder: &mut SceneBuilder,
    log: &mut Log,
) -> Result<Vec<(Range<usize>, MaterialId)>, ReadError> {
    let mut library = Library::read(&model.libraries, files, log);
    let mut ids: HashMap<Option<library::Found>, MaterialId> = HashMap::new();
    let mut undefined: HashMap<&str, MaterialId> = HashMap::new();
    let mut doubts = Doubts::default();
    let mut parts = Vec::with_capacity(model.parts.len());
    for part in &model.parts {
        let found = part.material.as_ref().and_then(|(name, _)| library.find(name));
        let id = match (&part.material, found) {
            (Some((name, line)), None) => match undefined.get(name.text.as_str()) {
                Some(id) => *id,
                None => {
                    doubts.add_one("undefined", *line, "materials", || {
                        format!("no MTL file defines `{}`: {GREY_IS}", shown(&name.text))
                    });
                    let id = builder.material(grey(log)?);
                    undefined.insert(&name.text, id);
                    id
                }
            },
            (_, found) => match ids.get(&found) {
                Some(id) => *id,
                None => {
                    let material = match found {
                        Some(found) => library.material(found, log)?,
                        None => {
                            log.note(format!("some faces have no material: {GREY_IS}"));
                            grey(log)?
                        }
                    };
                    let id = builder.material(material);
                    ids.insert(found, id);
                    id
                }
            },
        };
        parts.push((part.triangles.clone(), id));
    }
    doubts.report(log);
    library.report(log);
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smooth;

    /// One entry a triangle, in the order of the triangles, which are sorted by part.
    #[test]
    fn every_triangle_knows_what_the_file_says_of_smoothing() {
        let of = |faces: &str| {
            let text = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{faces}");
            let mut log = Log::new("m.obj".as_ref());
            let mesh = read(text.as_bytes(), &mut log).unwrap().mesh;
            let told = log.finish().warnings.iter().map(|w| w.to_string()).collect::<Vec<_>>();
            (mesh.smoothing, told)
        };
        use Smooth::{Flat, Group, Unsaid};
        let nothing: [String; 0] = [];
        for (faces, expected) in [
            ("f 1 2 3 4", vec![]),
            ("f 1 2 3 4\ns off", vec![]),
            ("s off\nf 1 2 3 4", vec![Flat; 2]),
            ("s 0\nf 1 2 3 4", vec![Flat; 2]),
            ("s OFF\nf 1 2 3", vec![Flat]),
            ("s 1\nf 1 2 3\ns 4294967295\nf 1 2 3", vec![Group(1), Group(u32::MAX)]),
            ("s on\nf 1 2 3", vec![Group(1)]),
            ("f 1 2 3\ns 7\nf 1 2 3\ns off\nf 1 2 3", vec![Unsaid, Group(7), Flat]),
            // The third is of the first part.
            (
                "usemtl a\ns 1\nf 1 2 3\nusemtl b\nf 1 2 3 4\nusemtl a\ns 2\nf 1 2 3",
                vec![Group(1), Group(2), Group(1), Group(1)],
            ),
        ] {
            assert_eq!(of(faces), (expected, nothing.to_vec()), "{faces}");
        }
        for odd in ["s", "s -1", "s smooth", "s 1.5", "s 4294967296", "s 1 2"] {
            let (found, told) = of(&format!("s 1\n{odd}\nf 1 2 3\n{odd}\ns 0\nf 1 2 3"));
            assert_eq!(found, [Unsaid, Flat], "{odd}");
            let [one] = told.as_slice() else { panic!("{told:?}") };
            assert!(one.starts_with("m.obj:6: s: expected `off`"), "{one}");
            assert!(one.ends_with("(2 lines)"), "{one}");
        }
    }
}
