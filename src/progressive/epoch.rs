//! One epoch: what the workers share while the parameters stay the same, and what they show.

use super::pair_queue::PairQueue;
use super::plan::{self, Plan};
use super::sample_buffer::SampleBuffer;
use super::turn::Turn;
use super::{Counts, Params, Snapshot, State, TileGrid, TileImage, choose_group};
use crate::film::{ErrorSums, Film};
use crate::math::Rgb;
use crate::trace::{BatchOptions, PixelBatch, PixelGrouping, ReuseGroup, Scratch, Tracer};
use std::mem::take;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Everything of one epoch that workers share. A new epoch gets a new one, so nothing of an old
/// epoch can reach it.
pub(super) struct Epoch {
    /// For whom it is traced at present.
    pub(super) turn: Turn,
    pub(super) params: Params,
    pub(super) tracer: Tracer,
    /// Once it is decided.
    pub(super) group: OnceLock<ReuseGroup>,
    /// The newest.
    plan: Mutex<Option<Arc<Plan>>>,
    pub(super) grid: TileGrid,
    /// By worker.
    pub(super) own: Vec<Mutex<Own>>,
    shown: Vec<Mutex<Shown>>,
    counts: [AtomicU64; 4],
    /// Tracing time before the present run, in nanoseconds.
    earlier: AtomicU64,
    run_start: Mutex<Option<Instant>>,
    pub(super) last_snapshot: Mutex<Instant>,
}

/// What is a worker's own.
pub(super) struct Own {
    pub(super) scratch: Scratch,
    /// The pixels that it traces.
    pub(super) batch: PixelBatch,
    pub(super) pairs: PairQueue,
}

impl Own {
    fn new(tracer: &Tracer) -> Own {
        let (batch, pairs) = (PixelBatch::default(), PairQueue::default());
        Own { scratch: tracer.scratch(), batch, pairs }
    }
}

/// What there is to see of a tile.
#[derive(Default)]
struct Shown {
    image: Option<(Arc<TileImage>, ErrorSums)>,
    /// Whether no snapshot has it yet.
    dirty: bool,
}

impl Shown {
    fn passes(&self) -> u64 {
        self.image.as_ref().map_or(0, |(image, _)| image.passes)
    }
}

impl Epoch {
    pub(super) fn new(turn: Turn, params: Params, threads: usize) -> Epoch {
        let grid = TileGrid { size: params.size };
        let tracer = params.tracer();
        let mut shown = Vec::new();
        shown.resize_with(grid.len(), Mutex::default);
        let own = (0..threads.max(1)).map(|_| Mutex::new(Own::new(&tracer))).collect();
        let group =
            choose_group::without(&params, &tracer).map_or_else(OnceLock::new, OnceLock::from);
        Epoch {
            turn,
            params,
            tracer,
            group,
            plan: Mutex::default(),
            grid,
            own,
            shown,
            counts: Default::default(),
            earlier: AtomicU64::new(0),
            run_start: Mutex::new(None),
            last_snapshot: Mutex::new(Instant::now()),
        }
    }

    /// Gives back the workers' memory, while nothing is traced.
    pub(super) fn rest(&mut self) {
        self.own = Vec::new();
    }

    /// Makes it ready for a turn by `workers` workers; all of it is new to whoever looks.
    pub(super) fn wake(&mut self, turn: Turn, threads: usize) {
        self.turn = turn;
        self.own = (0..threads.max(1)).map(|_| Mutex::new(Own::new(&self.tracer))).collect();
        for shown in &mut self.shown {
            let shown = shown.get_mut().unwrap_or_else(PoisonError::into_inner);
            shown.dirty = shown.image.is_some();
        }
    }

    /// Bytes of memory that its tiles and what its tracer is made of hold.
    pub(super) fn bytes(&self) -> usize {
        let tile = |shown: &Mutex<Shown>| {
            let shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
            shown.image.as_ref().map_or(0, |(image, _)| image.bytes())
        };
        self.shown.iter().map(tile).sum::<usize>() + self.tracer.bytes()
    }

    /// Traces a batch of a grouping.
    pub(super) fn trace(
        &self,
        grouping: &PixelGrouping,
        at: [u32; 2],
        round: BatchOptions,
        own: &mut Own,
        put: &mut dyn FnMut([u32; 2], Rgb),
    ) {
        let Own { scratch, batch, .. } = own;
        grouping.batch(at, batch);
        self.tracer.sample_batch(batch, round, scratch, put);
    }

