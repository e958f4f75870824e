use super::*;
use crate::geometry::{Cylinder, NO_SURFACE, Ray, Sphere, offset_origin};
use crate::math::numbers::Numbers;
use crate::math::simd::{Isa, Kernel, dispatch};
use crate::scene::{Material, Scene, SceneBuilder};
use std::array::from_fn;

const LANES: usize = 16;

fn point(numbers: &mut Numbers) -> V3 {
    V3::from(numbers.point().as_vec3().to_array())
}

fn direction(numbers: &mut Numbers) -> V3 {
    loop {
        let d = point(numbers);
        if (0.01..1.0).contains(&d.length2()) {
            return d.normalize();
        }
    }
}

/// One of a few sizes, from specks to what fills the scene.
fn size(numbers: &mut Numbers) -> f32 {
    10f32.powf(-4.0 * numbers.next() as f32)
}

#[derive(Clone, Copy)]
enum Body {
    Sphere(Sphere),
    Cylinder(Cylinder),
}

impl Body {
    fn draw(numbers: &mut Numbers) -> Body {
        let place = point(numbers);
        if numbers.next() < 0.4 {
            return Body::Sphere(Sphere { centre: place, radius: size(numbers) });
        }
        // Some stand upright.
        let axis = match numbers.next() < 0.3 {
            true => V3::new(0.0, 0.0, 1.0),
            false => direction(numbers),
        };
        Body::Cylinder(Cylinder::new(place, axis, size(numbers), size(numbers)))
    }

    fn quick(&self) -> QuickTest {
        match self {
            Body::Sphere(sphere) => QuickTest::sphere(sphere),
            Body::Cylinder(cylinder) => QuickTest::cylinder(cylinder),
        }
    }

    fn meets(&self, o: V3, d: V3, t_max: f32) -> bool {
        match self {
            Body::Sphere(sphere) => sphere.intersect(o, d, t_max).is_some(),
            Body::Cylinder(cylinder) => cylinder.intersect(o, d, t_max).is_some(),
        }
    }

    /// A place on the surface, near it, or anywhere about.
    fn about(&self, numbers: &mut Numbers) -> V3 {
        let (centre, reach) = match self {
            Body::Sphere(s) => (s.centre, s.radius),
            Body::Cylinder(c) => {
                (c.base + c.axis() * (0.5 * c.height), c.radius.max(0.5 * c.height))
            }
        };
        let p = centre + direction(numbers) * (reach * 2.0 * numbers.next() as f32);
        let on = match self {
            Body::Sphere(s) => s.surface(p),
            Body::Cylinder(c) => c.surface(p),
        };
        match (numbers.next() * 4.0) as u32 {
            0 => on.p,
            1 => on.p + on.ng * (1e-6 * (numbers.next() as f32 - 0.5)),
            2 => offset_origin(on.p, on.error, on.ng, direction(numbers)),
            _ => p,
        }
    }
}

/// Origins and directions of a register's worth of rays from the `at`th on.
#[inline(always)]
fn load<P: SimdWide>(rays: &[[V3; 2]; LANES], at: usize) -> (V3<P>, V3<P>) {
    let mut columns = [[0.0; LANES]; 6];
    for (i, [o, d]) in rays[at..].iter().enumerate() {
        for (column, x) in columns.iter_mut().zip([o.x, o.y, o.z, d.x, d.y, d.z]) {
            column[i] = x;
        }
    }
    let [ox, oy, oz, dx, dy, dz] = &columns;
    let o = V3::new(P::load(ox), P::load(oy), P::load(oz));
    (o, V3::new(P::load(dx), P::load(dy), P::load(dz)))
}

/// For rays: which may hit a body as the nearest, which may hit it at all, and which certainly do.
struct Try<'a>(&'a QuickTest, &'a [[V3; 2]; LANES], f32);

impl Kernel for Try<'_> {
    type Output = [u32; 3];
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> [u32; 3] {
        let Try(quick, rays, t_max) = self;
        let mut found = [0; 3];
        for at in (0..LANES).step_by(P::WIDTH) {
            let (o, d) = load::<P>(rays, at);
            let segment = Segment::new(o, d, P::splat(t_max));
            let [may, certainly] = quick.occludes(&segment);
            let masks = [quick.may_hit(&segment), may, certainly];
            for (found, mask) in found.iter_mut().zip(masks) {
                *found |= (mask.bits() & ((1u64 << P::WIDTH) - 1) as u32) << at;
            }
        }
        found
    }
}

