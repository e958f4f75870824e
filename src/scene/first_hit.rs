//! The first surface behind a point of the picture, as the tracer sees it.

use super::{Camera, CameraRays, MaterialId, Scene};
use crate::geometry::Kind;
use glam::DVec3;

/// Where a camera ray meets its first surface. World space; directions are unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Whose surface.
    pub material: MaterialId,
    /// Which shape, by its index among those of its kind.
    pub shape: Kind,
    /// The point.
    pub point: DVec3,
    /// From the eye, in world units.
    pub distance: f64,
    /// Geometric normal, on the viewer's side.
    pub ng: DVec3,
    /// Shading normal: on the viewer's side, and bent where it would be seen from behind.
    pub ns: DVec3,
    /// Angle between the shading normal and the direction to the viewer in radians, 0 to pi/2.
    pub theta_o: f64,
}

impl Scene {
    /// What is met first through a point of the picture, in pixels from its top left corner;
    /// `None` where nothing is.
    pub fn first_hit(&self, camera: &Camera, size: [u32; 2], [x, y]: [f32; 2]) -> Option<FirstHit> {
        let ray = CameraRays::new(camera, self.placement, size).ray(x, y);
        let mut stack = self.stack();
        let hit = self.bvh.closest(&self.geometry, &ray, f32::INFINITY, &mut stack)?;
        let wo = -ray.d;
        let surface = self.geometry.surface(&ray, &hit).turned_to(wo);
        let ns = surface.normal_for(wo).0;
        let wide = |v: crate::math::V3| DVec3::new(v.x.into(), v.y.into(), v.z.into());
        let point = self.placement.to_world(wide(surface.p));
        // By both sine and cosine: either alone loses its digits at one end.
        let theta_o = f64::from(ns.cross(wo).length()).atan2(f64::from(ns.dot(wo).max(0.0)));
        Some(FirstHit {
            material: self.geometry.material(hit.primitive),
            shape: self.geometry.kind(hit.primitive),
            point,
            distance: (point - camera.eye).length(),
            ng: wide(surface.ng),
            ns: wide(ns),
            theta_o,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Material, SceneBuilder};
    use super::*;

    /// A ball of radius 2 about (1, 5, 3), seen from the origin's side.
    fn ball() -> (Scene, Camera) {
        let mut b = SceneBuilder::new("ball");
        let grey = b.material(Material::reflecting("grey", [0.5; 3], [0.1; 3], 10.0).unwrap());
        b.sphere(DVec3::new(1.0, 5.0, 3.0), 2.0, grey).unwrap();
        let camera = Camera::look_at(DVec3::new(1.0, -5.0, 3.0), DVec3::new(1.0, 5.0, 3.0), 0.5);
        (b.build(), camera.unwrap())
    }

    #[test]
    fn a_ball_is_met_where_geometry_says() {
        let (scene, camera) = ball();
        let hit = scene.first_hit(&camera, [200, 100], [100.0, 50.0]).unwrap();
        assert_eq!((hit.material, hit.shape), (0, Kind::Sphere(0)));
        assert!((hit.point - DVec3::new(1.0, 3.0, 3.0)).length() < 1e-6);
        assert!((hit.distance - 8.0).abs() < 1e-6);
        assert!((hit.ns - DVec3::NEG_Y).length() < 1e-6 && hit.theta_o < 1e-6);
        // Off the middle: law of sines in the triangle of eye, centre and point.
        let hit = scene.first_hit(&camera, [200, 100], [115.0, 50.0]).unwrap();
        let slope: f64 = 0.5 * 15.0 / 50.0;
        let sin = 10.0 * slope.atan().sin() / 2.0;
        assert!((hit.theta_o - sin.asin()).abs() < 1e-5, "{}", hit.theta_o);
        assert!(scene.first_hit(&camera, [200, 100], [1.0, 1.0]).is_none());
    }

    #[test]
    fn a_point_is_drawn_where_its_ray_went_through() {
        let (scene, camera) = ball();
        for pixel in [[100.0, 50.0], [115.0, 50.0], [93.5, 61.25]] {
            let hit = scene.first_hit(&camera, [200, 100], pixel).unwrap();
            let beyond = hit.point + (hit.point - camera.eye) * 0.5;
            for [from, to] in [[hit.point, beyond], [beyond, hit.point]] {
                for at in camera.project(from, to, [200, 100]).unwrap() {
                    let error = (at[0] - f64::from(pixel[0])).hypot(at[1] - f64::from(pixel[1]));
                    assert!(error < 1e-3, "{pixel:?}: {at:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_behind_the_eye_is_cut_off() {
        let (_, camera) = ball();
        let behind = camera.eye + DVec3::new(0.0, -3.0, 0.0);
        assert!(camera.project(behind, behind + DVec3::X, [200, 100]).is_none());
        let ahead = camera.eye + DVec3::new(1.0, 4.0, 0.0);
        let [start, end] = camera.project(behind, ahead, [200, 100]).unwrap();
        assert!((end[0] - (100.0 + 50.0 / 0.5 / 4.0)).abs() < 1e-9 && (end[1] - 50.0).abs() < 1e-9);
        assert!(start.iter().all(|x| x.is_finite()));
        for odd in [DVec3::splat(f64::NAN), DVec3::splat(f64::INFINITY)] {
            assert!(camera.project(odd, ahead, [200, 100]).is_none());
        }
    }
}