    /// The plan for the passes that come next, made if it is not there: all films then have the passes
    /// at which it begins, or have noted what they had there.
    pub(super) fn plan(&self, films: &mut [Film]) -> Arc<Plan> {
        let done = films.iter().map(Film::passes).min().unwrap_or(0);
        let mut plan = self.plan.lock().unwrap_or_else(PoisonError::into_inner);
        match &*plan {
            Some(plan) if plan.passes().contains(&done) => plan.clone(),
            _ => {
                let start = plan::start_of_plan(done);
                for film in films.iter_mut().filter(|film| film.planned_at() != Some(start)) {
                    if start == plan::UNIFORM {
                        (0..film.cells())
                            .for_each(|cell| (0..2).for_each(|h| film.note_spread(cell, h)));
                    }
                    film.begin_plan(start);
                }
                let made = Arc::new(Plan::new(self.grid, films, start));
                *plan = Some(made.clone());
                made
            }
        }
    }

    /// Traces what a tile is to get in its next pass, and adds it. Returns the number of samples, and
    /// whether the pass is whole: not if half-way the picture was not `wanted` for now, for a noisy
    /// tile has many batches. The next call then goes on with what is left.
    pub(super) fn uneven_pass(
        &self,
        index: usize,
        film: &mut Film,
        plan: &Plan,
        group: ReuseGroup,
        Own { scratch, batch, pairs }: &mut Own,
        wanted: &dyn Fn() -> bool,
    ) -> (u64, bool) {
        let (rect, pass) = (self.grid.rect(index), film.begin_pass());
        let area = |cell| plan::cell_rect(self.grid, index, cell);
        let (mut paths, mut nonfinite) = (0, 0);
        pairs.fill(index, film, plan, pass);
        let whole = loop {
            let these = pairs.next(&area, self.params.seed, group, batch);
            if these.is_empty() {
                break true;
            }
            if !wanted() {
                break false;
            }
            pairs.samples.clear();
            let put = &mut |_, sample| pairs.samples.push(sample);
            self.tracer.sample_batch(batch, BatchOptions::of(0), scratch, put);
            paths += batch.pixels.len() as u64;
            nonfinite += pairs.add(these, batch, rect, film);
        };
        if whole {
            film.end_uneven_pass();
        }
        let (rays, capped) = (take(&mut scratch.rays), take(&mut scratch.capped));
        self.count(Counts { paths, rays, nonfinite, capped });
        (paths, whole)
    }

    /// Adds the samples of those of the canvas's passes that a tile's film does not have: after an
    /// interruption it may have some.
    pub(super) fn add(
        &self,
        index: usize,
        film: &mut Film,
        sample_buffer: &SampleBuffer,
        passes: Range<u64>,
    ) {
        let rect = self.grid.rect(index);
        let (mut paths, mut nonfinite) = (0, 0);
        for pass in film.passes().max(passes.start)..passes.end {
            film.begin_pass();
            let which = (pass - passes.start) as usize;
            for (pixel, sample) in sample_buffer.tile(which, rect).enumerate() {
                if sample.is_finite() {
                    film.add(pixel, sample);
                } else {
                    nonfinite += 1;
                }
            }
            film.end_pass();
            paths += rect.area() as u64;
        }
        self.count(Counts { paths, nonfinite, ..Counts::default() });
    }

    /// Whether a film has so much more than is shown of it that one would see it: an eighth.
    pub(super) fn is_behind(&self, index: usize, film: &Film) -> bool {
        let shown = self.shown(index).passes();
        film.passes() > shown + shown / 8
    }

    /// Shows what a film has if it is more than what is shown.
    pub(super) fn show_if_new(&self, index: usize, film: &Film) {
        if film.passes() == self.shown(index).passes() || !film.is_whole() {
            return;
        }
        let estimate = film.estimate(self.grid.rect(index).width());
        let image = TileImage {
            passes: film.passes(),
            samples: (0..film.cells()).map(|cell| film.samples(cell)).collect(),
            mean: estimate.mean,
            standard_error: estimate.standard_error,
            block: 1,
        };
        self.show(index, image, estimate.sums);
    }

