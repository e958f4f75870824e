//! Lights: which to ask, where on it, and with what density.

use crate::geometry::{Geometry, Kind, PrimitiveRange, Sphere, SurfacePoint};
use crate::math::warp;
use crate::math::{Frame, Lane, Rgb, V3};
use crate::scene::{Material, Scene};
use std::f32::consts::PI;

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightSample {
    /// Unit, leaving the surface.
    pub wi: V3,
    /// What arrives from there unless something is in between.
    pub radiance: Rgb,
    /// Density in 1/sr, the choice of the light included; above 0.
    pub pdf: f32,
    /// Where on the light.
    pub target: Target,
}

/// The end of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// The environment.
    Infinity,
    /// A known point.
    Point(SurfacePoint),
    /// Where the direction meets this sphere, if it does: found only if the ray is traced at all.
    Sphere(Sphere),
    /// The same for a direction within the cone that the sphere fills, which meets it for certain.
    SphereWithin(Sphere),
}

/// Where a shadow ray ends.
pub(super) enum End {
    /// Nowhere: the direction misses the light after all.
    Missed,
    /// At this distance along the direction, which may be infinite.
    Distance(f32),
    /// On this surface.
    At(SurfacePoint),
}

impl Target {
    /// The end of a ray from `o` in the direction `wi`.
    #[inline(always)]
    pub(super) fn end(&self, o: V3, wi: V3) -> End {
        // The traversal meets the sphere at this same number, so just short of it is short enough.
        let before = |t: f32| End::Distance(t * (1.0 - f32::EPSILON));
        match self {
            Target::Infinity => End::Distance(f32::INFINITY),
            Target::Point(point) => End::At(*point),
            Target::Sphere(sphere) => {
                sphere.intersect(o, wi, f32::INFINITY).map_or(End::Missed, before)
            }
            Target::SphereWithin(sphere) => {
                // On the rim rounding may make it miss: then up to the nearest point will do.
                let nearest = || (sphere.centre - o).dot(wi).max(0.0);
                before(sphere.intersect(o, wi, f32::INFINITY).unwrap_or_else(nearest))
            }
        }
    }
}

/// All that emits, with the probability of each being asked.
///
/// Lights are chosen by power. Spheres are sampled by the solid angle they fill, other shapes by
/// area, the uniform environment by the cosine.
#[derive(Debug)]
pub(super) struct Lights {
    emitters: Vec<Emitter>,
    environment: Rgb,
    /// Running sums of the choice probabilities; the environment is last.
    cumulative: Vec<f32>,
}

#[derive(Debug)]
struct Emitter {
    shape: PrimitiveRange,
    radiance: Rgb,
    area: f32,
    /// Running sums of the triangles' areas; empty for a single primitive.
    areas: Vec<f32>,
}

impl Lights {
    /// Those of a scene with these materials; `equally` has each asked as often as the others,
    /// whatever its power.
    pub(super) fn new(scene: &Scene, materials: &[Material], equally: bool) -> Lights {
        let geometry = scene.geometry();
        let mut emitters = Vec::new();
        let mut powers = Vec::new();
        for surface in scene.surfaces() {
            let radiance = Rgb::from(materials[surface.material as usize].emission);
            if radiance.is_black() {
                continue;
            }
            let emitter = Emitter::new(geometry, surface.shape, radiance);
            if emitter.area > 0.0 {
                powers.push((radiance.luminance().max(1e-30) * emitter.area) as f64);
                emitters.push(emitter);
            }
        }
        let environment = Rgb::from(scene.environment());
        // The scene fits into a sphere of radius sqrt 3, which the environment fills with light.
        powers.push((environment.luminance() * 4.0 * PI * 3.0) as f64);
        if equally {
            powers.iter_mut().for_each(|power| *power = f64::from(*power > 0.0));
        }
        let total: f64 = powers.iter().sum();
        let mut sum = 0.0;
        let mut cumulative: Vec<f32> = powers
            .iter()
            .map(|p| {
                sum += p;
                if total > 0.0 { (sum / total) as f32 } else { 0.0 }
            })
            .collect();
        if let (Some(last), true) = (cumulative.last_mut(), total > 0.0) {
            *last = 1.0;
        }
        Lights { emitters, environment, cumulative }
    }

