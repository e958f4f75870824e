//! How many neighbours share: decided before the first pass, by what sharing costs and what it gives.
//!
//! A few bundles of the picture are traced a few times with every size of group. What counts is the
//! product of the work a sample takes and the variance it leaves. Work is counted, not timed, so
//! that equal parameters decide alike on any machine and in any haste. The samples are thrown away:
//! the decision may depend on them, so the picture must not.

use super::Params;
use crate::brdf::{Microfacet, ModelVisitor};
use crate::film::REL_MSE_FLOOR;
use crate::math::Rgb;
use crate::trace::{Deal, Effort, Group, Hand, Scratch, Tracer};

/// Bundles traced.
const BUNDLES: usize = 6;
/// Times each is traced: with numbers that have nothing to do with each other, one of each
/// replicate.
const TIMES: u64 = 4;
/// Passes that no picture gets to.
const FIRST_PASS: u64 = 1 << 40;

/// One bundle of the pilot with one size of group.
pub(super) struct Task {
    which: usize,
    group: Group,
}

/// What a task found: the work, and the samples of each time.
pub(super) struct Found {
    task: Task,
    effort: Effort,
    samples: Vec<Vec<Rgb>>,
}

/// What there is to do.
pub(super) fn tasks() -> Vec<Task> {
    let all = |which| Group::ALL.into_iter().map(move |group| Task { which, group });
    (0..BUNDLES).flat_map(all).collect()
}

impl Task {
    /// Does it.
    pub(super) fn run(self, tracer: &Tracer, params: &Params, scratch: &mut Scratch) -> Found {
        let apart = self.group == Group::None;
        let group = if apart { Group::Sixteen } else { self.group };
        let deal = Deal::new(params.size, params.seed, FIRST_PASS, group);
        let [columns, rows] = deal.bundles().map(|n| n as usize);
        // Along the golden section of all bundles, so that no two are near each other.
        let all = columns * rows;
        let place = (all as f64 * (0.5 + self.which as f64 * 0.618_033_988_749_895).fract()) as usize;
        let at = [place % columns, place / columns].map(|x| x as u32);
        let mut hand = Hand::default();
        deal.bundle(at, &mut hand);
        if apart {
            hand.ends.clear();
        }
        // Groups of different sizes take the same pixels in different orders.
        let mut order: Vec<usize> = (0..hand.pixels.len()).collect();
        order.sort_unstable_by_key(|&i| hand.pixels[i]);
        scratch.effort = Effort::default();
        let samples = (0..TIMES)
            .map(|time| {
                let pass = FIRST_PASS + time;
                let found = params.model.visit(Once { tracer, hand: &hand, pass, scratch });
                order.iter().map(|&i| found[i]).collect()
            })
            .collect();
        let effort = std::mem::take(&mut scratch.effort);
        (scratch.rays, scratch.capped) = (0, 0);
        Found { task: self, effort, samples }
    }
}

/// The size of group whose work times variance is least.
pub(super) fn choose(mut found: Vec<Found>, primitives: usize) -> Group {
    // In an order that does not depend on who was first.
    found.sort_by_key(|f| (f.task.which, f.task.group));
    let found = &found;
    let means: Vec<Vec<[f64; 3]>> = (0..BUNDLES).map(|which| mean(found, which)).collect();
    let price = |group: Group| {
        let (mut work, mut variance) = (0.0, 0.0);
        for f in found.iter().filter(|f| f.task.group == group) {
            work += f.effort.work(primitives);
            variance += spread(&f.samples, &means[f.task.which]);
        }
        work * variance
    };
    let prices = Group::ALL.map(price);
    let least = (0..prices.len()).min_by(|&a, &b| prices[a].total_cmp(&prices[b]));
    least.map_or(Group::None, |i| Group::ALL[i])
}

/// The best that is known of the pixels of a bundle: the mean of all its samples.
fn mean(found: &[Found], which: usize) -> Vec<[f64; 3]> {
    let mut means = Vec::new();
    for f in found.iter().filter(|f| f.task.which == which) {
        for samples in &f.samples {
            means.resize(samples.len(), [0.0; 3]);
            for (sum, &sample) in means.iter_mut().zip(samples) {
                for (sum, x) in sum.iter_mut().zip(<[f32; 3]>::from(sample)) {
                    *sum += f64::from(x) / (TIMES as usize * Group::ALL.len()) as f64;
                }
            }
        }
    }
    means
}

/// Relative variance of a sample, summed over the pixels.
fn spread(samples: &[Vec<Rgb>], means: &[[f64; 3]]) -> f64 {
    let count = samples.len() as f64;
    let mut sum = 0.0;
    for (pixel, mean) in means.iter().enumerate() {
        for c in 0..3 {
            let values = samples.iter().map(|s| f64::from(<[f32; 3]>::from(s[pixel])[c]));
            let own = values.clone().sum::<f64>() / count;
            let squares: f64 = values.map(|x| (x - own) * (x - own)).sum();
            let term = squares / (count - 1.0) / (mean[c] * mean[c] + REL_MSE_FLOOR);
            sum += if term.is_finite() { term } else { 0.0 };
        }
    }
    sum
}

/// A bundle's samples of one pass.
struct Once<'a> {
    tracer: &'a Tracer,
    hand: &'a Hand,
    pass: u64,
    scratch: &'a mut Scratch,
}

impl ModelVisitor for Once<'_> {
    type Output = Vec<Rgb>;
    fn visit<M: Microfacet>(self) -> Vec<Rgb> {
        let mut found = Vec::with_capacity(self.hand.pixels.len());
        let Once { tracer, hand, pass, scratch } = self;
        tracer.sample_hand::<M>(hand, pass, 1, scratch, &mut |_, sample| found.push(sample));
        found
    }
}
