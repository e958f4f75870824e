//! Traversal.
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
    #[inline]
    pub fn at(&self, t: f32) -> V3 {
        self.o + self.d * t
    }
}
