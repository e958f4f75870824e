//! Logarithmic axes with round ends.

/// An axis from one round number to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    low: f64,
    high: f64,
}

/// Values that an axis may begin and end with, times a power of ten.
const ROUND: [f64; 3] = [1.0, 2.0, 5.0];

impl Axis {
    /// An axis from the round number below the least of these to the one above the greatest, at least a
    /// factor of 10; of what has a logarithm. `None` if nothing has.
    pub(super) fn over(values: impl Iterator<Item = f64>) -> Option<Axis> {
        let placed = values.filter(|v| *v > 0.0 && v.is_finite());
        let [low, high] =
            placed.fold([f64::INFINITY, 0.0f64], |[low, high], v| [low.min(v), high.max(v)]);
        if low > high {
            return None;
        }
        let steps = |of: f64| {
            let decade = of.log10().floor() as i32;
            (decade - 1..=decade + 1)
                .flat_map(|d| ROUND.map(|f| f * 10f64.powi(d)))
                .collect::<Vec<_>>()
        };
        let below = steps(low).into_iter().rfind(|s| *s <= low * (1.0 + 1e-9));
        let above = steps(high).into_iter().find(|s| *s >= high * (1.0 - 1e-9));
        let (low, high) = (below.unwrap_or(low), above.unwrap_or(high));
        Some(Axis { low, high: high.max(10.0 * low) })
    }

    pub(super) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Place of a value, from 0 to 1; beyond that where it is beyond the ends.
    pub(super) fn share(&self, value: f64) -> f64 {
        (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// The value at a place.
    pub(super) fn value(&self, share: f64) -> f64 {
        self.low * (self.high / self.low).powf(share)
    }

    /// Round numbers on it, the more the shorter it is; powers of ten alone on a long one.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let decades = (self.high / self.low).log10();
        let factors: &[f64] = match decades {
            d if d < 1.5 => &[1.0, 2.0, 5.0],
            d if d < 3.5 => &[1.0, 3.0],
            _ => &[1.0],
        };
        let [first, last] = self.ends().map(|v| v.log10().floor() as i32);
        let all = (first..=last + 1).flat_map(|d| factors.iter().map(move |f| f * 10f64.powi(d)));
        let on = |v: &f64| (self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9)).contains(v);
        all.filter(on).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) -> bool {
        (found / expected - 1.0).abs() < 1e-9
    }

    #[test]
    fn ends_are_round_and_hold_all() {
        for (values, ends) in [
            (vec![0.013, 0.4], [0.01, 0.5]),
            (vec![0.3], [0.2, 2.0]),
            (vec![1.0, 1000.0], [1.0, 1000.0]),
            (vec![0.6, f64::NAN, 0.0, 99.0], [0.5, 100.0]),
            (vec![2e-7, 7e8], [2e-7, 1e9]),
        ] {
            let axis = Axis::over(values.iter().copied()).unwrap();
            let [low, high] = axis.ends();
            assert!(near(low, ends[0]) && near(high, ends[1]), "{values:?}: {axis:?}");
            assert!(near(axis.value(axis.share(0.37)), 0.37));
        }
        assert_eq!(Axis::over([0.0, f64::NAN].into_iter()), None);
    }

    #[test]
    fn ticks_are_few_and_on_the_axis() {
        for values in [[0.2, 2.0], [0.013, 0.4], [1e-3, 1.0], [1e-3, 1e6], [3.0, 3.1]] {
            let axis = Axis::over(values.into_iter()).unwrap();
            let ticks = axis.ticks();
            assert!((2..=10).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.iter().all(|&t| (-1e-6..=1.0 + 1e-6).contains(&axis.share(t))));
        }
    }
}
