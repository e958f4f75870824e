//! Sums that do not depend on the order of what is added: whole numbers of a small quantum.
//!
//! Sums of floating-point numbers depend on their order, so those of two parts of a picture would
//! not be, to the bit, those of the whole. Every sample is therefore rounded to a multiple of a
//! power of two, the [quantum](Film::quantum), and these multiples are added as integers.
//!
//! **Error.** A sample is off by at most half a quantum, and so is a mean. The quantum is 2^-48 of
//! the brightest emission of the scene, rounded up to a power of two, but at most 2^-44 W/(m² sr): a small
//! emitter that is brighter by far than what it shines on is no measure of the picture. Only for emissions
//! beyond 2^47 it is 2^-92 of these, the least for which 128 bits do. For a pixel of one
//! millionth of such a bound that is some 1e-8 of its radiance, less than the rounding of the mean to single
//! precision. Beyond that nothing is lost, where sums in double precision lose some 2^-53 of
//! themselves with every sample.
//!
//! **Size.** 64 bits hold 2^14 samples of radiance 8 or of the brightest emission if that is less. The
//! sums of a tile in which one outgrows them go on with 128 bits, enough for 2^32 samples of 2^94
//! quanta, 4 times the brightest emission or more; a sample beyond that counts as so much.

use crate::math::sobol::REPLICATES;

/// Of each replicate and channel.
pub(super) type Exact = [[i128; 3]; REPLICATES];

/// Powers of two by which the quantum is below the brightest emission,
pub(super) const BITS: i32 = 48;
/// but at most two to this power,
const MOST: i32 = -44;
/// and powers of two by which it is below the brightest emission at most.
const MOST_BITS: i32 = 92;
/// Multiples below this are rounded by adding [`MAGIC`], whose last place is 1.
const QUICK: f64 = (1u64 << 51) as f64;
const MAGIC: f64 = 1.5 * (1u64 << 52) as f64;
/// What all sums of 64 bits are below, so that one more sample of the quick kind fits.
const ROOM: u64 = 1 << 62;
/// The largest multiple that a sample is taken for: 2^32 of them fit into 128 bits.
const LARGEST: i128 = 1 << 94;

/// The sums of some pixels.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// The quantum, and one over it.
    quantum: f64,
    per_quantum: f64,
    /// Empty once they are wide.
    narrow: Vec<[[i64; 3]; REPLICATES]>,
    wide: Vec<Exact>,
}

impl Default for Sums {
    fn default() -> Sums {
        let (narrow, wide) = (Vec::new(), Vec::new());
        let mut sums = Sums { quantum: 1.0, per_quantum: 1.0, narrow, wide };
        sums.clear(0, -BITS);
        sums
    }
}

impl Sums {
    /// Makes them the empty sums of this many pixels in multiples of 2^`quantum`, in the memory that they have if
    /// it is enough, and else in as much as they need and no more.
    pub(super) fn clear(&mut self, pixels: usize, quantum: i32) {
        (self.quantum, self.per_quantum) = (power_of_two(quantum), power_of_two(-quantum));
        self.wide = Vec::new();
        self.narrow.clear();
        if self.narrow.capacity() < pixels {
            // The old given back first: together they would be held for a moment.
            self.narrow = Vec::new();
            self.narrow.reserve_exact(pixels);
        }
        self.narrow.resize(pixels, Default::default());
    }

    /// Bytes of memory that they hold.
    pub(super) fn bytes(&self) -> usize {
        self.narrow.capacity() * size_of::<[[i64; 3]; REPLICATES]>()
            + self.wide.capacity() * size_of::<Exact>()
    }

    /// Whether the others are of as many pixels and of the same quantum.
    pub(super) fn is_like(&self, o: &Sums) -> bool {
        (self.quantum, self.len()) == (o.quantum, o.len())
    }

    pub(super) fn len(&self) -> usize {
        self.narrow.len().max(self.wide.len())
    }

