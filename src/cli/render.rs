//! `burnish render`: a picture without a window.

use super::jobs::{Job, jobs};
use super::outputs::{self, Failures};
use super::progress::{self, Goal, Progress};
use super::scene::{self, Loaded};
use super::settings::{Settings, warn};
use super::snapshots::next;
use super::stats::{self, Stats};
use super::talk::{detail, note, say, warning};
use super::values::{self, Chosen};
use super::{Failure, interrupt, misused};
use burnish::brdf::{Erratum, Model};
use burnish::measure::energy::remarks;
use burnish::picture::{Curve, Picture, Tone};
use burnish::plain;
use burnish::progressive::{Options, Params, Recipe, Session, Snapshot, State, StopRule};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Renders a picture without a window.
///
/// Ctrl-C, SIGTERM and SIGHUP end it early and still write what is done; a second one quits at once.
/// What cannot be written where it was wanted is kept in the temporary folder, and the error says where.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish render -o ball.png
  burnish render table.scn -o table.exr -o table.png --model ggx --alpha 0.1 --passes 512
  burnish render table.scn -o table.png --time 60 --size 1600x1200 --exposure -1 --tone filmic
  burnish render cornell plates my.scn --model all -o out/{name}-{model}.png    nine pictures")]
pub(super) struct Args {
    /// Scenes to render: .scn, .obj or .ply files, or names of shipped ones. The built-in scene
    /// without one.
    scenes: Vec<PathBuf>,
    /// Picture to write; may be given more than once. The name ends in .png (8-bit sRGB) or .exr
    /// (linear 32-bit float, untouched by --exposure and --tone). In it {name} stands for the
    /// scene's file without folder and ending, {model} for the model; so they do in --stats.
    /// `burnish info` shows how it was made.
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    #[arg(value_parser = values::picture)]
    outputs: Vec<PathBuf>,
    /// Which BRDF: phong, beckmann, ggx, some of them with commas between, or all.
    #[arg(long = "model", value_name = "MODELS", default_value = "ggx",
          value_parser = values::chosen(Model::ALL, Model::name))]
    models: Chosen<Model>,
    /// Samples a pixel: of each up to 16, then on the mean unless --uniform is given.
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: u64,
    /// Renders for so long instead, loading not counted. It may end within a pass: every pixel is
    /// divided by its own numbers of samples.
    #[arg(long, value_name = "SECONDS", conflicts_with = "passes",
          value_parser = values::seconds)]
    time: Option<f64>,
    /// Renders until the relative error is at most this, as a part of one or in percent (0.02,
    /// 2%): the upper 95 % limit of sqrt(mean((x - r)^2 / (r^2 + 0.01))), r being the truth. With
    /// --time, whichever comes first.
    #[arg(long, value_name = "E", conflicts_with = "passes", value_parser = values::error)]
    error: Option<f64>,
    #[command(flatten)]
    settings: Settings,
    /// Worker threads; 0 is one a core. The picture does not depend on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    /// Exposure of PNG files in stops, -30 to 30.
    #[arg(long, value_name = "EV", default_value = "0",
          value_parser = values::exposure)]
    exposure: f32,
    /// How PNG files bring bright values into range: neutral keeps the hue and shape of highlights and
    /// is what the window shows, srgb clips each channel, so that what is below 1 is exact.
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::curve())]
    tone: Curve,
    /// Writes times, counts and the mean as JSON.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

/// Renders and writes all of them; `started` is when the program began.
pub(super) fn run(args: &Args, mut started: Instant) -> Result<(), Failure> {
    let jobs = jobs(&args.scenes, &args.models.0, &args.outputs, args.stats.as_deref())
        .unwrap_or_else(|why| misused(why));
    // Known now, not after an hour.
    outputs::are_distinct(jobs.iter().flat_map(Job::files));
    let files = || jobs.iter().flat_map(Job::files);
    outputs::are_no_inputs(files(), args.scenes.iter().map(PathBuf::as_path))?;
    outputs::can_be_written(files())?;
    args.scenes.iter().try_for_each(|path| scene::exists(path))?;
    interrupt::listen()?;
    let mut done = 0;
    for jobs_of_scene in jobs.chunk_by(|a, b| a.scene == b.scene) {
        let loaded = scene::load_for(
            jobs_of_scene[0].scene.as_deref(),
            args.settings.isa,
            args.settings.up,
        )?;
        let read = loaded.scene.source().files.iter().map(|file| file.path.as_path());
        outputs::are_no_inputs(files(), read)?;
        for job in jobs_of_scene {
            done += 1;
            if jobs.len() > 1 {
                say(format_args!("{done} of {}: {}", jobs.len(), job.title()));
            }
            let interrupted = render(args, job, &loaded, started)?;
            if interrupted && done < jobs.len() {
                let (left, of) = (jobs.len() - done, jobs.len());
                return Err(Failure::new(format_args!("{left} of {of} pictures are not begun")));
            }
            started = Instant::now();
        }
    }
    Ok(())
}

