//! Against the exact test, ray by ray.

use super::select::narrow;
use super::*;
use crate::geometry::triangle::resolve;
use crate::geometry::{Hit, Ray, offset_origin};
use crate::math::numbers::Numbers;
use crate::math::simd::{F32x8, Isa, Kernel, Simd8, dispatch};
use crate::scene::builtin::EXAMPLES;
use crate::scene::{Material, Mesh, Scene, SceneBuilder};
use glam::{DAffine3, DVec3};

/// A closed room with boxes in it, turned, and loose triangles that cut through them.
fn room(numbers: &mut Numbers) -> Scene {
    let mut b = SceneBuilder::new("room");
    let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
    let mut soup = Mesh::default();
    for _ in 0..12 {
        let p = numbers.point() * 0.7;
        soup.positions.extend([(); 3].map(|()| p + numbers.point() * 0.4));
        let n = soup.positions.len() as u32;
        soup.triangles.push([n - 3, n - 2, n - 1]);
    }
    b.mesh(&soup, DAffine3::IDENTITY, clay).unwrap();
    b.cuboid(DVec3::splat(-1.0), DVec3::splat(2.0), clay).unwrap();
    for _ in 0..4 {
        b.cuboid(numbers.point() * 0.6, numbers.point() * 0.3 + DVec3::splat(0.35), clay).unwrap();
    }
    // A board: slender faces.
    b.cuboid(numbers.point() * 0.3, DVec3::new(0.6, 0.4, 0.01), clay).unwrap();
    b.build()
}

/// What as many rays hit by the quick test and then the exact distance: t, triangle, weights,
/// and whether it is open; and for the same rays cut at `t_max` whether they are blocked.
struct QuickTest<'a> {
    scene: &'a Scene,
    rays: &'a [Segment],
}
/// A ray, how far it goes, and the large quads at its ends.
type Segment = (Ray, f32, [u32; 2]);
type Answer = (Option<Hit>, bool, [bool; 2]);

impl Kernel for QuickTest<'_> {
    type Output = Vec<Answer>;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> Vec<Answer> {
        let (quads, geometry) = (&self.scene.bvh().quads, self.scene.geometry());
        let mut answers = Vec::new();
        for rays in self.rays.chunks_exact(16) {
            for rays in rays.chunks_exact(P::WIDTH) {
                let column = |f: &dyn Fn(&Segment) -> f32| {
                    let mut x = [0.0; 16];
                    x.iter_mut().zip(rays).for_each(|(x, ray)| *x = f(ray));
                    P::load(&x)
                };
                let ends = [0, 1].map(|end: usize| {
                    let mut x = [0; 16];
                    x.iter_mut().zip(rays).for_each(|(x, ray)| *x = ray.2[end]);
                    P::load_bits(&x)
                });
                let o = V3::new(column(&|r| r.0.o.x), column(&|r| r.0.o.y), column(&|r| r.0.o.z));
                let d = V3::new(column(&|r| r.0.d.x), column(&|r| r.0.d.y), column(&|r| r.0.d.z));
                let t_max = column(&|r| r.1);
                let slabs = PacketSlabs::new(o, d);
                let hits = quads.closest::<P>((o, d), &slabs, ends[0]);
                let between = (t_max.lt(P::splat(f32::INFINITY))).all();
                let all = P::mask(u32::MAX);
                let [blocked, unsure] =
                    quads.occluded::<P>((o, d, t_max), &slabs, ends, all, between);
                let (mut quad, mut triangle) = ([0; 16], [0; 16]);
                P::store_bits(hits.quad, &mut quad);
                P::store_bits(hits.triangle, &mut triangle);
                let corner = |vertex: usize| {
                    let of = |axis: usize| {
                        let mut x = [0.0; 16];
                        for lane in 0..P::WIDTH {
                            let p = geometry.corners(triangle[lane] as usize)[vertex];
                            x[lane] = [p.x, p.y, p.z][axis];
                        }
                        P::load(&x)
                    };
                    V3::new(of(0), of(1), of(2))
                };
                let corners = [corner(0), corner(1), corner(2)];
                let (t, b) = resolve::<P>(o, d, corners, P::mask(u32::MAX));
                let mut found = [[0.0; 16]; 3];
                for (found, x) in found.iter_mut().zip([t, b[0], b[1]]) {
                    x.store(found);
                }
                for lane in 0..P::WIDTH {
                    let bit = |mask: P::Mask| mask.bits() >> lane & 1 != 0;
                    let [t, b1, b2] = found.map(|x| x[lane]);
                    let hit = Hit { t, primitive: triangle[lane], b: [b1, b2] };
                    let hit = (quad[lane] != NO_QUAD).then_some(hit);
                    answers.push((hit, bit(hits.open), [bit(blocked), bit(unsure)]));
                }
            }
        }
        answers
    }
}

