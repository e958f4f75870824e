//! Sixteen values in an AVX-512 register.
//!
//! `GFNI` says whether the machine also has the instructions on bits as a field, of which one is of
//! use here: it turns the bits of every byte around. The types without it do the same by two shuffles
//! of bytes. Nothing else differs.
//!
//! Soundness: as for AVX2, but under [`run_avx512`](super::run_avx512) alone, which asks the machine
//! for F, DQ, BW and VL, or [`run_avx512_gfni`](super::run_avx512_gfni), which asks for GFNI as well
//! and is alone in using the types that have it.
#![allow(unsafe_code)]

use super::super::{Bits, Mask, Simd, SimdWide};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512<const GFNI: bool>(__m512);
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512Bits<const GFNI: bool>(__m512i);
/// Lane `i` in bit `i`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512Mask(__mmask16);

macro_rules! binary {
    ($type:ident: $($op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl<const GFNI: bool> $op for $type<GFNI> {
            type Output = $type<GFNI>;
            #[inline(always)]
            fn $method(self, other: $type<GFNI>) -> $type<GFNI> {
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

impl<const GFNI: bool> Neg for Avx512<GFNI> {
    type Output = Avx512<GFNI>;
    #[inline(always)]
    fn neg(self) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}
impl<const GFNI: bool> Shl<u32> for Avx512Bits<GFNI> {
    type Output = Avx512Bits<GFNI>;
    #[inline(always)]
    fn shl(self, by: u32) -> Avx512Bits<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl<const GFNI: bool> Shr<u32> for Avx512Bits<GFNI> {
    type Output = Avx512Bits<GFNI>;
    #[inline(always)]
    fn shr(self, by: u32) -> Avx512Bits<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl<const GFNI: bool> Bits for Avx512Bits<GFNI> {
    #[inline(always)]
    fn splat(x: u32) -> Avx512Bits<GFNI> {
        // SAFETY: reached only as a SIMD type of a kernel under those two (module docs).
        Avx512Bits(unsafe { _mm512_set1_epi32(x as i32) })
    }
    #[inline(always)]
    fn reverse_bits(self) -> Avx512Bits<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 with BW (module docs).
        Avx512Bits(unsafe {
            // The bytes of each word; within them turns both kinds.
            let order = _mm512_broadcast_i32x4(_mm_setr_epi8(
                3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12,
            ));
            _mm512_shuffle_epi8(self.reverse_within_bytes().0, order)
        })
    }
}
impl<const GFNI: bool> Avx512Bits<GFNI> {
    /// Bit 7 of each byte becomes its bit 0, and so on.
    #[inline(always)]
    fn reverse_within_bytes(self) -> Avx512Bits<GFNI> {
        if GFNI {
            // By an anti-diagonal matrix.
            // SAFETY: a value of this type exists only under AVX-512 with GFNI (module docs).
            return Avx512Bits(unsafe {
                let matrix = _mm512_set1_epi64(0x8040_2010_0804_0201_u64 as i64);
                _mm512_gf2p8affine_epi64_epi8::<0>(self.0, matrix)
            });
        }
        // Each half of a byte, turned around, into the place of the other half.
        // SAFETY: a value of this type exists only under AVX-512 with BW (module docs).
        Avx512Bits(unsafe {
            let turned = _mm512_broadcast_i32x4(_mm_setr_epi8(
                0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15,
            ));
            let half = _mm512_set1_epi8(0xf);
            let low = _mm512_and_si512(self.0, half);
            let high = _mm512_and_si512(_mm512_srli_epi32::<4>(self.0), half);
            let (low, high) = (_mm512_shuffle_epi8(turned, low), _mm512_shuffle_epi8(turned, high));
            _mm512_or_si512(_mm512_slli_epi32::<4>(low), high)
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
        fn $method(self, other: Avx512<GFNI>) -> Avx512Mask {
            // SAFETY: a value of this type exists only under AVX-512 (module docs).
            Avx512Mask(unsafe { _mm512_cmp_ps_mask::<$predicate>(self.0, other.0) })
        }
    )*};
}

impl<const GFNI: bool> Simd for Avx512<GFNI> {
    const WIDTH: usize = 16;
    type Mask = Avx512Mask;
    type Bits = Avx512Bits<GFNI>;

    #[inline(always)]
    fn splat(x: f32) -> Avx512<GFNI> {
        // SAFETY: reached only as a SIMD type of a kernel under those two (module docs).
        Avx512(unsafe { _mm512_set1_ps(x) })
    }
    #[inline(always)]
    fn min(self, other: Avx512<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Avx512<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Avx512<GFNI>, c: Avx512<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_fmadd_ps(self.0, b.0, c.0) })
    }
    compare! {
        lt _CMP_LT_OQ;
        le _CMP_LE_OQ;
        equal _CMP_EQ_OQ;
    }
    #[inline(always)]
    fn select(mask: Avx512Mask, a: Avx512<GFNI>, b: Avx512<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_mask_blend_ps(mask.0, b.0, a.0) })
    }
    #[inline(always)]
    fn to_bits(self) -> Avx512Bits<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_castps_si512(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: Avx512Bits<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_castsi512_ps(bits.0) })
    }
    #[inline(always)]
    fn from_small(bits: Avx512Bits<GFNI>) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_cvtepi32_ps(bits.0) })
    }
}

