//! The engine's pictures of a scene against the reference tracer's.

use super::{EmitterKind, RandomError, RandomScene};
use crate::film::normal_score;
use crate::progressive::{Counts, Options, Params, Session, Snapshot, State};
use crate::trace::{Scratch, Tracer};

/// Most times that a difference is looked at.
pub const LOOKS: usize = 4;
/// Standard errors, as rare as with a normal number, beyond which a region is looked at again.
/// Seventeen regions of a right program are beyond it in one scene of 120, or a little more often
/// where fireflies are.
pub const SUSPECT: f64 = 3.5;
/// What does not count as a difference, as a part of the scene's mean: of pictures, and of samples
/// of the same random numbers.
pub const EFFECT: [f64; 2] = [1e-3, 1e-4];
/// Regions across and down, which are tried beside the whole.
const GRID: usize = 4;
/// Independent pictures of each tracer at each look: pixels of one picture share, so that their
/// errors are alike; those of the pictures have nothing to do with each other.
const PICTURES: u64 = 16;
/// By how much more is traced at each further look.
const MORE: u64 = 2;
/// Standard errors beyond which at two looks running nothing is left to look at.
const CERTAIN: f64 = 7.0;
/// Orders of sums and quick reciprocals: what two right tracers may differ by without any noise.
const ROUNDING_ERROR: f64 = 1e-5;
/// Weights of the channels, so that no two can be exchanged unseen.
const CHANNELS: [f64; 3] = [0.2, 0.3, 0.5];

/// What is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Passes of each of 16 pictures at the first look.
    pub passes: u64,
}

impl Budget {
    /// Two seconds of one core for a scene.
    pub const FULL: Budget = Budget { passes: 32 };
    /// A second or less.
    pub const QUICK: Budget = Budget { passes: 16 };
}

/// The light of a part of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// Mean of the engine's pictures.
    pub engine: f64,
    /// Mean of the reference tracer's.
    pub reference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
    /// The difference in standard errors, as rare as a normal number (Welch); signed.
    pub sigmas: f64,
}

/// Regions of a picture: sixteen, row by row from the top left, and the whole.
pub const REGIONS: usize = GRID * GRID + 1;

/// All regions at one look, twice: of the pictures that users get, which have nothing to do with
/// those of the reference tracer; then of samples that the engine finds with the same random numbers
/// as the reference tracer, without sharing and without split rays, which differ where rounding
/// turns a decision, and so tell far smaller faults.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Passes of each picture.
    pub passes: u64,
    /// What was found.
    pub regions: Vec<Region>,
}

impl Look {
    /// The whole picture.
    pub fn whole(&self) -> Region {
        self.regions.get(REGIONS - 1).copied().unwrap_or_default()
    }

    /// How far the engine is off in a region, as a part of the scene's mean.
    pub fn effect(&self, region: &Region) -> f64 {
        let off = region.engine - region.reference;
        if off == 0.0 { 0.0 } else { off / self.whole().reference }
    }
}

/// What the looks say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No region was off at every look.
    Agrees,
    /// One was, or samples were not finite.
    Differs,
}

/// A scene after its looks.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedScene {
    /// The scene's seed.
    pub seed: u64,
    /// How its emitters lie.
    pub kind: EmitterKind,
    /// What was found, look by look.
    pub looks: Vec<Look>,
    /// Regions that were off at every look, on the same side.
    pub suspects: Vec<usize>,
    /// Paths, rays, and samples that were not finite, of both tracers.
    pub counts: Counts,
    /// Whether they agree.
    pub verdict: Verdict,
}

impl JudgedScene {
    /// The first look, which no result has called for.
    pub fn first(&self) -> Region {
        self.looks.first().map(Look::whole).unwrap_or_default()
    }

    /// How far the engine was off over the whole at the first look, as a part of it.
    pub fn relative(&self) -> f64 {
        let Region { engine, reference, .. } = self.first();
        if engine == reference { 0.0 } else { engine / reference - 1.0 }
    }

    /// Of the regions that were off to the last, the one that was most: its number, and by what part
    /// of the scene's mean.
    pub fn worst(&self) -> Option<(usize, f64)> {
        let last = self.looks.last()?;
        let of = |&i: &usize| Some((i, last.effect(last.regions.get(i)?)));
        let all = self.suspects.iter().filter_map(of);
        all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }

    /// The whole at the first look, by the same random numbers: the difference in standard errors,
    /// and as a part of the scene's mean.
    pub fn same_numbers(&self) -> [f64; 2] {
        let of = |look: &Look| {
            let whole = look.regions.last().copied().unwrap_or_default();
            [whole.sigmas, look.effect(&whole)]
        };
        self.looks.first().map(of).unwrap_or_default()
    }
}

