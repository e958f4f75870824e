//! The exact sphere.

use super::SurfacePoint;
use super::offset::ROUNDING;
use crate::math::V3;

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
    ///
    /// The discriminant comes from the distance between centre and line, not from b² - 4ac, which
    /// cancels for small or distant spheres (Haines, Günther and Akenine-Möller, "Precision
    /// improvements for ray/sphere intersection", Ray Tracing Gems 2019, ch. 7).
    #[inline(always)]
    pub fn intersect(&self, o: V3, d: V3, t_max: f32) -> Option<f32> {
        let f = o - self.centre;
        let a = d.length2();
        let b = -f.dot(d);
        let nearest = f + d * (b / a);
        let discriminant = self.radius * self.radius - nearest.length2();
        if discriminant < 0.0 || a == 0.0 {
            return None;
        }
        let root = (a * discriminant).sqrt();
        let q = b + root.copysign(b);
        // |f|² - r² as a product, which keeps the digits near the surface.
        let distance = f.length();
        let c = (distance - self.radius) * (distance + self.radius);
        let (t0, t1) = if b > 0.0 { (c / q, q / a) } else { (q / a, c / q) };
        [t0, t1].into_iter().find(|&t| t > 0.0 && t <= t_max)
    }

    /// The surface nearest to `p`.
    #[inline(always)]
    pub fn surface(&self, p: V3) -> SurfacePoint {
        let n = (p - self.centre).normalize();
        let p = self.centre + n * self.radius;
        let error = (self.centre.abs() + V3::splat(self.radius)) * (8.0 * ROUNDING);
        SurfacePoint { p, ng: n, ns: n, error }
    }

    /// Lowest and highest corner.
    pub fn bounds(&self) -> [V3; 2] {
        let r = V3::splat(self.radius);
        [self.centre - r, self.centre + r]
    }
}
