//! Four values in an SSE register: what batches of paths are computed with in the portable set of
//! x86-64.
//!
//! Soundness: SSE2 is part of the baseline of x86-64, so that no machine this is compiled for lacks
//! it; `x86` holds a build without it off. Each intrinsic call below leans on that.
#![allow(unsafe_code)]

use super::super::pair::Half;
use super::super::{Bits, Mask, Simd, SimdWide};
use std::arch::x86_64::*;
use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2(__m128);
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2Bits(__m128i);
/// All ones or all zeros in each lane.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sse2Mask(__m128);

macro_rules! binary {
    ($type:ident: $($op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl $op for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                // SAFETY: every x86-64 has SSE2 (module docs).
                $type(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
binary! { Sse2:
    Add add _mm_add_ps;
    Sub sub _mm_sub_ps;
    Mul mul _mm_mul_ps;
    Div div _mm_div_ps;
}
binary! { Sse2Bits:
    Add add _mm_add_epi32;
    Sub sub _mm_sub_epi32;
    BitAnd bitand _mm_and_si128;
    BitOr bitor _mm_or_si128;
    BitXor bitxor _mm_xor_si128;
}
binary! { Sse2Mask:
    BitAnd bitand _mm_and_ps;
    BitOr bitor _mm_or_ps;
}

impl Neg for Sse2 {
    type Output = Sse2;
    #[inline(always)]
    fn neg(self) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_xor_ps(self.0, _mm_set1_ps(-0.0)) })
    }
}
impl Mul for Sse2Bits {
    type Output = Sse2Bits;
    // SSE2 multiplies every second word only, into twice the width.
    #[inline(always)]
    fn mul(self, other: Sse2Bits) -> Sse2Bits {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe {
            let even = _mm_mul_epu32(self.0, other.0);
            let odd = _mm_mul_epu32(_mm_srli_epi64::<32>(self.0), _mm_srli_epi64::<32>(other.0));
            let even = _mm_shuffle_epi32::<0b00_00_10_00>(even);
            _mm_unpacklo_epi32(even, _mm_shuffle_epi32::<0b00_00_10_00>(odd))
        })
    }
}
impl Shl<u32> for Sse2Bits {
    type Output = Sse2Bits;
    #[inline(always)]
    fn shl(self, by: u32) -> Sse2Bits {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe { _mm_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Shr<u32> for Sse2Bits {
    type Output = Sse2Bits;
    #[inline(always)]
    fn shr(self, by: u32) -> Sse2Bits {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe { _mm_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Bits for Sse2Bits {
    #[inline(always)]
    fn splat(x: u32) -> Sse2Bits {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe { _mm_set1_epi32(x as i32) })
    }
}
impl Not for Sse2Mask {
    type Output = Sse2Mask;
    #[inline(always)]
    fn not(self) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe { _mm_xor_ps(self.0, _mm_castsi128_ps(_mm_set1_epi32(-1))) })
    }
}
impl Mask for Sse2Mask {
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == 0xf
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        unsafe { _mm_movemask_ps(self.0) as u32 }
    }
}

impl Simd for Sse2 {
    const WIDTH: usize = 4;
    type Mask = Sse2Mask;
    type Bits = Sse2Bits;

    #[inline(always)]
    fn splat(x: f32) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_set1_ps(x) })
    }
    #[inline(always)]
    fn min(self, other: Sse2) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Sse2) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_sqrt_ps(self.0) })
    }
    // Rounded twice, as in all portable code.
    #[inline(always)]
    fn mul_add(self, b: Sse2, c: Sse2) -> Sse2 {
        self * b + c
    }
    #[inline(always)]
    fn lt(self, other: Sse2) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe { _mm_cmplt_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Sse2) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe { _mm_cmple_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn equal(self, other: Sse2) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe { _mm_cmpeq_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn select(mask: Sse2Mask, a: Sse2, b: Sse2) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_or_ps(_mm_and_ps(mask.0, a.0), _mm_andnot_ps(mask.0, b.0)) })
    }
    #[inline(always)]
    fn to_bits(self) -> Sse2Bits {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe { _mm_castps_si128(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: Sse2Bits) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_castsi128_ps(bits.0) })
    }
    #[inline(always)]
    fn from_small(bits: Sse2Bits) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_cvtepi32_ps(bits.0) })
    }
    #[inline(always)]
    fn or_zero(self, mask: Sse2Mask) -> Sse2 {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2(unsafe { _mm_and_ps(mask.0, self.0) })
    }
}