impl<const GFNI: bool> SimdWide for Avx512<GFNI> {
    #[inline(always)]
    fn load(x: &[f32]) -> Avx512<GFNI> {
        let x = &x[..16];
        // SAFETY: the slice holds sixteen readable floats; the load needs no alignment; reached
        // only under those two (module docs).
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
    fn load_bits(x: &[u32]) -> Avx512Bits<GFNI> {
        let x = &x[..16];
        // SAFETY: the slice holds sixteen readable words; the load needs no alignment; reached only
        // under `run_avx512`.
        Avx512Bits(unsafe { _mm512_loadu_si512(x.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store_bits(bits: Avx512Bits<GFNI>, x: &mut [u32]) {
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
    fn select_bits(mask: Avx512Mask, a: Avx512Bits<GFNI>, b: Avx512Bits<GFNI>) -> Avx512Bits<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Bits(unsafe { _mm512_mask_blend_epi32(mask.0, b.0, a.0) })
    }
    #[inline(always)]
    fn equal_bits(a: Avx512Bits<GFNI>, b: Avx512Bits<GFNI>) -> Avx512Mask {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Mask(unsafe { _mm512_cmpeq_epi32_mask(a.0, b.0) })
    }
    #[inline(always)]
    fn less_bits(a: Avx512Bits<GFNI>, b: Avx512Bits<GFNI>) -> Avx512Mask {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512Mask(unsafe { _mm512_cmplt_epu32_mask(a.0, b.0) })
    }
    // Within the register and then a whole store: a compressing store is slow on Zen 4.
    #[inline(always)]
    fn compress(self, mask: Avx512Mask, x: &mut [f32]) {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Self(unsafe { _mm512_maskz_compress_ps(mask.0, self.0) }).store(x);
    }
    #[inline(always)]
    fn compress_bits(bits: Avx512Bits<GFNI>, mask: Avx512Mask, x: &mut [u32]) {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        let side_by_side: Self::Bits =
            Avx512Bits(unsafe { _mm512_maskz_compress_epi32(mask.0, bits.0) });
        Self::store_bits(side_by_side, x);
    }
    #[inline(always)]
    fn recip(self) -> Avx512<GFNI> {
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        let rough = Self(unsafe { _mm512_rcp14_ps(self.0) });
        // Newton's step: from 14 bits to all but the last few roundings.
        let off = (-self).mul_add(rough, Self::splat(1.0));
        rough.mul_add(off, rough)
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: Avx512Bits<GFNI>) -> Avx512<GFNI> {
        let table = Self::load(table);
        // SAFETY: a value of this type exists only under AVX-512 (module docs).
        Avx512(unsafe { _mm512_permutexvar_ps(index.0, table.0) })
    }
}
