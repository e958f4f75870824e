//! Camera rays in the scene's local units.

use super::{Camera, Placement};
use crate::geometry::Ray;
use crate::math::V3;

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
        let local = |v: glam::DVec3| V3::from(v.as_vec3().to_array());
        CameraRays {
            eye: local(placement.to_local(camera.eye)),
            right: local(x * rx),
            up: local(y * camera.ry),
            back: local(z),
            step: size.map(|s| 2.0 / s as f32),
        }
    }

    /// The ray through pixel coordinates `x`, `y`, whose whole numbers are the corners of pixels,
    /// y counted from the top. Its direction is unit.
    #[inline(always)]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let sx = x * self.step[0] - 1.0;
        let sy = 1.0 - y * self.step[1];
        let d = self.right * sx + self.up * sy - self.back;
        Ray { o: self.eye, d: d.normalize() }
    }
}
