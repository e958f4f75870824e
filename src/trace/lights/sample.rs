//! Sampling a point on a light, and its density in 1/sr.

use super::importance::LightSampleContext;
use super::record::{LightKind, LightRecord};
use super::spherical_rectangle::SphericalRectangle;
use crate::geometry::{Geometry, Kind, Sphere, SurfacePoint, intersect_spheres, offset_origin};
use crate::math::simd::{MAX_WIDTH, Mask, Simd, SimdWide};
use crate::math::{Frame, Rgb, V3, warp};

/// Shadow rays end this close to 1: a distance along a ray is known to a few unit roundoffs of the whole.
pub(in crate::trace) const SHADOW_END: f32 = 1.0 - 16.0 * f32::EPSILON;
/// Distance between the hits of spheres that coincide, in distances between the spheres, at all but
/// grazing angles.
const SLACK: f32 = 16.0;
/// Directions towards lights.
pub(in crate::trace) struct LightSample<P: Simd> {
    /// Unit, leaving the surface.
    pub(in crate::trace) wi: V3<P>,
    /// What arrives from there unless something is in between.
    pub(in crate::trace) radiance: Rgb<P>,
    /// In 1/sr, the choice of the light included.
    pub(in crate::trace) pdf: P,
    /// The surface that the light is, if it is one.
    pub(in crate::trace) surface_id: P::Bits,
    /// Whether there is one.
    pub(in crate::trace) found: P::Mask,
    /// A known point, or a sphere's centre with its radius in `error`, or nothing.
    target: SurfacePoint<P>,
    is_point: P::Mask,
    is_sphere: P::Mask,
    /// How far before a sphere another one may be that coincides with it.
    slack: P,
    /// Whether the direction is from outside a sphere and in its cone: it hits it for certain.
    is_in_cone: P::Mask,
}

/// The rest of a shadow ray whose origin is known: direction, length, and whether it hits the light
/// at all.
pub(in crate::trace) struct ShadowRay<P: Simd> {
    pub(in crate::trace) d: V3<P>,
    pub(in crate::trace) t_max: P,
    pub(in crate::trace) hits: P::Mask,
}

impl<P: SimdWide> LightSample<P> {
    /// The way to the light from `o`, which is just off the surface.
    #[inline(always)]
    pub(in crate::trace) fn shadow_ray(&self, o: V3<P>) -> ShadowRay<P> {
        let (zero, infinite) = (P::splat(0.0), P::splat(f32::INFINITY));
        let mut ray = ShadowRay { d: self.wi, t_max: infinite, hits: P::mask(u32::MAX) };
        if self.is_point.any() {
            let q = &self.target;
            // To just off the other surface, but for the rounding of the distance itself.
            let d = offset_origin(q.p, q.error, q.ng, -self.wi) - o;
            ray.d = V3::select(self.is_point, d, ray.d);
            ray.t_max = P::select(self.is_point, P::splat(SHADOW_END), ray.t_max);
            // Rounding puts a point of the light's own plane on either side of it, and a light from
            // below would fill the hemisphere above. The ray's origin is off the surface by more
            // than all rounding errors: it has the light on the side where it is.
            let same_side = (q.ng.dot(q.p - o) * q.ng.dot(self.wi)).gt(zero);
            ray.hits = same_side | !self.is_point;
        }
        if self.is_sphere.any() {
            let (centre, radius) = (self.target.p, self.target.error.x);
            let [t0, t1] = intersect_spheres(centre, radius, o, self.wi);
            let t = P::select(t0.gt(zero), t0, t1);
            let met = t.gt(zero) & t.lt(infinite);
            // A direction of the cone hits the sphere but for rounding on the rim: then up to the
            // nearest point will do. The traversal hits it at the same number, so just short of it
            // is short enough.
            let nearest = (centre - o).dot(self.wi).max(zero);
            let t_max = P::select(met, t, nearest) * P::splat(1.0 - f32::EPSILON) - self.slack;
            ray.t_max = P::select(self.is_sphere, t_max, ray.t_max);
            ray.hits = ray.hits & (met | self.is_in_cone | !self.is_sphere);
        }
        ray
    }
}

