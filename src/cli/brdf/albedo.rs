//! `--albedo`: how much of the light a surface sends back, by the sampler that the renderer uses.

use super::roughness;
use crate::cli::{Failure, values};
use burnish::brdf::{BrdfParams, Formulas, Model, Normals};
use burnish::math::{Rgb, V3};
use burnish::measure::check::{BATCHES, sampled_albedo};
use std::io::Write;

/// What to estimate, and how well.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Diffuse reflectance Kd, 0 to 1.
    #[arg(long, value_name = "KD", default_value = "0", conflicts_with = "eval",
          value_parser = values::reflectance)]
    kd: f32,
    /// Specular reflectance at normal incidence Ks, 0 to 1. With Kd 0 and Ks 1, F is 1
    /// everywhere: what is missing from an albedo of 1 is what the model loses.
    #[arg(long, value_name = "KS", default_value = "1", conflicts_with = "eval",
          value_parser = values::reflectance)]
    ks: f32,
    /// Samples a row, rounded up to a multiple of 16. What is rarer than one in so many shows in
    /// neither the albedo nor its standard error.
    #[arg(long, value_name = "N", default_value_t = 16_384, conflicts_with = "eval",
          value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    samples: u64,
    /// Picks one of 2^64 independent tables.
    #[arg(long, value_name = "K", default_value_t = 0, conflicts_with = "eval")]
    seed: u64,
}

const EXPONENTS: [f64; 12] = [0.0, 1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5, 1e6];
const ALPHAS: [f64; 12] = [1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0];
const COSINES: [f64; 14] =
    [1.0, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01];

/// Prints a row for every model, roughness and angle of the grid.
pub(super) fn run(args: &Args, out: &mut impl Write) -> Result<(), Failure> {
    writeln!(out, "model,param,alpha,cos_o,Kd,Ks,albedo,standard_error,samples")?;
    let per_batch = args.samples.div_ceil(BATCHES.into());
    let mut row = 0;
    for model in Model::ALL {
        let formulas = Formulas::of(model, Normals::Visible, None);
        for param in if model == Model::Phong { EXPONENTS } else { ALPHAS } {
            let roughness = roughness(model, param).map_err(Failure::new)?;
            for cos in COSINES {
                let params = BrdfParams {
                    kd: Rgb::splat(args.kd),
                    ks: Rgb::splat(args.ks),
                    roughness: roughness.into(),
                };
                let wo = V3::new((1.0 - cos * cos).sqrt() as f32, 0.0, cos as f32);
                let batches = sampled_albedo(&formulas, &params, wo, args.seed, row, per_batch);
                let (mean, error) = mean_and_error(batches);
                let (name, alpha) = (model.name(), roughness.alpha());
                let samples = per_batch * u64::from(BATCHES);
                let (kd, ks) = (args.kd, args.ks);
                writeln!(out, "{name},{param},{alpha},{cos},{kd},{ks},{mean},{error:e},{samples}")?;
                row += 1;
            }
        }
    }
    Ok(())
}

fn mean_and_error(batches: [f64; BATCHES as usize]) -> (f64, f64) {
    let n = f64::from(BATCHES);
    let mean = batches.iter().sum::<f64>() / n;
    let squares = batches.iter().map(|b| (b - mean) * (b - mean)).sum::<f64>();
    (mean, (squares / (n - 1.0) / n).sqrt())
}
