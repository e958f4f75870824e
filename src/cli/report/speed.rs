//! `burnish report speed`: speed against error.

use super::measured::Measured;
use super::{Repeats, Scenes, Threads, sheet, table};
use crate::cli::outputs::{self, Failures};
use crate::cli::values::{self, Chosen, chosen};
use crate::cli::{Failure, print, say, scene, stats};
use burnish::brdf::{Model, Normals};
use burnish::measure::error::{REL_RMSE, Reference};
use burnish::measure::plot::{Dot, Panel, PlotCurve, log_log};
use burnish::measure::speed::{Checkpoint, SpeedPlan, SpeedStage, Summary, Truth, Variant};
use burnish::picture::{read_exr, replace_file};
use burnish::plain;
use burnish::progressive::{Params, Session, Strategy};
use std::path::{Path, PathBuf};

/// Measures how the error falls with time, of every way to sample.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish report speed table.scn --plot table.svg --csv table.csv
  burnish report speed --model ggx --strategy mis,bsdf --passes 256 --size 640x480
  burnish report speed furnace --exact 1 --seconds 5")]
pub(super) struct Args {
    #[command(flatten)]
    scenes: Scenes,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = values::size)]
    size: [u32; 2],
    #[command(flatten)]
    threads: Threads,
    /// Which BRDFs: all, or some of phong, beckmann, ggx with commas between.
    #[arg(long, value_name = "MODELS", default_value = "all",
          value_parser = chosen(Model::ALL, Model::name))]
    model: Chosen<Model>,
    /// How light is found: all, or some of mis, light, bsdf with commas between.
    #[arg(long, value_name = "STRATEGIES", default_value = "all",
          value_parser = chosen(Strategy::ALL, Strategy::name))]
    strategy: Chosen<Strategy>,
    /// How Beckmann's and GGX's microfacet normals are drawn: all, visible, or distribution, which
    /// the reference tracer does.
    #[arg(long, value_name = "NORMALS", default_value = "visible",
          value_parser = chosen(Normals::ALL, Normals::name))]
    normals: Chosen<Normals>,
    /// Passes of the last checkpoint; the others are the powers of 2 below.
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: u64,
    /// Ends a curve before a checkpoint that would come after this number of seconds.
    #[arg(long, value_name = "S", value_parser = values::seconds)]
    seconds: Option<f64>,
    #[command(flatten)]
    repeats: Repeats,
    /// Passes of the reference, rendered for each model with MIS in two halves of seeds that no
    /// repeat has; 16 times --passes without it.
    #[arg(long, value_name = "N", conflicts_with_all = ["reference", "exact"],
          value_parser = clap::value_parser!(u64).range(2..=Session::MAX_PASSES))]
    reference_passes: Option<u64>,
    /// Takes this picture for right instead, an OpenEXR file of the size of --size, for all models.
    #[arg(long, value_name = "FILE.exr", conflicts_with = "exact")]
    reference: Option<PathBuf>,
    /// Takes this radiance for right instead, in every channel of every pixel: a furnace.
    #[arg(long, value_name = "L", value_parser = values::radiance)]
    exact: Option<f32>,
    /// Writes every checkpoint of every repeat as a table, a row each.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Plots the relative RMSE over the seconds as SVG.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// Measures, prints and writes.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let files = || args.csv.iter().chain(&args.plot);
    outputs::are_distinct(files());
    let scenes = args.scenes.scenes.iter().map(PathBuf::as_path);
    outputs::are_no_inputs(files(), scenes.chain(args.reference.as_deref()))?;
    outputs::can_be_written(files())?;
    let mut all = Vec::new();
    for path in args.scenes.each() {
        let measured = measure(args, path)?;
        print(table::of(&measured))?;
        all.push(measured);
    }
    print(table::legend())?;
    let mut failures = Failures::default();
    if let Some(path) = &args.csv {
        failures.note(sheet::write(path, &all));
    }
    if let Some(path) = &args.plot {
        failures.note(plot(path, &all));
    }
    failures.finish()
}

