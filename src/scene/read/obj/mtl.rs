//! MTL: the materials of an OBJ file.
//!
//! Kd, Ks, Ns (the Phong exponent a_p) and Ke (emission) are used. `tobj` panics on the legal
//! shorthand `Kd 0.5` and drops a whole file for one bad line, so lines are checked here first.

use super::join_continued;
use crate::scene::read::ReadError;
use crate::scene::read::files::Files;
use crate::scene::read::log::{Log, Unsupported};
use crate::scene::read::text::{decode, lines, shown};
use crate::scene::{Material, MaterialError};
use std::collections::HashMap;
use std::path::PathBuf;

/// The exponent of a shiny surface whose file gives none.
const DEFAULT_NS: f64 = 10.0;

/// All materials that the MTL files of a model define, by name.
pub(super) struct Library(HashMap<String, Entry>);

struct Entry {
    file: PathBuf,
    lines: Lines,
    raw: tobj::Material,
}

/// Where a material's statements stand.
#[derive(Clone, Copy, Default)]
struct Lines {
    newmtl: usize,
    kd: usize,
    ks: usize,
    ns: usize,
    ke: usize,
}

impl Library {
    /// Reads these files; one that cannot be found is a warning.
    pub(super) fn read(
        libraries: &[(usize, String)],
        files: &dyn Files,
        log: &mut Log,
    ) -> Result<Library, ReadError> {
        let mut all = Library(HashMap::new());
        for (line, names) in libraries {
            // A name may hold spaces, and a line several names.
            match files.find(names) {
                Ok((path, bytes)) => all.add(path, &bytes, log)?,
                Err(_) if names.contains(char::is_whitespace) => {
                    for name in names.split_whitespace() {
                        match files.find(name) {
                            Ok((path, bytes)) => all.add(path, &bytes, log)?,
                            Err(e) => cannot_read(name, *line, &e, log),
                        }
                    }
                }
                Err(e) => cannot_read(names, *line, &e, log),
            }
        }
        Ok(all)
    }

    fn add(&mut self, path: PathBuf, bytes: &[u8], log: &mut Log) -> Result<(), ReadError> {
        log.within(path.clone(), |log| {
            let (text, places) = checked(bytes, log)?;
            let (materials, _) = tobj::load_mtl_buf(&mut text.as_bytes())
                .map_err(|e| log.error(None, format!("the MTL reader refuses this file: {e}")))?;
            for (raw, lines) in materials.into_iter().zip(places) {
                let name = raw.name.clone();
                let entry = Entry { file: path.clone(), lines, raw };
                if self.0.insert(name.clone(), entry).is_some() {
                    let text = format!("`{}` is defined again; this one counts", shown(&name));
                    log.warn(Some(lines.newmtl), text);
                }
            }
            Ok(())
        })
    }

    /// The material of this name, checked; `None` if no file defines it.
    pub(super) fn material(
        &self,
        name: &str,
        log: &mut Log,
    ) -> Result<Option<Material>, ReadError> {
        let Some(entry) = self.0.get(name) else { return Ok(None) };
        log.within(entry.file.clone(), |log| entry.material(log).map(Some))
    }
}

fn cannot_read(name: &str, line: usize, error: &std::io::Error, log: &mut Log) {
    log.warn(Some(line), format!("mtllib: cannot read {}: {error}", shown(name)));
}

impl Entry {
    fn material(&self, log: &mut Log) -> Result<Material, ReadError> {
        let (raw, lines) = (&self.raw, self.lines);
        let name = shown(&raw.name);
        let ks = raw.specular.unwrap_or_default();
        let kd = raw.diffuse.unwrap_or_else(|| {
            let other = raw.specular.is_some() || raw.emissive.is_some();
            let kd = if other { 0.0 } else { 0.5 };
            log.warn(Some(lines.newmtl), format!("`{name}` has no Kd: {kd} {kd} {kd} is used"));
            [kd; 3]
        });
        let exponent = raw.shininess.unwrap_or_else(|| {
            if ks != [0.0; 3] {
                let text =
                    format!("`{name}` has Ks but no Ns: an exponent of {DEFAULT_NS} is used");
                log.warn(Some(lines.newmtl), text);
            }
            DEFAULT_NS
        });
        Material::reflecting(raw.name.clone(), kd, ks, exponent)
            .and_then(|m| m.emitting(raw.emissive.unwrap_or_default()))
            .map_err(|e| {
                let (line, what) = match &e {
                    MaterialError::Reflectance { name: "Kd", .. } => (lines.kd, ""),
                    MaterialError::Reflectance { .. } => (lines.ks, ""),
                    MaterialError::Roughness(_) => (lines.ns, "Ns: "),
                    MaterialError::Emission(_) => (lines.ke, "Ke: "),
                };
                log.error(Some(line), format!("{what}{e}"))
            })
    }
}

