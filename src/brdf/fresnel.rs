//! Schlick's approximation of the Fresnel reflectance.

use crate::math::{Rgb, Simd};

/// `(1 - d)^5` from `1 - d`, which the caller has without cancellation. In [0, 1].
#[inline(always)]
pub(crate) fn schlick_weight<L: Simd>(one_minus_d: L) -> L {
    let x = one_minus_d.max(L::splat(0.0)).min(L::splat(1.0));
    let x2 = x * x;
    x2 * x2 * x
}

/// `F = Ks + (1 - Ks) (1 - d)^5` (Schlick 1994), with `d` the cosine between the light and the
/// microfacet normal.
#[inline(always)]
pub(crate) fn schlick<L: Simd>(ks: Rgb<L>, weight: L) -> Rgb<L> {
    ks.map(|ks| ks + (L::splat(1.0) - ks) * weight)
}
