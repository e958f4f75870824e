//! The exact sphere.

use super::SurfacePoint;
use super::ray_origin::UNIT_ROUNDOFF;
use crate::math::{Mask, Simd, V3};

/// Centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub centre: V3,
    /// Radius, above 0.
    pub radius: f32,
}

impl Sphere {
    /// Smallest distance t in (0, t_max] at which `o + t d` is on the sphere.
    #[inline(always)]
    pub fn intersect(&self, o: V3, d: V3, t_max: f32) -> Option<f32> {
        let t = intersect(self.centre, self.radius, o, d);
        // Both roots may be wanted: the first may be behind, or at the origin itself.
        t.into_iter().find(|&t| t > 0.0 && t <= t_max && t < f32::INFINITY)
    }

    /// The surface nearest to `p`.
    #[inline(always)]
    pub fn surface(&self, p: V3) -> SurfacePoint {
        let n = (p - self.centre).normalize();
        let p = self.centre + n * self.radius;
        let error = (self.centre.abs() + V3::splat(self.radius)) * (8.0 * UNIT_ROUNDOFF);
        SurfacePoint { p, ng: n, ns: n, error }
    }

    /// Lowest and highest corner.
    pub fn bounds(&self) -> [V3; 2] {
        let r = V3::splat(self.radius);
        [self.centre - r, self.centre + r]
    }
}

/// The two distances at which rays `o + t d` cross spheres, the smaller first; infinite where they
/// do not.
///
/// The discriminant comes from the distance between centre and line, not from b² - 4ac, which
/// cancels for small or distant spheres (Haines, Günther and Akenine-Möller, "Precision
/// improvements for ray/sphere intersection", Ray Tracing Gems 2019, ch. 7).
#[inline(always)]
pub(crate) fn intersect<L: Simd>(centre: V3<L>, radius: L, o: V3<L>, d: V3<L>) -> [L; 2] {
    let zero = L::splat(0.0);
    let none = L::splat(f32::INFINITY);
    let f = o - centre;
    let a = d.length2();
    let b = -f.dot(d);
    let nearest = f + d * (b / a);
    let discriminant = radius * radius - nearest.length2();
    let met = discriminant.ge(zero) & a.gt(zero);
    if !met.any() {
        return [none; 2];
    }
    let root = (a * discriminant).sqrt();
    let q = b + root.copysign(b);
    // |f|² - r² as a product, which keeps the digits near the surface.
    let distance = f.length();
    let c = (distance - radius) * (distance + radius);
    let (over, under) = (c / q, q / a);
    let ahead = b.gt(zero);
    [
        L::select(met, L::select(ahead, over, under), none),
        L::select(met, L::select(ahead, under, over), none),
    ]
}
