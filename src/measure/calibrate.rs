//! Whether the error bar keeps its word: many independent renders against each other.
//!
//! Each render of a scene is judged against the mean of all the others, which is independent of it
//! and as unbiased; what noise that mean has left is known and taken off. (That the mean itself is
//! right is not shown here but by scenes whose answer is known, [`super::exact`].)

use crate::film::{DEGREES_OF_FREEDOM, ErrorEstimate, REL_MSE_FLOOR, student};
use crate::math::Rgb;
use crate::math::sobol::REPLICATES;
use crate::progressive::{Options, Params, ParamsError, Session, Snapshot, State, StopRule};
use crate::trace::Tracer;

/// How the error bar did after a number of passes, over all renders of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Passes of each render.
    pub passes: u64,
    /// Share of pixels and channels whose 95 % interval holds the truth.
    pub coverage: f64,
    /// Estimated over true `sqrt(mean((x - r)²))`, both squared errors summed over the renders.
    pub rmse_ratio: f64,
    /// The same of the relative error, over the renders that call theirs reliable; NaN if none.
    pub relative_ratio: f64,
    /// Share of renders that call their relative error reliable.
    pub reliable: f64,
    /// Share of those whose interval's upper limit is not exceeded by the true relative error.
    pub below_limit: f64,
    /// The true relative error, root mean square over the renders.
    pub relative: f64,
}

impl Calibration {
    /// How many of its figures are out of bounds: coverage within 0.92 to 0.97 from 256 passes on,
    /// estimates within 0.8 to 1.25 of the true errors from 16 passes on, the relative error's upper
    /// limit held by 0.9 or more of those renders that call theirs reliable.
    pub fn faults(&self) -> usize {
        let ratio = 0.8..=1.25;
        let covers = self.passes < 256 || (0.92..=0.97).contains(&self.coverage);
        let absolute = self.passes < 16 || ratio.contains(&self.rmse_ratio);
        let none = self.reliable <= 0.0;
        let relative = none || ratio.contains(&self.relative_ratio);
        let limit = none || self.below_limit >= 0.9;
        [covers, absolute, relative, limit].iter().filter(|&&fine| !fine).count()
    }
}

/// How a wanted error was kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped {
    /// The relative error asked for.
    pub wanted: f64,
    /// Share of renders whose true relative error is at most that.
    pub kept: f64,
    /// Passes that they took in the mean.
    pub passes: f64,
}

impl Stopped {
    /// 1 if fewer than 95 % of the renders kept the error.
    pub fn faults(&self) -> usize {
        usize::from(self.kept < 0.95)
    }
}

/// One render at one pass count.
struct Shot {
    mean: Vec<[f32; 3]>,
    standard_error: Vec<[f32; 3]>,
    error: Option<ErrorEstimate>,
}

/// Many renders of a scene: seeds `1..=renders`.
pub struct Renders {
    params: Params,
    passes: Vec<u64>,
    /// By render, then by pass count.
    shots: Vec<Vec<Shot>>,
    /// Sum over the renders of the means after the most passes.
    total: Vec<[f64; 3]>,
    /// Variance over the renders of those means.
    variance: Vec<[f64; 3]>,
}

