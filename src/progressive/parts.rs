//! Shares of a picture's passes, for as many machines.

use crate::math::sobol::REPLICATES;
use std::ops::Range;

/// The passes of part `number`, from 1, of `of` parts of a picture of `passes` passes: all of them one
/// after the other, each beginning with a multiple of 4, so that every part is assigned to the
/// replicates alike and knows its own error. Parts differ by 4 passes at most, but for what is left
/// of a number of passes that is not a multiple of 4, which the last one has. `None` where a part
/// would have no passes, or there is no such part.
pub fn part(passes: u64, number: u64, of: u64) -> Option<Range<u64>> {
    let fours = passes / REPLICATES as u64;
    if !(1..=of).contains(&number) || of > fours.max(1) {
        return None;
    }
    let start = |number: u64| {
        let fours = u128::from(fours) * u128::from(number) / u128::from(of);
        REPLICATES as u64 * fours as u64
    };
    Some(start(number - 1)..if number == of { passes } else { start(number) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_the_whole_one_after_the_other() {
        for (passes, of) in [(4096, 40), (4096, 1), (7, 1), (2, 1), (163, 40), (1 << 32, 1000)] {
            let parts: Vec<_> = (1..=of).map(|number| part(passes, number, of).unwrap()).collect();
            assert_eq!((parts[0].start, parts.last().unwrap().end), (0, passes));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(parts.iter().all(|part| part.start % 4 == 0 && part.start < part.end));
            let lengths = || parts.iter().map(|part| part.end - part.start);
            assert!(lengths().max().unwrap() - lengths().min().unwrap() <= 4 + passes % 4);
        }
        for (passes, number, of) in [(4096, 0, 40), (4096, 41, 40), (100, 1, 26), (8, 1, 0)] {
            assert_eq!(part(passes, number, of), None);
        }
    }
}
