//! `burnish resume`: a render that has ended goes on.

use super::checkpoint::{self, Keeper};
use super::outputs::{self, Failures};
use super::talk::{note, say};
use super::trace::{End, options, tell, trace};
use super::{Failure, interrupt, pictures, values};
use burnish::picture::{Curve, Tone};
use burnish::plain;
use burnish::progressive::{Experiment, Goal, Recipe, Session};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Goes on with a render from the file that `render --checkpoint` has written, and writes that file.
///
/// However often a render was ended or killed, its picture has the same bits as one that was not, on any
/// number of threads. The scene is read again; if any of its files has changed, it is refused.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish resume table.exr                          to the end that it was begun for
  burnish resume table.exr --passes 4096 -o table.png   further, and a picture of it
  burnish resume part-3.exr --scene /scenes/table.scn")]
pub(super) struct Args {
    /// Experiment that `render --checkpoint`, this command or `merge` has written.
    file: PathBuf,
    /// Passes that it is to have in all. Without it, and without --time and --error, those that it was begun
    /// for.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: Option<u64>,
    /// Goes on for so long.
    #[arg(long, value_name = "SECONDS", conflicts_with = "passes", value_parser = values::seconds)]
    time: Option<f64>,
    /// Goes on until the upper 95 % limit of the relative error is at most this.
    #[arg(long, value_name = "E", conflicts_with = "passes", value_parser = values::error)]
    error: Option<f64>,
    /// Where its scene is, if not where it was.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Picture to write in the end; may be given more than once.
    #[arg(short, long = "output", value_name = "FILE", value_parser = values::picture)]
    outputs: Vec<PathBuf>,
    /// Seconds between two checkpoints.
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = values::interval)]
    every: f64,
    /// Worker threads; 0 is one a core. The picture does not depend on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    /// Exposure of PNG files in stops, -30 to 30.
    #[arg(long, value_name = "EV", default_value = "0", value_parser = values::exposure)]
    exposure: f32,
    /// How PNG files bring bright values into range, each channel on its own.
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::curve())]
    tone: Curve,
}

/// Reads, goes on and writes.
pub(super) fn run(args: &Args, started: Instant) -> Result<(), Failure> {
    let file = args.file.as_path();
    let written = || args.outputs.iter().chain([&args.file]);
    outputs::are_distinct(written());
    let experiment = checkpoint::read(file)?;
    outputs::can_be_written(written())?;
    let about =
        |e: &dyn std::fmt::Display| Failure::new(format_args!("{}: {e}", plain::path(file)));
    let end = end(args, &experiment).map_err(|e| about(&e))?;
    interrupt::listen()?;
    let (recipe, called) = (experiment.recipe(), experiment.goal.scene.as_deref());
    let loaded = checkpoint::scene_of(recipe, called, file, args.scene.as_deref())?;
    let read = loaded.scene.source().files.iter().map(|file| file.path.as_path());
    outputs::are_no_inputs(written(), read)?;
    let params = experiment.params(loaded.scene.clone()).map_err(|e| about(&e))?;
    let (has, goal) = (experiment.passes(), goal(args, &experiment));
    let limit = end.limit(has);
    if limit <= has {
        note(format_args!("{}: it has {has} passes already", plain::path(file)));
    } else {
        say(format_args!("{}: going on after {has} passes", plain::path(file)));
    }
    let options = options(args.threads);
    let session = Session::with_experiment(experiment, loaded.scene, limit, options, || {})
        .map_err(|e| about(&e))?;
    let mut keeper = Some(Keeper::new(file, args.every, goal));
    let traced = trace(&session, end, started, &mut keeper)?;
    tell(&traced);
    let mut failures = Failures::default();
    if let Some(keeper) = keeper {
        failures.note(keeper.finish(&session));
    }
    let picture = traced.snapshot.mean();
    let recipe = Recipe::new(&params, &traced.snapshot);
    let tone = Tone { exposure: args.exposure, curve: args.tone };
    pictures::write(&args.outputs, &recipe, &traced.snapshot, &picture, tone, &mut failures);
    failures.finish()
}

/// When it ends: as asked, or as it was begun for.
fn end(args: &Args, experiment: &Experiment) -> Result<End, String> {
    let begun_for = experiment.goal.end.map(|end| {
        let first = experiment.recipe().first_pass;
        end.saturating_sub(first).clamp(1, Session::MAX_PASSES)
    });
    let (has, most) = (experiment.passes(), experiment.most_passes());
    if let Some(passes) = args.passes.filter(|passes| (has + 1..most).contains(passes)) {
        return Err(format!(
            "{passes} passes are fewer than the {most} that a part of the picture has already, and \
             samples cannot be taken back: give --passes {most} or more"
        ));
    }
    match args.passes.or(begun_for) {
        None if args.time.is_none() && args.error.is_none() => {
            Err("it was begun for a time or an error: give --passes, --time or --error".to_owned())
        }
        passes => Ok(End::new(passes.unwrap_or(1), args.time, args.error)),
    }
}

/// What it is to become from now on.
fn goal(args: &Args, experiment: &Experiment) -> Goal {
    let place = |path: &Path| path.to_str().map(str::to_owned);
    let old = experiment.goal.clone();
    let scene = args.scene.as_deref().and_then(place).or(old.scene);
    let first = experiment.recipe().first_pass;
    match args.passes {
        Some(passes) => {
            let end = first + passes;
            Goal { end: Some(end), passes: old.passes.max(Some(end)), scene }
        }
        None if args.time.is_some() || args.error.is_some() => {
            Goal { end: None, passes: None, scene }
        }
        None => Goal { scene, ..old },
    }
}
