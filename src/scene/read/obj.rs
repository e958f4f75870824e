//! OBJ and its MTL, by `tobj`.
//!
//! `tobj` names no line in its errors, panics on some indices, loses a vertex to a byte order mark
//! and splits shared vertices by texture coordinates, which would cut smooth normals along every
//! seam. So each line is checked here first, and `tobj` is given only the statements that matter,
//! with absolute indices and normals on every corner or none, and polygons as triangles. It unifies
//! pairs of vertex and normal.

mod mtl;

use super::ReadError;
use super::files::Files;
use super::log::{Log, Unsupported};
use super::polygon::triangulate;
use super::text::{decode, lines, shown};
use super::{GREY_IS, grey};
use crate::scene::{MaterialId, Mesh, SceneBuilder, Smooth};
use glam::DVec3;
use std::collections::HashMap;
use std::fmt::Write;
use std::ops::Range;

/// What an OBJ file holds.
pub(super) struct Model {
    /// The whole file as one mesh, its triangles ordered by part.
    pub(super) mesh: Mesh,
    parts: Vec<Part>,
    /// The MTL files it names, with the line.
    libraries: Vec<(usize, String)>,
}

impl Model {
    /// The line that gives each part its material.
    pub(super) fn lines(&self) -> impl Iterator<Item = Option<usize>> {
        self.parts.iter().map(|part| part.material.as_ref().map(|(_, line)| *line))
    }
}

/// All faces of one object or group that have the same material.
struct Part {
    /// Name and line of the `usemtl`.
    material: Option<(String, usize)>,
    triangles: Range<usize>,
}

/// Reads the geometry, and the names of the materials but not those themselves.
pub(super) fn read(bytes: &[u8], log: &mut Log) -> Result<Model, ReadError> {
    let text = join_continued(&decode(bytes, log)?);
    let mut checked = Checked::default();
    for (number, line) in lines(&text) {
        checked.statement(number, line).map_err(|text| log.error(Some(number), text))?;
    }
    checked.finish(log)
}

/// Adds the materials of a model that is opened by itself: each part with its material's number.
pub(super) fn materials(
    model: &Model,
    files: &dyn Files,
    builder: &mut SceneBuilder,
    log: &mut Log,
) -> Result<Vec<(Range<usize>, MaterialId)>, ReadError> {
    let library = mtl::Library::read(&model.libraries, files, log)?;
    let mut ids: HashMap<Option<&str>, MaterialId> = HashMap::new();
    let mut parts = Vec::with_capacity(model.parts.len());
    for part in &model.parts {
        let name = part.material.as_ref().map(|(name, _)| name.as_str());
        let id = match ids.get(&name) {
            Some(id) => *id,
            None => {
                let material = match &part.material {
                    None => {
                        log.note(format!("some faces have no material: {GREY_IS}"));
                        grey(log)?
                    }
                    Some((name, line)) => match library.material(name, log)? {
                        Some(material) => material,
                        None => {
                            let name = shown(name);
                            let text = format!("no MTL file defines `{name}`: {GREY_IS}");
                            log.warn(Some(*line), text);
                            grey(log)?
                        }
                    },
                };
                let id = builder.material(material);
                ids.insert(name, id);
                id
            }
        };
        parts.push((part.triangles.clone(), id));
    }
    Ok(parts)
}

/// Joins lines that end in a backslash with the next, except comments, which may end in the name
/// of a folder; empty lines keep the count right.
fn join_continued(text: &str) -> String {
    let mut joined = String::with_capacity(text.len() + 1);
    let mut pending = 0;
    for (_, line) in lines(text) {
        let comment = pending == 0 && line.trim_start().starts_with('#');
        match line.strip_suffix('\\') {
            Some(start) if !comment => {
                joined.push_str(start);
                joined.push(' ');
                pending += 1;
            }
            _ => {
                joined.push_str(line);
                joined.extend(std::iter::repeat_n('\n', 1 + pending));
                pending = 0;
            }
        }
    }
    joined
}

