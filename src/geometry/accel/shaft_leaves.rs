//! What of the tree lies in a shaft: found once, and tried by each of its rays.

use super::bvh::Bvh;
use super::leaf::hit_analytic;
use super::node::{ANALYTIC, Child, PACK, child};
use super::ray::is_traceable;
use super::shaft::{Rays, Shaft, ShaftLeaves};
use super::stack::Stack;
use crate::geometry::Geometry;
use crate::geometry::aabb::{Aabb, PacketSlabs};
use crate::geometry::triangle::{self, ShearedRay};
use crate::math::V3;
use crate::math::simd::{MAX_WIDTH, Mask, Simd8, SimdWide};

/// More leaves than this, or more nodes on the way to them, and each ray goes by itself.
const MOST_LEAVES: usize = 32;
const MOST_NODES: usize = 48;

impl Bvh {
    /// Looks up what lies in a shaft; false if that is too much.
    #[inline(always)]
    pub(super) fn look_up<W: Simd8>(
        &self,
        shaft: &Shaft,
        stack: &mut Stack,
        leaves: &mut ShaftLeaves,
    ) -> bool {
        leaves.0.clear();
        let Some(root) = self.root else { return true };
        if root & (PACK | ANALYTIC) != 0 {
            leaves.0.push((root, self.aabb));
            return true;
        }
        let nodes = &self.nodes[..];
        let stack = &mut stack.subtrees;
        stack[0].1 = root;
        let (mut top, mut visited) = (1, 0);
        while top > 0 {
            top -= 1;
            let node = &nodes[stack[top].1 as usize];
            let mut mask = shaft.test::<W>(node);
            visited += 1;
            while mask != 0 {
                let at = mask.trailing_zeros() as usize;
                let word = node.child[at];
                mask &= mask - 1;
                if word & (PACK | ANALYTIC) != 0 {
                    let corner = |row: usize| {
                        let [x, y, z] = &node.bounds;
                        V3::new(x[row][at], y[row][at], z[row][at])
                    };
                    leaves.0.push((word, Aabb::from_corners([corner(0), corner(1)])));
                } else {
                    stack[top].1 = word;
                    top += 1;
                }
            }
            if leaves.0.len() > MOST_LEAVES || visited > MOST_NODES {
                return false;
            }
        }
        true
    }

