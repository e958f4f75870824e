//! `burnish check --scene`, and the scenes drawn at random of `--full`.

use crate::cli::{Failure, print, say};
use burnish::measure::random::{
    self, Budget, JudgedScene, LOOKS, REGIONS, RandomScene, SUSPECT, Verdict,
};
use std::ops::Range;

/// Scenes of `--full`.
const FULL: Range<u64> = 0..500;

/// `A` or `A..B`, B not included.
pub(super) fn seeds(text: &str) -> Result<Range<u64>, String> {
    let number = |text: &str| text.parse::<u64>().map_err(|e| format!("`{text}`: {e}"));
    let range = match text.split_once("..") {
        Some((first, end)) => number(first)?..number(end)?,
        None => {
            let one = number(text)?;
            one..one.checked_add(1).ok_or("too large")?
        }
    };
    if range.is_empty() { Err("no scene is in that range".into()) } else { Ok(range) }
}

/// The scenes of `--full`; how many differ.
pub(super) fn all() -> Result<usize, Failure> {
    some(FULL, false)
}

/// These scenes, with all that is in them if there is but one; how many differ.
pub(super) fn some(seeds: Range<u64>, told: bool) -> Result<usize, Failure> {
    let count = seeds.end - seeds.start;
    if count == 1 {
        let scene = RandomScene::draw(seeds.start).map_err(Failure::new)?;
        print(format_args!("Random scene {}: {}", scene.seed, scene.kind.name()))?;
        print(&scene.description)?;
    }
    print(format_args!(
        "Scenes drawn at random, engine against reference tracer: no region beyond {SUSPECT} \
         standard errors at {LOOKS} looks, and 0.1 %"
    ))?;
    print(format_args!(
        "  {:>6}  {:<18}{:>12}{:>12}{:>8}{:>10}{:>8}{:>10}{:>7}{:>8}{:>10}  verdict",
        "seed",
        "kind",
        "reference",
        "engine",
        "sigmas",
        "relative",
        "=sigmas",
        "=relative",
        "looks",
        "region",
        "effect"
    ))?;
    let mut done = 0;
    let mut printed = Ok(());
    let summary = random::run(seeds, Budget::FULL, &mut |outcome| {
        done += 1;
        if done % 50 == 0 {
            say(format_args!("random scenes: {done} of {count}"));
        }
        if (told || outcome.verdict == Verdict::Differs) && printed.is_ok() {
            printed = row(outcome);
        }
    });
    printed?;
    let summary = summary.map_err(Failure::new)?;
    let failed = summary.failed.len();
    print(format_args!(
        "  {} scenes, {failed} of which differ; engine over reference, mean of all scenes: {:+.1e} \
         +- {:.1e}; mean square of the sigmas {:.2}; {} samples not finite",
        summary.scenes,
        summary.pooled,
        summary.pooled_error,
        summary.mean_square,
        summary.nonfinite
    ))?;
    if failed > 0 {
        let seeds: Vec<String> = summary.failed.iter().map(|(s, _)| s.to_string()).collect();
        print(format_args!("  `burnish check --scene SEED` shows one again: {}", seeds.join(" ")))?;
    }
    print("")?;
    Ok(failed + usize::from(!summary.pooled_holds()))
}

fn row(o: &JudgedScene) -> Result<(), Failure> {
    let first = o.first();
    let [same, part] = o.same_numbers();
    let (region, effect) = match o.worst() {
        Some((region, effect)) => (place(region), format!("{effect:+.1e}")),
        None => ("-".to_owned(), "-".to_owned()),
    };
    print(format_args!(
        "  {:>6}  {:<18}{:>12.4e}{:>12.4e}{:>8.2}{:>10.1e}{same:>8.2}{part:>10.1e}{:>7}{region:>8}\
         {effect:>10}  {}",
        o.seed,
        o.kind.name(),
        first.reference,
        first.engine,
        first.sigmas,
        o.relative(),
        o.looks.len(),
        match o.verdict {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "DIFFERS",
        }
    ))
}

/// A region's name: its number or the whole; `=` if it is of the same random numbers.
fn place(region: usize) -> String {
    let same = if region < REGIONS { "" } else { "=" };
    match region % REGIONS + 1 {
        REGIONS => format!("{same}whole"),
        number => format!("{same}{number}"),
    }
}
