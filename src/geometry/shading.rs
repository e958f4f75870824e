//! Which way a surface faces the one who looks at it.
//!
//! The geometric normal decides the sides. A shading normal that is blended from a triangle's corners
//! leans away from the triangle, and where one looks along a coarse mesh's outline it leans so far
//! that it is seen from behind, or that a mirror with this normal would reflect into the surface. Left
//! alone both make black rims. So the normal is bent towards the geometric one, as far as is needed
//! for the mirror's direction to stay above the surface.
//!
//! **The rule** is that of Keller et al., "The iray light transport simulation and rendering system"
//! (2017), section on shading normals: where the viewer's direction, mirrored at the normal, is below
//! the surface, it is lifted along the geometric normal, and the normal is half way between the viewer
//! and what was lifted. Three details are ours. It is lifted to a height of `min(0.9 cos, 0.01)`, as
//! in Cycles' `ensure_valid_specular_reflection`, where `cos` is the viewer's to the geometric normal:
//! lower than any flat surface would reflect, so that these stay as they are. The lifted direction is
//! not made a unit vector again, which saves a difference of nearly equal numbers. And a normal that
//! the viewer sees from behind counts as one that he sees edge on: the result is the geometric one.
//!
//! With `g`, `n` the two normals, `w` towards the viewer, `c = g·w`, `s = max(n·w, 0)` and the height
//! `h`, the mirrored direction `2 s n - w` is below `h` where `2 s (n·g) < c + h`. Then the lifted one
//! is `2 s n - w + (c + h - 2 s (n·g)) g`, and half way to it from `w` is, up to its length,
//!
//! > `(1 - x (n·g)) g + x n`, with `x = 2 s / (c + h)`.
//!
//! Neither factor is negative. Hence all that is asked for: the result lies on the arc from `g` to
//! `n`; its cosine to the viewer is above 0 wherever `c` is; at `2 s (n·g) = c + h` it is `n`, so it is
//! continuous in `n` and `w` (up to where `n` is turned about, at a right angle to `g`); and the viewer
//! mirrored at it is above the surface.
//!
//! **What it costs.** The frame depends on `w`, so where either of two directions bends it the BRDF is
//! not reciprocal there; where neither does it is as reciprocal as with any shading normal (Veach
//! 1997, section 5.3). A normal that leans by an angle `a` is bent for a part of about `2 a / pi + 0.005`
//! of all directions. Energy is never made: in a white furnace the BRDF in the bent frame gives back
//! at most what the same BRDF gives in its own, less what falls below the surface. As a mesh is made
//! finer the normals part less, and the band along the outline in which they are bent vanishes.

use super::SurfacePoint;
use crate::math::V3;
use crate::math::simd::{Mask, Simd};

/// A mirror's direction is kept this high above the surface, or at this part of the viewer's height.
const HEIGHT: f32 = 0.01;
const PART: f32 = 0.9;
/// Keeps a division finite where the surface is seen exactly edge on.
const TINY: f32 = 1e-12;

impl<L: Simd> SurfacePoint<L> {
    /// With both normals turned to the side that `wo` is on.
    #[inline(always)]
    pub(crate) fn turned_to(mut self, wo: V3<L>) -> SurfacePoint<L> {
        let zero = L::splat(0.0);
        self.ng = V3::select(self.ng.dot(wo).lt(zero), -self.ng, self.ng);
        self.ns = V3::select(self.ns.dot(self.ng).lt(zero), -self.ns, self.ns);
        self
    }

    /// The shading normal for a viewer in the unit direction `wo`, to whose side both normals are
    /// turned, and where it is not the surface's own.
    #[inline(always)]
    pub(crate) fn normal_for(&self, wo: V3<L>) -> (V3<L>, L::Mask) {
        bent(self.ng, self.ns, wo)
    }
}

