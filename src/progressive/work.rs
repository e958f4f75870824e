//! What the workers do: coarse blocks, then pass after pass over the tiles.

use super::canvas::Canvas;
use super::outlet::Outlet;
use super::pilot;
use super::session::{Options, Shared};
use super::{Counts, Params, ParamsError, Snapshot, State, TILE, TileGrid, TileImage};
use crate::brdf::{Microfacet, ModelVisitor};
use crate::film::{ErrorSums, Film};
use crate::math::Rgb;
use crate::trace::{Deal, Group, Hand, Scratch, Tracer};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Most passes that are traced before their samples are added up.
const BATCH: u64 = 16;
/// What is traced between two looks at what is wanted is to take about so long: it is what a pause
/// loses, and how often the picture shows what is new. No sum depends on it.
const WAVE_TIME: Duration = Duration::from_millis(50);
/// Fewest and most samples of that, for one worker and for all.
const WAVE_LEAST: u64 = 8 * 512;
const WAVE_MOST: u64 = 1 << 18;

/// A preview has as many paths as the last one traced in this time, so that it stands within a
/// frame's. It is thrown away, so it may depend on the clock.
const PREVIEW_TIME: Duration = Duration::from_millis(15);
/// Paths of the first preview of all.
const PREVIEW_PATHS: u64 = 8192;
/// The preview is refined by this factor in each direction until a pass is no finer.
const PREVIEW_STEP: u32 = 4;
/// Paths of a preview that share.
const PREVIEW_GROUP: Group = Group::Sixteen;

/// What a driver is to do next.
pub(super) enum Work {
    Stop,
    Start(u64, Box<Params>),
    Continue,
}

pub(super) struct Workers {
    options: Options,
    shared: Arc<Shared>,
    outlet: Outlet,
    pool: ThreadPool,
    /// Samples to be traced in [`WAVE_TIME`], as far as is known.
    wave: AtomicU64,
}

/// Everything of one epoch that workers share. A new epoch gets a new one, so nothing of an old
/// epoch can reach it.
struct Epoch {
    number: u64,
    params: Params,
    tracer: Tracer,
    /// Once it is decided.
    group: OnceLock<Group>,
    grid: TileGrid,
    /// One a worker.
    scratch: Vec<Mutex<Scratch>>,
    shown: Vec<Shown>,
    counts: [AtomicU64; 4],
    /// Tracing time before the present run, in nanoseconds.
    earlier: AtomicU64,
    run_start: Mutex<Option<Instant>>,
    last_snapshot: Mutex<Instant>,
}

#[derive(Default)]
struct Shown {
    image: Mutex<Option<(Arc<TileImage>, ErrorSums)>>,
    dirty: AtomicBool,
}

impl Workers {
    pub(super) fn new(
        options: Options,
        shared: Arc<Shared>,
        outlet: Outlet,
    ) -> Result<Workers, ParamsError> {
        let pool = ThreadPoolBuilder::new()
            .num_threads(options.threads)
            .thread_name(|i| format!("burnish worker {i}"))
            .build()
            .map_err(|e| ParamsError::Threads {
                threads: options.threads,
                reason: e.to_string(),
            })?;
        let wave = AtomicU64::new(WAVE_LEAST * pool.current_num_threads() as u64);
        Ok(Workers { options, shared, outlet, pool, wave })
    }

