//! The exact tests of what a leaf holds against one ray.

use super::ray::Ray;
use crate::geometry::triangle::{self, ShearedRay, TrianglePack8};
use crate::geometry::{Geometry, Hit, Kind};
use crate::math::simd::Simd8;

#[inline(always)]
pub(super) fn take_nearest<W: Simd8>(best: &mut Hit, pack: &TrianglePack8, ray: &ShearedRay) {
    let Some(hits) = triangle::intersect::<W>(pack, ray, best.t) else { return };
    let (mut mask, t, b) = (hits.mask, hits.t.store(), hits.b.map(W::store));
    while mask != 0 {
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        take_nearer(best, t[i], pack.id[i], [b[0][i], b[1][i]]);
    }
}

#[inline(always)]
pub(super) fn take_nearer(best: &mut Hit, t: f32, primitive: u32, b: [f32; 2]) {
    if t < best.t || (t == best.t && primitive < best.primitive) {
        *best = Hit { t, primitive, b };
    }
}

#[inline(always)]
pub(super) fn hit_analytic(
    geometry: &Geometry,
    primitive: u32,
    ray: &Ray,
    t_max: f32,
) -> Option<f32> {
    match geometry.kind(primitive) {
        Kind::Sphere(i) => geometry.spheres[i].intersect(ray.o, ray.d, t_max),
        Kind::Cylinder(i) => geometry.cylinders[i].intersect(ray.o, ray.d, t_max),
        Kind::Triangle(_) => None,
    }
}
