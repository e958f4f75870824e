//! The payload of an ASCII PLY file.
//!
//! A line an element, as programs write it and as messages can name it. Where that does not come
//! out, the values are taken in their order, wherever the lines end: but only if they are all used
//! up then, for a single one that is missing would shift all that follow.

use super::elements::{Element, Elements, PlyFace, Unused, definition, scalar};
use super::header::{Declared, ElementHeader as Declaration, Header, Number, PlyKind, PlyRole};
use crate::scene::read::ReadError;
use crate::scene::read::log::{Errors, Log};
use crate::scene::read::text::{lines, number, shown};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};

/// Reads all elements.
pub(super) fn read(payload: &[u8], header: &Header, log: &mut Log) -> Result<Elements, ReadError> {
    let text = String::from_utf8_lossy(payload);
    let lines = lines(&text)
        .map(|(number, line)| (number + header.lines, line))
        .filter(|(_, line)| !line.trim().is_empty());
    // Elements without properties have no lines that could be told from blank ones.
    let declared =
        || header.elements.iter().filter(|e| !e.properties.is_empty()).map(Declaring::new);
    let mut by_lines = ByLines::new(lines.clone(), header.lines);
    let mut elements = Elements::default();
    for kind in declared() {
        match kind.declared.role {
            PlyRole::PlyVertex => elements.vertices = by_lines.all(&kind, log),
            PlyRole::PlyFace => elements.faces = by_lines.all(&kind, log),
            PlyRole::Strip => elements.strips.extend(by_lines.all::<PlyFace>(&kind, log)),
            PlyRole::Unused => drop(by_lines.all::<Unused>(&kind, log)),
        }
    }
    if !by_lines.errors.is_empty() {
        let tokens = lines.flat_map(|(n, line)| line.split_whitespace().map(move |t| (n, t)));
        let mut in_order = InOrder { tokens, odd: Odd::default(), first: None, last: 0 };
        if let Some(elements) = in_order.read(declared()) {
            let text = "from here on elements do not begin and end with a line: the values are \
                        taken in their order";
            log.warn(in_order.first, text);
            in_order.odd.report(log);
            return Ok(elements);
        }
    }
    by_lines.finish(log)?;
    Ok(elements)
}

/// Elements of one kind, for us and for the parser.
struct Declaring<'a> {
    declared: &'a Declaration,
    def: ElementDef,
}

impl Declaring<'_> {
    fn new(declared: &Declaration) -> Declaring<'_> {
        // Whatever the header says of whole numbers that are used: a text is what it is.
        let kind = |property: &Declared, number| match (number, property.used) {
            (Number::Float | Number::Double, _) | (_, None) => scalar(number),
            _ => ScalarType::Double,
        };
        Declaring { declared, def: definition(declared, kind, scalar) }
    }
}

/// Values make no element: there are too few, or one of them is none.
struct Unfit;

/// A line an element.
struct ByLines<'a, I> {
    lines: I,
    last: usize,
    errors: Errors,
    /// The file ended before its elements.
    ended: bool,
    odd: Odd<'a>,
    /// Lines with more values than the parser takes: the kind, the first, and how many.
    longer: Vec<(&'a str, usize, usize)>,
}

