//! `burnish pixel`: one sample of one pixel again.

use super::numbers::significant;
use super::settings::{Settings, warn};
use super::{Failure, misused, print, scene, values};
use burnish::brdf::Model;
use burnish::picture::Curve;
use burnish::progressive::{Replay, Session};
use burnish::trace::ReuseGroup;
use std::path::PathBuf;

/// Traces one sample of one pixel again, with the neighbours that it shares with, and prints what
/// each of them finds: the same bits as in a picture rendered with the same options, such as
/// `burnish info` gives for it.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish pixel cornell 320 240 0
  burnish pixel table.scn 17 4 99 --model phong --size 160x120 --seed 7")]
pub(super) struct Args {
    /// Scene: a .scn, .obj or .ply file, or the name of a shipped one.
    scene: PathBuf,
    /// Column from the left, from 0.
    x: u32,
    /// Row from the top, from 0.
    y: u32,
    /// Pass, from 0.
    pass: u64,
    /// Which BRDF.
    #[arg(long, value_name = "MODEL", default_value = "ggx", value_parser = values::model())]
    model: Model,
    /// Passes of the picture: the one asked for has to be among them.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=Session::MAX_PASSES))]
    passes: Option<u64>,
    /// Number of the picture's first pass, where it is a part.
    #[arg(long, value_name = "F", default_value_t = 0, value_parser = values::first_pass)]
    first_pass: u64,
    #[command(flatten)]
    settings: Settings,
    // Radiance does not depend on them, as an EXR file does not: they are among the arguments that
    // `burnish info` gives for a PNG file.
    #[arg(long, hide = true, value_parser = values::exposure)]
    exposure: Option<f32>,
    #[arg(long, hide = true, value_parser = values::curve())]
    tone: Option<Curve>,
}

/// Traces and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (pass, first) = (args.pass, args.first_pass);
    if let Some(passes) = args.passes.filter(|&passes| pass >= first.saturating_add(passes)) {
        misused(format_args!(
            "there is no pass {pass} of {passes}: passes are counted from {first}"
        ));
    }
    if pass < first {
        misused(format_args!("there is no pass {pass}: passes are counted from {first}"));
    }
    let loaded =
        scene::load_for(Some(&args.scene), args.settings.common.isa, args.settings.common.up)?;
    let mut params = args.settings.params(&loaded.scene, args.model);
    params.uniform |= first > 0;
    params.check().map_err(Failure::new)?;
    warn(&params);
    let [width, height] = params.size;
    let Some(replay) = Replay::new(&params, [args.x, args.y], args.pass) else {
        return Err(Failure::new(format_args!(
            "there is no pixel {} {}: the picture has {width} columns and {height} rows, each \
             counted from 0",
            args.x, args.y
        )));
    };
    let sharing = match replay.group {
        ReuseGroup::None => "every path for itself".to_owned(),
        group => format!("groups of {}, this one of {}", group.paths(), replay.pixels.len()),
    };
    print(format_args!(
        "{}, {width}x{height}, seed {}, pass {}: {sharing}",
        params.model.title(),
        params.seed,
        args.pass
    ))?;
    print(format_args!(
        "{:>7} {:>6}  {:>36}  {:>36}",
        "column", "row", "radiance (r g b)", "of that by shared points"
    ))?;
    for (i, (pixel, sample)) in replay.pixels.iter().zip(&replay.samples).enumerate() {
        let mark = if i == replay.own { "<- asked for" } else { "" };
        let light = [sample.whole, sample.shared].map(|c| {
            <[f32; 3]>::from(c).map(|x| format!("{:>12}", significant(x.into(), 7))).concat()
        });
        let [x, y] = pixel;
        print(format_args!("{x:>7} {y:>6}  {}  {}  {mark}", light[0], light[1]))?;
    }
    Ok(())
}
