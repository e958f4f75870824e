//! Numbers without a pattern, for tests: the same ones every time.

/// A linear congruential generator, of which the high bits are used.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    /// The next one, in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Three of them, in [-1, 1).
    pub(crate) fn point(&mut self) -> glam::DVec3 {
        glam::DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}
