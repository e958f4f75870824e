//! One value: `f32` itself.

use super::{Bits, Mask, Simd, SimdWide};
use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Shl, Shr, Sub};

impl Simd for f32 {
    const WIDTH: usize = 1;
    type Mask = bool;
    type Bits = U32;

    #[inline(always)]
    fn splat(x: f32) -> f32 {
        x
    }
    #[inline(always)]
    fn min(self, other: f32) -> f32 {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: f32) -> f32 {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn abs(self) -> f32 {
        f32::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> f32 {
        f32::sqrt(self)
    }
    // A plain build has no fused instruction: f32::mul_add would call a library function.
    #[inline(always)]
    fn mul_add(self, b: f32, c: f32) -> f32 {
        self * b + c
    }
    #[inline(always)]
    fn lt(self, other: f32) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: f32) -> bool {
        self <= other
    }
    #[inline(always)]
    fn equal(self, other: f32) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, a: f32, b: f32) -> f32 {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Bits {
        U32(f32::to_bits(self))
    }
    #[inline(always)]
    fn from_bits(bits: Self::Bits) -> f32 {
        f32::from_bits(bits.0)
    }
    #[inline(always)]
    fn from_small(bits: Self::Bits) -> f32 {
        bits.0 as f32
    }
}

/// The bundle of plain Rust is one value at a time: what a compiler makes of arrays in code as long as
/// the tracer's is no faster, and takes it minutes.
impl SimdWide for f32 {
    #[inline(always)]
    fn load(x: &[f32]) -> f32 {
        x[0]
    }
    #[inline(always)]
    fn store(self, x: &mut [f32]) {
        x[0] = self;
    }
    #[inline(always)]
    fn load_bits(x: &[u32]) -> U32 {
        U32(x[0])
    }
    #[inline(always)]
    fn store_bits(bits: U32, x: &mut [u32]) {
        x[0] = bits.0;
    }
    #[inline(always)]
    fn mask(bits: u32) -> bool {
        bits & 1 != 0
    }
    #[inline(always)]
    fn select_bits(mask: bool, a: U32, b: U32) -> U32 {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn equal_bits(a: U32, b: U32) -> bool {
        a == b
    }
    #[inline(always)]
    fn less_bits(a: U32, b: U32) -> bool {
        a.0 < b.0
    }
    #[inline(always)]
    fn compress(self, _: bool, x: &mut [f32]) {
        x[0] = self;
    }
    #[inline(always)]
    fn compress_bits(bits: U32, _: bool, x: &mut [u32]) {
        x[0] = bits.0;
    }
    #[inline(always)]
    fn recip(self) -> f32 {
        1.0 / self
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: U32) -> f32 {
        table[index.0 as usize % 16]
    }
}

impl Mask for bool {
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self as u32
    }
}

/// One `u32` with wrapping arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct U32(pub u32);

impl Bits for U32 {
    #[inline(always)]
    fn splat(x: u32) -> U32 {
        U32(x)
    }
    #[inline(always)]
    fn reverse_bits(self) -> U32 {
        U32(self.0.reverse_bits())
    }
}

macro_rules! wrapping {
    ($($op:ident $method:ident $rhs:ty: $f:expr;)*) => {$(
        impl $op<$rhs> for U32 {
            type Output = U32;
            #[inline(always)]
            fn $method(self, other: $rhs) -> U32 {
                let f: fn(u32, u32) -> u32 = $f;
                U32(f(self.0, other.into()))
            }
        }
    )*};
}
wrapping! {
    Add add U32: u32::wrapping_add;
    Sub sub U32: u32::wrapping_sub;
    Mul mul U32: u32::wrapping_mul;
    BitAnd bitand U32: |a, b| a & b;
    BitOr bitor U32: |a, b| a | b;
    BitXor bitxor U32: |a, b| a ^ b;
    Shl shl u32: u32::wrapping_shl;
    Shr shr u32: u32::wrapping_shr;
}

impl From<U32> for u32 {
    #[inline(always)]
    fn from(x: U32) -> u32 {
        x.0
    }
}
