//! Four values in a NEON register. `FUSED` says whether a product and a sum after it are rounded once,
//! which gives the bits of AVX2, or twice, which gives those of SSE2 and of plain Rust.
//!
//! Soundness: NEON is part of every AArch64, so that no machine this is compiled for lacks it;
//! `aarch64` holds a build without it off. Each intrinsic call below leans on that.
#![allow(unsafe_code)]

use super::super::pair::Half;
use super::super::{Bits, Mask, Simd, SimdWide};
use std::arch::aarch64::*;
use std::arch::asm;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

#[derive(Clone, Copy, Debug)]
pub(super) struct Neon<const FUSED: bool>(float32x4_t);
#[derive(Clone, Copy, Debug)]
pub(super) struct NeonBits(uint32x4_t);
/// All ones or all zeros in each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct NeonMask(uint32x4_t);

macro_rules! binary {
    ($($type:ty: $op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl $op for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: every AArch64 has NEON (module docs).
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
binary! {
    NeonBits: Add add vaddq_u32;
    NeonBits: Sub sub vsubq_u32;
    NeonBits: Mul mul vmulq_u32;
    NeonBits: BitAnd bitand vandq_u32;
    NeonBits: BitOr bitor vorrq_u32;
    NeonBits: BitXor bitxor veorq_u32;
    NeonMask: BitAnd bitand vandq_u32;
    NeonMask: BitOr bitor vorrq_u32;
}
macro_rules! arithmetic {
    ($($op:ident $method:ident $intrinsic:ident;)*) => {$(
        impl<const FUSED: bool> $op for Neon<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: every AArch64 has NEON (module docs).
                Neon(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}
arithmetic! {
    Add add vaddq_f32;
    Sub sub vsubq_f32;
    Mul mul vmulq_f32;
    Div div vdivq_f32;
}

impl<const FUSED: bool> Neg for Neon<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vnegq_f32(self.0) })
    }
}
impl Shl<u32> for NeonBits {
    type Output = NeonBits;
    #[inline(always)]
    fn shl(self, by: u32) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vshlq_u32(self.0, vdupq_n_s32(by as i32)) })
    }
}
impl Shr<u32> for NeonBits {
    type Output = NeonBits;
    // To the right is to the left by less than nothing.
    #[inline(always)]
    fn shr(self, by: u32) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vshlq_u32(self.0, vdupq_n_s32(-(by as i32))) })
    }
}
impl Bits for NeonBits {
    #[inline(always)]
    fn splat(x: u32) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vdupq_n_u32(x) })
    }
    // The bits within each byte, then the bytes of each word.
    #[inline(always)]
    fn reverse_bits(self) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe {
            vreinterpretq_u32_u8(vrev32q_u8(vrbitq_u8(vreinterpretq_u8_u32(self.0))))
        })
    }
}
impl Not for NeonMask {
    type Output = NeonMask;
    #[inline(always)]
    fn not(self) -> NeonMask {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonMask(unsafe { vmvnq_u32(self.0) })
    }
}
impl Mask for NeonMask {
    #[inline(always)]
    fn any(self) -> bool {
        // SAFETY: every AArch64 has NEON (module docs).
        unsafe { vmaxvq_u32(self.0) != 0 }
    }
    #[inline(always)]
    fn all(self) -> bool {
        // SAFETY: every AArch64 has NEON (module docs).
        unsafe { vminvq_u32(self.0) != 0 }
    }
    // One bit of each lane, added up.
    #[inline(always)]
    fn bits(self) -> u32 {
        let each = Neon::<false>::load_bits(&EACH);
        // SAFETY: every AArch64 has NEON (module docs).
        unsafe { vaddvq_u32(vandq_u32(self.0, each.0)) }
    }
}

macro_rules! compare {
    ($($method:ident $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $method(self, other: Self) -> NeonMask {
            // SAFETY: every AArch64 has NEON (module docs).
            NeonMask(unsafe { $intrinsic(self.0, other.0) })
        }
    )*};
}

impl<const FUSED: bool> Simd for Neon<FUSED> {
    const WIDTH: usize = 4;
    type Mask = NeonMask;
    type Bits = NeonBits;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vdupq_n_f32(x) })
    }
    // NEON's own smaller number is NaN where either is.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vabsq_f32(self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vsqrtq_f32(self.0) })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if FUSED {
            // SAFETY: every AArch64 has NEON (module docs).
            Neon(unsafe { vfmaq_f32(c.0, self.0, b.0) })
        } else {
            self * b + c
        }
    }
    compare! {
        lt vcltq_f32;
        le vcleq_f32;
        equal vceqq_f32;
    }
    #[inline(always)]
    fn select(mask: NeonMask, a: Self, b: Self) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vbslq_f32(mask.0, a.0, b.0) })
    }
    #[inline(always)]
    fn to_bits(self) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vreinterpretq_u32_f32(self.0) })
    }
    #[inline(always)]
    fn from_bits(bits: NeonBits) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vreinterpretq_f32_u32(bits.0) })
    }
    #[inline(always)]
    fn from_small(bits: NeonBits) -> Self {
        // SAFETY: every AArch64 has NEON (module docs).
        Neon(unsafe { vcvtq_f32_u32(bits.0) })
    }
    #[inline(always)]
    fn or_zero(self, mask: NeonMask) -> Self {
        Self::from_bits(NeonBits(mask.0) & self.to_bits())
    }
}