impl SimdWide for Sse2 {
    #[inline(always)]
    fn load(x: &[f32]) -> Sse2 {
        let x = &x[..4];
        // SAFETY: the slice holds four readable floats; the load needs no alignment.
        Sse2(unsafe { _mm_loadu_ps(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, x: &mut [f32]) {
        let x = &mut x[..4];
        // SAFETY: the slice holds four floats; the store needs no alignment.
        unsafe { _mm_storeu_ps(x.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn load_bits(x: &[u32]) -> Sse2Bits {
        let x = &x[..4];
        // SAFETY: the slice holds four readable words; the load needs no alignment.
        Sse2Bits(unsafe { _mm_loadu_si128(x.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store_bits(bits: Sse2Bits, x: &mut [u32]) {
        let x = &mut x[..4];
        // SAFETY: the slice holds four words; the store needs no alignment.
        unsafe { _mm_storeu_si128(x.as_mut_ptr().cast(), bits.0) }
    }
    #[inline(always)]
    fn mask(bits: u32) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe {
            let each = _mm_setr_epi32(1, 2, 4, 8);
            let set = _mm_and_si128(_mm_set1_epi32(bits as i32), each);
            _mm_castsi128_ps(_mm_cmpeq_epi32(set, each))
        })
    }
    #[inline(always)]
    fn select_bits(mask: Sse2Mask, a: Sse2Bits, b: Sse2Bits) -> Sse2Bits {
        Self::select(mask, Self::from_bits(a), Self::from_bits(b)).to_bits()
    }
    #[inline(always)]
    fn equal_bits(a: Sse2Bits, b: Sse2Bits) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe { _mm_castsi128_ps(_mm_cmpeq_epi32(a.0, b.0)) })
    }
    #[inline(always)]
    fn less_bits(a: Sse2Bits, b: Sse2Bits) -> Sse2Mask {
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Mask(unsafe {
            // Signed is all there is: both shifted by half the range.
            let half = _mm_set1_epi32(i32::MIN);
            let (a, b) = (_mm_xor_si128(a.0, half), _mm_xor_si128(b.0, half));
            _mm_castsi128_ps(_mm_cmplt_epi32(a, b))
        })
    }
    #[inline(always)]
    fn compress(self, mask: Sse2Mask, x: &mut [f32]) {
        let mut all = [0.0; 4];
        self.store(&mut all);
        side_by_side(all, mask, x);
    }
    #[inline(always)]
    fn compress_bits(bits: Sse2Bits, mask: Sse2Mask, x: &mut [u32]) {
        let mut all = [0; 4];
        Sse2::store_bits(bits, &mut all);
        side_by_side(all, mask, x);
    }
    // The estimate of SSE differs between makers of processors, and pictures would with it.
    #[inline(always)]
    fn recip(self) -> Sse2 {
        Sse2::splat(1.0) / self
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: Sse2Bits) -> Sse2 {
        let mut at = [0; 4];
        Sse2::store_bits(index, &mut at);
        let found: [f32; 4] = from_fn(|lane| table[at[lane] as usize % 16]);
        Sse2::load(&found)
    }
}

impl Half for Sse2 {
    #[inline(always)]
    fn each(bits: Sse2Bits) -> [Sse2Bits; 4] {
        // SAFETY: every x86-64 has SSE2 (module docs).
        unsafe {
            [
                Sse2Bits(_mm_shuffle_epi32::<0b00_00_00_00>(bits.0)),
                Sse2Bits(_mm_shuffle_epi32::<0b01_01_01_01>(bits.0)),
                Sse2Bits(_mm_shuffle_epi32::<0b10_10_10_10>(bits.0)),
                Sse2Bits(_mm_shuffle_epi32::<0b11_11_11_11>(bits.0)),
            ]
        }
    }
    #[inline(always)]
    fn count_less(total: Sse2Bits, a: Sse2Bits, b: Sse2Bits) -> Sse2Bits {
        // All ones is -1.
        // SAFETY: every x86-64 has SSE2 (module docs).
        Sse2Bits(unsafe { _mm_sub_epi32(total.0, _mm_cmplt_epi32(a.0, b.0)) })
    }
    #[inline(always)]
    fn prefetch_line(address: *const u8) {
        // SAFETY: a prefetch reads nothing that the program could see and never faults.
        unsafe { _mm_prefetch::<_MM_HINT_T1>(address.cast()) };
    }
}

/// Without branches: each goes to where the next one kept belongs, and is written over if it was not
/// to be kept. SSE2 has no shuffle by an index.
#[inline(always)]
fn side_by_side<T: Copy>(all: [T; 4], mask: Sse2Mask, out: &mut [T]) {
    let (out, bits) = (&mut out[..4], mask.bits() as usize);
    let mut place = 0;
    for (lane, x) in all.into_iter().enumerate() {
        out[place & 3] = x;
        place += bits >> lane & 1;
    }
}
