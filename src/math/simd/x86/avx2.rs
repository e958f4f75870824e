//! Eight values in an AVX2 register.
//!
//! Soundness: an [`Avx2`] value can only be made by code that runs under [`run_avx2`](super::run_avx2)
//! or its wider siblings, which ask the machine first; the type is private to the crate's lanes and
//! reaches callers only as a parameter of a [`Kernel`](super::super::Kernel). Each intrinsic call below
//! leans on that.
#![allow(unsafe_code)]

use super::super::{Bits, Mask, Simd, Simd8, SimdWide};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(__m256);
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2Bits(__m256i);
/// All ones or all zeros in each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2Mask(__m256);

macro_rules! binary {
    ($type:ident: $($op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl $op for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, other: $type) -> $type {
                // SAFETY: a value of this type exists only under AVX2 (module docs).
                $type(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
binary! { Avx2:
    Add add _mm256_add_ps;
    Sub sub _mm256_sub_ps;
    Mul mul _mm256_mul_ps;
    Div div _mm256_div_ps;
}
binary! { Avx2Bits:
    Add add _mm256_add_epi32;
    Sub sub _mm256_sub_epi32;
    Mul mul _mm256_mullo_epi32;
    BitAnd bitand _mm256_and_si256;
    BitOr bitor _mm256_or_si256;
    BitXor bitxor _mm256_xor_si256;
}
binary! { Avx2Mask:
    BitAnd bitand _mm256_and_ps;
    BitOr bitor _mm256_or_ps;
}

impl Neg for Avx2 {
    type Output = Avx2;
    #[inline(always)]
    fn neg(self) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}
impl Shl<u32> for Avx2Bits {
    type Output = Avx2Bits;
    #[inline(always)]
    fn shl(self, by: u32) -> Avx2Bits {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Bits(unsafe { _mm256_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Shr<u32> for Avx2Bits {
    type Output = Avx2Bits;
    #[inline(always)]
    fn shr(self, by: u32) -> Avx2Bits {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Bits(unsafe { _mm256_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
}
impl Bits for Avx2Bits {
    #[inline(always)]
    fn splat(x: u32) -> Avx2Bits {
        // SAFETY: reached only as a SIMD type of a kernel under `run_avx2` or its siblings.
        Avx2Bits(unsafe { _mm256_set1_epi32(x as i32) })
    }
}
impl Not for Avx2Mask {
    type Output = Avx2Mask;
    #[inline(always)]
    fn not(self) -> Avx2Mask {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        unsafe {
            let ones = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
            Avx2Mask(_mm256_xor_ps(self.0, ones))
        }
    }
}
impl Mask for Avx2Mask {
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == 0xff
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

macro_rules! compare {
    ($($method:ident $predicate:ident;)*) => {$(
        #[inline(always)]
        fn $method(self, other: Avx2) -> Avx2Mask {
            // SAFETY: a value of this type exists only under AVX2 (module docs).
            Avx2Mask(unsafe { _mm256_cmp_ps::<$predicate>(self.0, other.0) })
        }
    )*};
}

impl Simd for Avx2 {
    const WIDTH: usize = 8;
    type Mask = Avx2Mask;
    type Bits = Avx2Bits;

    #[inline(always)]
    fn splat(x: f32) -> Avx2 {
        // SAFETY: reached only as a SIMD type of a kernel under `run_avx2` or its siblings.
        Avx2(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn min(self, other: Avx2) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Avx2) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Avx2, c: Avx2) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 and FMA (module docs).
        Avx2(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
    }
    compare! {
        lt _CMP_LT_OQ;
        le _CMP_LE_OQ;
        equal _CMP_EQ_OQ;
    }
    #[inline(always)]
    fn select(mask: Avx2Mask, a: Avx2, b: Avx2) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_blendv_ps(b.0, a.0, mask.0) })
    }
    #[inline(always)]
    fn to_bits(self) -> Avx2Bits {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Bits(unsafe { _mm256_castps_si256(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: Avx2Bits) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_castsi256_ps(bits.0) })
    }
    #[inline(always)]
    fn from_small(bits: Avx2Bits) -> Avx2 {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe { _mm256_cvtepi32_ps(bits.0) })
    }
}

impl Simd8 for Avx2 {
    const INTERLEAVED: bool = true;
    #[inline(always)]
    fn load(x: &[f32; 8]) -> Avx2 {
        // SAFETY: the reference is to eight readable floats; the load needs no alignment; reached
        // only under `run_avx2` or its siblings.
        Avx2(unsafe { _mm256_loadu_ps(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f32; 8] {
        let mut x = [0.0; 8];
        // SAFETY: the array holds eight floats; the store needs no alignment; a value of this type
        // exists only under AVX2 (module docs).
        unsafe { _mm256_storeu_ps(x.as_mut_ptr(), self.0) };
        x
    }
    #[inline(always)]
    fn sort_far_to_near(
        self,
        mask: Avx2Mask,
        words: &[u32; 8],
        numbers_out: &mut [f32; 8],
        words_out: &mut [u32; 8],
    ) -> usize {
        let words = <Avx2 as SimdWide>::load_bits(words);
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        let (sorted, sorted_words) = unsafe {
            let lanes = _mm256_setr_epi32(8, 9, 10, 11, 12, 13, 14, 15);
            let number = _mm256_andnot_si256(_mm256_set1_epi32(15), _mm256_castps_si256(self.0));
            let number = _mm256_or_si256(number, lanes);
            // What the mask leaves out is 0 and comes last.
            let mut x = _mm256_and_si256(number, _mm256_castps_si256(mask.0));
            // A sorting network: in each step the first of two partners gets the larger.
            macro_rules! step {
                ($partner:expr, $second:literal) => {{
                    let partner = $partner;
                    let (large, small) =
                        (_mm256_max_epu32(x, partner), _mm256_min_epu32(x, partner));
                    x = _mm256_blend_epi32::<$second>(large, small);
                }};
            }
            step!(_mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
            step!(_mm256_shuffle_epi32::<0b00_01_10_11>(x), 0b1100_1100);
            step!(_mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
            let reversed = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
            step!(_mm256_permutevar8x32_epi32(x, reversed), 0b1111_0000);
            step!(_mm256_shuffle_epi32::<0b01_00_11_10>(x), 0b1100_1100);
            step!(_mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
            (Avx2(_mm256_castsi256_ps(x)), Avx2Bits(_mm256_permutevar8x32_epi32(words.0, x)))
        };
        SimdWide::store(sorted, numbers_out);
        <Avx2 as SimdWide>::store_bits(sorted_words, words_out);
        mask.bits().count_ones() as usize
    }
    #[inline(always)]
    fn pick(mask: Avx2Mask, words: &[u32; 8], out: &mut [u32; 8]) -> usize {
        <Avx2 as SimdWide>::compress_bits(<Avx2 as SimdWide>::load_bits(words), mask, out);
        mask.bits().count_ones() as usize
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

impl SimdWide for Avx2 {
    #[inline(always)]
    fn load(x: &[f32]) -> Avx2 {
        let x: &[f32; 8] = x[..8].try_into().expect("eight of eight");
        <Avx2 as Simd8>::load(x)
    }
    #[inline(always)]
    fn store(self, x: &mut [f32]) {
        x[..8].copy_from_slice(&<Avx2 as Simd8>::store(self));
    }
    #[inline(always)]
    fn load_bits(x: &[u32]) -> Avx2Bits {
        let x = &x[..8];
        // SAFETY: the slice holds eight readable words; the load needs no alignment; reached only
        // under `run_avx2` or its siblings.
        Avx2Bits(unsafe { _mm256_loadu_si256(x.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store_bits(bits: Avx2Bits, x: &mut [u32]) {
        let x = &mut x[..8];
        // SAFETY: the slice holds eight words; the store needs no alignment; a value of this type
        // exists only under AVX2 (module docs).
        unsafe { _mm256_storeu_si256(x.as_mut_ptr().cast(), bits.0) }
    }
    #[inline(always)]
    fn mask(bits: u32) -> Avx2Mask {
        // SAFETY: reached only as a SIMD type of a kernel under `run_avx2` or its siblings.
        unsafe {
            let each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), each);
            Avx2Mask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, each)))
        }
    }
    #[inline(always)]
    fn select_bits(mask: Avx2Mask, a: Avx2Bits, b: Avx2Bits) -> Avx2Bits {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Bits(unsafe { _mm256_blendv_epi8(b.0, a.0, _mm256_castps_si256(mask.0)) })
    }
    #[inline(always)]
    fn equal_bits(a: Avx2Bits, b: Avx2Bits) -> Avx2Mask {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Mask(unsafe { _mm256_castsi256_ps(_mm256_cmpeq_epi32(a.0, b.0)) })
    }
    #[inline(always)]
    fn less_bits(a: Avx2Bits, b: Avx2Bits) -> Avx2Mask {
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2Mask(unsafe {
            // Signed is all there is: both shifted by half the range.
            let half = _mm256_set1_epi32(i32::MIN);
            let (a, b) = (_mm256_xor_si256(a.0, half), _mm256_xor_si256(b.0, half));
            _mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a))
        })
    }
    #[inline(always)]
    fn compress(self, mask: Avx2Mask, x: &mut [f32]) {
        let order = <Avx2 as SimdWide>::load_bits(&COMPRESS[mask.bits() as usize & 0xff]);
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        let side_by_side = Avx2(unsafe { _mm256_permutevar8x32_ps(self.0, order.0) });
        SimdWide::store(side_by_side, x);
    }
    #[inline(always)]
    fn compress_bits(bits: Avx2Bits, mask: Avx2Mask, x: &mut [u32]) {
        let order = <Avx2 as SimdWide>::load_bits(&COMPRESS[mask.bits() as usize & 0xff]);
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        let side_by_side = Avx2Bits(unsafe { _mm256_permutevar8x32_epi32(bits.0, order.0) });
        <Avx2 as SimdWide>::store_bits(side_by_side, x);
    }
    #[inline(always)]
    fn recip(self) -> Avx2 {
        Avx2::splat(1.0) / self
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: Avx2Bits) -> Avx2 {
        let low = <Avx2 as Simd8>::load(table[..8].try_into().expect("eight of sixteen"));
        let high = <Avx2 as Simd8>::load(table[8..].try_into().expect("eight of sixteen"));
        // SAFETY: a value of this type exists only under AVX2 (module docs).
        Avx2(unsafe {
            let a = _mm256_permutevar8x32_ps(low.0, index.0);
            let b = _mm256_permutevar8x32_ps(high.0, index.0);
            // Bit 3 of the index to the sign, which is what the blend reads.
            let upper = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index.0));
            _mm256_blendv_ps(a, b, upper)
        })
    }
}

/// For every mask the lanes that it has, in order.
static COMPRESS: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 != 0 {
                table[mask][place] = lane;
                place += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};
