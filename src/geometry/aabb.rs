//! Boxes, hit by as many rays at a time as a register holds: what misses one is done with all that
//! is in it.

use super::ray_origin::UNIT_ROUNDOFF;
use crate::math::V3;
use crate::math::simd::{Simd, SimdWide};
use std::array::from_fn;

/// By how much boxes are taken to be larger for a ray from `o`: three times what the roundings of a
/// box test, fused or not, and of the triangle test's shear add up to, for points of the scene, whose
/// coordinates are within 1.
#[inline(always)]
pub(super) fn box_margin<L: Simd>(o: V3<L>) -> L {
    (o.abs().max_component() + L::splat(1.0)) * L::splat(32.0 * UNIT_ROUNDOFF)
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Aabb {
    pub(crate) centre: V3,
    /// Half its size.
    pub(crate) half: V3,
}

impl Aabb {
    /// The box around these.
    pub(crate) fn around(boxes: impl Iterator<Item = Aabb>) -> Option<Aabb> {
        let corners = |e: Aabb| [e.centre - e.half, e.centre + e.half];
        let all = boxes.map(corners).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])?;
        Some(Aabb::from_corners(all))
    }

    /// From lowest to highest corner.
    pub(crate) fn from_corners([low, high]: [V3; 2]) -> Aabb {
        Aabb { centre: (low + high) * 0.5, half: (high - low) * 0.5 }
    }
}

/// Rays made ready for boxes.
pub(crate) struct PacketSlabs<P> {
    inverse: [P; 3],
    /// Minus the origin times the inverse.
    shift: [P; 3],
    margin: P,
}

impl<P: SimdWide> PacketSlabs<P> {
    #[inline(always)]
    pub(crate) fn new(o: V3<P>, d: V3<P>) -> PacketSlabs<P> {
        let margin = box_margin(o);
        let inverse = [d.x.recip(), d.y.recip(), d.z.recip()];
        let o = [o.x, o.y, o.z];
        let shift = from_fn(|axis| -(o[axis] * inverse[axis]));
        PacketSlabs { inverse, shift, margin }
    }

    /// The rays that may be in the box before `t_max`; of those that are not, none is.
    #[inline(always)]
    pub(crate) fn may_hit(&self, aabb: &Aabb, t_max: P) -> P::Mask {
        let Aabb { centre, half } = aabb;
        let (centre, half) = ([centre.x, centre.y, centre.z], [half.x, half.y, half.z]);
        let (mut near, mut far) = (P::splat(0.0), t_max);
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let middle = inverse.mul_add(P::splat(centre[axis]), self.shift[axis]);
            let reach = inverse.abs() * (P::splat(half[axis]) + self.margin);
            // Along a plane there is no number, and no bound by it.
            near = (middle - reach).max(near);
            far = (middle + reach).min(far);
        }
        !near.gt(far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::numbers::Numbers;

    /// Rays aimed at points of a box hit it, wherever they start; and of those that pass it by at
    /// more than a hair's breadth none does.
    #[test]
    fn what_is_aimed_at_a_box_meets_it() {
        let mut numbers = Numbers(1);
        let mut passed = 0;
        for round in 0..20_000 {
            let mut point = |size: f32| V3::from(numbers.point().as_vec3().to_array()) * size;
            let corners = [point(1.0), point(1.0)];
            let [low, high] = [corners[0].min(corners[1]), corners[0].max(corners[1])];
            let aabb = Aabb::from_corners([low, high]);
            let mut o = point([1.0, 30.0, 2000.0][round % 3]);
            let (inside, half) = (point(1.0), aabb.half);
            let aside = V3::new(inside.x * half.x, inside.y * half.y, inside.z * half.z);
            let target = aabb.centre + aside;
            // Some along the axes, where there is nothing to divide by.
            if round % 7 == 0 {
                (o.x, o.y) = (target.x, target.y);
            }
            let d = (target - o).normalize();
            let meets = |d: V3, t_max: f32| PacketSlabs::<f32>::new(o, d).may_hit(&aabb, t_max);
            assert!(meets(d, f32::INFINITY), "{o:?} {d:?} {aabb:?}");
            let away = [o.x - aabb.centre.x, o.y - aabb.centre.y, o.z - aabb.centre.z];
            let half = [aabb.half.x, aabb.half.y, aabb.half.z];
            if (0..3).any(|axis| away[axis].abs() > half[axis] * 1.01 + 0.01) {
                assert!(!meets(-d, f32::INFINITY), "{o:?} {d:?} {aabb:?}");
                passed += 1;
            }
        }
        assert!(passed > 10_000, "{passed}");
    }
}