/// Renders one and writes it; returns whether Ctrl-C ended it.
fn render(args: &Args, job: &Job, loaded: &Loaded, started: Instant) -> Result<bool, Failure> {
    let params = args.settings.params(&loaded.scene, job.model);
    warn(&params);
    energy(&params);
    detail(describe(&params, args.threads));
    let traced = trace(args, params.clone(), started)?;
    tell(&traced);
    if traced.snapshot.counts.paths == 0 {
        return Err(Failure::new("stopped before the first sample: nothing is written"));
    }
    let (picture, samples) = (traced.snapshot.mean(), traced.snapshot.samples());
    let tone = Tone { exposure: args.exposure, curve: args.tone };
    let recipe = Recipe::new(&params, &traced.snapshot);
    let mut failures = Failures::default();
    for path in &job.outputs {
        match recipe.save_with_samples(path, &picture, &samples, tone) {
            Ok(()) => detail(format_args!("written: {}", plain::path(path))),
            Err(e) => failures.add(format_args!("{e}; {}", rescue(path, &recipe, &picture, tone))),
        }
    }
    if let Some(path) = &job.stats {
        failures.note(stats(&params, args.threads, loaded, &traced, &picture).write(path));
    }
    failures.finish()?;
    Ok(traced.interrupted)
}

/// Puts a picture that could not be written where it was wanted into the temporary folder, and says
/// where or why not: what was rendered is not thrown away.
fn rescue(path: &Path, recipe: &Recipe, picture: &Picture, tone: Tone) -> String {
    let ending = path.extension().map_or("exr".into(), |ending| ending.to_string_lossy());
    let place = tempfile::Builder::new()
        .prefix("burnish-")
        .suffix(&format!(".{ending}"))
        .tempfile()
        .and_then(|file| file.into_temp_path().keep().map_err(|e| e.error));
    let kept = place.map_err(|e| e.to_string()).and_then(|place| {
        recipe.save(&place, picture, tone).map(|()| place.clone()).map_err(|e| {
            // It is empty.
            let _ = std::fs::remove_file(&place);
            e.to_string()
        })
    });
    match kept {
        Ok(place) => format!("the picture is kept as {}", plain::path(&place)),
        Err(why) => format!("nor could it be kept in the temporary folder: {why}"),
    }
}

/// What is about to be rendered.
fn describe(params: &Params, threads: usize) -> String {
    let ([width, height], threads) = (params.size, values::worker_count(threads));
    format!(
        "{}, {width}x{height}, {} strategy, {} normals, seed {}, {threads} worker threads",
        params.model.title(),
        params.strategy.name(),
        params.normals.name(),
        params.seed
    )
}

/// What the model does to the energy of this scene.
fn energy(params: &Params) {
    const MOST: usize = 4;
    let remarks = remarks(&params.materials, params.model);
    for remark in remarks.iter().take(MOST) {
        note(remark);
    }
    if remarks.len() > MOST {
        note(format_args!("and {} more such remarks", remarks.len() - MOST));
    }
}

impl Args {
    fn goal(&self) -> Goal {
        match (self.error, self.time) {
            (Some(wanted), _) => Goal::Error(StopRule { wanted }),
            (None, Some(seconds)) => Goal::Time(Duration::from_secs_f64(seconds)),
            (None, None) => Goal::Passes(self.passes),
        }
    }
}

/// A render that is over.
struct Traced {
    snapshot: Snapshot,
    /// Ended by Ctrl-C.
    interrupted: bool,
    /// From the program's start until every pixel had a sample.
    first_image: Option<Duration>,
}

/// How long Ctrl-C may go unnoticed.
const TICK: Duration = Duration::from_millis(50);
/// Between two snapshots: how late the first complete picture may be noticed.
const INTERVAL: Duration = Duration::from_millis(20);

