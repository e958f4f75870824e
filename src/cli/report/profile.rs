//! `burnish report profile`: where the time goes.

use super::Scenes;
use super::table::Table;
use crate::cli::{Failure, print, scene, values};
use burnish::measure::profile::Profile;
use burnish::progressive::{Params, Session};
use burnish::trace::Stage;
use std::path::Path;

/// Measures where the engine's time goes, on one thread: by stage, rays by kind, lanes in use.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish report profile table.scn --passes 16
  burnish report profile cornell --size 640x480")]
pub(super) struct Args {
    #[command(flatten)]
    scenes: Scenes,
    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = values::size)]
    size: [u32; 2],
    /// Passes.
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: u64,
    /// Picks one of 2^64 independent pictures.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
}

/// Measures and prints, scene by scene.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    args.scenes.each().try_for_each(|path| measure(args, path))
}

fn measure(args: &Args, path: Option<&Path>) -> Result<(), Failure> {
    let scene = scene::load(path)?.scene;
    let Args { size, seed, passes, .. } = *args;
    let params = Params { size, seed, ..Params::new(scene.clone()) };
    params.check().map_err(Failure::new)?;
    let Some(profile) = Profile::new(&params, passes) else {
        return Err(Failure::new("there is nothing to measure: the picture has no paths"));
    };
    let paths = profile.paths.max(1) as f64;
    let percent = |part: f64| format!("{:.1} %", 100.0 * part);
    let nanoseconds = |share: f64| 1e9 * share * profile.time.as_secs_f64() / paths;
    let mut stages = Table::new(&["stage", "time", "ns a path", "members a path", "lanes in use"]);
    let mut rest = 1.0;
    for (i, stage) in Stage::ALL.into_iter().enumerate() {
        let (share, cost) = (profile.share(i), profile.stages[i]);
        rest -= share;
        stages.row([
            stage.name().into(),
            percent(share),
            format!("{:.1}", nanoseconds(share)),
            format!("{:.2}", cost.members as f64 / paths),
            // Those go through the reuse vertices one by one, with a group's primary vertices in SIMD lanes.
            match stage {
                Stage::Visibility | Stage::Gather => String::new(),
                _ => percent(cost.members as f64 / cost.lanes.max(1) as f64),
            },
        ]);
    }
    let rest = rest.max(0.0);
    let others = format!("{:.1}", nanoseconds(rest));
    stages.row(["grouping pixels".into(), percent(rest), others, "".into(), "".into()]);
    let counts = profile.counts;
    let mut rays = Table::new(&["rays", "a path"]);
    for (name, count) in [
        ("nearest hit", counts.nearest),
        ("towards lights", counts.shadow_rays),
        ("between points shared", counts.visibility_rays),
        ("of those, through the tree", counts.pair_rays),
        ("of the others, through it", counts.tree_rays),
    ] {
        rays.row([name.into(), format!("{:.2}", count as f64 / paths)]);
    }
    print(format_args!(
        "{}, {}x{}, {} passes, {}, {} paths share, one thread: {:.2} M paths/s\n\n{stages}\n{rays}",
        scene.name(),
        size[0],
        size[1],
        passes,
        scene.isa().name(),
        profile.group.paths(),
        paths / profile.time.as_secs_f64() / 1e6,
    ))?;
    print(format_args!("of {} lanes", profile.width))
}
