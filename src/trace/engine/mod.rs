//! The path tracer that runs: hundreds of paths side by side.
//!
//! A bundle of paths goes through one scattering event after the other, all of them in the same
//! stage: trace, fetch what was met, shade, trace towards the lights. Shading is written over lanes,
//! as many paths at a time as a register holds; paths that end make room for those that go on, so
//! that no lane is idle but in the last register. What a path finds depends on its own numbers
//! alone, never on who its neighbours are.

mod receivers;
mod shade;
mod surface;

use super::{DEPTH_CAP, Scratch, Tracer};
use crate::brdf::Microfacet;
use crate::geometry::{NO_PLATE, Ray, Stack};
use crate::math::columns::{BUNDLE, Column, Columns3};
use crate::math::lanes::{Bits, Kernel, Mask, Packet, Wide, dispatch};
use crate::math::sequence::{Slot, Stream, pair};
use crate::math::{Rgb, V3};
use crate::scene::Material;
use receivers::Receivers;
use std::marker::PhantomData;
use surface::{MaterialTable, Met};

/// What the engine looks up.
#[derive(Debug)]
pub(super) struct Tables {
    materials: MaterialTable,
}

impl Tables {
    pub(super) fn new(materials: &[Material]) -> Tables {
        Tables { materials: MaterialTable::new(materials) }
    }
}

/// Memory for one bundle.
#[derive(Clone, Debug, Default)]
pub(super) struct Bundle {
    paths: Paths,
    met: Met,
    shadows: Shadows,
    /// By place in the bundle.
    radiance: Vec<[f32; 3]>,
}

/// Rays on their way, each with its path's past.
#[derive(Clone, Debug, Default)]
struct Paths {
    o: Columns3,
    d: Columns3,
    beta: Columns3,
    /// Density of the direction, in 1/sr.
    pdf: Column<f32>,
    /// Of the direction to the shading normal that it left from.
    cos: Column<f32>,
    /// Where it left from, as the lights see it.
    from: Receivers,
    /// The plate that it left from.
    plate: Column<u32>,
    /// Place in the bundle.
    slot: Column<u32>,
    /// Of the path's random numbers.
    key: Column<u32>,
}

/// Rays towards lights, with what arrives if nothing is in between.
#[derive(Clone, Debug, Default)]
struct Shadows {
    count: usize,
    o: Columns3,
    d: Columns3,
    t_max: Column<f32>,
    light: Columns3,
    /// The plates where they begin and end.
    plates: [Column<u32>; 2],
    slot: Column<u32>,
}

impl Tracer {
    /// Radiance of one sample of each pixel, in their order: pass `pass` (from 0) of the pixels in
    /// these columns and rows from the top. The same pixel gets the same bits in any company and on
    /// any number of threads; they may differ from one instruction set to another.
    pub fn sample_each<M: Microfacet>(
        &self,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        scratch: &mut Scratch,
        each: &mut dyn FnMut(Rgb),
    ) {
        if !self.method.is_the_engines(M::MODEL) {
            return self.sample_one_by_one::<M>(pixels, pass, scratch, each);
        }
        loop {
            // Columns and rows lie where the slots and keys will be.
            let paths = &mut scratch.bundle.paths;
            let mut count = 0;
            while count < BUNDLE
                && let Some([x, y]) = pixels.next()
            {
                (paths.slot.0[count], paths.key.0[count]) = (x, y);
                count += 1;
            }
            if count == 0 {
                return;
            }
            self.follow::<M>(count, pass, scratch);
            for &radiance in &scratch.bundle.radiance {
                each(radiance.into());
            }
        }
    }

    /// The paths of the bundle, from the camera to their ends.
    fn follow<M: Microfacet>(&self, mut count: usize, pass: u64, scratch: &mut Scratch) {
        let isa = self.scene.bvh().isa();
        let Scratch { stack, bundle, rays, capped } = scratch;
        bundle.radiance.clear();
        bundle.radiance.resize(count, [0.0; 3]);
        dispatch(isa, Start { tracer: self, paths: &mut bundle.paths, count, pass });
        for event in 0.. {
            *rays += count as u64;
            dispatch(isa, Trace { tracer: self, bundle, count, stack });
            let last = event >= self.max_depth || event >= DEPTH_CAP;
            let model = PhantomData::<M>;
            let shade = Shade { tracer: self, bundle, count, event, pass, last, model };
            let going = dispatch(isa, shade);
            if event >= DEPTH_CAP && event < self.max_depth {
                *capped += going as u64;
            }
            if last {
                return;
            }
            *rays += bundle.shadows.count as u64;
            dispatch(isa, Ask { tracer: self, bundle, stack });
            if going == 0 {
                return;
            }
            count = going;
        }
    }
}

/// Camera rays of the pixels whose columns and rows lie where the slots and keys will be.
struct Start<'a> {
    tracer: &'a Tracer,
    paths: &'a mut Paths,
    count: usize,
    pass: u64,
}

