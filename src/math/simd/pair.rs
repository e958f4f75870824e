//! Eight values in two registers of four: one ray against eight boxes or triangles where registers hold
//! no more. All is done to both halves.

use super::{Bits, Mask, Simd, Simd8, SimdWide};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct SimdPair<H>(H, H);
#[derive(Clone, Copy, Debug)]
pub(super) struct PairBits<B>(B, B);
#[derive(Clone, Copy, Debug)]
pub(super) struct PairMask<M>(M, M);

/// A packet of four values, with what a pair of them needs besides.
pub(super) trait Half: SimdWide {
    /// Each of the four words by itself, in all lanes.
    fn each(bits: Self::Bits) -> [Self::Bits; 4];
    /// `total`, and one more in those lanes where `a` is less than `b`. None has the uppermost bit.
    fn count_less(total: Self::Bits, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// Asks for a line of memory as far as the second cache; any address will do.
    fn prefetch_line(address: *const u8);
}

macro_rules! both {
    ($type:ident of $half:ident: $($op:ident $method:ident;)*) => {$(
        impl<H: $half> $op for $type<H> {
            type Output = $type<H>;
            #[inline(always)]
            fn $method(self, other: $type<H>) -> $type<H> {
                $type(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}
both! { SimdPair of Simd: Add add; Sub sub; Mul mul; Div div; }
both! { PairBits of Bits: Add add; Sub sub; Mul mul; BitAnd bitand; BitOr bitor; BitXor bitxor; }
both! { PairMask of Mask: BitAnd bitand; BitOr bitor; }

impl<H: Simd> Neg for SimdPair<H> {
    type Output = SimdPair<H>;
    #[inline(always)]
    fn neg(self) -> SimdPair<H> {
        SimdPair(-self.0, -self.1)
    }
}
impl<B: Bits> Shl<u32> for PairBits<B> {
    type Output = PairBits<B>;
    #[inline(always)]
    fn shl(self, by: u32) -> PairBits<B> {
        PairBits(self.0 << by, self.1 << by)
    }
}
impl<B: Bits> Shr<u32> for PairBits<B> {
    type Output = PairBits<B>;
    #[inline(always)]
    fn shr(self, by: u32) -> PairBits<B> {
        PairBits(self.0 >> by, self.1 >> by)
    }
}
impl<B: Bits> Bits for PairBits<B> {
    #[inline(always)]
    fn splat(x: u32) -> PairBits<B> {
        PairBits(Bits::splat(x), Bits::splat(x))
    }
    #[inline(always)]
    fn reverse_bits(self) -> PairBits<B> {
        PairBits(self.0.reverse_bits(), self.1.reverse_bits())
    }
}
impl<M: Mask> Not for PairMask<M> {
    type Output = PairMask<M>;
    #[inline(always)]
    fn not(self) -> PairMask<M> {
        PairMask(!self.0, !self.1)
    }
}
impl<M: Mask> Mask for PairMask<M> {
    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        (self.0 & self.1).all()
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << 4
    }
}

impl<H: Half> Simd for SimdPair<H> {
    const WIDTH: usize = 8;
    type Mask = PairMask<H::Mask>;
    type Bits = PairBits<H::Bits>;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        SimdPair(H::splat(x), H::splat(x))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        SimdPair(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        SimdPair(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdPair(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdPair(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        SimdPair(self.0.mul_add(b.0, c.0), self.1.mul_add(b.1, c.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        PairMask(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        PairMask(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Self::Mask {
        PairMask(self.0.equal(other.0), self.1.equal(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        SimdPair(H::select(mask.0, a.0, b.0), H::select(mask.1, a.1, b.1))
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Bits {
        PairBits(self.0.to_bits(), self.1.to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: Self::Bits) -> Self {
        SimdPair(H::from_bits(bits.0), H::from_bits(bits.1))
    }
    #[inline(always)]
    fn from_small(bits: Self::Bits) -> Self {
        SimdPair(H::from_small(bits.0), H::from_small(bits.1))
    }
    #[inline(always)]
    fn or_zero(self, mask: Self::Mask) -> Self {
        SimdPair(self.0.or_zero(mask.0), self.1.or_zero(mask.1))
    }
}

impl<H: Half> Simd8 for SimdPair<H> {
    const INTERLEAVED: bool = true;
    #[inline(always)]
    fn load(x: &[f32; 8]) -> Self {
        SimdPair(H::load(&x[..4]), H::load(&x[4..]))
    }
    #[inline(always)]
    fn store(self) -> [f32; 8] {
        let mut x = [0.0; 8];
        self.0.store(&mut x[..4]);
        self.1.store(&mut x[4..]);
        x
    }
    #[inline(always)]
    fn sort_far_to_near(
        self,
        mask: Self::Mask,
        words: &[u32; 8],
        numbers_out: &mut [f32; 8],
        words_out: &mut [u32; 8],
    ) -> usize {
        let lanes = [8, 9, 10, 11, 12, 13, 14, 15];
        let marked = |half: H, mask, lanes: &[u32]| {
            let number = half.to_bits() & Bits::splat(!15) | H::load_bits(lanes);
            // What the mask leaves out is 0 and comes last.
            H::from_bits(number).or_zero(mask)
        };
        let numbers =
            SimdPair(marked(self.0, mask.0, &lanes[..4]), marked(self.1, mask.1, &lanes[4..]));
        // The place of each is how many are larger: no two are the same, but for zeros.
        let places = numbers.count_larger();
        let numbers = numbers.store();
        for lane in 0..8 {
            let place = places[lane] as usize & 7;
            numbers_out[place] = numbers[lane];
            words_out[place] = words[lane];
        }
        mask.bits().count_ones() as usize
    }
    // Without branches: each goes to where the next one kept belongs, and is written over if it was
    // not to be kept.
    #[inline(always)]
    fn pick(mask: Self::Mask, words: &[u32; 8], out: &mut [u32; 8]) -> usize {
        let (bits, mut place) = (mask.bits() as usize, 0);
        for (lane, word) in words.iter().enumerate() {
            out[place & 7] = *word;
            place += bits >> lane & 1;
        }
        place
    }
    #[inline(always)]
    fn prefetch<T>(thing: &T) {
        let start: *const T = thing;
        for line in 0..size_of::<T>().div_ceil(64) {
            H::prefetch_line(start.cast::<u8>().wrapping_add(64 * line));
        }
    }
}

impl<H: Half> SimdPair<H> {
    /// For each lane the number of lanes whose bits are larger; none has the sign.
    #[inline(always)]
    fn count_larger(self) -> [u32; 8] {
        let (low, high) = (self.0.to_bits(), self.1.to_bits());
        let mut places = [H::Bits::splat(0); 2];
        for half in [low, high] {
            for one in H::each(half) {
                places[0] = H::count_less(places[0], low, one);
                places[1] = H::count_less(places[1], high, one);
            }
        }
        let mut out = [0; 8];
        H::store_bits(places[0], &mut out[..4]);
        H::store_bits(places[1], &mut out[4..]);
        out
    }
}
