//! The header of a PLY file, and whether it can be true.
//!
//! It is read here rather than by `ply-rs-bw`, which takes neither blank lines nor other line ends
//! than LF and CR LF, nor capitals, nor whole numbers of 64 bits, nor names with other characters
//! than those of a variable.

use super::line_ends::Lines;
use crate::scene::read::ReadError;
use crate::scene::read::log::Log;
use crate::scene::read::text::shown;
use ply_rs_bw::ply::Encoding;

/// Both names of a face's corners are in use.
pub(super) const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
pub(super) const POSITION: [&str; 3] = ["x", "y", "z"];
pub(super) const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// Names of the element whose lists are strips of triangles.
const STRIPS: [&str; 4] = ["tristrips", "tristrip", "tri_strips", "triangle_strips"];

/// What a header says.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<ElementHeader>,
    /// How many lines it has.
    pub(super) lines: usize,
}

/// Elements of one kind.
#[derive(Clone)]
pub(super) struct ElementHeader {
    /// In lower case.
    pub(super) name: String,
    pub(super) role: PlyRole,
    pub(super) count: usize,
    /// Where the header declares it.
    line: usize,
    pub(super) properties: Vec<Declared>,
}

/// What the elements of a kind are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyRole {
    PlyVertex,
    PlyFace,
    Strip,
    /// Read only to get behind it.
    Unused,
}

/// One property of an element.
#[derive(Clone)]
pub(super) struct Declared {
    /// As the file has it.
    pub(super) name: String,
    pub(super) kind: PlyKind,
    /// What it is known by here; `None` if it is not used.
    pub(super) used: Option<&'static str>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyKind {
    Scalar(Number),
    /// The length's type and the items'.
    List(Number, Number),
}

/// The types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Long,
    ULong,
    Float,
    Double,
}

impl Number {
    fn of(word: &str) -> Option<Number> {
        let word = word.to_ascii_lowercase();
        Some(match word.strip_suffix("_t").unwrap_or(&word) {
            "char" | "int8" => Number::Char,
            "uchar" | "uint8" => Number::UChar,
            "short" | "int16" => Number::Short,
            "ushort" | "uint16" => Number::UShort,
            "int" | "int32" => Number::Int,
            "uint" | "uint32" => Number::UInt,
            "int64" => Number::Long,
            "uint64" => Number::ULong,
            "float" | "float32" => Number::Float,
            "double" | "float64" => Number::Double,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Number::Char | Number::UChar => 1,
            Number::Short | Number::UShort => 2,
            Number::Int | Number::UInt | Number::Float => 4,
            Number::Long | Number::ULong | Number::Double => 8,
        }
    }

    /// Whether a number can be of this type.
    pub(super) fn holds(self, x: f64) -> bool {
        let (low, high) = match self {
            Number::Float | Number::Double => return true,
            Number::Char => (-128.0, 127.0),
            Number::UChar => (0.0, 255.0),
            Number::Short => (-32768.0, 32767.0),
            Number::UShort => (0.0, 65535.0),
            Number::Int => (-2147483648.0, 2147483647.0),
            Number::UInt => (0.0, 4294967295.0),
            Number::Long => (i64::MIN as f64, i64::MAX as f64),
            Number::ULong => (0.0, u64::MAX as f64),
        };
        (low..=high).contains(&x) && x.fract() == 0.0
    }
}

/// The header and the bytes behind it.
pub(super) fn read<'a>(bytes: &'a [u8], log: &Log) -> Result<(Header, &'a [u8]), ReadError> {
    let mut lines = Lines::new(bytes);
    let first = lines.next().unwrap_or_default();
    if !first.trim_ascii().eq_ignore_ascii_case(b"ply") {
        return Err(log.error(Some(1), "expected `ply` on the first line of a PLY file"));
    }
    let (mut encoding, mut elements) = (None, Vec::<ElementHeader>::new());
    while let Some(line) = lines.next() {
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some(word) = words.first() else { continue };
        let declared = match word.to_ascii_lowercase().as_str() {
            "comment" | "obj_info" => Some(()),
            "format" => format_of(&words).map(|format| encoding = Some(format)),
            "element" => element(&words, lines.number).map(|element| elements.push(element)),
            "property" => property(&words).and_then(|property| {
                let element = elements.last_mut()?;
                element.properties.push(property);
                Some(())
            }),
            "end_header" if words.len() == 1 => {
                let Some(encoding) = encoding else {
                    let text = "expected a line `format ascii 1.0`, `format \
                                binary_little_endian 1.0` or `format binary_big_endian 1.0` in \
                                the PLY header";
                    return Err(log.error(None, text));
                };
                let header = Header { encoding, elements, lines: lines.number };
                return Ok((header, lines.behind(encoding != Encoding::Ascii)));
            }
            _ => None,
        };
        if declared.is_none() {
            let number = lines.number;
            if !std::iter::from_fn(|| lines.next()).any(is_end) {
                break;
            }
            let text = format!(
                "expected a PLY header line such as `element vertex 8` or `property float x`, not \
                 `{}`",
                shown(line.trim_end())
            );
            return Err(log.error(Some(number), text));
        }
    }
    Err(log.error(None, "expected a line `end_header` at the end of the PLY header"))
}

