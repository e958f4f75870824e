//! Light sampling: which light, which point on it, and with what density in 1/sr.
//!
//! One table of everything that emits, for one path or many side by side. A light is chosen in
//! proportion to [what may come from it](importance), of up to sixteen by looking at all, of more by
//! [a tree](tree). Spheres are sampled by the solid angle that they fill, [rectangles](spherical_rectangle)
//! too where they are near, everything else by area, the environment by the cosine. All of this is
//! a function of the surface point and the light alone, so that a light hit by chance has the
//! density with which light sampling would have found it.

mod importance;
mod merge_triangles;
mod record;
mod sample;
mod spherical_rectangle;
#[cfg(test)]
mod tests;
mod tree;

pub(super) use importance::{LightDisc, LightSampleContext};
pub(super) use sample::{LightSample, SHADOW_END};

use crate::geometry::{Aabb, Bvh, Geometry, Kind, NO_SURFACE, PacketSlabs};
use crate::math::record::RecordField;
use crate::math::simd::{Bits, MAX_WIDTH, Simd, SimdWide};
use crate::math::{Rgb, V3, warp};
use crate::scene::{Material, Scene};
use importance::LightBounds;
use record::{LightShape, LightTable};
use std::f32::consts::PI;
use tree::LightBvh;

/// The largest number below 1.
pub(super) const ALMOST_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
/// Most lights that are weighed one by one.
const FEW: usize = 16;
/// All lights that may contribute have this share of the choice between them whatever is estimated:
/// the bright one may be behind a wall.
const BLIND: f32 = 1.0 / 32.0;
/// Most branches of a tree that are weighed one by one; below them one is found by descent. The
/// environment comes besides.
const BRANCHES: usize = 64;
const MOST: usize = BRANCHES + 1;
/// Primitives without area are no lights.
const NONE: u32 = u32::MAX;

/// All that emits.
#[derive(Debug)]
pub(super) struct Lights {
    records: LightTable,
    /// What is looked at: every light, or branches of the tree.
    branches: Vec<LightBounds>,
    /// What they are, by place or as the tree has it. The environment, if it shines, is the last
    /// light and the last here.
    links: Vec<u32>,
    /// First and last primitive of each light, where some are behind what they coincide with.
    hidden: Vec<[u32; 2]>,
    /// Over lights that are more than [`FEW`].
    tree: Option<LightBvh>,
    /// Ranges of primitives that emit: first, count, and the first one's place in `light_of`.
    ranges: Vec<[u32; 3]>,
    light_of: Vec<u32>,
    /// Around all that can be hit: each, or everything together.
    aabbs: Vec<Aabb>,
    environment: Rgb,
    /// Luminance in units of the brightest light's; 0 for none.
    sky: f32,
    equally: bool,
}

/// A light, its probability, and what is left of the number that chose it, uniform again.
struct LightChoice<P: Simd> {
    index: P::Bits,
    probability: P,
    rest: P,
}

impl Lights {
    /// About how many bytes of memory it holds.
    pub(super) fn bytes(&self) -> usize {
        // A light has a record, its place in it, and two nodes of the tree.
        let light = record::LIGHT_BYTES + 2 * tree::NODE_BYTES + 64;
        self.links.len() * light + self.light_of.len() * 4 + self.ranges.len() * 12
    }

