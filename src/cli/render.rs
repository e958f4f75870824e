//! `burnish render`: a picture without a window.

use super::checkpoint::Keeper;
use super::jobs::{Job, jobs};
use super::outputs::{self, Failures};
use super::scene::{self, Loaded};
use super::settings::{Display, Settings, warn};
use super::stats::{self, Stats};
use super::talk::{detail, note, say};
use super::trace::{End, Traced, options, tell, trace};
use super::values::{self, Chosen};
use super::{Failure, interrupt, misused, pictures};
use burnish::brdf::{Erratum, Model};
use burnish::measure::energy::remarks;
use burnish::picture::Picture;
use burnish::plain;
use burnish::progressive::{Goal as KeptGoal, Params, Recipe, Session, part};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

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
  burnish render cornell plates my.scn --model all -o out/{name}-{model}.png    nine pictures
  burnish render table.scn --passes 4096 --checkpoint table.exr --every 600     for `burnish resume`
  burnish render table.scn --passes 4096 --part 3/40 --checkpoint part-3.exr    for `burnish merge`")]
pub(super) struct Args {
    /// Scenes to render: .scn, .obj or .ply files, or names of shipped ones. The built-in scene
    /// without one.
    scenes: Vec<PathBuf>,
    /// Picture to write; may be given more than once. The name ends in .png (8-bit sRGB) or .exr
    /// (linear 32-bit float, untouched by --exposure and --tone). In it {name} stands for the
    /// scene's file without folder and ending, {model} for the model; so they do in --stats.
    /// `burnish info` shows how it was made.
    #[arg(short, long = "output", value_name = "FILE", required_unless_present = "checkpoint")]
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
    /// Keeps the render in this file, an OpenEXR picture with every sum beside it, so that `burnish
    /// resume` goes on from it with the same bits, whatever has ended or killed it, and `burnish merge`
    /// puts parts together. It must not be there yet. {name} and {model} stand for the same as above.
    #[arg(long, value_name = "FILE", value_parser = values::experiment)]
    checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints; the last one comes at the end.
    #[arg(long, value_name = "SECONDS", default_value = "60", requires = "checkpoint",
          value_parser = values::interval)]
    every: f64,
    /// Renders part K of N of the --passes, from 1, for `burnish merge`: those from 4 floor((K - 1) P / 4 N)
    /// to before 4 floor(K P / 4 N). Implies --uniform.
    #[arg(long, value_name = "K/N", conflicts_with_all = ["time", "error"], value_parser = values::part)]
    part: Option<[u64; 2]>,
    /// Number of the first pass, a multiple of 4, as a part has it. Implies --uniform.
    #[arg(long, value_name = "F", default_value_t = 0, conflicts_with = "part",
          value_parser = values::first_pass)]
    first_pass: u64,
    #[command(flatten)]
    settings: Settings,
    /// Worker threads; 0 is one a core. The picture does not depend on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
    #[command(flatten)]
    display: Display,
    /// Writes times, counts and the mean as JSON.
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

/// Renders and writes all of them; `started` is when the program began.
pub(super) fn run(args: &Args, mut started: Instant) -> Result<(), Failure> {
    let files = (args.stats.as_deref(), args.checkpoint.as_deref());
    let jobs =
        jobs(&args.scenes, &args.models.0, &args.outputs, files).unwrap_or_else(|why| misused(why));
    let (first, passes) = args.passes();
    if args.part.is_some() {
        note(format_args!("passes {first} to {}, all of them uniform", first + passes - 1));
    }
    // Known now, not after an hour.
    outputs::are_distinct(jobs.iter().flat_map(Job::files));
    let files = || jobs.iter().flat_map(Job::files);
    outputs::are_no_inputs(files(), args.scenes.iter().map(PathBuf::as_path))?;
    outputs::can_be_written(files())?;
    let mut checkpoints = jobs.iter().filter_map(|job| job.checkpoint.as_deref());
    if let Some(path) = checkpoints.find(|path| path.exists()) {
        let path = plain::path(path);
        return Err(Failure::new(format_args!(
            "{path}: is there already; `burnish resume {path}` goes on with it, or remove it"
        )));
    }
    args.scenes.iter().try_for_each(|path| scene::exists(path))?;
    interrupt::listen()?;
    let mut done = 0;
    for jobs_of_scene in jobs.chunk_by(|a, b| a.scene == b.scene) {
        let loaded = scene::load_for(
            jobs_of_scene[0].scene.as_deref(),
            args.settings.common.isa,
            args.settings.common.up,
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
    let mut params = args.settings.params(&loaded.scene, job.model);
    params.first_pass = args.passes().0;
    if args.part.is_some() || args.first_pass > 0 {
        params.uniform = true;
    }
    warn(&params);
    energy(&params);
    detail(describe(&params, args.threads));
    let end = args.end();
    let session = Session::with_options(params.clone(), end.limit(0), options(args.threads), || {})
        .map_err(Failure::new)?;
    let keeper = |path: &PathBuf| Keeper::new(path, args.every, args.kept_goal(job));
    let mut keeper = job.checkpoint.as_ref().map(keeper);
    let traced = trace(&session, end, started, &mut keeper)?;
    tell(&traced);
    if traced.snapshot.counts.paths == 0 {
        return Err(Failure::new("stopped before the first sample: nothing is written"));
    }
    let mut failures = Failures::default();
    if let Some(keeper) = keeper {
        failures.note(keeper.finish(&session));
    }
    let picture = traced.snapshot.mean();
    let tone = args.display.tone();
    let recipe = Recipe::new(&params, &traced.snapshot);
    pictures::write(&job.outputs, &recipe, &traced.snapshot, &picture, tone, &mut failures);
    if let Some(path) = &job.stats {
        failures.note(stats(&params, args.threads, loaded, &traced, &picture).write(path));
    }
    failures.finish()?;
    Ok(traced.interrupted)
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
    /// The first pass, and how many passes there are from it on.
    fn passes(&self) -> (u64, u64) {
        match self.part {
            Some([number, of]) => match part(self.passes, number, of) {
                Some(Range { start, end }) => (start, end - start),
                None => misused(format_args!(
                    "--part {number}/{of}: {} passes have at most {} parts, of 4 passes and more",
                    self.passes,
                    (self.passes / 4).max(1)
                )),
            },
            None => (self.first_pass, self.passes),
        }
    }

    fn end(&self) -> End {
        End::new(self.passes().1, self.time, self.error)
    }

    /// What the checkpoint says that it is to become.
    fn kept_goal(&self, job: &Job) -> KeptGoal {
        let (first, passes) = self.passes();
        let known = self.time.is_none() && self.error.is_none();
        let of = if self.part.is_some() { self.passes } else { first + passes };
        KeptGoal {
            end: known.then_some(first + passes),
            passes: known.then_some(of),
            scene: job.scene.as_deref().and_then(Path::to_str).map(str::to_owned),
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
        isa: loaded.scene.isa().name(),
        version: env!("CARGO_PKG_VERSION"),
        width: picture.width,
        height: picture.height,
        threads: values::worker_count(threads),
    }
}
