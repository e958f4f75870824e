//! What `burnish check --full` proves beyond the BRDF: the whole renderer against scenes whose
//! answer is known, and its error bar against many renders.

use crate::cli::{Failure, print, say};
use burnish::measure::calibrate::Renders;
use burnish::measure::exact::{self, CaseBudget, CaseOutcome, CaseTable, CaseVerdict};
use burnish::progressive::Params;
use burnish::scene::builtin::Example;
use std::ops::Range;
use std::sync::Arc;

/// Of the scenes that are drawn at random and have a known answer: their seeds.
pub(super) const DRAWN: Range<u64> = 0..308;

/// Renders all scenes whose answer is known; how many differ, or stay unresolved.
pub(super) fn exact_scenes() -> Result<usize, Failure> {
    print("Scenes whose answer is known: within 4 standard errors and 0.1 %")?;
    let table = exact::all().map_err(Failure::new)?;
    figures(table, CaseBudget::FULL, true, false)
}

/// The same of scenes drawn at random, of which those are told that do not agree, or all.
pub(super) fn drawn_scenes(seeds: Range<u64>, all: bool) -> Result<usize, Failure> {
    print(format_args!(
        "Scenes whose answer is known, drawn at random, turned, scaled and moved: within 4 standard \
         errors and 0.1 %; {} figures{}",
        seeds.end - seeds.start,
        if all { "" } else { ", those that do not agree" }
    ))?;
    let table = exact::drawn(seeds).map_err(Failure::new)?;
    figures(table, CaseBudget::DRAWN, all, true)
}

fn figures(table: CaseTable, budget: CaseBudget, all: bool, drawn: bool) -> Result<usize, Failure> {
    print(format_args!(
        "  {:<14}{:<20}{:<14}{:>12}{:>12}{:>11}{:>8}{:>11}  verdict",
        "scene", "kind", "quantity", "expected", "mean", "std. error", "sigmas", "relative"
    ))?;
    let mut told = Ok(());
    let (mut nonfinite, mut done, count) = (0, 0, table.cases.len());
    let summary = table.run(budget, &mut |o| {
        nonfinite += o.counts.nonfinite;
        done += 1;
        if done % 50 == 0 {
            say(format_args!("scenes whose answer is known: {done} of {count}"));
        }
        if told.is_ok() && (all || o.verdict != CaseVerdict::Agrees) {
            told = figure(o, drawn);
        }
    });
    told?;
    let summary = summary.map_err(Failure::new)?;
    for left in &summary.left_out {
        print(format_args!("  {:<14}{:<20}left out: {}", left.id, left.quantity, left.reason))?;
    }
    let failed = summary.failed + summary.unresolved;
    print(format_args!(
        "  {} figures, {failed} of which do not agree; mean square of the sigmas {:.2} over {} \
         noisy ones; {nonfinite} samples not finite\n",
        summary.cases, summary.mean_square, summary.noisy
    ))?;
    Ok(failed + usize::from(nonfinite > 0))
}

fn figure(o: &CaseOutcome, drawn: bool) -> Result<(), Failure> {
    let verdict = match o.verdict {
        CaseVerdict::Agrees => "agrees",
        CaseVerdict::Differs => "DIFFERS",
        CaseVerdict::Unresolved => "UNRESOLVED: too noisy to tell",
    };
    print(format_args!(
        "  {:<14}{:<20}{:<14}{:>12.5e}{:>12.5e}{:>11.1e}{:>8.2}{:>11.1e}  {verdict}",
        o.case.id,
        o.case.group,
        o.case.quantity,
        o.case.expected,
        o.mean,
        o.standard_error,
        o.sigmas,
        o.relative_error,
    ))?;
    match o.verdict {
        CaseVerdict::Agrees => Ok(()),
        _ if drawn => print(format_args!("    {}", o.case.description())),
        _ => Ok(()),
    }
}

/// Scenes of the calibration, all at this size: small, so that lamps are smaller than pixels.
const SCENES: [&str; 3] = ["shell", "cornell", "plates"];
const SIZE: [u32; 2] = [64, 48];
const RENDERS: u64 = 200;
const PASSES: [u64; 4] = [16, 32, 64, 256];
/// Of which this one's error is what renders are to stop at, less a tenth.
const WANTED: u64 = 64;

/// A figure of those renders that call theirs reliable; there may be none.
fn of_reliable(figure: f64) -> String {
    if figure.is_nan() { "-".into() } else { format!("{figure:.3}") }
}

/// Renders three scenes 200 times each; how many figures are out of bounds.
pub(super) fn error_bar(threads: usize) -> Result<usize, Failure> {
    let mut failures = 0;
    for name in SCENES {
        let Some(example) = Example::named(name) else { continue };
        let (builder, _) = example.read().map_err(Failure::new)?;
        let params = Params { size: SIZE, ..Params::new(Arc::new(builder.build())) };
        let progress = |what: &'static str| {
            move |done: u64| {
                if done.is_multiple_of(50) {
                    say(format_args!("{name}: {done} of {RENDERS} renders {what}"));
                }
            }
        };
        let renders = Renders::new(&params, &PASSES, RENDERS, threads, &mut progress("done"))
            .map_err(Failure::new)?;
        print(format_args!(
            "The error bar: {} ({}x{}), {RENDERS} renders, each against the mean of the others",
            example.title, SIZE[0], SIZE[1]
        ))?;
        print(format_args!(
            "  {:>6}{:>14}{:>18}{:>18}{:>14}{:>13}{:>11}",
            "passes",
            "pixels held",
            "est./true RMSE",
            "est./true rel.",
            "under limit",
            "reliable",
            "rel. error"
        ))?;
        let mut wanted = 0.0;
        for c in renders.calibrations() {
            print(format_args!(
                "  {:>6}{:>14.3}{:>18.3}{:>18}{:>14}{:>13.3}{:>11.4}",
                c.passes,
                c.coverage,
                c.rmse_ratio,
                of_reliable(c.relative_ratio),
                of_reliable(c.below_limit),
                c.reliable,
                c.relative
            ))?;
            failures += c.faults();
            if c.passes == WANTED {
                wanted = 0.9 * c.relative;
            }
        }
        let stopped = renders
            .stopped(wanted, RENDERS, threads, &mut progress("stopped at the error asked for"))
            .map_err(Failure::new)?;
        failures += stopped.faults();
        print(format_args!(
            "  stopped at a relative error of {:.2} %: kept by {:.1} % of the renders (at least \
             95), after {:.0} passes in the mean",
            100.0 * stopped.wanted,
            100.0 * stopped.kept,
            stopped.passes
        ))?;
        let cost = renders.cost_of_replicates(WANTED, 32);
        print(format_args!(
            "  squared error of {WANTED} passes in four replicates over that in one: {cost:.2}\n"
        ))?;
    }
    print(
        "  bounds: pixels held 0.92 to 0.97 from 256 passes on; est./true 0.8 to 1.25 from 16 \
         passes on (relative: over the renders that call theirs reliable); under limit 0.9 or more",
    )?;
    Ok(failures)
}
