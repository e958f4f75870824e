//! Speed against error: the error after 1, 2, 4, ... passes, with the seconds and rays they took,
//! for one way of rendering beside another.
//!
//! Every repeat renders every variant once before the next begins (A B C A B C ...), so that a
//! machine that slows down slows them alike; a warm-up that counts for nothing goes before. Each
//! repeat has a seed of its own, so what is spread over repeats is the noise of the samples as well
//! as that of the machine's speed. Seconds are those of tracing alone.

mod fit;
mod spread;
mod summary;

pub use fit::Fit;
pub use spread::Spread;
pub use summary::{Checkpoint, Summary};

use super::error::{ALL, Measure, Pair, PairError, REL_MSE, Reference};
use super::flip::Flip;
use crate::brdf::{Model, Normals};
use crate::picture::Tone;
use crate::progressive::{
    Options, Params, ParamsError, Session, Snapshot, State, Strategy, render,
};
use thiserror::Error;

/// A way of rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Which BRDF. Variants of one model have one answer.
    pub model: Model,
    /// How light is found.
    pub strategy: Strategy,
    /// How microfacet normals are drawn.
    pub normals: Normals,
    /// Whether by the engine, which has one method: both ways to find light, visible normals. All
    /// others are traced by the reference, and so is the engine's own once more, so that their
    /// seconds compare.
    pub engine: bool,
}

impl Variant {
    /// Every combination of these, model by model. Phong draws from the distribution whatever is
    /// asked, so it is there once.
    pub fn all(models: &[Model], strategies: &[Strategy], normals: &[Normals]) -> Vec<Variant> {
        let mut all = Vec::new();
        for &model in models {
            let (strategy, visible) = (Strategy::Mis, Normals::Visible);
            let is_engines = model == Model::Phong || normals.contains(&visible);
            if is_engines && strategies.contains(&strategy) {
                all.push(Variant { model, strategy, normals: visible, engine: true });
            }
            let known = if model == Model::Phong { &[Normals::Visible] } else { normals };
            for &normals in known {
                let variant = |&strategy| Variant { model, strategy, normals, engine: false };
                all.extend(strategies.iter().map(variant));
            }
        }
        all
    }

    /// The parameters of a render in this way, all else being as in `base`.
    pub fn params(self, base: &Params) -> Params {
        let Variant { model, strategy, normals, engine } = self;
        Params { model, strategy, normals, reference: !engine, ..base.clone() }
    }

    /// As a person writes it: "GGX, engine", "GGX, light only", "GGX, MIS, all normals".
    pub fn title(self) -> String {
        if self.engine {
            return format!("{}, engine", self.model.title());
        }
        let strategy = match self.strategy {
            Strategy::Mis => "MIS",
            Strategy::LightOnly => "light only",
            Strategy::BsdfOnly => "BSDF only",
        };
        let normals = match self.normals {
            Normals::Visible => "",
            Normals::Distribution => ", all normals",
        };
        format!("{}, {strategy}{normals}", self.model.title())
    }
}

/// What is to be measured.
#[derive(Clone, Debug)]
pub struct SpeedPlan {
    /// Scene, size, depth; its seed is that of the first repeat.
    pub base: Params,
    /// What is held side by side.
    pub variants: Vec<Variant>,
    /// Passes of the last checkpoint; the others are the powers of 2 below.
    pub passes: u64,
    /// Ends a variant's curve before a checkpoint that would come after this number of seconds.
    pub seconds: Option<f64>,
    /// How often everything is measured.
    pub repeats: u32,
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// What is right.
#[derive(Clone, Debug)]
pub enum Truth {
    /// A picture rendered by this program, once for each model, in two halves with seeds that no
    /// repeat has: their difference is its own error.
    Rendered {
        /// Of both halves together, at least 2.
        passes: u64,
    },
    /// The same for all models.
    Given(Reference),
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct SpeedExperiment {
    /// What was held to be right for each model.
    pub references: Vec<(Model, Reference)>,
    /// The curves, repeat by repeat.
    pub runs: Vec<Run>,
}

/// One variant's curve in one repeat.
#[derive(Clone, Debug)]
pub struct Run {
    /// What was rendered.
    pub variant: Variant,
    /// Which time, from 0.
    pub repeat: u32,
    /// With which seed.
    pub seed: u64,
    /// One for each checkpoint, in the order of their passes; at least one.
    pub points: Vec<Point>,
    /// [`Flip::tone_mapped`] and [`Flip::hdr`] of the last checkpoint, where they have an answer.
    pub flip: [Option<f64>; 2],
}

/// Where a render stood at a checkpoint.
#[derive(Clone, Debug)]
pub struct Point {
    /// Samples in every pixel.
    pub passes: u64,
    /// Spent tracing them.
    pub seconds: f64,
    /// Traced for them, of all kinds.
    pub rays: u64,
    /// Samples left out because they were NaN or infinite.
    pub nonfinite: u64,
    /// The measures, in the order of [`ALL`].
    pub errors: [f64; ALL.len()],
}

impl Point {
    /// A measure's value.
    pub fn error(&self, measure: Measure) -> f64 {
        let place = ALL.iter().position(|m| m.column == measure.column);
        place.map_or(f64::NAN, |i| self.errors[i])
    }

