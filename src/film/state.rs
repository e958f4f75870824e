//! A film as numbers, for files, and films of different passes as one.

use super::sums::Exact;
use super::{CELL, Film, Planned, Sums};
use crate::math::sobol::REPLICATES;
use thiserror::Error;

/// All that a film is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmState {
    /// Pixels of a row; at least 1.
    pub width: usize,
    /// Sums are multiples of two to this power, see [`Film::quantum`].
    pub quantum: i32,
    /// Whole passes.
    pub passes: u64,
    /// Whether there are samples of a pass that is not whole.
    pub open: bool,
    /// Whether numbers of samples were chosen.
    pub uneven: bool,
    /// Sums of the samples of each pixel, row by row, by replicate and channel, in quanta.
    pub sums: Vec<[[i128; 3]; REPLICATES]>,
    /// Samples of each pixel of a cell by replicate, cells row by row.
    pub counts: Vec<[u64; REPLICATES]>,
    /// As [`Film::spreads`] has them, by cell.
    pub spreads: Vec<[Vec<f32>; 2]>,
    /// After how many passes numbers were last chosen, and [`Film::planned`] of each cell.
    pub plan: Option<(u64, Vec<[u64; 2]>)>,
}

/// What is not, or not together, a film.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum FilmError {
    /// Tables of the wrong length.
    #[error("the tables of a film do not have the lengths that its pixels ask for")]
    Lengths,
    /// Films of different pixels or quanta.
    #[error("films of different sizes or quanta cannot be added")]
    Different,
    /// A film whose numbers of samples were chosen by its samples.
    #[error("films whose numbers of samples were chosen cannot be added")]
    Uneven,
}

impl Film {
    /// A film of such numbers.
    pub fn restore(state: FilmState) -> Result<Film, FilmError> {
        let FilmState { width, quantum, passes, open, uneven, sums, counts, spreads, plan } = state;
        let plan = plan.map(|(from, before)| Planned { from, before });
        let cells = match width {
            0 => return Err(FilmError::Lengths),
            _ => width.div_ceil(CELL) * sums.len().div_ceil(width).div_ceil(CELL),
        };
        let planned = plan.as_ref().map_or(cells, |plan| plan.before.len());
        if [counts.len(), spreads.len(), planned] != [cells; 3] {
            return Err(FilmError::Lengths);
        }
        let mut own = Sums::default();
        own.clear(sums.len(), quantum);
        for (pixel, sums) in sums.into_iter().enumerate() {
            (0..REPLICATES).for_each(|r| own.add_numbers(pixel, r, sums[r]));
        }
        Ok(Film { width, sums: own, counts, uneven, spreads, plan, passes, open, retired: None })
    }

    /// Sums of the samples of a pixel by replicate and channel, in quanta.
    pub fn sums(&self, pixel: usize) -> Exact {
        self.sums.get(pixel)
    }

    /// Whether all of them fit into 64 bits.
    pub fn fits_64_bits(&self) -> bool {
        self.sums.fit_64_bits()
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.sums.len()
    }

    /// Whether numbers of samples were chosen.
    pub fn is_uneven(&self) -> bool {
        self.uneven
    }

    /// Takes in the samples of other passes: to the bit what a film of both would be, in any order.
    pub fn merge(&mut self, other: &Film) -> Result<(), FilmError> {
        if self.uneven || other.uneven {
            return Err(FilmError::Uneven);
        }
        if self.width != other.width || !self.sums.is_like(&other.sums) {
            return Err(FilmError::Different);
        }
        for pixel in 0..self.sums.len() {
            let sums = other.sums.get(pixel);
            (0..REPLICATES).for_each(|r| self.sums.add_numbers(pixel, r, sums[r]));
        }
        for (counts, others) in self.counts.iter_mut().zip(&other.counts) {
            (0..REPLICATES).for_each(|r| counts[r] += others[r]);
        }
        self.passes += other.passes;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::math::numbers::Numbers;

    fn samples(seed: u64, count: usize) -> Vec<Rgb> {
        let mut numbers = Numbers(seed);
        (0..count).map(|_| Rgb::splat(10f64.powf(8.0 * numbers.next() - 4.0) as f32)).collect()
    }

    fn film(samples: &[Rgb]) -> Film {
        let mut film = Film::default();
        film.clear(3, 6);
        for pass in samples.chunks(6) {
            (0..).zip(pass).for_each(|(pixel, sample)| film.add(pixel, *sample));
            film.end_pass();
        }
        film
    }

    fn state(film: &Film) -> FilmState {
        FilmState {
            width: film.width,
            quantum: Film::quantum(0.0),
            passes: film.passes(),
            open: !film.is_whole(),
            uneven: film.is_uneven(),
            sums: (0..film.pixels()).map(|pixel| film.sums(pixel)).collect(),
            counts: (0..film.cells()).map(|cell| film.counts(cell)).collect(),
            spreads: (0..film.cells()).map(|cell| film.spreads(cell).clone()).collect(),
            plan: film.planned_at().map(|from| (from, vec![film.planned(0)])),
        }
    }

    #[test]
    fn a_film_comes_back_from_its_numbers() {
        let mut film = film(&samples(1, 6 * 16));
        (0..2).for_each(|half| film.note_spread(0, half));
        film.begin_plan(16);
        film.count_samples(0, 2);
        assert!(Film::restore(state(&film)).unwrap() == film);
        for spoil in [
            |s: &mut FilmState| s.width = 0,
            |s: &mut FilmState| s.width = 300_000,
            |s: &mut FilmState| s.counts.clear(),
            |s: &mut FilmState| s.spreads.push(Default::default()),
            |s: &mut FilmState| s.plan = Some((16, Vec::new())),
            |s: &mut FilmState| s.sums.resize(3 * 17, Default::default()),
        ] {
            let mut state = state(&film);
            spoil(&mut state);
            assert_eq!(Film::restore(state), Err(FilmError::Lengths));
        }
    }

    /// Parts of four passes each, in any order, are the film of all.
    #[test]
    fn parts_make_up_the_whole_to_the_bit() {
        let all = samples(2, 6 * 20);
        let whole = film(&all);
        for order in [[0, 1, 2, 3, 4], [4, 2, 0, 1, 3]] {
            let mut parts = order.map(|i: usize| film(&all[24 * i..24 * i + 24])).into_iter();
            let mut sum = parts.next().unwrap();
            parts.for_each(|part| sum.merge(&part).unwrap());
            assert!(sum == whole);
            assert!(sum.estimate(3) == whole.estimate(3));
        }
        let mut other = Film::default();
        other.clear(2, 6);
        assert_eq!(other.merge(&whole), Err(FilmError::Different));
        let mut chosen = whole.clone();
        chosen.count_samples(0, 0);
        assert_eq!(chosen.merge(&whole), Err(FilmError::Uneven));
        assert_eq!(whole.clone().merge(&chosen), Err(FilmError::Uneven));
    }
}
