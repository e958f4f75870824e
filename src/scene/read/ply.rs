//! PLY: a header that declares elements, then their values in ASCII or binary.
//!
//! `ply-rs-bw` knows the syntax. It believes the header, though: an element of no properties with
//! a count of 2^64 would keep it busy for ever, two elements of one name shift all that follows.
//! So the header's claims are held against the bytes that are there before any element is read.

mod header;

use super::ReadError;
use super::log::Log;
use super::polygon::triangulate;
use super::text::{lines, shown};
use crate::scene::Mesh;
use glam::DVec3;
use header::{CORNERS, NORMAL, POSITION, has_all};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};
use std::io::ErrorKind;

/// Reads a mesh; polygons become triangles.
pub(super) fn read(bytes: &[u8], log: &mut Log) -> Result<Mesh, ReadError> {
    if bytes.is_empty() {
        return Err(log.error(None, "the file is empty"));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (head, payload) = header::split(bytes, log)?;
    let header = header::parse(&head, log)?;
    header::check(&header, payload.len(), log)?;
    let (vertices, faces) = match header.encoding {
        Encoding::Ascii => ascii_elements(payload, head.lines().count(), &header, log)?,
        _ => binary_elements(payload, &header, log)?,
    };
    header::mention_unused(&header, log);
    let has_normals = header.elements.get("vertex").is_some_and(|v| has_all(v, NORMAL));
    mesh(&vertices, &faces, has_normals, log)
}

fn mesh(
    vertices: &[Vertex],
    faces: &[Face],
    has_normals: bool,
    log: &mut Log,
) -> Result<Mesh, ReadError> {
    let mut mesh = Mesh {
        positions: vertices.iter().map(|v| DVec3::from_array(v.position)).collect(),
        ..Mesh::default()
    };
    if has_normals {
        mesh.normals = vertices.iter().map(|v| DVec3::from_array(v.normal)).collect();
    }
    let mut too_small = 0;
    // Faces whose outline crosses itself: the number of the first, and how many.
    let mut crossing: Option<(usize, usize)> = None;
    let mut corners = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        match face.corners.as_slice() {
            &[a, b, c] => mesh.triangles.push([a, b, c]),
            [] | [_] | [_, _] => too_small += 1,
            indices => {
                corners.clear();
                // An index that names no vertex is found once the mesh is placed.
                let of = |&i: &u32| mesh.positions.get(i as usize).copied().unwrap_or(DVec3::NAN);
                corners.extend(indices.iter().map(of));
                let cut = triangulate(&corners);
                mesh.triangles.extend(cut.indices.iter().map(|t| t.map(|i| indices[i as usize])));
                if cut.self_crossing {
                    crossing.get_or_insert((number + 1, 0)).1 += 1;
                }
            }
        }
    }
    if too_small > 0 {
        log.warn(None, format!("{too_small} faces of fewer than three corners are left out"));
    }
    if let Some((first, count)) = crossing {
        let text = format!(
            "the outline of {count} polygons, of face {first} first, crosses itself: their \
             triangles may overlap or leave gaps"
        );
        log.warn(None, text);
    }
    if mesh.triangles.is_empty() {
        return Err(log.error(None, "the file has no faces, so there is nothing to show"));
    }
    Ok(mesh)
}

type Elements = (Vec<Vertex>, Vec<Face>);

/// A line an element. Blank lines are harmless, here as in the other formats.
fn ascii_elements(
    payload: &[u8],
    header_lines: usize,
    header: &Header,
    log: &mut Log,
) -> Result<Elements, ReadError> {
    let text = String::from_utf8_lossy(payload);
    let mut lines = lines(&text)
        .map(|(number, line)| (number + header_lines, line))
        .filter(|(_, line)| !line.trim().is_empty());
    let mut elements = Elements::default();
    // Elements without properties have no lines that could be told from blank ones.
    for def in header.elements.values().filter(|def| !def.properties.is_empty()) {
        match def.name.as_str() {
            "vertex" => elements.0 = ascii(&mut lines, def, log)?,
            "face" => elements.1 = ascii(&mut lines, def, log)?,
            _ => drop(ascii::<Unused>(&mut lines, def, log)?),
        }
    }
    if let Some((line, _)) = lines.next() {
        log.warn(Some(line), "this line and those after it belong to no element and are not used");
    }
    Ok(elements)
}

fn ascii<'a, E: Element>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    def: &ElementDef,
    log: &mut Log,
) -> Result<Vec<E>, ReadError> {
    let parser = Parser::<E>::new();
    let mut elements = Vec::with_capacity(def.count);
    // Lines with more values than the parser takes: the first and how many.
    let mut longer: Option<(usize, usize)> = None;
    for done in 0..def.count {
        let Some((number, line)) = lines.next() else {
            return Err(cut_short(def, Some(done), log));
        };
        let element = parser
            .read_ascii_element(line, def)
            .or_else(|_| parser.read_ascii_element(&plain_numbers(line), def))
            .map_err(|_| {
                let wanted: Vec<&str> = def.properties.keys().map(String::as_str).collect();
                let wanted = shown(&wanted.join(" "));
                let text = format!(
                    "expected the values of `{wanted}` of an element `{}`, not `{}`",
                    shown(&def.name),
                    shown(line)
                );
                log.error(Some(number), text)
            })?;
        match element.problem() {
            Some(text) => return Err(log.error(Some(number), text)),
            None => elements.push(element),
        }
        if line.split_whitespace().count() > value_count(line, def) {
            longer.get_or_insert((number, 0)).1 += 1;
        }
    }
    if let Some((first, count)) = longer {
        let text = format!(
            "{count} lines of the element `{}`, this one first, have more values than it has \
             properties; the last ones are not used",
            shown(&def.name)
        );
        log.warn(Some(first), text);
    }
    Ok(elements)
}

