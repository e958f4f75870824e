//! One MTL file: materials as it describes them.
//!
//! Kd, Ks, Ns (the Phong exponent a_p) and Ke (emission) are used. `tobj` panics on the legal
//! shorthand `Kd 0.5` and drops a whole file for one bad line, so lines are checked here first, and
//! materials have numbers for names. A fault costs what it stands in: that value is clamped, or the
//! one that a material without it has.

use super::lines::{Name, STRAY, statements};
use crate::brdf::Roughness;
use crate::plain;
use crate::scene::Material;
use crate::scene::read::ReadError;
use crate::scene::read::log::{Doubts, Log};
use crate::scene::read::text::{decode_names, number, readable, shown};
use std::fmt::Write;

/// The exponent of a shiny surface whose file gives none.
const DEFAULT_NS: f64 = 10.0;

/// A material of the file.
pub(super) struct Entry {
    pub(super) name: Name,
    /// The line of its `newmtl`.
    pub(super) line: usize,
    kd: Option<[f64; 3]>,
    ks: Option<[f64; 3]>,
    ke: Option<[f64; 3]>,
    ns: Option<f64>,
    said: Said,
}

/// What a material says besides its numbers.
#[derive(Clone, Copy, Default)]
struct Said {
    /// There is a Kd that cannot be used.
    bad_kd: bool,
    /// There is a texture for it.
    map_kd: bool,
    /// The line and number of an `illum` that has no specular lobe.
    no_lobe: Option<(usize, u8)>,
    /// Which numbers are given: Kd, Ks, Ke, Ns.
    given: [bool; 4],
}

/// The materials of a file in their order.
pub(super) fn read(bytes: &[u8], doubts: &mut Doubts) -> Vec<Entry> {
    let text = decode_names(bytes);
    if text.trim().is_empty() {
        doubts.add("empty", 1, || "the file is empty".to_owned());
    }
    let mut reader =
        MtlReader { kept: String::new(), entries: Vec::new(), nameless: false, doubts };
    for statement in statements(&text) {
        let (word, rest) = statement.parts();
        if statement.stray {
            reader.doubts.add("stray", statement.line, || STRAY.to_owned());
        }
        reader.statement(statement.line, word, rest);
    }
    reader.finish()
}

/// The statements that are used, each known to be well formed, as text for `tobj`.
struct MtlReader<'a> {
    kept: String,
    entries: Vec<Entry>,
    /// True within a material without a name.
    nameless: bool,
    doubts: &'a mut Doubts,
}