    /// The driver's thread: until the handle is dropped.
    pub(super) fn drive(self) {
        let mut films: Vec<Film> = Vec::new();
        let mut canvas = Canvas::default();
        let mut preview_paths = PREVIEW_PATHS;
        let mut now: Option<Epoch> = None;
        let mut failed = false;
        loop {
            let (number, passes) = match &now {
                Some(epoch) => (epoch.number, whole_passes(&films)),
                None => (0, 0),
            };
            let idle = |state| {
                if let Some(epoch) = &now {
                    self.outlet.send(|| epoch.snapshot(state, passes));
                }
            };
            match self.shared.wait(number, passes, failed, idle) {
                Work::Stop => return,
                Work::Continue => {}
                Work::Start(number, params) => {
                    // Old sums are cleared by the workers, tile by tile, when they come to them.
                    let epoch = Epoch::new(number, *params, self.pool.current_num_threads());
                    films.resize_with(epoch.grid.len(), Film::default);
                    films.truncate(epoch.grid.len());
                    for (index, film) in films.iter_mut().enumerate() {
                        film.retire(epoch.grid.rect(index).area());
                    }
                    now = Some(epoch);
                    failed = false;
                }
            }
            let Some(epoch) = &now else { continue };
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                self.run(epoch, &mut films, &mut canvas, &mut preview_paths)
            }));
            if let Err(panic) = outcome {
                let reason = failure(epoch, panic.as_ref());
                self.outlet.send(|| epoch.snapshot(State::Failed(reason), whole_passes(&films)));
                failed = true;
            }
        }
    }

    /// Traces until the pass limit or an interruption.
    fn run(&self, epoch: &Epoch, films: &mut [Film], canvas: &mut Canvas, most: &mut u64) {
        epoch.clock(true);
        let goes_on = || self.shared.goes_on(epoch.number);
        if self.options.preview && whole_passes(films) == 0 {
            self.preview(epoch, canvas, most);
        }
        let Some(group) = self.group(epoch) else { return epoch.clock(false) };
        let pixels: u64 = epoch.params.size.map(u64::from).iter().product();
        while goes_on() {
            let done = whole_passes(films);
            let at_once = done.clamp(1, BATCH).min((self.wave() / pixels).max(1));
            let target = (done + at_once).min(self.shared.limit());
            if done >= target {
                break;
            }
            self.passes(epoch, films, canvas, done..target, group);
            // The first whole pass is worth showing whenever it comes.
            if done == 0 && whole_passes(films) > 0 {
                self.outlet.send(|| epoch.snapshot(State::Running, whole_passes(films)));
            }
        }
        self.pool.install(|| {
            films.par_iter().enumerate().for_each(|(index, film)| epoch.show_if_new(index, film))
        });
        epoch.clock(false);
    }

    /// How many paths share, found out if it is not known; `None` if it was to stop before.
    fn group(&self, epoch: &Epoch) -> Option<Group> {
        if let Some(&group) = epoch.group.get() {
            return Some(group);
        }
        let found = Mutex::new(Vec::new());
        let whole = self.for_each_task(epoch, pilot::tasks(), &|task, scratch| {
            let result = task.run(&epoch.tracer, &epoch.params, scratch);
            found.lock().unwrap_or_else(PoisonError::into_inner).push(result);
        });
        let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        let primitives = epoch.params.scene.geometry().len();
        whole.then(|| *epoch.group.get_or_init(|| pilot::choose(found, primitives)))
    }

    /// Some passes, in bands of as many rows as are worth it. Ends early when it is to.
    fn passes(
        &self,
        epoch: &Epoch,
        films: &mut [Film],
        canvas: &mut Canvas,
        passes: Range<u64>,
        group: Group,
    ) {
        let Params { size, seed, .. } = epoch.params;
        let deals: Vec<Deal> =
            passes.clone().map(|pass| Deal::new(size, seed, pass, group)).collect();
        canvas.prepare(size, deals.len());
        let columns = epoch.grid.columns_rows()[0] as usize;
        let rows = films.len() / columns;
        // Rows of tiles that had this pass before an interruption are not traced again.
        let have = |films: &[Film], row: usize| {
            films[row * columns..][..columns].iter().all(|film| film.passes() >= passes.end)
        };
        let mut row = (0..rows).find(|&row| !have(films, row)).unwrap_or(rows);
        let mut traced = vec![0; deals.len()];
        let samples = (size[0] * TILE) as usize * deals.len();
        while row < rows {
            let band = (self.wave() as usize).div_ceil(samples);
            let end = (row + band).min(rows);
            let lines = row as u32 * TILE..(end as u32 * TILE).min(size[1]);
            if !self.trace_lines(epoch, canvas, &deals, passes.start, lines, &mut traced) {
                return;
            }
            let due = passes.start == 0 || epoch.is_snapshot_due(self.shared.interval());
            let films = &mut films[row * columns..end * columns];
            self.pool.install(|| {
                films.par_iter_mut().enumerate().for_each(|(i, film)| {
                    let index = row * columns + i;
                    epoch.add(index, film, canvas, deals.len());
                    if due {
                        epoch.show_if_new(index, film);
                        self.show_now_and_then(epoch);
                    }
                })
            });
            row = end;
        }
    }

    /// Samples that are worth tracing before the next look.
    fn wave(&self) -> u64 {
        let least = WAVE_LEAST * self.pool.current_num_threads() as u64;
        self.wave.load(Ordering::Relaxed).clamp(least, WAVE_MOST.max(least))
    }

    /// Traces what these lines of the picture need, but for the rows of bundles that already are:
    /// false if it was to stop before all of them were there.
    fn trace_lines(
        &self,
        epoch: &Epoch,
        canvas: &Canvas,
        deals: &[Deal],
        first_pass: u64,
        lines: Range<u32>,
        traced: &mut [u32],
    ) -> bool {
        let mut tasks = Vec::new();
        for (which, (deal, traced)) in deals.iter().zip(traced).enumerate() {
            let rows = deal.bundle_rows(lines.clone());
            let columns = deal.bundles()[0];
            for y in rows.start.max(*traced)..rows.end {
                tasks.extend((0..columns).map(|x| (which, [x, y])));
            }
            *traced = rows.end;
        }
        let counts = [AtomicU64::new(0), AtomicU64::new(0)];
        let (start, bundles) = (Instant::now(), tasks.len());
        let whole = self.for_each_task(epoch, tasks, &|(which, at), scratch| {
            let (deal, pass) = (&deals[which], first_pass + which as u64);
            epoch.trace(deal, at, pass, 1, scratch, &|pixel, sample| {
                canvas.put(which, pixel, sample);
            });
            counts[0].fetch_add(std::mem::take(&mut scratch.rays), Ordering::Relaxed);
            counts[1].fetch_add(std::mem::take(&mut scratch.capped), Ordering::Relaxed);
        });
        if whole && bundles > 0 {
            let waves = start.elapsed().as_secs_f64() / WAVE_TIME.as_secs_f64();
            let samples = 512.0 * bundles as f64 / waves.max(1e-6);
            self.wave.store(samples as u64, Ordering::Relaxed);
        }
        if whole {
            let [rays, capped] = counts.map(AtomicU64::into_inner);
            epoch.count(Counts { rays, capped, ..Counts::default() });
        }
        whole
    }

    /// Deals tasks to the workers; false if some were left because it was to stop.
    fn for_each_task<T: Send>(
        &self,
        epoch: &Epoch,
        tasks: Vec<T>,
        work: &(dyn Fn(T, &mut Scratch) + Sync),
    ) -> bool {
        let finished = AtomicBool::new(true);
        self.pool.install(|| {
            tasks.into_par_iter().with_max_len(1).for_each(|task| {
                if !self.shared.goes_on(epoch.number) {
                    finished.store(false, Ordering::Relaxed);
                    return;
                }
                // A worker's own: nobody waits for this lock.
                let worker = rayon::current_thread_index().unwrap_or(0);
                let mut scratch =
                    epoch.scratch[worker].lock().unwrap_or_else(PoisonError::into_inner);
                work(task, &mut scratch);
            })
        });
        finished.into_inner()
    }

    /// Blocks of pixels in the colour of one sample each, ever finer.
    fn preview(&self, epoch: &Epoch, canvas: &mut Canvas, most: &mut u64) {
        let Params { size, seed, .. } = epoch.params;
        let coarse = |block: u32| size.map(|side| side.div_ceil(block));
        let paths = |block: u32| coarse(block).map(u64::from).iter().product::<u64>();
        let mut block = 1u32;
        while paths(block) > *most {
            block *= 2;
        }
        while block > 1 && self.shared.goes_on(epoch.number) {
            let apart = epoch.group.get() == Some(&Group::None);
            let group = if apart { Group::None } else { PREVIEW_GROUP };
            let deal = Deal::new(coarse(block), seed, 0, group);
            canvas.prepare(coarse(block), 1);
            let [columns, rows] = deal.bundles();
            let tasks = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])).collect();
            let start = Instant::now();
            let whole = self.for_each_task(epoch, tasks, &|at, scratch| {
                let put = |pixel, sample| canvas.put(0, pixel, sample);
                epoch.trace(&deal, at, 0, block, scratch, &put);
                (scratch.rays, scratch.capped) = (0, 0);
            });
            if !whole {
                return;
            }
            let speed = PREVIEW_TIME.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-6);
            *most = (paths(block) as f64 * speed).clamp(1024.0, 131_072.0) as u64;
            self.pool.install(|| {
                (0..epoch.grid.len())
                    .into_par_iter()
                    .for_each(|index| epoch.show_preview(index, canvas, block))
            });
            self.outlet.send(|| epoch.snapshot(State::Running, 0));
            block /= PREVIEW_STEP;
        }
    }

    /// A snapshot, if the last one is long enough ago and no other worker is about it.
    fn show_now_and_then(&self, epoch: &Epoch) {
        let Ok(mut last) = epoch.last_snapshot.try_lock() else { return };
        if last.elapsed() < self.shared.interval() {
            return;
        }
        *last = Instant::now();
        self.outlet.send(|| epoch.snapshot(State::Running, epoch.passes_shown()));
    }
}

