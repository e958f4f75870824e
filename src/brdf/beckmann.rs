//! Beckmann (Beckmann and Spizzichino 1963; Walter et al. 2007): Gaussian slopes.
//!
//! | parameter | range | look |
//! | --- | --- | --- |
//! | alpha, the slopes' root mean square times √2 | 1e-4 to 1 | 0.01 mirror, 0.1 polished metal, 0.5 diffuse |
//!
//! `D = exp(-tan²/alpha²) / (pi alpha² cos⁴)`. G1 is the source report's rational form, within 0.313 % of
//! the exact one and unclamped; the sampler's density needs the exact one, with the error
//! function, or it would not be a density. Highlights are compact, without GGX's halo.

use super::{Alpha, Microfacet, Model, rational_g1_over_cos, tan2};
use crate::math::special::{INV_PI, INV_SQRT_PI, erf, erfc_inv, exp};
use crate::math::{Simd, V3};

/// The Beckmann model.
#[derive(Clone, Copy, Debug)]
pub struct Beckmann;

impl Beckmann {
    /// `G1(w) / w.z`, exact for Smith's uncorrelated Gaussian surface.
    #[inline(always)]
    pub fn exact_g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        let b = roughness.alpha * (w.x * w.x + w.y * w.y).sqrt();
        // At the normal b is 0; from a = 10 on, the form is 1 / cos to the last bit.
        let a = (w.z / b.max(L::splat(1e-30))).min(L::splat(10.0));
        let gauss = b * exp(-(a * a)) * L::splat(INV_SQRT_PI);
        L::splat(2.0) / (w.z * (L::splat(1.0) + erf(a)) + gauss)
    }
}

impl Microfacet for Beckmann {
    const MODEL: Model = Model::Beckmann;

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        let a = roughness.alpha;
        let z2 = h.z * h.z;
        // sec² / alpha; the exponential is zero long before its square overflows.
        let s = (h.x * h.x + h.y * h.y + z2) / (z2 * a);
        let d = exp(-(tan2(h) / (a * a))) * L::splat(INV_PI);
        let seen = h.z.gt(L::splat(0.0)) & d.gt(L::splat(0.0));
        (d * s * s).or_zero(seen)
    }

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        rational_g1_over_cos(roughness.alpha, w)
    }

    /// Visible normals by inverting both distribution functions of the slopes seen from `wo`
    /// (Heitz and d'Eon, "Importance sampling microfacet-based BSDFs using the distribution of
    /// visible normals", 2014; the solution of the first by Euler's method is ours).
    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
        // Stretched to alpha 1.
        let (vx, vy) = (roughness.alpha * wo.x, roughness.alpha * wo.y);
        let across = (vx * vx + vy * vy).sqrt();
        let axis = across.gt(L::splat(1e-20));
        let safe = across.max(L::splat(1e-20));
        let cos_phi = L::select(axis, vx / safe, L::splat(1.0));
        let sin_phi = L::select(axis, vy / safe, L::splat(0.0));
        let x = visible_slope(u[0], wo.z / safe);
        let y = erfc_inv((L::splat(1.0) - u[1]) * L::splat(2.0));
        // Back to the surface's azimuth and roughness.
        let sx = (x * cos_phi - y * sin_phi) * roughness.alpha;
        let sy = (x * sin_phi + y * cos_phi) * roughness.alpha;
        V3::new(-sx, -sy, L::splat(1.0)).normalize()
    }

    #[inline(always)]
    fn pdf_factor<L: Simd>(roughness: Alpha<L>, wo: V3<L>) -> L {
        Self::exact_g1_over_cos(roughness, wo) * L::splat(0.25)
    }

    #[inline(always)]
    fn pdf_wi<L: Simd>(factor: L, d: L, _cos_over_dot: L) -> L {
        factor * d
    }
}

/// The slope x towards the viewer's far side whose visible distribution function is `u`, for a
/// viewer at this cotangent: solves `F(x) = u F(cot)` for `x <= cot`, where
/// `F(x) = 1 + erf x + tan exp(-x²) / sqrt(pi)`.
///
/// In the variable `c = 1 + erf x`, F is concave with a maximum at the end, nearly a parabola
/// there; Euler's method takes the parabola exactly. Two steps from a quadratic start leave an
/// error of u below 1e-6 at every angle.
#[inline(always)]
fn visible_slope<L: Simd>(u: L, cot: L) -> L {
    let one = L::splat(1.0);
    let two = L::splat(2.0);
    let cot = cot.min(L::splat(1e10));
    let tan = one / cot;
    let k = tan * L::splat(INV_SQRT_PI);
    let end = cot.min(L::splat(10.0));
    let c_max = one + erf(end);
    let f_max = c_max + k * exp(-(end * end));
    let target = u * f_max;
    let linear = c_max / f_max;
    let b = two - linear;
    let root = (b * b - L::splat(4.0) * (one - linear) * u).max(L::splat(0.0)).sqrt();
    let mut c = two * u / (b + root) * c_max;
    for _ in 0..2 {
        let x = -erfc_inv(c);
        let gauss = exp(-(x * x));
        let f = c + k * gauss - target;
        let slope = one - x * tan;
        // F'' = -(tan sqrt(pi) / 2) exp(x²)
        let bend = tan * L::splat(-0.886_226_9) / gauss;
        let root = (slope * slope - two * f * bend).max(L::splat(0.0)).sqrt();
        let next = c - two * f / (slope + root).max(L::splat(1e-20));
        c = next.max(c * L::splat(0.1)).min((c + c_max) * L::splat(0.5));
    }
    (-erfc_inv(c)).min(cot)
}
