//! What stands on a contact sheet and in its files.

use super::{Sheet, TracedCell, TracedSheet};
use crate::brdf::Roughness;
use crate::picture::sheet::{Cell, ContactSheet, draw};
use crate::picture::{Codes, Format, Part, Picture, SaveError, Tone, write_codes, write_parts};
use crate::progressive::{Recipe, Snapshot};
use std::path::Path;

impl Sheet {
    /// What a cell is called in an OpenEXR file: "ggx_alpha_0p1", and "ggx_ap_98" where the roughness was
    /// given as a Phong exponent. A decimal point is written `p`, for many programs know no other characters
    /// in such a name than letters, digits and underscores.
    pub fn name(&self, cell: usize) -> String {
        let Some((model, roughness)) = self.of(cell) else { return String::new() };
        let number = match self.by_exponent {
            false => format!("alpha_{}", roughness.alpha()),
            true => format!("ap_{}", roughness.exponent()),
        };
        format!("{}_{}", model.name(), number.replace('.', "p"))
    }

    /// A cell as a person calls it: "GGX, alpha 0.1".
    pub fn title(&self, cell: usize) -> String {
        let Some((model, roughness)) = self.of(cell) else { return String::new() };
        let [first, _] = self.headings(roughness);
        format!("{}, {first}", model.title())
    }

    /// The words and places of a sheet with these pictures and cells; of one that has none yet without.
    pub(super) fn laid_out<'a>(
        &self,
        cells: &'a [Option<(Picture, &TracedCell)>],
    ) -> ContactSheet<'a> {
        let cell = |i: usize| match cells.get(i).and_then(Option::as_ref) {
            Some((picture, cell)) => {
                Cell { picture: Some(picture), label: self.label(cell), warns: !cell.reached }
            }
            None => Cell { picture: None, label: vec!["not traced".to_owned()], warns: false },
        };
        ContactSheet {
            title: self.params.scene.name().to_owned(),
            remarks: self.remarks(),
            rows: self.models.iter().map(|model| model.title().to_owned()).collect(),
            columns: self.roughnesses.iter().map(|&r| self.headings(r).to_vec()).collect(),
            size: self.params.size,
            cells: (0..self.len()).map(cell).collect(),
        }
    }

    /// The number first by which the columns are called.
    fn headings(&self, roughness: Roughness) -> [String; 2] {
        let alpha = format!("alpha {}", digits(roughness.alpha()));
        let exponent = format!("a_p {}", digits(roughness.exponent()));
        if self.by_exponent { [exponent, alpha] } else { [alpha, exponent] }
    }

    fn remarks(&self) -> Vec<String> {
        let name = |&id: &u32| self.params.materials.get(id as usize).map(|m| m.name.as_str());
        let named: Vec<&str> = self.materials.iter().filter_map(name).collect();
        let whose = match named.as_slice() {
            [] => "all materials".to_owned(),
            [first, others @ ..] if others.iter().all(|name| name == first) => first.to_string(),
            all => all.join(", "),
        };
        let mut remarks = vec![format!(
            "Roughness of {whose}. Each picture has the passes that a relative error of {} takes (upper \
             95 % limit), and the same random numbers.",
            self.wanted()
        )];
        if let Some(erratum) = self.params.erratum {
            remarks.push(format!("Wrong on purpose: {erratum}"));
        }
        remarks
    }

    /// The error that was wished for, as it was.
    fn wanted(&self) -> String {
        format!("{} %", digits(100.0 * self.error))
    }

    fn label(&self, cell: &TracedCell) -> Vec<String> {
        let Snapshot { passes, seconds, error, .. } = &cell.snapshot;
        let plural = if *passes == 1 { "pass" } else { "passes" };
        let passes = format!("{passes} {plural}");
        let wanted = self.wanted();
        let error = match error.map(|e| percent(e.relative.value)) {
            Some(error) if cell.reached => format!("error {error}"),
            Some(error) => format!("error {error}, not {wanted}"),
            None => format!("error not known, not {wanted}"),
        };
        let stopped = if cell.stopped { "stopped at " } else { "" };
        vec![format!("{stopped}{passes}"), error, duration(*seconds)]
    }
}

