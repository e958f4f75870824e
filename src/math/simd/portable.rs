//! Eight values in plain arrays: runs on every target, and is the oracle of the intrinsic twins.

use super::{Bits, Mask, Simd, Simd8};
use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct F32x8([f32; 8]);

/// Eight `u32`.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct U32x8([u32; 8]);

/// Eight truth values, lane `i` in bit `i`.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(u8);

macro_rules! elementwise {
    ($type:ident: $($op:ident $method:ident $f:expr;)*) => {$(
        impl $op for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                $type(from_fn(|i| $f(self.0[i], other.0[i])))
            }
        }
    )*};
}
elementwise! { F32x8:
    Add add |a: f32, b: f32| a + b;
    Sub sub |a: f32, b: f32| a - b;
    Mul mul |a: f32, b: f32| a * b;
    Div div |a: f32, b: f32| a / b;
}
elementwise! { U32x8:
    Add add u32::wrapping_add;
    Sub sub u32::wrapping_sub;
    Mul mul u32::wrapping_mul;
    BitAnd bitand |a: u32, b: u32| a & b;
    BitOr bitor |a: u32, b: u32| a | b;
    BitXor bitxor |a: u32, b: u32| a ^ b;
}

impl Neg for F32x8 {
    type Output = F32x8;
    #[inline(always)]
    fn neg(self) -> F32x8 {
        F32x8(self.0.map(|a| -a))
    }
}
impl Shl<u32> for U32x8 {
    type Output = U32x8;
    #[inline(always)]
    fn shl(self, by: u32) -> U32x8 {
        U32x8(self.0.map(|a| a << by))
    }
}
impl Shr<u32> for U32x8 {
    type Output = U32x8;
    #[inline(always)]
    fn shr(self, by: u32) -> U32x8 {
        U32x8(self.0.map(|a| a >> by))
    }
}
impl Bits for U32x8 {
    #[inline(always)]
    fn splat(x: u32) -> U32x8 {
        U32x8([x; 8])
    }
}

impl BitAnd for Mask8 {
    type Output = Mask8;
    #[inline(always)]
    fn bitand(self, other: Mask8) -> Mask8 {
        Mask8(self.0 & other.0)
    }
}
impl BitOr for Mask8 {
    type Output = Mask8;
    #[inline(always)]
    fn bitor(self, other: Mask8) -> Mask8 {
        Mask8(self.0 | other.0)
    }
}
impl Not for Mask8 {
    type Output = Mask8;
    #[inline(always)]
    fn not(self) -> Mask8 {
        Mask8(!self.0)
    }
}
impl Mask for Mask8 {
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == 0xff
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0 as u32
    }
}

#[inline(always)]
fn compare(a: [f32; 8], b: [f32; 8], f: impl Fn(f32, f32) -> bool) -> Mask8 {
    let mut bits = 0u8;
    for i in 0..8 {
        bits |= (f(a[i], b[i]) as u8) << i;
    }
    Mask8(bits)
}

impl Simd for F32x8 {
    const WIDTH: usize = 8;
    type Mask = Mask8;
    type Bits = U32x8;

    #[inline(always)]
    fn splat(x: f32) -> F32x8 {
        F32x8([x; 8])
    }
    #[inline(always)]
    fn min(self, other: F32x8) -> F32x8 {
        F32x8(from_fn(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn max(self, other: F32x8) -> F32x8 {
        F32x8(from_fn(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn abs(self) -> F32x8 {
        F32x8(self.0.map(f32::abs))
    }
    #[inline(always)]
    fn sqrt(self) -> F32x8 {
        F32x8(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn mul_add(self, b: F32x8, c: F32x8) -> F32x8 {
        self * b + c
    }
    #[inline(always)]
    fn lt(self, other: F32x8) -> Mask8 {
        compare(self.0, other.0, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: F32x8) -> Mask8 {
        compare(self.0, other.0, |a, b| a <= b)
    }
    #[inline(always)]
    fn equal(self, other: F32x8) -> Mask8 {
        compare(self.0, other.0, |a, b| a == b)
    }
    #[inline(always)]
    fn select(mask: Mask8, a: F32x8, b: F32x8) -> F32x8 {
        F32x8(from_fn(|i| if mask.0 >> i & 1 != 0 { a.0[i] } else { b.0[i] }))
    }
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        U32x8(self.0.map(f32::to_bits))
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> F32x8 {
        F32x8(bits.0.map(f32::from_bits))
    }
    #[inline(always)]
    fn from_small(bits: U32x8) -> F32x8 {
        F32x8(bits.0.map(|x| x as f32))
    }
}

impl Simd8 for F32x8 {
    const INTERLEAVED: bool = false;
    #[inline(always)]
    fn load(x: &[f32; 8]) -> F32x8 {
        F32x8(*x)
    }
    #[inline(always)]
    fn store(self) -> [f32; 8] {
        self.0
    }
    #[inline(always)]
    fn sort_far_to_near(
        self,
        mask: Mask8,
        words: &[u32; 8],
        numbers_out: &mut [f32; 8],
        words_out: &mut [u32; 8],
    ) -> usize {
        let mut count = 0;
        for lane in (0..8).filter(|lane| mask.0 >> lane & 1 != 0) {
            // Compared as bits: with the lane's in it, infinity is no number.
            let number = f32::from_bits(self.0[lane].to_bits() & !15 | lane as u32);
            let mut place = count;
            while place > 0 && numbers_out[place - 1].to_bits() < number.to_bits() {
                numbers_out[place] = numbers_out[place - 1];
                words_out[place] = words_out[place - 1];
                place -= 1;
            }
            numbers_out[place] = number;
            words_out[place] = words[lane];
            count += 1;
        }
        count
    }
    #[inline(always)]
    fn pick(mask: Mask8, words: &[u32; 8], out: &mut [u32; 8]) -> usize {
        let lanes = (0..8).filter(|lane| mask.0 >> lane & 1 != 0);
        out.iter_mut().zip(lanes).map(|(out, lane)| *out = words[lane]).count()
    }
    #[inline(always)]
    fn prefetch<T>(_: &T) {}
}