    /// What comes from a direction that hits nothing.
    #[inline(always)]
    pub(super) fn environment(&self) -> Rgb {
        self.environment
    }

    /// How many there are, the environment included if it shines.
    pub(super) fn count(&self) -> usize {
        (0..self.cumulative.len()).filter(|&i| self.probability(i) > 0.0).count()
    }

    #[inline(always)]
    fn probability(&self, index: usize) -> f32 {
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        self.cumulative[index] - before
    }

    /// A direction from `p`, whose shading normal `n` faces the viewer, towards some light.
    #[inline(always)]
    pub(super) fn sample(
        &self,
        geometry: &Geometry,
        p: V3,
        n: V3,
        choice: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        // A handful of lights is counted through without a branch.
        let index = if self.cumulative.len() <= 16 {
            self.cumulative.iter().map(|&c| (c <= choice) as usize).sum()
        } else {
            self.cumulative.partition_point(|&c| c <= choice)
        };
        let probability = self.probability(index.min(self.cumulative.len() - 1));
        if index >= self.cumulative.len() || probability <= 0.0 {
            return None;
        }
        let Some(emitter) = self.emitters.get(index) else {
            let local = warp::cosine_hemisphere(u);
            let pdf = warp::cosine_hemisphere_pdf(local.z) * probability;
            let wi = Frame::around(n).to_world(local);
            let (radiance, target) = (self.environment, Target::Infinity);
            return Some(LightSample { wi, radiance, pdf, target });
        };
        // What is left of the number after the choice is uniform again.
        let before = self.cumulative[index] - probability;
        let again = ((choice - before) / probability).clamp(0.0, 1.0);
        let (wi, pdf, target) = emitter.sample(geometry, p, again, u)?;
        let pdf = pdf * probability;
        (pdf > 0.0 && pdf.is_finite()).then_some(LightSample {
            wi,
            radiance: emitter.radiance,
            pdf,
            target,
        })
    }

    /// Density with which [`Lights::sample`] at `p` finds the direction `wi` in which `hit` of
    /// `primitive` was met at `distance`, in 1/sr.
    #[inline(always)]
    pub(super) fn pdf(
        &self,
        geometry: &Geometry,
        p: V3,
        wi: V3,
        primitive: u32,
        hit: &SurfacePoint,
        distance: f32,
    ) -> f32 {
        let index = self.emitters.partition_point(|e| e.shape.first + e.shape.count <= primitive);
        match self.emitters.get(index) {
            Some(emitter) if emitter.shape.contains(primitive) => {
                emitter.pdf(geometry, p, wi, hit, distance) * self.probability(index)
            }
            _ => 0.0,
        }
    }

    /// Density with which [`Lights::sample`] finds a direction at this cosine to the normal that
    /// hits nothing, in 1/sr.
    #[inline(always)]
    pub(super) fn environment_pdf(&self, cos: f32) -> f32 {
        warp::cosine_hemisphere_pdf(cos.max(0.0)) * self.probability(self.emitters.len())
    }
}

impl Emitter {
    fn new(geometry: &Geometry, shape: PrimitiveRange, radiance: Rgb) -> Emitter {
        let mut sum = 0.0f64;
        let areas: Vec<f32> = (shape.first..shape.first + shape.count)
            .map(|primitive| {
                sum += area_of(geometry, primitive) as f64;
                sum as f32
            })
            .collect();
        let areas = if areas.len() > 1 { areas } else { Vec::new() };
        Emitter { shape, radiance, area: sum as f32, areas }
    }