    #[inline]
    pub(super) fn add(&mut self, pixel: usize, replicate: usize, sample: [f32; 3]) {
        let scaled = sample.map(|x| f64::from(x) * self.per_quantum);
        if let Some(sums) = self.narrow.get_mut(pixel) {
            let sum = &mut sums[replicate];
            // To the nearest, and of two to the even one.
            let next = [0, 1, 2].map(|c: usize| {
                let number = (scaled[c] + MAGIC).to_bits().wrapping_sub(MAGIC.to_bits());
                sum[c].wrapping_add(number as i64)
            });
            let is_quick = scaled.iter().all(|x| x.abs() < QUICK);
            if is_quick && next.iter().all(|s| s.unsigned_abs() < ROOM) {
                *sum = next;
                return;
            }
        }
        self.add_slowly(pixel, replicate, scaled);
    }

    #[cold]
    fn add_slowly(&mut self, pixel: usize, replicate: usize, scaled: [f64; 3]) {
        let number = |x: f64| (x.round_ties_even() as i128).clamp(-LARGEST, LARGEST);
        self.add_numbers(pixel, replicate, scaled.map(number));
    }

    /// Adds multiples of the quantum of any size.
    pub(super) fn add_numbers(&mut self, pixel: usize, replicate: usize, numbers: [i128; 3]) {
        let sums = self.get(pixel)[replicate];
        let next: [i128; 3] = std::array::from_fn(|c| sums[c].saturating_add(numbers[c]));
        let narrow = |s: i128| i64::try_from(s).ok().filter(|s| s.unsigned_abs() < ROOM);
        match (self.narrow.get_mut(pixel), next.map(narrow)) {
            (Some(sums), [Some(r), Some(g), Some(b)]) => sums[replicate] = [r, g, b],
            _ => {
                self.widen();
                self.wide[pixel][replicate] = next;
            }
        }
    }

    fn widen(&mut self) {
        if self.wide.is_empty() {
            self.wide = self.narrow.iter().map(|sums| sums.map(|s| s.map(i128::from))).collect();
            self.narrow = Vec::new();
        }
    }

    pub(super) fn fit_64_bits(&self) -> bool {
        self.wide.iter().flatten().flatten().all(|&sum| i64::try_from(sum).is_ok())
    }

    /// The multiples of the quantum.
    pub(super) fn get(&self, pixel: usize) -> Exact {
        match self.narrow.get(pixel) {
            Some(sums) => sums.map(|s| s.map(i128::from)),
            None => self.wide[pixel],
        }
    }

    /// As radiance, each rounded once.
    #[inline]
    pub(super) fn radiance(&self, pixel: usize) -> [[f64; 3]; REPLICATES] {
        match self.narrow.get(pixel) {
            Some(sums) => sums.map(|s| s.map(|s| s as f64 * self.quantum)),
            None => self.wide[pixel].map(|s| s.map(|s| s as f64 * self.quantum)),
        }
    }
}

impl PartialEq for Sums {
    /// Whether they are the same numbers of the same quantum, however they are held.
    fn eq(&self, o: &Sums) -> bool {
        self.is_like(o) && (0..self.len()).all(|pixel| self.get(pixel) == o.get(pixel))
    }
}

/// Exact within the normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent.clamp(-1022, 1023)) as u64) << 52)
}

/// The exponent of the quantum for samples of which the brightest emission is this.
pub(super) fn quantum_for(brightest: f32) -> i32 {
    // Brightest is below 2^(exponent + 1).
    let exponent = (f64::from(brightest).to_bits() >> 52) as i32 - 1023;
    if brightest > 0.0 && brightest.is_finite() {
        (exponent + 1 - BITS).min(MOST).max(exponent + 1 - MOST_BITS)
    } else {
        -BITS
    }
}