    /// Those of a scene with these materials; `equally` has each sampled as often as the others,
    /// wherever it is.
    pub(super) fn new(scene: &Scene, materials: &[Material], equally: bool) -> Lights {
        let (geometry, bvh) = (scene.geometry(), scene.bvh());
        let environment = Rgb::from(scene.environment());
        let emits = |m: u32| Rgb::from(materials[m as usize].emission);
        let radiances = scene.surfaces().iter().map(|s| emits(s.material)).chain([environment]);
        let brightest = radiances.map(Rgb::luminance).fold(f32::MIN_POSITIVE, f32::max);
        let relative = |radiance: Rgb| (radiance.luminance() / brightest).clamp(1e-20, 1.0);
        let (mut records, mut bounds) = (Vec::new(), Vec::new());
        let (mut ranges, mut light_of) = (Vec::new(), Vec::new());
        let (coincident, mut hidden) = (scene.bvh().coincident(), Vec::new());
        for surface in scene.surfaces() {
            let (radiance, shape) = (emits(surface.material), surface.shape);
            if radiance.is_black() {
                continue;
            }
            let base = light_of.len();
            ranges.push([shape.first, shape.count, base as u32]);
            light_of.resize(base + shape.count as usize, NONE);
            for (shape, primitives) in record::of(geometry, shape) {
                if !(shape.area() > 0.0 && shape.area() < f32::INFINITY) {
                    continue;
                }
                for primitive in primitives {
                    light_of[base + (primitive - surface.shape.first) as usize] =
                        records.len() as u32;
                }
                let [a, b] = primitives.map(|primitive| bvh.surface_id(primitive));
                // Points are sampled on either side of a cylinder, and the near side hides the far one.
                let whole = a == b && !matches!(shape, LightShape::Cylinder(..));
                let surface_id = if whole { a } else { NO_SURFACE };
                records.push(shape.record(
                    primitives[0],
                    radiance,
                    surface_id,
                    geometry.least_error(),
                ));
                hidden.push(primitives);
                bounds.push(shape.bound(relative(radiance)));
            }
        }
        if hidden.iter().flatten().all(|&i| coincident.fronts(i).is_empty()) {
            hidden.clear();
        }
        let sky = if environment.is_black() { 0.0 } else { relative(environment) };
        if sky > 0.0 {
            records.push(LightShape::Environment.record(u32::MAX, environment, NO_SURFACE, 0.0));
        }
        let boxes = bounds.iter().map(|b| Aabb { centre: b.centre, half: b.half });
        let aabbs = match bounds.len() {
            ..=FEW => boxes.collect(),
            _ => Aabb::around(boxes).into_iter().collect(),
        };
        let mut links: Vec<u32> = (0..bounds.len() as u32).collect();
        let (mut branches, mut tree, mut leaf) = (bounds, None, 0);
        if records.len() > FEW {
            let (over, parts) = LightBvh::new(&branches, BRANCHES);
            links = parts.iter().map(|part| part.link).collect();
            branches = parts.iter().map(|part| part.bound).collect();
            (tree, leaf) = (Some(over), tree::LEAF);
        }
        if sky > 0.0 {
            links.push(leaf | (records.len() as u32 - 1));
        }
        let records = LightTable::new(records);
        Lights {
            records,
            branches,
            links,
            hidden,
            tree,
            ranges,
            light_of,
            aabbs,
            environment,
            sky,
            equally,
        }
    }

    /// How many there are, the environment included if it shines.
    pub(super) fn count(&self) -> usize {
        self.records.len()
    }

    /// Whether the probability of a light depends on the place.
    pub(super) fn choose_by_place(&self) -> bool {
        self.count() > 1
    }

    /// The boxes of emitters, where they are so few that each has its own.
    pub(super) fn emitter_boxes(&self) -> &[Aabb] {
        if self.tree.is_none() { &self.aabbs } else { &[] }
    }

    /// The strongest lights or branches of the tree, at most so many, and the irradiance of the
    /// environment in their units.
    pub(super) fn discs(&self, most: usize) -> (Vec<LightDisc>, f32) {
        let mut discs: Vec<LightDisc> = self.branches.iter().map(LightBounds::disc).collect();
        discs.sort_by(|a, b| b.intensity.total_cmp(&a.intensity));
        discs.truncate(most);
        (discs, PI * self.sky)
    }

    /// Whether emitters are all that shines.
    pub(super) fn has_no_environment(&self) -> bool {
        self.sky == 0.0
    }

