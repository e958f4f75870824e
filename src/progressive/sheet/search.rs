//! How many passes have an error, known of a picture that has less of it.

use crate::film::ErrorEstimate;

/// A search for the fewest passes whose error's upper 95 % limit is at most the wanted one.
pub(super) struct Search {
    wanted: f64,
    /// Passes and upper limits that are known, in the order of passes.
    known: Vec<(u64, f64)>,
    /// How many more may be asked for.
    left: usize,
}

impl Search {
    /// As near to the wanted error as is near enough.
    pub(super) const NEAR: f64 = 0.95;
    /// How many pictures are traced for it at most, all of them of fewer passes than the one that there is.
    const MOST: usize = 4;

    /// With a picture of this many passes and this error.
    pub(super) fn new(wanted: f64, passes: u64, error: &ErrorEstimate) -> Search {
        let known = vec![(passes, error.relative.interval.high)];
        Search { wanted, known, left: Search::MOST }
    }

    /// The number of passes to try next; `None` when the search is over.
    pub(super) fn next(&mut self) -> Option<u64> {
        let enough = self.known.partition_point(|(_, high)| *high > self.wanted);
        let &(most, low) = self.known.get(enough)?;
        if low >= Search::NEAR * self.wanted || self.left == 0 {
            return None;
        }
        self.left -= 1;
        let too_few = enough.checked_sub(1).map(|i| self.known[i]);
        // Errors fall with a power of the passes: the one between the two, else the root of independent
        // samples.
        let power = too_few.map_or(0.5, |(few, high)| {
            (high / low).ln() / (most as f64 / few as f64).ln().max(f64::MIN_POSITIVE)
        });
        let passes = most as f64 * (low / self.wanted).powf(1.0 / power.max(0.25));
        let least = too_few.map_or(1, |(few, _)| few + 1);
        (least < most).then(|| (passes.ceil() as u64).clamp(least, most - 1))
    }

    /// Takes in the error of a picture of this many passes, and returns whether it is the best so far.
    pub(super) fn note(&mut self, passes: u64, error: &ErrorEstimate) -> bool {
        let high = error.relative.interval.high;
        let place = self.known.partition_point(|(known, _)| *known < passes);
        self.known.insert(place, (passes, high));
        high <= self.wanted && place == self.known.partition_point(|(_, high)| *high > self.wanted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Figure, Interval};

    fn error(high: f64) -> ErrorEstimate {
        let figure = Figure { value: 0.9 * high, interval: Interval { low: 0.8 * high, high } };
        ErrorEstimate {
            rel_mse: figure,
            relative: figure,
            rmse: figure,
            terms: 99.0,
            reliable: true,
        }
    }

    /// Errors that fall faster and slower than those of independent samples do.
    #[test]
    fn the_fewest_passes_are_found_with_few_pictures() {
        for (power, factor) in [(0.5, 1.0), (0.75, 1.0), (0.6, 0.37), (0.35, 0.2), (1.0, 2.0)] {
            let truth = |passes: u64| factor * (passes as f64).powf(-power);
            for (passes, wanted) in [(64, 0.2), (64, 0.31), (1000, 0.1), (64, 0.03), (300, 1.5)] {
                if truth(passes) > wanted {
                    continue;
                }
                let mut search = Search::new(wanted, passes, &error(truth(passes)));
                let (mut best, mut tried) = (passes, 0);
                while let Some(next) = search.next() {
                    tried += 1;
                    assert!((1..passes).contains(&next));
                    if search.note(next, &error(truth(next))) {
                        assert!(next < best);
                        best = next;
                    }
                }
                assert!(truth(best) <= wanted && tried <= Search::MOST, "{power} {wanted}");
                let near = truth(best) >= Search::NEAR * wanted;
                assert!(near || best == 1 || truth(best - 1) > wanted, "{power} {wanted} {best}");
            }
        }
    }

    #[test]
    fn a_picture_that_is_near_enough_stays() {
        assert_eq!(Search::new(0.1, 64, &error(0.096)).next(), None);
        assert!(Search::new(0.1, 64, &error(0.09)).next().is_some());
        assert_eq!(Search::new(0.1, 1, &error(0.01)).next(), None);
    }

    /// Errors of few passes need not fall with every one.
    #[test]
    fn no_picture_is_taken_that_has_not_the_error() {
        let mut search = Search::new(0.1, 64, &error(0.02));
        while let Some(next) = search.next() {
            assert!(!search.note(next, &error(if next % 2 == 0 { 0.3 } else { 0.2 })));
        }
    }
}
