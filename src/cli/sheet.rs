//! `burnish sheet`: every model with every roughness in one picture.

use super::outputs::{self, Failures};
use super::progress::{self, Goal, Progress};
use super::settings::{Common, Display};
use super::talk::{detail, note, say, warning};
use super::values::{self, Chosen};
use super::{Failure, interrupt, pictures, scene};
use burnish::brdf::{Model, Roughness};
use burnish::picture::Format;
use burnish::plain;
use burnish::progressive::{Params, Session, Sheet, SheetProgress, TracedSheet};
use burnish::scene::{Material, MaterialId, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Makes a contact sheet: a row for each model, a column for each roughness, and every picture traced to
/// the same error.
///
/// All pictures have the same random numbers. Ctrl-C ends it early and still writes what is done; a second
/// one quits at once.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish sheet -o sheet.png                      the built-in scene: sheet.png and sheet.exr
  burnish sheet table.scn -o table.png --model beckmann,ggx --alpha 0.1,0.2,0.4 --size 480x360
  burnish sheet table.scn -o gold.png --material gold --error 1% --max-passes 20000
  burnish compare sheet.exr sheet.exr --part ggx_alpha_0p1 --reference-part beckmann_alpha_0p1
  burnish info sheet.exr --part ggx_alpha_0p1     how that cell was made")]
pub(super) struct Args {
    /// Scene to render: a .scn, .obj or .ply file, or the name of a shipped one. The built-in scene
    /// without one.
    scene: Option<PathBuf>,
    /// The sheet. Two files are written under this name, which ends in .png or .exr: the labelled sheet as
    /// .png, 8-bit sRGB, and the radiance of its pictures as .exr, linear 32-bit float, untouched by
    /// --exposure and --tone. There each picture is a part of its own, called by its model and roughness,
    /// p being the decimal point: ggx_alpha_0p1.
    #[arg(short, long = "output", value_name = "FILE", value_parser = values::picture)]
    output: PathBuf,
    /// The rows: phong, beckmann, ggx, some of them with commas between, or all.
    #[arg(long = "model", value_name = "MODELS", default_value = "all",
          value_parser = values::chosen(Model::ALL, Model::name))]
    models: Chosen<Model>,
    /// The columns: roughness alphas with commas between, each 0.0001 to 1.
    #[arg(long, value_name = "A,...", default_value = "0.05,0.1,0.2,0.4,0.8",
          value_parser = values::alphas)]
    alpha: Chosen<Roughness>,
    /// The columns as Phong exponents a_p instead, each 0 to 199999998; alpha = sqrt(2 / (a_p + 2)).
    #[arg(long, value_name = "N,...", conflicts_with = "alpha", value_parser = values::exponents)]
    exponent: Option<Chosen<Roughness>>,
    /// The material that is given the columns' roughness, by its name as `burnish info SCENE` shows it;
    /// the others keep their own. Without it all are.
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Relative error that each picture has, as a part of one or in percent (0.02, 2%): the upper 95 %
    /// limit of sqrt(mean((x - r)^2 / (r^2 + 0.01))), r being the truth. It is looked at from 64 passes
    /// on; a picture that has less then is traced again to as few passes as have the error. Only one that
    /// has less after its first pass stays better.
    #[arg(long, value_name = "E", default_value = "3%", value_parser = values::error)]
    error: f64,
    /// Most passes of a picture. One that needs more says in its label that it has not the error.
    #[arg(long, value_name = "N", default_value_t = Sheet::MOST_PASSES,
          value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    max_passes: u64,
    /// Width and height of each picture in pixels. Without it the scene's, made smaller to be within
    /// 320x240.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    common: Common,
    /// Worker threads; 0 is one a core. The pictures do not depend on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    #[command(flatten)]
    display: Display,
}

/// Traces the sheet and writes it.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let files = args.files();
    let given = args.scene.as_deref();
    // Known now, not after an hour.
    outputs::are_no_inputs(&files, given)?;
    outputs::can_be_written(&files)?;
    interrupt::listen()?;
    let loaded = scene::load_for(given, args.common.isa, args.common.up)?;
    let read = loaded.scene.source().files.iter().map(|file| file.path.as_path());
    outputs::are_no_inputs(&files, read)?;
    let sheet = args.sheet(&loaded.scene)?;
    sheet.check().map_err(Failure::new)?;
    if let Some(erratum) = sheet.params.erratum {
        warning(format_args!("this sheet is wrong on purpose: {erratum}"));
    }
    let [width, height] = sheet.params.size;
    detail(format_args!(
        "{} pictures of {width}x{height}, seed {}, {} worker threads",
        sheet.len(),
        sheet.params.seed,
        values::worker_count(args.threads)
    ));
    let traced = trace(&sheet, args.threads)?;
    if traced.cells.iter().all(Option::is_none) {
        return Err(Failure::new("stopped before the first sample: nothing is written"));
    }
    let mut failures = Failures::default();
    write(&traced, args, &files, &mut failures);
    tell(&traced, &mut failures);
    failures.finish()
}

