//! Where secondary rays start.
//!
//! A hit point is known to within an error bound; a ray that leaves from the point itself could
//! meet its own surface again, or start behind it. So it starts off the surface, along the
//! geometric normal, by as much as the bound demands and no more: there is no absolute epsilon,
//! and scenes of any size behave alike (after pbrt-v4, section 6.8; the bounds are our own).

use crate::math::V3;

/// The relative error of one rounding, 2^-24.
pub(super) const ROUNDING: f32 = f32::EPSILON * 0.5;

/// The point moved off its surface to the side of `towards`. `error` bounds the point's error in
/// each component and that of meeting the surface again; `ng` is unit.
#[inline(always)]
pub fn offset_origin(p: V3, error: V3, ng: V3, towards: V3) -> V3 {
    let distance = ng.abs().dot(error);
    let offset = if ng.dot(towards) >= 0.0 { ng * distance } else { -(ng * distance) };
    // The sum itself is rounded: go on by one more rounding.
    let step = |p: f32, o: f32| {
        let q = p + o;
        q + (q.abs() * f32::EPSILON).copysign(o)
    };
    V3::new(step(p.x, offset.x), step(p.y, offset.y), step(p.z, offset.z))
}