/// How many values the properties of an element take from its line, lengths of lists included.
fn value_count(line: &str, def: &ElementDef) -> usize {
    let mut tokens = line.split_whitespace();
    let mut count: usize = 0;
    for property in def.properties.values() {
        let token = tokens.next();
        count = count.saturating_add(1);
        if let PropertyType::List(..) = property.data_type {
            let length = token.and_then(|t| t.parse().ok()).unwrap_or(0);
            count = count.saturating_add(length);
            tokens.by_ref().take(length).for_each(drop);
        }
    }
    count
}

/// Rewrites what other programs print as numbers and the parser does not take: `.5`, `5.`, `nan`.
fn plain_numbers(line: &str) -> String {
    let plain = |token: &str| match token.parse::<f64>() {
        Ok(x) if x.is_finite() && token.contains('.') => x.to_string(),
        // Not finite when it is parsed again, and found as such once the mesh is placed.
        Ok(x) if !x.is_finite() => "1e999".to_owned(),
        _ => token.to_owned(),
    };
    line.split_whitespace().map(plain).collect::<Vec<_>>().join(" ")
}

fn binary_elements(payload: &[u8], header: &Header, log: &mut Log) -> Result<Elements, ReadError> {
    let mut reader = Reader::new(payload);
    let mut elements = Elements::default();
    // Elements without properties take no bytes.
    for def in header.elements.values().filter(|def| !def.properties.is_empty()) {
        match def.name.as_str() {
            "vertex" => elements.0 = binary(&mut reader, def, header, log)?,
            "face" => elements.1 = binary(&mut reader, def, header, log)?,
            _ => drop(binary::<Unused>(&mut reader, def, header, log)?),
        }
    }
    let left = reader.into_inner().len();
    if left > 0 {
        log.warn(None, format!("{left} bytes after the last element are not used"));
    }
    Ok(elements)
}

fn binary<E: Element>(
    reader: &mut Reader<&[u8]>,
    def: &ElementDef,
    header: &Header,
    log: &Log,
) -> Result<Vec<E>, ReadError> {
    let elements: Vec<E> =
        Parser::new().read_payload_for_element(reader, def, header).map_err(|e| {
            match e.kind() {
                ErrorKind::UnexpectedEof => cut_short(def, None, log),
                _ => log.error(None, format!("the elements `{}` are damaged", shown(&def.name))),
            }
        })?;
    for (i, element) in elements.iter().enumerate() {
        if let Some(text) = element.problem() {
            return Err(log.error(None, format!("{} number {}: {text}", def.name, i + 1)));
        }
    }
    Ok(elements)
}

fn cut_short(def: &ElementDef, done: Option<usize>, log: &Log) -> ReadError {
    let name = shown(&def.name);
    let after = done.map_or(String::new(), |n| format!(" after {n}"));
    let text = format!("expected {} elements `{name}`; the file ends{after} among them", def.count);
    log.error(None, text)
}

/// An element of the payload, one of these three.
trait Element: PropertyAccess {
    /// What is wrong with its values.
    fn problem(&self) -> Option<String> {
        None
    }
}

#[derive(Default)]
struct Vertex {
    position: [f64; 3],
    normal: [f64; 3],
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let index = |names: [&str; 3]| names.iter().position(|n| *n == name);
        let slot = match (index(POSITION), index(NORMAL)) {
            (Some(i), _) => self.position.get_mut(i),
            (_, Some(i)) => self.normal.get_mut(i),
            _ => None,
        };
        if let (Some(slot), Some(number)) = (slot, number(&value)) {
            *slot = number;
        }
        PropertyAccessResult::Set
    }
}

impl Element for Vertex {}

fn number(value: &Property) -> Option<f64> {
    match *value {
        Property::Char(x) => Some(f64::from(x)),
        Property::UChar(x) => Some(f64::from(x)),
        Property::Short(x) => Some(f64::from(x)),
        Property::UShort(x) => Some(f64::from(x)),
        Property::Int(x) => Some(f64::from(x)),
        Property::UInt(x) => Some(f64::from(x)),
        Property::Float(x) => Some(f64::from(x)),
        Property::Double(x) => Some(x),
        _ => None,
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    negative: bool,
}

impl PropertyAccess for Face {
    fn new() -> Face {
        Face::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if CORNERS.contains(&name) {
            match value.to_u32_list() {
                Some(list) => self.corners = list,
                None => self.negative = true,
            }
        }
        PropertyAccessResult::Set
    }
}

impl Element for Face {
    fn problem(&self) -> Option<String> {
        let text = "the vertex indices of a face must not be negative";
        self.negative.then(|| text.to_owned())
    }
}

/// An element that is read only to get behind it.
struct Unused;

impl PropertyAccess for Unused {
    fn new() -> Unused {
        Unused
    }
}

impl Element for Unused {}