/// Traces it and says how far it is.
fn trace(sheet: &Sheet, threads: usize) -> Result<TracedSheet, Failure> {
    let mut shown: Option<Progress> = None;
    let mut has_samples = None;
    let watch = |SheetProgress { cell, snapshot, is_done }: SheetProgress| {
        let shown_now = shown.get_or_insert_with(|| {
            say(format_args!("{} of {}: {}", cell + 1, sheet.len(), sheet.title(cell)));
            Progress::start(Goal::Error(sheet.rule()))
        });
        if let Some(snapshot) = snapshot {
            shown_now.show(snapshot);
            if snapshot.passes > 0 && has_samples.replace(cell) != Some(cell) {
                detail("  every pixel has a sample");
            }
            if is_done {
                shown = None;
                let (passes, error) =
                    (progress::passes(snapshot.passes), progress::error(snapshot));
                say(format_args!("  {passes} in {:.2} s{error}", snapshot.seconds));
            }
        }
        !interrupt::came()
    };
    sheet.trace(threads, watch).map_err(Failure::new)
}

fn write(traced: &TracedSheet, args: &Args, files: &[PathBuf], failures: &mut Failures) {
    for path in files {
        match traced.save(path, args.display.tone()) {
            Ok(()) => detail(format_args!("written: {}", plain::path(path))),
            Err(e) => {
                let again = |place: &Path| traced.save(place, args.display.tone());
                failures.add(format_args!("{e}; {}", pictures::rescue(path, again)));
            }
        }
    }
}

/// What there is to know about a sheet that is written.
fn tell(traced: &TracedSheet, failures: &mut Failures) {
    let cells = || traced.cells.iter().flatten();
    let capped = cells().filter(|cell| !cell.reached && !cell.stopped).count();
    if capped > 0 {
        note(format_args!(
            "{capped} of {} pictures have not the error that was asked for after {}: their labels say \
             so; --max-passes gives them more",
            traced.sheet.len(),
            progress::passes(traced.sheet.most_passes)
        ));
    }
    let nonfinite: u64 = cells().map(|cell| cell.snapshot.counts.nonfinite).sum();
    if nonfinite > 0 {
        warning(format_args!(
            "{nonfinite} samples were NaN or infinite and are left out; their pixels are wrong"
        ));
    }
    let (done, of) = (traced.done(), traced.sheet.len());
    if done < of {
        let left = of - done;
        failures.add(format_args!(
            "stopped by a signal: {left} of {of} pictures are not done; what there is of them is written"
        ));
    }
}

impl Args {
    /// The labelled sheet and the pictures' radiance: one as it was named, the other beside it.
    fn files(&self) -> [PathBuf; 2] {
        let own = &self.output;
        match Format::of(own) {
            Ok(Format::Exr) => [own.with_extension("png"), own.clone()],
            _ => [own.clone(), own.with_extension("exr")],
        }
    }

    fn sheet(&self, scene: &Arc<Scene>) -> Result<Sheet, Failure> {
        let mut params = self.common.params(scene, Model::Ggx);
        params.size = self.size.unwrap_or(Sheet::fitted(params.size));
        let materials = match self.material.as_deref() {
            Some(name) => named(name, &params)?,
            None => Vec::new(),
        };
        if materials.is_empty() && !params.materials.iter().any(is_specular) {
            note("no material has a specular lobe (Ks = 0): models and roughness have no effect");
        }
        Ok(Sheet {
            models: self.models.0.clone(),
            roughnesses: self.exponent.as_ref().unwrap_or(&self.alpha).0.clone(),
            by_exponent: self.exponent.is_some(),
            materials,
            error: self.error,
            most_passes: self.max_passes,
            ..Sheet::new(params)
        })
    }
}

/// The materials of this name, in any case if there is none in this.
fn named(name: &str, params: &Params) -> Result<Vec<MaterialId>, Failure> {
    let find = |equal: fn(&str, &str) -> bool| -> Vec<MaterialId> {
        let all = (0..).zip(params.materials.iter());
        all.filter(|(_, material)| equal(&material.name, name)).map(|(id, _)| id).collect()
    };
    let mut found = find(|a, b| a == b);
    if found.is_empty() {
        found = find(str::eq_ignore_ascii_case);
    }
    let of = |id: &MaterialId| &params.materials[*id as usize];
    if found.is_empty() {
        let mut names: Vec<&str> = params.materials.iter().map(|m| m.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let names = plain::line(&names.join(", "));
        return Err(Failure::new(format_args!(
            "--material {}: the scene has no such material; it has {names}",
            plain::line(name)
        )));
    }
    if !found.iter().map(of).any(is_specular) {
        return Err(Failure::new(format_args!(
            "--material {}: it has no specular lobe (Ks = 0), and roughness has no effect on it",
            plain::line(name)
        )));
    }
    Ok(found)
}

fn is_specular(material: &Material) -> bool {
    material.ks.iter().any(|&c| c > 0.0)
}