fn whole_passes(films: &[Film]) -> u64 {
    films.iter().map(Film::passes).min().unwrap_or(0)
}

fn failure(epoch: &Epoch, panic: &(dyn std::any::Any + Send)) -> String {
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

impl Epoch {
    fn new(number: u64, params: Params, threads: usize) -> Epoch {
        let grid = TileGrid { size: params.size };
        let tracer = params.tracer();
        let mut shown = Vec::new();
        shown.resize_with(grid.len(), Shown::default);
        let scratch = (0..threads.max(1)).map(|_| Mutex::new(tracer.scratch())).collect();
        let group = OnceLock::new();
        let known = match params.group {
            _ if !tracer.shares(params.model) => Some(Group::None),
            given @ Some(_) => given,
            None => None,
        };
        if let Some(known) = known {
            let _ = group.set(known);
        }
        Epoch {
            number,
            params,
            tracer,
            group,
            grid,
            scratch,
            shown,
            counts: Default::default(),
            earlier: AtomicU64::new(0),
            run_start: Mutex::new(None),
            last_snapshot: Mutex::new(Instant::now()),
        }
    }

    /// Traces a bundle of a deal.
    fn trace(
        &self,
        deal: &Deal,
        at: [u32; 2],
        pass: u64,
        block: u32,
        scratch: &mut Scratch,
        put: &(dyn Fn([u32; 2], Rgb) + Sync),
    ) {
        let mut hand = Hand::default();
        deal.bundle(at, &mut hand);
        let tracer = &self.tracer;
        self.params.model.visit(TraceHand { tracer, hand: &hand, pass, block, scratch, put });
    }

    /// Adds the samples of some passes to a tile's film.
    fn add(&self, index: usize, film: &mut Film, canvas: &Canvas, passes: usize) {
        let rect = self.grid.rect(index);
        let mut nonfinite = 0;
        for pass in 0..passes {
            film.begin_pass();
            for (pixel, sample) in canvas.tile(pass, rect).enumerate() {
                if sample.is_finite() {
                    film.add(pixel, sample);
                } else {
                    nonfinite += 1;
                }
            }
            film.end_pass();
        }
        let paths = rect.area() as u64 * passes as u64;
        self.count(Counts { paths, nonfinite, ..Counts::default() });
    }

    /// Shows what a film has if it is more than what is shown.
    fn show_if_new(&self, index: usize, film: &Film) {
        let shown = self.shown[index].image.lock().unwrap_or_else(PoisonError::into_inner);
        let passes = shown.as_ref().map_or(0, |(image, _)| image.passes);
        drop(shown);
        if film.passes() == passes {
            return;
        }
        let estimate = film.estimate(self.grid.rect(index).width());
        let image = TileImage {
            passes: film.passes(),
            mean: estimate.mean,
            standard_error: estimate.standard_error,
            block: 1,
        };
        self.show(index, image, estimate.sums);
    }

    /// Shows a tile in blocks of the colours on the canvas.
    fn show_preview(&self, index: usize, canvas: &Canvas, block: u32) {
        let rect = self.grid.rect(index);
        let mut mean = Vec::with_capacity(rect.area());
        for y in rect.y0..rect.y1 {
            for left in (rect.x0..rect.x1).step_by(block as usize) {
                let colour = canvas.at([left / block, y / block]);
                let colour = if colour.is_finite() { colour } else { Rgb::BLACK };
                let width = block.min(rect.x1 - left) as usize;
                mean.extend(std::iter::repeat_n(<[f32; 3]>::from(colour), width));
            }
        }
        let image = TileImage { passes: 0, mean, standard_error: Vec::new(), block };
        self.show(index, image, ErrorSums::default());
    }

    /// Whether the last snapshot is so long ago.
    fn is_snapshot_due(&self, interval: Duration) -> bool {
        let last = self.last_snapshot.lock().unwrap_or_else(PoisonError::into_inner);
        last.elapsed() >= interval
    }

    fn show(&self, index: usize, image: TileImage, sums: ErrorSums) {
        let shown = &self.shown[index];
        *shown.image.lock().unwrap_or_else(PoisonError::into_inner) = Some((Arc::new(image), sums));
        shown.dirty.store(true, Ordering::Release);
    }

    fn count(&self, c: Counts) {
        for (total, n) in self.counts.iter().zip([c.paths, c.rays, c.nonfinite, c.capped]) {
            total.fetch_add(n, Ordering::Relaxed);
        }
    }

    fn clock(&self, running: bool) {
        let mut start = self.run_start.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(start) = start.take() {
            self.earlier.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        }
        *start = running.then(Instant::now);
    }

    fn seconds(&self) -> f64 {
        let start = self.run_start.lock().unwrap_or_else(PoisonError::into_inner);
        let run = start.map_or(0.0, |s| s.elapsed().as_secs_f64());
        run + self.earlier.load(Ordering::Relaxed) as f64 * 1e-9
    }

    fn passes_shown(&self) -> u64 {
        let passes = |s: &Shown| match &*s.image.lock().unwrap_or_else(PoisonError::into_inner) {
            Some((image, _)) => image.passes,
            None => 0,
        };
        self.shown.iter().map(passes).min().unwrap_or(0)
    }

    fn snapshot(&self, state: State, passes: u64) -> Snapshot {
        let mut dirty = Vec::new();
        let mut tiles = Vec::with_capacity(self.shown.len());
        let mut sums = ErrorSums::default();
        for (index, shown) in self.shown.iter().enumerate() {
            // The flag first: an image shown in between is then sent twice rather than never.
            if shown.dirty.swap(false, Ordering::AcqRel) {
                dirty.push(index as u32);
            }
            let image = shown.image.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if let Some((_, tile)) = &image {
                sums.add(tile);
            }
            tiles.push(image.map(|(i, _)| i));
        }
        let [paths, rays, nonfinite, capped] =
            [0, 1, 2, 3].map(|i: usize| self.counts[i].load(Ordering::Relaxed));
        let pixels = self.params.size.map(u64::from).iter().product();
        Snapshot {
            epoch: self.number,
            grid: self.grid,
            tiles,
            dirty,
            passes,
            counts: Counts { paths, rays, nonfinite, capped },
            error: sums.estimate(pixels, passes),
            group: self.group.get().copied().unwrap_or_default(),
            seconds: self.seconds(),
            state,
        }
    }
}

/// One pass of a bundle.
struct TraceHand<'a> {
    tracer: &'a Tracer,
    hand: &'a Hand,
    pass: u64,
    block: u32,
    scratch: &'a mut Scratch,
    put: &'a (dyn Fn([u32; 2], Rgb) + Sync),
}

impl ModelVisitor for TraceHand<'_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let TraceHand { tracer, hand, pass, block, scratch, put } = self;
        tracer
            .sample_hand::<M>(hand, pass, block, scratch, &mut |pixel, sample| put(pixel, sample));
    }
}
