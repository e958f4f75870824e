//! Text files as they come: any line ends, any encoding, a byte order mark or not.

use super::ReadError;
use super::log::Log;
use std::borrow::Cow;

/// The text of a file. Bytes that are not UTF-8 become `U+FFFD`, which no command or number
/// contains: where they matter the reader then says so, and in comments they do not matter.
pub(super) fn decode<'a>(bytes: &'a [u8], log: &Log) -> Result<Cow<'a, str>, ReadError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.is_empty() {
        return Err(log.error(None, "the file is empty"));
    }
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        return Err(log.error(Some(line), "expected text in UTF-8, found a zero byte"));
    }
    Ok(String::from_utf8_lossy(bytes))
}

/// The text of a file whose names are bytes: no two spellings become one, and [`raw`] gives back
/// what was there. UTF-16 is known by its byte order mark, or by the zeros of its first characters.
pub(super) fn decode_names(bytes: &[u8]) -> Cow<'_, str> {
    let utf16 = |wide: fn([u8; 2]) -> u16, bytes: &[u8]| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| wide([pair[0], pair[1]])).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => return utf16(u16::from_le_bytes, rest),
        [0xfe, 0xff, rest @ ..] => return utf16(u16::from_be_bytes, rest),
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => return utf16(u16::from_le_bytes, bytes),
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => return utf16(u16::from_be_bytes, bytes),
        _ => {}
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // All that the private characters begin with in UTF-8.
    match std::str::from_utf8(bytes) {
        Ok(text) if !bytes.contains(&0xf4) => Cow::Borrowed(text),
        _ => Cow::Owned(private(bytes)),
    }
}

/// A byte that is not text is kept as a character of private use, this one plus the byte. Where a
/// file has such characters itself, their bytes are kept in the same way.
const PRIVATE: u32 = 0x10_fe00;

fn private(bytes: &[u8]) -> String {
    let of = |byte: u8| char::from_u32(PRIVATE + u32::from(byte));
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        for c in chunk.valid().chars() {
            match byte_of(c) {
                None => text.push(c),
                Some(_) => text.extend(c.encode_utf8(&mut [0; 4]).bytes().filter_map(of)),
            }
        }
        text.extend(chunk.invalid().iter().copied().filter_map(of));
    }
    text
}

/// The byte that a private character stands for.
fn byte_of(c: char) -> Option<u8> {
    u32::from(c).checked_sub(PRIVATE).and_then(|byte| u8::try_from(byte).ok())
}

/// The bytes that a piece of decoded text was read from.
pub(super) fn raw(text: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    for c in text.chars() {
        match byte_of(c) {
            Some(byte) => bytes.push(byte),
            None => bytes.extend(c.encode_utf8(&mut [0; 4]).bytes()),
        }
    }
    bytes
}

/// A name for people, in which bytes that are not text are written `\xe4`.
pub(super) fn readable(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for c in name.chars() {
        match byte_of(c) {
            Some(byte) => text.push_str(&format!("\\x{byte:02x}")),
            None => text.push(c),
        }
    }
    text
}

/// The lines with their numbers from 1, whether they end in LF, CR LF, CR or LF CR.
pub(in crate::scene) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> + Clone {
    let mut rest = Some(text);
    let next = move || {
        let line = rest?;
        let Some(end) = line.bytes().position(|b| matches!(b, b'\n' | b'\r')) else {
            rest = None;
            return Some(line);
        };
        let (line, after) = line.split_at(end);
        rest = after.get(line_end(after.as_bytes())..);
        Some(line)
    };
    std::iter::from_fn(next).enumerate().map(|(i, line)| (i + 1, line))
}

