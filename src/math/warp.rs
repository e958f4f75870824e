//! Maps from the unit square to directions and points, each beside its density.

use super::simd::Simd;
use super::special::{INV_PI, sin_cos_2pi};
use super::vec::V3;

/// A direction about +z with density [`cosine_hemisphere_pdf`]; its z is above 0.
#[inline(always)]
pub fn cosine_hemisphere<L: Simd>([u, v]: [L; 2]) -> V3<L> {
    let r = u.sqrt();
    let (sin, cos) = sin_cos_2pi(v);
    V3::new(r * cos, r * sin, (L::splat(1.0) - u).sqrt())
}

/// `cos / pi`, in 1/sr.
#[inline(always)]
pub fn cosine_hemisphere_pdf<L: Simd>(cos: L) -> L {
    cos * L::splat(INV_PI)
}

/// A point of the unit disc, uniform by area (density 1/pi).
#[inline(always)]
pub fn disc<L: Simd>([u, v]: [L; 2]) -> [L; 2] {
    let r = u.sqrt();
    let (sin, cos) = sin_cos_2pi(v);
    [r * cos, r * sin]
}

/// Barycentric weights of a triangle's second and third vertex, uniform by area (Heitz, "A
/// low-distortion map between triangle and square", 2019).
#[inline(always)]
pub fn triangle<L: Simd>([u, v]: [L; 2]) -> [L; 2] {
    let half = L::splat(0.5);
    let above = v.gt(u);
    let small = L::select(above, u, v) * half;
    let large = L::select(above, v, u) - small;
    [L::select(above, small, large), L::select(above, large, small)]
}

/// A direction about +z, uniform within the cone whose `1 - cos` is `one_minus_cos`; density
/// [`cone_pdf`]. Keeps its digits for cones of any width.
#[inline(always)]
pub fn cone<L: Simd>([u, v]: [L; 2], one_minus_cos: L) -> V3<L> {
    let h = u * one_minus_cos;
    let sin = (h * (L::splat(2.0) - h)).sqrt();
    let (sin_phi, cos_phi) = sin_cos_2pi(v);
    V3::new(sin * cos_phi, sin * sin_phi, L::splat(1.0) - h)
}

/// `1 / (2 pi (1 - cos))`, in 1/sr.
#[inline(always)]
pub fn cone_pdf<L: Simd>(one_minus_cos: L) -> L {
    L::splat(0.5 * INV_PI) / one_minus_cos
}

/// A direction uniform over the sphere (density 1/(4 pi)).
#[inline(always)]
pub fn sphere<L: Simd>(u: [L; 2]) -> V3<L> {
    cone(u, L::splat(2.0))
}