impl<P: SimdWide> LightSample<P> {
    /// Drops the points of which this is true: by lane, point and normal. Of a sphere the point is
    /// the centre.
    #[cold]
    #[inline(never)]
    pub(super) fn drop_hidden(&mut self, drops: impl Fn(usize, V3, V3) -> bool) {
        let SurfacePoint { p, ng, .. } = self.target;
        let mut columns = [[0.0; MAX_WIDTH]; 6];
        for (column, x) in columns.iter_mut().zip([p.x, p.y, p.z, ng.x, ng.y, ng.z]) {
            x.store(column);
        }
        let live = (self.found & (self.is_point | self.is_sphere)).bits();
        let mut dropped = 0;
        for lane in (0..P::WIDTH).filter(|lane| live >> lane & 1 != 0) {
            let [x, y, z, nx, ny, nz] = columns.map(|column| column[lane]);
            dropped |= u32::from(drops(lane, V3::new(x, y, z), V3::new(nx, ny, nz))) << lane;
        }
        self.found = self.found & !P::mask(dropped);
    }
}

impl LightSample<f32> {
    /// The point sampled for, as seen from `p`; none of the environment.
    pub(in crate::trace) fn point(&self, p: V3) -> Option<V3> {
        let SurfacePoint { p: centre, error, .. } = self.target;
        if self.is_sphere {
            let sphere = Sphere { centre, radius: error.x };
            return sphere.intersect(p, self.wi, f32::INFINITY).map(|t| p + self.wi * t);
        }
        self.is_point.then_some(centre)
    }
}