/// The statements that passed, as text for `tobj`, and what it cannot tell afterwards.
#[derive(Default)]
struct Checked {
    vertices: String,
    normals: String,
    positions: Vec<DVec3>,
    normal_count: i64,
    /// Vertex and normal of the corners of all faces; normal 0 is none.
    corners: Vec<[u32; 2]>,
    faces: Vec<Face>,
    smooth: Smooth,
    /// Smoothing statements that say nothing: the line of the first, and how many.
    odd_smoothing: Option<(usize, usize)>,
    /// Corners with a normal.
    with_normal: usize,
    /// The largest vertex and normal index, each with its line: they may be defined later.
    largest: [(i64, usize); 2],
    object: String,
    material: Option<(String, usize)>,
    /// The part that faces now belong to, once one is there.
    part: Option<usize>,
    /// Part by names of object and material.
    part_numbers: HashMap<(String, Option<String>), usize>,
    materials: Vec<Option<(String, usize)>>,
    libraries: Vec<(usize, String)>,
    too_small: usize,
    unsupported: Unsupported,
}

/// A face: how many of the corners are its own, where it stands, and what it belongs to.
struct Face {
    count: usize,
    line: usize,
    part: usize,
    smooth: Smooth,
}

impl Checked {
    fn statement(&mut self, number: usize, line: &str) -> Result<(), String> {
        let line = line.trim();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim_start();
        match word {
            "v" => self.vertex(number, rest),
            "vn" => {
                let [x, y, z] = three(rest, "vn x y z")?;
                self.normal_count += 1;
                written(writeln!(self.normals, "vn {x} {y} {z}"))
            }
            "f" => self.face(number, rest),
            "o" | "g" => {
                rest.clone_into(&mut self.object);
                self.part = None;
                Ok(())
            }
            "usemtl" if rest.is_empty() => Err("usemtl: expected the name of a material".into()),
            "usemtl" => {
                self.material = Some((rest.to_owned(), number));
                self.part = None;
                Ok(())
            }
            "mtllib" if rest.is_empty() => Err("mtllib: expected the name of a file".into()),
            "mtllib" => {
                self.libraries.push((number, rest.to_owned()));
                Ok(())
            }
            "s" => {
                self.smooth = smoothing(rest).unwrap_or_else(|| {
                    self.odd_smoothing.get_or_insert((number, 0)).1 += 1;
                    Smooth::Unsaid
                });
                Ok(())
            }
            // Without textures their coordinates do not matter.
            "" | "vt" => Ok(()),
            comment if comment.starts_with('#') => Ok(()),
            other => {
                self.unsupported.add(&format!("`{}`", shown(other)), number);
                Ok(())
            }
        }
    }

    /// `v x y z`, with a weight or a colour.
    fn vertex(&mut self, number: usize, rest: &str) -> Result<(), String> {
        let texts = three(rest, "v x y z")?;
        let [x, y, z] = texts;
        let mut position = DVec3::from_array(texts.map(|t| t.parse().unwrap_or(f64::NAN)));
        let mut more = rest.split_whitespace().skip(3);
        let weight = match (more.next(), more.next()) {
            (None, _) => "",
            (Some(w), None) => match w.parse::<f64>() {
                Ok(weight) if weight != 0.0 => {
                    position /= weight;
                    w
                }
                _ => {
                    return Err(format!("v: expected a weight other than 0, not `{}`", shown(w)));
                }
            },
            _ => {
                self.unsupported.add("a colour of a vertex", number);
                ""
            }
        };
        self.positions.push(position);
        written(writeln!(self.vertices, "v {x} {y} {z} {weight}"))
    }

    fn vertex_count(&self) -> i64 {
        self.positions.len() as i64
    }

