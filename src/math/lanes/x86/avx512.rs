//! Sixteen values in an AVX-512 register.
//!
//! Soundness: as for AVX2, but under [`run_avx512`](super::run_avx512) alone, which asks the machine
//! for F, DQ, BW, VL and GFNI.
#![allow(unsafe_code)]

use super::super::{Bits, Lane, Mask, Packet};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(__m512);
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512Bits(__m512i);
/// Lane `i` in bit `i`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512Mask(__mmask16);

macro_rules! binary {
    ($type:ident: $($op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl $op for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                // SAFETY: a value of this type exists only under AVX-512 (module docs).
                $type(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
binary! { Avx512:
    Add add _mm512_add_ps;
    Sub sub _mm512_sub_ps;
    Mul mul _mm512_mul_ps;
    Div div _mm512_div_ps;
}
binary! { Avx512Bits:
    Add add _mm512_add_epi32;
    Sub sub _mm512_sub_epi32;
    Mul mul _mm512_mullo_epi32;
    BitAnd bitand _mm512_and_si512;
    BitOr bitor _mm512_or_si512;
    BitXor bitxor _mm512_xor_si512;
}

impl Neg for Avx512 {
    type Output = Avx512;
    #[inline(always)]
    fn neg(self) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}
impl Shl<u32> for Avx512Bits {
    type Output = Avx512Bits;
    #[inline(always)]
    fn shl(self, by: u32) -> Avx512Bits {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Shr<u32> for Avx512Bits {
    type Output = Avx512Bits;
    #[inline(always)]
    fn shr(self, by: u32) -> Avx512Bits {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Bits for Avx512Bits {
    #[inline(always)]
    fn splat(x: u32) -> Avx512Bits {
        // SAFETY: reached only as a lane type of a kernel under `run_avx512`.
        Avx512Bits(unsafe { _mm512_set1_epi32(x as i32) })
    }
    #[inline(always)]
    fn reverse_bits(self) -> Avx512Bits {
        // SAFETY: a value of this type exists only under AVX-512 with BW and GFNI (module docs).
        Avx512Bits(unsafe {
            // The bits within each byte by an anti-diagonal matrix, then the bytes of each word.
            let within = _mm512_set1_epi64(0x8040_2010_0804_0201_u64 as i64);
            let bytes = _mm512_gf2p8affine_epi64_epi8::<0>(self.0, within);
            let order = _mm512_broadcast_i32x4(_mm_setr_epi8(
                3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12,
            ));
            _mm512_shuffle_epi8(bytes, order)
        })
    }
}

impl BitAnd for Avx512Mask {
    type Output = Avx512Mask;
    #[inline(always)]
    fn bitand(self, other: Avx512Mask) -> Avx512Mask {
        Avx512Mask(self.0 & other.0)
    }
}
impl BitOr for Avx512Mask {
    type Output = Avx512Mask;
    #[inline(always)]
    fn bitor(self, other: Avx512Mask) -> Avx512Mask {
        Avx512Mask(self.0 | other.0)
    }
}
impl Not for Avx512Mask {
    type Output = Avx512Mask;
    #[inline(always)]
    fn not(self) -> Avx512Mask {
        Avx512Mask(!self.0)
    }
}
impl Mask for Avx512Mask {
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == 0xffff
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

macro_rules! compare {
    ($($method:ident $predicate:ident;)*) => {$(
        #[inline(always)]
        fn $method(self, other: Avx512) -> Avx512Mask {
            // SAFETY: a value of this type exists only under AVX-512 (module docs).
            Avx512Mask(unsafe { _mm512_cmp_ps_mask::<$predicate>(self.0, other.0) })
        }
    )*};
}

impl Lane for Avx512 {
    const WIDTH: usize = 16;
    type Mask = Avx512Mask;
    type Bits = Avx512Bits;

    #[inline(always)]
    fn splat(x: f32) -> Avx512 {
        // SAFETY: reached only as a lane type of a kernel under `run_avx512`.
        Avx512(unsafe { _mm512_set1_ps(x) })
    }
    #[inline(always)]
    fn min(self, other: Avx512) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Avx512) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Avx512, c: Avx512) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_fmadd_ps(self.0, b.0, c.0) })
    }
    compare! {
        lt _CMP_LT_OQ;
        le _CMP_LE_OQ;
        equal _CMP_EQ_OQ;
    }
    #[inline(always)]
    fn select(mask: Avx512Mask, a: Avx512, b: Avx512) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_mask_blend_ps(mask.0, b.0, a.0) })
    }
    #[inline(always)]
    fn to_bits(self) -> Avx512Bits {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_castps_si512(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: Avx512Bits) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_castsi512_ps(bits.0) })
    }
    #[inline(always)]
    fn from_small(bits: Avx512Bits) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_cvtepi32_ps(bits.0) })
    }
}

