//! Sample streams: Owen-scrambled Sobol points as a pure function.
//!
//! A number is fixed by (seed, pixel, pass, slot, dimension) and by nothing else: any thread count
//! and any order of work gives the same bits, and any path can be replayed alone.
//!
//! A path draws *pairs*, one a [`Slot`]. Over the passes of one pixel each slot is the Sobol (0,2)
//! sequence, its index shuffled and both coordinates scrambled by hashes of their own, so that
//! slots are independent of each other and any 2^k passes are stratified (Burley, "Practical
//! hash-based Owen scrambling", JCGT 9:4, 2020). Passes are assigned to [`REPLICATES`] independent
//! randomisations in turn, whose spread tells the error. After 65,536 passes of a replicate a new
//! randomisation begins, so indices need 16 bits only.

use super::simd::{Bits, Simd};

/// Independent randomisations that the passes are assigned to in turn.
pub const REPLICATES: usize = 4;

/// Which decision of a path a pair of numbers is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot(u32);

impl Slot {
    /// Position within the pixel.
    pub const CAMERA: Slot = Slot(0);
    /// Where on the light, at scattering event `event` counted from 0.
    pub fn light(event: u32) -> Slot {
        Slot(1 + 4 * event)
    }
    /// The scattered direction.
    pub fn direction(event: u32) -> Slot {
        Slot(2 + 4 * event)
    }
    /// Which lobe, which light.
    pub fn choice(event: u32) -> Slot {
        Slot(3 + 4 * event)
    }
    /// Russian roulette; the second number is spare.
    pub fn roulette(event: u32) -> Slot {
        Slot(4 + 4 * event)
    }
    /// Position within the pixel of split rays that look for emitters.
    pub(crate) const SPLIT_CAMERA: Slot = Slot(1 << 16);
    /// The scattered direction of split rays from the primary vertex.
    pub(crate) const SPLIT_DIRECTION: Slot = Slot(1 << 16 | 1);
    /// Their lobe.
    pub(crate) const SPLIT_CHOICE: Slot = Slot(1 << 16 | 2);
}

/// Mixes 32 bits; a bijection (the constants are those of C. Wellons' "triple32" search).
#[inline(always)]
pub fn mix<B: Bits>(x: B) -> B {
    let x = (x ^ (x >> 17)) * B::splat(0xed5a_d4bb);
    let x = (x ^ (x >> 11)) * B::splat(0xac4c_1b51);
    let x = (x ^ (x >> 15)) * B::splat(0x3184_8bab);
    x ^ (x >> 14)
}

/// Owen scrambling of a bit-reversed number: each bit flips by a hash of the bits below it
/// (Laine and Karras 2011, with the constants of N. Vegdahl 2021).
#[inline(always)]
fn scramble_reversed<B: Bits>(x: B, seed: B) -> B {
    let x = x ^ (x * B::splat(0x3d20_adea));
    let x = (x + seed) * ((seed >> 16) | B::splat(1));
    let x = x ^ (x * B::splat(0x0552_6c56));
    x ^ (x * B::splat(0x53a2_2864))
}

/// The second Sobol dimension of a 16-bit index, reversed: bit i of the result is the parity of the
/// index bits j whose number has all the bits of i (the Pascal matrix modulo 2, by Lucas).
#[inline(always)]
fn sobol_1_reversed<B: Bits>(index: B) -> B {
    let step = |x: B, by: u32, low: u32| x ^ ((x >> by) & B::splat(low));
    let x = step(index, 1, 0x5555);
    let x = step(x, 2, 0x3333);
    let x = step(x, 4, 0x0f0f);
    step(x, 8, 0x00ff)
}

/// What the streams of all pixels have in common in one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PassKey {
    /// Tells seeds, replicates and blocks of 65,536 passes apart.
    pub(crate) salt: u32,
    /// Which point of the sequence, in 16 bits.
    pub(crate) index: u32,
}

impl PassKey {
    /// Of `pass`, from 0.
    #[inline(always)]
    pub(crate) fn new(seed: u64, pass: u64) -> PassKey {
        let replicate = (pass % REPLICATES as u64) as u32;
        let block = ((pass / REPLICATES as u64) >> 16) as u32;
        // Equal for all pixels of a pass; mix is a bijection, so no two pixels share a key.
        let mut salt = mix_u32(seed as u32);
        salt = mix_u32(salt ^ (seed >> 32) as u32 ^ 0x9e37_79b9);
        salt = mix_u32(salt.wrapping_add(block));
        salt = mix_u32(salt ^ (replicate << 28 | 0x0123_4567));
        PassKey { salt, index: (pass / REPLICATES as u64) as u32 & 0xffff }
    }
}