impl Kernel for Start<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        let Start { tracer, paths, count, pass } = self;
        let eye = tracer.camera.eye().splat_lanes::<P>();
        for at in (0..count).step_by(P::WIDTH) {
            let (x, y) = (paths.slot.load::<P>(at), paths.key.load::<P>(at));
            let stream = Stream::new(tracer.seed, x, y, pass);
            let [dx, dy] = pair::<P>(&stream, Slot::CAMERA);
            let d = tracer.camera.direction(P::from_small(x) + dx, P::from_small(y) + dy);
            paths.o.store(at, eye);
            paths.d.store(at, d);
            paths.beta.store(at, V3::splat(P::splat(1.0)));
            paths.plate.store::<P>(at, P::Bits::splat(NO_PLATE));
            paths.key.store::<P>(at, stream.key());
        }
        for (slot, place) in paths.slot.0.iter_mut().zip(0..count as u32) {
            *slot = place;
        }
    }
}

/// Finds what the rays meet: plates by the register, the rest one by one.
struct Trace<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    count: usize,
    stack: &'a mut Stack,
}

impl Kernel for Trace<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        let Trace { tracer, bundle, count, stack } = self;
        tracer.trace::<W, P>(bundle, count, stack);
        bundle.met.fetch(tracer.scene.geometry(), &bundle.paths, count);
        bundle.met.resolve::<P>(&bundle.paths, count);
    }
}

/// [`Tracer::shade`]
struct Shade<'a, M> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    count: usize,
    event: u32,
    pass: u64,
    last: bool,
    model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for Shade<'_, M> {
    type Output = usize;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> usize {
        let Shade { tracer, bundle, count, event, pass, last, .. } = self;
        tracer.shade::<P, M>(bundle, count, event, pass, last)
    }
}

/// Adds the light of those shadow rays that meet nothing.
struct Ask<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    stack: &'a mut Stack,
}

impl Kernel for Ask<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        self.tracer.ask::<W, P>(self.bundle, self.stack);
    }
}

impl Paths {
    #[inline(always)]
    fn ray(&self, at: usize) -> Ray {
        Ray { o: self.o.get(at).into(), d: self.d.get(at).into() }
    }
}

impl Tracer {
    #[inline(always)]
    fn trace<W: Wide, P: Packet>(&self, bundle: &mut Bundle, count: usize, stack: &mut Stack) {
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let plates = bvh.plates();
        let (paths, met) = (&bundle.paths, &mut bundle.met);
        for at in (0..count).step_by(P::WIDTH) {
            let (o, d) = (paths.o.load::<P>(at), paths.d.load::<P>(at));
            let hits = plates.closest::<P>(o, d, paths.plate.load::<P>(at));
            met.on_plates::<P>(at, &hits);
            let live = P::mask(lowest(count - at));
            let open = (hits.open & live).bits();
            let mut others = (bvh.meets_tree(o, d, hits.t + hits.within) & live).bits() | open;
            if others == 0 {
                continue;
            }
            let (mut t, mut within) = ([0.0; 16], [0.0; 16]);
            hits.t.store(&mut t);
            hits.within.store(&mut within);
            while others != 0 {
                let lane = others.trailing_zeros() as usize;
                others &= others - 1;
                let ray = paths.ray(at + lane);
                if open >> lane & 1 == 0 {
                    let until = t[lane] + within[lane];
                    match bvh.closest_but_plates::<W>(geometry, &ray, until, stack) {
                        None => continue,
                        Some(hit) if hit.t < t[lane] - within[lane] => {
                            met.set(at + lane, Some(hit), NO_PLATE);
                            continue;
                        }
                        // Too close to the plate to tell.
                        Some(_) => {}
                    }
                }
                let hit = bvh.closest_with::<W>(geometry, &ray, f32::INFINITY, stack);
                let plate = hit.map_or(NO_PLATE, |hit| plates.plate_of(hit.primitive));
                met.set(at + lane, hit, plate);
            }
        }
    }

    #[inline(always)]
    fn ask<W: Wide, P: Packet>(&self, bundle: &mut Bundle, stack: &mut Stack) {
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let shadows = &bundle.shadows;
        for at in (0..shadows.count).step_by(P::WIDTH) {
            let (o, d) = (shadows.o.load::<P>(at), shadows.d.load::<P>(at));
            let t_max = shadows.t_max.load::<P>(at);
            let ends = [shadows.plates[0].load::<P>(at), shadows.plates[1].load::<P>(at)];
            let live = P::mask(lowest(shadows.count - at));
            let between = (t_max.lt(P::splat(f32::INFINITY)) | !live).all();
            let [blocked, open] = bvh.plates().occluded::<P>(o, d, t_max, ends, live, between);
            let tree = bvh.meets_tree(o, d, t_max).bits();
            let open = open.bits();
            let mut seen = (live & !blocked).bits();
            while seen != 0 {
                let lane = seen.trailing_zeros() as usize;
                seen &= seen - 1;
                if (open | tree) >> lane & 1 != 0 {
                    let (o, d) = (shadows.o.get(at + lane), shadows.d.get(at + lane));
                    let (ray, t_max) =
                        (Ray { o: o.into(), d: d.into() }, shadows.t_max.0[at + lane]);
                    let occluded = if open >> lane & 1 != 0 {
                        bvh.occluded_with::<W>(geometry, &ray, t_max, stack)
                    } else {
                        bvh.occluded_but_plates::<W>(geometry, &ray, t_max, stack)
                    };
                    if occluded {
                        continue;
                    }
                }
                let light = shadows.light.get(at + lane);
                let sum = &mut bundle.radiance[shadows.slot.0[at + lane] as usize];
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
    }
}

/// So many lowest bits, at most all.
fn lowest(count: usize) -> u32 {
    if count >= 32 { u32::MAX } else { (1 << count) - 1 }
}
