//! The statements of OBJ and MTL files: lines without their comments, joined where a backslash says
//! so.

use crate::scene::read::text::lines;
use std::borrow::Cow;

/// One statement and the line where it begins.
pub(super) struct Statement<'a> {
    pub(super) line: usize,
    text: Cow<'a, str>,
    /// True when a backslash at its end continues nothing, for a statement follows.
    pub(super) stray: bool,
}

/// What to say of a stray backslash.
pub(super) const STRAY: &str = "the backslash at the end of this line continues nothing";

/// A name as a statement gives it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Name {
    /// Without the comment that may follow it.
    pub(super) text: String,
    /// With it, for some names look like a name and a comment: `Material #25`.
    pub(super) whole: String,
}

/// What follows a statement's word.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LineKind {
    /// A name: up to a `#` after a blank, and never continued, for the last byte of a name may be a
    /// backslash, or that of half a character in some encodings.
    Name,
    /// Numbers: up to any `#`.
    Numbers,
    /// A word that nobody knows.
    Unknown,
}

const NAMES: [&str; 18] = [
    "usemtl",
    "usemap",
    "mtllib",
    "maplib",
    "g",
    "o",
    "call",
    "csh",
    "shadow_obj",
    "trace_obj",
    "newmtl",
    "bump",
    "disp",
    "decal",
    "refl",
    "norm",
    "lib",
    "texture",
];

const NUMBERS: [&str; 46] = [
    "v",
    "vt",
    "vn",
    "vp",
    "f",
    "fo",
    "l",
    "p",
    "s",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "ctech",
    "stech",
    "kd",
    "ks",
    "ka",
    "ke",
    "ns",
    "ni",
    "d",
    "tr",
    "tf",
    "illum",
    "sharpness",
    "pr",
    "pm",
    "ps",
    "pc",
    "pcr",
];

impl LineKind {
    fn of(word: &str) -> LineKind {
        // Nearly every line.
        if matches!(word, "v" | "vn" | "vt" | "f") {
            return LineKind::Numbers;
        }
        let word = word.to_ascii_lowercase();
        if NAMES.contains(&word.as_str()) || word.starts_with("map_") {
            LineKind::Name
        } else if NUMBERS.contains(&word.as_str()) {
            LineKind::Numbers
        } else {
            LineKind::Unknown
        }
    }
}

/// All statements, empty ones among them.
pub(super) fn statements(text: &str) -> impl Iterator<Item = Statement<'_>> {
    // Files that were put together have byte order marks within.
    let mut physical = lines(text).map(|(number, line)| (number, trim_start(line))).peekable();
    std::iter::from_fn(move || {
        let (line, first) = physical.next()?;
        let kind = LineKind::of(word(first).0);
        if kind == LineKind::Name {
            return Some(Statement { line, text: first.into(), stray: false });
        }
        let (content, mut continued) = content(first, kind);
        let mut statement = Statement { line, text: content.into(), stray: false };
        while continued {
            let Some((_, next)) = physical.peek() else { break };
            if LineKind::of(word(next).0) != LineKind::Unknown {
                statement.stray = true;
                break;
            }
            let (more, again) = self::content(next, kind);
            let text = statement.text.to_mut();
            text.push(' ');
            text.push_str(more);
            continued = again;
            physical.next();
        }
        Some(statement)
    })
}

impl Statement<'_> {
    /// The word in front in small letters.
    pub(super) fn word(&self) -> Cow<'_, str> {
        let word = self.parts().0;
        if word.bytes().any(|b| b.is_ascii_uppercase()) {
            word.to_ascii_lowercase().into()
        } else {
            word.into()
        }
    }

    /// The word in front, and what follows it, a name's comment included.
    pub(super) fn parts(&self) -> (&str, &str) {
        word(&self.text)
    }
}

impl Name {
    /// The name in what follows a statement's word. Blanks around it do not belong to it; those
    /// within do, and so do all bytes beyond ASCII.
    pub(super) fn of(rest: &str) -> Name {
        let trim = |text: &str| text.trim_matches(blank).to_owned();
        Name { text: trim(until_comment(rest, LineKind::Name)), whole: trim(rest) }
    }
}

fn blank(c: char) -> bool {
    c.is_ascii_whitespace() || c == '\x0b'
}

fn trim_start(line: &str) -> &str {
    line.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}')
}

fn word(line: &str) -> (&str, &str) {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (word, rest.trim_start_matches(blank))
}

