//! Lights for many lanes at once: one table of everything that emits.
//!
//! The same densities as the [reference](super::super::light): lights by power, spheres by the
//! solid angle that they fill, other shapes by area, the environment by the cosine. But triangles
//! are chosen at once, not first the mesh and then the triangle, and by 32-bit integers, so that no
//! probability is rounded.

use super::super::light::{area_of, cones, sample_cylinder};
use super::table::Table;
use crate::geometry::{
    Geometry, Kind, NO_PLATE, SurfacePoint, flat_surface, intersect_spheres, offset_origin,
};
use crate::math::lanes::{Bits, Lane, Mask, Packet};
use crate::math::{Frame, Rgb, V3, warp};
use crate::scene::{Material, Scene};
use std::f32::consts::PI;

/// Shadow rays end this close to 1: a distance along a ray is known to a few roundings of the whole.
const SHADOW_END: f32 = 1.0 - 16.0 * f32::EPSILON;

const TRIANGLE: f32 = 0.0;
const SPHERE: f32 = 1.0;
const CYLINDER: f32 = 2.0;
const ENVIRONMENT: f32 = 3.0;

/// Kind; three corners, or centre and radius, or nothing; probability; that over the area; radiance;
/// the bits of the plate's number.
const FIELDS: usize = 16;

#[derive(Debug)]
pub(super) struct LightTable {
    lights: Table<FIELDS>,
    /// For each light but the last the first 32-bit number that is beyond it.
    ends: Vec<u32>,
    /// Ranges of primitives that emit: first, count, and the first one's place in the table.
    ranges: Vec<[u32; 3]>,
    /// Those of them that are not triangles, by place in the table.
    primitives: Vec<u32>,
    environment_probability: f32,
}

/// Directions towards lights.
pub(super) struct Asked<P: Lane> {
    pub(super) wi: V3<P>,
    /// What arrives from there unless something is in between.
    pub(super) radiance: Rgb<P>,
    /// In 1/sr, the choice of the light included.
    pub(super) pdf: P,
    /// The shadow ray, up to `t_max`.
    pub(super) o: V3<P>,
    pub(super) d: V3<P>,
    pub(super) t_max: P,
    /// The plate that the light is, if it is one.
    pub(super) plate: P::Bits,
    /// Whether there is one.
    pub(super) found: P::Mask,
}

