//! What the workers do: coarse blocks, then pass after pass over the tiles.

#[cfg(test)]
mod tests;

use super::accumulator::whole_passes;
use super::control::{Options, Shared};
use super::epoch::{Epoch, Own};
use super::first_hits::FirstHitCache;
use super::mailbox::Mailbox;
use super::sample_buffer::SampleBuffer;
use super::turn::Role;
use super::{Counts, Params, ParamsError, State, TILE, choose_group, plan};
use crate::film::Film;
use crate::math::soa::BATCH as PATHS;
use crate::trace::{BatchOptions, FirstHits, PixelGrouping, ReuseGroup, Scratch};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Most passes that are traced before their samples are added up.
const BATCH: u64 = 16;
/// What is traced between two looks at what is wanted is to take about so long: it is what a pause
/// loses, and how often the picture shows what is new. No sum depends on it.
const WAVE_TIME: Duration = Duration::from_millis(50);
/// Fewest and most samples of that, for one worker and for all.
const WAVE_LEAST: u64 = 8 * PATHS as u64;
const WAVE_MOST: u64 = 1 << 18;

/// A preview has as many paths as the last one traced in this time, so that it stands within a
/// frame's. It is thrown away, so it may depend on the clock.
const PREVIEW_TIME: Duration = Duration::from_millis(10);
/// Paths of the first preview of all.
const PREVIEW_PATHS: u64 = 8192;
/// The preview is refined by this factor in each direction until a pass is no finer.
const PREVIEW_STEP: u32 = 4;
/// Paths of a preview that share.
const PREVIEW_GROUP: ReuseGroup = ReuseGroup::Sixteen;

/// What a driver has from one epoch to the next besides the films.
pub(super) struct Store {
    sample_buffer: SampleBuffer,
    /// Of the next preview.
    preview_paths: u64,
    first_hits: FirstHitCache,
}

impl Default for Store {
    fn default() -> Store {
        let (sample_buffer, first_hits) = (SampleBuffer::default(), FirstHitCache::default());
        Store { sample_buffer, preview_paths: PREVIEW_PATHS, first_hits }
    }
}

/// Passes that are traced at once, and what is kept of the first one.
#[derive(Clone, Copy)]
struct Rounds<'a> {
    groupings: &'a [PixelGrouping],
    /// The first one's number.
    first: u64,
    /// Of each batch, or nothing.
    first_hits: &'a [FirstHits],
}

pub(super) struct Workers {
    options: Options,
    pub(super) shared: Arc<Shared>,
    /// For the picture that is shown, and for the one beside.
    outlets: [Mailbox; 2],
    pool: ThreadPool,
    /// Samples to be traced in [`WAVE_TIME`], as far as is known.
    wave: AtomicU64,
}

impl Workers {
    pub(super) fn new(
        options: Options,
        shared: Arc<Shared>,
        outlets: [Mailbox; 2],
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
        Ok(Workers { options, shared, outlets, pool, wave })
    }

    /// Traces until the pass limit, until others are to have the workers, or until an interruption.
    pub(super) fn run(&self, epoch: &Epoch, films: &mut [Film], store: &mut Store, until: u64) {
        epoch.clock(true);
        store.first_hits.renew(&epoch.params);
        let beside = self.shared.beside();
        let goes_on = || self.shared.goes_on(epoch.turn) && self.shared.beside() == beside;
        if self.options.preview && epoch.turn.role == Role::Shown && whole_passes(films) == 0 {
            self.preview(epoch, store);
        }
        let Some(group) = self.group(epoch) else { return epoch.clock(false) };
        let pixels: u64 = epoch.params.size.map(u64::from).iter().product();
        while goes_on() && !self.shared.is_wished() {
            let done = whole_passes(films);
            let at_once = done.clamp(1, BATCH).min((self.wave() / pixels).max(1));
            let mut target = (done + at_once).min(self.shared.limit()).min(until);
            if done >= target {
                break;
            }
            if epoch.params.uniform {
                self.passes(epoch, films, store, done..target, group);
            } else {
                // Whatever a plan is made from is there before it is.
                target = target.min(plan::end_of_plan(done));
                if done < plan::UNIFORM {
                    self.passes(epoch, films, store, done..target, group);
                } else {
                    self.uneven_passes(epoch, films, target, group);
                }
            }
            // The first whole pass is worth showing whenever it comes.
            if done == 0 && whole_passes(films) > 0 {
                self.send(epoch, State::Running, whole_passes(films));
            }
        }
        self.show_all(epoch, films);
        epoch.clock(false);
    }

    /// How many paths share, found out if it is not known; `None` if it was to stop before.
    fn group(&self, epoch: &Epoch) -> Option<ReuseGroup> {
        if let Some(&group) = epoch.group.get() {
            return Some(group);
        }
        let found = Mutex::new(Vec::new());
        let whole = self.for_each_task(epoch, choose_group::tasks(), &|task, own| {
            let result = task.run(&epoch.params, &epoch.tracer, &mut own.scratch);
            found.lock().unwrap_or_else(PoisonError::into_inner).push(result);
        });
        let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        let primitives = epoch.params.scene.geometry().len();
        let uniform = epoch.params.uniform;
        whole.then(|| *epoch.group.get_or_init(|| choose_group::choose(found, primitives, uniform)))
    }