impl TracedSheet {
    /// The labelled sheet as it is seen.
    pub fn draw(&self, tone: Tone) -> Codes {
        draw(&self.drawn(tone, &self.pictures()), tone)
    }

    /// Writes it: all of it with its labels to a `.png` file, or each cell's radiance, untouched by `tone`, to
    /// an `.exr` file as a part called by [`Sheet::name`], with its recipe. Cells that were not traced are
    /// left out there.
    pub fn save(&self, path: &Path, tone: Tone) -> Result<(), SaveError> {
        let pictures = self.pictures();
        match Format::of(path)? {
            Format::Png => {
                let sheet = self.drawn(tone, &pictures);
                write_codes(path, &draw(&sheet, tone), &described(&sheet))
            }
            Format::Exr => {
                let failed = |e: serde_json::Error| SaveError::Write {
                    path: path.to_path_buf(),
                    source: e.into(),
                };
                let mut parts = Vec::new();
                for (i, cell) in pictures.iter().enumerate() {
                    let (Some((picture, cell)), Some(params)) = (cell, self.sheet.cell(i)) else {
                        continue;
                    };
                    let recipe = Recipe::new(&params, &cell.snapshot).text().map_err(failed)?;
                    parts.push(Part { name: self.sheet.name(i), picture, recipe });
                }
                write_parts(path, &parts)
            }
        }
    }

    fn pictures(&self) -> Vec<Option<(Picture, &TracedCell)>> {
        let cells = self.cells.iter().map(Option::as_ref);
        cells.map(|cell| cell.map(|cell| (cell.snapshot.mean(), cell))).collect()
    }

    fn drawn<'a>(
        &self,
        tone: Tone,
        cells: &'a [Option<(Picture, &'a TracedCell)>],
    ) -> ContactSheet<'a> {
        let mut sheet = self.sheet.laid_out(cells);
        sheet.remarks.push(format!(
            "Seed {}, curve {}, exposure {} EV, burnish {}.",
            self.sheet.params.seed,
            tone.curve.title(),
            tone.exposure,
            env!("CARGO_PKG_VERSION")
        ));
        sheet
    }
}

/// The sheet's words, a line for each cell.
fn described(sheet: &ContactSheet) -> String {
    let mut lines = vec![sheet.title.clone()];
    lines.extend(sheet.remarks.iter().cloned());
    for (row, cells) in sheet.rows.iter().zip(sheet.cells.chunks(sheet.columns.len().max(1))) {
        for (column, cell) in sheet.columns.iter().zip(cells) {
            lines.push(format!("{row}, {}: {}", column.join(", "), cell.label.join(", ")));
        }
    }
    lines.join("\n")
}

/// Four significant digits, without zeros at their end.
fn digits(x: f64) -> String {
    let places =
        if x.abs() >= 1e-9 { (3.0 - x.abs().log10().floor()).clamp(0.0, 9.0) } else { 0.0 };
    let text = format!("{x:.*}", places as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// "2.4 %", "0.86 %", "12 %"
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    // Two digits, after rounding too.
    let places = match percent {
        p if p < 0.995 => 2,
        p if p < 9.95 => 1,
        _ => 0,
    };
    format!("{percent:.places$} %")
}

/// "0.52 s", "12.3 s", "123 s"
fn duration(seconds: f64) -> String {
    let places = match seconds {
        s if s < 9.995 => 2,
        s if s < 99.95 => 1,
        _ => 0,
    };
    format!("{seconds:.places$} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_honest() {
        for (x, text) in [
            (0.1, "0.1"),
            (0.05, "0.05"),
            (0.141_421_356, "0.1414"),
            (1.125, "1.125"),
            (798.0, "798"),
            (48.000_000_000_1, "48"),
            (199_999_998.0, "199999998"),
            (0.0, "0"),
        ] {
            assert_eq!(digits(x), text);
        }
        assert_eq!([0.03, 0.0086, 0.123].map(percent), ["3.0 %", "0.86 %", "12 %"]);
        assert_eq!([0.00997, 0.0997].map(percent), ["1.0 %", "10 %"]);
        assert_eq!([0.523, 12.34, 123.4].map(duration), ["0.52 s", "12.3 s", "123 s"]);
    }
}
