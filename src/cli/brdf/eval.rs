//! `--eval`: every factor of the BRDF for given directions.

use super::roughness;
use crate::cli::Failure;
use burnish::brdf::{BrdfParams, Evaluation, Microfacet, Model, ModelVisitor, Terms};
use burnish::limits::{Bytes, TABLE_BYTES};
use burnish::math::{Rgb, V3};
use burnish::plain;
use csv::{Position, StringRecord};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// What a row must have.
const INPUTS: [&str; 10] =
    ["model", "param", "wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z", "Kd", "Ks"];
const OUTPUTS: [&str; 12] = [
    "D",
    "G1i",
    "G1o",
    "G",
    "F",
    "spec",
    "brdf",
    "fcos",
    "pdf_diffuse",
    "pdf_spec",
    "p_spec",
    "pdf",
];

/// Reads rows and prints each with what it gives. Floats have as many digits as they need.
pub(super) fn run(path: &Path, out: &mut impl Write) -> Result<(), Failure> {
    let text = read(path)
        .map_err(|e| Failure::new(format_args!("{}: cannot be read: {e}", plain::path(path))))?;
    answer(&text, path, out)
}

/// The same for the text of a file of this name.
fn answer(text: &str, path: &Path, out: &mut impl Write) -> Result<(), Failure> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let at = |position: Option<&Position>, why: String| {
        let line = position.map_or(1, |p| line(text, p));
        Failure::new(format_args!("{}:{line}: {why}", plain::path(path)))
    };
    let broken = |e: csv::Error| at(e.position(), reason(&e));

    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = columns(reader.headers().map_err(broken)?).map_err(|why| at(None, why))?;
    writeln!(out, "{},{}", INPUTS.join(","), OUTPUTS.join(","))?;
    for record in reader.into_records() {
        let record = record.map_err(broken)?;
        let row = Row::read(&record, &columns).map_err(|why| at(record.position(), why))?;
        let inputs = columns.map(|c| record.get(c).unwrap_or_default().trim());
        write!(out, "{}", inputs.join(","))?;
        for value in row.model.visit(&row) {
            write!(out, ",{value:e}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The whole table, of a file or of a pipe, which need not end.
fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(TABLE_BYTES + 1).read_to_string(&mut text)?;
    if text.len() as u64 > TABLE_BYTES {
        let why = format!("it is larger than {}", Bytes(TABLE_BYTES));
        return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
    }
    Ok(text)
}

/// The line of a record, counted from 1. Positions point before the empty lines that were skipped.
fn line(text: &str, position: &Position) -> usize {
    let from = (position.byte() as usize).min(text.len());
    let (before, after) = text.as_bytes().split_at(from);
    let empty = after.iter().take_while(|&&b| b == b'\n' || b == b'\r');
    1 + before.iter().chain(empty).filter(|&&b| b == b'\n').count()
}

fn reason(e: &csv::Error) -> String {
    match e.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("expected {expected_len} columns as in the header, not {len}")
        }
        _ => e.to_string(),
    }
}

/// Where each of `INPUTS` is.
fn columns(header: &StringRecord) -> Result<[usize; 10], String> {
    let mut columns = [0; 10];
    for (column, name) in columns.iter_mut().zip(INPUTS) {
        *column = header
            .iter()
            .position(|h| h.trim() == name)
            .ok_or_else(|| format!("there is no column `{name}`; needed: {}", INPUTS.join(", ")))?;
    }
    Ok(columns)
}

/// One question.
struct Row {
    model: Model,
    params: BrdfParams,
    wo: V3,
    wi: V3,
}

