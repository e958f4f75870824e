//! SIMD: the number type that every formula of this crate is written over.
//!
//! A formula takes `L: Simd` and never branches on a value; it selects. So the same source serves
//! one ray (`f32`, [`Simd::WIDTH`] 1), four at a time (SSE2, NEON), eight ([`F32x8`] or its twins of
//! SSE2, NEON and AVX2) and sixteen (AVX-512).
//! Control flow that differs between scalar and SIMD code lives with its callers.
//!
//! This is the one module that may use `unsafe`: the instruction-set shells below it. It is also the one
//! that knows which processor it is compiled for: `machine` is what that has, of one shape for all.

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod pair;
mod portable;
mod scalar;
#[cfg(test)]
mod tests;

#[cfg(target_arch = "aarch64")]
#[path = "aarch64/mod.rs"]
mod machine;
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[path = "fallback.rs"]
mod machine;
#[cfg(target_arch = "x86_64")]
#[path = "x86/mod.rs"]
mod machine;

pub use portable::F32x8;
pub use scalar::U32;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// A vector of `WIDTH` independent `f32` values.
///
/// Arithmetic is IEEE single precision per lane, rounding to nearest, without contraction, so that
/// one lane of a wide vector gives the bits of the scalar code. [`Simd::mul_add`] is the exception
/// and says so.
pub trait Simd:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many values one vector holds.
    const WIDTH: usize;
    /// The result of a comparison, one truth value per lane.
    type Mask: Mask;
    /// The same number of `u32` values.
    type Bits: Bits;

    /// The same value in every lane.
    fn splat(x: f32) -> Self;
    /// The smaller of each pair; the second where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of each pair; the second where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// `self * b + c`, fused where the instruction set has it for free, otherwise rounded twice.
    /// For polynomials only: code that needs one of the two roundings must not use it.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self < other`
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`
    fn le(self, other: Self) -> Self::Mask;
    /// `self == other`
    fn equal(self, other: Self) -> Self::Mask;
    /// `self > other`
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// `a` where the mask is set, else `b`. Both are evaluated; a NaN in the other has no effect.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// The IEEE bits.
    fn to_bits(self) -> Self::Bits;
    /// The value with these IEEE bits.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Each `u32`, which must be below 2^24, as the same number.
    fn from_small(bits: Self::Bits) -> Self;

    /// `a` where the mask is set, else 0.
    #[inline(always)]
    fn or_zero(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::splat(0.0))
    }
    /// The square.
    #[inline(always)]
    fn sqr(self) -> Self {
        self * self
    }
    /// This magnitude with the sign of `sign`, zeros included.
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let top = Self::Bits::splat(0x8000_0000);
        let rest = Self::Bits::splat(0x7fff_ffff);
        Self::from_bits((self.to_bits() & rest) | (sign.to_bits() & top))
    }
}

/// One truth value per lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// True in any lane.
    fn any(self) -> bool {
        self.bits() != 0
    }
    /// True in every lane.
    fn all(self) -> bool;
    /// Lane `i` as bit `i`.
    fn bits(self) -> u32;
}

/// A vector of `u32` values with wrapping arithmetic.
pub trait Bits:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// The same value in every lane.
    fn splat(x: u32) -> Self;
    /// Bit 31 becomes bit 0, and so on.
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        let swap = |x: Self, mask: u32, by: u32| {
            let m = Self::splat(mask);
            ((x >> by) & m) | ((x & m) << by)
        };
        let x = swap(self, 0x5555_5555, 1);
        let x = swap(x, 0x3333_3333, 2);
        let x = swap(x, 0x0f0f_0f0f, 4);
        let x = swap(x, 0x00ff_00ff, 8);
        (x >> 16) | (x << 16)
    }
}

/// A SIMD type of eight values that can be read from memory: what the traversal works on.
pub trait Simd8: Simd {
    /// Whether it pays to trace many rays in turn: [`Simd8::sort_far_to_near`] and [`Simd8::pick`] take no
    /// branches, and [`Simd8::prefetch`] does something.
    const INTERLEAVED: bool;
    /// The eight numbers in order.
    fn load(x: &[f32; 8]) -> Self;
    /// The eight numbers in order.
    fn store(self) -> [f32; 8];
    /// The words of those lanes that the mask has, that of the largest number first, and beside
    /// each its number as IEEE bits of which the last four are the lane's and of no meaning. The
    /// numbers are not negative. Returns how many; what is left of the places holds anything.
    fn sort_far_to_near(
        self,
        mask: Self::Mask,
        words: &[u32; 8],
        numbers_out: &mut [f32; 8],
        words_out: &mut [u32; 8],
    ) -> usize;
    /// The words of those lanes that the mask has, side by side. Returns how many; what is left of
    /// the places holds anything.
    fn pick(mask: Self::Mask, words: &[u32; 8], out: &mut [u32; 8]) -> usize;
    /// Asks for the cache line at the start of a thing and for all others that it lies in, as far
    /// as the second cache: the first one can wait for two dozen lines at a time, which a few rays
    /// want at once, and then the asking itself would wait.
    fn prefetch<T>(thing: &T);
}

/// The largest [`Simd::WIDTH`] of any [`SimdWide`]: an array of this length has room for any
/// register.
pub(crate) const MAX_WIDTH: usize = 16;

/// A SIMD type as wide as the machine's registers, with a way into memory and out of it: what
/// batches of paths are computed with.
pub trait SimdWide: Simd {
    /// The first [`Simd::WIDTH`] numbers of a slice, which must have at least that number.
    fn load(x: &[f32]) -> Self;
    /// Into the first [`Simd::WIDTH`] places of a slice, which must have at least that number.
    fn store(self, x: &mut [f32]);
    /// [`SimdWide::load`] of words.
    fn load_bits(x: &[u32]) -> Self::Bits;
    /// [`SimdWide::store`] of words.
    fn store_bits(bits: Self::Bits, x: &mut [u32]);
    /// Lane `i` from bit `i`.
    fn mask(bits: u32) -> Self::Mask;
    /// `a` where the mask is set, else `b`.
    fn select_bits(mask: Self::Mask, a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// `a == b`
    fn equal_bits(a: Self::Bits, b: Self::Bits) -> Self::Mask;
    /// `a < b`
    fn less_bits(a: Self::Bits, b: Self::Bits) -> Self::Mask;
    /// The lanes that the mask has, side by side, into the first places of a slice of at least
    /// [`Simd::WIDTH`]; what is left of those places holds anything.
    fn compress(self, mask: Self::Mask, x: &mut [f32]);
    /// [`SimdWide::compress`] of words.
    fn compress_bits(bits: Self::Bits, mask: Self::Mask, x: &mut [u32]);
    /// The reciprocal to within 4 ulp, by whatever is fastest; of 0 it is infinite or NaN.
    fn recip(self) -> Self;
    /// The entry that the low four bits of each index name.
    fn lookup(table: &[f32; 16], index: Self::Bits) -> Self;
}

/// An instruction set the SIMD code can run on. Code that keeps off [`Simd::mul_add`] gets the same
/// bits on all of them; all but the portable one, whatever the processor, give the same bits always.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// What every machine of the target has, without fused sums: SSE2 on x86-64, NEON on AArch64,
    /// plain Rust elsewhere, with the same bits.
    Portable,
    /// AVX2 with FMA.
    Avx2,
    /// AVX-512 (F, DQ, BW, VL): Skylake-SP, Cascade Lake.
    Avx512,
    /// AVX-512 with GFNI: Ice Lake, Zen 4 and later.
    Avx512Gfni,
    /// NEON with fused sums, which every AArch64 has.
    Neon,
}

impl Isa {
    /// All of them, of each kind of processor the plainest first.
    pub const ALL: [Isa; 5] = [Isa::Portable, Isa::Avx2, Isa::Avx512, Isa::Avx512Gfni, Isa::Neon];

    /// The best one this machine has; asked once per scene, not per ray.
    pub fn detect() -> Isa {
        let best = Isa::ALL.into_iter().rfind(|&isa| machine::has(isa));
        best.expect("every machine has the portable set")
    }

    /// Every set that this machine can run, the portable one first.
    pub fn available() -> Vec<Isa> {
        Isa::ALL.into_iter().filter(|&isa| machine::has(isa)).collect()
    }

    /// How many paths are computed at a time: [`Simd::WIDTH`] of the packets that [`dispatch`] runs
    /// a kernel with on this machine.
    pub fn width(self) -> usize {
        struct Width;
        impl Kernel for Width {
            type Output = usize;
            #[inline(always)]
            fn run<W: Simd8, P: SimdWide>(self) -> usize {
                P::WIDTH
            }
        }
        dispatch(self, Width)
    }

    /// Lower-case name as `--stats` writes it.
    pub fn name(self) -> &'static str {
        match self {
            Isa::Portable => "portable",
            Isa::Avx2 => "avx2",
            Isa::Avx512 => "avx512",
            Isa::Avx512Gfni => "avx512-gfni",
            Isa::Neon => "neon",
        }
    }
}

/// A piece of work written over SIMD types, `W` for one ray against eight boxes or triangles and
/// `P` for as many paths as the registers hold, to be run on an instruction set chosen at run
/// time. `run` must be `#[inline(always)]`, and so must all it calls, to be compiled for that set.
pub trait Kernel {
    /// What the work returns.
    type Output;
    /// Does the work on one instruction set.
    fn run<W: Simd8, P: SimdWide>(self) -> Self::Output;
}

/// The lanes of a mask, lowest first, from [`Mask::bits`].
#[inline(always)]
pub(crate) fn each_lane(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        let some = mask != 0;
        mask &= mask.wrapping_sub(1);
        some.then_some(lane)
    })
}

/// The bits of the first `count` lanes, at most all.
#[inline(always)]
pub(crate) fn first_lanes(count: usize) -> u32 {
    if count >= 32 { u32::MAX } else { (1 << count) - 1 }
}

/// Runs a kernel on `isa`, or on a plainer one where the machine lacks it.
#[inline(always)]
pub fn dispatch<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    machine::run(isa, kernel)
}