/// The quick test never contradicts the exact one: for bodies of all sizes, rays from and to their
/// surfaces and through their rims, of any length, near and far.
#[test]
fn what_is_certain_is_so() {
    let mut numbers = Numbers(3);
    let (mut missed, mut met, mut unsure) = (0, 0, 0);
    for round in 0..40_000 {
        let body = Body::draw(&mut numbers);
        let away = [1.0, 1.0, 30.0, 2000.0][round % 4];
        let rays: [[V3; 2]; LANES] = from_fn(|lane| {
            let o = match lane % 3 {
                0 => body.about(&mut numbers),
                _ => point(&mut numbers) * away,
            };
            let target = match lane % 5 {
                0 => point(&mut numbers),
                _ => body.about(&mut numbers),
            };
            let d = target - o;
            // Along an axis, or to a point.
            let unit = numbers.next() < 0.5;
            let d = match round % 9 {
                0 => V3::new(d.x, 0.0, 0.0),
                1 => V3::new(d.x, d.y, 0.0),
                _ => d,
            };
            [o, if unit { d.normalize() } else { d }]
        });
        let t_max = [f32::INFINITY, 1.0, 1.0 - 16.0 * f32::EPSILON, 0.3][(round / 4) % 4];
        for isa in Isa::available() {
            let [nearest, may, certainly] = dispatch(isa, Try(&body.quick(), &rays, t_max));
            for (lane, [o, d]) in rays.iter().enumerate() {
                let [nearest, may, certainly] =
                    [nearest, may, certainly].map(|mask| mask >> lane & 1 != 0);
                if d.length2() < 1e-30 {
                    continue;
                }
                let truth = body.meets(*o, *d, t_max);
                assert!(nearest || !truth, "{isa:?} {round} {lane}: {o:?} {d:?}");
                assert!(may || !truth, "{isa:?} {round} {lane}: {o:?} {d:?}");
                assert!(truth || !certainly, "{isa:?} {round} {lane}: {o:?} {d:?}");
                missed += u32::from(!may);
                met += u32::from(certainly);
                unsure += u32::from(may && !certainly);
            }
        }
    }
    let all = missed + met + unsure;
    assert!(missed > all / 4 && met > all / 8, "{missed} {met} {unsure}");
}

/// Bodies all over.
fn scene(numbers: &mut Numbers, count: usize) -> Scene {
    let mut b = SceneBuilder::new("bodies");
    let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
    for i in 0..count {
        let p = numbers.point();
        let radius = 0.02 + 0.2 * numbers.next();
        if i % 2 == 0 {
            b.sphere(p, radius, clay).unwrap();
        } else {
            b.cylinder(p, numbers.point(), radius, clay).unwrap();
        }
    }
    b.build()
}

/// What a register of rays finds of all shapes.
struct All<'a>(&'a Scene, &'a [[V3; 2]; LANES], [u32; 2]);

impl Kernel for All<'_> {
    /// By lane the nearest, and who is in the shadow: through boxes, and in a shaft.
    type Output = (Vec<Option<u32>>, [u32; 2]);
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> Self::Output {
        let All(scene, rays, ends) = self;
        let (geometry, analytic) = (scene.geometry(), &scene.bvh().analytic);
        let (mut nearest, mut shadows) = (vec![None; LANES], [0; 2]);
        for at in (0..LANES).step_by(P::WIDTH) {
            let (o, d) = load::<P>(rays, at);
            let (slabs, live) = (PacketSlabs::new(o, d), P::mask(u32::MAX));
            let ray = |lane: usize| Ray { o: rays[at + lane][0], d: rays[at + lane][1] };
            let [from, to] = ends.map(P::Bits::splat);
            let infinite = P::splat(f32::INFINITY);
            let mut best = [f32::INFINITY; LANES];
            analytic.may_hit((o, d, infinite), &slabs, from, live, &mut |primitive, lanes| {
                for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
                    if let Some(t) = hit_analytic(geometry, primitive, &ray(lane), best[lane]) {
                        (best[lane], nearest[at + lane]) = (t, Some(primitive));
                    }
                }
            });
            let one = P::splat(1.0);
            let boxes = analytic.occluded(geometry, (o, d, one), &slabs, [from, to], live);
            let corners = rays.iter().map(|[o, _]| [*o; 2]).reduce(clusters::around).unwrap();
            let shaft = Shaft::new(corners, rays[0][0] + rays[0][1]);
            let which = analytic.within::<W>(&shaft);
            let shaft = analytic.occluded_by(geometry, which, (o, d, one), [from, to], live);
            for (all, mask) in shadows.iter_mut().zip([boxes, shaft]) {
                *all |= (mask.bits() & ((1u64 << P::WIDTH) - 1) as u32) << at;
            }
        }
        (nearest, shadows)
    }
}

