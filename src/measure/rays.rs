//! What rays through a scene cost, without shading: rays of each kind a path has, on one thread.

use super::speed::Spread;
use crate::geometry::{Geometry, Hit, Kind, Query, Ray, SurfacePoint, offset_origin};
use crate::math::simd::U32;
use crate::math::soa::BATCH;
use crate::math::sobol::{Slot, Stream, mix, pair};
use crate::math::{Frame, V3, warp};
use crate::scene::{CameraRays, Scene};
use std::time::Instant;

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera, in the order of the pixels: neighbours share most of their way.
    Camera,
    /// From what those meet, in all directions as a diffuse surface scatters, shuffled: neighbours
    /// share nothing.
    Bounce,
    /// From there to points on lights, shuffled; whether anything is hit. Without lights, in the
    /// directions of [`RayKind::Bounce`] and without end.
    Shadow,
}

impl RayKind {
    /// All of them.
    pub const ALL: [RayKind; 3] = [RayKind::Camera, RayKind::Bounce, RayKind::Shadow];

    /// Lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            RayKind::Camera => "camera",
            RayKind::Bounce => "bounce",
            RayKind::Shadow => "shadow",
        }
    }
}

/// How fast rays of a kind are.
#[derive(Clone, Copy, Debug)]
pub struct RayRate {
    /// Which.
    pub kind: RayKind,
    /// How many there were; 0 where the camera sees nothing that they could start from.
    pub rays: usize,
    /// The part of them that hit something.
    pub hits: f64,
    /// Rays a second, one after the other.
    pub alone: Spread,
    /// Rays a second, [`TOGETHER`] at a time, as the engine traces them.
    pub together: Spread,
}

/// Rays that are traced together.
pub const TOGETHER: usize = BATCH;

/// What is to be measured.
#[derive(Clone, Copy, Debug)]
pub struct RayBench {
    /// Rays of each kind, at most 2^32.
    pub rays: usize,
    /// Width and height of the picture whose camera rays are taken.
    pub size: [u32; 2],
    /// How often each kind is measured; every repeat measures all kinds before the next begins.
    pub repeats: u32,
    /// Of the random numbers.
    pub seed: u64,
}

impl RayBench {
    /// Traces rays through a scene, on this thread alone.
    pub fn run(&self, scene: &Scene) -> Vec<RayRate> {
        let kinds = RayKind::ALL.map(|kind| (kind, self.queries(scene, kind)));
        let mut seconds = [(); 3].map(|()| [Vec::new(), Vec::new()]);
        let mut hits = [0; 3];
        let (geometry, bvh) = (scene.geometry(), scene.bvh());
        let mut stack = scene.stack();
        let (mut nearest, mut any) = (Vec::<Option<Hit>>::new(), Vec::<bool>::new());
        for _ in 0..self.repeats {
            for (at, (kind, queries)) in kinds.iter().enumerate() {
                let shadow = *kind == RayKind::Shadow;
                let start = Instant::now();
                let mut count = 0;
                for Query { ray, t_max } in queries {
                    count += if shadow {
                        bvh.occluded(geometry, ray, *t_max, &mut stack) as usize
                    } else {
                        bvh.closest(geometry, ray, *t_max, &mut stack).is_some() as usize
                    };
                }
                seconds[at][0].push(start.elapsed().as_secs_f64());
                let start = Instant::now();
                hits[at] = 0;
                for queries in queries.chunks(TOGETHER) {
                    hits[at] += if shadow {
                        bvh.occluded_each(geometry, queries, &mut stack, &mut any);
                        any.iter().filter(|hit| **hit).count()
                    } else {
                        bvh.closest_each(geometry, queries, &mut stack, &mut nearest);
                        nearest.iter().flatten().count()
                    };
                }
                seconds[at][1].push(start.elapsed().as_secs_f64());
                debug_assert_eq!(hits[at], count);
            }
        }
        let rate = |at: usize| {
            let (kind, queries) = &kinds[at];
            let n = queries.len();
            let per_second = |s: &Vec<f64>| {
                Spread::of(s.iter().filter(|_| n > 0).map(|s| n as f64 / s.max(1e-9)))
            };
            RayRate {
                kind: *kind,
                rays: n,
                hits: if n > 0 { hits[at] as f64 / n as f64 } else { 0.0 },
                alone: per_second(&seconds[at][0]),
                together: per_second(&seconds[at][1]),
            }
        };
        (0..3).map(rate).collect()
    }

