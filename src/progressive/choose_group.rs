//! How many neighbours share: decided before the first pass, by what sharing costs and what it gives.
//!
//! Small parts of the picture are traced a few times with every size of group. What counts is the
//! product of the work a sample takes and the variance it leaves, part by part where the picture's
//! samples are to be [planned](super::plan). Work is counted, not timed, so
//! that equal parameters decide alike on any machine, however busy it is. The samples are thrown away:
//! the decision depends on them, so the picture must not.

use super::{Params, ParamsError};
use crate::film::REL_MSE_FLOOR;
use crate::math::Rgb;
use crate::trace::{
    Contribution, PixelBatch, PixelGrouping, RayCounts, ReuseGroup, Scratch, Tracer,
};

/// Parts of batches traced: many small ones, for a picture's noise is mostly that of a few places.
const PARTS: usize = 16;
/// Batches traced of a picture that has not as many that no edge cuts.
const WHOLE: usize = 4;
/// Times each is traced: with numbers that have nothing to do with each other, one of each
/// replicate.
const TIMES: u64 = 4;
/// Passes that no picture gets to.
const FIRST_PASS: u64 = 1 << 40;
/// How much faster than by one over their number the variance of many samples falls where each path
/// is for itself: edges and direct light are what stratification is best at. Measured as 2 to 4 in
/// the Cornell box from 16 to 256 passes.
const STRATIFIED: f64 = 4.0;

/// Against one over the size of a group, about what its paths have in common.
const COMMON: f64 = 1.0 / 64.0;

/// What is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Trial {
    /// Paths for themselves.
    Apart,
    /// Of paths that share, what is not shared.
    Own,
    /// What is shared, in groups of this size.
    Shared(ReuseGroup),
}

/// One trial of one part.
pub(super) struct TrialTask {
    which: usize,
    trial: Trial,
}

/// The work that it took, and the samples of each time.
pub(super) struct TrialResult {
    task: TrialTask,
    counts: RayCounts,
    samples: Vec<Vec<Rgb>>,
}

/// The sizes of groups that share.
fn sizes() -> impl Iterator<Item = ReuseGroup> {
    ReuseGroup::ALL.into_iter().skip(1)
}

/// What there is to do.
pub(super) fn tasks() -> Vec<TrialTask> {
    let trials = || [Trial::Apart, Trial::Own].into_iter().chain(sizes().map(Trial::Shared));
    (0..PARTS).flat_map(|which| trials().map(move |trial| TrialTask { which, trial })).collect()
}

impl Params {
    /// How many neighbouring paths share in a picture of these: as many as [`Params::group`] says,
    /// or else as many as a selection of the group finds best, which takes some milliseconds.
    pub fn decide_group(&self) -> Result<ReuseGroup, ParamsError> {
        self.check()?;
        let tracer = self.tracer();
        Ok(decide(self, &tracer, &mut tracer.scratch()))
    }
}

/// How many paths share with these parameters, where no selection of the group is asked.
pub(super) fn without(params: &Params, tracer: &Tracer) -> Option<ReuseGroup> {
    if tracer.shares() { params.group } else { Some(ReuseGroup::None) }
}

/// How many paths share with these parameters.
pub(super) fn decide(params: &Params, tracer: &Tracer, scratch: &mut Scratch) -> ReuseGroup {
    without(params, tracer).unwrap_or_else(|| {
        let found = tasks().into_iter().map(|task| task.run(params, tracer, scratch)).collect();
        choose(found, params.scene.geometry().len(), params.uniform)
    })
}

impl TrialTask {
    /// The pixels that it traces: by the golden section of all batches, so that no two are near each
    /// other, and none that an edge cuts. A picture with too few of those has some batches traced whole.
    fn take_pixels(&self, grouping: &PixelGrouping, batch: &mut PixelBatch) {
        let part = (0.5 + self.which as f64 * 0.618_033_988_749_895).fract();
        let place = |[columns, rows]: [u32; 2]| {
            let place = (f64::from(columns * rows) * part) as u32;
            [place % columns, place / columns]
        };
        let batches = grouping.batches();
        let inner = batches.map(|n| n.saturating_sub(2));
        if inner[0] * inner[1] >= PARTS as u32 {
            let [column, row] = place(inner);
            grouping.part_of_batch([column + 1, row + 1], batch);
        } else if self.which < WHOLE {
            grouping.batch(place(batches), batch);
        }
    }