/// By the register rays hit what each hits by itself: rays from all over to one point.
#[test]
fn rays_meet_what_each_meets_alone() {
    let mut numbers = Numbers(11);
    let mut hits = 0;
    for round in 0..3000 {
        let scene = scene(&mut numbers, 1 + round % 40);
        let geometry = scene.geometry();
        let target = point(&mut numbers);
        let near = point(&mut numbers);
        let rays: [[V3; 2]; LANES] = from_fn(|_| {
            let o = near + point(&mut numbers) * [0.05, 1.0][round % 2];
            [o, target - o]
        });
        for isa in Isa::available() {
            let (nearest, shadows) = dispatch(isa, All(&scene, &rays, [NO_SURFACE; 2]));
            let analytic: Vec<u32> = scene.bvh().analytic.primitives().collect();
            for (lane, [o, d]) in rays.iter().enumerate() {
                let ray = Ray { o: *o, d: *d };
                let mut best = (f32::INFINITY, None);
                for &primitive in &analytic {
                    if let Some(t) = hit_analytic(geometry, primitive, &ray, best.0)
                        && t < best.0
                    {
                        best = (t, Some(primitive));
                    }
                }
                assert_eq!(nearest[lane], best.1, "{isa:?} {round} {lane}");
                let dark = analytic.iter().any(|&i| hit_analytic(geometry, i, &ray, 1.0).is_some());
                assert_eq!(shadows.map(|mask| mask >> lane & 1 != 0), [dark; 2], "{isa:?} {round}");
                hits += usize::from(dark);
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

/// More shapes than there is room for: the large ones are taken, the rest stay in the tree, and every
/// ray still hits the same.
#[test]
fn of_many_shapes_the_large_ones_are_taken() {
    let mut b = SceneBuilder::new("many");
    let clay = b.material(Material::reflecting("clay", [0.5; 3], [0.0; 3], 1.0).unwrap());
    let mut numbers = Numbers(5);
    for i in 0..100 {
        let radius = if i % 20 == 7 { 0.4 } else { 0.01 };
        b.sphere(numbers.point() * 3.0, radius, clay).unwrap();
    }
    let scene = b.build();
    let taken: Vec<u32> = scene.bvh().analytic.primitives().collect();
    assert_eq!(taken, [7, 27, 47, 67, 87]);
    assert_eq!(scene.bvh().surface_id(47), MAX_QUADS as u32 + 2);
    assert_eq!(scene.bvh().surface_id(48), NO_SURFACE);
    let (geometry, mut stack) = (scene.geometry(), scene.stack());
    let mut hits = 0;
    for _ in 0..20_000 {
        let ray = Ray { o: point(&mut numbers), d: direction(&mut numbers) };
        let found = scene.bvh().closest(geometry, &ray, f32::INFINITY, &mut stack);
        let mut best: Option<(f32, u32)> = None;
        for i in 0..100 {
            let t_max = best.map_or(f32::INFINITY, |b| b.0);
            if let Some(t) = hit_analytic(geometry, i, &ray, t_max)
                && t < t_max
            {
                best = Some((t, i));
            }
        }
        assert_eq!(found.map(|hit| (hit.t, hit.primitive)), best);
        hits += usize::from(best.is_some());
    }
    assert!(hits > 300, "{hits}");
}