    /// The rays that may hit something that emits: from those that are not, there comes nothing.
    #[inline(always)]
    pub(super) fn may_hit_emitter<P: SimdWide>(&self, o: V3<P>, d: V3<P>) -> P::Mask {
        let mut may = P::mask(if self.sky > 0.0 { u32::MAX } else { 0 });
        let slabs = PacketSlabs::new(o, d);
        for aabb in &self.aabbs {
            may = may | slabs.may_hit(aabb, P::splat(f32::INFINITY));
        }
        may
    }

    /// What comes from a direction that hits nothing.
    #[inline(always)]
    pub(super) fn environment(&self) -> Rgb {
        self.environment
    }

    /// Directions from surface points, whose `ng` faces the viewer, towards some light each, by a
    /// uniform number for which one and two for where on it. There has to be a light. Points that are
    /// behind another surface in the same place are not found.
    #[inline(always)]
    pub(super) fn sample<P: SimdWide>(
        &self,
        bvh: &Bvh,
        geometry: &Geometry,
        to: &LightSampleContext<P>,
        choice: P,
        u: [P; 2],
    ) -> LightSample<P> {
        let chosen = self.choose(to, choice);
        let record = self.records.get::<P>(chosen.index);
        let mut sample = sample::sample(geometry, &record, to, chosen.rest, u);
        sample.pdf = sample.pdf * chosen.probability;
        if !self.hidden.is_empty() {
            let mut lights = [0; MAX_WIDTH];
            P::store_bits(chosen.index, &mut lights);
            sample.drop_hidden(|lane, p, ng| {
                let primitives = self.hidden.get(lights[lane] as usize).into_iter().flatten();
                primitives.copied().any(|i| bvh.coincident().is_behind(geometry, i, p, ng))
            });
        }
        let zero = P::splat(0.0);
        sample.found = sample.found & sample.pdf.gt(zero) & sample.pdf.lt(P::splat(f32::INFINITY));
        sample
    }

    /// Densities with which [`Lights::sample`] finds the directions in which these primitives, one a
    /// lane, were hit at a distance, their surfaces at this cosine to the directions. In 1/sr; 0 for a
    /// primitive that is no light.
    #[inline(always)]
    pub(super) fn pdf<P: SimdWide>(
        &self,
        to: &LightSampleContext<P>,
        primitives: &[u32],
        distance: P,
        cos: P,
    ) -> P {
        let mut lights = [NONE; MAX_WIDTH];
        for (light, &primitive) in lights.iter_mut().zip(primitives) {
            *light = self.light_of(primitive).unwrap_or(NONE);
        }
        let lights = P::load_bits(&lights);
        let none = P::equal_bits(lights, P::Bits::splat(NONE));
        let lights = P::select_bits(none, P::Bits::splat(0), lights);
        let record = self.records.get::<P>(lights);
        let density = sample::pdf(&record, to.p, distance, cos);
        (density * self.probability(to, lights)).or_zero(!none)
    }

    /// The light that a primitive is, or is part of.
    fn light_of(&self, primitive: u32) -> Option<u32> {
        let after = self.ranges.partition_point(|r| r[0] <= primitive);
        let [first, count, base] = *self.ranges.get(after.checked_sub(1)?)?;
        let at = primitive - first;
        let light = (at < count).then(|| self.light_of[(base + at) as usize])?;
        (light != NONE).then_some(light)
    }

    /// Density with which [`Lights::sample`] finds a direction at this cosine to the normal that
    /// hits nothing, in 1/sr.
    #[inline(always)]
    pub(super) fn environment_pdf<P: SimdWide>(&self, to: &LightSampleContext<P>, cos: P) -> P {
        let density = warp::cosine_hemisphere_pdf(cos.max(P::splat(0.0)));
        if self.sky <= 0.0 {
            return P::splat(0.0);
        }
        if self.count() == 1 {
            return density;
        }
        if self.equally {
            return density * P::splat(1.0 / self.count() as f32);
        }
        let mut weights = [P::splat(0.0); MOST];
        let total = self.weigh(to, &mut weights);
        density * (weights[self.branches.len()] / total)
    }

