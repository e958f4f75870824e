//! `burnish brdf`: the BRDF itself, as tables.

mod albedo;
mod eval;

use super::Failure;
use burnish::brdf::{Model, Roughness, RoughnessError};
use clap::ArgGroup;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Tables of the BRDF, as CSV on stdout.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(group(ArgGroup::new("table").args(["eval", "albedo"]).required(true)))]
#[command(after_help = "Examples:
  burnish brdf --eval directions.csv > values.csv
  burnish brdf --albedo --kd 0.5 --ks 0.04 --samples 65536")]
pub(super) struct Args {
    /// Evaluates the BRDF for each row of a CSV file with the columns model, param, wi_x, wi_y,
    /// wi_z, wo_x, wo_y, wo_z, Kd, Ks in any order; others are ignored. The directions are unit
    /// vectors, the normal is z; param is the exponent a_p for phong, alpha for the others.
    #[arg(long, value_name = "FILE")]
    eval: Option<PathBuf>,
    /// Directional albedo over model, roughness and angle, estimated by the renderer's sampler.
    #[arg(long)]
    albedo: bool,
    #[command(flatten)]
    albedo_args: albedo::Args,
}

/// Prints the table asked for.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    match &args.eval {
        Some(path) => eval::run(path, &mut out)?,
        None => albedo::run(&args.albedo_args, &mut out)?,
    }
    Ok(out.flush()?)
}

/// A table's `param`: a_p for Phong, alpha for the others.
fn roughness(model: Model, param: f64) -> Result<Roughness, RoughnessError> {
    if model == Model::Phong {
        return Roughness::from_exponent(param);
    }
    // 1e-4 as a float is a little less than 1e-4: still the end of the range, not beyond it.
    let [least, _] = Roughness::ALPHA;
    Roughness::from_alpha(if param as f32 == least as f32 { param.max(least) } else { param })
}
