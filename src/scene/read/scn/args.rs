//! The arguments of one command, taken off one by one.

use crate::scene::read::ReadError;
use crate::scene::read::text::{leading_number, shown};
use glam::{DQuat, DVec3};
use std::str::SplitWhitespace;

/// Why a command cannot be carried out.
pub(super) enum Problem {
    /// Its own line is at fault.
    Here(String),
    /// A file that it names is.
    Elsewhere(ReadError),
    /// The same that an earlier line has told already.
    Told,
}

/// A squared length so near 1 is that of a unit vector, rounded.
const UNIT: f64 = 1e-15;

impl<E: std::error::Error> From<E> for Problem {
    fn from(error: E) -> Problem {
        Problem::Here(error.to_string())
    }
}

/// What is left of a command's line.
pub(super) struct Args<'a> {
    command: &'static str,
    usage: &'static str,
    /// What each argument is called, in the order of the usage.
    names: SplitWhitespace<'static>,
    /// The arguments that nothing has taken yet.
    rest: &'a str,
    remarks: Vec<String>,
}

/// What people and word processors put around a name.
const QUOTES: [(char, char); 4] =
    [('"', '"'), ('\'', '\''), ('\u{201c}', '\u{201d}'), ('\u{2018}', '\u{2019}')];

impl<'a> Args<'a> {
    pub(super) fn new(command: &'static str, usage: &'static str, arguments: &'a str) -> Args<'a> {
        let names = usage.split_whitespace();
        Args { command, usage, names, rest: arguments, remarks: Vec::new() }
    }

    /// True when arguments are left.
    pub(super) fn more(&self) -> bool {
        self.peek().is_some()
    }

    /// The next argument, which stays.
    pub(super) fn peek(&self) -> Option<&'a str> {
        self.rest.split_whitespace().next()
    }

    /// The next argument, a name: a word, or what stands between quotes, blanks and all.
    pub(super) fn file_name(&mut self) -> Result<&'a str, Problem> {
        let name = self.name();
        let rest = self.rest.trim_start();
        for (open, close) in QUOTES {
            let Some(inner) = rest.strip_prefix(open) else { continue };
            // Within a name a quote may be an apostrophe: the last one ends a word.
            let ends = inner.match_indices(close).map(|(at, mark)| (at, at + mark.len()));
            let mut ends = ends.filter(|&(_, after)| {
                inner
                    .get(after..)
                    .is_some_and(|s| s.is_empty() || s.starts_with(char::is_whitespace))
            });
            if let Some((end, after)) = ends.next() {
                self.rest = inner.get(after..).unwrap_or_default();
                return Ok(inner.get(..end).unwrap_or_default());
            }
        }
        let word = self.token(name)?;
        let bare = word.trim_matches('"');
        if bare != word {
            self.remarks.push(format!("`{}` is read as `{}`", shown(word), shown(bare)));
        }
        Ok(bare)
    }

    /// All that is left of the line, some text.
    pub(super) fn text(&mut self) -> Result<&'a str, Problem> {
        let (name, text) = (self.name(), self.rest.trim());
        self.token(name)?;
        self.rest = "";
        Ok(text)
    }

    /// The next arguments, numbers.
    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Problem> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let name = self.name();
            *number = self.number(name)?;
        }
        Ok(numbers)
    }

    /// The next three arguments, a point or vector.
    pub(super) fn point(&mut self) -> Result<DVec3, Problem> {
        self.numbers().map(DVec3::from_array)
    }

    /// The rotations that follow, multiplied from left to right: the last acts first.
    pub(super) fn orientation(&mut self) -> Result<DQuat, Problem> {
        let mut total = DQuat::IDENTITY;
        while let Some(kind) = self.peek().filter(|t| ["x", "y", "z", "q", "a"].contains(t)) {
            self.next();
            total *= match kind {
                "x" => DQuat::from_rotation_x(self.angle()?),
                "y" => DQuat::from_rotation_y(self.angle()?),
                "z" => DQuat::from_rotation_z(self.angle()?),
                "q" => {
                    let [w, x, y, z] = self.unit(["w", "x", "y", "z"])?;
                    DQuat::from_xyzw(x, y, z, w)
                }
                _ => {
                    let angle = self.angle()?;
                    let axis = DVec3::from_array(self.unit(["ax", "ay", "az"])?);
                    DQuat::from_axis_angle(axis, angle)
                }
            };
        }
        let unit = (total.length_squared() - 1.0).abs() <= UNIT;
        Ok(if unit { total } else { total.normalize() })
    }

    /// What is odd about the arguments, those included that no one took.
    pub(super) fn remarks(mut self) -> Vec<String> {
        if let Some(extra) = self.peek() {
            self.remarks.push(format!(
                "`{}` and what follows is not used; expected `{} {}`",
                shown(extra),
                self.command,
                self.usage
            ));
        }
        self.remarks
    }

    fn name(&mut self) -> &'static str {
        self.names.next().unwrap_or("argument").trim_matches(['[', ']'])
    }

    /// Takes the next argument off.
    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_start();
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        self.rest = after;
        (!word.is_empty()).then_some(word)
    }

    fn token(&mut self, name: &str) -> Result<&'a str, Problem> {
        self.next().ok_or_else(|| {
            let (command, usage) = (self.command, self.usage);
            Problem::Here(format!("{name} is missing; expected `{command} {usage}`"))
        })
    }

    fn number(&mut self, name: &str) -> Result<f64, Problem> {
        let token = self.token(name)?;
        let Some((number, rest)) = leading_number(token) else {
            let text = format!("expected a number for {name}, not `{}`", shown(token));
            return Err(Problem::Here(text));
        };
        if !rest.is_empty() {
            self.remarks.push(format!("`{}` is read as {number}", shown(token)));
        }
        Ok(number)
    }

    /// An angle in degrees, as radians.
    fn angle(&mut self) -> Result<f64, Problem> {
        let degrees = self.number("deg")?;
        if degrees.is_finite() {
            Ok(degrees.to_radians())
        } else {
            Err(Problem::Here("the angle deg must be a finite number of degrees".to_owned()))
        }
    }

    /// Numbers that matter by their direction alone, normalised.
    fn unit<const N: usize>(&mut self, names: [&str; N]) -> Result<[f64; N], Problem> {
        let mut v = [0.0; N];
        for (number, name) in v.iter_mut().zip(names) {
            *number = self.number(name)?;
        }
        // What is unit stays as it is, so that a line that was written reads back to its bits.
        if (v.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() <= UNIT {
            return Ok(v);
        }
        // By the largest first, so that no square overflows or vanishes.
        let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            let text = format!("{} must be finite and not all 0", names.join(" "));
            return Err(Problem::Here(text));
        }
        let v = v.map(|x| x / largest);
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Ok(v.map(|x| x / length))
    }
}