fn is_end(line: &[u8]) -> bool {
    line.trim_ascii().eq_ignore_ascii_case(b"end_header")
}

fn format_of(words: &[&str]) -> Option<Encoding> {
    let version = |word: &&str| word.parse::<f32>().is_ok();
    if words.len() > 3 || !words.iter().skip(2).all(version) {
        return None;
    }
    match words.get(1)?.to_ascii_lowercase().as_str() {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::BinaryLittleEndian),
        "binary_big_endian" => Some(Encoding::BinaryBigEndian),
        _ => None,
    }
}

fn element(words: &[&str], line: usize) -> Option<ElementHeader> {
    let &[_, name, count] = words else { return None };
    let (name, count) = (name.to_ascii_lowercase(), count.parse().ok()?);
    let role = match name.as_str() {
        "vertex" => PlyRole::PlyVertex,
        "face" => PlyRole::PlyFace,
        name if STRIPS.contains(&name) => PlyRole::Strip,
        _ => PlyRole::Unused,
    };
    Some(ElementHeader { name, role, count, line, properties: Vec::new() })
}

fn property(words: &[&str]) -> Option<Declared> {
    let (kind, name) = match *words {
        [_, list, length, item, name] if list.eq_ignore_ascii_case("list") => {
            (PlyKind::List(Number::of(length)?, Number::of(item)?), name)
        }
        [_, kind, name] => (PlyKind::Scalar(Number::of(kind)?), name),
        _ => return None,
    };
    Some(Declared { name: name.to_owned(), kind, used: None })
}

