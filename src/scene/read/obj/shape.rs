//! The geometry of an OBJ file, checked line by line.

use super::lines::{Name, STRAY, Statement};
use super::{ObjModel, ObjPart};
use crate::scene::read::ReadError;
use crate::scene::read::log::{Doubts, Log};
use crate::scene::read::polygon::triangulate;
use crate::scene::read::text::{number, shown};
use crate::scene::{Mesh, Smooth};
use glam::DVec3;
use std::collections::HashMap;
use std::fmt::Write;

/// The statements that passed, as text for `tobj`, and what it cannot tell afterwards.
#[derive(Default)]
pub(super) struct Shape {
    vertices: String,
    normals: String,
    positions: Vec<DVec3>,
    normal_count: u32,
    /// Vertex and normal of the corners of all faces; normal 0 is none.
    corners: Vec<[u32; 2]>,
    faces: Vec<ObjFace>,
    /// The largest vertex index and its line: it may be defined later.
    largest: (i64, usize),
    object: String,
    material: Option<(Name, usize)>,
    smooth: Smooth,
    /// The part that faces now belong to, once one is there.
    part: Option<usize>,
    /// Part by names of object and material.
    part_numbers: HashMap<(String, Option<Name>), usize>,
    materials: Vec<Option<(Name, usize)>>,
    libraries: Vec<(usize, Name)>,
    doubts: Doubts,
}

/// A face: how many of the corners are its own, where it stands, and what it belongs to.
struct ObjFace {
    count: usize,
    line: usize,
    part: usize,
    smooth: Smooth,
}

/// A normal that is named but cannot be there.
const NO_NORMAL: u32 = u32::MAX;

impl Shape {
    pub(super) fn statement(&mut self, statement: &Statement) -> Result<(), String> {
        let (line, (word, rest)) = (statement.line, statement.parts());
        if statement.stray {
            self.doubts.add("stray", line, || STRAY.to_owned());
        }
        match &*statement.word() {
            "v" => self.vertex(line, rest),
            "vn" => {
                self.normal_count += 1;
                let [x, y, z] = three(rest, "vn x y z").unwrap_or_else(|text| {
                    self.doubts.add("vn", line, || format!("{text}: the face's own is used"));
                    ["0"; 3]
                });
                written(writeln!(self.normals, "vn {x} {y} {z}"))
            }
            "f" | "fo" => self.face(line, rest),
            "s" => {
                self.smooth = smoothing(rest).unwrap_or_else(|| {
                    self.doubts.add("s", line, || {
                        "s: expected `off` or the number of a smoothing group: taken as if \
                         nothing were said"
                            .to_owned()
                    });
                    Smooth::Unsaid
                });
                Ok(())
            }
            "o" | "g" => {
                self.object = Name::of(rest).text;
                self.part = None;
                Ok(())
            }
            "usemtl" => {
                let name = Name::of(rest);
                if name.text.is_empty() {
                    self.doubts.add("usemtl", line, || {
                        "usemtl: no name is given: the faces that follow have no material".into()
                    });
                }
                self.material = (!name.text.is_empty()).then_some((name, line));
                self.part = None;
                Ok(())
            }
            "mtllib" => {
                let name = Name::of(rest);
                if name.text.is_empty() {
                    self.doubts.add("mtllib", line, || "mtllib: no name is given".into());
                } else {
                    self.libraries.push((line, name));
                }
                Ok(())
            }
            // Without textures their coordinates do not matter.
            "" | "vt" => Ok(()),
            _ => {
                self.doubts.unsupported(&format!("`{}`", shown(word)), line);
                Ok(())
            }
        }
    }

    /// `v x y z`, with a weight or a colour.
    fn vertex(&mut self, line: usize, rest: &str) -> Result<(), String> {
        let texts = three(rest, "v x y z")?;
        let [x, y, z] = texts;
        let mut position = DVec3::from_array(texts.map(|t| t.parse().unwrap_or(f64::NAN)));
        let mut more = rest.split_whitespace().skip(3);
        let mut weight = "";
        match (more.next(), more.next()) {
            (None, _) => {}
            (Some(w), None) => match w.parse::<f64>() {
                Ok(number) if number != 0.0 && number.is_finite() => {
                    position /= number;
                    weight = w;
                }
                _ => self.doubts.add("weight", line, || {
                    let w = shown(w);
                    format!("v: expected a weight other than 0, not `{w}`: none is used")
                }),
            },
            _ => self.doubts.unsupported("a colour of a vertex", line),
        }
        self.positions.push(position);
        written(writeln!(self.vertices, "v {x} {y} {z} {weight}"))
    }

