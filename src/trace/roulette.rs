//! When a path may end by chance.

use crate::math::Simd;

/// First scattering event after which a path may be ended.
pub(super) const FROM: u32 = 1;
/// A path goes on for certain while its throughput is above the inverse of this. Measured on the
/// built-in scene from the first event on: 2.5 has 7 % less error for equal time, 1 a seventh more,
/// for every path that ends by chance costs the stratification.
const MILDNESS: f32 = 1.5;
/// From this event on even a bright path may end, so that none is endless: event k with a chance of
/// 2 / (k + 64). A constant chance q would leave the variance without bound wherever the albedo's
/// square exceeds 1 - q; one that falls like this leaves it finite for every albedo below 1, and a
/// path in a white room has 74 rays on the mean.
const ALWAYS_FROM: u32 = 8;

/// The chance to go on after this event, for paths whose throughput's largest channel is this.
#[inline(always)]
pub(super) fn survival<L: Simd>(event: u32, throughput: L) -> L {
    let most = if event < ALWAYS_FROM { 1.0 } else { 1.0 - 2.0 / (event as f32 + 64.0) };
    (throughput * L::splat(MILDNESS)).min(L::splat(most))
}