/// A line without its comment, and whether the next one continues it.
fn content(line: &str, kind: LineKind) -> (&str, bool) {
    let text = until_comment(line, kind).trim_end();
    match text.strip_suffix('\\') {
        Some(start) if !start.ends_with(|c: char| !c.is_ascii()) => (start, true),
        _ => (text, false),
    }
}

fn until_comment(line: &str, kind: LineKind) -> &str {
    let begins = |at: usize| {
        let (before, after) = (&line[..at], &line[at + 1..]);
        before.is_empty()
            || before.ends_with(blank)
            || (kind == LineKind::Numbers && !(before.ends_with('.') && not_finite(after)))
    };
    let at = line.match_indices('#').map(|(at, _)| at).find(|&at| begins(at));
    at.map_or(line, |at| &line[..at])
}

/// True for what stands after `1.#` where Microsoft's library prints what is no number.
fn not_finite(after: &str) -> bool {
    let end = after.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(after.len());
    let letters = after[..end].to_ascii_lowercase();
    ["inf", "ind", "nan", "qnan", "snan"].iter().any(|known| letters.starts_with(known))
        || ["j", "io", "i", "q", "qo", "r", "s"].contains(&letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(usize, String)> {
        statements(text)
            .map(|s| (s.line, s.parts().0.to_owned() + "|" + s.parts().1))
            .filter(|(_, text)| text != "|")
            .collect()
    }

    #[test]
    fn comments_end_lines_and_names_may_hold_their_mark() {
        for (text, expected) in [
            ("v 0 0 0 # a", "v|0 0 0"),
            ("v 0 0 0#a", "v|0 0 0"),
            ("v 0 0 1.#comment", "v|0 0 1."),
            ("v 1.#INF -1.#IND 1.#QNAN0#x", "v|1.#INF -1.#IND 1.#QNAN0"),
            ("v 1.#INF#1.#INF", "v|1.#INF"),
            ("f 1 2 3 #\\", "f|1 2 3"),
            ("#v 0 0 0", "|"),
            ("odd a#b #c", "odd|a#b"),
        ] {
            let found: Vec<String> = statements(text)
                .map(|s| s.parts().0.to_owned() + "|" + s.parts().1.trim())
                .collect();
            assert_eq!(found, [expected], "{text}");
        }
        for (rest, name) in [
            ("red # paint", "red"),
            ("red#2", "red#2"),
            ("red\t#2", "red"),
            ("#2", ""),
            ("a b ", "a b"),
            ("a\u{3000}", "a\u{3000}"),
        ] {
            assert_eq!(Name::of(rest).text, name, "{rest}");
        }
        assert_eq!(Name::of("Material #25 ").whole, "Material #25");
    }

    #[test]
    fn only_numbers_go_on_after_a_backslash() {
        let of = |text: &str| -> Vec<String> { all(text).into_iter().map(|(_, t)| t).collect() };
        for (text, expected) in [
            ("v 0 \\\n1 \\\r\n2\nv 3", &["v|0  1  2", "v|3"][..]),
            ("v 0 \\  \n1 \\ # c\n2", &["v|0  1  2"]),
            ("usemtl a\\\nf 1 2 3", &["usemtl|a\\", "f|1 2 3"]),
            ("g a \\\nf 1 2 3", &["g|a \\", "f|1 2 3"]),
            ("map_Kd C:\\\nKd 1", &["map_Kd|C:\\", "Kd|1"]),
            ("# C:\\\nf 1 2 3", &["f|1 2 3"]),
            ("f 1 2 3 # C:\\\nf 1 2 4", &["f|1 2 3", "f|1 2 4"]),
            ("f 1 2 3\\\nf 1 2 4", &["f|1 2 3", "f|1 2 4"]),
            ("odd \u{10fe95}\\\nf 1 2 4", &["odd|\u{10fe95}\\", "f|1 2 4"]),
            ("odd 1 \\\n2", &["odd|1  2"]),
            ("f 1 2 3 \\", &["f|1 2 3 "]),
            ("\u{feff}v 1\n\u{feff} v 2", &["v|1", "v|2"]),
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
        assert_eq!(all("\nv 0 \\\n\\\n0\n\nf 1").iter().map(|s| s.0).collect::<Vec<_>>(), [2, 6]);
        assert!(statements("f 1 2 3\\\nf 1 2 4").next().unwrap().stray);
    }
}
