//! Rectangles by the solid angle that they fill (Ureña, Fajardo and King, "An area-preserving
//! parametrization for spherical rectangles", EGSR 2013).
//!
//! The solid angle is a sum of four corners' `atan(x y / (z r))`, each of which keeps its digits,
//! and not of angles near 2 pi.

use crate::math::V3;
use crate::math::simd::Simd;
use crate::math::special::{atan_ratio, sin_cos_2pi};
use std::f32::consts::{FRAC_1_PI, PI};

/// A rectangle as seen from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalRectangle<L> {
    /// From the point to the first and to the opposite corner, along the sides and the normal.
    x: [L; 2],
    y: [L; 2],
    z: L,
    axes: [V3<L>; 2],
    /// Cosines of the planes through the point and the sides along x.
    b: [L; 2],
    /// The angle at which the sampled one starts.
    start: L,
    /// In sr.
    pub(super) solid_angle: L,
}

// Not closures: one that is called more than once is compiled by itself, for no instruction set.

/// A corner's part of the solid angle.
#[inline(always)]
fn corner_angle<L: Simd>(x: L, y: L, z: L) -> L {
    atan_ratio(x * y, z * (x * x + y * y + z * z).sqrt())
}

/// `y` over the length of what has `y` across a vector whose square is `d2`.
#[inline(always)]
fn lean<L: Simd>(y: L, d2: L) -> L {
    y / (y * y + d2).sqrt()
}

impl<L: Simd> SphericalRectangle<L> {
    /// A rectangle from its first corner, its sides and its unit normal (of either side), seen from
    /// `p`, which is not in its plane.
    #[inline(always)]
    pub(super) fn new(
        corner: V3<L>,
        sides: [V3<L>; 2],
        ng: V3<L>,
        p: V3<L>,
    ) -> SphericalRectangle<L> {
        let one = L::splat(1.0);
        let lengths = [sides[0].length(), sides[1].length()];
        let axes = [sides[0] * (one / lengths[0]), sides[1] * (one / lengths[1])];
        let away = corner - p;
        let (x0, y0) = (away.dot(axes[0]), away.dot(axes[1]));
        let (x, y) = ([x0, x0 + lengths[0]], [y0, y0 + lengths[1]]);
        let z = away.dot(ng).abs();
        let z2 = z * z;
        let [a00, a01] = [corner_angle(x[0], y[0], z), corner_angle(x[0], y[1], z)];
        let [a10, a11] = [corner_angle(x[1], y[0], z), corner_angle(x[1], y[1], z)];
        SphericalRectangle {
            x,
            y,
            z,
            axes,
            b: [-lean(y[0], z2), lean(y[1], z2)],
            start: L::splat(PI) + a01 - a00,
            solid_angle: (a11 - a01) - (a10 - a00),
        }
    }

    /// Towards a point of the rectangle, not of unit length: uniform over its directions.
    #[inline(always)]
    pub(super) fn sample(&self, [u, v]: [L; 2], ng_towards: V3<L>) -> V3<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let SphericalRectangle { x, y, z, axes, b, .. } = *self;
        let turn = (u * self.solid_angle + self.start) * L::splat(0.5 * FRAC_1_PI);
        let (sin, cos) = sin_cos_2pi(turn);
        let f = (cos * b[0] - b[1]) / sin;
        // c² = 1 - b0² without cancellation.
        let c = z / (y[0] * y[0] + z * z).sqrt();
        let size = ((f.abs() - c) * (f.abs() + c)).max(L::splat(1e-30)).sqrt();
        let along = (z / size).copysign(f).max(x[0]).min(x[1]);
        let d2 = along * along + z * z;
        let (h0, h1) = (lean(y[0], d2), lean(y[1], d2));
        let h = h0 + v * (h1 - h0);
        let rest = ((one - h) * (one + h)).max(zero);
        let across = (h * d2.sqrt() / rest.max(L::splat(1e-30)).sqrt()).max(y[0]).min(y[1]);
        axes[0] * along + axes[1] * across + ng_towards * z
    }
}
