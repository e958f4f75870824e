//! A surface point of a path, seen from the side of the viewer.

use crate::geometry::{SurfacePoint, offset_origin};
use crate::math::{Frame, V3};

/// A surface hit by a path, turned to the viewer.
pub(super) struct PathPoint {
    pub(super) point: SurfacePoint,
    pub(super) ng: V3,
    pub(super) frame: Frame,
    /// Towards the viewer, in the frame; z > 0.
    pub(super) wo: V3,
}

impl PathPoint {
    /// `wo` is unit. The geometric normal decides the sides: both normals are turned to the
    /// viewer's, and the shading normal is bent until he sees it. `None` for a surface that is seen
    /// exactly edge on.
    #[inline(always)]
    pub(super) fn facing(point: SurfacePoint, wo: V3) -> Option<PathPoint> {
        let point = point.turned_to(wo);
        let frame = Frame::around(point.normal_for(wo).0);
        let wo = frame.to_local(wo);
        (wo.z > 0.0).then_some(PathPoint { point, ng: point.ng, frame, wo })
    }

    /// Where a ray in this direction starts.
    #[inline(always)]
    pub(super) fn leave(&self, d: V3) -> V3 {
        offset_origin(self.point.p, self.point.error, self.ng, d)
    }
}
