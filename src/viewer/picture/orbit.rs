//! Moves of the camera: around a pivot, along the picture, towards it.

use burnish::scene::Camera;
use glam::{DQuat, DVec3};

/// The scene as the camera moves see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject {
    pub(crate) centre: DVec3,
    /// Half the diagonal of the bounding box; above 0.
    pub(crate) radius: f64,
}

impl Subject {
    /// The subject between the lowest and the highest corner of the scene.
    pub(crate) fn new([low, high]: [DVec3; 2]) -> Subject {
        let radius = ((high - low).length() * 0.5).max(f64::MIN_POSITIVE.sqrt());
        Subject { centre: (low + high) * 0.5, radius }
    }

    /// The point that the camera turns about where nothing else is meant: straight ahead, as far away as the
    /// scene's centre.
    pub(crate) fn pivot(&self, camera: &Camera) -> DVec3 {
        camera.eye - back(camera) * self.distance(camera)
    }

    fn distance(&self, camera: &Camera) -> f64 {
        (camera.eye - self.centre).dot(back(camera)).max(0.05 * self.radius)
    }
}

/// Turns about a point, which stays where it is in the picture: `yaw` about the world's Z, `pitch` about
/// the camera's X, in radians. Stops just before looking straight up or down, where the yaw would be
/// undefined.
pub(crate) fn orbit(camera: &Camera, pivot: DVec3, yaw: f64, pitch: f64) -> Camera {
    const POLE: f64 = 0.02;
    let polar = back(camera).z.clamp(-1.0, 1.0).acos();
    // A camera that already is beyond the stop may stay there, but not go on.
    let (low, high) = (POLE.min(polar), (std::f64::consts::PI - POLE).max(polar));
    // About X, a positive angle takes "back" away from Z when the camera stands upright.
    let upright = if camera.axes()[1].z < 0.0 { -1.0 } else { 1.0 };
    let pitch = upright * ((polar + upright * pitch).clamp(low, high) - polar);
    let [right, ..] = camera.axes();
    let turn = DQuat::from_rotation_z(yaw) * DQuat::from_axis_angle(right, pitch);
    placed(camera, pivot + turn * (camera.eye - pivot), turn * camera.orientation)
}

/// Moves along the picture: by `right` and `up` of the picture's height where the pivot is.
pub(crate) fn pan(camera: &Camera, pivot: DVec3, right: f64, up: f64) -> Camera {
    let [_, _, side] = camera.crop.parts();
    let height = 2.0 * camera.ry * side * (camera.eye - pivot).dot(back(camera));
    let [x, y, _] = camera.axes();
    placed(camera, camera.eye + (x * right + y * up) * height, camera.orientation)
}

/// Multiplies the distance to the pivot by `factor`.
pub(crate) fn dolly(camera: &Camera, subject: Subject, factor: f64) -> Camera {
    let ahead = subject.distance(camera) * (1.0 - factor);
    placed(camera, camera.eye - back(camera) * ahead, camera.orientation)
}

fn back(camera: &Camera) -> DVec3 {
    camera.axes()[2]
}

/// The camera there, or the old one where that is out of reach.
fn placed(camera: &Camera, eye: DVec3, orientation: DQuat) -> Camera {
    camera.moved(eye, orientation).unwrap_or(*camera)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBJECT: Subject = Subject { centre: DVec3::new(1.0, 2.0, 3.0), radius: 2.0 };

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(7.0, -4.0, 6.0), SUBJECT.centre, 0.4).unwrap()
    }

    #[test]
    fn an_orbit_keeps_the_distance_the_horizon_and_the_pivot() {
        let before = camera();
        let after = orbit(&before, SUBJECT.pivot(&before), 0.7, -0.2);
        let distance = |c: &Camera| (c.eye - SUBJECT.centre).length();
        assert!((distance(&before) - distance(&after)).abs() < 1e-12);
        assert!(after.axes()[0].z.abs() < 1e-12, "the horizon tilts");
        assert!((SUBJECT.pivot(&before) - SUBJECT.pivot(&after)).length() < 1e-12);
        assert!((before.eye - after.eye).length() > 1.0);
    }

    #[test]
    fn an_orbit_back_is_the_same_camera() {
        for pivot in [SUBJECT.centre, DVec3::new(-3.0, 0.5, 1.0)] {
            let there = orbit(&camera(), pivot, 0.3, 0.1);
            let back = orbit(&there, pivot, -0.3, -0.1);
            assert!((camera().eye - back.eye).length() < 1e-12);
        }
    }

    /// Wherever the pivot is, an orbit and a pan keep it under the pointer.
    #[test]
    fn what_is_held_stays_under_the_pointer() {
        let size = [200, 100];
        let at = |c: &Camera, p: DVec3| {
            c.project(p, p + (p - c.eye) * 0.5, size).expect("out of sight")[0]
        };
        for pivot in [DVec3::new(2.0, 1.0, 3.5), DVec3::new(-0.5, 4.0, 2.0)] {
            let before = at(&camera(), pivot);
            let turned = at(&orbit(&camera(), pivot, 0.4, 0.15), pivot);
            assert!((before[0] - turned[0]).hypot(before[1] - turned[1]) < 1e-9);
            let panned = at(&pan(&camera(), pivot, 0.1, -0.05), pivot);
            let moved = [panned[0] - before[0], panned[1] - before[1]];
            assert!((moved[0] + 10.0).hypot(moved[1] + 5.0) < 1e-9, "{moved:?}");
        }
    }

    #[test]
    fn the_poles_are_never_crossed() {
        for pitch in [10.0, -10.0] {
            let mut c = camera();
            for _ in 0..5 {
                c = orbit(&c, SUBJECT.centre, 0.0, pitch);
                assert!(c.axes()[1].z > 0.0, "upside down after {pitch}");
                assert!(c.axes()[0].z.abs() < 1e-9, "tilted after {pitch}");
            }
        }
    }

    #[test]
    fn a_positive_pitch_lowers_the_eye() {
        assert!(orbit(&camera(), SUBJECT.centre, 0.0, 0.1).eye.z < camera().eye.z);
    }

    #[test]
    fn a_pan_by_the_height_moves_the_picture_by_its_height() {
        let before = camera();
        let after = pan(&before, SUBJECT.pivot(&before), 0.0, 1.0);
        // The pivot was in the middle; now it lies on the lower edge, where sy = -1 ... and one
        // more half height: the tangent there is twice ry.
        let to = SUBJECT.pivot(&before) - after.eye;
        let [_, y, z] = after.axes();
        assert!((to.dot(y) / to.dot(z) - 2.0 * before.ry).abs() < 1e-12);
    }

    #[test]
    fn a_dolly_keeps_the_direction_and_never_arrives() {
        let mut c = camera();
        for _ in 0..200 {
            c = dolly(&c, SUBJECT, 0.5);
        }
        assert!((c.orientation.dot(camera().orientation).abs() - 1.0).abs() < 1e-12);
        assert!(c.eye.is_finite());
    }

    #[test]
    fn a_point_like_scene_keeps_everything_finite() {
        let subject = Subject::new([DVec3::ZERO, DVec3::ZERO]);
        let c = camera();
        for pivot in [subject.pivot(&c), c.eye] {
            for c in [dolly(&c, subject, 0.0), pan(&c, pivot, 9.0, 9.0), orbit(&c, pivot, 9.0, 9.0)]
            {
                assert!(c.eye.is_finite() && c.orientation.is_finite());
            }
        }
    }
}