    fn face(&mut self, number: usize, rest: &str) -> Result<(), String> {
        let count = rest.split_whitespace().count();
        if count < 3 {
            self.too_small += 1;
            return Ok(());
        }
        for token in rest.split_whitespace() {
            let mut fields = token.split('/');
            let vertex = fields.next().unwrap_or_default();
            let (_texture, normal) = (fields.next(), fields.next().unwrap_or_default());
            if fields.next().is_some() {
                return Err(format!(
                    "f: expected a corner v, v/vt, v//vn or v/vt/vn, not `{}`",
                    shown(token)
                ));
            }
            let v = index(vertex, self.vertex_count(), "vertex")?;
            let n = if normal.is_empty() { 0 } else { index(normal, self.normal_count, "normal")? };
            for (largest, i) in self.largest.iter_mut().zip([v, n]) {
                *largest = (*largest).max((i, number));
            }
            self.with_normal += usize::from(n != 0);
            // Larger ones are an error in the end.
            self.corners.push([v, n].map(|i| u32::try_from(i).unwrap_or(u32::MAX)));
        }
        let part = self.part();
        self.faces.push(Face { count, line: number, part, smooth: self.smooth });
        Ok(())
    }

    /// The number of the part that faces now belong to.
    fn part(&mut self) -> usize {
        if let Some(part) = self.part {
            return part;
        }
        let name = self.material.as_ref().map(|(name, _)| name.clone());
        let materials = &mut self.materials;
        let part = *self.part_numbers.entry((self.object.clone(), name)).or_insert_with(|| {
            materials.push(self.material.clone());
            materials.len() - 1
        });
        self.part = Some(part);
        part
    }

    fn finish(mut self, log: &mut Log) -> Result<Model, ReadError> {
        let defined = [(self.vertex_count(), "vertex"), (self.normal_count, "normal")];
        for ((largest, line), (count, what)) in self.largest.into_iter().zip(defined) {
            if largest > count {
                let text = format!("f: expected a {what} index from 1 to {count}, not {largest}");
                return Err(log.error(Some(line), text));
            }
        }
        if self.faces.is_empty() {
            return Err(log.error(None, "the file has no faces, so there is nothing to show"));
        }
        if self.too_small > 0 {
            let text = format!("{} faces of fewer than three corners are left out", self.too_small);
            log.warn(None, text);
        }
        if let Some((line, count)) = self.odd_smoothing {
            let times = if count > 1 { format!(" ({count} lines)") } else { String::new() };
            let text = format!(
                "s: expected `off` or the number of a smoothing group: taken as if nothing were \
                 said{times}"
            );
            log.warn(Some(line), text);
        }
        let (faces, triangles) = self.triangles(log);
        std::mem::take(&mut self.unsupported).report(log);
        let mut mesh = run_tobj(&[&self.vertices, "vn 0 0 0\n", &self.normals, &faces])
            .map_err(|e| log.error(None, format!("the OBJ reader refuses this file: {e}")))?;
        if self.with_normal == 0 {
            mesh.normals.clear();
        }
        let mut order: Vec<usize> = (0..mesh.triangles.len().min(triangles.len())).collect();
        order.sort_by_key(|&triangle| triangles[triangle].0);
        mesh.triangles = order.iter().map(|&i| mesh.triangles[i]).collect();
        if self.faces.iter().any(|face| face.smooth != Smooth::Unsaid) {
            mesh.smoothing = order.iter().map(|&i| triangles[i].1).collect();
        }
        let mut parts = Vec::with_capacity(self.materials.len());
        let mut start = 0;
        for (number, material) in self.materials.into_iter().enumerate() {
            let end = order.partition_point(|&triangle| triangles[triangle].0 <= number);
            parts.push(Part { material, triangles: start..end });
            start = end;
        }
        Ok(Model { mesh, parts, libraries: self.libraries })
    }

