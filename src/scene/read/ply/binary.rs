//! The payload of a binary PLY file.

use super::elements::{Element, Elements, PlyFace, Unused, definition, scalar};
use super::header::{ElementHeader as Declaration, Header, Number, PlyKind, PlyRole};
use crate::scene::read::ReadError;
use crate::scene::read::log::Log;
use crate::scene::read::text::shown;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Encoding, Header as ParserHeader, ScalarType};
use std::io::ErrorKind;

pub(super) fn read(payload: &[u8], header: &Header, log: &mut Log) -> Result<Elements, ReadError> {
    let mut rest = payload;
    let mut elements = Elements::default();
    // Elements without properties take no bytes.
    for declared in header.elements.iter().filter(|e| !e.properties.is_empty()) {
        let rest = &mut rest;
        match declared.role {
            PlyRole::PlyVertex => elements.vertices = all(rest, declared, header.encoding, log)?,
            PlyRole::PlyFace => elements.faces = all(rest, declared, header.encoding, log)?,
            PlyRole::Strip => {
                elements.strips.extend(all::<PlyFace>(rest, declared, header.encoding, log)?);
            }
            PlyRole::Unused => drop(all::<Unused>(rest, declared, header.encoding, log)?),
        }
    }
    if !rest.is_empty() {
        log.warn(None, format!("{} bytes after the last element are not used", rest.len()));
    }
    Ok(elements)
}

/// All elements of a kind, taken off the front of the payload.
fn all<E: Element>(
    rest: &mut &[u8],
    declared: &Declaration,
    encoding: Encoding,
    log: &Log,
) -> Result<Vec<E>, ReadError> {
    let cut_short = || {
        let (count, name) = (declared.count, shown(&declared.name));
        let text = format!("expected {count} elements `{name}`; the file ends among them");
        log.error(None, text)
    };
    let damaged =
        || log.error(None, format!("the elements `{}` are damaged", shown(&declared.name)));
    let known = match known_types(rest, declared, encoding == Encoding::BinaryBigEndian) {
        Ok(known) => known,
        Err(Damage::Short) => return Err(cut_short()),
        Err(Damage::Length) => return Err(damaged()),
    };
    let bytes = known.as_ref().map_or(*rest, |(bytes, _)| bytes);
    let def = definition(declared, |_, number| scalar(number), length);
    let mut reader = Reader::new(bytes);
    let header = ParserHeader { encoding, ..ParserHeader::default() };
    let elements: Vec<E> = Parser::new()
        .read_payload_for_element(&mut reader, &def, &header)
        .map_err(|e| match e.kind() {
            ErrorKind::UnexpectedEof => cut_short(),
            _ => damaged(),
        })?;
    let left = reader.into_inner().len();
    let used = known.as_ref().map_or(bytes.len() - left, |(_, used)| *used);
    *rest = rest.get(used..).unwrap_or(&[]);
    for (i, element) in elements.iter().enumerate() {
        if let Some(text) = element.problem() {
            return Err(log.error(None, format!("{} number {}: {text}", declared.name, i + 1)));
        }
    }
    Ok(elements)
}

/// The type of a list's length once [`known_types`] has been at work.
fn length(number: Number) -> ScalarType {
    match number {
        Number::Float | Number::Double | Number::Long | Number::ULong => ScalarType::UInt,
        whole => scalar(whole),
    }
}

enum Damage {
    /// The bytes end within an element.
    Short,
    /// A list's length is no whole number.
    Length,
}

/// Rewrites elements with types that the parser does not know, to be read by [`definition`]: whole
/// numbers of 64 bits as doubles, lengths that are no small whole numbers as such. Nothing grows.
/// With how many bytes of the payload they were; `None` where nothing is to be rewritten.
fn known_types(
    payload: &[u8],
    declared: &Declaration,
    big: bool,
) -> Result<Option<(Vec<u8>, usize)>, Damage> {
    let wide = |number: Number| matches!(number, Number::Long | Number::ULong);
    let odd = declared.properties.iter().any(|p| match p.kind {
        PlyKind::Scalar(number) => wide(number),
        PlyKind::List(count, item) => length(count) != scalar(count) || wide(count) || wide(item),
    });
    if !odd {
        return Ok(None);
    }
    let mut walk = Walk { rest: payload, out: Vec::new(), big };
    for _ in 0..declared.count {
        for property in &declared.properties {
            match property.kind {
                PlyKind::Scalar(number) => walk.copy(number, 1)?,
                PlyKind::List(count, item) => {
                    let items = walk.length(count)?;
                    walk.copy(item, items)?;
                }
            }
        }
    }
    let used = payload.len() - walk.rest.len();
    Ok(Some((walk.out, used)))
}

struct Walk<'a> {
    rest: &'a [u8],
    out: Vec<u8>,
    big: bool,
}

impl Walk<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], Damage> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(Damage::Short)?;
        self.rest = rest;
        Ok(taken)
    }

    /// A number of values of one type.
    fn copy(&mut self, number: Number, count: usize) -> Result<(), Damage> {
        let bytes = count.checked_mul(number.size()).ok_or(Damage::Short)?;
        let (taken, rest) = self.rest.split_at_checked(bytes).ok_or(Damage::Short)?;
        self.rest = rest;
        if !matches!(number, Number::Long | Number::ULong) {
            self.out.extend_from_slice(taken);
            return Ok(());
        }
        let (numbers, _) = taken.as_chunks::<8>();
        for &bytes in numbers {
            let bits = if self.big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) };
            let real = if number == Number::Long { bits as i64 as f64 } else { bits as f64 };
            let real = if self.big { real.to_be_bytes() } else { real.to_le_bytes() };
            self.out.extend(real);
        }
        Ok(())
    }

    /// A list's length, which is also written.
    fn length(&mut self, number: Number) -> Result<usize, Damage> {
        let big = self.big;
        let taken = self.take(number.size())?;
        let mut bytes = [0; 8];
        let (slot, _) = bytes.split_at_mut(taken.len());
        slot.copy_from_slice(taken);
        if big {
            slot.reverse();
        }
        let [a, b, c, d, ..] = bytes;
        let low = u32::from_le_bytes([a, b, c, d]);
        let real = match number {
            Number::Char => f64::from(a as i8),
            Number::Short => f64::from(i16::from_le_bytes([a, b])),
            Number::Int => f64::from(low as i32),
            Number::UChar | Number::UShort | Number::UInt => f64::from(low),
            Number::Long => i64::from_le_bytes(bytes) as f64,
            Number::ULong => u64::from_le_bytes(bytes) as f64,
            Number::Float => f64::from(f32::from_bits(low)),
            Number::Double => f64::from_le_bytes(bytes),
        };
        if !(0.0..=f64::from(u32::MAX)).contains(&real) || real.fract() != 0.0 {
            return Err(Damage::Length);
        }
        if length(number) == scalar(number) {
            // As it was.
            let mut same = bytes;
            let (same, _) = same.split_at_mut(number.size());
            if big {
                same.reverse();
            }
            self.out.extend_from_slice(same);
        } else {
            let whole = real as u32;
            self.out.extend(if big { whole.to_be_bytes() } else { whole.to_le_bytes() });
        }
        Ok(real as usize)
    }
}