/// The stream of one path (or of a lane's worth of paths, each of a pixel and a pass of its own).
#[derive(Clone, Copy, Debug)]
pub struct Stream<B> {
    key: B,
    /// Which point of the sequence, in 16 bits, and these reversed.
    index: B,
    reversed: B,
}

impl<B: Bits> Stream<B> {
    /// The stream of `pass` (from 0) of the pixel in column `x`, row `y` (from the top), each
    /// below 65,536.
    #[inline(always)]
    pub fn new(seed: u64, x: B, y: B, pass: u64) -> Stream<B> {
        let PassKey { salt, index } = PassKey::new(seed, pass);
        Stream::of_pixels(x, y, B::splat(salt), B::splat(index))
    }

    /// The streams of these pixels in passes with these [keys](PassKey).
    #[inline(always)]
    pub(crate) fn of_pixels(x: B, y: B, salt: B, index: B) -> Stream<B> {
        Stream::again(mix(mix((y << 16) | x) ^ salt), index)
    }

    /// The stream that has this [`Stream::key`] at this point of the sequence.
    #[inline(always)]
    pub(crate) fn again(key: B, index: B) -> Stream<B> {
        Stream { key, index, reversed: index.reverse_bits() >> 16 }
    }

    /// Where a pass takes `count` pairs of a slot's sequence instead of one, up to 8: the stream that
    /// has the `which`th of them, from 0. Together they go through the sequence without a gap.
    #[inline(always)]
    pub(crate) fn one_of(&self, count: u32, which: u32) -> Stream<B> {
        if count == 1 {
            return *self;
        }
        let index = self.index * B::splat(count) + B::splat(which);
        // Beyond the sequence's end a new randomisation begins: all ones where that is so.
        let (round, one) = (index >> 16, B::splat(1));
        let beyond = B::splat(0) - ((round | (round >> 1) | (round >> 2)) & one);
        let key = self.key ^ ((mix(self.key ^ round) ^ self.key) & beyond);
        Stream::again(key, index & B::splat(0xffff))
    }

    /// Which point of the sequence it is at.
    #[inline(always)]
    pub(crate) fn index(&self) -> B {
        self.index
    }

    /// What tells it from other pixels' streams in its pass.
    #[inline(always)]
    pub(crate) fn key(&self) -> B {
        self.key
    }

    /// The pair of a slot as 32-bit integers: uniform fixed-point numbers in [0, 1).
    #[inline(always)]
    pub fn pair_bits(&self, slot: Slot) -> [B; 2] {
        // Three seeds from one hash: products with odd numbers differ in all high bits, which is
        // what the scrambling reads most.
        let a = mix(self.key + B::splat(slot.0.wrapping_mul(0x9e37_79b9)));
        let b = (a ^ (a >> 16)) * B::splat(0x2c1b_3c6d);
        let c = (b ^ (b >> 15)) * B::splat(0x297a_2d39);
        // Shuffling the index within 16 bits: low bits of the scrambled number depend on low bits
        // only, so the rest may be cut off.
        let index = (scramble_reversed(self.reversed, a) & B::splat(0xffff)).reverse_bits() >> 16;
        // Dimension 0 is the reversed index itself; both are scrambled while still reversed.
        [
            scramble_reversed(index, b).reverse_bits(),
            scramble_reversed(sobol_1_reversed(index), c).reverse_bits(),
        ]
    }
}

#[inline(always)]
fn mix_u32(x: u32) -> u32 {
    mix(super::simd::U32(x)).0
}

/// A 32-bit fixed-point number as a float in [0, 1 - 2^-24].
#[inline(always)]
pub fn unit<L: Simd>(x: L::Bits) -> L {
    L::from_small(x >> 8) * L::splat(1.0 / 16_777_216.0)
}

