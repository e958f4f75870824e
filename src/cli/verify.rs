//! `burnish verify`: whether a picture is what its recipe makes.

use super::trace::{End, options, tell, trace};
use super::{Failure, checkpoint, interrupt, print, progress, values};
use burnish::picture::{read_exr, read_recipe};
use burnish::plain;
use burnish::progressive::{Difference, Experiment, ExperimentError, Params, Recipe, Session};
use std::fmt::Display;
use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::time::Instant;

/// Renders a picture again and compares: every sum of an experiment, every mean of another OpenEXR picture
/// with its recipe, to the bit.
///
/// Exit code 0 if they are the same. It takes as long as the render did.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish verify table.exr
  burnish verify merged.exr --scene /scenes/table.scn --threads 8")]
pub(super) struct Args {
    /// OpenEXR file that `render`, `resume` or `merge` has written.
    file: PathBuf,
    /// Where its scene is, if not where it was.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Worker threads; 0 is one a core. The picture does not depend on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
}

/// Renders again and compares.
pub(super) fn run(args: &Args, started: Instant) -> Result<(), Failure> {
    let path = args.file.as_path();
    let about = |text: &dyn Display| Failure::new(format_args!("{}: {text}", plain::path(path)));
    interrupt::listen()?;
    let told = match Experiment::read(path) {
        Ok(experiment) => sums(args, &experiment, started, &about)?,
        Err(ExperimentError::NoSums(_)) => means(args, started, &about)?,
        Err(e) => return Err(Failure::new(e)),
    };
    print(format_args!("{}: {told}", plain::path(path)))
}

/// An error about the file.
type About<'a> = &'a dyn Fn(&dyn Display) -> Failure;

const WITHIN: &str = "it ended within a pass, so that its recipe does not say all";

/// Every sum of an experiment.
fn sums(
    args: &Args,
    experiment: &Experiment,
    started: Instant,
    about: About,
) -> Result<String, Failure> {
    if !experiment.is_whole() {
        return Err(about(&format_args!("{WITHIN}; `burnish resume` it to the end of one")));
    }
    let (recipe, called) = (experiment.recipe(), experiment.goal.scene.as_deref());
    let loaded = checkpoint::scene_of(recipe, called, &args.file, args.scene.as_deref())?;
    let params = experiment.params(loaded.scene).map_err(|e| about(&e))?;
    let mut again: Option<Experiment> = None;
    for &[from, to] in experiment.spans() {
        let params = Params { first_pass: from, ..params.clone() };
        let part = render(params, to - from, args.threads, started)?;
        match &mut again {
            None => again = Some(part),
            Some(whole) => whole.merge(&part).map_err(|e| about(&e))?,
        }
    }
    let again = again.ok_or_else(|| about(&"it has no passes"))?;
    verdict(recipe, experiment.difference(&again), "sum", about)
}

/// Every pixel of a picture without sums.
fn means(args: &Args, started: Instant, about: About) -> Result<String, Failure> {
    let text = read_recipe(&args.file).map_err(Failure::new)?;
    let text = text.ok_or_else(|| about(&"there is no recipe in it"))?;
    let recipe = Recipe::parse(&text).map_err(|e| about(&e))?;
    if !recipe.is_whole() {
        return Err(about(&WITHIN));
    }
    let loaded = checkpoint::scene_of(&recipe, None, &args.file, args.scene.as_deref())?;
    let params = recipe.params(loaded.scene).map_err(|e| about(&e))?;
    let picture = read_exr(&args.file).map_err(Failure::new)?;
    let again = render(params, recipe.passes, args.threads, started)?.picture().0;
    if [picture.width, picture.height] != recipe.size {
        return Err(about(&"it does not have the size that its recipe says"));
    }
    let mut found: Option<Difference> = None;
    for (at, (a, b)) in (0..).zip(picture.pixels.iter().zip(&again.pixels)) {
        if a.map(f32::to_bits) == b.map(f32::to_bits) {
            continue;
        }
        let first = [at % picture.width, at / picture.width];
        let found = found.get_or_insert(Difference { pixels: 0, first, largest: 0.0 });
        let off = (0..3).map(|c| f64::from(a[c] - b[c]).abs());
        found.pixels += 1;
        found.largest = off.fold(found.largest, f64::max);
    }
    verdict(&recipe, found, "mean", about)
}

/// What came of it.
fn verdict(
    recipe: &Recipe,
    found: Option<Difference>,
    what: &str,
    about: About,
) -> Result<String, Failure> {
    let (passes, [width, height]) = (progress::passes(recipe.passes), recipe.size);
    let Some(Difference { pixels, first: [x, y], largest }) = found else {
        return Ok(format!(
            "the same: {passes} of {width}x{height} pixels, every {what} to the bit"
        ));
    };
    Err(about(&format_args!(
        "{pixels} of {} pixels differ from what its recipe makes, the first in column {x}, row {y}; the \
         largest difference is {largest:e}",
        u64::from(width) * u64::from(height)
    )))
}

/// Some passes as an experiment.
fn render(
    params: Params,
    passes: u64,
    threads: usize,
    started: Instant,
) -> Result<Experiment, Failure> {
    let session = Session::with_options(params, passes, options(threads), || {});
    let session = session.map_err(Failure::new)?;
    let traced = trace(&session, End::new(passes, None, None), started, &mut None)?;
    tell(&traced);
    if traced.interrupted {
        return Err(Failure::new("stopped by a signal before the end: nothing is compared"));
    }
    let (tell, told) = channel();
    session.visit_experiment(move |experiment| {
        // Who asked waits for it.
        let _ = tell.send(experiment.clone());
    });
    told.recv().map_err(|_| Failure::new("the render has failed"))
}