/// The length of the line end with which these bytes begin.
pub(super) fn line_end(bytes: &[u8]) -> usize {
    match bytes {
        [b'\r', b'\n', ..] => 2,
        [b'\n', b'\r', ..] => {
            // LF CR, unless this is the end of one line and a blank one that ends in CR LF: then
            // the run is odd. It need not be looked at for ever.
            let run = bytes.iter().take(64).take_while(|b| matches!(b, b'\n' | b'\r')).count();
            2 - run % 2
        }
        _ => 1,
    }
}

/// A piece of the file for a message: short, and without characters that steer a terminal.
pub(in crate::scene) fn shown(token: &str) -> String {
    const LONGEST: usize = 60;
    // Three of them leave room in a line.
    const BYTES: usize = 120;
    let mut safe = String::new();
    for (i, c) in token.chars().enumerate() {
        if i == LONGEST || safe.len() >= BYTES {
            safe.push('…');
            break;
        }
        if let Some(byte) = byte_of(c) {
            safe.push_str(&format!("\\x{byte:02x}"));
            continue;
        }
        match c {
            '\'' | '"' | '\\' => safe.push(c),
            _ => safe.extend(c.escape_debug()),
        }
    }
    safe
}

/// A number, in any spelling that C libraries print: `1.#QNAN`, `-nan(ind)`, `inf` and their like
/// are what they mean.
pub(super) fn number(token: &str) -> Option<f64> {
    token.parse().ok().or_else(|| not_finite(token))
}

/// Infinity and not-a-number where Rust does not know the spelling.
fn not_finite(token: &str) -> Option<f64> {
    let (sign, word) = match token.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, token.strip_prefix('+').unwrap_or(token)),
    };
    let word = word.to_ascii_lowercase();
    // Microsoft's: `1.#INF`, `1.#QNAN0`, `1.#IND000`, `1.#INF00e+000`.
    if let Some((digits, kind)) = word.split_once('#') {
        let odd = |c: char| !c.is_ascii_alphanumeric() && !matches!(c, '+' | '-');
        if !matches!(digits, "1." | "1" | "0." | "0") || kind.contains(odd) {
            return None;
        }
        // With few digits asked for, the letters are rounded as digits are: `1.#J`, `1.#IO`.
        let rounded = ["j", "io", "i", "q", "qo", "r", "s"];
        let nan = ["nan", "ind", "qnan", "snan"].iter().any(|known| kind.starts_with(known));
        return if kind.starts_with("inf") {
            Some(sign * f64::INFINITY)
        } else {
            (nan || rounded.contains(&kind)).then_some(f64::NAN)
        };
    }
    if word == "∞" {
        return Some(sign * f64::INFINITY);
    }
    let rest = ["nan", "qnan", "snan"].iter().find_map(|known| word.strip_prefix(known))?;
    let more = matches!(rest, "" | "q" | "s")
        || (rest.starts_with('(') && rest.ends_with(')'))
        || rest.strip_prefix("0x").is_some_and(|r| r.bytes().all(|b| b.is_ascii_hexdigit()));
    more.then_some(f64::NAN)
}