/// Towards lights with these records; `again` is one more uniform number. The densities are those
/// of the lights alone.
#[inline(always)]
pub(super) fn sample<P: SimdWide>(
    geometry: &Geometry,
    light: &LightRecord<P>,
    to: &LightSampleContext<P>,
    again: P,
    u: [P; 2],
) -> LightSample<P> {
    let (zero, one) = (P::splat(0.0), P::splat(1.0));
    let nothing = V3::splat(zero);
    let is_sphere = light.kind.is(LightKind::Sphere);
    let is_environment = light.kind.is(LightKind::Environment);
    let is_point = !(is_sphere | is_environment);
    let mut sample = LightSample {
        wi: to.frame.n,
        radiance: light.radiance,
        pdf: zero,
        surface_id: light.surface_id,
        found: !P::mask(0),
        target: SurfacePoint { p: nothing, ng: nothing, ns: nothing, error: nothing },
        is_point,
        is_sphere,
        slack: zero,
        is_in_cone: P::mask(0),
    };
    if is_point.any() {
        let LightRecord { corner, sides, ng, error, .. } = *light;
        let [a, b] = sides;
        let triangle = light.kind.is(LightKind::Triangle);
        let [mut s, mut t] = u;
        let mut middle = P::splat(0.5);
        if triangle.any() {
            let [x, y] = warp::triangle(u);
            (s, t) = (P::select(triangle, x, s), P::select(triangle, y, t));
            middle = P::select(triangle, P::splat(1.0 / 3.0), middle);
        }
        let mut p = corner + a * s + b * t;
        let mut pdf = light.one_over_area;
        let near = light.kind.is(LightKind::Rectangle) & light.is_near(to.p);
        if near.any() {
            let side = ng.dot(corner - to.p);
            let towards = V3::select(side.lt(zero), -ng, ng);
            let glossy = SphericalRectangle::new(corner, sides, ng, to.p);
            p = V3::select(near, to.p + glossy.sample(u, towards), p);
            pdf = P::select(near, one / glossy.solid_angle, pdf);
            let along = p - corner;
            s = P::select(near, along.dot(a) / a.length2(), s);
            t = P::select(near, along.dot(b) / b.length2(), t);
        }
        // A point that rounding has put past an edge may lie behind the neighbouring face. A step of
        // the error's size towards the middle brings it back. Points elsewhere stay: to one who is
        // hardly farther away than that, all of them moved inwards would be another light.
        let inwards = corner + (a + b) * middle - p;
        let reach = inwards.abs().max_component();
        let step = error + error;
        let at_edge = from_edge(light, [s, t], triangle).lt(step) & reach.gt(step);
        p = V3::select(at_edge, p + inwards * (step / reach), p);
        let mut target = SurfacePoint { p, ng, ns: ng, error: V3::splat(error) };
        let cylinder = light.kind.is(LightKind::Cylinder);
        if cylinder.any() {
            on_cylinders::<P>(geometry, cylinder.bits(), light.primitive, again, u, &mut target);
        }
        let away = target.p - to.p;
        let distance2 = away.length2();
        let wi = away * (one / distance2.sqrt());
        let cos = target.ng.dot(wi).abs();
        pdf = P::select(near, pdf, pdf * (distance2 / cos));
        let found = distance2.gt(zero) & cos.gt(zero);
        sample.found = found | !is_point;
        sample.wi = V3::select(is_point, wi, sample.wi);
        sample.pdf = P::select(is_point, pdf, sample.pdf);
        sample.target = target;
    }
    if is_sphere.any() {
        let LightRecord { corner: centre, radius, .. } = *light;
        let (axis, narrow, outside) = cones(centre, radius, to.p);
        let one_minus_cos = P::select(outside, narrow, P::splat(2.0));
        // From its centre there is no axis, and need not be.
        let axis = V3::select(outside, axis, to.frame.n);
        let wi = Frame::around(axis).to_world(warp::cone(u, one_minus_cos));
        sample.wi = V3::select(is_sphere, wi, sample.wi);
        sample.is_in_cone = outside;
        sample.slack = light.error * P::splat(SLACK);
        sample.pdf = P::select(is_sphere, warp::cone_pdf(one_minus_cos), sample.pdf);
        sample.target.p = V3::select(is_sphere, centre, sample.target.p);
        sample.target.error = V3::select(is_sphere, V3::splat(radius), sample.target.error);
    }
    if is_environment.any() {
        let local = warp::cosine_hemisphere(u);
        let pdf = warp::cosine_hemisphere_pdf(local.z);
        sample.wi = V3::select(is_environment, to.frame.to_world(local), sample.wi);
        sample.pdf = P::select(is_environment, pdf, sample.pdf);
    }
    sample
}

/// How far a point at these parts of both sides lies from the nearest edge of a flat light, or, at a
/// triangle's third one, at least half of that; below 0 outside.
#[inline(always)]
fn from_edge<P: SimdWide>(light: &LightRecord<P>, [s, t]: [P; 2], triangle: P::Mask) -> P {
    let one = P::splat(1.0);
    let [a, b] = light.sides.map(|side| side.length());
    let parallelogram = P::select(triangle, P::splat(2.0), one) / light.one_over_area;
    let [across_a, across_b] = [parallelogram / a, parallelogram / b];
    let third = (one - s - t) * (parallelogram / (a + b));
    let opposite = ((one - s) * across_b).min((one - t) * across_a);
    (s * across_b).min(t * across_a).min(P::select(triangle, third, opposite))
}