    /// Shows a tile in blocks of the colours on the canvas.
    pub(super) fn show_preview(&self, index: usize, sample_buffer: &SampleBuffer, block: u32) {
        let rect = self.grid.rect(index);
        let mut mean = Vec::with_capacity(rect.area());
        for y in rect.y0..rect.y1 {
            for left in (rect.x0..rect.x1).step_by(block as usize) {
                let colour = sample_buffer.at([left / block, y / block]);
                let colour = if colour.is_finite() { colour } else { Rgb::BLACK };
                let width = block.min(rect.x1 - left) as usize;
                mean.extend(std::iter::repeat_n(<[f32; 3]>::from(colour), width));
            }
        }
        let (samples, standard_error) = (Vec::new(), Vec::new());
        let image = TileImage { passes: 0, samples, mean, standard_error, block };
        self.show(index, image, ErrorSums::default());
    }

    /// Whether the last snapshot is so long ago.
    pub(super) fn is_snapshot_due(&self, interval: Duration) -> bool {
        let last = self.last_snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        last.elapsed() >= interval
    }

    fn show(&self, index: usize, image: TileImage, sums: ErrorSums) {
        // Image and flag at once: a snapshot is to name all in it that is new.
        *self.shown(index) = Shown { image: Some((Arc::new(image), sums)), dirty: true };
    }

    fn shown(&self, index: usize) -> MutexGuard<'_, Shown> {
        self.shown[index].lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn count(&self, c: Counts) {
        for (total, n) in self.counts.iter().zip([c.paths, c.rays, c.nonfinite, c.capped]) {
            total.fetch_add(n, Ordering::Relaxed);
        }
    }

    pub(super) fn clock(&self, running: bool) {
        let mut start = self.run_start.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(start) = start.take() {
            self.earlier.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        }
        *start = running.then(Instant::now);
    }

    /// Of tracing so far.
    pub(super) fn seconds(&self) -> f64 {
        let start = self.run_start.lock().unwrap_or_else(PoisonError::into_inner);
        let run = start.map_or(0.0, |s| s.elapsed().as_secs_f64());
        run + self.earlier.load(Ordering::Relaxed) as f64 * 1e-9
    }

    pub(super) fn passes_shown(&self) -> u64 {
        (0..self.shown.len()).map(|index| self.shown(index).passes()).min().unwrap_or(0)
    }

    /// Counts so far.
    pub(super) fn counts(&self) -> Counts {
        let [paths, rays, nonfinite, capped] =
            [0, 1, 2, 3].map(|i: usize| self.counts[i].load(Ordering::Relaxed));
        Counts { paths, rays, nonfinite, capped }
    }

    pub(super) fn snapshot(&self, state: State, passes: u64) -> Snapshot {
        let mut dirty = Vec::new();
        let mut tiles = Vec::with_capacity(self.shown.len());
        let mut sums = ErrorSums::default();
        for index in 0..self.shown.len() {
            let mut shown = self.shown(index);
            if std::mem::take(&mut shown.dirty) {
                dirty.push(index as u32);
            }
            if let Some((_, tile)) = &shown.image {
                sums.add(tile);
            }
            tiles.push(shown.image.as_ref().map(|(image, _)| image.clone()));
        }
        let pixels = self.params.size.map(u64::from).iter().product();
        let is_level =
            |tile: &Option<Arc<TileImage>>| tile.as_ref().is_some_and(|t| t.passes == passes);
        let whole = passes > 0 && tiles.iter().all(is_level);
        Snapshot {
            epoch: self.turn.epoch,
            grid: self.grid,
            tiles,
            dirty,
            passes,
            whole,
            counts: self.counts(),
            error: sums.estimate(pixels, passes),
            group: self.group.get().copied().unwrap_or_default(),
            seconds: self.seconds(),
            state,
        }
    }
}

/// What is told of a worker that panicked.
pub(super) fn failure(epoch: &Epoch, panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .map(|s| s.to_string())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no reason given".into());
    let p = &epoch.params;
    format!(
        "a worker failed: {text}. This is a fault of burnish; to repeat it: scene {}, model {}, seed {}, {}x{}, {:?}",
        p.scene.name(),
        p.model.name(),
        p.seed,
        p.size[0],
        p.size[1],
        p.method()
    )
}
