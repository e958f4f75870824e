//! Eight values in two SSE registers: one ray against eight boxes or triangles in the portable set
//! of x86-64. Each half is an [`Sse2`], and all is done to both.
#![allow(unsafe_code)]

use super::super::{Bits, Lane, Mask, Packet, Wide};
use super::sse2::{Sse2, Sse2Bits, Sse2Mask};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2x8(Sse2, Sse2);
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2Bits8(Sse2Bits, Sse2Bits);
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2Mask8(Sse2Mask, Sse2Mask);

macro_rules! both {
    ($type:ident: $($op:ident $method:ident;)*) => {$(
        impl $op for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                $type(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}
both! { Sse2x8: Add add; Sub sub; Mul mul; Div div; }
both! { Sse2Bits8: Add add; Sub sub; Mul mul; BitAnd bitand; BitOr bitor; BitXor bitxor; }
both! { Sse2Mask8: BitAnd bitand; BitOr bitor; }

impl Neg for Sse2x8 {
    type Output = Sse2x8;
    #[inline(always)]
    fn neg(self) -> Sse2x8 {
        Sse2x8(-self.0, -self.1)
    }
}
impl Shl<u32> for Sse2Bits8 {
    type Output = Sse2Bits8;
    #[inline(always)]
    fn shl(self, by: u32) -> Sse2Bits8 {
        Sse2Bits8(self.0 << by, self.1 << by)
    }
}
impl Shr<u32> for Sse2Bits8 {
    type Output = Sse2Bits8;
    #[inline(always)]
    fn shr(self, by: u32) -> Sse2Bits8 {
        Sse2Bits8(self.0 >> by, self.1 >> by)
    }
}
impl Bits for Sse2Bits8 {
    #[inline(always)]
    fn splat(x: u32) -> Sse2Bits8 {
        Sse2Bits8(Bits::splat(x), Bits::splat(x))
    }
}
impl Not for Sse2Mask8 {
    type Output = Sse2Mask8;
    #[inline(always)]
    fn not(self) -> Sse2Mask8 {
        Sse2Mask8(!self.0, !self.1)
    }
}
impl Mask for Sse2Mask8 {
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

impl Lane for Sse2x8 {
    const WIDTH: usize = 8;
    type Mask = Sse2Mask8;
    type Bits = Sse2Bits8;

    #[inline(always)]
    fn splat(x: f32) -> Sse2x8 {
        Sse2x8(Sse2::splat(x), Sse2::splat(x))
    }
    #[inline(always)]
    fn min(self, other: Sse2x8) -> Sse2x8 {
        Sse2x8(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Sse2x8) -> Sse2x8 {
        Sse2x8(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn abs(self) -> Sse2x8 {
        Sse2x8(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Sse2x8 {
        Sse2x8(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn mul_add(self, b: Sse2x8, c: Sse2x8) -> Sse2x8 {
        Sse2x8(self.0.mul_add(b.0, c.0), self.1.mul_add(b.1, c.1))
    }
    #[inline(always)]
    fn lt(self, other: Sse2x8) -> Sse2Mask8 {
        Sse2Mask8(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Sse2x8) -> Sse2Mask8 {
        Sse2Mask8(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn equal(self, other: Sse2x8) -> Sse2Mask8 {
        Sse2Mask8(self.0.equal(other.0), self.1.equal(other.1))
    }
    #[inline(always)]
    fn select(mask: Sse2Mask8, a: Sse2x8, b: Sse2x8) -> Sse2x8 {
        Sse2x8(Sse2::select(mask.0, a.0, b.0), Sse2::select(mask.1, a.1, b.1))
    }
    #[inline(always)]
    fn to_bits(self) -> Sse2Bits8 {
        Sse2Bits8(self.0.to_bits(), self.1.to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: Sse2Bits8) -> Sse2x8 {
        Sse2x8(Sse2::from_bits(bits.0), Sse2::from_bits(bits.1))
    }
    #[inline(always)]
    fn from_small(bits: Sse2Bits8) -> Sse2x8 {
        Sse2x8(Sse2::from_small(bits.0), Sse2::from_small(bits.1))
    }
    #[inline(always)]
    fn or_zero(self, mask: Sse2Mask8) -> Sse2x8 {
        Sse2x8(self.0.or_zero(mask.0), self.1.or_zero(mask.1))
    }
}

impl Wide for Sse2x8 {
    const IN_TURN: bool = true;
    #[inline(always)]
    fn load(x: &[f32; 8]) -> Sse2x8 {
        Sse2x8(Sse2::load(&x[..4]), Sse2::load(&x[4..]))
    }
    #[inline(always)]
    fn store(self) -> [f32; 8] {
        let mut x = [0.0; 8];
        self.0.store(&mut x[..4]);
        self.1.store(&mut x[4..]);
        x
    }
    #[inline(always)]
    fn far_first(
        self,
        mask: Sse2Mask8,
        words: &[u32; 8],
        numbers_out: &mut [f32; 8],
        words_out: &mut [u32; 8],
    ) -> usize {
        let lanes = [8, 9, 10, 11, 12, 13, 14, 15];
        let marked = |half: Sse2, mask, lanes: &[u32]| {
            let number = half.to_bits() & Bits::splat(!15) | Sse2::load_bits(lanes);
            // What the mask leaves out is 0 and comes last.
            Sse2::from_bits(number).or_zero(mask)
        };
        let numbers =
            Sse2x8(marked(self.0, mask.0, &lanes[..4]), marked(self.1, mask.1, &lanes[4..]));
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
    fn pick(mask: Sse2Mask8, words: &[u32; 8], out: &mut [u32; 8]) -> usize {
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
        let start = start.cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(64) {
            // SAFETY: a prefetch reads nothing that the program could see and never faults.
            unsafe { _mm_prefetch::<_MM_HINT_T1>(start.wrapping_add(64 * line)) };
        }
    }
}

impl Sse2x8 {
    /// For each lane the number of lanes whose bits are larger; none has the sign.
    #[inline(always)]
    fn count_larger(self) -> [u32; 8] {
        let (low, high) = (self.0.to_bits(), self.1.to_bits());
        let mut places = [Sse2Bits::splat(0); 2];
        macro_rules! against {
            ($($half:ident $lane:literal;)*) => {$(
                let one = $half.every::<$lane>();
                // All ones is -1.
                places[0] = places[0] - low.below(one);
                places[1] = places[1] - high.below(one);
            )*};
        }
        against! {
            low 0b00_00_00_00; low 0b01_01_01_01; low 0b10_10_10_10; low 0b11_11_11_11;
            high 0b00_00_00_00; high 0b01_01_01_01; high 0b10_10_10_10; high 0b11_11_11_11;
        }
        let mut out = [0; 8];
        Sse2::store_bits(places[0], &mut out[..4]);
        Sse2::store_bits(places[1], &mut out[4..]);
        out
    }
}