    /// `1 / (relMSE seconds)` in 1/s: twice as large is the same error in half the time. The same
    /// at every checkpoint where the error falls with the root of the time.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.error(REL_MSE) * self.seconds)
    }
}

/// Why an experiment came to nothing.
#[derive(Clone, Debug, Error)]
pub enum SpeedError {
    /// These parameters cannot be rendered.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The reference does not fit the picture.
    #[error(transparent)]
    Pair(#[from] PairError),
    /// A render failed on the way.
    #[error("{0}")]
    Failed(String),
}

/// What an experiment is about to do.
#[derive(Clone, Copy, Debug)]
pub enum SpeedStage {
    /// Rendering a reference.
    Reference(Model),
    /// Rendering each variant for a moment.
    WarmUp,
    /// Measuring a repeat, from 0.
    Repeat(u32),
}

/// Passes of the warm-up: enough to have touched all of the code, the scene and the film.
const WARM_UP: u64 = 4;

impl SpeedPlan {
    /// Measures everything. `watch` is told what comes next.
    pub fn run(
        &self,
        truth: &Truth,
        mut watch: impl FnMut(SpeedStage),
    ) -> Result<SpeedExperiment, SpeedError> {
        let references = self.references(truth, &mut watch)?;
        watch(SpeedStage::WarmUp);
        for variant in &self.variants {
            render(variant.params(&self.base), WARM_UP.min(self.passes), self.threads)?;
        }
        let mut runs: Vec<Run> = Vec::new();
        for repeat in 0..self.repeats {
            watch(SpeedStage::Repeat(repeat));
            for (index, &variant) in self.variants.iter().enumerate() {
                // The first repeat finds out how far a curve goes; the others follow it.
                let first = runs.get(index).and_then(|run| run.points.last());
                let (passes, seconds) =
                    first.map_or((self.passes, self.seconds), |last| (last.passes, None));
                let same = |(model, _): &&(Model, Reference)| *model == variant.model;
                let Some((_, reference)) = references.iter().find(same) else { continue };
                let seed = self.base.seed.wrapping_add(repeat.into());
                let params = Params { seed, ..variant.params(&self.base) };
                let (points, flip) = curve(params, self.threads, reference, passes, seconds)?;
                runs.push(Run { variant, repeat, seed, points, flip });
            }
        }
        Ok(SpeedExperiment { references, runs })
    }

    fn references(
        &self,
        truth: &Truth,
        watch: &mut impl FnMut(SpeedStage),
    ) -> Result<Vec<(Model, Reference)>, SpeedError> {
        let mut references: Vec<(Model, Reference)> = Vec::new();
        for &Variant { model, .. } in &self.variants {
            if references.iter().any(|(known, _)| *known == model) {
                continue;
            }
            let reference = match truth {
                Truth::Given(reference) => reference.clone(),
                Truth::Rendered { passes } => {
                    watch(SpeedStage::Reference(model));
                    let (strategy, normals) = (Strategy::Mis, Normals::Visible);
                    let best = Variant { model, strategy, normals, engine: true };
                    let half = |place: u64| {
                        // Repeats count up from the base's seed and do not come this far.
                        let seed = self.base.seed ^ place << 62;
                        let params = Params { seed, ..best.params(&self.base) };
                        render(params, passes.div_ceil(2), self.threads)
                    };
                    Reference::halves(&half(1)?.mean(), &half(2)?.mean())?
                }
            };
            references.push((model, reference));
        }
        Ok(references)
    }
}

/// Renders to each checkpoint in turn and measures what is there.
fn curve(
    params: Params,
    threads: usize,
    reference: &Reference,
    passes: u64,
    seconds: Option<f64>,
) -> Result<(Vec<Point>, [Option<f64>; 2]), SpeedError> {
    let session = Session::with_options(params, 1, Options::headless(threads), || {})?;
    let mut points = Vec::new();
    let mut goal = 1;
    loop {
        session.set_limit(goal);
        let snapshot = finished(&session, goal)?;
        let picture = snapshot.mean();
        let pair = Pair::new(&picture, reference)?;
        points.push(Point {
            passes: snapshot.passes,
            seconds: snapshot.seconds,
            rays: snapshot.counts.rays,
            nonfinite: snapshot.counts.nonfinite,
            errors: ALL.map(|measure| measure.of(&pair)),
        });
        let next = (2 * goal).min(passes);
        let expected = snapshot.seconds * next as f64 / goal as f64;
        if goal >= passes || seconds.is_some_and(|most| expected > most) {
            let tone_mapped = Flip::tone_mapped(&pair, Tone::default());
            let flip = [tone_mapped, Flip::hdr(&pair)].map(|f| f.ok().map(|f| f.mean()));
            return Ok((points, flip));
        }
        goal = next;
    }
}

/// Waits until `passes` passes are done.
fn finished(session: &Session, passes: u64) -> Result<Snapshot, SpeedError> {
    for snapshot in session.snapshots().iter() {
        match snapshot.state {
            State::Failed(why) => return Err(SpeedError::Failed(why)),
            State::Done if snapshot.passes >= passes => return Ok(snapshot),
            _ => {}
        }
    }
    Err(SpeedError::Failed("the worker threads ended without a word".into()))
}
