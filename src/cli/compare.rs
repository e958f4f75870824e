//! `burnish compare`: how far one picture is from another.

use super::numbers::significant;
use super::outputs::{self, Failures};
use super::{Failure, print, talk, values};
use burnish::limits::fits;
use burnish::measure::difference::{self, PictureDifference};
use burnish::measure::error::{ALL, MEAN_ERROR, Pair, REFERENCE_NOISE, Reference};
use burnish::measure::flip::{self, Flip};
use burnish::picture::{Curve, Picture, Tone, read_exr_part, write};
use burnish::plain;
use std::path::{Path, PathBuf};

/// Measures how far a picture is from a reference, each number with its formula.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish compare fast.exr converged.exr
  burnish compare fast.exr converged.exr -o difference.png --flip seen.png --exposure -1
  burnish compare all.exr all.exr --part noisy --reference-part denoised")]
pub(super) struct Args {
    /// Picture to judge, an OpenEXR file: x in the formulas.
    picture: PathBuf,
    /// Picture to hold it against, an OpenEXR file of the same size: r in the formulas.
    reference: PathBuf,
    /// The part or layer to read where a file has several, by its name. Without it, the first that
    /// has colours; what is read is told.
    #[arg(long, value_name = "NAME")]
    part: Option<String>,
    /// The same for the reference alone.
    #[arg(long, value_name = "NAME")]
    reference_part: Option<String>,
    /// Writes where they differ, in false colours: white where not, red where the picture is too
    /// bright, blue where it is too dark.
    #[arg(short, long = "output", value_name = "FILE", value_parser = values::picture)]
    output: Option<PathBuf>,
    /// The relative difference of the full colours of --output. Without it, what 99 % of the
    /// pixels do not exceed.
    #[arg(long, value_name = "D", requires = "output", value_parser = values::positive)]
    scale: Option<f32>,
    /// Writes where a person sees a difference (FLIP), from black, not at all, to pale yellow.
    #[arg(long, value_name = "FILE", value_parser = values::picture)]
    flip: Option<PathBuf>,
    /// Difference in percent of the display's range, 255 codes, beyond which a pixel counts as
    /// changed.
    #[arg(long, value_name = "PERCENT", default_value = "4", value_parser = values::percent)]
    threshold: f64,
    /// Exposure in stops at which FLIP and the changed pixels are seen, -30 to 30.
    #[arg(long, value_name = "EV", default_value = "0", value_parser = values::exposure)]
    exposure: f32,
    /// Tone curve through which FLIP and the changed pixels are seen.
    #[arg(long, value_name = "CURVE", default_value = "srgb", value_parser = values::curve())]
    tone: Curve,
}

/// Bytes a pixel that both pictures, their errors and both kinds of FLIP take at most; measured.
const PIXEL: u64 = 120;

/// Measures, prints and writes.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let files = || args.output.iter().chain(&args.flip);
    outputs::are_distinct(files());
    outputs::are_no_inputs(files(), [args.picture.as_path(), &args.reference])?;
    outputs::can_be_written(files())?;
    let part = args.part.as_deref();
    let picture = read(&args.picture, part, "--part")?;
    let pixels = picture.pixels.len() as u64;
    fits(pixels * PIXEL, || format!("to compare pictures of {}x{}", picture.width, picture.height))
        .map_err(Failure::new)?;
    let part = args.reference_part.as_deref().or(part);
    let reference = Reference::known(read(&args.reference, part, "--reference-part")?);
    let pair = Pair::new(&picture, &reference).map_err(Failure::new)?;
    let tone = Tone { exposure: args.exposure, curve: args.tone };
    let seen = Flip::tone_mapped(&pair, tone);
    print_measures(args, &pair, &seen)?;
    let mut failures = Failures::default();
    failures.note(false_colours(args, &pair));
    failures.note(seen_colours(args, seen));
    failures.finish()
}

fn false_colours(args: &Args, pair: &Pair) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        let difference = PictureDifference::new(pair);
        let scale = args.scale.unwrap_or_else(|| difference.scale());
        save(path, &difference.false_colour(scale))?;
        print(format_args!(
            "{}: {}; blue -{end} or less, white 0, red +{end} or more, magenta undefined",
            plain::path(path),
            difference::FORMULA,
            end = significant(scale.into(), 3)
        ))?;
    }
    Ok(())
}

fn seen_colours(args: &Args, seen: Result<Flip, String>) -> Result<(), Failure> {
    if let Some(path) = &args.flip {
        let colours = seen.and_then(|flip| flip.false_colour()).map_err(Failure::new)?;
        save(path, &colours)?;
        print(format_args!(
            "{}: FLIP of every pixel; black 0, violet 0.3, orange 0.7, pale yellow 1",
            plain::path(path)
        ))?;
    }
    Ok(())
}

fn print_measures(args: &Args, pair: &Pair, seen: &Result<Flip, String>) -> Result<(), Failure> {
    let Picture { width, height, .. } = pair.picture();
    let (x, r) = (plain::path(&args.picture), plain::path(&args.reference));
    print(format_args!(
        "x = {x}, r = {r}, {width}x{height}; s = 0, for r's own noise is not known"
    ))?;
    match pair.left_out() {
        0 => {}
        n => print(format_args!("left out: {n} pixels with NaN or infinity in x or r"))?,
    }
    let row = |name: &str, value: &str, formula: &str| {
        print(format_args!("{name:<22}{value:>12}   {formula}"))
    };
    // The noise of a picture from a file is not known: its row would say 0.
    for measure in ALL.iter().filter(|m| m.column != REFERENCE_NOISE.column) {
        row(measure.name, &figure(measure.of(pair)), measure.formula)?;
        if measure.column == MEAN_ERROR.column {
            let margin = pair.mean_error_margin().unwrap_or(f64::NAN);
            let how = "95 %, from the spread of the means of 8x8 blocks";
            row("    +- interval", &figure(margin), how)?;
        }
    }
    let tone = Tone { exposure: args.exposure, curve: args.tone };
    let changed = difference::changed(pair, tone, 0.01 * args.threshold);
    let formula = format!("{} than {} % of 255", difference::CHANGED_FORMULA, args.threshold);
    row("changed pixels", &figure(changed), &formula)?;
    for (name, flip, formula) in
        [("FLIP", seen, flip::FORMULA), ("HDR-FLIP", &Flip::hdr(pair), flip::HDR_FORMULA)]
    {
        match flip {
            Ok(flip) => row(name, &figure(flip.mean()), formula)?,
            Err(why) => row(name, "-", &format!("no answer: {why}"))?,
        }
    }
    Ok(())
}

/// Five digits are enough to tell two runs apart.
fn figure(value: f64) -> String {
    significant(value, 5)
}

/// Pictures of radiance alone can be measured: a PNG file has been through a tone curve.
fn read(path: &Path, part: Option<&str>, option: &str) -> Result<Picture, Failure> {
    let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    if !exr {
        return Err(Failure::new(format_args!(
            "{}: only OpenEXR pictures (.exr) can be compared, which hold radiance; \
             `burnish render -o picture.exr` writes one",
            plain::path(path)
        )));
    }
    let read = read_exr_part(path, part).map_err(Failure::new)?;
    for remark in &read.remarks {
        talk::note(format_args!("{}: {remark}", plain::path(path)));
    }
    if part.is_none() && read.choices > 1 {
        talk::note(format_args!("{}: {option} NAME chooses another", plain::path(path)));
    }
    Ok(read.picture)
}

fn save(path: &Path, colours: &Picture) -> Result<(), Failure> {
    write(path, colours, Tone::default()).map_err(Failure::new)
}