    /// Some passes of a sample a pixel, in bands of as many rows as are worth it. Ends early when it is
    /// to.
    fn passes(
        &self,
        epoch: &Epoch,
        films: &mut [Film],
        Store { sample_buffer, first_hits: cache, .. }: &mut Store,
        passes: Range<u64>,
        group: ReuseGroup,
    ) {
        let Params { size, seed, first_pass, .. } = epoch.params;
        let groupings: Vec<PixelGrouping> = passes
            .clone()
            .map(|pass| PixelGrouping::new(size, seed, first_pass + pass, group))
            .collect();
        // Only who edits comes back to the first pass.
        let first_hits = match passes {
            Range { start: 0, end: 1 } if self.options.preview && first_pass == 0 => {
                cache.pass(1, group, &groupings[0])
            }
            _ => &[],
        };
        sample_buffer.prepare(size, groupings.len());
        let columns = epoch.grid.columns_rows()[0] as usize;
        let rows = films.len() / columns;
        // Rows of tiles that had all of these before an interruption are not traced again.
        let have = |films: &[Film], row: usize| {
            films[row * columns..][..columns].iter().all(|film| film.passes() >= passes.end)
        };
        let mut row = (0..rows).find(|&row| !have(films, row)).unwrap_or(rows);
        let mut traced = vec![0; groupings.len()];
        let samples = (size[0] * TILE) as usize * groupings.len();
        while row < rows {
            let band = (self.wave() as usize).div_ceil(samples);
            let end = (row + band).min(rows);
            let lines = row as u32 * TILE..(end as u32 * TILE).min(size[1]);
            let rounds =
                Rounds { groupings: &groupings, first: first_pass + passes.start, first_hits };
            if !self.trace_lines(epoch, sample_buffer, rounds, lines, &mut traced) {
                return;
            }
            let due = passes.start == 0 || epoch.is_snapshot_due(self.shared.interval());
            let films = &mut films[row * columns..end * columns];
            self.pool.install(|| {
                films.par_iter_mut().enumerate().for_each(|(i, film)| {
                    let index = row * columns + i;
                    epoch.add(index, film, sample_buffer, passes.clone());
                    // Every row gets its turn, whenever the others were shown.
                    if due || self.options.preview && epoch.is_behind(index, film) {
                        epoch.show_if_new(index, film);
                        self.show_now_and_then(epoch);
                    }
                })
            });
            row = end;
        }
    }

    /// Passes up to this one that give cells as many samples as is planned for them. Every tile goes
    /// through them by itself. Ends early when it is to.
    fn uneven_passes(&self, epoch: &Epoch, films: &mut [Film], target: u64, group: ReuseGroup) {
        let plan = epoch.plan(films);
        let due = epoch.is_snapshot_due(self.shared.interval());
        let (start, samples) = (Instant::now(), AtomicU64::new(0));
        self.pool.install(|| {
            films.par_iter_mut().enumerate().with_max_len(1).for_each(|(index, film)| {
                // A worker's own: nobody waits for this lock.
                let worker = rayon::current_thread_index().unwrap_or(0);
                let mut own = epoch.own[worker].lock().unwrap_or_else(PoisonError::into_inner);
                let before = film.passes();
                while film.passes() < target && self.shared.goes_on(epoch.turn) {
                    let wanted = || self.shared.is_wanted(epoch.turn);
                    let own = &mut own;
                    let (n, whole) = epoch.uneven_pass(index, film, &plan, group, own, &wanted);
                    samples.fetch_add(n, Ordering::Relaxed);
                    if !whole {
                        return;
                    }
                }
                drop(own);
                if film.passes() == before {
                    return;
                }
                if due || self.options.preview && epoch.is_behind(index, film) {
                    epoch.show_if_new(index, film);
                    self.show_now_and_then(epoch);
                }
            })
        });
        let samples = samples.into_inner();
        if samples > 0 {
            let waves = start.elapsed().as_secs_f64() / WAVE_TIME.as_secs_f64();
            self.wave.store((samples as f64 / waves.max(1e-6)) as u64, Ordering::Relaxed);
        }
    }

    /// Shows all that there is.
    pub(super) fn show_all(&self, epoch: &Epoch, films: &[Film]) {
        self.pool.install(|| {
            films.par_iter().enumerate().for_each(|(index, film)| epoch.show_if_new(index, film))
        });
    }

    /// Clears what is still to be cleared.
    pub(super) fn settle(&self, films: &mut [Film]) {
        self.pool.install(|| films.par_iter_mut().for_each(Film::settle));
    }

    pub(super) fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Samples that are worth tracing before the next look.
    fn wave(&self) -> u64 {
        let least = WAVE_LEAST * self.pool.current_num_threads() as u64;
        self.wave.load(Ordering::Relaxed).clamp(least, WAVE_MOST.max(least))
    }