impl ElementHeader {
    /// Marks the properties that are known by these names, one each: as they stand here, else in
    /// other letter case. `None` where one is not there, or not of the form wanted.
    fn using(&mut self, names: &[&'static str], form: fn(PlyKind) -> bool) -> Option<()> {
        let find = |name: &str| {
            let exact = self.properties.iter().position(|p| p.name == name);
            exact.or_else(|| self.properties.iter().position(|p| p.name.eq_ignore_ascii_case(name)))
        };
        let places: Vec<usize> = names.iter().map(|name| find(name)).collect::<Option<_>>()?;
        if !places.iter().all(|&at| self.properties.get(at).is_some_and(|p| form(p.kind))) {
            return None;
        }
        for (&at, &name) in places.iter().zip(names) {
            if let Some(property) = self.properties.get_mut(at) {
                property.used = Some(name);
            }
        }
        Some(())
    }

    /// Whether two properties have this name.
    fn declares_twice(&self, name: &str) -> bool {
        self.properties.iter().filter(|p| p.name == name).count() > 1
    }

    /// Bytes that one takes at least; of lists, those of their lengths.
    fn least_size(&self, encoding: Encoding) -> usize {
        match encoding {
            // A digit and a separator each; the last one may end with the file.
            Encoding::Ascii => 2 * self.properties.len(),
            _ => {
                let size = |p: &Declared| match p.kind {
                    PlyKind::Scalar(kind) | PlyKind::List(kind, _) => kind.size(),
                };
                self.properties.iter().map(size).sum()
            }
        }
    }

    /// Whether this is something to be seen that is not shown.
    fn is_geometry(&self) -> bool {
        const PARTS: [&str; 12] = [
            "edge", "line", "strip", "fan", "poly", "patch", "curve", "grid", "tri", "quad", "tet",
            "cell",
        ];
        let named = PARTS.iter().any(|part| self.name.contains(part));
        // Corners are called vertex_indices, vertex1, v1 and the like; texture's are not.
        let has_corners = self.properties.iter().any(|p| {
            let name = p.name.to_ascii_lowercase();
            name.starts_with("vertex") && !name.starts_with("vertex_color")
        });
        let texture = self.name.starts_with("multi_texture");
        self.role == PlyRole::Unused && self.count > 0 && !texture && (named || has_corners)
    }
}

/// Checks that there is what a mesh needs, marks it, and checks that the bytes behind the header
/// can hold it.
pub(super) fn check(header: &mut Header, available: usize, log: &mut Log) -> Result<(), ReadError> {
    check_layout(header, log)?;
    header.elements.iter().try_for_each(|e| check_count(e, header.encoding, available, log))
}

/// Vertices must have x y z and faces a list of indices.
fn check_layout(header: &mut Header, log: &Log) -> Result<(), ReadError> {
    let is_single = |kind| matches!(kind, PlyKind::Scalar(_));
    let is_list = |kind| matches!(kind, PlyKind::List(..));
    let has = |role: PlyRole| header.elements.iter().filter(|e| e.role == role).count();
    if has(PlyRole::PlyVertex) == 0 {
        return Err(log.error(None, "the PLY header declares no element `vertex`"));
    }
    if has(PlyRole::PlyFace) + has(PlyRole::Strip) == 0 {
        let text = "the PLY header declares no element `face`, and no `tristrips`";
        return Err(log.error(None, text));
    }
    let twice = |names: &[&str], e: &ElementHeader| names.iter().any(|name| e.declares_twice(name));
    let ambiguous = [PlyRole::PlyVertex, PlyRole::PlyFace].iter().any(|&role| has(role) > 1)
        || header.elements.iter().any(|e| match e.role {
            PlyRole::PlyVertex => twice(&POSITION, e) || twice(&NORMAL, e),
            PlyRole::PlyFace | PlyRole::Strip => twice(&CORNERS, e),
            PlyRole::Unused => false,
        });
    if ambiguous {
        let text = "the PLY header declares two elements, or two properties of one element, of \
                    the same name";
        return Err(log.error(None, text));
    }
    for element in &mut header.elements {
        match element.role {
            PlyRole::Unused => {}
            PlyRole::PlyVertex => {
                element.using(&POSITION, is_single).ok_or_else(|| {
                    let text = "the PLY header must declare the vertex properties x, y and z as \
                                single numbers";
                    log.error(None, text)
                })?;
                let _ = element.using(&NORMAL, is_single);
            }
            PlyRole::PlyFace | PlyRole::Strip => {
                let [first, second] = CORNERS.map(|name| [name]);
                let (a, b) = (element.using(&first, is_list), element.using(&second, is_list));
                if a.is_some() && b.is_some() {
                    let text = "the PLY header must declare one of vertex_indices and \
                                vertex_index, not both";
                    return Err(log.error(None, text));
                }
                a.or(b).ok_or_else(|| {
                    let text = format!(
                        "the PLY header must declare `property list uchar int vertex_indices`, \
                         or another list of that name, for the element `{}`",
                        shown(&element.name)
                    );
                    log.error(None, text)
                })?;
            }
        }
    }
    Ok(())
}

/// Refuses a count that the bytes cannot hold, so that nothing is allocated on the header's word.
fn check_count(
    element: &ElementHeader,
    encoding: Encoding,
    available: usize,
    log: &Log,
) -> Result<(), ReadError> {
    let smallest = element.least_size(encoding);
    if element.count.saturating_mul(smallest) > available + 1 {
        return Err(log.error(
            None,
            format!(
                "the PLY header announces {} elements `{}` of at least {smallest} bytes, but only \
                 {available} bytes follow: the file is cut short or its header wrong",
                element.count,
                shown(&element.name)
            ),
        ));
    }
    Ok(())
}

/// Tells which elements and properties play no part: in a note, or in a warning where there would
/// be something to see.
pub(super) fn mention_unused(header: &Header, log: &mut Log) {
    let mut unused = Vec::new();
    for element in &header.elements {
        let others = element.properties.iter().filter(|p| p.used.is_none()).map(|p| &p.name);
        match element.role {
            PlyRole::PlyVertex => unused.extend(others.cloned()),
            PlyRole::PlyFace | PlyRole::Strip => {
                unused.extend(others.map(|name| format!("{} {name}", element.name)));
            }
            PlyRole::Unused if element.is_geometry() => {
                let text = format!(
                    "{} elements `{}` are left out: of geometry only faces and tristrips are shown",
                    element.count,
                    shown(&element.name)
                );
                log.warn(Some(element.line), text);
            }
            PlyRole::Unused => unused.push(format!("element {}", element.name)),
        }
    }
    if !unused.is_empty() {
        log.note_on_file(format!("not used: {}", shown(&unused.join(", "))));
    }
}
