//! The driver: a thread that deals the workers' time to the pictures that are wanted.

#[cfg(test)]
mod tests;

use super::accumulator::{Accumulator, AccumulatorCache};
use super::control::{Progress, Work};
use super::epoch::{Epoch, failure};
use super::turn::Turn;
use super::work::{Store, Workers};
use super::{Counts, Experiment, Params, State};
use crate::film::Film;
use crate::trace::ReuseGroup;
use std::mem::take;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What the first picture begins with.
pub(super) struct Start {
    films: Vec<Film>,
    group: Option<ReuseGroup>,
    counts: Counts,
}

impl Start {
    pub(super) fn of(experiment: Experiment) -> Start {
        let (group, counts) = (experiment.group(), experiment.counts());
        Start { films: experiment.into_films(), group, counts }
    }

    /// Begins an epoch with it, and shows it.
    pub(super) fn begin(self, epoch: Epoch, workers: &Workers) -> Accumulator {
        let Start { films, group, counts } = self;
        // Where the parameters leave no choice it is made already.
        let _ = group.map(|group| epoch.group.set(group));
        epoch.count(counts);
        workers.show_all(&epoch, &films);
        Accumulator { epoch, films }
    }
}

pub(super) struct Driver {
    workers: Workers,
    /// Until the first picture is begun.
    begin: Option<Start>,
    store: Store,
    shown: Option<Accumulator>,
    beside: Option<Accumulator>,
    /// Those that are not in use.
    cache: AccumulatorCache,
    /// Films whose samples are of no use any more, but whose memory is.
    spare: Vec<Film>,
    at: Progress,
    /// What was last told of the picture that is shown while it was at rest.
    reported: Option<(Progress, State)>,
    /// Parameters that fail or cannot be kept: not to be tried in the background again.
    useless: Vec<Params>,
}

impl Driver {
    pub(super) fn new(workers: Workers, begin: Option<Start>) -> Driver {
        Driver {
            workers,
            begin,
            store: Store::default(),
            shown: None,
            beside: None,
            cache: AccumulatorCache::default(),
            spare: Vec::new(),
            at: Progress::default(),
            reported: None,
            useless: Vec::new(),
        }
    }

    /// Until the handle is dropped.
    pub(super) fn drive(mut self) {
        loop {
            let keep = self.workers.shared.keep();
            self.cache.set_limit(keep);
            self.workers.shared.set_kept(self.cache.size());
            match self.next(keep) {
                Work::Stop => return,
                Work::Resize => {}
                Work::Keep => self.keep(),
                Work::Start(turn, params, discard) => self.start(turn, *params, discard),
                Work::StartBeside(turn, params) => self.start_beside(turn, params.map(|p| *p)),
                Work::Shown(turn, until) => {
                    self.reported = None;
                    let Some(mut shown) = self.shown.take() else { continue };
                    shown.epoch.turn = turn;
                    self.at.failed = !self.run(&mut shown, until);
                    self.at.passes = shown.passes();
                    self.shown = Some(shown);
                }
                Work::Beside(turn, until) => {
                    let Some(mut beside) = self.beside.take() else { continue };
                    beside.epoch.turn = turn;
                    let good = self.run(&mut beside, until);
                    self.at.beside_passes = good.then(|| beside.passes());
                    self.beside = good.then_some(beside);
                }
                Work::Background(turn, params) => self.in_the_background(turn, *params),
            }
        }
    }

    /// What to do now, and tells that nothing is if so.
    fn next(&mut self, keep: u64) -> Work {
        let Driver { workers, shown, beside, cache, at, reported, useless, .. } = self;
        let idle = |state: State| {
            let news = Some((*at, state.clone()));
            if *reported == news {
                return;
            }
            *reported = news;
            // Both are as far as they get.
            for accumulator in [&*shown, &*beside].into_iter().flatten() {
                workers.send(&accumulator.epoch, state.clone(), accumulator.passes());
            }
        };
        let there = |params: &Params| {
            let known =
                |of: &Option<Accumulator>| of.as_ref().is_some_and(|of| of.epoch.params == *params);
            let out = known(shown) || known(beside) || useless.contains(params);
            (!out && cache.has_room_for(params)).then(|| cache.passes(params))
        };
        workers.shared.wait(*at, keep, idle, there)
    }

