//! Rendering a case, and judging what came out.

use super::stage::ExactStage;
use super::{Case, CaseTable, ExactError, LeftOut, all};
use crate::film::normal_score;
use crate::progressive::{Counts, Options, Params, Session, Snapshot, State};

/// Standard errors that chance is allowed: outside once in 16,000.
const SIGMAS: f64 = 4.0;
/// Pictures that each case is rendered to, of different seeds. Pixels of one picture share, so that
/// their errors are alike; those of the pictures have nothing to do with each other.
const PICTURES: u64 = 32;
/// Passes of each at the first look.
const FIRST: u64 = 2;

/// When to stop.
///
/// Passes are doubled until the standard error is small enough. The decision reads the standard
/// error alone, which comes from 31 degrees of freedom and varies by an eighth: that it draws the
/// mean towards runs of small spread is far below one standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaseBudget {
    /// Enough when the standard error is this fraction of the expected value. The mean has to be
    /// right to four times as much. Where the rays are spent before, twice the fraction will do to
    /// tell; a larger noise leaves the case unresolved.
    pub relative: f64,
    /// Rays that may be spent on a case, about.
    pub rays: u64,
}

impl CaseBudget {
    /// Every mean to 1e-3, which is four standard errors, or two where the rays do not suffice.
    pub const FULL: CaseBudget = CaseBudget { relative: 2.5e-4, rays: 1 << 31 };
    /// The same for the hundreds of cases that are [drawn](super::drawn), in some seconds each.
    pub const DRAWN: CaseBudget = CaseBudget { relative: 2.5e-4, rays: 1 << 26 };
    /// A look at each case in some tens of milliseconds: to 1 %.
    pub const QUICK: CaseBudget = CaseBudget { relative: 2.5e-3, rays: 1 << 25 };
}

/// What the comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseVerdict {
    /// Within four standard errors and within the relative limit.
    Agrees,
    /// Not so, or samples were not finite.
    Differs,
    /// Within four standard errors, which the budget's rays left too large for the second rule.
    Unresolved,
}

/// A case after its rendering.
#[derive(Clone, Debug)]
pub struct CaseOutcome {
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
    pub verdict: CaseVerdict,
}

/// All cases together.
#[derive(Clone, Debug, Default)]
pub struct ExactSummary {
    /// Cases rendered.
    pub cases: usize,
    /// Of those, how many differ.
    pub failed: usize,
    /// And how many are unresolved.
    pub unresolved: usize,
    /// Mean square of the sigmas where noise, not the allowance, decides: about 1 when the standard
    /// errors are true.
    pub mean_square: f64,
    /// How many that mean is over.
    pub noisy: usize,
    /// What was not asked, and why.
    pub left_out: Vec<LeftOut>,
}

/// Renders every case of [`all`] on all cores, and hands out each as it is done.
pub fn run_all(
    budget: CaseBudget,
    each: &mut dyn FnMut(&CaseOutcome),
) -> Result<ExactSummary, ExactError> {
    all()?.run(budget, each)
}

impl CaseTable {
    /// Renders its cases on all cores, and hands out each as it is done.
    pub fn run(
        self,
        budget: CaseBudget,
        each: &mut dyn FnMut(&CaseOutcome),
    ) -> Result<ExactSummary, ExactError> {
        let mut summary = ExactSummary { left_out: self.left_out, ..ExactSummary::default() };
        let mut squares = 0.0;
        for case in self.cases {
            let outcome = case.run(budget)?;
            summary.cases += 1;
            summary.failed += usize::from(outcome.verdict == CaseVerdict::Differs);
            summary.unresolved += usize::from(outcome.verdict == CaseVerdict::Unresolved);
            if outcome.standard_error > 5.0 * outcome.allowance {
                let off = outcome.mean - outcome.case.expected;
                summary.noisy += 1;
                squares += score(off, outcome.standard_error).powi(2);
            }
            each(&outcome);
        }
        summary.mean_square = squares / summary.noisy.max(1) as f64;
        Ok(summary)
    }
}

impl Case {
    /// What is rendered, with a seed of the case's own.
    pub fn params(&self) -> Result<Params, ExactError> {
        Ok(self.seeded()?.params)
    }