/// All scenes together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RandomSummary {
    /// Scenes tried.
    pub scenes: usize,
    /// Seeds and kinds of those that differ.
    pub failed: Vec<(u64, EmitterKind)>,
    /// The mean of how far the engine's whole pictures were off at the first look, each as a part
    /// of the reference tracer's.
    pub pooled: f64,
    /// Its standard error, by the spread of the scenes.
    pub pooled_error: f64,
    /// Mean square of the whole pictures' sigmas: about 1 where standard errors are true.
    pub mean_square: f64,
    /// Samples that were not finite.
    pub nonfinite: u64,
}

impl RandomSummary {
    /// Whether the pooled mean is within 1e-3, or not told from it by four of its standard errors.
    pub fn pooled_holds(&self) -> bool {
        let noise = if self.scenes > 1 { self.pooled_error } else { f64::INFINITY };
        self.pooled.abs() <= EFFECT[0] + 4.0 * noise
    }
}

/// Draws and judges the scenes of these seeds, and hands out each as it is done.
pub fn run(
    seeds: impl IntoIterator<Item = u64>,
    budget: Budget,
    each: &mut dyn FnMut(&JudgedScene),
) -> Result<RandomSummary, RandomError> {
    let mut summary = RandomSummary::default();
    let (mut off, mut squares) = (Vec::new(), 0.0);
    for seed in seeds {
        let outcome = judge(&RandomScene::draw(seed)?, budget)?;
        summary.scenes += 1;
        summary.nonfinite += outcome.counts.nonfinite;
        if outcome.verdict == Verdict::Differs {
            summary.failed.push((seed, outcome.kind));
        }
        squares += outcome.first().sigmas.powi(2);
        off.push(outcome.relative());
        each(&outcome);
    }
    let (mean, variance) = mean_and_variance(&off);
    (summary.pooled, summary.pooled_error) = (mean, variance.sqrt());
    summary.mean_square = squares / off.len().max(1) as f64;
    Ok(summary)
}

/// Renders a scene with both tracers, on all cores, until the looks have decided.
pub fn judge(scene: &RandomScene, budget: Budget) -> Result<JudgedScene, RandomError> {
    let mut outcome = JudgedScene {
        seed: scene.seed,
        kind: scene.kind,
        looks: Vec::new(),
        suspects: Vec::new(),
        counts: Counts::default(),
        verdict: Verdict::Agrees,
    };
    let mut sides = [0.0; 2 * REGIONS];
    let mut suspects: Vec<usize> = (0..2 * REGIONS).collect();
    for number in 0..LOOKS {
        let passes = budget.passes * MORE.pow(number as u32);
        let look = look(scene, passes, number as u64, &mut outcome.counts)?;
        let suspect = |&i: &usize| {
            let sigmas = look.regions[i].sigmas;
            let same_side = number == 0 || sigmas * sides[i] >= 0.0;
            sigmas.is_nan() || sigmas.abs() > SUSPECT && same_side
        };
        suspects.retain(suspect);
        let certain = |&i: &usize| {
            let least = f64::min(sides[i].abs(), look.regions[i].sigmas.abs());
            least > CERTAIN && look.effect(&look.regions[i]).abs() > EFFECT[i / REGIONS]
        };
        let is_over = suspects.is_empty() || suspects.iter().any(certain);
        for (side, region) in sides.iter_mut().zip(&look.regions) {
            *side = region.sigmas;
        }
        outcome.looks.push(look);
        if is_over {
            break;
        }
    }
    // What is not a number is large, and suspicious.
    let is_large = |i: usize| {
        let of = |look: &Look| look.effect(&look.regions[i]).abs();
        outcome
            .looks
            .last()
            .map(of)
            .is_some_and(|effect| effect.is_nan() || effect > EFFECT[i / REGIONS])
    };
    suspects.retain(|&i| is_large(i));
    outcome.suspects = suspects;
    if !outcome.suspects.is_empty() || outcome.counts.nonfinite > 0 {
        outcome.verdict = Verdict::Differs;
    }
    Ok(outcome)
}