impl MtlReader<'_> {
    fn statement(&mut self, line: usize, word: &str, rest: &str) {
        let lower = word.to_ascii_lowercase();
        match lower.as_str() {
            "" => return,
            "newmtl" => return self.begin(line, rest),
            _ if self.nameless => return,
            _ => {}
        }
        let Some(entry) = self.entries.last_mut() else {
            // A file that begins with other words may be of any kind, and nobody's business.
            let of_mtl = ["ka", "kd", "ks", "ke", "ns", "ni", "d", "tr", "illum"];
            let quoted = of_mtl.contains(&lower.as_str());
            return self.doubts.add("outside", line, || {
                let before = if quoted { format!("`{}`", shown(word)) } else { "this".to_owned() };
                format!("expected `newmtl` before {before}: it is not used")
            });
        };
        match lower.as_str() {
            "kd" | "ks" | "ke" => self.colour(line, &lower, rest),
            "ns" => self.exponent(line, rest),
            _ => {
                let value = rest.split_whitespace().last().and_then(number);
                if lower == "map_kd" {
                    entry.said.map_kd = true;
                }
                if lower == "illum" {
                    entry.said.no_lobe = match value {
                        Some(0.0) => Some((line, 0)),
                        Some(1.0) => Some((line, 1)),
                        _ => None,
                    };
                }
                if let Some(kind) = unsupported_kind(&lower, word, value) {
                    self.doubts.unsupported(&kind, line);
                }
            }
        }
    }

    fn begin(&mut self, line: usize, rest: &str) {
        let name = Name::of(rest);
        self.nameless = name.text.is_empty();
        if self.nameless {
            return self.doubts.add("nameless", line, || {
                "newmtl: no name is given, so no face can have this material".to_owned()
            });
        }
        self.kept.push_str(&format!("newmtl {}\n", self.entries.len()));
        let said = Said::default();
        self.entries.push(Entry { name, line, kd: None, ks: None, ke: None, ns: None, said });
    }

    /// Kd, Ks or Ke: three numbers, or one that counts for all three.
    fn colour(&mut self, line: usize, word: &str, rest: &str) {
        let (name, instead) = match word {
            "kd" => ("Kd", "0.5 0.5 0.5 is used"),
            "ks" => ("Ks", "there is no specular lobe"),
            _ => ("Ke", "nothing is emitted"),
        };
        let values = match three(rest) {
            Ok((values, more)) => {
                if more {
                    self.doubts.add(&format!("{name} more"), line, || {
                        format!("{name}: expected {COLOUR}: the first three are used")
                    });
                }
                self.clamped(line, name, values)
            }
            Err(MtlFault::Unsupported) => {
                let kind = format!("`{name}` by a spectrum or CIE XYZ");
                self.doubts.unsupported(&kind, line);
                None
            }
            Err(MtlFault::Not(what)) => {
                self.doubts.add(&format!("{name} fault"), line, || {
                    format!("{name}: expected {COLOUR}, {what}: {instead}")
                });
                None
            }
        };
        let Some(entry) = self.entries.last_mut() else { return };
        match values {
            Some([r, g, b]) => {
                let number = ["Kd", "Ks", "Ke"].iter().position(|known| *known == name);
                entry.given(number.unwrap_or_default(), name, line, self.doubts);
                written(writeln!(self.kept, "{name} {r:e} {g:e} {b:e}"));
                entry.said.bad_kd &= name != "Kd";
            }
            None => entry.said.bad_kd |= name == "Kd",
        }
    }

    /// The nearest colour that can be; none for what is no number.
    fn clamped(&mut self, line: usize, name: &str, values: [f64; 3]) -> Option<[f64; 3]> {
        let light = name == "Ke";
        let most = if light { Material::MAX_EMISSION } else { 1.0 };
        let given = || values.map(plain::number).join(" ");
        if values.iter().any(|x| x.is_nan()) || (light && values.contains(&f64::INFINITY)) {
            let instead = match name {
                "Kd" => "0.5 0.5 0.5 is used",
                "Ks" => "there is no specular lobe",
                _ => "nothing is emitted",
            };
            self.doubts.add(&format!("{name} not finite"), line, || {
                format!("{name} must be finite, not {}: {instead}", given())
            });
            return None;
        }
        let near = values.map(|x| x.clamp(0.0, most));
        if near != values {
            let range = if light { "from 0 to 1e18" } else { "from 0 to 1" };
            self.doubts.add(&format!("{name} clamped"), line, || {
                format!("{name} must be {range}, not {}: it is clamped", given())
            });
        }
        Some(near)
    }

    /// Ns: one number.
    fn exponent(&mut self, line: usize, rest: &str) {
        let mut tokens = rest.split_whitespace();
        let first = tokens.next();
        let value = match first.and_then(number).filter(|x| !x.is_nan()) {
            Some(value) => value,
            None => {
                let token = first.map_or("nothing".to_owned(), |t| format!("`{}`", shown(t)));
                return self.doubts.add("Ns fault", line, || {
                    format!("Ns: expected one number, not {token}: {DEFAULT_NS} is used")
                });
            }
        };
        if tokens.next().is_some() {
            self.doubts
                .add("Ns more", line, || "Ns: expected one number: the first is used".to_owned());
        }
        let [least, most] = Roughness::EXPONENT;
        let near = value.clamp(least, most);
        if near != value {
            self.doubts.add("Ns clamped", line, || {
                format!("Ns must be from {least} to {most}, not {value}: it is clamped")
            });
        }
        if let Some(entry) = self.entries.last_mut() {
            entry.given(3, "Ns", line, self.doubts);
        }
        written(writeln!(self.kept, "Ns {near:e}"));
    }

    fn finish(mut self) -> Vec<Entry> {
        match tobj::load_mtl_buf(&mut self.kept.as_bytes()) {
            Ok((materials, _)) => {
                for (entry, raw) in self.entries.iter_mut().zip(materials) {
                    (entry.kd, entry.ks, entry.ke) = (raw.diffuse, raw.specular, raw.emissive);
                    entry.ns = raw.shininess;
                }
            }
            Err(e) => {
                self.doubts.add("refused", 1, || format!("the MTL reader refuses this file: {e}"));
                self.entries.clear();
            }
        }
        self.entries
    }
}

