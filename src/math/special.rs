//! Elementary and special functions over lanes, in single precision.
//!
//! The standard library has these for one `f32` at a time only, and no error function at all. The
//! polynomials are least-maximum-error fits made for this file; each doc states the largest error
//! seen against f64 over a dense sweep, which `tests/brdf/special.rs` repeats.

// Coefficients are written as they were fitted; that one is near a constant is no accident.
#![allow(clippy::excessive_precision, clippy::approx_constant)]

use super::simd::{Bits, Simd};

/// `1 / pi`
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// `1 / sqrt(pi)`
pub const INV_SQRT_PI: f32 = 0.564_189_6;

#[inline(always)]
fn poly<L: Simd>(x: L, coefficients: &[f32]) -> L {
    let (last, rest) = coefficients.split_last().expect("a polynomial has a coefficient");
    rest.iter().rev().fold(L::splat(*last), |sum, &c| sum.mul_add(x, L::splat(c)))
}

/// Adding this rounds to an integer, which then stands in the low bits.
const ROUND: f32 = 12_582_912.0;

/// `e^x` for x <= 88.7; 0 below -86.6. Relative error 1.3e-7.
#[inline(always)]
pub fn exp<L: Simd>(x: L) -> L {
    let clamped = x.max(L::splat(-86.6)).min(L::splat(88.7));
    let shifted = clamped * L::splat(std::f32::consts::LOG2_E) + L::splat(ROUND);
    let k = shifted - L::splat(ROUND);
    // ln 2 in two parts, the first of few bits so that its product with k is exact.
    let r = clamped - k * L::splat(0.693_359_4) + k * L::splat(2.121_944_4e-4);
    let p = poly(r, &[0.5, 1.666_651_8e-1, 4.166_620_6e-2, 8.368_882e-3, 1.395_047_6e-3]);
    let e = (p * r).mul_add(r, r) + L::splat(1.0);
    // Half the scale first: 2^128 itself is not a number.
    let scale = L::from_bits((shifted.to_bits() + L::Bits::splat(126)) << 23);
    (e * scale * L::splat(2.0)).or_zero(x.gt(L::splat(-86.6)))
}

/// Natural logarithm of a positive normal number. Relative error 2e-7, also next to 1.
#[inline(always)]
pub fn ln<L: Simd>(x: L) -> L {
    // Mantissa within [sqrt 1/2, sqrt 2), so that ln x near 1 keeps its digits.
    let root_half = L::Bits::splat(0x3f35_04f3);
    let bits = x.to_bits() + (L::Bits::splat(0x3f80_0000) - root_half);
    let exponent = L::from_small(bits >> 23) - L::splat(127.0);
    let f = L::from_bits((bits & L::Bits::splat(0x007f_ffff)) + root_half) - L::splat(1.0);
    let s = f / (f + L::splat(2.0));
    let z = s * s;
    let q = poly(z, &[6.666_666_9e-1, 4.000_012_3e-1, 2.855_065_2e-1, 2.333_471_9e-1]);
    let tail = s * z * q + exponent * L::splat(-2.121_944_4e-4);
    (s + s) + tail + exponent * L::splat(0.693_359_4)
}

/// `ln(1 + x)` for x >= 0, without loss at small x. Relative error 3e-7.
#[inline(always)]
pub fn ln_1p<L: Simd>(x: L) -> L {
    let u = x + L::splat(1.0);
    let d = u - L::splat(1.0);
    // The rounding of 1 + x cancels in ln(u) / (u - 1), which is smooth (Kahan).
    L::select(d.equal(L::splat(0.0)), x, ln(u) * (x / d)).min(L::splat(f32::MAX)).max(L::splat(0.0))
}

/// `e^x - 1` for -80 <= x <= 0, without loss at small x. Relative error 3e-7.
#[inline(always)]
pub fn exp_m1<L: Simd>(x: L) -> L {
    let one = L::splat(1.0);
    let u = exp(x);
    let d = u - one;
    // As in ln_1p: the rounding of u cancels. Below -1 nothing is lost in the difference itself.
    let near = d * (x / ln(u.max(L::splat(f32::MIN_POSITIVE))));
    let y = L::select(x.lt(-one), d, near);
    L::select(u.equal(one), x, y)
}