    #[inline(always)]
    fn choose<P: SimdWide>(&self, to: &LightSampleContext<P>, choice: P) -> LightChoice<P> {
        let (zero, one) = (P::splat(0.0), P::splat(1.0));
        if self.count() == 1 {
            return LightChoice { index: P::Bits::splat(0), probability: one, rest: choice };
        }
        if self.equally {
            return self.choose_equally(choice);
        }
        let mut weights = [zero; MOST];
        let total = self.weigh(to, &mut weights);
        let wanted = choice * total;
        let (mut index, mut start, mut roughness) = (P::Bits::splat(0), zero, zero);
        let mut end = zero;
        for (&link, &weight) in self.links.iter().zip(&weights) {
            let here = end.le(wanted) & weight.gt(zero);
            index = P::select_bits(here, P::Bits::splat(link), index);
            start = P::select(here, end, start);
            roughness = P::select(here, weight, roughness);
            end = end + weight;
        }
        let rest = ((wanted - start) / roughness).max(zero).min(P::splat(ALMOST_ONE));
        let probability = (roughness / total).or_zero(total.gt(zero));
        let chosen = LightChoice { index, probability, rest };
        match &self.tree {
            Some(tree) => tree.choose(to, chosen),
            None => chosen,
        }
    }

    /// The weights by which one of the branches or the environment is chosen, and their sum.
    #[inline(always)]
    fn weigh<P: SimdWide>(&self, to: &LightSampleContext<P>, weights: &mut [P; MOST]) -> P {
        let zero = P::splat(0.0);
        let mut sum = zero;
        for (weight, bound) in weights.iter_mut().zip(&self.branches) {
            *weight = LightBounds::splat::<P>(bound).estimate(to);
            sum = sum + *weight;
        }
        if self.sky > 0.0 {
            let sky = &mut weights[self.branches.len()];
            *sky = importance::environment(self.sky, to);
            sum = sum + *sky;
        }
        let count = self.links.len();
        let blind = sum * P::splat(BLIND / count as f32);
        let mut total = zero;
        for weight in &mut weights[..count] {
            *weight = (*weight + blind).or_zero(weight.gt(zero));
            total = total + *weight;
        }
        total
    }

    /// The probabilities with which lights other than the environment are chosen.
    #[inline(always)]
    fn probability<P: SimdWide>(&self, to: &LightSampleContext<P>, lights: P::Bits) -> P {
        let zero = P::splat(0.0);
        if self.count() == 1 || self.equally {
            return P::splat(1.0 / self.count() as f32);
        }
        let mut weights = [zero; MOST];
        let total = self.weigh(to, &mut weights);
        let branches = self.tree.as_ref().map_or(lights, |tree| tree.branches_of::<P>(lights));
        let (mut weight, mut link) = (zero, P::Bits::splat(0));
        for (branch, (&of, &to)) in (0..).zip(weights.iter().zip(&self.links)) {
            let here = P::equal_bits(branches, P::Bits::splat(branch));
            weight = P::select(here, of, weight);
            link = P::select_bits(here, P::Bits::splat(to), link);
        }
        let share = (weight / total).or_zero(total.gt(zero));
        match &self.tree {
            Some(tree) => share * tree.probability(to, link, lights),
            None => share,
        }
    }

    #[cold]
    #[inline(never)]
    fn choose_equally<P: SimdWide>(&self, choice: P) -> LightChoice<P> {
        let count = self.count() as f32;
        let (mut number, mut index) = ([0.0; MAX_WIDTH], [0; MAX_WIDTH]);
        (choice * P::splat(count)).store(&mut number);
        for (number, index) in number.iter_mut().zip(&mut index).take(P::WIDTH) {
            let whole = number.floor().clamp(0.0, count - 1.0);
            (*index, *number) = (whole as u32, (*number - whole).clamp(0.0, ALMOST_ONE));
        }
        let probability = P::splat(1.0 / count);
        LightChoice { index: P::load_bits(&index), probability, rest: P::load(&number) }
    }
}

/// A primitive's whole surface.
fn area_of(geometry: &Geometry, primitive: u32) -> f32 {
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
