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

/// The lines with their numbers from 1, whether they end in LF, CR LF or CR.
pub(in crate::scene) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.split('\n')
        .flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'))
        .enumerate()
        .map(|(i, line)| (i + 1, line))
}

/// A piece of the file for a message: short, and without characters that steer a terminal.
pub(in crate::scene) fn shown(token: &str) -> String {
    const LONGEST: usize = 60;
    let mut safe = String::new();
    for c in token.chars().take(LONGEST) {
        match c {
            '\'' | '"' | '\\' => safe.push(c),
            _ => safe.extend(c.escape_debug()),
        }
    }
    if token.chars().nth(LONGEST).is_some() {
        safe.push('…');
    }
    safe
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
    fn all_line_ends_count_alike() {
        let found: Vec<_> = lines("a\nb\r\nc\rd\n\ne").collect();
        assert_eq!(found, [(1, "a"), (2, "b"), (3, "c"), (4, "d"), (5, ""), (6, "e")]);
    }

    #[test]
    fn messages_cannot_steer_a_terminal() {
        assert_eq!(shown("a\u{1b}[2J"), "a\\u{1b}[2J");
        assert_eq!(shown(&"x".repeat(1000)).chars().count(), 61);
    }
}
