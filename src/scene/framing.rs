//! Where a camera has to be to see something, without leaving the room that it is in.

use super::{Camera, MaterialId, Scene};
use crate::geometry::Ray;
use crate::math::V3;
use glam::DVec3;

/// Directions in which a room is looked for: an opening of a two-hundredth of the sphere is found.
const DIRECTIONS: usize = 400;
/// Part of the way to a wall that a camera goes at most.
const SHORT_OF: f64 = 0.95;

impl Scene {
    /// Lowest and highest corner in world units of the surfaces of a material, to f32 of the scene's
    /// size; `None` where there are none.
    pub fn bounds_of(&self, material: MaterialId) -> Option<[DVec3; 2]> {
        let of = |primitive: &u32| self.geometry.material(*primitive) == material;
        let boxes = (0..self.geometry.len() as u32).filter(of).map(|p| self.geometry.bounds(p));
        let [low, high] = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])?;
        let world = |v: V3| self.placement.to_world(DVec3::new(v.x.into(), v.y.into(), v.z.into()));
        Some([world(low), world(high)])
    }

    /// Distance in world units from a point to the first surface in a direction of any length; `None`
    /// where there is none.
    fn clearance(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let local = |v: DVec3| V3::from(v.as_vec3().to_array());
        let d = local(direction.try_normalize()?);
        let ray = Ray { o: local(self.placement.to_local(from)), d };
        let mut stack = self.stack();
        let hit = self.bvh.closest(&self.geometry, &ray, f32::INFINITY, &mut stack)?;
        Some(f64::from(hit.t) / self.placement.scale())
    }

    /// Whether there are surfaces in all directions from a point: 400 are tried, evenly spread (a
    /// Fibonacci lattice; Gonzalez 2010).
    pub fn is_enclosed(&self, point: DVec3) -> bool {
        (0..DIRECTIONS).all(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
            let phi = i as f64 * std::f64::consts::PI * (3.0 - 5f64.sqrt());
            let r = (1.0 - z * z).sqrt();
            self.clearance(point, DVec3::new(r * phi.cos(), r * phi.sin(), z)).is_some()
        })
    }

    /// A camera that looks in the same direction, from where the box from lowest to highest corner, in
    /// world units, is seen with a small margin. A camera in a closed room stays in it: as far back as
    /// its wall allows. One that has left the room of the scene's own camera comes back to it.
    pub fn framed(&self, camera: &Camera, aspect: f64, [low, high]: [DVec3; 2]) -> Camera {
        let centre = (low + high) * 0.5;
        let radius = ((high - low).length() * 0.5).max(f64::MIN_POSITIVE.sqrt());
        let back = camera.axes()[2];
        // The bounding sphere touches the nearer pair of the pyramid's sides.
        let narrow = camera.ry * aspect.min(1.0);
        let distance = 1.02 * radius * (1.0 + narrow * narrow).sqrt() / narrow;
        let wanted = centre + back * distance;
        let homes = [camera.eye, self.camera.eye];
        let eye = match homes.into_iter().find(|&eye| self.is_enclosed(eye)) {
            Some(home) => self.short_of_walls(home, [centre + back * radius, wanted]),
            None => wanted,
        };
        Camera::new(eye, camera.ry, camera.orientation).unwrap_or(*camera)
    }

    /// The way to a place as far as nothing is in it: from a nearer place, if that is in a room, else
    /// from where the camera is at home.
    fn short_of_walls(&self, home: DVec3, [near, wanted]: [DVec3; 2]) -> DVec3 {
        let from = if self.is_enclosed(near) { near } else { home };
        let way = wanted - from;
        match self.clearance(from, way) {
            Some(clear) if clear * SHORT_OF < way.length() => {
                from + way * (clear * SHORT_OF / way.length())
            }
            _ => wanted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Material, SceneBuilder};
    use super::*;
    use crate::math::numbers::Numbers;

    fn grey(name: &str) -> Material {
        Material::reflecting(name, [0.5; 3], [0.1; 3], 10.0).unwrap()
    }

    /// A closed room from -4 to 4 along each axis, somewhere, with a ball of radius .5 in it.
    fn room(at: DVec3, ball: DVec3) -> Scene {
        let mut b = SceneBuilder::new("room");
        let (walls, marble) = (b.material(grey("walls")), b.material(grey("marble")));
        b.cuboid(at - 4.0, DVec3::splat(8.0), walls).unwrap();
        b.sphere(at + ball, 0.5, marble).unwrap();
        b.build()
    }

    fn inside(at: DVec3, eye: DVec3) -> bool {
        (eye - at).abs().max_element() < 4.0
    }

    #[test]
    fn a_camera_in_a_room_sees_what_it_frames_and_stays_in_it() {
        let mut numbers = Numbers(3);
        for _ in 0..300 {
            let mut point = |r: f64| {
                DVec3::new(numbers.next() - 0.5, numbers.next() - 0.5, numbers.next() - 0.5)
                    * (2.0 * r)
            };
            let (at, ball, eye) = (point(50.0), point(3.0), point(3.9));
            if (eye - ball).length() < 0.6 {
                continue;
            }
            let scene = room(at, ball);
            let camera = Camera::look_at(at + eye, at + ball, 0.4).unwrap();
            for material in 0..2 {
                let box_ = scene.bounds_of(material).unwrap();
                let framed = scene.framed(&camera, 1.3, box_);
                assert!(inside(at, framed.eye), "{eye} {ball} {material}: {}", framed.eye - at);
                assert_eq!(framed.orientation, camera.orientation);
            }
            // The ball has room enough around it, or a wall is close behind the camera.
            let framed = scene.framed(&camera, 1.3, scene.bounds_of(1).unwrap());
            let hit = scene.first_hit(&framed, [130, 100], [65.0, 50.0]).unwrap();
            assert_eq!(hit.material, 1, "{eye} {ball}");
            // From outside it comes back.
            let outside = Camera::new(at + eye * 30.0, 0.4, camera.orientation).unwrap();
            let mut scene = scene;
            scene.camera = camera;
            let framed = scene.framed(&outside, 1.3, scene.bounds());
            assert!(inside(at, framed.eye), "{eye} {ball}");
        }
    }

    #[test]
    fn what_is_in_the_open_is_seen_whole() {
        let mut b = SceneBuilder::new("two");
        let (left, right) = (b.material(grey("left")), b.material(grey("right")));
        b.sphere(DVec3::new(-1.0, 0.0, 0.0), 0.5, left).unwrap();
        b.sphere(DVec3::new(7.0, 2.0, 0.0), 1.5, right).unwrap();
        let scene = b.build();
        let camera = Camera::look_at(DVec3::new(3.0, -9.0, 2.0), DVec3::ZERO, 0.4).unwrap();
        for (material, centre, radius) in
            [(0, DVec3::new(-1.0, 0.0, 0.0), 0.5), (1, DVec3::new(7.0, 2.0, 0.0), 1.5)]
        {
            let [low, high] = scene.bounds_of(material).unwrap();
            assert!((low - (centre - radius)).length() < 1e-5);
            assert!((high - (centre + radius)).length() < 1e-5);
            for aspect in [0.3, 1.0, 3.0] {
                let framed = scene.framed(&camera, aspect, [low, high]);
                let to = centre - framed.eye;
                let [x, y, z] = framed.axes();
                assert!(to.dot(x).abs() < 1e-5 && to.dot(y).abs() < 1e-5);
                // The ball around the box touches the pyramid's sides, but for two per cent.
                let narrow = camera.ry * aspect.min(1.0);
                let half = -to.dot(z) * narrow / narrow.hypot(1.0);
                let ratio = half / (radius * 3f64.sqrt());
                assert!((1.0..1.05).contains(&ratio), "{aspect}: {ratio}");
            }
        }
        assert!(scene.bounds_of(2).is_none());
        assert!(!scene.is_enclosed(DVec3::ZERO) && scene.is_enclosed(DVec3::new(7.0, 2.0, 0.0)));
    }

    #[test]
    fn nothing_and_a_point_are_framed_without_a_fault() {
        let scene = SceneBuilder::new("empty").build();
        let camera = Camera::look_at(DVec3::splat(3.0), DVec3::ZERO, 0.4).unwrap();
        for place in [DVec3::ZERO, DVec3::splat(1e9), DVec3::splat(f64::NAN)] {
            let framed = scene.framed(&camera, 1.0, [place, place]);
            assert!(framed.eye.is_finite() && framed.orientation.is_finite());
        }
    }
}
