//! A ray, and a question about one.

use crate::math::V3;

/// A ray `o + t d`; `d` need not be unit.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub o: V3,
    /// Direction.
    pub d: V3,
}

impl Ray {
    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> V3 {
        self.o + self.d * t
    }
}

/// A ray and how far it goes.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// Largest distance of a hit, in units of the ray's direction.
    pub t_max: f32,
}

/// Whether a ray is finite and has a direction that can be divided by.
pub(super) fn is_traceable(ray: &Ray) -> bool {
    let fastest = ray.d.abs().max_component();
    let finite = |v: V3| v.x.is_finite() && v.y.is_finite() && v.z.is_finite();
    finite(ray.o) && finite(ray.d) && fastest > 1e-18 && fastest < 1e18
}