/// The statements that are used, each known to be well formed, and their lines.
fn checked(bytes: &[u8], log: &mut Log) -> Result<(String, Vec<Lines>), ReadError> {
    let text = join_continued(&decode(bytes, log)?);
    let mut kept = String::new();
    let mut places: Vec<Lines> = Vec::new();
    let mut unsupported = Unsupported::default();
    for (number, line) in lines(&text) {
        let line = line.trim();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim_start();
        if word.is_empty() || word.starts_with('#') {
            continue;
        }
        let error = |text: String| log.error(Some(number), format!("{word}: {text}"));
        if word == "newmtl" {
            if rest.is_empty() {
                return Err(error("expected the name of a material".to_owned()));
            }
            places.push(Lines { newmtl: number, ..Lines::default() });
            kept.extend(["newmtl ", rest, "\n"]);
            continue;
        }
        let Some(place) = places.last_mut() else {
            return Err(
                log.error(Some(number), format!("expected `newmtl` before `{}`", shown(word)))
            );
        };
        let slot = match word {
            "Kd" => &mut place.kd,
            "Ks" => &mut place.ks,
            "Ns" => &mut place.ns,
            "Ke" => &mut place.ke,
            _ => {
                if let Some(kind) = unsupported_kind(word, rest) {
                    unsupported.add(&kind, number);
                }
                continue;
            }
        };
        if matches!(rest.split_whitespace().next(), Some("spectral" | "xyz")) {
            unsupported.add(&format!("`{word}` by a spectrum or CIE XYZ"), number);
            continue;
        }
        let values = numbers(rest, word != "Ns").map_err(error)?;
        *slot = number;
        kept.extend([word, " ", &values, "\n"]);
    }
    unsupported.report(log);
    Ok((kept, places))
}

/// Three numbers, or one that counts for all three; or just one.
fn numbers(rest: &str, colour: bool) -> Result<String, String> {
    let tokens: Vec<&str> = rest.split_whitespace().take(4).collect();
    let wanted = if colour { "three numbers, or one for all three channels" } else { "one number" };
    let wrong = |t: &&&str| t.parse::<f64>().is_err();
    match (tokens.iter().find(wrong), tokens.as_slice()) {
        (Some(token), _) => Err(format!("expected {wanted}, not `{}`", shown(token))),
        (None, [one]) if colour => Ok(format!("{one} {one} {one}")),
        (None, [_, _, _]) if colour => Ok(tokens.join(" ")),
        (None, [one]) => Ok((*one).to_owned()),
        (None, found) => Err(format!("expected {wanted}, found {}", found.len())),
    }
}

/// What to call a statement that asks for something that is not done; `None` if it asks nothing.
fn unsupported_kind(word: &str, rest: &str) -> Option<String> {
    let value = rest.split_whitespace().last().and_then(|t| t.parse::<f64>().ok());
    match word {
        // There is no ambient light, and Ni without transparency changes nothing.
        "Ka" | "Ni" => None,
        "d" if value == Some(1.0) => None,
        "Tr" if value == Some(0.0) => None,
        "d" | "Tr" => Some(format!("transparency (`{word}`)")),
        // Constant colour, diffuse, and diffuse with highlights.
        "illum" if value.is_some_and(|i| (0.0..=2.0).contains(&i)) => None,
        "illum" => Some("`illum` other than 0, 1 and 2".to_owned()),
        _ => Some(format!("`{}`", shown(word))),
    }
}