    /// Does it.
    pub(super) fn run(
        self,
        params: &Params,
        tracer: &Tracer,
        scratch: &mut Scratch,
    ) -> TrialResult {
        let group = match self.trial {
            Trial::Shared(group) => group,
            _ => ReuseGroup::Sixteen,
        };
        let grouping = PixelGrouping::new(params.size, params.seed, FIRST_PASS, group);
        let mut batch = PixelBatch::default();
        self.take_pixels(&grouping, &mut batch);
        match self.trial {
            Trial::Apart => batch.ends.clear(),
            Trial::Own => batch.contribution = Contribution::Own,
            Trial::Shared(_) => batch.contribution = Contribution::Shared,
        }
        // Groups of different sizes take the same pixels in different orders.
        let mut order: Vec<usize> = (0..batch.pixels.len()).collect();
        order.sort_unstable_by_key(|&i| batch.pixels[i]);
        scratch.counts = RayCounts::default();
        let samples = (FIRST_PASS..FIRST_PASS + TIMES)
            .map(|pass| {
                let found = tracer.samples_of(&batch, pass, scratch);
                order.iter().map(|&i| found[i]).collect()
            })
            .collect();
        let counts = std::mem::take(&mut scratch.counts);
        (scratch.rays, scratch.capped) = (0, 0);
        TrialResult { task: self, counts, samples }
    }
}

/// The size of group whose work times variance is least, in a scene of `primitives` primitives.
pub(super) fn choose(mut found: Vec<TrialResult>, primitives: usize, uniform: bool) -> ReuseGroup {
    // In an order that does not depend on who was first.
    found.sort_by_key(|f| (f.task.which, f.task.trial));
    // Light as the quietest of the trials have it.
    let quiet = [Trial::Own, Trial::Shared(ReuseGroup::OneTwentyEight)];
    let means: Vec<Vec<[f64; 3]>> = (0..PARTS)
        .map(|which| {
            let these = |f: &&TrialResult| f.task.which == which && quiet.contains(&f.task.trial);
            mean(found.iter().filter(these).flat_map(|f| &f.samples))
        })
        .collect();
    let of = |which: usize, trial: Trial| {
        found.iter().filter(move |f| (f.task.which, f.task.trial) == (which, trial))
    };
    let work = |which, trial| of(which, trial).map(|f| f.counts.work(primitives)).sum::<f64>();
    let spread = |which, trial| {
        of(which, trial).map(|f| spread(&f.samples, &means[f.task.which])).sum::<f64>()
    };
    let shared: Vec<[f64; 2]> = (0..PARTS)
        .map(|which| line(sizes().map(|group| spread(which, Trial::Shared(group)))))
        .collect();
    // Of one part, the work of a sample and the variance that it leaves.
    let costs = |which: usize, group: ReuseGroup| {
        let own = spread(which, Trial::Own);
        match group {
            ReuseGroup::None => {
                let rest = (spread(which, Trial::Apart) - own).max(0.0);
                (work(which, Trial::Apart), rest + own / STRATIFIED)
            }
            _ => {
                let trial = Trial::Shared(group);
                let [a, b] = shared[which];
                let variance = a + b / f64::from(group.paths());
                (work(which, trial), variance + own / STRATIFIED)
            }
        }
    };
    let price = |group: ReuseGroup| {
        let each = (0..PARTS).map(|which| costs(which, group));
        if uniform {
            let (work, variance) = each.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
            return work * variance;
        }
        // Where samples go to where they are wanted, as many as make the error least.
        each.map(|(work, variance)| (work * variance).sqrt()).sum::<f64>().powi(2)
    };
    let prices = ReuseGroup::ALL.map(price);
    let least = (0..prices.len()).min_by(|&a, &b| prices[a].total_cmp(&prices[b]));
    least.map_or(ReuseGroup::None, |i| ReuseGroup::ALL[i])
}

