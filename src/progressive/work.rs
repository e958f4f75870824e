//! What the workers do: coarse blocks, then pass after pass over the tiles.

use super::outlet::Outlet;
use super::session::{Options, Shared};
use super::{Counts, Params, ParamsError, Snapshot, State, TileGrid, TileImage, TileRect};
use crate::brdf::{Microfacet, ModelVisitor};
use crate::film::{ErrorSums, Film};
use crate::math::Rgb;
use crate::trace::{Scratch, Tracer};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Passes of one visit to a tile, once the first few are there: fewer waits for the last worker.
const BATCH: u64 = 16;
/// A preview has at most this many paths, so that it stands within a frame's time.
const PREVIEW_PATHS: u64 = 8192;
/// The preview is refined by this factor in each direction until a pass is no finer.
const PREVIEW_STEP: u32 = 4;
/// Tiles of a preview that one worker does at a time: together they fill a bundle of paths.
const TOGETHER: usize = 16;

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
}

/// Everything of one epoch that workers share. A new epoch gets a new one, so nothing of an old
/// epoch can reach it.
struct Epoch {
    number: u64,
    params: Params,
    tracer: Tracer,
    grid: TileGrid,
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
        Ok(Workers { options, shared, outlet, pool })
    }

    /// The driver's thread: until the handle is dropped.
    pub(super) fn drive(self) {
        let mut films: Vec<Film> = Vec::new();
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
                    let epoch = Epoch::new(number, *params);
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
            let outcome = catch_unwind(AssertUnwindSafe(|| self.run(epoch, &mut films)));
            if let Err(panic) = outcome {
                let reason = failure(epoch, panic.as_ref());
                self.outlet.send(|| epoch.snapshot(State::Failed(reason), whole_passes(&films)));
                failed = true;
            }
        }
    }

    /// Traces until the pass limit or an interruption.
    fn run(&self, epoch: &Epoch, films: &mut [Film]) {
        epoch.clock(true);
        let goes_on = || self.shared.goes_on(epoch.number);
        if self.options.preview && whole_passes(films) == 0 {
            self.preview(epoch, films);
        }
        while goes_on() {
            let done = whole_passes(films);
            let target = (done + done.clamp(1, BATCH)).min(self.shared.limit());
            if done >= target {
                break;
            }
            self.pool.install(|| {
                films.par_iter_mut().enumerate().with_max_len(1).for_each_init(
                    || epoch.tracer.scratch(),
                    |scratch, (index, film)| {
                        if film.passes() < target && goes_on() {
                            self.trace_tile(epoch, index, film, target, scratch);
                        }
                    },
                )
            });
            // The first whole pass is worth showing whenever it comes.
            if done == 0 && whole_passes(films) > 0 {
                self.outlet.send(|| epoch.snapshot(State::Running, whole_passes(films)));
            }
        }
        epoch.clock(false);
    }

    fn trace_tile(
        &self,
        epoch: &Epoch,
        index: usize,
        film: &mut Film,
        target: u64,
        scratch: &mut Scratch,
    ) {
        let rect = epoch.grid.rect(index);
        let mut counts = Counts::default();
        while film.passes() < target && self.shared.goes_on(epoch.number) {
            let tracer = &epoch.tracer;
            let pass = TilePass { tracer, rect, film, scratch, nonfinite: &mut counts.nonfinite };
            epoch.params.model.visit(pass);
            counts.paths += rect.area() as u64;
        }
        if counts.paths == 0 {
            return;
        }
        counts.rays = std::mem::take(&mut scratch.rays);
        counts.capped = std::mem::take(&mut scratch.capped);
        epoch.count(counts);
        let estimate = film.estimate(rect.width());
        let image = TileImage {
            passes: film.passes(),
            mean: estimate.mean,
            standard_error: estimate.standard_error,
            block: 1,
        };
        epoch.show(index, image, estimate.sums);
        self.show_now_and_then(epoch);
    }

    /// Blocks of pixels in the colour of one of them, ever finer.
    fn preview(&self, epoch: &Epoch, films: &[Film]) {
        let [w, h] = epoch.params.size.map(u64::from);
        let mut block = 1u32;
        while w.div_ceil(block as u64) * h.div_ceil(block as u64) > PREVIEW_PATHS {
            block *= 2;
        }
        while block > 1 && self.shared.goes_on(epoch.number) {
            let finished = AtomicBool::new(true);
            let starts: Vec<usize> = (0..films.len()).step_by(TOGETHER).collect();
            self.pool.install(|| {
                starts.into_par_iter().with_max_len(1).for_each_init(
                    || epoch.tracer.scratch(),
                    |scratch, start| {
                        if !self.shared.goes_on(epoch.number) {
                            finished.store(false, Ordering::Relaxed);
                            return;
                        }
                        let tiles = start..(start + TOGETHER).min(films.len());
                        preview_tiles(epoch, tiles, block, scratch);
                    },
                )
            });
            if finished.into_inner() {
                self.outlet.send(|| epoch.snapshot(State::Running, 0));
            }
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
    fn new(number: u64, params: Params) -> Epoch {
        let grid = TileGrid { size: params.size };
        let tracer = params.tracer();
        let mut shown = Vec::new();
        shown.resize_with(grid.len(), Shown::default);
        Epoch {
            number,
            params,
            tracer,
            grid,
            shown,
            counts: Default::default(),
            earlier: AtomicU64::new(0),
            run_start: Mutex::new(None),
            last_snapshot: Mutex::new(Instant::now()),
        }
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
            seconds: self.seconds(),
            state,
        }
    }
}