/// The pair of a slot as floats in [0, 1 - 2^-24].
#[inline(always)]
pub fn pair<L: Simd>(stream: &Stream<L::Bits>, slot: Slot) -> [L; 2] {
    // Not by `map`: what the compiler does not inline there is not compiled for the instruction set.
    let [a, b] = stream.pair_bits(slot);
    [unit::<L>(a), unit::<L>(b)]
}

#[cfg(test)]
mod tests {
    use super::super::simd::U32;
    use super::*;

    fn bits(seed: u64, x: u32, y: u32, pass: u64, slot: Slot) -> [u32; 2] {
        Stream::new(seed, U32(x), U32(y), pass).pair_bits(slot).map(|b| b.0)
    }

    /// Index bits of one replicate's first 2^k passes fill every elementary interval once.
    #[test]
    fn every_power_of_two_of_passes_is_a_net() {
        for (seed, x, y, slot) in [(0, 0, 0, Slot::CAMERA), (7, 319, 41, Slot::direction(3))] {
            for k in 0..=10u32 {
                for (replicate, start) in [(0u64, 0u64), (3, 1 << k), (1, 65536)] {
                    let points: Vec<_> = (start..start + (1 << k))
                        .map(|i| bits(seed, x, y, i * REPLICATES as u64 + replicate, slot))
                        .collect();
                    for split in 0..=k {
                        let mut cells = vec![0; 1 << k];
                        for p in &points {
                            let high = |v: u32, n: u32| (v as u64 >> (32 - n)) as usize;
                            cells[high(p[0], split) << (k - split) | high(p[1], k - split)] += 1;
                        }
                        assert!(cells.iter().all(|&c| c == 1), "k {k} split {split}");
                    }
                }
            }
        }
    }

    /// Pairs of different slots, pixels, replicates and seeds are uncorrelated: the correlation of
    /// n pairs has standard deviation 1/sqrt(n); 4.5 sigma over some thirty checks.
    #[test]
    fn streams_are_independent_of_each_other() {
        let n = 40_000u32;
        let value = |b: u32| b as f64 / 4_294_967_296.0 - 0.5;
        let pixel = |i: u32| (i % 200, i / 200);
        let check = |name: &str, a: &dyn Fn(u32) -> f64, b: &dyn Fn(u32) -> f64| {
            let r = (0..n).map(|i| a(i) * b(i)).sum::<f64>() * 12.0 / n as f64;
            assert!(r.abs() < 4.5 / (n as f64).sqrt(), "{name}: correlation {r}");
        };
        let draw = |seed, pass, slot: Slot, d: usize| {
            move |i: u32| {
                let (x, y) = pixel(i);
                value(bits(seed, x, y, pass, slot)[d])
            }
        };
        for (s, t) in [(Slot::CAMERA, Slot::light(0)), (Slot::direction(0), Slot::direction(1))] {
            for (d, e) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                check("slots", &draw(1, 0, s, d), &draw(1, 0, t, e));
            }
        }
        check("dimensions", &draw(1, 0, Slot::CAMERA, 0), &draw(1, 0, Slot::CAMERA, 1));
        check("replicates", &draw(1, 0, Slot::CAMERA, 0), &draw(1, 1, Slot::CAMERA, 0));
        check("seeds", &draw(1, 0, Slot::CAMERA, 0), &draw(2, 0, Slot::CAMERA, 0));
        check("blocks", &draw(1, 0, Slot::CAMERA, 0), &draw(1, 65536 * 4, Slot::CAMERA, 0));
        let shifted = |i: u32| {
            let (x, y) = pixel(i);
            value(bits(1, x + 1, y, 0, Slot::CAMERA)[0])
        };
        check("neighbours", &draw(1, 0, Slot::CAMERA, 0), &shifted);
    }

    /// The numbers themselves are part of the format of a recipe: they may never change.
    #[test]
    fn the_stream_is_frozen() {
        let a = bits(0, 0, 0, 0, Slot::CAMERA);
        let b = bits(1 << 40, 1599, 1199, 4_294_967_295, Slot::roulette(9));
        assert_eq!([a, b], FROZEN);
    }
    const FROZEN: [[u32; 2]; 2] = [[562_286_061, 3_286_860_163], [796_627_085, 1_222_405_181]];

    #[test]
    fn floats_stay_below_one() {
        assert_eq!(unit::<f32>(U32(u32::MAX)), 1.0 - f32::EPSILON / 2.0);
        assert_eq!(unit::<f32>(U32(0)), 0.0);
    }
}