impl Packet for Avx512 {
    #[inline(always)]
    fn load(x: &[f32]) -> Avx512 {
        let x = &x[..16];
        // SAFETY: the slice holds sixteen readable floats; the load needs no alignment; reached
        // only under `run_avx512`.
        Avx512(unsafe { _mm512_loadu_ps(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, x: &mut [f32]) {
        let x = &mut x[..16];
        // SAFETY: the slice holds sixteen floats; the store needs no alignment; a value of this
        // type exists only under AVX-512 (module docs).
        unsafe { _mm512_storeu_ps(x.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn load_bits(x: &[u32]) -> Avx512Bits {
        let x = &x[..16];
        // SAFETY: the slice holds sixteen readable words; the load needs no alignment; reached only
        // under `run_avx512`.
        Avx512Bits(unsafe { _mm512_loadu_si512(x.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store_bits(bits: Avx512Bits, x: &mut [u32]) {
        let x = &mut x[..16];
        // SAFETY: the slice holds sixteen words; the store needs no alignment; a value of this type
        // exists only under AVX-512 (module docs).
        unsafe { _mm512_storeu_si512(x.as_mut_ptr().cast(), bits.0) }
    }
    #[inline(always)]
    fn mask(bits: u32) -> Avx512Mask {
        Avx512Mask(bits as u16)
    }
    #[inline(always)]
    fn select_bits(mask: Avx512Mask, a: Avx512Bits, b: Avx512Bits) -> Avx512Bits {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_mask_blend_epi32(mask.0, b.0, a.0) })
    }
    #[inline(always)]
    fn equal_bits(a: Avx512Bits, b: Avx512Bits) -> Avx512Mask {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Mask(unsafe { _mm512_cmpeq_epi32_mask(a.0, b.0) })
    }
    #[inline(always)]
    fn less_bits(a: Avx512Bits, b: Avx512Bits) -> Avx512Mask {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Mask(unsafe { _mm512_cmplt_epu32_mask(a.0, b.0) })
    }
    // Within the register and then a whole store: a compressing store is slow on Zen 4.
    #[inline(always)]
    fn compress(self, mask: Avx512Mask, x: &mut [f32]) {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_maskz_compress_ps(mask.0, self.0) }).store(x);
    }
    #[inline(always)]
    fn compress_bits(bits: Avx512Bits, mask: Avx512Mask, x: &mut [u32]) {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        let side_by_side = Avx512Bits(unsafe { _mm512_maskz_compress_epi32(mask.0, bits.0) });
        Avx512::store_bits(side_by_side, x);
    }
    #[inline(always)]
    fn recip(self) -> Avx512 {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        let rough = Avx512(unsafe { _mm512_rcp14_ps(self.0) });
        // Newton's step: from 14 bits to all but the last few roundings.
        let off = (-self).mul_add(rough, Avx512::splat(1.0));
        rough.mul_add(off, rough)
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: Avx512Bits) -> Avx512 {
        let table = Avx512::load(table);
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_permutexvar_ps(index.0, table.0) })
    }
}
