//! `burnish pixel`: one sample of one pixel again.

use super::figures::significant;
use super::{Failure, print, scene, values};
use burnish::brdf::{Model, Roughness};
use burnish::math::lanes::Isa;
use burnish::progressive::{Params, Replay};
use burnish::scene::Camera;
use burnish::trace::Group;
use std::path::PathBuf;

/// Traces one sample of one pixel again, with the neighbours that it shares with, and prints what
/// each of them finds: the same bits as in a picture rendered with the same options.
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
    /// Roughness alpha of every material, 0.0001 to 1.
    #[arg(long, value_name = "A", value_parser = values::alpha)]
    alpha: Option<Roughness>,
    /// Width and height in pixels instead of the scene's.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Camera instead of the scene's: the text after `camera` in a .scn file.
    #[arg(long, value_name = "x y z ry ORIENT", allow_hyphen_values = true,
          value_parser = scene::camera)]
    camera: Option<Camera>,
    /// The picture's seed.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Most scattering events between camera and light.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// Every path for itself.
    #[arg(long)]
    no_reuse: bool,
    /// So many neighbours share, instead of as many as a pilot finds best.
    #[arg(long, value_name = "N", value_parser = values::group(), conflicts_with = "no_reuse")]
    group: Option<Group>,
    /// Instruction set to trace with instead of the widest.
    #[arg(long, value_name = "SET", value_parser = values::isa())]
    isa: Option<Isa>,
}

/// Traces and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let loaded = scene::load_for(Some(&args.scene), args.isa)?;
    let params = args.params(Params::new(loaded.scene.clone()));
    params.check().map_err(Failure::new)?;
    let [width, height] = params.size;
    let Some(replay) = Replay::new(&params, [args.x, args.y], args.pass) else {
        return Err(Failure::new(format_args!(
            "there is no pixel {} {}: the picture has {width} columns and {height} rows, each \
             counted from 0",
            args.x, args.y
        )));
    };
    let sharing = match replay.group {
        Group::None => "every path for itself".to_owned(),
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

impl Args {
    fn params(&self, mut params: Params) -> Params {
        params.model = self.model;
        params.seed = self.seed;
        params.max_depth = self.max_depth;
        params.size = self.size.unwrap_or(params.size);
        params.camera = self.camera.unwrap_or(params.camera);
        params.group = if self.no_reuse { Some(Group::None) } else { self.group };
        match self.alpha {
            Some(roughness) => params.with_roughness(roughness),
            None => params,
        }
    }
}
