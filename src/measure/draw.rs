//! Random numbers for what is to be tried: scenes and their parameters.
//!
//! SplitMix64 (Steele, Lea and Flood 2014): any seed is as good as any other, and none has to do
//! with the numbers that the renderer draws.

use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// A sequence of independent numbers.
#[derive(Clone, Debug)]
pub(super) struct Draw(u64);

impl Draw {
    /// Sequence `seed` of the family `family`.
    pub(super) fn new(family: u64, seed: u64) -> Draw {
        let mut draw = Draw(family);
        draw.0 = draw.bits() ^ seed;
        draw.0 = draw.bits();
        draw
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In [low, high), uniform in its logarithm.
    pub(super) fn decades(&mut self, low: f64, high: f64) -> f64 {
        (self.within(low.ln(), high.ln())).exp()
    }

    /// A whole number below `count`.
    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// True with this probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// One of these.
    pub(super) fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// A unit direction, uniform over the sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        let z = self.within(-1.0, 1.0);
        let (sin, cos) = self.within(0.0, TAU).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    }

    /// A rotation, uniform over all of them (Shoemake 1992).
    pub(super) fn rotation(&mut self) -> DQuat {
        let u = self.unit();
        let (a, b) = (self.within(0.0, TAU).sin_cos(), self.within(0.0, TAU).sin_cos());
        let (p, q) = ((1.0 - u).sqrt(), u.sqrt());
        DQuat::from_xyzw(p * a.0, p * a.1, q * b.0, q * b.1).normalize()
    }

    /// A seed for something else.
    pub(super) fn seed(&mut self) -> u64 {
        self.bits()
    }
}