impl<'a, 't, I: Iterator<Item = (usize, &'t str)>> ByLines<'a, I> {
    fn new(lines: I, last: usize) -> ByLines<'a, I> {
        let (errors, odd) = (Errors::default(), Odd::default());
        ByLines { lines, last, errors, ended: false, odd, longer: Vec::new() }
    }

    fn all<E: Element>(&mut self, kind: &Declaring<'a>, log: &Log) -> Vec<E> {
        let count = kind.declared.count;
        let mut elements = Vec::with_capacity(count);
        for done in 0..count {
            let Some((number, line)) = self.lines.next() else {
                if !self.ended {
                    let name = shown(&kind.declared.name);
                    let text = format!(
                        "expected {count} elements `{name}`; the file ends after {done} among them"
                    );
                    self.errors.add(log.error(Some(self.last), text));
                }
                self.ended = true;
                break;
            };
            self.last = number;
            match self.one::<E>(kind, number, line, log) {
                Ok(element) => elements.push(element),
                Err(error) => self.errors.add(error),
            }
        }
        elements
    }

    fn one<E: Element>(
        &mut self,
        kind: &Declaring<'a>,
        number: usize,
        line: &str,
        log: &Log,
    ) -> Result<E, ReadError> {
        let parser = Parser::<E>::new();
        let parse = |text: &str| parser.read_ascii_element(text, &kind.def).map_err(|_| Unfit);
        let mut tokens = line.split_whitespace().map(|token| (number, token));
        let read = parse(line).or_else(|_| {
            rewritten(&mut tokens, kind.declared, &mut self.odd).and_then(|t| parse(&t))
        });
        let element = read.map_err(|Unfit| {
            let names: Vec<&str> =
                kind.declared.properties.iter().map(|p| p.name.as_str()).collect();
            let text = format!(
                "expected the values of `{}` of an element `{}`, not `{}`",
                shown(&names.join(" ")),
                shown(&kind.declared.name),
                shown(line)
            );
            log.error(Some(number), text)
        })?;
        if let Some(text) = element.problem() {
            return Err(log.error(Some(number), text));
        }
        if line.split_whitespace().count() > value_count(line, &kind.def) {
            let name = kind.declared.name.as_str();
            match self.longer.iter_mut().find(|(known, ..)| *known == name) {
                Some((_, _, count)) => *count += 1,
                None => self.longer.push((name, number, 1)),
            }
        }
        Ok(element)
    }

    /// Tells what is odd, or of the errors.
    fn finish(mut self, log: &mut Log) -> Result<(), ReadError> {
        self.errors.finish(log)?;
        for (name, first, count) in self.longer {
            let text = format!(
                "{count} lines of the element `{}`, this one first, have more values than it has \
                 properties; the last ones are not used",
                shown(name)
            );
            log.warn(Some(first), text);
        }
        if let Some((line, _)) = self.lines.next() {
            let text = "this line and those after it belong to no element and are not used";
            log.warn(Some(line), text);
        }
        self.odd.report(log);
        Ok(())
    }
}

/// Values in their order, whatever lines they are on.
struct InOrder<'a, I> {
    tokens: I,
    odd: Odd<'a>,
    /// The line of the first element that shares its lines with others or has several.
    first: Option<usize>,
    /// The line of the last value.
    last: usize,
}