impl Row {
    fn read(record: &StringRecord, columns: &[usize; 10]) -> Result<Row, String> {
        let text = |i: usize| record.get(columns[i]).unwrap_or_default().trim();
        let number = |i: usize| {
            let value = text(i).parse().ok().filter(|x: &f64| x.is_finite());
            value.ok_or_else(|| {
                format!("column {}: expected a number, not `{}`", INPUTS[i], plain::start(text(i)))
            })
        };
        let direction = |i: usize| {
            let w = [number(i)?, number(i + 1)?, number(i + 2)?];
            let length = w.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (length - 1.0).abs() > UNIT_WITHIN {
                let names = INPUTS[i..i + 3].join(", ");
                return Err(format!(
                    "columns {names}: expected a unit vector, not one of {length}"
                ));
            }
            Ok(V3::from(w.map(|c| c as f32)))
        };
        let reflectance = |i: usize| {
            let value = number(i)?;
            let valid = (0.0..=1.0).contains(&value);
            let say =
                || format!("column {}: expected a number from 0 to 1, not {value}", INPUTS[i]);
            valid.then_some(Rgb::splat(value as f32)).ok_or_else(say)
        };
        let model = Model::ALL.into_iter().find(|m| m.name() == text(0)).ok_or_else(|| {
            let known = Model::ALL.map(Model::name).join(", ");
            format!("column model: expected one of {known}, not `{}`", plain::start(text(0)))
        })?;
        let roughness = roughness(model, number(1)?).map_err(|e| format!("column param: {e}"))?;
        let params =
            BrdfParams { kd: reflectance(8)?, ks: reflectance(9)?, roughness: roughness.into() };
        Ok(Row { model, params, wi: direction(2)?, wo: direction(5)? })
    }
}

/// How far from 1 a direction's length may be: tables are often printed with few digits.
const UNIT_WITHIN: f64 = 1e-3;

impl ModelVisitor for &Row {
    type Output = [f32; 12];
    /// The values of `OUTPUTS`.
    fn visit<M: Microfacet>(self) -> [f32; 12] {
        let Evaluation { f, pdf } = self.params.eval::<M>(self.wo, self.wi);
        let t: Terms = self.params.terms::<M>(self.wo, self.wi);
        let fcos = f.r * self.wi.z.max(0.0);
        [
            t.d,
            t.g1i,
            t.g1o,
            t.g,
            t.fresnel,
            t.specular,
            f.r,
            fcos,
            t.pdf_diffuse,
            t.pdf_specular,
            t.p_specular,
            pdf,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounded::{EACH, FREE, bounded, is_alone};
    use crate::mutate;

    /// A table and what random changes make of it: an answer for each row, or one line with the
    /// file, its line and what was expected; in a second, and in memory by its length.
    #[test]
    fn broken_tables_are_errors_with_their_line() {
        if !is_alone(concat!(module_path!(), "::broken_tables_are_errors_with_their_line")) {
            return;
        }
        let header = INPUTS.join(",");
        let good = format!(
            "{header}\nggx,0.1,0,0,1,0.6,0,0.8,0.5,0.04\nphong,198,0,0.6,0.8,0,0,1,0.2,0.9\n\
             beckmann,0.3,0.28,0,0.96,-0.6,0,0.8,0,1\n"
        );
        let corpus = include_str!("../../../tests/fuzz/corpus/csv.txt").replace("{H}", &header);
        let mut files = mutate::corpus(&corpus);
        assert!(files.len() >= 60, "{}", files.len());
        files.insert(0, good.into_bytes());
        let words = ["\n", ",", "\"", "nan", "1e999", "\r", "ggx", ";", "\u{feff}", "0.5,"];
        let (mut answered, mut refused) = (0, 0);
        mutate::try_all(&files, 1, &words, 8, |bytes, _| {
            let text = String::from_utf8_lossy(bytes);
            let most = FREE + EACH * bytes.len();
            let answered_by = || {
                let mut out = Vec::new();
                answer(&text, "t.csv".as_ref(), &mut out).map(|()| out)
            };
            match bounded(most, bytes, 8, answered_by) {
                Ok(out) => {
                    answered += 1;
                    assert!(out.len() <= 400 * (2 + text.len()), "{} bytes", out.len());
                }
                Err(Failure(told)) => {
                    refused += 1;
                    let told = plain::lines(&told.unwrap());
                    assert!(mutate::is_fit(&told), "{told:?}");
                    let line = told.strip_prefix("t.csv:").and_then(|rest| rest.split(':').next());
                    let lines = 1 + text.matches(['\n', '\r']).count();
                    let line: usize = line.unwrap().parse().unwrap();
                    assert!((1..=lines).contains(&line), "{told}");
                }
            }
        });
        assert!(answered > 10 && refused > 100, "{answered} answered, {refused} refused");
    }
}
