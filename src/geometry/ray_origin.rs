//! Where secondary rays start.
//!
//! A hit point is known to within an error bound; a ray that leaves from the point itself could
//! hit its own surface again, or start behind it. So it starts off the surface, along the
//! geometric normal, by as much as the bound demands and no more: there is no absolute epsilon,
//! and scenes of any size behave alike (after pbrt-v4, section 6.8; the bounds are our own).

use crate::math::{Simd, V3};

/// The relative error of one rounding, 2^-24.
pub(super) const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// The point moved off its surface to the side of `towards`. `error` bounds the point's error in
/// each component and that of hitting the surface again; `ng` is unit.
#[inline(always)]
pub fn offset_origin<L: Simd>(p: V3<L>, error: V3<L>, ng: V3<L>, towards: V3<L>) -> V3<L> {
    let distance = ng.abs().dot(error);
    let outwards = ng * distance;
    let same_side = ng.dot(towards).ge(L::splat(0.0));
    let offset = V3::select(same_side, outwards, -outwards);
    V3::new(step(p.x, offset.x), step(p.y, offset.y), step(p.z, offset.z))
}

/// The sum itself is rounded: goes on by one more rounding.
#[inline(always)]
fn step<L: Simd>(p: L, o: L) -> L {
    let q = p + o;
    q + (q.abs() * L::splat(f32::EPSILON)).copysign(o)
}
