//! The pinhole camera of the `.scn` format.

use super::{Crop, MAX_COORDINATE};
use crate::plain::number;
use glam::{DMat3, DQuat, DVec3};
use thiserror::Error;

/// Where the picture is taken from. World units; right-handed, Z up.
///
/// The ray of picture coordinates (sx, sy) in -1..=1, sy upwards, has the direction
/// `normalize(sx rx X + sy ry Y - Z)` where X Y Z are the axes rotated by `orientation` and
/// `rx = ry * width / height`. Of that picture only the crop is taken, which a line of a `.scn` file has no
/// words for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub eye: DVec3,
    /// Tangent of half the vertical field of view.
    pub ry: f64,
    /// Takes camera space (looking along -Z, Y up) to world space. Unit length.
    pub orientation: DQuat,
    /// The part of the picture that is taken.
    pub crop: Crop,
}

/// A camera that takes no picture.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum CameraError {
    /// The field of view is not between 0 and 180 degrees.
    #[error(
        "ry, the tangent of half the vertical field of view, must be from 1e-6 to 1e4, not {0}"
    )]
    FieldOfView(f64),
    /// The eye is not a point within reach.
    #[error(
        "the eye must be three finite numbers of at most 1e18 in size, not {} {} {}",
        number(*.0), number(*.1), number(*.2)
    )]
    Eye(f64, f64, f64),
}

impl Camera {
    /// Checks and normalises.
    pub fn new(eye: DVec3, ry: f64, orientation: DQuat) -> Result<Camera, CameraError> {
        if !(1e-6..=1e4).contains(&ry) {
            return Err(CameraError::FieldOfView(ry));
        }
        if !eye.to_array().iter().all(|x| x.abs() <= MAX_COORDINATE) {
            return Err(CameraError::Eye(eye.x, eye.y, eye.z));
        }
        // What is unit stays as it is: a camera is read back from its line with the same bits.
        let unit = (orientation.length_squared() - 1.0).abs() <= 1e-15;
        let orientation = if unit { orientation } else { orientation.normalize() };
        Ok(Camera { eye, ry, orientation, crop: Crop::WHOLE })
    }

    /// The same elsewhere: field of view and crop stay.
    pub fn moved(&self, eye: DVec3, orientation: DQuat) -> Result<Camera, CameraError> {
        Ok(Camera { crop: self.crop, ..Camera::new(eye, self.ry, orientation)? })
    }

    /// From `eye` towards `target`, Z up where that is possible.
    pub fn look_at(eye: DVec3, target: DVec3, ry: f64) -> Result<Camera, CameraError> {
        let back = (eye - target).try_normalize().unwrap_or(DVec3::Y);
        let right = DVec3::Z.cross(back).try_normalize().unwrap_or(DVec3::X);
        let axes = DMat3::from_cols(right, back.cross(right), back);
        Camera::new(eye, ry, DQuat::from_mat3(&axes))
    }

    /// Sees the whole box `[low, high]` from a three-quarter view, with a small margin.
    pub fn framing(low: DVec3, high: DVec3, aspect: f64) -> Camera {
        let ry: f64 = 0.35;
        let centre = (low + high) * 0.5;
        let radius = ((high - low).length() * 0.5).max(1e-12 * (1.0 + centre.length()));
        let narrow = ry * aspect.min(1.0);
        let distance = 1.02 * radius * (1.0 + narrow * narrow).sqrt() / narrow;
        let towards = DVec3::new(0.55, -1.0, 0.45).normalize();
        Camera::look_at(centre + towards * distance, centre, ry).unwrap_or(Camera {
            eye: DVec3::ZERO,
            ry,
            orientation: DQuat::IDENTITY,
            crop: Crop::WHOLE,
        })
    }

    /// The unit axes X (right), Y (up) and Z (backwards) in world space.
    pub fn axes(&self) -> [DVec3; 3] {
        [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.orientation * axis)
    }

    /// Where a straight line from one world point to another is drawn in a picture of this many
    /// pixels: both ends in pixels from the top left corner, cut where the line passes the eye's
    /// plane. `None` if all of it is behind the eye or an end is not finite.
    pub fn project(&self, from: DVec3, to: DVec3, size: [u32; 2]) -> Option<[[f64; 2]; 2]> {
        // The least depth that is drawn, as a part of the line's larger distance from the eye.
        const NEAR: f64 = 1e-4;
        let [x, y, z] = self.axes();
        let seen = |p: DVec3| {
            let p = p - self.eye;
            DVec3::new(p.dot(x), p.dot(y), -p.dot(z))
        };
        let [a, b] = [seen(from), seen(to)];
        let near = NEAR * a.length().max(b.length());
        if !a.is_finite() || !b.is_finite() || a.z.max(b.z) <= near {
            return None;
        }
        let cut = |p: DVec3, other: DVec3| {
            if p.z > near { p } else { p.lerp(other, (near - p.z) / (other.z - p.z)) }
        };
        let [w, h] = size.map(f64::from);
        let pixel = |p: DVec3| {
            let scale = 0.5 * h / (self.ry * p.z);
            let [left, top, side] = self.crop.parts();
            let whole = [0.5 * w + p.x * scale, 0.5 * h - p.y * scale];
            [(whole[0] - left * w) / side, (whole[1] - top * h) / side]
        };
        Some([pixel(cut(a, b)), pixel(cut(b, a))])
    }

    /// The `camera` line of a `.scn` file, which reads back to this camera.
    pub fn scn_line(&self) -> String {
        let (e, q) = (self.eye, self.orientation);
        format!("camera {} {} {} {} q {} {} {} {}", e.x, e.y, e.z, self.ry, q.w, q.x, q.y, q.z)
    }
}