impl LightTable {
    pub(super) fn new(scene: &Scene, materials: &[Material]) -> LightTable {
        let (geometry, plates) = (scene.geometry(), scene.bvh().plates());
        let mut records = Vec::new();
        let mut powers = Vec::new();
        let mut ranges = Vec::new();
        let mut primitives = Vec::new();
        for surface in scene.surfaces() {
            let radiance = Rgb::from(materials[surface.material as usize].emission);
            let shape = surface.shape;
            if radiance.is_black() {
                continue;
            }
            ranges.push([shape.first, shape.count, records.len() as u32]);
            for primitive in shape.first..shape.first + shape.count {
                let area = area_of(geometry, primitive);
                let (kind, shape) = match geometry.kind(primitive) {
                    Kind::Triangle(i) => (TRIANGLE, geometry.corners(i)),
                    Kind::Sphere(i) => {
                        let sphere = geometry.spheres[i];
                        let radius = V3::new(sphere.radius, 0.0, 0.0);
                        (SPHERE, [sphere.centre, radius, V3::default()])
                    }
                    Kind::Cylinder(_) => (CYLINDER, [V3::default(); 3]),
                };
                let [a, b, c] = shape.map(<[f32; 3]>::from);
                powers.push(f64::from(radiance.luminance().max(1e-30)) * f64::from(area));
                let light = [radiance.r, radiance.g, radiance.b];
                records.push([
                    kind,
                    a[0],
                    a[1],
                    a[2],
                    b[0],
                    b[1],
                    b[2],
                    c[0],
                    c[1],
                    c[2],
                    0.0,
                    area,
                    light[0],
                    light[1],
                    light[2],
                    f32::from_bits(plates.plate_of(primitive)),
                ]);
                primitives.push(primitive);
            }
        }
        let environment = Rgb::from(scene.environment());
        if !environment.is_black() {
            // The scene fits into a sphere of radius sqrt 3, which the environment fills with light.
            powers.push(f64::from(environment.luminance() * 4.0 * PI * 3.0));
            let mut record = [0.0; FIELDS];
            record[0] = ENVIRONMENT;
            record[12..15].copy_from_slice(&<[f32; 3]>::from(environment));
            record[15] = f32::from_bits(NO_PLATE);
            records.push(record);
        }
        let widths = shares(&powers);
        let mut end = 0u64;
        let mut ends: Vec<u32> = Vec::new();
        for (record, &width) in records.iter_mut().zip(&widths) {
            end += u64::from(width);
            ends.push(end.min(u64::from(u32::MAX)) as u32);
            let probability = (f64::from(width) / RANGE) as f32;
            record[10] = probability;
            record[11] = if record[11] > 0.0 { probability / record[11] } else { 0.0 };
        }
        ends.pop();
        let environment_probability =
            records.last().filter(|r| r[0] == ENVIRONMENT).map_or(0.0, |r| r[10]);
        LightTable {
            lights: Table::new(records),
            ends,
            ranges,
            primitives,
            environment_probability,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lights.len() == 0
    }

    /// Density with which [`LightTable::sample`] at `p` finds the direction in which `primitive` was
    /// met at a distance, its surface at this cosine to the direction. In 1/sr.
    #[inline(always)]
    pub(super) fn pdf(&self, p: V3, primitive: u32, distance: f32, cos: f32) -> f32 {
        let after = self.ranges.partition_point(|r| r[0] <= primitive);
        let Some(&[first, count, base]) = after.checked_sub(1).and_then(|i| self.ranges.get(i))
        else {
            return 0.0;
        };
        if primitive - first >= count {
            return 0.0;
        }
        let light = self.lights.record((base + primitive - first) as usize);
        if light[0] == SPHERE {
            let centre = V3::new(light[1], light[2], light[3]);
            let (_, one_minus_cos, outside) = cones(centre, light[4], p);
            return warp::cone_pdf(if outside { one_minus_cos } else { 2.0 }) * light[10];
        }
        if cos > 0.0 { light[11] * (distance * distance / cos) } else { 0.0 }
    }

    /// Density with which [`LightTable::sample`] finds a direction at this cosine to the normal that
    /// hits nothing, in 1/sr.
    #[inline(always)]
    pub(super) fn environment_pdf<L: Lane>(&self, cos: L) -> L {
        warp::cosine_hemisphere_pdf(cos.max(L::splat(0.0))) * L::splat(self.environment_probability)
    }

    /// Directions from surface points, whose `ng` and frame face the viewer, towards some light
    /// each, by 32-bit numbers for which one and pairs of floats for where on it.
    #[inline(always)]
    pub(super) fn sample<P: Packet>(
        &self,
        geometry: &Geometry,
        from: &SurfacePoint<P>,
        frame: &Frame<P>,
        choice: P::Bits,
        u: [P; 2],
    ) -> Asked<P> {
        let zero = P::splat(0.0);
        let index = self.choose::<P>(choice);
        let light = self.lights.get::<P>(index);
        let kind = light[0];
        let corners = [
            V3::new(light[1], light[2], light[3]),
            V3::new(light[4], light[5], light[6]),
            V3::new(light[7], light[8], light[9]),
        ];
        let mut asked = Asked {
            wi: frame.n,
            radiance: Rgb::new(light[12], light[13], light[14]),
            pdf: zero,
            o: from.p,
            d: frame.n,
            t_max: P::splat(SHADOW_END),
            plate: light[15].to_bits(),
            found: P::mask(0),
        };
        let by_area = kind.equal(P::splat(TRIANGLE)) | kind.equal(P::splat(CYLINDER));
        if by_area.any() {
            let mut target = flat_surface(corners, warp::triangle(u));
            let cylinder = kind.equal(P::splat(CYLINDER));
            if cylinder.any() {
                self.on_cylinders::<P>(geometry, cylinder.bits(), index, choice, u, &mut target);
            }
            let away = target.p - from.p;
            let distance2 = away.length2();
            let wi = away * (P::splat(1.0) / distance2.sqrt());
            let cos = target.ng.dot(wi).abs();
            let pdf = light[11] * (distance2 / cos);
            let o = offset_origin(from.p, from.error, from.ng, wi);
            // From just off one surface to just off the other.
            let d = offset_origin(target.p, target.error, target.ng, -wi) - o;
            let found = by_area & distance2.gt(zero) & cos.gt(zero);
            asked.take(found, wi, pdf, o, d, P::splat(SHADOW_END));
        }
        let sphere = kind.equal(P::splat(SPHERE));
        if sphere.any() {
            let (centre, radius) = (corners[0], light[4]);
            let (axis, narrow, outside) = cones(centre, radius, from.p);
            let one_minus_cos = P::select(outside, narrow, P::splat(2.0));
            let wi = Frame::around(axis).to_world(warp::cone(u, one_minus_cos));
            let pdf = warp::cone_pdf(one_minus_cos) * light[10];
            let o = offset_origin(from.p, from.error, from.ng, wi);
            let [t0, t1] = intersect_spheres(centre, radius, o, wi);
            let t = P::select(t0.gt(zero), t0, t1);
            let met = t.gt(zero) & t.lt(P::splat(f32::INFINITY));
            // A direction of the cone meets the sphere but for rounding on the rim: then up to the
            // nearest point will do. The traversal meets it at the same number, so just short of it
            // is short enough.
            let nearest = (centre - o).dot(wi).max(zero);
            let t_max = P::select(met, t, nearest) * P::splat(1.0 - f32::EPSILON);
            asked.take(sphere & (met | outside), wi, pdf, o, wi, t_max);
        }
        let environment = kind.equal(P::splat(ENVIRONMENT));
        if environment.any() {
            let local = warp::cosine_hemisphere(u);
            let pdf = warp::cosine_hemisphere_pdf(local.z) * light[10];
            let wi = frame.to_world(local);
            let o = offset_origin(from.p, from.error, from.ng, wi);
            asked.take(environment, wi, pdf, o, wi, P::splat(f32::INFINITY));
        }
        asked.found = asked.found & asked.pdf.gt(zero) & asked.pdf.lt(P::splat(f32::INFINITY));
        asked
    }

    /// The places of the lights in whose shares the numbers are.
    #[inline(always)]
    fn choose<P: Packet>(&self, choice: P::Bits) -> P::Bits {
        if self.ends.len() < 16 {
            // A handful is counted through without a branch.
            let (zero, one) = (P::Bits::splat(0), P::Bits::splat(1));
            let mut index = zero;
            for &end in &self.ends {
                let before = P::less_bits(choice, P::Bits::splat(end));
                index = index + P::select_bits(before, zero, one);
            }
            return index;
        }
        let mut number = [0; 16];
        P::store_bits(choice, &mut number);
        for n in &mut number[..P::WIDTH] {
            *n = self.ends.partition_point(|&end| end <= *n) as u32;
        }
        P::load_bits(&number)
    }

    /// Points on cylinders, which are rare: one by one.
    #[cold]
    #[inline(never)]
    fn on_cylinders<P: Packet>(
        &self,
        geometry: &Geometry,
        lanes: u32,
        index: P::Bits,
        choice: P::Bits,
        u: [P; 2],
        target: &mut SurfacePoint<P>,
    ) {
        let mut fields = [[0.0; 16]; 9];
        let columns = [target.p, target.ng, target.error];
        for (v, field) in columns.iter().zip(fields.chunks_exact_mut(3)) {
            for (x, field) in [v.x, v.y, v.z].iter().zip(field) {
                x.store(field);
            }
        }
        let (mut which, mut number, mut pairs) = ([0; 16], [0; 16], [[0.0; 16]; 2]);
        P::store_bits(index, &mut which);
        P::store_bits(choice, &mut number);
        u[0].store(&mut pairs[0]);
        u[1].store(&mut pairs[1]);
        for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
            let place = which[lane] as usize;
            let Kind::Cylinder(cylinder) = geometry.kind(self.primitives[place]) else { continue };
            // What is left of the number after the choice is uniform again.
            let start = place.checked_sub(1).map_or(0.0, |i| f64::from(self.ends[i]));
            let width = f64::from(self.lights.record(place)[10]) * RANGE;
            let again = ((f64::from(number[lane]) - start) / width).clamp(0.0, 1.0) as f32;
            let point =
                sample_cylinder(geometry, cylinder, again, [pairs[0][lane], pairs[1][lane]]);
            for (v, field) in
                [point.p, point.ng, point.error].iter().zip(fields.chunks_exact_mut(3))
            {
                for (x, field) in [v.x, v.y, v.z].iter().zip(field) {
                    field[lane] = *x;
                }
            }
        }
        let back = |i: usize| {
            V3::new(P::load(&fields[i]), P::load(&fields[i + 1]), P::load(&fields[i + 2]))
        };
        (target.p, target.ng, target.error) = (back(0), back(3), back(6));
    }
}