/// Sine and cosine of `2 pi u`, 0 <= u <= 1. Absolute error 1.2e-7.
#[inline(always)]
pub fn sin_cos_2pi<L: Simd>(u: L) -> (L, L) {
    let quarters = u * L::splat(4.0);
    let shifted = quarters + L::splat(ROUND);
    let x = quarters - (shifted - L::splat(ROUND));
    let quadrant = shifted.to_bits() & L::Bits::splat(3);
    let z = x * x;
    let s = x * poly(z, &[1.570_796_4, -6.459_635e-1, 7.968_022_7e-2, -4.602_177e-3]);
    let c = poly(z, &[1.0, -1.233_700_5, 2.536_692e-1, -2.086_007_2e-2, 9.036_316_8e-4]);
    let odd = L::from_small(quadrant & L::Bits::splat(1)).gt(L::splat(0.0));
    let flip_sin = (quadrant & L::Bits::splat(2)) << 30;
    let flip_cos = ((quadrant + L::Bits::splat(1)) & L::Bits::splat(2)) << 30;
    let sin = L::select(odd, c, s);
    let cos = L::select(odd, s, c);
    (L::from_bits(sin.to_bits() ^ flip_sin), L::from_bits(cos.to_bits() ^ flip_cos))
}

/// `atan(y / x)` for x >= 0, from -pi/2 to pi/2; 0 where both are 0. Absolute error 2e-7.
#[inline(always)]
pub fn atan_ratio<L: Simd>(y: L, x: L) -> L {
    let a = y.abs();
    let steep = a.gt(x);
    let large = L::select(steep, a, x);
    let t = L::select(steep, x, a) / large.max(L::splat(f32::MIN_POSITIVE));
    let z = t * t;
    let near = t * poly(
        z,
        &[
            9.999_993_4e-1,
            -3.332_986e-1,
            1.994_656_6e-1,
            -1.390_862_9e-1,
            9.642_196_5e-2,
            -5.591_231_5e-2,
            2.186_295e-2,
            -4.054_565_1e-3,
        ],
    );
    L::select(steep, L::splat(std::f32::consts::FRAC_PI_2) - near, near).copysign(y)
}

/// `erfc(x) e^(x²)` for x >= 0. Relative error 5e-7.
#[inline(always)]
pub fn erfc_scaled<L: Simd>(x: L) -> L {
    let t = L::splat(1.0) / (x * L::splat(0.4) + L::splat(1.0));
    t * poly(
        t - L::splat(0.5),
        &[
            4.216_126_5e-1,
            6.437_221e-1,
            7.262_766_4e-1,
            5.479_657_7e-1,
            1.810_765_7e-1,
            -1.067_903_1e-1,
            -1.184_933_5e-1,
            1.825_262_6e-2,
            4.871_053e-2,
        ],
    )
}

/// Error function. Absolute error 1.5e-7, relative 3e-7.
#[inline(always)]
pub fn erf<L: Simd>(x: L) -> L {
    let a = x.abs();
    let z = a * a;
    let near = a * poly(
        z,
        &[
            1.128_379_1,
            -3.761_262_6e-1,
            1.128_360_03e-1,
            -2.685_444_4e-2,
            5.189_535e-3,
            -8.020_841e-4,
            7.889_119e-5,
        ],
    );
    let far = L::splat(1.0) - exp(-z) * erfc_scaled(a);
    L::select(a.lt(L::splat(1.0)), near, far).copysign(x)
}

/// The x with `erfc(x) = c`, that is `erf(x) = 1 - c`, for 3e-8 <= c <= 2 - 3e-8; outside, the
/// value at the end. Relative error 1e-6 where |x| > 1e-3.
#[inline(always)]
pub fn erfc_inv<L: Simd>(c: L) -> L {
    let one = L::splat(1.0);
    let c = c.max(L::splat(3e-8)).min(L::splat(2.0 - 1.2e-7));
    let y = one - c;
    // (1 - y)(1 + y) without cancellation.
    let w = -ln(c * (L::splat(2.0) - c));
    let central = poly(
        w - L::splat(2.5),
        &[
            1.501_409_4,
            2.466_403e-1,
            -4.177_384e-3,
            -1.252_763_8e-3,
            2.183_422_2e-4,
            -4.950_465e-6,
            -3.462_116e-6,
            4.633_812e-7,
            2.318_436_8e-8,
            -8.590_424e-9,
        ],
    );
    let tail = poly(
        w.max(L::splat(0.0)).sqrt() - L::splat(3.2),
        &[
            3.033_636_6,
            1.004_690_3,
            5.978_668_6e-3,
            -4.261_845_7e-3,
            2.909_449_6e-3,
            -2.124_833_2e-3,
            1.188_218e-3,
            -1.602_028_1e-4,
            -1.339_042_1e-4,
        ],
    );
    y * L::select(w.lt(L::splat(5.0)), central, tail)
}