    #[inline(always)]
    fn sample(
        &self,
        geometry: &Geometry,
        p: V3,
        choice: f32,
        u: [f32; 2],
    ) -> Option<(V3, f32, Target)> {
        let target = match geometry.kind(self.shape.first) {
            Kind::Sphere(i) => return Some(sample_sphere(geometry.spheres[i], p, u)),
            Kind::Cylinder(i) => sample_cylinder(geometry, i, choice, u),
            Kind::Triangle(first) => {
                let wanted = choice * self.area;
                let offset = self.areas.partition_point(|&a| a <= wanted);
                let offset = offset.min(self.areas.len().saturating_sub(1));
                geometry.triangle_surface(first + offset, warp::triangle(u))
            }
        };
        let away = target.p - p;
        let distance2 = away.length2();
        if distance2 <= 0.0 {
            return None;
        }
        let distance = distance2.sqrt();
        let wi = away * (1.0 / distance);
        Some((wi, self.area_pdf(wi, &target, distance), Target::Point(target)))
    }

    #[inline(always)]
    fn pdf(&self, geometry: &Geometry, p: V3, wi: V3, hit: &SurfacePoint, distance: f32) -> f32 {
        match geometry.kind(self.shape.first) {
            Kind::Sphere(i) => sphere_pdf(geometry.spheres[i], p),
            _ => self.area_pdf(wi, hit, distance),
        }
    }

    /// A density of 1/area, per solid angle.
    #[inline(always)]
    fn area_pdf(&self, wi: V3, hit: &SurfacePoint, distance: f32) -> f32 {
        let cos = hit.ng.dot(wi).abs();
        if cos > 0.0 { distance * distance / (cos * self.area) } else { 0.0 }
    }
}

/// A primitive's whole surface.
pub(super) fn area_of(geometry: &Geometry, primitive: u32) -> f32 {
    match geometry.kind(primitive) {
        Kind::Triangle(i) => {
            let [a, b, c] = geometry.corners(i);
            (b - a).cross(c - a).length() * 0.5
        }
        Kind::Sphere(i) => 4.0 * PI * geometry.spheres[i].radius.powi(2),
        Kind::Cylinder(i) => {
            let c = &geometry.cylinders[i];
            2.0 * PI * c.radius * (c.height + c.radius)
        }
    }
}

#[inline(always)]
fn sample_sphere(sphere: Sphere, p: V3, u: [f32; 2]) -> (V3, f32, Target) {
    match cone(sphere, p) {
        Some((axis, one_minus_cos)) => {
            let wi = Frame::around(axis).to_world(warp::cone(u, one_minus_cos));
            (wi, warp::cone_pdf(one_minus_cos), Target::SphereWithin(sphere))
        }
        None => (warp::sphere(u), warp::cone_pdf(2.0), Target::Sphere(sphere)),
    }
}

/// Axis and `1 - cos` of the cone that a sphere fills as seen from `p` outside it; `None` inside.
#[inline(always)]
fn cone(sphere: Sphere, p: V3) -> Option<(V3, f32)> {
    let (axis, one_minus_cos, outside) = cones(sphere.centre, sphere.radius, p);
    outside.then_some((axis, one_minus_cos))
}

