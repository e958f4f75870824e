//! Text that may come from anyone, made safe for a terminal and for a log.

use std::path::Path;

/// One line: nothing in it moves the cursor, recolours the screen or turns the order of letters.
pub fn line(text: &str) -> String {
    escaped(text, |_| false)
}

/// Lines: the same but for tabs and line ends.
pub fn lines(text: &str) -> String {
    escaped(text, |c| matches!(c, '\n' | '\t'))
}

/// A file's name for a message: on one line, whatever is in it.
pub fn path(path: &Path) -> String {
    line(&path.display().to_string())
}

/// The beginning of a text, on one line: enough to know it again.
pub fn start(text: &str) -> String {
    const LONGEST: usize = 60;
    let start: String = text.chars().take(LONGEST).collect();
    let more = if text.chars().nth(LONGEST).is_some() { "…" } else { "" };
    line(&start) + more
}

/// A number as it is written, or by a power of ten where that would take hundreds of digits.
pub fn number(x: f64) -> String {
    const LONGEST: usize = 40;
    let text = x.to_string();
    if text.len() > LONGEST { format!("{x:e}") } else { text }
}

/// As JSON writes it, so that JSON stays what it says.
fn escaped(text: &str, keep: fn(char) -> bool) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) && !keep(c) {
            safe.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            safe.push(c);
        }
    }
    safe
}

/// Control characters, those of 0x80 to 0x9f included, and marks that turn the order of letters.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{061c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (-0.125, "-0.125"),
            (1e18, "1000000000000000000"),
            (-1e300, "-1e300"),
            (3e-300, "3e-300"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), text);
        }
        assert!(number(-f64::MAX / 3.0).len() < 30 && number(f64::MIN_POSITIVE / 3.0).len() < 30);
    }

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        assert_eq!(
            line("a\u{1b}[2J\r\u{9b}5m\u{202e}b\n"),
            "a\\u001b[2J\\u000d\\u009b5m\\u202eb\\u000a"
        );
        assert_eq!(lines("a\tb\n\u{7}"), "a\tb\n\\u0007");
        assert_eq!(path("a\nburnish: b".as_ref()), "a\\u000aburnish: b");
        assert_eq!(line("W\u{fc}rfel \u{7acb}\u{65b9} %\\"), "W\u{fc}rfel \u{7acb}\u{65b9} %\\");
    }
}