/// Traces until the goal is reached or Ctrl-C is pressed.
fn trace(args: &Args, params: Params, started: Instant) -> Result<Traced, Failure> {
    let limit = match args.goal() {
        Goal::Passes(passes) => passes,
        Goal::Time(_) => Session::MAX_PASSES,
        Goal::Error(_) => StopRule::FIRST,
    };
    let time = args.time.map_or(Duration::MAX, Duration::from_secs_f64);
    let options = Options { interval: INTERVAL, ..Options::headless(args.threads) };
    let session = Session::with_options(params, limit, options, || {}).map_err(Failure::new)?;
    let mut progress = Progress::start(args.goal());
    let mut first_image = None;
    let mut stopping = false;
    loop {
        let left = time.saturating_sub(progress.elapsed());
        let wait = if stopping { TICK } else { left.min(TICK) };
        if let Some(snapshot) = next(&session, wait)? {
            if snapshot.passes > 0 {
                first_image.get_or_insert_with(|| started.elapsed());
                // From now on nobody watches as closely.
                session.set_interval(TICK * 10);
            }
            progress.show(&snapshot);
            let again = match (args.goal(), &snapshot.state) {
                (Goal::Error(rule), State::Done) => {
                    rule.next(snapshot.passes, snapshot.error.as_ref())
                }
                _ => None,
            };
            if let Some(passes) = again.filter(|_| !stopping) {
                session.set_limit(passes);
            } else if snapshot.state != State::Running {
                let interrupted = snapshot.state == State::Paused && interrupt::came();
                return Ok(Traced { snapshot, interrupted, first_image });
            }
        }
        if !stopping && (left.is_zero() || interrupt::came()) {
            stopping = true;
            session.pause();
        }
    }
}

fn stats(
    params: &Params,
    threads: usize,
    loaded: &Loaded,
    traced: &Traced,
    picture: &Picture,
) -> Stats {
    let Traced { snapshot, first_image, .. } = traced;
    Stats {
        load_s: loaded.load_s,
        build_s: loaded.build_s,
        first_image_s: first_image.map(|t| t.as_secs_f64()),
        render_s: snapshot.seconds,
        passes: snapshot.passes,
        paths: snapshot.counts.paths,
        rays: snapshot.counts.rays,
        peak_mib: stats::peak_mib(),
        est_rel_error: snapshot.error.map(|e| e.relative.value),
        est_rel_error_limits: snapshot
            .error
            .map(|e| [e.relative.interval.low, e.relative.interval.high]),
        est_reliable: snapshot.error.is_some_and(|e| e.reliable),
        mean: stats::mean(picture),
        nonfinite: snapshot.counts.nonfinite,
        capped: snapshot.counts.capped,
        model: params.model.name(),
        strategy: params.strategy.name(),
        normals: params.normals.name(),
        erratum: params.erratum.map(Erratum::name),
        seed: params.seed,
        group: snapshot.group.paths(),
        isa: loaded.scene.bvh().isa().name(),
        version: env!("CARGO_PKG_VERSION"),
        width: picture.width,
        height: picture.height,
        threads: values::worker_count(threads),
    }
}

/// What there is to know about a finished render.
fn tell(traced: &Traced) {
    let Traced { snapshot, interrupted, first_image } = traced;
    let early = if *interrupted { "stopped by Ctrl-C: " } else { "" };
    let Snapshot { passes, seconds, counts, .. } = snapshot;
    let (done, error) = (progress::passes(*passes), progress::error(snapshot));
    say(format_args!("{early}{done} in {seconds:.2} s{error}"));
    let millions = |n: u64| n as f64 / seconds.max(1e-9) / 1e6;
    detail(format_args!(
        "{:.2} M paths/s, {:.2} M rays/s; every pixel had a sample after {:.3} s",
        millions(counts.paths),
        millions(counts.rays),
        first_image.map_or(f64::NAN, |t| t.as_secs_f64())
    ));
    if snapshot.error.is_some_and(|e| !e.reliable) {
        note("the error is not yet reliable: too few passes, or a handful of pixels owns it");
    }
    if *passes == 0 {
        warning("not every pixel has a sample yet; the rest is black");
    }
    if counts.nonfinite > 0 {
        let n = counts.nonfinite;
        warning(format_args!(
            "{n} samples were NaN or infinite and are left out; their pixels are wrong"
        ));
    }
    if counts.capped > 0 {
        let n = counts.capped;
        note(format_args!(
            "{n} paths were ended by the safety caps on their length and throughput"
        ));
    }
}