    /// Which of these lanes' rays hit any of the leaves at `0 < t <= t_max`.
    #[inline(always)]
    pub(super) fn occluded_by<W: Simd8, P: SimdWide>(
        &self,
        geometry: &Geometry,
        (rays, slabs): (&Rays, &PacketSlabs<P>),
        t_max: f32,
        lanes: u32,
        leaves: &ShaftLeaves,
    ) -> u32 {
        let packs = &self.packs[..];
        let mut blocked = 0;
        let (mut sheared, mut ready) = ([ShearedRay::default(); MAX_WIDTH], 0u32);
        for (word, aabb) in &leaves.0 {
            let met = slabs.may_hit(aabb, P::splat(t_max)).bits();
            let mut met = met & lanes & !blocked;
            while met != 0 {
                let lane = met.trailing_zeros() as usize;
                met &= met - 1;
                let ray = rays.get(lane);
                if !is_traceable(&ray) {
                    continue;
                }
                if ready >> lane & 1 == 0 {
                    sheared[lane] = ShearedRay::new(ray.o, ray.d);
                    ready |= 1 << lane;
                }
                let hit = match child(*word) {
                    Child::Triangles(at) => {
                        let pack = &packs[at];
                        triangle::intersect::<W>(pack, &sheared[lane], t_max).is_some()
                    }
                    Child::Analytic(primitive) => {
                        hit_analytic(geometry, primitive, &ray, t_max).is_some()
                    }
                    Child::Node(_) => false,
                };
                blocked |= u32::from(hit) << lane;
            }
        }
        blocked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::math::numbers::Numbers;
    use crate::math::simd::{Isa, Kernel, dispatch};
    use crate::scene::{Material, Mesh, Scene, SceneBuilder};
    use glam::DAffine3;

    /// Small triangles all over, some spheres, and a long one: nothing of it a large quad.
    fn clutter(numbers: &mut Numbers) -> Scene {
        let mut b = SceneBuilder::new("clutter");
        let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
        let mut point = |size: f64| numbers.point() * size;
        let mut soup = Mesh::default();
        for _ in 0..4000 {
            let p = point(1.0);
            soup.positions.extend([(); 3].map(|()| p + point(0.03)));
            let n = soup.positions.len() as u32;
            soup.triangles.push([n - 3, n - 2, n - 1]);
        }
        b.mesh(&soup, DAffine3::IDENTITY, clay).unwrap();
        // More than are taken out of the tree.
        for _ in 0..40 {
            b.sphere(point(1.0), 0.03, clay).unwrap();
        }
        b.build()
    }

    /// For a box, a point and places in the box: which of them do not see the point, or nothing
    /// where there was too much to look up.
    struct Together<'a>(&'a Scene, [V3; 2], V3, &'a [V3; 16]);

    impl Kernel for Together<'_> {
        type Output = Option<u32>;
        #[inline(always)]
        fn run<W: Simd8, P: SimdWide>(self) -> Option<u32> {
            let Together(scene, bounds, p, from) = self;
            let (bvh, geometry) = (scene.bvh(), scene.geometry());
            let (mut stack, mut leaves) = (scene.stack(), ShaftLeaves::default());
            if !bvh.look_up::<W>(&Shaft::new(bounds, p), &mut stack, &mut leaves) {
                return None;
            }
            let mut blocked = 0;
            for at in (0..16).step_by(P::WIDTH) {
                let mut columns = [[0.0; 16]; 3];
                for (i, v) in from[at..at + P::WIDTH].iter().enumerate() {
                    for (column, x) in columns.iter_mut().zip([v.x, v.y, v.z]) {
                        column[i] = x;
                    }
                }
                let [x, y, z] = &columns;
                let o = V3::new(P::load(x), P::load(y), P::load(z));
                let d = p.splat_lanes::<P>() - o;
                let rays = (&Rays::new(o, d), &PacketSlabs::new(o, d));
                let found = bvh.occluded_by::<W, P>(geometry, rays, END, u32::MAX, &leaves);
                let all = if P::WIDTH == 32 { u32::MAX } else { (1 << P::WIDTH) - 1 };
                blocked |= (found & all) << at;
            }
            Some(blocked)
        }
    }
    const END: f32 = 0.999;

    #[test]
    fn rays_of_a_shaft_meet_what_each_meets_by_itself() {
        let mut numbers = Numbers(9);
        let scene = clutter(&mut numbers);
        let (bvh, geometry) = (scene.bvh(), scene.geometry());
        let mut stack = scene.stack();
        let (mut done, mut blocked) = ([0; 2], 0);
        for round in 0..2000 {
            let mut point = |size: f32| V3::from(numbers.point().as_vec3().to_array()) * size;
            let (centre, mut p) = (point(0.9), point(0.9));
            let half = point([0.01, 0.05, 0.2][round % 3]).abs();
            // The point may lie within the box's reach along an axis, or in the box.
            if round % 5 == 0 {
                p.x = centre.x;
            }
            if round % 10 == 0 {
                p.y = centre.y;
            }
            if round % 100 == 0 {
                p = centre;
            }
            let from: [V3; 16] = std::array::from_fn(|_| {
                let u = point(1.0);
                centre + V3::new(u.x * half.x, u.y * half.y, u.z * half.z)
            });
            let bounds = [centre - half, centre + half];
            for isa in Isa::available() {
                let found = dispatch(isa, Together(&scene, bounds, p, &from));
                done[usize::from(found.is_some())] += 1;
                let Some(found) = found else { continue };
                for (i, o) in from.into_iter().enumerate() {
                    let ray = Ray { o, d: p - o };
                    let truth = bvh.occluded(geometry, &ray, END, &mut stack);
                    assert_eq!(found >> i & 1 != 0, truth, "{isa:?} {bounds:?} {p:?} {o:?}");
                    blocked += usize::from(truth);
                }
            }
        }
        // Thin and thick shafts, rays that are blocked and rays that are not.
        assert!(done[0] > 100 && done[1] > 1000, "{done:?}");
        assert!(blocked > done[1] && blocked < 15 * done[1], "{blocked} of {done:?}");
    }
}
