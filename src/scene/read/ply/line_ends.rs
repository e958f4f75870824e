//! The lines of a header whose file may go on in binary.

use crate::scene::read::text::line_end;

/// Takes lines off the front of a file.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// The number of the last line, from 1.
    pub(super) number: usize,
    /// With what the first line ends.
    first_end: Vec<u8>,
    /// What follows the last line, its own end included.
    behind: &'a [u8],
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Lines<'a> {
        // A file of CR LF that was once more written as text ends its lines in CR CR LF.
        let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
        let after = bytes.iter().position(is_end).and_then(|at| bytes.get(at..)).unwrap_or(&[]);
        let length = match after {
            [b'\r', b'\r', b'\n', ..] => 3,
            _ => line_end(after).min(after.len()),
        };
        let first_end = after.get(..length).unwrap_or(&[]).to_vec();
        Lines { rest: bytes, number: 0, first_end, behind: bytes }
    }

    /// The next line without its end.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let (line, behind) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.behind = behind;
        self.rest = behind.get(self.end(behind)..).unwrap_or(&[]);
        Some(line)
    }

    /// The length of the line end in front: the first line's, where it is that.
    fn end(&self, bytes: &[u8]) -> usize {
        if bytes.starts_with(&self.first_end) && self.first_end.len() > 1 {
            self.first_end.len()
        } else {
            line_end(bytes)
        }
    }

    /// All behind the last line. In a binary file a CR or LF there may be the first of its values:
    /// then what ended the lines before ends this one.
    pub(super) fn behind(&self, binary: bool) -> &'a [u8] {
        let length = match self.behind {
            behind if !binary => self.end(behind),
            behind if behind.starts_with(&self.first_end) => self.first_end.len(),
            [b'\r', b'\n', ..] => 2,
            _ => 1,
        };
        self.behind.get(length..).unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes behind the header, whose lines end so, when it begins like another line end.
    #[test]
    fn values_that_look_like_line_ends_are_values() {
        for end in ["\n", "\r\n", "\r", "\n\r", "\r\r\n"] {
            for value in [&b"\n"[..], b"\r", b"\n\r", b"\r\n", b"x", b""] {
                let mut bytes = format!("ply{end}{end}format{end}end_header{end}").into_bytes();
                bytes.extend(value);
                let mut lines = Lines::new(&bytes);
                let mut found = Vec::new();
                while let Some(line) = lines.next() {
                    found.push(line);
                    if line == b"end_header" {
                        break;
                    }
                }
                assert_eq!(found, [&b"ply"[..], b"", b"format", b"end_header"], "{end:?}");
                assert_eq!(lines.behind(true), value, "{end:?}");
            }
        }
    }
}