impl Renders {
    /// Renders with each of a number of seeds on `threads` threads (0 for one a core) and keeps the
    /// pictures after each of `passes`, which ascend. `each` is told how many are done.
    pub fn new(
        params: &Params,
        passes: &[u64],
        renders: u64,
        threads: usize,
        each: &mut dyn FnMut(u64),
    ) -> Result<Renders, ParamsError> {
        let mut shots = Vec::new();
        for seed in 1..=renders {
            let params = Params { seed, ..params.clone() };
            let mut looks = passes.iter().copied();
            let first = looks.next().unwrap_or(1);
            let mut taken = Vec::new();
            until(params, first, threads, &mut |snapshot| {
                taken.push(Shot {
                    mean: snapshot.mean().pixels,
                    standard_error: snapshot.standard_error().pixels,
                    error: snapshot.error,
                });
                looks.next()
            })?;
            shots.push(taken);
            each(seed);
        }
        let pixels = params.size.iter().map(|&s| s as usize).product();
        let (mut total, mut squares) = (vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]);
        let n = shots.len() as f64;
        for shot in shots.iter().filter_map(|s| s.last()) {
            for (i, x) in shot.mean.iter().enumerate() {
                for c in 0..3 {
                    total[i][c] += x[c] as f64;
                    squares[i][c] += (x[c] as f64).powi(2);
                }
            }
        }
        let variance = squares.iter().zip(&total).map(|(square, sum)| {
            std::array::from_fn(|c| (square[c] - sum[c] * sum[c] / n).max(0.0) / (n - 1.0))
        });
        let variance = variance.collect();
        Ok(Renders { params: params.clone(), passes: passes.to_vec(), shots, total, variance })
    }

    /// How the error bar did after each pass count.
    pub fn calibrations(&self) -> Vec<Calibration> {
        (0..self.passes.len()).map(|look| self.calibration(look)).collect()
    }

    fn calibration(&self, look: usize) -> Calibration {
        let wide = student(DEGREES_OF_FREEDOM);
        let (mut held, mut values) = (0u64, 0u64);
        let mut absolute = [0.0; 2];
        let mut relative = [0.0; 2];
        let (mut reliable, mut below, mut true_sum) = (0.0, 0.0, 0.0);
        for (render, shots) in self.shots.iter().enumerate() {
            let Some(shot) = shots.get(look) else { continue };
            let mut truth = [0.0; 2];
            for (i, x) in shot.mean.iter().enumerate() {
                for (c, &x) in x.iter().enumerate() {
                    let (reference, noise) = self.others(render, i, c);
                    let off = x as f64 - reference;
                    // Means are stored in single precision.
                    let room = wide * shot.standard_error[i][c] as f64 + 1e-6 * reference.abs();
                    held += u64::from(off.abs() <= room);
                    values += 1;
                    truth[0] += off * off - noise;
                    truth[1] += (off * off - noise) / (reference * reference + REL_MSE_FLOOR);
                }
            }
            let per_value = 1.0 / (3 * shot.mean.len()) as f64;
            let [mse, rel_mse] = truth.map(|t| t * per_value);
            true_sum += rel_mse;
            let Some(error) = &shot.error else { continue };
            absolute[0] += error.rmse.value.powi(2);
            absolute[1] += mse;
            if error.reliable {
                reliable += 1.0;
                relative[0] += error.rel_mse.value;
                relative[1] += rel_mse;
                below += f64::from(rel_mse <= error.rel_mse.interval.high);
            }
        }
        let n = self.shots.len() as f64;
        Calibration {
            passes: self.passes[look],
            coverage: held as f64 / values as f64,
            rmse_ratio: (absolute[0] / absolute[1]).sqrt(),
            relative_ratio: (relative[0] / relative[1]).sqrt(),
            reliable: reliable / n,
            below_limit: below / reliable,
            relative: (true_sum / n).sqrt(),
        }
    }

    /// A pixel of the mean of all renders but one, and the variance of that mean.
    fn others(&self, render: usize, pixel: usize, c: usize) -> (f64, f64) {
        let n = self.shots.len() as f64;
        let own = self.shots[render].last().map_or(0.0, |shot| shot.mean[pixel][c] as f64);
        ((self.total[pixel][c] - own) / (n - 1.0), self.variance[pixel][c] / (n - 1.0))
    }

    /// True `mean((x - r)² / (r² + 0.01))` of a picture that is none of the renders.
    fn rel_mse(&self, picture: &[[f32; 3]]) -> f64 {
        let n = self.shots.len() as f64;
        let mut sum = 0.0;
        for (i, x) in picture.iter().enumerate() {
            for (c, &x) in x.iter().enumerate() {
                let reference = self.total[i][c] / n;
                let off = (x as f64 - reference).powi(2) - self.variance[i][c] / n;
                sum += off / (reference * reference + REL_MSE_FLOOR);
            }
        }
        sum / (3 * picture.len()) as f64
    }

    /// Renders with other seeds until `wanted` is reached, and looks how far off they truly are.
    pub fn stopped(
        &self,
        wanted: f64,
        renders: u64,
        threads: usize,
        each: &mut dyn FnMut(u64),
    ) -> Result<Stopped, ParamsError> {
        let rule = StopRule { wanted };
        let (mut kept, mut passes) = (0.0, 0.0);
        for run in 1..=renders {
            let params = Params { seed: (1 << 32) + run, ..self.params.clone() };
            let mut good = 0.0;
            until(params, StopRule::FIRST, threads, &mut |snapshot| {
                let next = rule.next(snapshot.passes, snapshot.error.as_ref());
                if next.is_none() {
                    good = f64::from(self.rel_mse(&snapshot.mean().pixels) <= wanted * wanted);
                    passes += snapshot.passes as f64;
                }
                next
            })?;
            kept += good;
            each(run);
        }
        let n = renders as f64;
        Ok(Stopped { wanted, kept: kept / n, passes: passes / n })
    }

    /// What knowing the error costs: the true squared relative error of the passes assigned to
    /// [`REPLICATES`] randomisations over that of as many passes of a single one. Above 1, as a
    /// longer low-discrepancy sequence is more even than its parts apart.
    pub fn cost_of_replicates(&self, passes: u64, seeds: u64) -> f64 {
        let [mut dealt, mut single] = [0.0; 2];
        for seed in 0..seeds {
            let params = Params { seed: (2 << 32) + seed, ..self.params.clone() };
            let tracer = params.tracer();
            let of = |pass: fn(u64) -> u64| {
                let visitor = ScoredPicture { tracer: &tracer, size: params.size, passes, pass };
                self.rel_mse(&visitor.mean())
            };
            dealt += of(|i| i);
            single += of(|i| i * REPLICATES as u64);
        }
        dealt / single
    }
}