impl Entry {
    fn given(&mut self, number: usize, name: &str, line: usize, doubts: &mut Doubts) {
        if std::mem::replace(&mut self.said.given[number], true) {
            doubts.add(&format!("{name} again"), line, || {
                format!("{name} is given again for the same material; this one counts")
            });
        }
    }

    /// True when both describe the same surface.
    pub(super) fn same_surface(&self, other: &Entry) -> bool {
        let numbers = |e: &Entry| (e.kd, e.ks, e.ke, e.ns);
        let said = |e: &Entry| (e.said.bad_kd, e.said.map_kd, e.said.no_lobe.map(|s| s.1));
        numbers(self) == numbers(other) && said(self) == said(other)
    }

    /// The material, with what is not given filled in.
    pub(super) fn material(&self, doubts: &mut Doubts, log: &Log) -> Result<Material, ReadError> {
        let name = shown(&self.name.text);
        let mut ks = self.ks.unwrap_or_default();
        let kd = self.kd.unwrap_or_else(|| {
            let other = self.ks.is_some() || self.ke.is_some();
            let (kd, why) = match self.said {
                Said { bad_kd: true, .. } => return [0.5; 3],
                Said { map_kd: true, .. } => (0.5, "has map_Kd and no Kd"),
                _ if other => (0.0, "has no Kd"),
                _ => (0.5, "has no Kd"),
            };
            doubts.add_one(&format!("{why} {kd}"), self.line, "materials", || {
                format!("`{name}` {why}: {kd} {kd} {kd} is used")
            });
            [kd; 3]
        });
        if let (Some((line, illum)), true) = (self.said.no_lobe, ks != [0.0; 3]) {
            ks = [0.0; 3];
            doubts.add_one("no lobe", line, "materials", || {
                format!("`{name}` has illum {illum}, so no specular lobe: its Ks is not used")
            });
        }
        let exponent = self.ns.unwrap_or_else(|| {
            if ks != [0.0; 3] {
                doubts.add_one("no Ns", self.line, "materials", || {
                    format!("`{name}` has Ks but no Ns: an exponent of {DEFAULT_NS} is used")
                });
            }
            DEFAULT_NS
        });
        Material::reflecting(readable(&self.name.text), kd, ks, exponent)
            .and_then(|m| m.emitting(self.ke.unwrap_or_default()))
            .map_err(|e| log.error(Some(self.line), e.to_string()))
    }
}

const COLOUR: &str = "three numbers, or one for all three channels";

/// Why there is no colour.
enum MtlFault {
    Unsupported,
    Not(String),
}

/// Three numbers, or one that counts for all three, and whether more follow.
fn three(rest: &str) -> Result<([f64; 3], bool), MtlFault> {
    let tokens: Vec<&str> = rest.split_whitespace().take(4).collect();
    let first = tokens.first().map(|t| t.to_ascii_lowercase());
    if matches!(first.as_deref(), Some("spectral" | "xyz")) {
        return Err(MtlFault::Unsupported);
    }
    let mut values = Vec::with_capacity(3);
    for token in tokens.iter().take(3) {
        match number(token) {
            Some(value) => values.push(value),
            None => return Err(MtlFault::Not(format!("not `{}`", shown(token)))),
        }
    }
    match values.as_slice() {
        &[x] => Ok(([x; 3], false)),
        &[r, g, b] => Ok(([r, g, b], tokens.len() > 3)),
        found => Err(MtlFault::Not(format!("found {}", found.len()))),
    }
}

/// Writing into a string cannot fail.
fn written(result: std::fmt::Result) {
    debug_assert!(result.is_ok());
}

/// What to call a statement that asks for something that is not done; `None` if it asks nothing.
fn unsupported_kind(lower: &str, word: &str, value: Option<f64>) -> Option<String> {
    match lower {
        // There is no ambient light, and Ni without transparency changes nothing.
        "ka" | "ni" => None,
        "d" if value == Some(1.0) => None,
        "tr" if value == Some(0.0) => None,
        "d" | "tr" => Some(format!("transparency (`{word}`)")),
        // Constant colour, diffuse, and diffuse with highlights.
        "illum" if value.is_some_and(|i| [0.0, 1.0, 2.0].contains(&i)) => None,
        "illum" => Some("`illum` other than 0, 1 and 2".to_owned()),
        _ => Some(format!("`{}`", shown(word))),
    }
}
