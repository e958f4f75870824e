//! Rendering a case, and judging what came out.

use super::stage::Stage;
use super::{Case, ExactError, LeftOut, all};
use crate::progressive::{Counts, Options, Params, Session, Snapshot, State};

/// Standard errors that chance is allowed: outside once in 16,000.
const SIGMAS: f64 = 4.0;
/// Passes of the first look; a multiple of the replicates.
const FIRST: u64 = 16;

/// When to stop.
///
/// Passes are doubled until the standard error is small enough. The decision reads the standard
/// error alone, which comes from some thousands of degrees of freedom and hardly varies: that it
/// draws the mean towards runs of small spread is far below one standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Enough when the standard error is this fraction of the expected value.
    pub relative: f64,
    /// Paths at most.
    pub paths: u64,
}

impl Budget {
    /// Every mean to 1e-3 at four standard errors.
    pub const FULL: Budget = Budget { relative: 2.5e-4, paths: 1 << 28 };
    /// A look at each case in some tens of milliseconds: to 1 %.
    pub const QUICK: Budget = Budget { relative: 2.5e-3, paths: 1 << 20 };
}

/// What the comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within four standard errors and within the relative limit.
    Agrees,
    /// Not so, or samples were not finite.
    Differs,
    /// Within four standard errors, which the budget's paths left too large to tell more.
    Noisy,
}

/// A case after its rendering.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What was asked.
    pub case: Case,
    /// Mean of what was rendered.
    pub mean: f64,
    /// Its standard error, from the replicates of every pixel.
    pub standard_error: f64,
    /// What the construction and the answer's own error may add, absolute.
    pub allowance: f64,
    /// By how many standard errors the mean lies beyond the allowance; signed.
    pub sigmas: f64,
    /// `mean / expected - 1`.
    pub relative_error: f64,
    /// Paths, rays, and samples that were not finite.
    pub counts: Counts,
    /// Whether it agrees.
    pub verdict: Verdict,
}

/// All cases together.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Cases rendered.
    pub cases: usize,
    /// Of those, how many did not agree.
    pub failed: usize,
    /// Mean square of the sigmas where noise, not the allowance, decides: about 1 when the standard
    /// errors are true.
    pub mean_square: f64,
    /// How many that mean is over.
    pub noisy: usize,
    /// What was not asked, and why.
    pub left_out: Vec<LeftOut>,
}

/// Renders every case of [`all`] on all cores, and hands out each as it is done.
pub fn run_all(budget: Budget, each: &mut dyn FnMut(&Outcome)) -> Result<Summary, ExactError> {
    let table = all()?;
    let mut summary = Summary { left_out: table.left_out, ..Summary::default() };
    let mut squares = 0.0;
    for case in table.cases {
        let outcome = case.run(budget)?;
        summary.cases += 1;
        summary.failed += usize::from(outcome.verdict != Verdict::Agrees);
        if outcome.standard_error > 5.0 * outcome.allowance {
            summary.noisy += 1;
            let off = outcome.mean - outcome.case.expected;
            squares += (off / outcome.standard_error).powi(2);
        }
        each(&outcome);
    }
    summary.mean_square = squares / summary.noisy.max(1) as f64;
    Ok(summary)
}

impl Case {
    /// What is rendered, with a seed of the case's own.
    pub fn params(&self) -> Result<Params, ExactError> {
        Ok(self.seeded()?.params)
    }

    fn seeded(&self) -> Result<Stage, ExactError> {
        let mut stage = self.stage()?;
        let name = self.id.bytes().chain(self.quantity.bytes());
        stage.params.seed =
            name.fold(1, |seed: u64, byte| seed.wrapping_mul(0x0100_0000_01b3) ^ byte as u64);
        Ok(stage)
    }

    /// Renders on all cores until the budget is met or spent.
    pub fn run(&self, budget: Budget) -> Result<Outcome, ExactError> {
        let stage = self.seeded()?;
        let pixels: u64 = stage.params.size.iter().map(|&side| side as u64).product();
        let mut passes = FIRST;
        let options = Options::headless(0);
        let session = Session::with_options(stage.params.clone(), passes, options, || {})?;
        loop {
            let snapshot = finished(&session, passes)?;
            let outcome = self.judge(&stage, budget, &snapshot);
            if outcome.verdict != Verdict::Noisy || 2 * passes * pixels > budget.paths {
                return Ok(outcome);
            }
            passes *= 2;
            session.set_limit(passes);
        }
    }

    fn judge(&self, stage: &Stage, budget: Budget, snapshot: &Snapshot) -> Outcome {
        let (mean, standard_error) = whole(snapshot);
        let mean = (mean - stage.rest) / stage.share;
        let standard_error = standard_error / stage.share;
        let off = mean - self.expected;
        let allowance = self.error + stage.bound * self.expected;
        let limit = SIGMAS * budget.relative * self.expected + self.error;
        let told = SIGMAS * standard_error <= limit;
        let close = beyond(off, allowance).abs() <= SIGMAS * standard_error;
        let verdict = if snapshot.counts.nonfinite > 0 || (told && !close) {
            Verdict::Differs
        } else if !told {
            Verdict::Noisy
        } else if off.abs() <= limit {
            Verdict::Agrees
        } else {
            Verdict::Differs
        };
        Outcome {
            mean,
            standard_error,
            allowance,
            sigmas: beyond(off, allowance) / standard_error.max(f64::MIN_POSITIVE),
            relative_error: off / self.expected,
            counts: snapshot.counts,
            verdict,
            case: self.clone(),
        }
    }
}

/// How far `off` from zero goes beyond what is allowed; signed.
fn beyond(off: f64, allowance: f64) -> f64 {
    (off.abs() - allowance).max(0.0).copysign(off)
}

/// Waits for this many passes.
fn finished(session: &Session, passes: u64) -> Result<Snapshot, ExactError> {
    for snapshot in session.snapshots() {
        match snapshot.state {
            State::Failed(reason) => return Err(ExactError::Failed(reason)),
            State::Done if snapshot.passes >= passes => return Ok(snapshot),
            _ => {}
        }
    }
    Err(ExactError::Failed("the renderer stopped without a word".to_owned()))
}

/// Mean of the whole picture and its standard error. Everything here is grey: one channel is
/// enough. Pixels are independent, so that their variances, each from few replicates, add up to one
/// with many degrees of freedom.
fn whole(snapshot: &Snapshot) -> (f64, f64) {
    let (mut sum, mut variance, mut pixels) = (0.0, 0.0, 0.0);
    for tile in snapshot.tiles.iter().flatten() {
        sum += tile.mean.iter().map(|p| p[0] as f64).sum::<f64>();
        variance += tile.standard_error.iter().map(|p| (p[0] as f64).powi(2)).sum::<f64>();
        pixels += tile.mean.len() as f64;
    }
    (sum / pixels, variance.sqrt() / pixels)
}