    /// All faces as triangles, and the part and smoothing of each.
    fn triangles(&self, log: &mut Log) -> (String, Vec<(usize, Smooth)>) {
        let (mut text, mut triangles) = (String::new(), Vec::new());
        // Polygons whose outline crosses itself: the line of the first, and how many.
        let mut crossing: Option<(usize, usize)> = None;
        let mut positions = Vec::new();
        let mut rest = self.corners.as_slice();
        for face in &self.faces {
            let (corners, after) = rest.split_at(face.count);
            rest = after;
            positions.clear();
            if face.count > 3 {
                let of = |c: &[u32; 2]| self.positions[c[0] as usize - 1];
                positions.extend(corners.iter().map(of));
            }
            let cut = match face.count {
                3 => None,
                _ => Some(triangulate(&positions)),
            };
            if cut.as_ref().is_some_and(|cut| cut.self_crossing) {
                crossing.get_or_insert((face.line, 0)).1 += 1;
            }
            for t in cut.as_ref().map_or(&[[0, 1, 2]][..], |cut| &cut.indices) {
                text.push('f');
                for i in t {
                    let [v, n] = corners[*i as usize];
                    // The zero normal in front stands for that of the face, and shifts the others.
                    text.push_str(&format!(" {v}//{}", u64::from(n) + 1));
                }
                text.push('\n');
                triangles.push((face.part, face.smooth));
            }
        }
        if let Some((line, count)) = crossing {
            let text = format!(
                "f: the outline of {count} polygons, this one first, crosses itself: their \
                 triangles may overlap or leave gaps"
            );
            log.warn(Some(line), text);
        }
        (text, triangles)
    }
}

/// What `s` says; `None` if that is nothing.
fn smoothing(rest: &str) -> Option<Smooth> {
    let mut words = rest.split_whitespace();
    let (word, None) = (words.next()?, words.next()) else { return None };
    if word.eq_ignore_ascii_case("off") {
        return Some(Smooth::Flat);
    }
    if word.eq_ignore_ascii_case("on") {
        return Some(Smooth::Group(1));
    }
    word.parse().ok().map(|group| if group == 0 { Smooth::Flat } else { Smooth::Group(group) })
}

/// Writing into a string cannot fail, but says that it might.
fn written(result: std::fmt::Result) -> Result<(), String> {
    result.map_err(|e| e.to_string())
}

/// The first three numbers of a statement, as the text that stands for them.
fn three<'a>(rest: &'a str, usage: &str) -> Result<[&'a str; 3], String> {
    let mut found = [""; 3];
    let mut tokens = rest.split_whitespace();
    for slot in &mut found {
        *slot = tokens.next().ok_or_else(|| format!("expected three numbers, `{usage}`"))?;
        if slot.parse::<f64>().is_err() {
            return Err(format!("expected three numbers, `{usage}`, not `{}`", shown(slot)));
        }
    }
    Ok(found)
}

/// An index counted from 1; a negative one counts back from the last of `count` so far.
fn index(token: &str, count: i64, what: &str) -> Result<i64, String> {
    let wanted = || format!("f: expected a {what} index, not `{}`", shown(token));
    match token.parse::<i64>().map_err(|_| wanted())? {
        0 => Err(format!("f: a {what} index counts from 1, not 0")),
        i if i > 0 => Ok(i),
        i if count.saturating_add(i) >= 0 => Ok(count + i + 1),
        i => Err(format!("f: the {what} index {i} points before the first of {count}")),
    }
}

fn run_tobj(pieces: &[&str]) -> Result<Mesh, tobj::LoadError> {
    let options =
        tobj::LoadOptions { triangulate: true, single_index: true, ..tobj::LoadOptions::default() };
    let text = pieces.concat();
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials)?;
    let points = |numbers: &[f64]| numbers.chunks_exact(3).map(DVec3::from_slice).collect();
    let mut mesh = Mesh::default();
    // Without `o`, `g` and `usemtl` there is exactly one.
    if let Some(model) = models.into_iter().next() {
        mesh.positions = points(&model.mesh.positions);
        mesh.normals = points(&model.mesh.normals);
        mesh.triangles = model.mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

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