    fn face(&mut self, line: usize, rest: &str) -> Result<(), String> {
        let count = rest.split_whitespace().count();
        if count < 3 {
            self.doubts.add_one("few corners", line, "faces", || {
                "f: a face of fewer than three corners is left out".to_owned()
            });
            return Ok(());
        }
        for token in rest.split_whitespace() {
            let mut fields = token.split('/');
            let vertex = fields.next().unwrap_or_default();
            let (_texture, normal) = (fields.next(), fields.next().unwrap_or_default());
            if fields.next().is_some_and(|more| !more.is_empty()) {
                self.doubts.add_one("fields", line, "corners", || {
                    let token = shown(token);
                    format!(
                        "f: expected a corner v, v/vt, v//vn or v/vt/vn: the rest of `{token}` is \
                         not used"
                    )
                });
            }
            let v = vertex_index(vertex, self.positions.len() as i64)?;
            if v > self.largest.0 {
                self.largest = (v, line);
            }
            let n = if normal.is_empty() { 0 } else { normal_index(normal, self.normal_count) };
            // A larger index is an error in the end.
            self.corners.push([u32::try_from(v).unwrap_or(u32::MAX), n]);
        }
        let part = self.part();
        self.faces.push(ObjFace { count, line, part, smooth: self.smooth });
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

    /// True when there is nothing to show.
    pub(super) fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    pub(super) fn finish(mut self, log: &mut Log) -> Result<ObjModel, ReadError> {
        let (largest, line) = self.largest;
        let count = self.positions.len() as i64;
        if largest > count {
            let text = format!("f: expected a vertex index from 1 to {count}, not {largest}");
            return Err(log.error(Some(line), text));
        }
        if self.is_empty() {
            return Err(log.error(None, "the file has no faces, so there is nothing to show"));
        }
        // Where a face names normals, even none that are there, it does not ask for smooth ones.
        let named = self.corners.iter().any(|corner| corner[1] != 0);
        self.mend_normals();
        let (faces, triangles) = self.triangles().map_err(|text| log.error(None, text))?;
        std::mem::take(&mut self.doubts).report(log);
        let mut mesh = run_tobj(&[&self.vertices, "vn 0 0 0\n", &self.normals, &faces])
            .map_err(|e| log.error(None, format!("the OBJ reader refuses this file: {e}")))?;
        if !named {
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
            parts.push(ObjPart { material, triangles: start..end });
            start = end;
        }
        Ok(ObjModel { mesh, parts, libraries: self.libraries })
    }

    /// Corners whose normal is not there have none.
    fn mend_normals(&mut self) {
        let mut rest = self.corners.as_mut_slice();
        for face in &self.faces {
            let (corners, after) = rest.split_at_mut(face.count);
            rest = after;
            for [_, normal] in corners.iter_mut().filter(|c| c[1] > self.normal_count) {
                *normal = 0;
                self.doubts.add_one("normal", face.line, "corners", || {
                    "f: a corner names a normal that is not there: the face's own is used".into()
                });
            }
        }
    }

    /// All faces as triangles, and the part and smoothing of each.
    fn triangles(&mut self) -> Result<(String, Vec<(usize, Smooth)>), String> {
        let (mut text, mut triangles) = (String::new(), Vec::new());
        let mut positions = Vec::new();
        let mut rest = self.corners.as_slice();
        for face in &self.faces {
            let (corners, after) = rest.split_at(face.count);
            rest = after;
            let cut = (face.count > 3).then(|| {
                positions.clear();
                let of = |c: &[u32; 2]| self.positions[c[0] as usize - 1];
                positions.extend(corners.iter().map(of));
                triangulate(&positions)
            });
            if cut.as_ref().is_some_and(|cut| cut.self_crossing) {
                self.doubts.add_one("crossing", face.line, "polygons", || {
                    "f: the outline of this polygon crosses itself: its triangles may overlap or \
                     leave gaps"
                        .to_owned()
                });
            }
            for t in cut.as_ref().map_or(&[[0, 1, 2]][..], |cut| &cut.indices) {
                text.push('f');
                for i in t {
                    let [v, n] = corners[*i as usize];
                    // The zero normal in front stands for that of the face, and shifts the others.
                    written(write!(text, " {v}//{}", u64::from(n) + 1))?;
                }
                text.push('\n');
                triangles.push((face.part, face.smooth));
            }
        }
        Ok((text, triangles))
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

/// The first three numbers of a statement, in a spelling that `tobj` knows.
fn three<'a>(rest: &'a str, usage: &str) -> Result<[&'a str; 3], String> {
    let mut found = [""; 3];
    let mut tokens = rest.split_whitespace();
    for slot in &mut found {
        let token = tokens.next().ok_or_else(|| format!("expected three numbers, `{usage}`"))?;
        *slot = match number(token) {
            None => {
                return Err(format!("expected three numbers, `{usage}`, not `{}`", shown(token)));
            }
            Some(x) if x.is_nan() => "nan",
            Some(f64::INFINITY) => "inf",
            Some(f64::NEG_INFINITY) => "-inf",
            Some(_) => token,
        };
    }
    Ok(found)
}

/// A vertex index counted from 1; a negative one counts back from the last of `count` so far.
fn vertex_index(token: &str, count: i64) -> Result<i64, String> {
    let wanted = || format!("f: expected a vertex index, not `{}`", shown(token));
    match token.parse::<i64>().map_err(|_| wanted())? {
        0 => Err("f: a vertex index counts from 1, not 0".to_owned()),
        i if i > 0 => Ok(i),
        i if count.saturating_add(i) >= 0 => Ok(count + i + 1),
        i => Err(format!("f: the vertex index {i} points before the first of {count}")),
    }
}

/// A normal index likewise; what cannot be one is the index of a normal that is not there.
fn normal_index(token: &str, count: u32) -> u32 {
    let count = i64::from(count);
    let from_one = match token.parse::<i64>() {
        Ok(i) if i > 0 => i,
        Ok(i) if i < 0 => count.saturating_add(i).saturating_add(1).max(0),
        _ => 0,
    };
    u32::try_from(from_one).ok().filter(|&i| i > 0).unwrap_or(NO_NORMAL)
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
