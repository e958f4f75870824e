//! A sphere or cylinder against as many rays as a register holds: which certainly miss it, and which
//! certainly hit it.
//!
//! Both are convex bodies, so that a segment hits the body where its point nearest to the middle
//! does, and hits the surface where besides one of its ends is outside.

use crate::geometry::ray_origin::UNIT_ROUNDOFF;
use crate::geometry::{Cylinder, Sphere};
use crate::math::simd::{Mask, SimdWide};
use crate::math::{Frame, V3};

/// Distance that decisions keep from the surface, as a multiple of 1 + the origin's largest coordinate:
/// three times what those of this test and of the exact one add up to, for shapes of the scene, whose
/// coordinates are within 1. The longest chain is that of the cylinder: an origin relative to the
/// base, turned into its frame, and a step along a direction turned likewise, each within 12
/// rounding errors here and there.
const MARGIN: f32 = 128.0 * UNIT_ROUNDOFF;
/// A ray that comes no nearer to a cap than by this part of its way is left to the exact test.
const ALONG: f32 = 1e12;

/// Rays `o + t d`, `0 < t <= t_max`, made ready.
pub(super) struct Segment<P> {
    pub(super) o: V3<P>,
    pub(super) d: V3<P>,
    pub(super) t_max: P,
    /// One over the square of the direction.
    inverse2: P,
    margin: P,
}

impl<P: SimdWide> Segment<P> {
    #[inline(always)]
    pub(super) fn new(o: V3<P>, d: V3<P>, t_max: P) -> Segment<P> {
        let margin = (o.abs().max_component() + P::splat(1.0)) * P::splat(MARGIN);
        Segment { o, d, t_max, inverse2: dot(d, d).recip(), margin }
    }
}

#[derive(Clone, Debug)]
pub(super) enum QuickTest {
    Sphere { centre: V3, radius: f32 },
    Cylinder(Tube),
}

/// A cylinder's base point, the frame around its axis, half its height, its radius.
#[derive(Clone, Debug)]
pub(super) struct Tube {
    base: V3,
    frame: Frame,
    half: f32,
    radius: f32,
}

/// Fused where that is faster: the margin is for either.
#[inline(always)]
fn dot<P: SimdWide>(a: V3<P>, b: V3<P>) -> P {
    a.z.mul_add(b.z, a.y.mul_add(b.y, a.x * b.x))
}

/// The point at `t`.
#[inline(always)]
fn at<P: SimdWide>(o: V3<P>, d: V3<P>, t: P) -> V3<P> {
    V3::new(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y), d.z.mul_add(t, o.z))
}

#[inline(always)]
fn turned<P: SimdWide>(frame: &Frame<P>, v: V3<P>) -> V3<P> {
    V3::new(dot(v, frame.s), dot(v, frame.t), dot(v, frame.n))
}

#[inline(always)]
fn square2<P: SimdWide>(x: P, y: P) -> P {
    y.mul_add(y, x * x)
}

impl QuickTest {
    pub(super) fn sphere(sphere: &Sphere) -> QuickTest {
        QuickTest::Sphere { centre: sphere.centre, radius: sphere.radius }
    }

    pub(super) fn cylinder(cylinder: &Cylinder) -> QuickTest {
        QuickTest::Cylinder(Tube {
            base: cylinder.base,
            frame: Frame::around(cylinder.axis()),
            half: 0.5 * cylinder.height,
            radius: cylinder.radius,
        })
    }

    /// The rays that do not certainly miss it.
    #[inline(always)]
    pub(super) fn may_hit<P: SimdWide>(&self, segment: &Segment<P>) -> P::Mask {
        match self {
            QuickTest::Sphere { centre, radius } => {
                let o = segment.o - centre.splat_lanes();
                !near_sphere(segment, o).gt(outer(segment, *radius))
            }
            QuickTest::Cylinder(tube) => {
                let local = tube.local(segment);
                let [near, far] = local.between_caps(segment, segment.margin);
                let e2 = local.nearest2([near, far]);
                !(near.gt(far) | e2.gt(outer(segment, local.radius)))
            }
        }
    }