    /// Shows a picture of these parameters: of what there is of them.
    fn start(&mut self, turn: Turn, params: Params, discard: bool) {
        if let Some(old) = self.shown.take() {
            // What failed may have samples that it does not count.
            match discard || self.at.failed {
                true => self.spare = old.films,
                false => self.put_aside(old),
            }
        }
        if self.beside.as_ref().is_some_and(|beside| beside.epoch.params == params) {
            self.beside.take().into_iter().for_each(|beside| self.put_aside(beside));
            self.at.beside_passes = None;
        }
        self.useless.clear();
        let shown = self.accumulator(turn, params);
        self.at = Progress { epoch: turn.epoch, passes: shown.passes(), failed: false, ..self.at };
        if self.at.passes > 0 {
            self.workers.send(&shown.epoch, State::Running, self.at.passes);
        }
        self.shown = Some(shown);
        self.reported = None;
    }

    /// Has a picture of these parameters beside it.
    fn start_beside(&mut self, turn: Turn, params: Option<Params>) {
        if let Some(old) = self.beside.take() {
            self.put_aside(old);
        }
        self.at.beside = turn.epoch;
        let shown = self.shown.as_ref().map(|shown| &shown.epoch.params);
        let beside = params.filter(|params| shown != Some(params));
        self.beside = beside.map(|params| self.accumulator(turn, params));
        self.at.beside_passes = self.beside.as_ref().map(Accumulator::passes);
        if let Some(beside) = self.beside.as_ref().filter(|beside| beside.passes() > 0) {
            self.workers.send(&beside.epoch, State::Running, beside.passes());
        }
    }

    /// Does what was wished with the experiment of the picture that is shown.
    fn keep(&mut self) {
        let wishes = self.workers.shared.wishes();
        let failed = self.at.failed;
        let Some(Accumulator { epoch, films }) = self.shown.as_mut().filter(|_| !failed) else {
            return;
        };
        self.workers.settle(films);
        let group = epoch.group.get().copied();
        let mut kept = Experiment::of(&epoch.params, group, epoch.counts(), take(films));
        for wish in wishes {
            // Who wished it notices by what it owns.
            let _ = catch_unwind(AssertUnwindSafe(|| wish(&mut kept)));
        }
        *films = kept.into_films();
    }

    fn in_the_background(&mut self, turn: Turn, params: Params) {
        let known = u64::from(self.cache.passes(&params) > 0);
        let others = self.cache.size()[0] - known;
        let mut accumulator = self.accumulator(turn, params.clone());
        let good = self.run(&mut accumulator, self.at.passes);
        let traced = accumulator.passes() > 0;
        if good {
            self.put_aside(accumulator);
        }
        // Where it was not kept, or another had to go for it, the two would be traced in turn for ever.
        if !good || traced && self.cache.size()[0] != others + 1 {
            self.useless.push(params);
        }
    }

    fn put_aside(&mut self, accumulator: Accumulator) {
        if let Some(films) = self.cache.put(accumulator) {
            self.spare = films;
        }
    }

    /// What there is of these parameters, ready to be traced.
    fn accumulator(&mut self, turn: Turn, params: Params) -> Accumulator {
        let threads = self.workers.threads();
        if let Some(begin) = self.begin.take().filter(|_| turn.epoch == 1) {
            return begin.begin(Epoch::new(turn, params, threads), &self.workers);
        }
        if let Some(mut kept) = self.cache.take(&params) {
            kept.epoch.wake(turn, threads);
            return kept;
        }
        if self.spare.is_empty() {
            self.cache.make_room(params.bytes_after(self.workers.shared.limit()));
        }
        let films = take(&mut self.spare);
        Accumulator::new(Epoch::new(turn, params, threads), films)
    }

    /// Traces; false if that failed, which is then told.
    fn run(&mut self, of: &mut Accumulator, until: u64) -> bool {
        let Driver { workers, store, .. } = self;
        let Accumulator { epoch, films } = &mut *of;
        let traced = AssertUnwindSafe(|| workers.run(epoch, films, store, until));
        match catch_unwind(traced) {
            Ok(()) => true,
            Err(panic) => {
                let reason = failure(&of.epoch, panic.as_ref());
                workers.send(&of.epoch, State::Failed(reason), of.passes());
                false
            }
        }
    }
}