/// Bytes of a pixel's sums after so many samples of each replicate, none of them above the brightest emission.
pub(super) fn pixel_bytes(brightest: f32, samples: u64) -> usize {
    let quanta = f64::from(brightest) * power_of_two(-quantum_for(brightest));
    let fit = quanta.is_nan() || quanta * (samples as f64) < ROOM as f64;
    if fit { size_of::<[[i64; 3]; REPLICATES]>() } else { size_of::<Exact>() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::numbers::Numbers;

    #[test]
    fn the_quantum_follows_the_brightest_emission() {
        for (brightest, power) in [
            (f32::MIN_POSITIVE, -125 - 48),
            (0.99, -48),
            (1.5, 1 - 48),
            (7.9, 3 - 48),
            // A tiny emitter is brighter than what it shines on.
            (16.0, -44),
            (1e12, -44),
            (1e18, 60 - 92),
        ] {
            assert_eq!(quantum_for(brightest), power, "{brightest}");
        }
        for none in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(quantum_for(none), -BITS);
        }
        assert_eq!([power_of_two(-3), power_of_two(4)], [0.125, 16.0]);
    }

    /// What is told ahead is what they come to.
    #[test]
    fn the_bytes_of_a_pixel_are_foreseen() {
        for (brightest, samples) in [
            (0.0, 9),
            (1.0, 9),
            (8.0, 16_000),
            (8.0, 33_000),
            (2e5, 1),
            (2e5, 2),
            (3e5, 1),
            (1e12, 1),
        ] {
            let mut sums = Sums::default();
            sums.clear(64, quantum_for(brightest));
            (0..samples).for_each(|_| sums.add(0, 1, [0.0, brightest, 0.5 * brightest]));
            assert_eq!(sums.bytes(), 64 * pixel_bytes(brightest, samples), "{brightest} {samples}");
        }
        assert_eq!(pixel_bytes(f32::NAN, 1), pixel_bytes(0.0, 1));
    }

    /// Samples over forty decades, negative ones among them: in any order and in any parts they come to
    /// the same sums, which are those of integers, each sample rounded by half a quantum at most.
    #[test]
    fn sums_are_those_of_integers_in_any_order() {
        let mut numbers = Numbers(3);
        let mut samples: Vec<[f32; 3]> = (0..3000)
            .map(|_| {
                [(); 3].map(|()| {
                    let size = 10f64.powf(40.0 * numbers.next() - 20.0) as f32;
                    if numbers.next() < 0.1 { -size } else { size }
                })
            })
            .collect();
        samples.extend([[f32::MAX, -f32::MAX, f32::MIN_POSITIVE]; 3]);
        for quantum in [-BITS, -10, 12] {
            let sums = |all: &[[f32; 3]]| {
                let mut sums = Sums::default();
                sums.clear(2, quantum);
                all.iter().for_each(|s| sums.add(1, 2, *s));
                sums
            };
            let whole = sums(&samples);
            let one = power_of_two(quantum);
            for c in 0..3 {
                let exact = samples.iter().fold(0i128, |sum, s| {
                    let number = (f64::from(s[c]) / one).round_ties_even();
                    assert!((number * one - f64::from(s[c])).abs() <= 0.5 * one);
                    sum + (number as i128).clamp(-LARGEST, LARGEST)
                });
                assert_eq!(whole.get(1)[2][c], exact);
            }
            assert_eq!(whole.get(0), Exact::default());
            let mut other = samples.clone();
            other.reverse();
            let (a, b) = other.split_at(1234);
            let (mut a, b) = (sums(a), sums(b));
            a.add_numbers(1, 2, b.get(1)[2]);
            assert!(a == whole);
        }
    }

    /// The quick way rounds as the slow one does, to both sides of every border.
    #[test]
    fn quick_and_slow_round_alike() {
        let mut numbers = Numbers(5);
        for power in -4..70 {
            for _ in 0..100 {
                let x = (power_of_two(power) * (0.5 + numbers.next())) as f32;
                for x in [x, -x, x.round() + 0.5] {
                    let mut sums = Sums::default();
                    sums.clear(1, 0);
                    sums.add(0, 0, [x, 0.0, 0.25]);
                    let number = f64::from(x).round_ties_even() as i128;
                    assert_eq!(sums.get(0)[0], [number, 0, 0]);
                }
            }
        }
    }

    /// Sums that outgrow 64 bits are what they would have been.
    #[test]
    fn sums_that_outgrow_their_bits_go_on() {
        let mut sums = Sums::default();
        sums.clear(3, -BITS);
        sums.add(0, 1, [0.5, 0.25, 3.0]);
        for _ in 0..100_000 {
            sums.add(2, 3, [2.0, -2.0, 1.0]);
        }
        assert!(sums.narrow.is_empty() && sums.len() == 3);
        let one = 1i128 << BITS;
        assert_eq!(sums.get(2)[3], [200_000 * one, -200_000 * one, 100_000 * one]);
        assert_eq!(sums.get(0)[1], [one / 2, one / 4, 3 * one]);
        assert_eq!(sums.radiance(2)[3], [200_000.0, -200_000.0, 100_000.0]);
    }
}