    /// The rays that do not certainly miss its surface, and those that certainly hit it.
    #[inline(always)]
    pub(super) fn occludes<P: SimdWide>(&self, segment: &Segment<P>) -> [P::Mask; 2] {
        match self {
            QuickTest::Sphere { centre, radius } => {
                let o = segment.o - centre.splat_lanes();
                let e2 = near_sphere(segment, o);
                let [outer, inner] = [outer(segment, *radius), inner(segment, *radius)];
                let may = !e2.gt(outer);
                if !may.any() {
                    return [may; 2];
                }
                let end = at(o, segment.d, segment.t_max);
                let outside = dot(o, o).gt(outer) | dot(end, end).gt(outer);
                [may, e2.lt(inner) & outside]
            }
            QuickTest::Cylinder(tube) => {
                let local = tube.local(segment);
                let [near, far] = local.between_caps(segment, segment.margin);
                let [outer, inner] = [outer(segment, local.radius), inner(segment, local.radius)];
                let e2 = local.nearest2([near, far]);
                let may = !(near.gt(far) | e2.gt(outer));
                if !may.any() {
                    return [may; 2];
                }
                let [near, far] = local.between_caps(segment, -segment.margin);
                let e2 = local.nearest2([near, far]);
                let inside =
                    near.lt(far) & e2.lt(inner) & local.inverse_z.abs().lt(P::splat(ALONG));
                let reach = P::splat(local.half) + segment.margin;
                let (start, end) = (local.o, at(local.o, local.d, segment.t_max));
                let outside = square2(start.x, start.y).gt(outer)
                    | square2(end.x, end.y).gt(outer)
                    | start.z.abs().gt(reach)
                    | end.z.abs().gt(reach);
                [may, inside & outside]
            }
        }
    }
}

impl Tube {
    /// Rays in the frame around its middle.
    #[inline(always)]
    fn local<P: SimdWide>(&self, segment: &Segment<P>) -> Local<P> {
        let Tube { base, frame, half, radius } = self;
        let frame = frame.splat_lanes::<P>();
        let mut o = turned(&frame, segment.o - base.splat_lanes());
        o.z = o.z - P::splat(*half);
        let d = turned(&frame, segment.d);
        let inverse_z = d.z.recip();
        Local { o, d, inverse_z, half: *half, radius: *radius }
    }
}

/// The square of the distance within which rays do not certainly miss.
#[inline(always)]
fn outer<P: SimdWide>(segment: &Segment<P>, radius: f32) -> P {
    (P::splat(radius) + segment.margin).sqr()
}

/// The square of the distance within which they certainly hit.
#[inline(always)]
fn inner<P: SimdWide>(segment: &Segment<P>, radius: f32) -> P {
    (P::splat(radius) - segment.margin).max(P::splat(0.0)).sqr()
}

/// The square of the least distance to the origin of rays that start at `o`.
#[inline(always)]
fn near_sphere<P: SimdWide>(segment: &Segment<P>, o: V3<P>) -> P {
    // Without a number there is no bound.
    let t = -dot(o, segment.d) * segment.inverse2;
    let e = at(o, segment.d, t.max(P::splat(0.0)).min(segment.t_max));
    dot(e, e)
}

/// Rays in the frame of a cylinder, the origin in its middle.
struct Local<P> {
    o: V3<P>,
    d: V3<P>,
    inverse_z: P,
    half: f32,
    radius: f32,
}

impl<P: SimdWide> Local<P> {
    /// Where rays are between the planes of the caps, each moved outwards by this.
    #[inline(always)]
    fn between_caps(&self, segment: &Segment<P>, by: P) -> [P; 2] {
        let zero = P::splat(0.0);
        let middle = -(self.o.z * self.inverse_z);
        let reach = self.inverse_z.abs() * (P::splat(self.half) + by);
        // Along a cap there is no number, and no bound by it.
        [(middle - reach).max(zero), (middle + reach).min(segment.t_max)]
    }

    /// The square of the least distance to the axis between two places.
    #[inline(always)]
    fn nearest2(&self, [near, far]: [P; 2]) -> P {
        let (o, d) = (self.o, self.d);
        let along = -d.y.mul_add(o.y, d.x * o.x);
        let t = (along * square2(d.x, d.y).recip()).max(near).min(far);
        square2(d.x.mul_add(t, o.x), d.y.mul_add(t, o.y))
    }
}