    /// Traces what these lines of the picture need, but for the rows of batches that already are:
    /// false if it was to stop before all of them were there.
    fn trace_lines(
        &self,
        epoch: &Epoch,
        sample_buffer: &SampleBuffer,
        Rounds { groupings, first, first_hits }: Rounds,
        lines: Range<u32>,
        traced: &mut [u32],
    ) -> bool {
        let mut tasks = Vec::new();
        for (which, (grouping, traced)) in groupings.iter().zip(traced).enumerate() {
            let rows = grouping.batch_rows(lines.clone());
            let columns = grouping.batches()[0];
            for y in rows.start.max(*traced)..rows.end {
                tasks.extend((0..columns).map(|x| (which, [x, y])));
            }
            *traced = rows.end;
        }
        let counts = [AtomicU64::new(0), AtomicU64::new(0)];
        let (start, batches) = (Instant::now(), tasks.len());
        let whole = self.for_each_task(epoch, tasks, &|(which, at), own| {
            let (grouping, pass) = (&groupings[which], first + which as u64);
            let put = &mut |pixel, sample| sample_buffer.put(which, pixel, sample);
            let first_hits = first_hits.get((at[1] * grouping.batches()[0] + at[0]) as usize);
            epoch.trace(
                grouping,
                at,
                BatchOptions { first_hits, ..BatchOptions::of(pass) },
                own,
                put,
            );
            let Scratch { rays, capped, .. } = &mut own.scratch;
            counts[0].fetch_add(std::mem::take(rays), Ordering::Relaxed);
            counts[1].fetch_add(std::mem::take(capped), Ordering::Relaxed);
        });
        if whole && batches > 0 {
            let waves = start.elapsed().as_secs_f64() / WAVE_TIME.as_secs_f64();
            let samples = (PATHS * batches) as f64 / waves.max(1e-6);
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
        work: &(dyn Fn(T, &mut Own) + Sync),
    ) -> bool {
        let finished = AtomicBool::new(true);
        self.pool.install(|| {
            tasks.into_par_iter().with_max_len(1).for_each(|task| {
                if !self.shared.goes_on(epoch.turn) {
                    finished.store(false, Ordering::Relaxed);
                    return;
                }
                // A worker's own: nobody waits for this lock.
                let worker = rayon::current_thread_index().unwrap_or(0);
                let mut own = epoch.own[worker].lock().unwrap_or_else(PoisonError::into_inner);
                work(task, &mut own);
            })
        });
        finished.into_inner()
    }

    /// Blocks of pixels in the colour of one sample each, ever finer.
    fn preview(&self, epoch: &Epoch, store: &mut Store) {
        let Store { sample_buffer, preview_paths: most, first_hits: cache } = store;
        let Params { size, seed, .. } = epoch.params;
        let coarse = |block: u32| size.map(|side| side.div_ceil(block));
        let paths = |block: u32| coarse(block).map(u64::from).iter().product::<u64>();
        let mut block = 1u32;
        while paths(block) > *most {
            block *= 2;
        }
        while block > 1 && self.shared.goes_on(epoch.turn) {
            let apart = epoch.group.get() == Some(&ReuseGroup::None);
            let group = if apart { ReuseGroup::None } else { PREVIEW_GROUP };
            let grouping = PixelGrouping::new(coarse(block), seed, 0, group);
            sample_buffer.prepare(coarse(block), 1);
            let [columns, rows] = grouping.batches();
            let tasks = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])).collect();
            let first_hits = cache.pass(block, group, &grouping);
            let start = Instant::now();
            let whole = self.for_each_task(epoch, tasks, &|at, own| {
                let put = &mut |pixel, sample| sample_buffer.put(0, pixel, sample);
                let first_hits = first_hits.get((at[1] * columns + at[0]) as usize);
                epoch.trace(
                    &grouping,
                    at,
                    BatchOptions { block, first_hits, ..BatchOptions::of(0) },
                    own,
                    put,
                );
                (own.scratch.rays, own.scratch.capped) = (0, 0);
            });
            if !whole {
                return;
            }
            let speed = PREVIEW_TIME.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-6);
            *most = (paths(block) as f64 * speed).clamp(1024.0, 131_072.0) as u64;
            self.pool.install(|| {
                (0..epoch.grid.len())
                    .into_par_iter()
                    .for_each(|index| epoch.show_preview(index, sample_buffer, block))
            });
            self.send(epoch, State::Running, 0);
            block /= PREVIEW_STEP;
        }
    }

    /// Leaves a snapshot for whoever looks at this picture.
    pub(super) fn send(&self, epoch: &Epoch, state: State, passes: u64) {
        match epoch.turn.role {
            Role::Shown => self.outlets[0].send(|| epoch.snapshot(state, passes)),
            Role::Beside => self.outlets[1].send(|| epoch.snapshot(state, passes)),
            Role::Background => {}
        }
    }

    /// A snapshot, if the last one is long enough ago and no other worker is about it.
    fn show_now_and_then(&self, epoch: &Epoch) {
        let Ok(mut last) = epoch.last_snapshot.try_lock() else { return };
        if last.elapsed() < self.shared.interval() {
            return;
        }
        *last = Instant::now();
        self.send(epoch, State::Running, epoch.passes_shown());
    }
}