    /// The rays of a kind: the same ones for the same seed.
    fn queries(&self, scene: &Scene, kind: RayKind) -> Vec<Query> {
        let camera = CameraRays::new(&scene.camera(), scene.placement(), self.size);
        let lights = lit_primitives(scene);
        let mut stack = scene.stack();
        let width = self.size[0] as usize;
        let pixels = width * self.size[1] as usize;
        let mut rays = Vec::with_capacity(self.rays);
        // Points that face away from the light give no shadow ray: others take their place.
        for n in 0..2 * self.rays {
            if rays.len() == self.rays {
                break;
            }
            let stream = Stream::new(self.seed, U32(n as u32 & 0xffff), U32(n as u32 >> 16), 0);
            let [dx, dy] = pair::<f32>(&stream, Slot::CAMERA);
            // Few rays are spread over the picture.
            let pixel = if self.rays < pixels { n % self.rays * pixels / self.rays } else { n };
            let (x, y) = (pixel % width, pixel / width % (pixels / width));
            let ray = camera.ray(x as f32 + dx, y as f32 + dy);
            if kind == RayKind::Camera {
                rays.push((n as u32, Query { ray, t_max: f32::INFINITY }));
                continue;
            }
            let hit = scene.bvh().closest(scene.geometry(), &ray, f32::INFINITY, &mut stack);
            let Some(hit) = hit else { continue };
            let from = scene.geometry().surface(&ray, &hit).turned_to(-ray.d);
            let query = if kind == RayKind::Shadow && !lights.is_empty() {
                shadow(scene.geometry(), &lights, &stream, &from)
            } else {
                let d = warp::cosine_hemisphere(pair::<f32>(&stream, Slot::direction(0)));
                let d = Frame::around(from.ng).to_world(d);
                Some(leaving(&from, d, f32::INFINITY))
            };
            rays.extend(query.map(|query| (mix(U32(n as u32)).0, query)));
        }
        rays.sort_by_key(|(place, _)| *place);
        rays.into_iter().map(|(_, query)| query).collect()
    }
}

fn leaving(from: &SurfacePoint, d: V3, t_max: f32) -> Query {
    Query { ray: Ray { o: offset_origin(from.p, from.error, from.ng, d), d }, t_max }
}

/// The primitives that emit.
fn lit_primitives(scene: &Scene) -> Vec<u32> {
    let emits = |m: u32| scene.materials()[m as usize].emits();
    let lit = scene.surfaces().iter().filter(|light| emits(light.material));
    lit.flat_map(|light| light.shape.first..light.shape.first + light.shape.count).collect()
}

/// Towards a point on one of these, or within the box around one; `None` if that lies behind.
fn shadow(
    geometry: &Geometry,
    lights: &[u32],
    stream: &Stream<U32>,
    from: &SurfacePoint,
) -> Option<Query> {
    let [which, _] = pair::<f32>(stream, Slot::choice(0));
    let u = pair::<f32>(stream, Slot::light(0));
    let within = |[low, high]: [V3; 2]| {
        let v = V3::new(u[0], u[1], which);
        low + V3::new((high - low).x * v.x, (high - low).y * v.y, (high - low).z * v.z)
    };
    let place = (which * lights.len() as f32) as usize;
    let to = match geometry.kind(lights[place.min(lights.len() - 1)]) {
        Kind::Triangle(i) => {
            let [a, b, c] = geometry.corners(i);
            let [v, w] = warp::triangle(u);
            a * (1.0 - v - w) + b * v + c * w
        }
        Kind::Sphere(i) => within(geometry.spheres[i].bounds()),
        Kind::Cylinder(i) => within(geometry.cylinders[i].bounds()),
    };
    let d = to - from.p;
    // Not as far as the light itself.
    (d.dot(from.ng) > 0.0).then(|| leaving(from, d, 0.999))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, SceneBuilder};
    use glam::DVec3;

    fn ball_and_lamp() -> Scene {
        let mut builder = SceneBuilder::new("a ball and a lamp");
        let grey = builder.material(Material::reflecting("", [0.5; 3], [0.0; 3], 1.0).unwrap());
        let emitter = builder.material(Material::light("", [1.0; 3]).unwrap());
        builder.sphere(DVec3::ZERO, 1.0, grey).unwrap();
        builder.sphere(DVec3::new(0.0, 0.0, 3.0), 0.5, emitter).unwrap();
        builder.build()
    }

    #[test]
    fn every_kind_is_measured_with_the_rays_asked_for() {
        let scene = ball_and_lamp();
        let bench = RayBench { rays: 2000, size: [40, 30], repeats: 3, seed: 1 };
        for rate in bench.run(&scene) {
            let asked = if rate.kind == RayKind::Camera { 2000..=2000 } else { 100..=2000 };
            assert!(asked.contains(&rate.rays), "{rate:?}");
            assert!(rate.alone.min > 0.0 && rate.together.min > 0.0, "{rate:?}");
            assert!((0.0..=1.0).contains(&rate.hits), "{rate:?}");
        }
    }

    #[test]
    fn shadow_rays_end_before_their_light() {
        let scene = ball_and_lamp();
        let bench = RayBench { rays: 500, size: [40, 30], repeats: 1, seed: 2 };
        let rays = bench.queries(&scene, RayKind::Shadow);
        assert!(!rays.is_empty() && rays.iter().all(|q| q.t_max == 0.999));
        // The upper half of a ball sees a small emitter above it; nothing else is in the way.
        let (geometry, mut stack) = (scene.geometry(), scene.stack());
        let free = |q: &&Query| !scene.bvh().occluded(geometry, &q.ray, 0.5, &mut stack);
        assert!(rays.iter().filter(free).count() > rays.len() / 4);
    }

    #[test]
    fn nothing_seen_is_no_ray() {
        let scene = SceneBuilder::new("empty").build();
        let bench = RayBench { rays: 10, size: [4, 4], repeats: 2, seed: 0 };
        let rates = bench.run(&scene);
        assert_eq!(rates[1].rays, 0);
        assert!(rates[1].together.median.is_nan());
    }
}