    fn seeded(&self) -> Result<ExactStage, ExactError> {
        let mut stage = self.stage()?;
        let name = self.id.bytes().chain(self.quantity.bytes());
        stage.params.seed =
            name.fold(1, |seed: u64, byte| seed.wrapping_mul(0x0100_0000_01b3) ^ byte as u64);
        Ok(stage)
    }

    /// Renders on all cores until the budget is met or spent.
    pub fn run(&self, budget: CaseBudget) -> Result<CaseOutcome, ExactError> {
        let stage = self.seeded()?;
        let mut passes = FIRST;
        let sessions: Vec<Session> = (0..PICTURES)
            .map(|picture| {
                let mut params = stage.params.clone();
                params.seed = params.seed.wrapping_add(picture);
                Session::with_options(params, passes, Options::headless(1), || {})
            })
            .collect::<Result<_, _>>()?;
        loop {
            let snapshots: Vec<Snapshot> =
                sessions.iter().map(|s| finished(s, passes)).collect::<Result<_, _>>()?;
            let outcome = self.judge(&stage, budget, &snapshots);
            let spent = 2 * outcome.counts.rays > budget.rays;
            if spent || outcome.resolved(budget) {
                return Ok(outcome);
            }
            passes *= 2;
            for session in &sessions {
                session.set_limit(passes);
            }
        }
    }

    fn judge(&self, stage: &ExactStage, budget: CaseBudget, snapshots: &[Snapshot]) -> CaseOutcome {
        let (mean, standard_error) = whole(snapshots);
        let counts = snapshots.iter().fold(Counts::default(), |sum, s| sum + s.counts);
        let mean = (mean - stage.rest) / stage.share;
        let standard_error = standard_error / stage.share;
        let off = mean - self.expected;
        let allowance = self.error + stage.bound * self.expected;
        let mut outcome = CaseOutcome {
            mean,
            standard_error,
            allowance,
            sigmas: score(beyond(off, allowance), standard_error),
            relative_error: off / self.expected,
            counts,
            verdict: CaseVerdict::Unresolved,
            case: self.clone(),
        };
        let close = outcome.sigmas.abs() <= SIGMAS && counts.nonfinite == 0;
        outcome.verdict = match outcome.is_told(budget) {
            true if close && off.abs() <= outcome.limit(budget) => CaseVerdict::Agrees,
            false if close => CaseVerdict::Unresolved,
            _ => CaseVerdict::Differs,
        };
        outcome
    }
}

impl CaseOutcome {
    /// How far the mean may be off by the second rule.
    fn limit(&self, budget: CaseBudget) -> f64 {
        SIGMAS * budget.relative * self.case.expected + self.case.error
    }

    /// Whether the noise is small enough to stop.
    fn resolved(&self, budget: CaseBudget) -> bool {
        SIGMAS * self.standard_error <= self.limit(budget)
    }

    /// Whether the noise that is left would hide what the second rule asks for. Where light goes a
    /// hundred times to and fro a budget ends before the noise is as small as it should be.
    fn is_told(&self, budget: CaseBudget) -> bool {
        0.5 * SIGMAS * self.standard_error <= self.limit(budget)
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

/// How many standard deviations of a normal number are as rare as this.
fn score(off: f64, standard_error: f64) -> f64 {
    normal_score(off / standard_error.max(f64::MIN_POSITIVE), (PICTURES - 1) as f64)
}

/// Mean of all pixels of all pictures and its standard error, by the spread of the pictures.
/// Everything here is grey: one channel is enough.
fn whole(pictures: &[Snapshot]) -> (f64, f64) {
    let count = pictures.len() as f64;
    let means = pictures.iter().map(|picture| {
        let tiles = || picture.tiles.iter().flatten();
        let sum: f64 = tiles().flat_map(|tile| &tile.mean).map(|p| f64::from(p[0])).sum();
        sum / tiles().map(|tile| tile.mean.len()).sum::<usize>() as f64
    });
    let mean = means.clone().sum::<f64>() / count;
    let squares: f64 = means.map(|m| (m - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}
