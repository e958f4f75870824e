//! The arguments of one command, taken off one by one.

use crate::scene::read::ReadError;
use crate::scene::read::text::{leading_number, shown};
use glam::{DQuat, DVec3};
use std::iter::Peekable;
use std::str::SplitWhitespace;

/// Why a command cannot be carried out.
pub(super) enum Problem {
    /// Its own line is at fault.
    Here(String),
    /// A file that it names is.
    Elsewhere(ReadError),
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
    tokens: Peekable<SplitWhitespace<'a>>,
    remarks: Vec<String>,
}

impl<'a> Args<'a> {
    pub(super) fn new(
        command: &'static str,
        usage: &'static str,
        tokens: SplitWhitespace<'a>,
    ) -> Args<'a> {
        let names = usage.split_whitespace();
        Args { command, usage, names, tokens: tokens.peekable(), remarks: Vec::new() }
    }

    /// True when arguments are left.
    pub(super) fn more(&mut self) -> bool {
        self.tokens.peek().is_some()
    }

    /// The next argument, a word.
    pub(super) fn word(&mut self) -> Result<&'a str, Problem> {
        let name = self.name();
        self.token(name)
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
        while let Some(kind) = self.tokens.next_if(|t| ["x", "y", "z", "q", "a"].contains(t)) {
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
        if let Some(extra) = self.tokens.peek() {
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

    fn token(&mut self, name: &str) -> Result<&'a str, Problem> {
        self.tokens.next().ok_or_else(|| {
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