/// Rays from anywhere, from surfaces, and at the very edges and corners; some of them from
/// surface to surface.
fn rays(scene: &Scene, numbers: &mut Numbers) -> Vec<Segment> {
    let (geometry, quads) = (scene.geometry(), &scene.bvh().quads);
    let count = geometry.faces().len();
    let mut rays = Vec::new();
    while rays.len() < 1 << 15 {
        let mut pick = || ((numbers.next() * count as f64) as usize).min(count - 1);
        let (here, there) = (pick(), pick());
        let weights = match rays.len() % 4 {
            0 => [0.0, 0.0],
            1 => [numbers.next() as f32, 0.0],
            _ => [0.5 * numbers.next() as f32, 0.5 * numbers.next() as f32],
        };
        let target = geometry.triangle_surface(there, weights);
        let inside = [0.5 * numbers.next() as f32, 0.5 * numbers.next() as f32];
        let start = geometry.triangle_surface(here, inside);
        let wi = target.p - start.p;
        if wi.length2() < 1e-6 {
            continue;
        }
        let wi = wi.normalize();
        // Along its own face a ray has no business, and the exact test none to do.
        if start.ng.dot(wi).abs().min(target.ng.dot(wi).abs()) < 1e-3 {
            continue;
        }
        let ng = if start.ng.dot(wi) < 0.0 { -start.ng } else { start.ng };
        let o = offset_origin(start.p, start.error, ng, wi);
        let from = quads.quad_of(here as u32).unwrap_or(NO_QUAD);
        if rays.len() % 2 == 0 {
            // Some from outside.
            let far = if rays.len() % 32 < 4 { 3.0 } else { 0.9 };
            let anywhere = narrow(numbers.point() * far);
            let d = target.p - anywhere;
            let ray = Ray { o: anywhere, d: d.normalize() };
            rays.push((ray, f32::INFINITY, [NO_QUAD; 2]));
        } else if rays.len() % 32 < 16 {
            rays.push((Ray { o, d: wi }, f32::INFINITY, [from, NO_QUAD]));
        } else {
            let d = offset_origin(target.p, target.error, target.ng, -wi) - o;
            let to = quads.quad_of(there as u32).unwrap_or(NO_QUAD);
            rays.push((Ray { o, d }, 1.0 - 16.0 * f32::EPSILON, [from, to]));
        }
    }
    // Such that whole registers run from surface to surface.
    rays.sort_by_key(|ray| ray.1 < 1.0);
    rays
}

/// Holds the quick test against the exact one, where it is sure; and it has to be, mostly.
fn check(scene: &Scene, numbers: &mut Numbers) {
    let (bvh, geometry) = (scene.bvh(), scene.geometry());
    let rays = rays(scene, numbers);
    let mut stack = scene.stack();
    // One ray at a time besides, as where there are no registers.
    let sets = Isa::available().into_iter().map(Some).chain([None]);
    for isa in sets {
        let quick = QuickTest { scene, rays: &rays };
        let answers = match isa {
            Some(isa) => dispatch(isa, quick),
            None => quick.run::<F32x8, f32>(),
        };
        assert_eq!(answers.len(), rays.len());
        let (mut open, mut unsure) = (0, 0);
        for ((ray, t_max, _), (hit, is_open, [blocked, is_unsure])) in rays.iter().zip(answers) {
            let truth = bvh.closest(geometry, ray, f32::INFINITY, &mut stack);
            assert!(is_open || hit == truth, "{isa:?} {hit:?} {truth:?} {ray:?}");
            let truth = bvh.occluded(geometry, ray, *t_max, &mut stack);
            assert!(is_unsure || blocked == truth, "{isa:?} {truth} {t_max} {ray:?}");
            open += usize::from(is_open);
            unsure += usize::from(is_unsure);
        }
        // Half of the rays are aimed at edges and corners; of the others hardly one.
        let name = scene.name();
        assert!(open < rays.len() * 11 / 20, "{name}: {open} of {}", rays.len());
        assert!(unsure < rays.len() * 9 / 20, "{name}: {unsure} of {}", rays.len());
    }
}

#[test]
fn what_is_not_left_open_is_exactly_right() {
    let mut numbers = Numbers(7);
    for _ in 0..4 {
        let scene = room(&mut numbers);
        let quads = &scene.bvh().quads;
        assert!(quads.quads.len() > 20);
        assert!(quads.hull.is_some() && !quads.clusters.is_empty());
        check(&scene, &mut numbers);
    }
    // A ceiling around an emitter, a box without a front, boards; all of it large quads.
    for example in &EXAMPLES {
        let scene = example.read().unwrap().0.build();
        let geometry = scene.geometry();
        let triangles = scene.bvh().quads.triangles().count();
        if triangles > 0 && triangles == geometry.len() {
            check(&scene, &mut numbers);
        }
    }
}

/// A box is six large quads, each on the hull; what is in it has inner ones.
#[test]
fn faces_of_a_box_are_joined_and_its_hull_is_known() {
    let mut b = SceneBuilder::new("boxes");
    let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
    b.cuboid(DVec3::ZERO, DVec3::ONE, clay).unwrap();
    b.cuboid(DVec3::splat(0.4), DVec3::splat(0.3), clay).unwrap();
    let scene = b.build();
    let quads = &scene.bvh().quads;
    assert_eq!(quads.quads.len(), 12);
    assert_eq!(quads.inner.len(), 6);
    assert_eq!(quads.triangles().collect::<Vec<_>>(), (0..24).collect::<Vec<_>>());
    for triangle in 0..24 {
        let quad = quads.quad_of(triangle).unwrap();
        assert!(quads.quads[quad as usize].triangles.contains(&triangle));
    }
    assert_eq!(quads.quad_of(24), None);
}