/// Both tracers' pictures of this many passes, of seeds that no other look has.
fn look(
    scene: &RandomScene,
    passes: u64,
    number: u64,
    counts: &mut Counts,
) -> Result<Look, RandomError> {
    // Numbers of the reference tracer's pictures are odd.
    let seed = |picture: u64| scene.params.seed.wrapping_add(2 * (number * PICTURES + picture));
    let odd = |picture: u64| seed(picture).wrapping_add(1);
    let engine = |seed: u64| Params { seed, ..scene.params.clone() };
    let reference = |seed: u64| Params { seed, ..scene.reference.clone() };
    let start = |params| Session::with_options(params, passes, Options::headless(1), || {});
    // All at once, a thread each: so small a picture has no work for two.
    let engines = (0..PICTURES).map(|p| start(engine(seed(p))));
    let references = (0..PICTURES).map(|p| start(reference(odd(p))));
    let tracers: [Result<Vec<_>, _>; 2] = [engines.collect(), references.collect()];
    // Meanwhile.
    let same: Vec<Vec<f64>> =
        (0..PICTURES).map(|p| samples(&engine(odd(p)), passes, counts)).collect();
    let mut pictures = [Vec::new(), Vec::new()];
    for (sessions, pictures) in tracers.into_iter().zip(&mut pictures) {
        for session in sessions? {
            let snapshot = finished(&session)?;
            *counts = *counts + snapshot.counts;
            pictures.push(regions(&snapshot));
        }
    }
    let of = |pictures: &[Vec<f64>], i: usize| {
        mean_and_variance(&pictures.iter().map(|p| p[i]).collect::<Vec<_>>())
    };
    let [engine, reference] = &pictures;
    let mut regions: Vec<Region> = (0..REGIONS)
        .map(|i| {
            let (a, b) = (of(engine, i), of(reference, i));
            let freedom = (PICTURES - 1) as f64 * (a.1 + b.1).powi(2) / (a.1 * a.1 + b.1 * b.1);
            compare(a.0, b.0, a.1 + b.1, freedom)
        })
        .collect();
    let differences: Vec<Vec<f64>> = same
        .iter()
        .zip(reference)
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
        .collect();
    regions.extend((0..REGIONS).map(|i| {
        let variance = of(&differences, i).1;
        compare(of(&same, i).0, of(reference, i).0, variance, (PICTURES - 1) as f64)
    }));
    Ok(Look { passes, regions })
}

/// The regions of the engine's samples by themselves.
fn samples(params: &Params, passes: u64, counts: &mut Counts) -> Vec<f64> {
    let tracer = params.tracer();
    let mut scratch = tracer.scratch();
    let mut sums = LookSums::new(params.size);
    for pass in 0..passes {
        counts.nonfinite += add_pass(&tracer, pass, &mut sums, &mut scratch);
    }
    counts.rays += scratch.rays;
    sums.means()
}

/// Adds a pass of every pixel, each for itself; the number of samples that were not finite.
fn add_pass(tracer: &Tracer, pass: u64, sums: &mut LookSums, scratch: &mut Scratch) -> u64 {
    let [width, height] = sums.size.map(|s| s as u32);
    let pixels = &mut (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let (mut i, mut nonfinite) = (0, 0);
    tracer.sample_each(pixels, pass, scratch, &mut |sample| {
        match sample.is_finite() {
            true => sums.add(i, sample.into()),
            false => nonfinite += 1,
        }
        i += 1;
    });
    nonfinite
}

/// Waits for the end of a session.
fn finished(session: &Session) -> Result<Snapshot, RandomError> {
    for snapshot in session.snapshots() {
        match snapshot.state {
            State::Failed(reason) => return Err(RandomError::Failed(reason)),
            State::Done => return Ok(snapshot),
            _ => {}
        }
    }
    Err(RandomError::Failed("the renderer stopped without a word".to_owned()))
}

/// The means of the regions.
fn regions(snapshot: &Snapshot) -> Vec<f64> {
    let mut sums = LookSums::new(snapshot.grid.size);
    for (i, &pixel) in snapshot.mean().pixels.iter().enumerate() {
        sums.add(i, pixel);
    }
    sums.means()
}

/// Sums of pixels, by region.
struct LookSums {
    size: [usize; 2],
    sums: [[f64; 2]; REGIONS],
}

impl LookSums {
    fn new(size: [u32; 2]) -> LookSums {
        LookSums { size: size.map(|s| s as usize), sums: [[0.0; 2]; REGIONS] }
    }

    /// A value of pixel `i`, row by row from the top left.
    fn add(&mut self, i: usize, pixel: [f32; 3]) {
        let [width, height] = self.size;
        let light: f64 = pixel.iter().zip(CHANNELS).map(|(&x, w)| f64::from(x) * w).sum();
        let (column, row) = (i % width * GRID / width, i / width * GRID / height);
        for place in [row * GRID + column, REGIONS - 1] {
            self.sums[place][0] += light;
            self.sums[place][1] += 1.0;
        }
    }

    fn means(&self) -> Vec<f64> {
        self.sums.iter().map(|[sum, count]| sum / count).collect()
    }
}

/// The mean and the variance of the mean.
fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, squares / (count * (count - 1.0)))
}

/// Student's test of two means, by the variance of their difference with its degrees of freedom
/// (Welch's for independent ones).
fn compare(engine: f64, reference: f64, variance: f64, freedom: f64) -> Region {
    let off = engine - reference;
    let beyond = (off.abs() - ROUNDING_ERROR * reference).max(0.0).copysign(off);
    let standard_error = variance.sqrt();
    let sigmas = match beyond == 0.0 {
        true => 0.0,
        false if standard_error == 0.0 => f64::INFINITY.copysign(beyond),
        false => normal_score(beyond / standard_error, freedom),
    };
    Region { engine, reference, standard_error, sigmas }
}