/// Renders to `first` passes and on to whatever `look` answers.
fn until(
    params: Params,
    first: u64,
    threads: usize,
    look: &mut dyn FnMut(&Snapshot) -> Option<u64>,
) -> Result<(), ParamsError> {
    let session = Session::with_options(params, first, Options::headless(threads), || {})?;
    let mut limit = first;
    for snapshot in session.snapshots() {
        match snapshot.state {
            State::Done if snapshot.passes >= limit => match look(&snapshot) {
                Some(more) => {
                    limit = more;
                    session.set_limit(more);
                }
                None => break,
            },
            State::Failed(reason) => return Err(ParamsError::Threads { threads, reason }),
            _ => {}
        }
    }
    Ok(())
}

/// A picture of chosen passes, traced here and now.
struct ScoredPicture<'a> {
    tracer: &'a Tracer,
    size: [u32; 2],
    passes: u64,
    pass: fn(u64) -> u64,
}

impl ScoredPicture<'_> {
    fn mean(&self) -> Vec<[f32; 3]> {
        let [width, height] = self.size;
        let mut sums = vec![[0.0f64; 3]; width as usize * height as usize];
        let mut scratch = self.tracer.scratch();
        for pass in (0..self.passes).map(self.pass) {
            let mut pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
            let mut sum = sums.iter_mut();
            self.tracer.sample_each(&mut pixels, pass, &mut scratch, &mut |Rgb { r, g, b }| {
                if let Some(sum) = sum.next() {
                    for (sum, x) in sum.iter_mut().zip([r, g, b]) {
                        *sum += x as f64;
                    }
                }
            });
        }
        sums.iter().map(|s| s.map(|x| (x / self.passes as f64) as f32)).collect()
    }
}