impl<P: Packet> Asked<P> {
    #[inline(always)]
    fn take(&mut self, which: P::Mask, wi: V3<P>, pdf: P, o: V3<P>, d: V3<P>, t_max: P) {
        self.wi = V3::select(which, wi, self.wi);
        self.pdf = P::select(which, pdf, self.pdf);
        self.o = V3::select(which, o, self.o);
        self.d = V3::select(which, d, self.d);
        self.t_max = P::select(which, t_max, self.t_max);
        self.found = self.found | which;
    }
}

/// How many 32-bit numbers there are.
const RANGE: f64 = 4_294_967_296.0;

/// How many of the 32-bit numbers each light has: in proportion to its power, but at least one, so
/// that none is missed, and all of them together.
fn shares(powers: &[f64]) -> Vec<u32> {
    let total: f64 = powers.iter().sum();
    let spare = RANGE - powers.len() as f64;
    let mut widths: Vec<u32> =
        powers.iter().map(|p| 1 + (p / total * spare).clamp(0.0, spare) as u32).collect();
    let left = RANGE as u64 - widths.iter().map(|&w| u64::from(w)).sum::<u64>().min(RANGE as u64);
    // Rounding down has left some over: the brightest can do with them. One light alone has one
    // number fewer than there are.
    if let Some(most) = widths.iter_mut().max() {
        *most = most.saturating_add(left.min(u64::from(u32::MAX)) as u32);
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::math::lanes::U32;
    use crate::scene::SceneBuilder;
    use glam::DVec3;

    #[test]
    fn shares_are_all_numbers_and_follow_the_powers() {
        for powers in [
            vec![1.0],
            vec![1.0, 1.0],
            vec![1e-30, 1.0, 1e30],
            vec![3.0, 1.0, 0.0, 4.0],
            (1..=100_000).map(f64::from).collect(),
        ] {
            let widths = shares(&powers);
            let sum: u64 = widths.iter().map(|&w| u64::from(w)).sum();
            // A single light would need one number more than 32 bits count.
            assert!(sum == 1 << 32 || (powers.len() == 1 && sum == u64::from(u32::MAX)), "{sum}");
            let total: f64 = powers.iter().sum();
            for (power, &width) in powers.iter().zip(&widths) {
                assert!(width > 0);
                let wanted = power / total * RANGE;
                let off = (f64::from(width) - wanted).abs();
                assert!(
                    off <= 2.0 + powers.len() as f64,
                    "{power} of {total}: {width}, not {wanted}"
                );
            }
        }
    }

    /// Whether a light is asked for or met by chance, its density is one number.
    #[test]
    fn asked_and_met_have_one_density() {
        let mut b = SceneBuilder::new("lamps");
        let lamp = |b: &mut SceneBuilder, x: f64| {
            b.material(Material::light("lamp", [x, 2.0 * x, 0.5]).unwrap())
        };
        let (dim, bright) = (lamp(&mut b, 0.5), lamp(&mut b, 3.0));
        b.cuboid(DVec3::new(-3.0, 1.0, 2.0), DVec3::new(1.0, 0.5, 0.1), dim).unwrap();
        b.cuboid(DVec3::new(2.0, -1.0, 1.0), DVec3::new(0.2, 0.4, 0.3), bright).unwrap();
        b.sphere(DVec3::new(0.0, 2.0, 3.0), 0.6, bright).unwrap();
        b.cylinder(DVec3::new(0.0, -2.0, 2.0), DVec3::new(0.3, 0.0, 0.8), 0.3, dim).unwrap();
        b.environment = [0.1; 3];
        let scene = b.build();
        let (geometry, bvh) = (scene.geometry(), scene.bvh());
        let table = LightTable::new(&scene, scene.materials());
        let mut stack = bvh.stack();
        // Local units are not the scene's: any point between the lamps will do.
        let p = V3::new(0.05, -0.1, -0.6);
        let n = V3::new(0.0, 0.0, 1.0);
        let from = SurfacePoint { p, ng: n, ns: n, error: V3::splat(1e-7) };
        let (mut met, mut beyond) = (0, 0);
        for i in 1..6000u32 {
            let part = |a: f64| (a * f64::from(i)).fract();
            let choice = U32((part(0.618_033_988_7) * RANGE) as u32);
            let u = [part(0.754_877_666_2) as f32, part(0.569_840_290_9) as f32];
            let asked = table.sample::<f32>(geometry, &from, &Frame::around(n), choice, u);
            if !asked.found {
                continue;
            }
            let ray = Ray { o: asked.o, d: asked.wi };
            let Some(hit) = bvh.closest(geometry, &ray, f32::INFINITY, &mut stack) else {
                if asked.t_max == f32::INFINITY {
                    let density = table.environment_pdf(asked.wi.z);
                    assert!((density / asked.pdf - 1.0).abs() < 1e-5);
                    beyond += 1;
                }
                continue;
            };
            let surface = geometry.surface(&ray, &hit);
            let cos = surface.ng.dot(asked.wi).abs();
            let density = table.pdf(p, hit.primitive, hit.t, cos);
            // Another light may stand before the one that was asked.
            let asked_here = {
                let end = asked.o + asked.d * asked.t_max.min(1e3);
                (end - surface.p).length() < 5e-6
            };
            if asked_here && cos > 0.01 {
                let ratio = density / asked.pdf;
                assert!((ratio - 1.0).abs() < 2e-3, "{ratio} {hit:?} {}", asked.wi.z);
                met += 1;
            }
        }
        assert!(met > 1500 && beyond > 1500, "{met} {beyond}");
    }

    /// Few lights are counted through, many searched: both find the light in whose share a number
    /// is, at its very ends too.
    #[test]
    fn a_light_is_chosen_by_its_share() {
        for count in [1, 2, 15, 16, 17, 40, 1000] {
            let powers: Vec<f64> = (0..count).map(|i| f64::from(1 + i * 7 % 5)).collect();
            let widths = shares(&powers);
            let mut end = 0u64;
            let ends: Vec<u64> = widths
                .iter()
                .map(|&width| {
                    end += u64::from(width);
                    end
                })
                .collect();
            let table = LightTable {
                lights: Table::new(vec![[0.0; FIELDS]; count as usize]),
                ends: ends[..ends.len() - 1].iter().map(|&end| end as u32).collect(),
                ranges: Vec::new(),
                primitives: Vec::new(),
                environment_probability: 0.0,
            };
            for (light, &end) in ends.iter().enumerate() {
                let start = end - u64::from(widths[light]);
                for number in [start, (start + end) / 2, end - 1] {
                    let found = table.choose::<f32>(U32(number as u32)).0;
                    assert_eq!(found as usize, light, "{number} of {count}");
                }
            }
        }
    }
}