impl<'a, 't, I: Iterator<Item = (usize, &'t str)>> InOrder<'a, I> {
    /// All elements, if they take all values.
    fn read(&mut self, kinds: impl Iterator<Item = Declaring<'a>>) -> Option<Elements> {
        let mut elements = Elements::default();
        for kind in kinds {
            match kind.declared.role {
                PlyRole::PlyVertex => elements.vertices = self.all(&kind)?,
                PlyRole::PlyFace => elements.faces = self.all(&kind)?,
                PlyRole::Strip => elements.strips.extend(self.all::<PlyFace>(&kind)?),
                PlyRole::Unused => drop(self.all::<Unused>(&kind)?),
            }
        }
        self.tokens.next().is_none().then_some(elements)
    }

    fn all<E: Element>(&mut self, kind: &Declaring<'a>) -> Option<Vec<E>> {
        let parser = Parser::<E>::new();
        let mut elements = Vec::new();
        for _ in 0..kind.declared.count {
            let before = self.last;
            let (mut begin, mut end) = (None, before);
            let mut tokens = self.tokens.by_ref().inspect(|(line, _)| {
                begin.get_or_insert(*line);
                end = *line;
            });
            let text = rewritten(&mut tokens, kind.declared, &mut self.odd).ok()?;
            self.last = end;
            if begin != Some(end) || before == end {
                self.first = self.first.or(begin);
            }
            let element: E = parser.read_ascii_element(&text, &kind.def).ok()?;
            if element.problem().is_some() {
                return None;
            }
            elements.push(element);
        }
        Some(elements)
    }
}

/// Takes the values of an element and writes them as the parser takes them: other programs print
/// `.5`, `5.` or `nan`, and what is not used may be anything.
fn rewritten<'a, 't>(
    tokens: &mut impl Iterator<Item = (usize, &'t str)>,
    declared: &'a Declaration,
    odd: &mut Odd<'a>,
) -> Result<String, Unfit> {
    let mut text = String::new();
    for property in &declared.properties {
        let (kind, count) = match property.kind {
            PlyKind::Scalar(kind) => (kind, 1),
            PlyKind::List(_, kind) => {
                let (_, token) = tokens.next().ok_or(Unfit)?;
                let length = length(token).ok_or(Unfit)?;
                text.push_str(&format!("{length} "));
                (kind, length)
            }
        };
        for _ in 0..count {
            let (line, token) = tokens.next().ok_or(Unfit)?;
            let value = number(token);
            if !value.is_some_and(|x| kind.holds(x)) {
                odd.add(declared, property, line);
            }
            match (property.used, value) {
                (None, _) => text.push('0'),
                (Some(_), None) => return Err(Unfit),
                (Some(_), Some(_)) if is_plain(token) => text.push_str(token),
                (Some(_), Some(x)) if x.is_finite() => text.push_str(&x.to_string()),
                // Not finite when it is parsed again, and found as such once the mesh is placed.
                (Some(_), Some(_)) => text.push_str("1e999"),
            }
            text.push(' ');
        }
    }
    Ok(text)
}

/// A list's length: a whole number, however it is written.
fn length(token: &str) -> Option<usize> {
    let real: f64 = token.parse().ok()?;
    Number::UInt.holds(real).then_some(real as usize)
}

/// Whether the parser takes a number as it stands.
fn is_plain(token: &str) -> bool {
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let unsigned = |s: &str| digits(s.strip_prefix(['+', '-']).unwrap_or(s));
    let (mantissa, exponent) = token.split_once(['e', 'E']).unwrap_or((token, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, "0"));
    unsigned(whole) && digits(fraction) && unsigned(exponent)
}

/// How many values the properties of an element take from its line, lengths of lists included.
fn value_count(line: &str, def: &ElementDef) -> usize {
    let mut tokens = line.split_whitespace();
    let mut count: usize = 0;
    for property in def.properties.values() {
        let token = tokens.next();
        count = count.saturating_add(1);
        if let PropertyType::List(..) = property.data_type {
            let length = token.and_then(length).unwrap_or(0);
            count = count.saturating_add(length);
            tokens.by_ref().take(length).for_each(drop);
        }
    }
    count
}

/// Counts the values that are not of their property's type.
#[derive(Default)]
struct Odd<'a> {
    /// The first line and the count.
    found: Vec<(&'a Declaration, &'a Declared, usize, usize)>,
}

impl<'a> Odd<'a> {
    fn add(&mut self, element: &'a Declaration, property: &'a Declared, line: usize) {
        match self.found.iter_mut().find(|(_, known, ..)| std::ptr::eq(*known, property)) {
            Some((.., count)) => *count += 1,
            None => self.found.push((element, property, line, 1)),
        }
    }

    fn report(mut self, log: &mut Log) {
        self.found.sort_by_key(|(_, _, line, _)| *line);
        for (element, property, line, count) in self.found {
            let fate = if property.used.is_some() {
                "they count as they stand"
            } else {
                "they are not used"
            };
            let text = format!(
                "{count} values of `{}` of the element `{}`, on this line first, are not of the \
                 type that the header declares; {fate}",
                shown(&property.name),
                shown(&element.name)
            );
            log.warn(Some(line), text);
        }
    }
}