/// `a` and `b`, neither below 0, of the law `a + b / size` for these variances of the [`sizes`]: `b` is of
/// what the paths of a group draw apart from each other, `a` of what all of them have in common. Four
/// samples tell a variance to half of it, and which size is best by little more than chance; of the sizes
/// together they tell more.
fn line(variances: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut sums = [0.0; 5];
    for (group, variance) in sizes().zip(variances) {
        let x = 1.0 / f64::from(group.paths());
        // The error of a variance is in proportion to it.
        let weight = (x + COMMON).powi(-2);
        let terms = [1.0, x, x * x, variance, x * variance];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
    }
    let [n, x, xx, y, xy] = sums;
    let b = (n * xy - x * y) / (n * xx - x * x);
    let a = (y - b * x) / n;
    match (a < 0.0, b < 0.0) {
        (true, _) => [0.0, xy / xx],
        (_, true) => [y / n, 0.0],
        _ => [a, b],
    }
}

/// The mean of each pixel over the times; what was traced at one time adds up.
fn mean<'a>(samples: impl Iterator<Item = &'a Vec<Rgb>>) -> Vec<[f64; 3]> {
    let mut means = Vec::new();
    for sample in samples {
        means.resize(sample.len(), [0.0; 3]);
        for (mean, sample) in means.iter_mut().zip(sample) {
            for (mean, x) in mean.iter_mut().zip(<[f32; 3]>::from(*sample)) {
                *mean += f64::from(x) / TIMES as f64;
            }
        }
    }
    means
}

/// Variance of a sample, summed over the pixels: of each against its light, as far as four samples
/// tell it, but at least against that of all of them, for four may have missed it.
fn spread(samples: &[Vec<Rgb>], means: &[[f64; 3]]) -> f64 {
    let count = samples.len() as f64;
    let channel = |s: &[Rgb], pixel: usize, c: usize| f64::from(<[f32; 3]>::from(s[pixel])[c]);
    let mut all = 0.0;
    for c in 0..3 {
        let light = means.iter().map(|m| m[c]).sum::<f64>() / means.len().max(1) as f64;
        for (pixel, own) in means.iter().enumerate() {
            let values = samples.iter().map(|s| channel(s, pixel, c));
            let mean = values.clone().sum::<f64>() / count;
            let squares: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
            let light = light.max(own[c]);
            let term = squares / (count - 1.0) / (light * light + REL_MSE_FLOOR);
            all += if term.is_finite() { term } else { 0.0 };
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at([a, b]: [f64; 2]) -> impl Iterator<Item = f64> {
        sizes().map(move |group| a + b / f64::from(group.paths()))
    }

    #[test]
    fn a_law_is_found_from_what_obeys_it() {
        for law in [[3.0, 70.0], [0.0, 5.0], [2.0, 0.0], [1e-9, 1e-9]] {
            for (found, part) in line(at(law)).into_iter().zip(law) {
                assert!((found - part).abs() <= 1e-9 * (law[0] + law[1]), "{found} {law:?}");
            }
        }
        assert_eq!(line(at([0.0; 2])), [0.0; 2]);
    }

    /// What falls faster than by one over the size, or grows, has nearest laws at the borders: no
    /// other law with neither part below 0 is nearer, by the weights.
    #[test]
    fn neither_part_is_below_zero() {
        let weight = |x: f64| (x + COMMON).powi(-2);
        for variances in [[8.0, 3.0, 1.0, 0.1], [1.0, 2.0, 3.0, 4.0], [5.0, 1.0, 7.0, 2.0]] {
            let off = |law: [f64; 2]| -> f64 {
                let each = sizes().zip(at(law)).zip(variances);
                each.map(|((g, y), v)| weight(1.0 / f64::from(g.paths())) * (y - v).powi(2)).sum()
            };
            let found = line(variances.into_iter());
            assert!(found.iter().all(|&part| part >= 0.0), "{found:?}");
            let least = off(found);
            for [da, db] in [[0.01, 0.0], [-0.01, 0.0], [0.0, 0.1], [0.0, -0.1], [0.01, -0.5]] {
                let [a, b] = [found[0] + da, found[1] + db];
                assert!(a < 0.0 || b < 0.0 || off([a, b]) >= least, "{variances:?} {found:?}");
            }
        }
    }
}