/// The shading normal `ns` bent for a viewer in the unit direction `wo`, and where it is bent. Both
/// normals are on one side, and `wo` on that of `ng`.
#[inline(always)]
pub(crate) fn bent<L: Simd>(ng: V3<L>, ns: V3<L>, wo: V3<L>) -> (V3<L>, L::Mask) {
    let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
    let (c, s, cos) = (ng.dot(wo), ns.dot(wo).max(zero), ns.dot(ng));
    let least = c + (L::splat(PART) * c).min(L::splat(HEIGHT));
    let bends = (two * s * cos).lt(least);
    if !bends.any() {
        return (ns, bends);
    }
    let x = two * s / least.max(L::splat(TINY));
    let sum = ng * (one - x * cos).max(zero) + ns * x;
    (V3::select(bends, sum.normalize(), ns), bends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    /// Unit vectors, the same each time.
    struct Random(u64);

    impl Random {
        fn number(&mut self) -> f32 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1u32 << 24) as f32
        }

        fn direction(&mut self) -> V3 {
            loop {
                let [x, y, z] = [(); 3].map(|()| 2.0 * self.number() - 1.0);
                let v = V3::new(x, y, z);
                if (0.01..1.0).contains(&v.length2()) {
                    return v.normalize();
                }
            }
        }

        /// Two normals on one side and a viewer on that of the first, often at grazing angles.
        fn view(&mut self) -> [V3; 3] {
            let ng = self.direction();
            let turned = |v: V3| if v.dot(ng) < 0.0 { -v } else { v };
            let lean = self.number().powi(2) * 3.0;
            let ns = turned((ng + self.direction() * lean).normalize());
            let flat = self.direction();
            let graze = 10f32.powf(-5.0 * self.number());
            let wo = turned(flat + ng * (graze - flat.dot(ng))).normalize();
            [ng, ns, if wo.dot(ng) < 0.0 { -wo } else { wo }]
        }
    }

    fn reflected(n: V3, wo: V3) -> V3 {
        n * (2.0 * n.dot(wo)) - wo
    }

    #[test]
    fn the_viewer_sees_it_from_the_front_and_a_mirror_reflects_off_the_surface() {
        let mut random = Random(1);
        let mut bends = 0;
        for _ in 0..1_000_000 {
            let [ng, ns, wo] = random.view();
            let c = ng.dot(wo);
            if c < 4e-6 {
                continue;
            }
            let (n, is_bent) = bent(ng, ns, wo);
            assert!((n.length() - 1.0).abs() < 1e-6);
            assert!(n.dot(wo) > 0.0, "{ng:?} {ns:?} {wo:?}");
            assert!(reflected(n, wo).dot(ng) > -3e-7, "{ng:?} {ns:?} {wo:?}");
            assert!(is_bent || n == ns);
            // On the arc from one to the other.
            let (out, plane) = (ng.cross(ns), ng.dot(ns));
            assert!(
                n.dot(out).abs() < 1e-6 && n.dot(ng) > plane - 1e-6 && n.dot(ns) > plane - 1e-6
            );
            bends += u32::from(is_bent);
        }
        assert!((200_000..800_000).contains(&bends), "{bends}");
    }

    /// As the rule says it, step by step and in double precision.
    #[test]
    fn it_is_half_way_to_the_lifted_direction() {
        let mut random = Random(2);
        let wide = |v: V3| [v.x, v.y, v.z].map(f64::from);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let along = |a: [f64; 3], x: f64, b: [f64; 3]| [0, 1, 2].map(|i| a[i] + x * b[i]);
        let mut bends = 0;
        for _ in 0..200_000 {
            let [ng, ns, wo] = random.view();
            let (found, is_bent) = bent(ng, ns, wo);
            if !is_bent || ng.dot(wo) < 1e-4 {
                continue;
            }
            let ([g, n, w], f) = ([ng, ns, wo].map(wide), wide(found));
            let (c, s) = (dot(g, w), dot(n, w).max(0.0));
            let mirrored = along(w.map(|x| -x), 2.0 * s, n);
            let lifted = along(mirrored, (0.9 * c).min(0.01) - dot(g, mirrored), g);
            let half = along(w, 1.0, lifted);
            let length = dot(half, half).sqrt();
            let off = along(f, -1.0 / length, half);
            assert!(dot(off, off).sqrt() < 1e-3, "{ng:?} {ns:?} {wo:?}: {off:?}");
            bends += 1;
        }
        assert!(bends > 30_000, "{bends}");
    }

    /// A step of size `e` moves the result by at most a multiple of `e` over the viewer's height.
    #[test]
    fn it_moves_little_where_normals_and_viewer_move_little() {
        let mut random = Random(3);
        let mut edges = 0;
        for _ in 0..400_000 {
            let [ng, ns, wo] = random.view();
            let height = ng.dot(wo);
            if height < 1e-3 || ns.dot(ng) < 0.05 {
                continue;
            }
            let e = height * 1e-2;
            let ns2 = (ns + random.direction() * e).normalize();
            let wo2 = (wo + random.direction() * e).normalize();
            let ((a, a_bends), (b, b_bends)) = (bent(ng, ns, wo), bent(ng, ns2, wo2));
            let bound = 12.0 * e / height / ns.dot(ng);
            assert!((a - b).length() < bound, "{ng:?} {ns:?} {wo:?}: {a:?} {b:?}");
            edges += u32::from(a_bends != b_bends);
        }
        assert!(edges > 20, "the edge of the rule was crossed {edges} times");
    }

    /// Where neither of two directions bends the normal both have one frame, and the BRDF is as
    /// reciprocal as itself; the others are as many as the lean of the normal says.
    #[test]
    fn a_normal_that_leans_little_is_bent_for_few_directions() {
        let mut random = Random(5);
        for _ in 0..20 {
            let lean = 0.03 + 0.4 * random.number();
            let ng = random.direction();
            let away = random.direction();
            let across = (away - ng * away.dot(ng)).normalize();
            let ns = ng * lean.cos() + across * lean.sin();
            let (mut bends, count) = (0, 100_000);
            for _ in 0..count {
                let wo = random.direction();
                let wo = if wo.dot(ng) < 0.0 { -wo } else { wo };
                let (n, is_bent) = bent(ng, ns, wo);
                bends += u32::from(is_bent);
                assert!(is_bent || n == ns);
            }
            let (found, wanted) = (bends as f32 / count as f32, 2.0 * lean / PI + 0.005);
            assert!((found - wanted).abs() < 0.006, "{lean}: {found} {wanted}");
        }
    }

    #[test]
    fn flat_surfaces_are_not_touched() {
        let mut random = Random(4);
        for _ in 0..300_000 {
            let [ng, _, wo] = random.view();
            let (n, is_bent) = bent(ng, ng, wo);
            assert!(!is_bent && n == ng, "{ng:?} {wo:?}");
        }
        // What is seen exactly edge on has no front.
        let (up, along) = (V3::new(0.0, 0.0, 1.0), V3::new(1.0, 0.0, 0.0));
        let lean = V3::new(-0.6, 0.0, 0.8);
        assert!(bent(up, lean, along).0.dot(along) <= 0.0);
    }
}
