//! The header of a PLY file, and whether it can be true.

use super::Unused;
use crate::scene::read::ReadError;
use crate::scene::read::log::Log;
use crate::scene::read::text::shown;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

/// Both names of a face's corners are in use.
pub(super) const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
pub(super) const POSITION: [&str; 3] = ["x", "y", "z"];
pub(super) const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

/// The header as text, and the bytes behind it.
pub(super) fn split<'a>(bytes: &'a [u8], log: &Log) -> Result<(String, &'a [u8]), ReadError> {
    let first = bytes.split(|&b| b == b'\n').next().unwrap_or_default();
    if first.trim_ascii() != b"ply" {
        return Err(log.error(Some(1), "expected `ply` on the first line of a PLY file"));
    }
    let mut end = 0;
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        end += line.len();
        if line.trim_ascii_end() == b"end_header" {
            let (head, payload) = bytes.split_at(end);
            return Ok((String::from_utf8_lossy(head).into_owned(), payload));
        }
    }
    Err(log.error(None, "expected a line `end_header` at the end of the PLY header"))
}

pub(super) fn parse(head: &str, log: &Log) -> Result<Header, ReadError> {
    let header =
        Parser::<Unused>::new().read_header(&mut Reader::new(head.as_bytes())).map_err(|e| {
            let text = match e.line().and_then(|n| head.lines().nth(n.saturating_sub(1))) {
                Some(line) => format!(
                    "expected a PLY header line such as `element vertex 8` or \
                     `property float x`, not `{}`",
                    shown(line)
                ),
                None => "expected a line `format ascii 1.0`, `format binary_little_endian 1.0` \
                         or `format binary_big_endian 1.0` in the PLY header"
                    .to_owned(),
            };
            log.error(e.line(), text)
        })?;
    // The parser keeps the last of two with one name, in the place of the first.
    let declared = |word: &str| {
        head.lines().filter(|line| line.split_whitespace().next() == Some(word)).count()
    };
    let properties: usize = header.elements.values().map(|def| def.properties.len()).sum();
    if declared("element") != header.elements.len() || declared("property") != properties {
        let text = "the PLY header declares two elements, or two properties of one element, of \
                    the same name";
        return Err(log.error(None, text));
    }
    Ok(header)
}

/// Checks that there is what a mesh needs, and that the bytes behind the header can hold it.
pub(super) fn check(header: &Header, available: usize, log: &Log) -> Result<(), ReadError> {
    check_layout(header, log)?;
    header.elements.values().try_for_each(|def| check_count(def, header.encoding, available, log))
}

/// Vertices must have x y z and faces a list of indices.
fn check_layout(header: &Header, log: &Log) -> Result<(), ReadError> {
    let element = |name: &str| {
        let missing = || log.error(None, format!("the PLY header declares no element `{name}`"));
        header.elements.get(name).ok_or_else(missing)
    };
    if !has_all(element("vertex")?, POSITION) {
        let text = "the PLY header must declare the vertex properties x, y and z as single numbers";
        return Err(log.error(None, text));
    }
    let face = element("face")?;
    if CORNERS.iter().all(|name| face.properties.contains_key(*name)) {
        let text = "the PLY header must declare one of vertex_indices and vertex_index, not both";
        return Err(log.error(None, text));
    }
    let integers = |kind: &ScalarType| !matches!(kind, ScalarType::Float | ScalarType::Double);
    match corners_name(face).and_then(|name| face.properties.get(name)).map(|p| &p.data_type) {
        Some(PropertyType::List(length, index)) if integers(length) && integers(index) => Ok(()),
        _ => {
            let text = "the PLY header must declare `property list uchar int vertex_indices`, or \
                        another list of whole numbers of that name, for the element `face`";
            Err(log.error(None, text))
        }
    }
}

/// Which of the two names the corners have here.
fn corners_name(face: &ElementDef) -> Option<&'static str> {
    CORNERS.into_iter().find(|name| face.properties.contains_key(*name))
}

pub(super) fn has_all(def: &ElementDef, names: [&str; 3]) -> bool {
    names.iter().all(|&name| {
        def.properties.get(name).is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)))
    })
}

/// Refuses a count that the bytes cannot hold, so that nothing is allocated on the header's word.
fn check_count(
    def: &ElementDef,
    encoding: Encoding,
    available: usize,
    log: &Log,
) -> Result<(), ReadError> {
    let smallest: usize = match encoding {
        // A digit and a separator each; the last one may end with the file.
        Encoding::Ascii => 2 * def.properties.len(),
        _ => def.properties.values().map(|p| least_size(&p.data_type)).sum(),
    };
    if def.count.saturating_mul(smallest) > available + 1 {
        return Err(log.error(
            None,
            format!(
                "the PLY header announces {} elements `{}` of at least {smallest} bytes, but only \
                 {available} bytes follow: the file is cut short or its header wrong",
                def.count,
                shown(&def.name)
            ),
        ));
    }
    Ok(())
}

/// Bytes of a property's value in a binary file; of a list, those of its length.
fn least_size(kind: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = kind;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Tells which elements and properties play no part.
pub(super) fn mention_unused(header: &Header, log: &mut Log) {
    let mut unused = Vec::new();
    for def in header.elements.values() {
        match def.name.as_str() {
            "vertex" => {
                let known = |p: &&String| {
                    POSITION.contains(&p.as_str())
                        || (has_all(def, NORMAL) && NORMAL.contains(&p.as_str()))
                };
                unused.extend(def.properties.keys().filter(|p| !known(p)).cloned());
            }
            "face" => {
                let corners = corners_name(def);
                let others = def.properties.keys().filter(|p| Some(p.as_str()) != corners);
                unused.extend(others.map(|p| format!("face {p}")));
            }
            other => unused.push(format!("element {other}")),
        }
    }
    if !unused.is_empty() {
        log.note_on_file(format!("not used: {}", shown(&unused.join(", "))));
    }
}