/// Splits off the longest prefix that is a decimal number, with what remains of the token.
pub(in crate::scene) fn leading_number(token: &str) -> Option<(f64, &str)> {
    let bytes = token.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let sign = |at: usize| at + usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let start = sign(0);
    let mut end = digits(start);
    let mut found = end - start;
    if bytes.get(end) == Some(&b'.') {
        let after = digits(end + 1);
        found += after - (end + 1);
        end = after;
    }
    if found == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let from = sign(end + 1);
        let to = digits(from);
        if to > from {
            end = to;
        }
    }
    Some((token.get(..end)?.parse().ok()?, token.get(end..)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_numeric_prefix_is_the_number() {
        for (token, number, rest) in [
            ("2.900874b", 2.900874, "b"),
            ("0,", 0.0, ","),
            ("-.5", -0.5, ""),
            ("5.", 5.0, ""),
            ("+1e3", 1000.0, ""),
            ("1e", 1.0, "e"),
            ("1e+x", 1.0, "e+x"),
            ("1.2.3", 1.2, ".3"),
            ("0x10", 0.0, "x10"),
            ("7é", 7.0, "é"),
        ] {
            assert_eq!(leading_number(token), Some((number, rest)), "{token}");
        }
        for token in ["", ".", "-", "+.", "e5", "nan", "inf", "é"] {
            assert_eq!(leading_number(token), None, "{token}");
        }
    }

    #[test]
    fn what_is_no_number_is_read_in_every_spelling() {
        for token in [
            "nan",
            "NaN",
            "-nan",
            "+NAN",
            "-nan(ind)",
            "nan(snan)",
            "NAN(0x8000000000000)",
            "NaNQ",
            "nans",
            "nan0x7fffffff",
            "1.#QNAN",
            "-1.#IND",
            "1.#IND000",
            "-1.#IND00e+000",
            "1.#SNAN",
            "1.#QNAN0",
            "1.#J",
            "-1.#J",
            "1.#IO",
            "-1.#R",
            "1.#NAN",
            "qnan",
        ] {
            assert!(number(token).is_some_and(f64::is_nan), "{token}");
        }
        for token in ["inf", "+INF", "Infinity", "1.#INF", "1.#INF00", "1.#inf00e+000", "∞"] {
            assert_eq!(number(token), Some(f64::INFINITY), "{token}");
        }
        for token in ["-inf", "-Infinity", "-1.#INF", "-1.#INF00", "-∞"] {
            assert_eq!(number(token), Some(f64::NEG_INFINITY), "{token}");
        }
        for token in
            ["", "-", "#", "1.#", "1.#x", "2.#INF", "nano", "nan(", "in", "0,5", "1.#INF;", "0x1p3"]
        {
            assert_eq!(number(token), None, "{token}");
        }
        assert_eq!(number("-.5e1"), Some(-5.0));
    }

    #[test]
    fn no_two_names_become_one() {
        let names: [&[u8]; 7] = [
            b"M\xe4dd",
            b"M\xf6dd",
            "Mädd".as_bytes(),
            "M\u{fffd}dd".as_bytes(),
            "M\u{10fee4}dd".as_bytes(),
            b"\x95\\",
            b"\xc3\xf4",
        ];
        let mut seen = std::collections::HashSet::new();
        for name in names {
            let text = decode_names(name);
            assert!(seen.insert(text.clone().into_owned()), "{text:?}");
            assert_eq!(raw(&text), name);
        }
        assert_eq!(shown(&decode_names(b"M\xe4dd")), "M\\xe4dd");
        assert_eq!(readable(&decode_names("a\u{e4}".as_bytes())), "aä");
        for (bytes, text) in [
            (&b"\xff\xfev\0\xe4\0"[..], "vä"),
            (b"\xfe\xff\0v\0\xe4", "vä"),
            (b"\xef\xbb\xbfv", "v"),
            (b"\xff\xfev\0x", "v"),
            (b"v\0 \x001\0", "v 1"),
            (b"\0v\0 \x001", "v 1"),
            (b"", ""),
        ] {
            assert_eq!(decode_names(bytes), text);
        }
    }

    #[test]
    fn all_line_ends_count_alike() {
        let found: Vec<_> = lines("a\nb\r\nc\rd\n\ne").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, "d"), (5, ""), (6, "e")]);
        let found: Vec<_> = lines("a\n\rb\n\r\n\rc\n\r").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, ""), (4, "c"), (5, "")]);
        let found: Vec<_> = lines("a\n\r\nb\r\n\r\nc").collect();
        assert_eq!(found, [(1, "a"), (2, ""), (3, "b"), (4, ""), (5, "c")]);
    }

    #[test]
    fn messages_cannot_steer_a_terminal() {
        assert_eq!(shown("a\u{1b}[2J"), "a\\u{1b}[2J");
        assert_eq!(shown(&"x".repeat(1000)).chars().count(), 61);
    }
}