/// One pass over one tile.
struct TilePass<'a> {
    tracer: &'a Tracer,
    rect: TileRect,
    film: &'a mut Film,
    scratch: &'a mut Scratch,
    nonfinite: &'a mut u64,
}

impl ModelVisitor for TilePass<'_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let pass = self.film.begin_pass();
        let (film, nonfinite) = (&mut *self.film, self.nonfinite);
        let r = self.rect;
        let gw = 8; let gh = 4;
        let order: Vec<[u32;2]> = (r.y0..r.y1).step_by(gh).flat_map(|y| (r.x0..r.x1).step_by(gw).flat_map(move |x| (y..(y+gh as u32).min(r.y1)).flat_map(move |yy| (x..(x+gw as u32).min(r.x1)).map(move |xx| [xx,yy])))).collect();
        let mut i = 0;
        self.tracer.sample_each::<M>(&mut order.iter().copied(), pass, self.scratch, &mut |sample| {
            let [x, y] = order[i];
            i += 1;
            let pixel = ((y - r.y0) * (r.x1 - r.x0) + x - r.x0) as usize;
            if sample.is_finite() {
                film.add(pixel, sample);
            } else {
                *nonfinite += 1;
            }
        });
        self.film.end_pass();
    }
}

/// Tiles in blocks, each the colour of its middle pixel's first sample.
fn preview_tiles(epoch: &Epoch, tiles: Range<usize>, block: u32, scratch: &mut Scratch) {
    let rects: Vec<TileRect> = tiles.clone().map(|index| epoch.grid.rect(index)).collect();
    let middles: Vec<[u32; 2]> =
        rects.iter().flat_map(|r| blocks(*r, block)).map(|b| b.1).collect();
    let first = FirstSamples { tracer: &epoch.tracer, pixels: &middles, scratch };
    let mut colours = epoch.params.model.visit(first).into_iter();
    for (index, rect) in tiles.zip(rects) {
        let mut mean = vec![[0.0; 3]; rect.area()];
        for ([left, top], _) in blocks(rect, block) {
            let colour = colours.next().filter(|c| c.is_finite()).unwrap_or(Rgb::BLACK);
            for row in top..(top + block).min(rect.y1) {
                let start = (row - rect.y0) as usize * rect.width() + (left - rect.x0) as usize;
                let end = start + block.min(rect.x1 - left) as usize;
                mean[start..end].fill(colour.into());
            }
        }
        let image = TileImage { passes: 0, mean, standard_error: Vec::new(), block };
        epoch.show(index, image, ErrorSums::default());
    }
}

/// Corner and middle pixel of each block of a tile.
fn blocks(rect: TileRect, block: u32) -> impl Iterator<Item = ([u32; 2], [u32; 2])> {
    let TileRect { x0, y0, x1, y1 } = rect;
    (y0..y1).step_by(block as usize).flat_map(move |top| {
        (x0..x1).step_by(block as usize).map(move |left| {
            let x = (left + block / 2).min(x1 - 1);
            let y = (top + block / 2).min(y1 - 1);
            ([left, top], [x, y])
        })
    })
}

/// The first sample of some pixels.
struct FirstSamples<'a> {
    tracer: &'a Tracer,
    pixels: &'a [[u32; 2]],
    scratch: &'a mut Scratch,
}

impl ModelVisitor for FirstSamples<'_> {
    type Output = Vec<Rgb>;
    fn visit<M: Microfacet>(self) -> Vec<Rgb> {
        let mut found = Vec::with_capacity(self.pixels.len());
        let pixels = &mut self.pixels.iter().copied();
        self.tracer.sample_each::<M>(pixels, 0, self.scratch, &mut |sample| found.push(sample));
        found
    }
}
