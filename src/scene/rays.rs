//! Camera rays in the scene's local units.

use super::{Camera, Placement};
use crate::geometry::Ray;
use crate::math::{Simd, V3};

/// A camera made ready for a picture size.
#[derive(Clone, Copy, Debug)]
pub struct CameraRays {
    eye: V3,
    right: V3,
    up: V3,
    back: V3,
    /// Picture coordinates of a pixel step: 2 / size.
    step: [f32; 2],
}

impl CameraRays {
    /// For a scene placed by `placement` and a picture of this many pixels.
    pub fn new(camera: &Camera, placement: Placement, size: [u32; 2]) -> CameraRays {
        let [x, y, z] = camera.axes();
        let rx = camera.ry * size[0] as f64 / size[1] as f64;
        // Of the crop; nothing changes where that is the whole.
        let [_, _, side] = camera.crop.parts();
        let [right, up] = camera.crop.middle();
        let ahead = z - x * (rx * right) - y * (camera.ry * up);
        let local = |v: glam::DVec3| V3::from(v.as_vec3().to_array());
        CameraRays {
            eye: local(placement.to_local(camera.eye)),
            right: local(x * (rx * side)),
            up: local(y * (camera.ry * side)),
            back: local(ahead),
            step: size.map(|s| 2.0 / s as f32),
        }
    }

    /// The ray through pixel coordinates `x`, `y`, whose whole numbers are the corners of pixels,
    /// y counted from the top. Its direction is unit.
    #[inline(always)]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        Ray { o: self.eye, d: self.direction(x, y) }
    }

    /// Where all rays start.
    pub(crate) fn eye(&self) -> V3 {
        self.eye
    }

    /// Half the diagonal of a pixel one unit in front of the eye: what lies at some distance is as
    /// far from the ray through the middle as this times the distance, or nearer.
    pub(crate) fn pixel_radius(&self) -> f32 {
        let [x, y] = self.step;
        0.5 * (self.right.length() * x).hypot(self.up.length() * y)
    }

    /// The directions of rays, as [`CameraRays::ray`]'s.
    #[inline(always)]
    pub(crate) fn direction<L: Simd>(&self, x: L, y: L) -> V3<L> {
        let one = L::splat(1.0);
        let sx = x * L::splat(self.step[0]) - one;
        let sy = one - y * L::splat(self.step[1]);
        let d =
            self.right.splat_lanes() * sx + self.up.splat_lanes() * sy - self.back.splat_lanes();
        d.normalize()
    }
}
