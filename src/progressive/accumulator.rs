//! Accumulators: the samples of a picture, of the one that is shown and of others that may be wanted
//! again.
//!
//! Whoever compares models goes back and forth between a few sets of parameters. So what has been
//! traced of one is put aside when another is wanted, as it is, and goes on from there when it is
//! wanted again: a picture's bits do not tell how often it was left.

use super::Params;
use super::epoch::Epoch;
use crate::film::Film;
use crate::limits;

/// Pictures traced for less than this are the steps of a drag: they go first where memory is short.
const SECONDS_WORTH_KEEPING: f64 = 1.0;

/// The samples of a picture.
pub(super) struct Accumulator {
    pub(super) epoch: Epoch,
    /// Of each tile.
    pub(super) films: Vec<Film>,
}

impl Accumulator {
    /// An empty one that takes over the memory of films of no further use.
    pub(super) fn new(epoch: Epoch, mut films: Vec<Film>) -> Accumulator {
        films.resize_with(epoch.grid.len(), Film::default);
        films.truncate(epoch.grid.len());
        let quantum = epoch.params.quantum();
        for (index, film) in films.iter_mut().enumerate() {
            let rect = epoch.grid.rect(index);
            // Cleared by the workers, tile by tile, when they come to it.
            film.retire(rect.width(), rect.area(), quantum);
        }
        Accumulator { epoch, films }
    }

    /// Whole passes.
    pub(super) fn passes(&self) -> u64 {
        whole_passes(&self.films)
    }

    /// Bytes of memory that it holds while nothing is traced.
    fn bytes(&self) -> u64 {
        (self.epoch.bytes() + self.films.iter().map(Film::bytes).sum::<usize>()) as u64
    }
}

/// Passes that all of the films have.
pub(super) fn whole_passes(films: &[Film]) -> u64 {
    films.iter().map(Film::passes).min().unwrap_or(0)
}

/// Those put aside, the one that was used last at the end, in no more than a given memory.
#[derive(Default)]
pub(super) struct AccumulatorCache {
    kept: Vec<(Accumulator, u64)>,
    limit: u64,
}

impl AccumulatorCache {
    /// Keeps at most this many bytes from now on.
    pub(super) fn set_limit(&mut self, bytes: u64) {
        self.limit = bytes;
        self.evict();
    }

    /// Accumulators, and the bytes that they hold.
    pub(super) fn size(&self) -> [u64; 2] {
        [self.kept.len() as u64, self.kept.iter().map(|(_, bytes)| bytes).sum()]
    }

    /// Puts one aside. Returns its films if there is nothing in it that is worth its memory.
    pub(super) fn put(&mut self, mut accumulator: Accumulator) -> Option<Vec<Film>> {
        accumulator.epoch.rest();
        let bytes = accumulator.bytes();
        if accumulator.passes() == 0 || bytes > self.limit {
            return Some(accumulator.films);
        }
        self.kept.push((accumulator, bytes));
        self.evict();
        None
    }

    /// The one of these parameters, if it is there.
    pub(super) fn take(&mut self, params: &Params) -> Option<Accumulator> {
        let at = self.kept.iter().position(|(kept, _)| kept.epoch.params == *params)?;
        Some(self.kept.remove(at).0)
    }

    /// Passes that there are of these parameters.
    pub(super) fn passes(&self, params: &Params) -> u64 {
        let found = self.kept.iter().find(|(kept, _)| kept.epoch.params == *params);
        found.map_or(0, |(kept, _)| kept.passes())
    }

    /// Whether more of these parameters can be kept without another being given up for it.
    pub(super) fn has_room_for(&self, params: &Params) -> bool {
        let known = self.kept.iter().any(|(kept, _)| kept.epoch.params == *params);
        known || self.size()[1] + params.bytes() <= self.limit
    }

    /// Gives back memory until `bytes` more can be had from the system.
    pub(super) fn make_room(&mut self, bytes: u64) {
        let lacks = || limits::free().is_some_and(|free| bytes > free.bytes);
        while !self.kept.is_empty() && lacks() {
            self.evict_one();
        }
    }

    fn evict(&mut self) {
        while self.size()[1] > self.limit {
            self.evict_one();
        }
    }

    fn evict_one(&mut self) {
        let cheap = |(kept, _): &(Accumulator, u64)| kept.epoch.seconds() < SECONDS_WORTH_KEEPING;
        let at = self.kept.iter().position(cheap).unwrap_or(0);
        if at < self.kept.len() {
            self.kept.remove(at);
        }
    }
}
