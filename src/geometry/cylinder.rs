//! The exact cylinder with flat caps.

use super::SurfacePoint;
use super::ray_origin::UNIT_ROUNDOFF;
use crate::math::{Frame, V3};

/// A solid cylinder: base point, unit axis, height, radius.
///
/// It is hit as the convex body that it is, the common part of an endless cylinder and a slab, so
/// that no ray slips through the seam between side and cap.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// Centre of the base cap.
    pub base: V3,
    /// Height along the axis.
    pub height: f32,
    /// Radius.
    pub radius: f32,
    frame: Frame,
}

impl Cylinder {
    /// `axis` is unit; height and radius are above 0.
    pub fn new(base: V3, axis: V3, height: f32, radius: f32) -> Cylinder {
        Cylinder { base, height, radius, frame: Frame::around(axis) }
    }

    /// The unit axis.
    pub fn axis(&self) -> V3 {
        self.frame.n
    }

    /// Smallest distance t in (0, t_max] at which `o + t d` is on the surface.
    #[inline(always)]
    pub fn intersect(&self, o: V3, d: V3, t_max: f32) -> Option<f32> {
        let o = self.frame.to_local(o - self.base);
        let d = self.frame.to_local(d);
        // Slab between the caps.
        let (mut enter, mut leave) = (f32::NEG_INFINITY, f32::INFINITY);
        if d.z != 0.0 {
            let (a, b) = (-o.z / d.z, (self.height - o.z) / d.z);
            enter = a.min(b);
            leave = a.max(b);
        } else if o.z < 0.0 || o.z > self.height {
            return None;
        }
        // Endless cylinder, in the plane across the axis.
        let a = d.x * d.x + d.y * d.y;
        let distance = (o.x * o.x + o.y * o.y).sqrt();
        let c = (distance - self.radius) * (distance + self.radius);
        if a > 0.0 {
            let b = -(o.x * d.x + o.y * d.y);
            let (nx, ny) = (o.x + d.x * (b / a), o.y + d.y * (b / a));
            let discriminant = self.radius * self.radius - (nx * nx + ny * ny);
            if discriminant < 0.0 {
                return None;
            }
            let q = b + (a * discriminant).sqrt().copysign(b);
            // q has the sign of b, that of a zero included: from the axis itself b is one.
            let (t0, t1) = if q > 0.0 { (c / q, q / a) } else { (q / a, c / q) };
            enter = enter.max(t0);
            leave = leave.min(t1);
        } else if c > 0.0 {
            return None;
        }
        if enter > leave {
            return None;
        }
        [enter, leave].into_iter().find(|&t| t > 0.0 && t <= t_max)
    }

    /// The surface nearest to `p`, which is on it but for rounding.
    #[inline(always)]
    pub fn surface(&self, p: V3) -> SurfacePoint {
        let mut q = self.frame.to_local(p - self.base);
        let across = (q.x * q.x + q.y * q.y).sqrt();
        let size = self.radius + self.radius + self.height;
        let error = (self.base.abs() + V3::splat(size)) * (12.0 * UNIT_ROUNDOFF);
        // A point that rounding has put past the seam lies outside the other part, and what leaves
        // it would leave the cylinder: so none is closer to the seam than that.
        let seam = (error.max_component() * 2.0).min(self.radius.min(self.height) * 0.5);
        let side = (across - self.radius).abs();
        let n = if side <= q.z.abs().min((q.z - self.height).abs()) {
            let scale = self.radius / across;
            q.x *= scale;
            q.y *= scale;
            q.z = q.z.max(seam).min(self.height - seam);
            V3::new(q.x / self.radius, q.y / self.radius, 0.0)
        } else {
            let scale = ((self.radius - seam) / across).min(1.0);
            q.x *= scale;
            q.y *= scale;
            let top = q.z + q.z >= self.height;
            q.z = if top { self.height } else { 0.0 };
            V3::new(0.0, 0.0, if top { 1.0 } else { -1.0 })
        };
        let n = self.frame.to_world(n).normalize();
        let p = self.base + self.frame.to_world(q);
        SurfacePoint { p, ng: n, ns: n, error }
    }

    /// How high above the base a point is, and how far from the axis.
    pub(super) fn height_and_distance(&self, p: V3) -> (f32, f32) {
        let q = self.frame.to_local(p - self.base);
        (q.z, (q.x * q.x + q.y * q.y).sqrt())
    }

    /// The point at fractions `u`, `v` of turn and height on the side.
    pub fn side_point(&self, cos: f32, sin: f32, v: f32) -> V3 {
        let q = V3::new(cos * self.radius, sin * self.radius, v * self.height);
        self.base + self.frame.to_world(q)
    }

    /// A point `(x, y)` of the unit disc on the base cap (`top` false) or the top cap.
    pub fn cap_point(&self, x: f32, y: f32, top: bool) -> V3 {
        let z = if top { self.height } else { 0.0 };
        self.base + self.frame.to_world(V3::new(x * self.radius, y * self.radius, z))
    }

    /// Lowest and highest corner.
    pub fn bounds(&self) -> [V3; 2] {
        let n = self.axis();
        let aabb = |c: f32| (1.0 - c * c).max(0.0).sqrt() * self.radius;
        let e = V3::new(aabb(n.x), aabb(n.y), aabb(n.z));
        let top = self.base + n * self.height;
        let (a, b) = (self.base, top);
        let low = V3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z)) - e;
        let high = V3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z)) + e;
        [low, high]
    }
}
