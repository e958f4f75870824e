//! The box around a primitive.

use crate::geometry::{Geometry, Kind};
use crate::math::V3;

/// Lowest and highest corner.
pub(in crate::geometry) fn primitive_bounds(geometry: &Geometry, primitive: u32) -> [V3; 2] {
    match geometry.kind(primitive) {
        Kind::Triangle(i) => {
            let [a, b, c] = geometry.corners(i);
            let low = |f: fn(V3) -> f32| f(a).min(f(b)).min(f(c));
            let high = |f: fn(V3) -> f32| f(a).max(f(b)).max(f(c));
            [
                V3::new(low(|v| v.x), low(|v| v.y), low(|v| v.z)),
                V3::new(high(|v| v.x), high(|v| v.y), high(|v| v.z)),
            ]
        }
        Kind::Sphere(i) => geometry.spheres[i].bounds(),
        Kind::Cylinder(i) => geometry.cylinders[i].bounds(),
    }
}