impl<const FUSED: bool> SimdWide for Neon<FUSED> {
    #[inline(always)]
    fn load(x: &[f32]) -> Self {
        let x = &x[..4];
        // SAFETY: the slice holds four readable floats; the load needs no alignment.
        Neon(unsafe { vld1q_f32(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, x: &mut [f32]) {
        let x = &mut x[..4];
        // SAFETY: the slice holds four floats; the store needs no alignment.
        unsafe { vst1q_f32(x.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn load_bits(x: &[u32]) -> NeonBits {
        let x = &x[..4];
        // SAFETY: the slice holds four readable words; the load needs no alignment.
        NeonBits(unsafe { vld1q_u32(x.as_ptr()) })
    }
    #[inline(always)]
    fn store_bits(bits: NeonBits, x: &mut [u32]) {
        let x = &mut x[..4];
        // SAFETY: the slice holds four words; the store needs no alignment.
        unsafe { vst1q_u32(x.as_mut_ptr(), bits.0) }
    }
    #[inline(always)]
    fn mask(bits: u32) -> NeonMask {
        let each = Self::load_bits(&EACH);
        // SAFETY: every AArch64 has NEON (module docs).
        NeonMask(unsafe { vtstq_u32(vdupq_n_u32(bits), each.0) })
    }
    #[inline(always)]
    fn select_bits(mask: NeonMask, a: NeonBits, b: NeonBits) -> NeonBits {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vbslq_u32(mask.0, a.0, b.0) })
    }
    #[inline(always)]
    fn equal_bits(a: NeonBits, b: NeonBits) -> NeonMask {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonMask(unsafe { vceqq_u32(a.0, b.0) })
    }
    #[inline(always)]
    fn less_bits(a: NeonBits, b: NeonBits) -> NeonMask {
        // SAFETY: every AArch64 has NEON (module docs).
        NeonMask(unsafe { vcltq_u32(a.0, b.0) })
    }
    #[inline(always)]
    fn compress(self, mask: NeonMask, x: &mut [f32]) {
        Self::from_bits(side_by_side(self.to_bits(), mask)).store(x);
    }
    #[inline(always)]
    fn compress_bits(bits: NeonBits, mask: NeonMask, x: &mut [u32]) {
        Self::store_bits(side_by_side(bits, mask), x);
    }
    #[inline(always)]
    fn recip(self) -> Self {
        Self::splat(1.0) / self
    }
    #[inline(always)]
    fn lookup(table: &[f32; 16], index: NeonBits) -> Self {
        // Four bytes an entry, from four times the index on.
        let place = index & NeonBits::splat(15);
        let bytes = place * NeonBits::splat(0x0404_0404) + NeonBits::splat(0x0302_0100);
        let quarter = |i: usize| Self::load(&table[4 * i..]).to_bits();
        // SAFETY: every AArch64 has NEON (module docs).
        let found = NeonBits(unsafe {
            let all = uint8x16x4_t(
                vreinterpretq_u8_u32(quarter(0).0),
                vreinterpretq_u8_u32(quarter(1).0),
                vreinterpretq_u8_u32(quarter(2).0),
                vreinterpretq_u8_u32(quarter(3).0),
            );
            vreinterpretq_u32_u8(vqtbl4q_u8(all, vreinterpretq_u8_u32(bytes.0)))
        });
        Self::from_bits(found)
    }
}

impl<const FUSED: bool> Half for Neon<FUSED> {
    #[inline(always)]
    fn each(bits: NeonBits) -> [NeonBits; 4] {
        // SAFETY: every AArch64 has NEON (module docs).
        unsafe {
            [
                NeonBits(vdupq_laneq_u32::<0>(bits.0)),
                NeonBits(vdupq_laneq_u32::<1>(bits.0)),
                NeonBits(vdupq_laneq_u32::<2>(bits.0)),
                NeonBits(vdupq_laneq_u32::<3>(bits.0)),
            ]
        }
    }
    #[inline(always)]
    fn count_less(total: NeonBits, a: NeonBits, b: NeonBits) -> NeonBits {
        // All ones is -1.
        // SAFETY: every AArch64 has NEON (module docs).
        NeonBits(unsafe { vsubq_u32(total.0, vcltq_u32(a.0, b.0)) })
    }
    // By its name: the standard library has no stable function for it.
    #[inline(always)]
    fn prefetch_line(address: *const u8) {
        // SAFETY: a prefetch reads nothing that the program could see and never faults.
        unsafe {
            asm!("prfm pldl2keep, [{}]", in(reg) address,
                options(readonly, nostack, preserves_flags));
        }
    }
}

/// The bit of each lane.
static EACH: [u32; 4] = [1, 2, 4, 8];

/// The words of those lanes that the mask has, in order.
#[inline(always)]
fn side_by_side(bits: NeonBits, mask: NeonMask) -> NeonBits {
    let order = Neon::<false>::load_bits(&COMPRESS[mask.bits() as usize & 0xf]);
    // SAFETY: every AArch64 has NEON (module docs).
    NeonBits(unsafe {
        let (bytes, order) = (vreinterpretq_u8_u32(bits.0), vreinterpretq_u8_u32(order.0));
        vreinterpretq_u32_u8(vqtbl1q_u8(bytes, order))
    })
}

/// For every mask the bytes of the lanes that it has, in order.
static COMPRESS: [[u32; 4]; 16] = {
    let mut table = [[0; 4]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut lane, mut place) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 != 0 {
                table[mask][place] = 0x0302_0100 + 0x0404_0404 * lane;
                place += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};