fn plot(path: &Path, all: &[Measured]) -> Result<(), Failure> {
    let panels: Vec<Panel> = all.iter().map(panel).collect();
    let svg = log_log(&panels).map_err(Failure::new)?;
    replace_file(path, |sink| sink.write_all(svg.as_bytes())).map_err(Failure::new)
}

fn measure(args: &Args, path: Option<&Path>) -> Result<Measured, Failure> {
    let scene = scene::load(path)?.scene;
    let plan = args.plan(Params::new(scene.clone()));
    let (truth, words) = args.truth(plan.base.size)?;
    let watch = |stage| match stage {
        SpeedStage::Reference(model) => {
            say(format_args!("reference for {}: {words}", model.title()))
        }
        SpeedStage::WarmUp => say("warm-up"),
        SpeedStage::Repeat(n) => say(format_args!("repeat {} of {}", n + 1, plan.repeats)),
    };
    let experiment = plan.run(&truth, watch).map_err(Failure::new)?;
    Ok(Measured {
        scene: scene.name().to_owned(),
        summaries: experiment.summaries(),
        plan,
        truth: words,
        experiment,
        peak_mib: stats::peak_mib(),
    })
}

impl Args {
    fn plan(&self, base: Params) -> SpeedPlan {
        SpeedPlan {
            variants: Variant::all(&self.model.0, &self.strategy.0, &self.normals.0),
            base: Params { size: self.size, seed: self.repeats.seed, ..base },
            passes: self.passes,
            seconds: self.seconds,
            repeats: self.repeats.repeats,
            threads: self.threads.threads,
        }
    }

    /// What is right, and that in words.
    fn truth(&self, size: [u32; 2]) -> Result<(Truth, String), Failure> {
        if let Some(path) = &self.reference {
            let picture = read_exr(path).map_err(Failure::new)?;
            let [width, height] = [picture.width, picture.height];
            if [width, height] != size {
                return Err(Failure::new(format_args!(
                    "{}: the reference has {width}x{height} pixels, the pictures {}x{}; \
                     give --size {width}x{height}",
                    plain::path(path),
                    size[0],
                    size[1]
                )));
            }
            let words = format!("{}, its own noise unknown", plain::path(path));
            return Ok((Truth::Given(Reference::known(picture)), words));
        }
        if let Some(radiance) = self.exact {
            let words = format!("exactly {radiance} in every pixel");
            return Ok((Truth::Given(Reference::exact(size, [radiance; 3])), words));
        }
        let passes = self.reference_passes.unwrap_or(self.passes.saturating_mul(16));
        let passes = passes.min(Session::MAX_PASSES);
        Ok((Truth::Rendered { passes }, format!("{passes} passes with MIS and other seeds")))
    }
}

/// Colours tell strategies apart, marks models, dashes ways to draw normals.
fn panel(measured: &Measured) -> Panel {
    let Measured { scene, plan, summaries, .. } = measured;
    let [width, height] = plan.base.size;
    let threads = values::worker_count(plan.threads);
    let curve = |summary: &Summary| {
        let Variant { model, strategy, normals, engine } = summary.variant;
        let of_strategy = Strategy::ALL.iter().position(|s| *s == strategy).unwrap_or(0);
        PlotCurve {
            label: summary.variant.title(),
            colour: if engine { Strategy::ALL.len() } else { of_strategy },
            mark: Model::ALL.iter().position(|m| *m == model).unwrap_or(0),
            last_only: false,
            dashed: normals != Normals::Visible,
            dots: summary.checkpoints.iter().map(dot).collect(),
        }
    };
    Panel {
        title: format!(
            "{scene}, {width}x{height}, {threads} threads: median of {} repeats",
            plan.repeats
        ),
        x: "seconds of tracing".into(),
        y: "relative RMSE in %".into(),
        upright: ["upright: lowest to", "highest of all repeats"],
        curves: summaries.iter().map(curve).collect(),
    }
}

fn dot(checkpoint: &Checkpoint) -> Dot {
    let error = checkpoint.error(REL_RMSE);
    Dot {
        x: checkpoint.seconds.median,
        y: 100.0 * error.median,
        range: [100.0 * error.min, 100.0 * error.max],
    }
}