/// The same for lanes of spheres and points, with which of the points are outside.
#[inline(always)]
pub(super) fn cones<L: Lane>(centre: V3<L>, radius: L, p: V3<L>) -> (V3<L>, L, L::Mask) {
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

#[inline(always)]
fn sphere_pdf(sphere: Sphere, p: V3) -> f32 {
    warp::cone_pdf(cone(sphere, p).map_or(2.0, |(_, one_minus_cos)| one_minus_cos))
}

/// A point uniform over a cylinder: `choice` is for the part, `u` for where on it.
pub(super) fn sample_cylinder(
    geometry: &Geometry,
    index: usize,
    choice: f32,
    u: [f32; 2],
) -> SurfacePoint {
    let cylinder = &geometry.cylinders[index];
    let cap = cylinder.radius * 0.5 / (cylinder.height + cylinder.radius);
    let p = if choice < 2.0 * cap {
        let [x, y] = warp::disc(u);
        cylinder.cap_point(x, y, choice < cap)
    } else {
        let (sin, cos) = crate::math::special::sin_cos_2pi(u[0]);
        cylinder.side_point(cos, sin, u[1])
    };
    cylinder.surface(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::scene::SceneBuilder;
    use glam::{DAffine3, DVec3};

    /// Numbers in [0, 1), ends included, in an order without pattern.
    fn numbers() -> impl Iterator<Item = [f32; 3]> {
        let top = 1.0 - f32::EPSILON / 2.0;
        let ends = [0.0, f32::EPSILON / 2.0, 0.5, top];
        let corners = (0..64).map(move |i| [ends[i % 4], ends[i / 4 % 4], ends[i / 16]]);
        let between = (1..4000u32).map(|i| {
            [0.754_877_7, 0.569_840_3, 0.430_159_7].map(|a: f64| (a * f64::from(i)).fract() as f32)
        });
        corners.chain(between.map(move |u| u.map(|x| x.min(top))))
    }

    fn wide(v: V3) -> DVec3 {
        DVec3::new(v.x.into(), v.y.into(), v.z.into())
    }

    /// From a spark to a ball whose surface is a hundredth of a millionth of its radius away.
    #[test]
    fn the_cone_of_a_sphere_is_known_at_every_size() {
        let ratios = [1e-6, 1e-4, 1e-3, 0.03, 0.5, 0.9, 0.99, 1.0 - 1e-3, 1.0 - 1e-5, 1.0 - 1e-7];
        for ratio in ratios {
            for towards in [DVec3::X, DVec3::new(0.3, -0.8, 0.5).normalize()] {
                let centre = V3::from((towards * 0.7).as_vec3().to_array());
                let sphere = Sphere { centre, radius: (0.7 * ratio) as f32 };
                let (p, radius) = (V3::default(), f64::from(sphere.radius));
                // 1 - cos as 2 sin²(half the angle), for distances as far off as their rounding.
                let exact = |off: f64| {
                    let sin = (radius / (wide(centre).length() * (1.0 + off))).min(1.0);
                    2.0 * (sin.asin() / 2.0).sin().powi(2)
                };
                let Some((axis, found)) = cone(sphere, p) else {
                    assert!(ratio > 1.0 - 1e-6, "{ratio}: taken for inside");
                    continue;
                };
                let (low, high) = (exact(1.5e-7) * (1.0 - 1e-6), exact(-1.5e-7) * (1.0 + 1e-6));
                let found = f64::from(found);
                assert!((low..=high).contains(&found), "{ratio}: {low} {found} {high}");
                for [u, v, _] in numbers() {
                    let (wi, pdf, _) = sample_sphere(sphere, p, [u, v]);
                    assert!((pdf * sphere_pdf(sphere, p).recip() - 1.0).abs() < 1e-6, "{ratio}");
                    assert!((wi.length() - 1.0).abs() < 1e-6, "{ratio}: {wi:?}");
                    let off = 0.5 * (wi - axis).length2();
                    assert!(
                        f64::from(off) < found * (1.0 + 1e-4) + 1e-13,
                        "{ratio}: {off} {found}"
                    );
                    // The shadow ray ends on the near side of the sphere.
                    match Target::SphereWithin(sphere).end(p, wi) {
                        End::Distance(t) => {
                            let t = f64::from(t);
                            assert!((0.0..0.7 * (1.0 + 1e-6)).contains(&t), "{ratio}: ends at {t}");
                        }
                        _ => panic!("{ratio}: a direction within the cone missed"),
                    }
                }
            }
        }
    }

    /// From inside and from the surface itself all directions are asked alike.
    #[test]
    fn inside_a_sphere_the_cone_is_everything() {
        let sphere = Sphere { centre: V3::new(0.25, 0.5, -0.5), radius: 0.25 };
        for x in [0.25, 0.3, 0.375, 0.5] {
            let p = V3::new(x, 0.5, -0.5);
            assert!((sphere_pdf(sphere, p) * 4.0 * PI - 1.0).abs() < 1e-6);
            let mut upwards = 0;
            for [u, v, _] in numbers() {
                let (wi, pdf, target) = sample_sphere(sphere, p, [u, v]);
                assert!((pdf * 4.0 * PI - 1.0).abs() < 1e-6 && (wi.length() - 1.0).abs() < 1e-6);
                upwards += i32::from(wi.y > 0.0);
                match target.end(p, wi) {
                    End::Distance(t) => assert!(t > 0.0 && t <= 0.5, "at {x}: {t}"),
                    // From the surface, outwards.
                    End::Missed => assert!(x == 0.5 && wi.x >= -1e-6, "at {x}: missed {wi:?}"),
                    End::At(_) => panic!("a sphere's end is a distance"),
                }
            }
            assert!((1900..2200).contains(&upwards), "{upwards}");
        }
    }

    /// A point of a light is asked for with the density with which it is known when met, whatever
    /// the shape; that is what makes the weights of the two ways sum to 1.
    #[test]
    fn asked_and_met_have_one_density() {
        let mut b = SceneBuilder::new("lamps");
        let lamp = b.material(Material::light("lamp", [1.0, 2.0, 3.0]).unwrap());
        let dim = b.material(Material::light("dim", [1e-3; 3]).unwrap());
        let v = DVec3::new;
        b.sphere(v(0.6, 0.5, 0.1), 0.2, lamp).unwrap();
        b.sphere(v(-0.4, 0.8, 0.0), 1e-4, dim).unwrap();
        b.cylinder(v(-0.5, -0.6, -0.3), v(0.1, 0.2, 0.5), 0.15, lamp).unwrap();
        b.cuboid(v(0.4, -0.7, -0.4), v(0.3, 0.2, 0.6), dim).unwrap();
        let mesh = crate::scene::Mesh {
            positions: vec![
                v(-0.9, 0.0, 0.8),
                v(0.9, 0.1, 0.8),
                v(0.0, 0.6, 0.9),
                v(0.9, 0.2, 0.8),
            ],
            normals: vec![],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
        };
        b.mesh(&mesh, DAffine3::IDENTITY, lamp).unwrap();
        let scene = b.build();
        let lights = Lights::new(&scene, scene.materials(), false);
        let (g, mut stack) = (scene.geometry(), scene.bvh().stack());
        let (mut met, mut kinds) = (0, [0; 3]);
        for [choice, u, w] in numbers() {
            for p in [V3::default(), V3::new(0.05, -0.1, 0.45), V3::new(-0.2, 0.15, -0.6)] {
                let n = V3::new(0.0, 0.0, 1.0);
                let Some(asked) = lights.sample(g, p, n, choice, [u, w]) else { continue };
                assert!(asked.pdf > 0.0 && asked.pdf.is_finite());
                let ray = Ray { o: p, d: asked.wi };
                let hit = scene.bvh().closest(g, &ray, f32::INFINITY, &mut stack);
                let Some(hit) = hit else { continue };
                let surface = g.surface(&ray, &hit);
                // What is in front of the point asked for is another question.
                let reached = match asked.target.end(p, asked.wi) {
                    // On a rim either face may be met.
                    End::At(q) => {
                        (q.p - surface.p).length() < 1e-5 && q.ng.dot(surface.ng).abs() > 0.99
                    }
                    End::Distance(t) => (t - hit.t).abs() < 1e-5 * hit.t,
                    End::Missed => false,
                };
                // A grazing angle magnifies the last digit of the point.
                if !reached || surface.ng.dot(asked.wi).abs() < 0.02 {
                    continue;
                }
                let known = lights.pdf(g, p, asked.wi, hit.primitive, &surface, hit.t);
                assert!((known / asked.pdf - 1.0).abs() < 2e-3, "{hit:?}: {known} {}", asked.pdf);
                let of_kind = match g.kind(hit.primitive) {
                    Kind::Triangle(_) => 0,
                    Kind::Sphere(_) => 1,
                    Kind::Cylinder(_) => 2,
                };
                kinds[of_kind] += 1;
                met += 1;
            }
        }
        assert!(met > 6000 && kinds.iter().all(|&n| n > 500), "{met} {kinds:?}");
    }
}
