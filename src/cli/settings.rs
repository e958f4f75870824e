//! The options that a picture's pixels depend on, besides its scene and model.

use super::talk::{note, warning};
use super::{scene, values};
use burnish::brdf::{Erratum, Model, Normals, Roughness};
use burnish::math::simd::Isa;
use burnish::picture::{Curve, Tone};
use burnish::progressive::{Params, Strategy};
use burnish::scene::{Axis, Camera, Crop, Scene};
use burnish::trace::ReuseGroup;
use std::sync::Arc;

// No doc comment: it would become that of the commands.
#[derive(Debug, clap::Args)]
pub(super) struct Settings {
    /// Roughness alpha of every material, 0.0001 to 1. Without it and --exponent each material
    /// keeps its own.
    #[arg(long, value_name = "A", value_parser = values::alpha)]
    alpha: Option<Roughness>,
    /// Phong exponent a_p of every material, 0 to 199999998; alpha = sqrt(2 / (a_p + 2)).
    #[arg(long, value_name = "N", conflicts_with = "alpha",
          value_parser = values::exponent)]
    exponent: Option<Roughness>,
    /// Width and height in pixels instead of the scene's.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    pub(super) common: Common,
}

// Those that a contact sheet has as well. No doc comment here either.
#[derive(Debug, clap::Args)]
pub(super) struct Common {
    /// Camera instead of the scene's: the text after `camera` in a .scn file.
    #[arg(long, value_name = "x y z ry ORIENT", allow_hyphen_values = true,
          value_parser = scene::camera)]
    camera: Option<Camera>,
    /// Only a part of the camera's picture, at the full size: its left and upper edge and its side, in parts
    /// of the whole.
    #[arg(long, value_name = "X,Y,SIDE", value_parser = values::crop)]
    crop: Option<Crop>,
    /// The axis of an OBJ or PLY file that points up. Without it Y for OBJ and Z for PLY files, unless
    /// the model has a foot at least twice as large along the other of these two.
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = values::axis())]
    pub(super) up: Option<Axis>,
    /// Picks one of 2^64 independent pictures.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Instruction set to trace with, of those that this machine has, instead of the widest. AVX2
    /// and AVX-512 give the same bits, the portable set others within rounding.
    #[arg(long, value_name = "SET", value_parser = values::isa())]
    pub(super) isa: Option<Isa>,
    /// Most scattering events between camera and light. Without it paths end by Russian roulette.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// How light is found: by sampling lights, by sampling the BRDF, or by both, weighed against each
    /// other (multiple importance sampling). All have the same mean.
    #[arg(long, default_value = "mis", value_parser = values::strategy())]
    strategy: Strategy,
    /// Which microfacet normals Beckmann and GGX draw: those that the viewer sees, or all that there
    /// are, as the distribution has them. Phong always draws from all.
    #[arg(long, default_value = "visible", value_parser = values::normals())]
    normals: Normals,
    /// Makes one mistake of the report or the program that burnish grew from, to see what it does:
    /// the picture is wrong on purpose. `burnish report errata` measures them all.
    #[arg(long, value_name = "NAME", value_parser = values::erratum())]
    erratum: Option<Erratum>,
    /// Traces one path at a time with the tracer that is written to be read, not with the engine. The
    /// random numbers are the same; other strategies, normals and errata are always traced so.
    #[arg(long)]
    reference: bool,
    /// Every path for itself. Otherwise neighbouring pixels share the points that their paths meet
    /// second, which leaves a tenth of the variance in most scenes and is exactly unbiased.
    #[arg(long)]
    no_reuse: bool,
    /// Number of neighbours that reuse each other's paths, instead of the one that trials find best for
    /// the scene.
    #[arg(long, value_name = "N", value_parser = values::group(), conflicts_with = "no_reuse")]
    group: Option<ReuseGroup>,
    /// The same number of samples for every pixel. Otherwise, from pass 16 on, a pass is one sample a
    /// pixel on the mean, and more where the picture is noisier, which is exactly unbiased too.
    #[arg(long)]
    uniform: bool,
}

impl Settings {
    /// All that the pixels depend on. The scene must have been loaded for the instruction set.
    pub(super) fn params(&self, scene: &Arc<Scene>, model: Model) -> Params {
        let mut params = self.common.params(scene, model);
        params.size = self.size.unwrap_or(params.size);
        match self.alpha.or(self.exponent) {
            Some(roughness) => params.with_roughness(roughness),
            None => params,
        }
    }
}

impl Common {
    /// The scene as it is but for these. It must have been loaded for the instruction set.
    pub(super) fn params(&self, scene: &Arc<Scene>, model: Model) -> Params {
        let mut params = Params::new(scene.clone());
        params.model = model;
        params.seed = self.seed;
        params.max_depth = self.max_depth;
        params.strategy = self.strategy;
        params.normals = self.normals;
        params.erratum = self.erratum;
        params.reference = self.reference;
        params.group = if self.no_reuse { Some(ReuseGroup::None) } else { self.group };
        params.uniform = self.uniform;
        params.camera = self.camera.unwrap_or(params.camera);
        params.camera.crop = self.crop.unwrap_or(Crop::WHOLE);
        params
    }
}

// How PNG files are to look.
#[derive(Debug, clap::Args)]
pub(super) struct Display {
    /// Exposure of PNG files in stops, -30 to 30.
    #[arg(long, value_name = "EV", default_value = "0",
          value_parser = values::exposure)]
    exposure: f32,
    /// How PNG files bring bright values into range: neutral keeps the hue and shape of highlights and
    /// is what the window shows, srgb clips each channel, so that what is below 1 is exact.
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::curve())]
    tone: Curve,
}

impl Display {
    pub(super) fn tone(&self) -> Tone {
        Tone { exposure: self.exposure, curve: self.tone }
    }
}

/// Says which mistake is being made, or that it is none with this model.
pub(super) fn warn(params: &Params) {
    let Some(erratum) = params.erratum else { return };
    match erratum.model() {
        Some(other) if other != params.model => note(format_args!(
            "{} is about {} and has no effect on {}",
            erratum.name(),
            other.title(),
            params.model.title()
        )),
        _ => warning(format_args!("this picture is wrong on purpose: {erratum}")),
    }
}