/// The density with which [`sample`] at `p` finds a point of a light at a distance, its surface at
/// this cosine to the direction.
#[inline(always)]
pub(super) fn pdf<P: SimdWide>(light: &LightRecord<P>, p: V3<P>, distance: P, cos: P) -> P {
    let (zero, one) = (P::splat(0.0), P::splat(1.0));
    let mut pdf = (light.one_over_area * (distance * distance / cos)).or_zero(cos.gt(zero));
    let is_sphere = light.kind.is(LightKind::Sphere);
    if is_sphere.any() {
        let (_, narrow, outside) = cones(light.corner, light.radius, p);
        let cone = warp::cone_pdf(P::select(outside, narrow, P::splat(2.0)));
        pdf = P::select(is_sphere, cone, pdf);
    }
    let near = light.kind.is(LightKind::Rectangle) & light.is_near(p);
    if near.any() {
        let LightRecord { corner, sides, ng, .. } = *light;
        let filled = SphericalRectangle::new(corner, sides, ng, p).solid_angle;
        pdf = P::select(near, one / filled, pdf);
    }
    pdf
}

/// Axes and `1 - cos` of the cones that spheres fill as seen from `p`, and where that is outside.
#[inline(always)]
pub(super) fn cones<L: Simd>(centre: V3<L>, radius: L, p: V3<L>) -> (V3<L>, L, L::Mask) {
    let one = L::splat(1.0);
    let towards = centre - p;
    let distance = towards.length();
    let inverse = one / distance;
    // cos² of the half angle, without the loss of 1 - sin² next to the surface. A small or distant
    // sphere's rounds to 1, or beyond.
    let sin = radius * inverse;
    let cos2 = (distance - radius) * inverse * (one + sin);
    let one_minus_cos = (sin * sin).min(one) / (one + cos2.min(one).sqrt());
    (towards * inverse, one_minus_cos, distance.gt(radius))
}

/// Points on cylinders, which are rare: one by one.
#[cold]
#[inline(never)]
fn on_cylinders<P: SimdWide>(
    geometry: &Geometry,
    lanes: u32,
    primitive: P::Bits,
    again: P,
    u: [P; 2],
    target: &mut SurfacePoint<P>,
) {
    let mut fields = [[0.0; MAX_WIDTH]; 9];
    let columns = [target.p, target.ng, target.error];
    for (v, field) in columns.iter().zip(fields.chunks_exact_mut(3)) {
        for (x, field) in [v.x, v.y, v.z].iter().zip(field) {
            x.store(field);
        }
    }
    let (mut which, mut numbers) = ([0; MAX_WIDTH], [[0.0; MAX_WIDTH]; 3]);
    P::store_bits(primitive, &mut which);
    for (number, x) in numbers.iter_mut().zip([again, u[0], u[1]]) {
        x.store(number);
    }
    for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
        let Kind::Cylinder(cylinder) = geometry.kind(which[lane]) else { continue };
        let [again, u, v] = numbers.map(|number| number[lane]);
        let point = sample_cylinder(geometry, cylinder, again, [u, v]);
        for (v, field) in [point.p, point.ng, point.error].iter().zip(fields.chunks_exact_mut(3)) {
            for (x, field) in [v.x, v.y, v.z].iter().zip(field) {
                field[lane] = *x;
            }
        }
    }
    let back =
        |i: usize| V3::new(P::load(&fields[i]), P::load(&fields[i + 1]), P::load(&fields[i + 2]));
    (target.p, target.ng, target.error) = (back(0), back(3), back(6));
}

/// A point uniform over a cylinder: `choice` is for the part, `u` for where on it.
fn sample_cylinder(geometry: &Geometry, index: usize, choice: f32, u: [f32; 2]) -> SurfacePoint {
    let cylinder = &geometry.cylinders[index];
    let cap = cylinder.radius * 0.5 / (cylinder.height + cylinder.radius);
    let p = if choice < 2.0 * cap {
        let [x, y] = warp::disc(u);
        cylinder.cap_point(x, y, choice < cap)
    } else {
        let (sin, cos) = crate::math::special::sin_cos_2pi(u[0]);
        cylinder.side_point(cos, sin, u[1])
    };
    let point = cylinder.surface(p);
    SurfacePoint { error: point.error.max(V3::splat(geometry.least_error())), ..point }
}
