//! All repeats of a variant in a few figures.

use super::super::error::{self, Measure, REL_MEAN_ERROR, REL_RMSE, Reference};
use super::{Fit, Point, Run, SpeedExperiment, Spread, Variant};

/// A variant over all repeats.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Which.
    pub variant: Variant,
    /// What its checkpoints cost and how wrong they are.
    pub checkpoints: Vec<Checkpoint>,
    /// Slope of ln relative RMSE over ln passes: -1/2 for independent samples, steeper where they
    /// are well stratified, flatter where rare bright paths have yet to be met.
    ///
    /// A line is fitted to the checkpoints of each repeat; the slope is the mean over repeats, and
    /// its standard error that of their spread, for the checkpoints of one repeat share samples
    /// and are not independent. With one repeat it is the fit's own standard error, too small for
    /// that reason.
    pub slope: Option<Fit>,
    /// The last checkpoint's relative mean error, the mean over repeats, and half the width of its
    /// 95 % interval; the latter `None` with one repeat.
    pub mean_error: (f64, Option<f64>),
    /// FLIP and HDR-FLIP of the last checkpoint; NaN where they have no answer.
    pub flip: [Spread; 2],
}

/// A checkpoint over all repeats.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// Samples in every pixel.
    pub passes: u64,
    /// Spent tracing.
    pub seconds: Spread,
    /// Traced, of all kinds.
    pub rays: Spread,
    /// [`Point::efficiency`].
    pub efficiency: Spread,
    errors: [Spread; error::ALL.len()],
}

impl Checkpoint {
    /// A measure over the repeats.
    pub fn error(&self, measure: Measure) -> Spread {
        let place = error::ALL.iter().position(|m| m.column == measure.column);
        place.map_or(Spread::of([]), |i| self.errors[i])
    }
}

impl SpeedExperiment {
    /// One for each variant, in the plan's order.
    pub fn summaries(&self) -> Vec<Summary> {
        let first = self.runs.iter().filter(|run| run.repeat == 0);
        first.map(|run| self.summary(run.variant)).collect()
    }

    fn summary(&self, variant: Variant) -> Summary {
        let runs: Vec<&Run> = self.runs.iter().filter(|run| run.variant == variant).collect();
        let most = runs.iter().map(|run| run.points.len()).max().unwrap_or(0);
        let checkpoints = (0..most).map(|i| {
            let points: Vec<&Point> = runs.iter().filter_map(|run| run.points.get(i)).collect();
            Checkpoint::of(&points)
        });
        let reference = self.references.iter().find(|(model, _)| *model == variant.model);
        Summary {
            variant,
            checkpoints: checkpoints.collect(),
            slope: slope(&runs),
            mean_error: mean_error(&runs, reference.map(|(_, reference)| reference)),
            flip: [0, 1].map(|i| Spread::of(runs.iter().filter_map(|run| run.flip[i]))),
        }
    }
}

impl Checkpoint {
    fn of(points: &[&Point]) -> Checkpoint {
        let spread = |value: &dyn Fn(&Point) -> f64| Spread::of(points.iter().map(|p| value(p)));
        Checkpoint {
            passes: points.first().map_or(0, |p| p.passes),
            seconds: spread(&|p| p.seconds),
            rays: spread(&|p| p.rays as f64),
            efficiency: spread(&Point::efficiency),
            errors: std::array::from_fn(|i| spread(&|p| p.errors[i])),
        }
    }
}

fn slope(runs: &[&Run]) -> Option<Fit> {
    let logs = |p: &Point| [(p.passes as f64).ln(), p.error(REL_RMSE).ln()];
    let fits: Vec<Fit> =
        runs.iter().filter_map(|run| Fit::line(run.points.iter().map(logs))).collect();
    let n = fits.len() as f64;
    match fits[..] {
        [] => None,
        [only] => Some(only),
        _ => {
            let slope = fits.iter().map(|f| f.slope).sum::<f64>() / n;
            let squares = fits.iter().map(|f| (f.slope - slope).powi(2)).sum::<f64>();
            Some(Fit { slope, standard_error: (squares / (n - 1.0) / n).sqrt() })
        }
    }
}

/// The signed error over independent renders: their mean, and Student's interval from their spread,
/// widened by the reference's own error, which all of them share. Nothing is assumed about pixels,
/// which differ in all that a variance depends on.
fn mean_error(runs: &[&Run], reference: Option<&Reference>) -> (f64, Option<f64>) {
    let last = |run: &&Run| run.points.last().map(|p| p.error(REL_MEAN_ERROR));
    let errors: Vec<f64> = runs.iter().filter_map(last).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let shared = 1.96 * reference.map_or(0.0, Reference::relative_error_of_mean);
    (mean, error::mean_margin(&errors).map(|margin| margin.hypot(shared)))
}
