//! `burnish merge`: parts of a picture as one.

use super::talk::{say, warning};
use super::{Failure, checkpoint, outputs, values};
use burnish::plain;
use burnish::progressive::Experiment;
use std::path::{Path, PathBuf};

/// Adds the passes of parts that `render --part` has written: to the bit what one render of all of
/// them would be, in any order.
///
/// Parts of other recipes, and such as have a pass that another has too, are refused by name, and
/// nothing is written. What is lacking is told; it can be merged with the result later.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish merge part-*.exr -o table.exr
  burnish merge table.exr part-17.exr -o whole.exr      one that came late")]
pub(super) struct Args {
    /// Experiments of one recipe.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Experiment to write, an OpenEXR file.
    #[arg(short, long = "output", value_name = "FILE", value_parser = values::experiment)]
    output: PathBuf,
}

/// Reads one after the other, adds them and writes.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let output = args.output.as_path();
    outputs::are_no_inputs([&args.output], args.files.iter().map(PathBuf::as_path))?;
    outputs::can_be_written([&args.output])?;
    let (first, others) = args.files.split_first().ok_or_else(|| Failure::new("no files"))?;
    let mut whole = checkpoint::read(first)?;
    let mut merged: Vec<(&Path, Vec<[u64; 2]>)> = vec![(first, whole.spans().to_vec())];
    for path in others {
        let part = checkpoint::read(path)?;
        // Of all that are in it already, the one that has the same passes.
        let overlaps = |spans: &[[u64; 2]]| {
            let both = |a: &[u64; 2], b: &[u64; 2]| a[0].max(b[0]) < a[1].min(b[1]);
            spans.iter().any(|a| part.spans().iter().any(|b| both(a, b)))
        };
        let clash = merged.iter().find(|(_, spans)| overlaps(spans)).map(|(path, _)| *path);
        whole.merge(&part).map_err(|e| {
            let other = plain::path(clash.unwrap_or(first));
            Failure::new(format_args!("{}, beside {other}: {e}", plain::path(path)))
        })?;
        merged.push((path, part.spans().to_vec()));
    }
    whole.save(output).map_err(Failure::new)?;
    say(format_args!("{}: {}", plain::path(output), told(&whole)));
    let lacking = lacking(&whole);
    if !lacking.is_empty() {
        warning(format_args!("{}: it lacks passes {}", plain::path(output), lacking.join(", ")));
    }
    Ok(())
}

/// What is in it.
fn told(whole: &Experiment) -> String {
    let (_, error, _) = whole.picture();
    let error = error.map_or(String::new(), |e| {
        let [value, low, high] =
            [e.relative.value, e.relative.interval.low, e.relative.interval.high]
                .map(|x| 100.0 * x);
        format!(", relative error {value:.2} % (estimated; 95 % limits {low:.2} to {high:.2} %)")
    });
    format!("{}{error}", super::progress::passes(whole.passes()))
}

/// The passes that the whole picture has besides.
fn lacking(whole: &Experiment) -> Vec<String> {
    let mut lacking = Vec::new();
    let mut next = 0;
    let end = whole.goal.passes.map(|passes| [passes, passes]);
    for [from, to] in whole.spans().iter().copied().chain(end) {
        if from > next {
            lacking.push(format!("{next} to {}", from - 1));
        }
        next = next.max(to);
    }
    lacking
}
