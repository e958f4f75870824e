//! The path tracer that runs: hundreds of paths side by side.
//!
//! A bundle of paths goes through one scattering event after the other, all of them in the same
//! stage: trace, fetch what was met, shade, trace towards the lights. Shading is written over lanes,
//! as many paths at a time as a register holds; paths that end make room for those that go on, so
//! that no lane is idle but in the last register. What a path finds depends on its own numbers
//! alone, never on who its neighbours are.

mod lights;
mod shade;
mod surface;
mod table;

use super::{DEPTH_CAP, Scratch, Tracer};
use crate::brdf::Microfacet;
use crate::geometry::{Ray, Stack};
use crate::math::columns::{BUNDLE, Column, Columns3};
use crate::math::lanes::{Kernel, Packet, Wide, dispatch};
use crate::math::sequence::{Slot, Stream, pair};
use crate::math::{Rgb, V3};
use crate::scene::{Material, Scene};
use lights::LightTable;
use std::marker::PhantomData;
use surface::{MaterialTable, Met};

/// What the engine looks up.
#[derive(Debug)]
pub(super) struct Tables {
    materials: MaterialTable,
    lights: LightTable,
}

impl Tables {
    pub(super) fn new(scene: &Scene, materials: &[Material]) -> Tables {
        Tables {
            materials: MaterialTable::new(materials),
            lights: LightTable::new(scene, materials),
        }
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
    /// The point that it left from.
    from: Columns3,
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
    slot: Column<u32>,
}

/// One pass of some pixels.
struct Pass<'a, M> {
    tracer: &'a Tracer,
    pixels: &'a mut dyn Iterator<Item = [u32; 2]>,
    pass: u64,
    scratch: &'a mut Scratch,
    each: &'a mut dyn FnMut(Rgb),
    model: PhantomData<M>,
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
        if !self.method.is_plain() {
            return self.sample_each_otherwise(M::MODEL, pixels, pass, scratch, each);
        }
        let model = PhantomData::<M>;
        let isa = self.scene.bvh().isa();
        dispatch(isa, Pass { tracer: self, pixels, pass, scratch, each, model })
    }
}

impl<M: Microfacet> Kernel for Pass<'_, M> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        loop {
            let bundle = &mut *self.scratch.bundle;
            let count = bundle.paths.start::<P>(self.tracer, self.pixels, self.pass);
            if count == 0 {
                return;
            }
            bundle.radiance.clear();
            bundle.radiance.resize(count, [0.0; 3]);
            self.tracer.follow::<W, P, M>(count, self.pass, self.scratch);
            for &radiance in &self.scratch.bundle.radiance {
                (self.each)(radiance.into());
            }
        }
    }
}

impl Paths {
    /// Camera rays of as many pixels as a bundle takes. Returns their number.
    #[inline(always)]
    fn start<P: Packet>(
        &mut self,
        tracer: &Tracer,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
    ) -> usize {
        // Columns and rows lie where the slots and keys will be.
        let mut count = 0;
        while count < BUNDLE
            && let Some([x, y]) = pixels.next()
        {
            (self.slot.0[count], self.key.0[count]) = (x, y);
            count += 1;
        }
        let eye = tracer.camera.eye().splat_lanes::<P>();
        for at in (0..count).step_by(P::WIDTH) {
            let (x, y) = (self.slot.load::<P>(at), self.key.load::<P>(at));
            let stream = Stream::new(tracer.seed, x, y, pass);
            let [dx, dy] = pair::<P>(&stream, Slot::CAMERA);
            let d = tracer.camera.direction(P::from_small(x) + dx, P::from_small(y) + dy);
            self.o.store(at, eye);
            self.d.store(at, d);
            self.beta.store(at, V3::splat(P::splat(1.0)));
            self.key.store::<P>(at, stream.key());
        }
        for (slot, place) in self.slot.0.iter_mut().zip(0..count as u32) {
            *slot = place;
        }
        count
    }

    #[inline(always)]
    fn ray(&self, at: usize) -> Ray {
        Ray { o: self.o.get(at).into(), d: self.d.get(at).into() }
    }
}

impl Tracer {
    /// The paths of the bundle, from the camera to their ends.
    #[inline(always)]
    fn follow<W: Wide, P: Packet, M: Microfacet>(
        &self,
        mut count: usize,
        pass: u64,
        scratch: &mut Scratch,
    ) {
        let Scratch { stack, bundle, rays, capped } = scratch;
        for event in 0.. {
            *rays += count as u64;
            self.trace::<W>(bundle, count, stack);
            bundle.met.fetch::<P>(self.scene.geometry(), &bundle.paths, count);
            let last = event >= self.max_depth || event >= DEPTH_CAP;
            let going = self.shade::<P, M>(bundle, count, event, pass, last);
            if event >= DEPTH_CAP && event < self.max_depth {
                *capped += going as u64;
            }
            if last {
                return;
            }
            *rays += bundle.shadows.count as u64;
            self.ask::<W>(bundle, stack);
            if going == 0 {
                return;
            }
            count = going;
        }
    }

    #[inline(always)]
    fn trace<W: Wide>(&self, bundle: &mut Bundle, count: usize, stack: &mut Stack) {
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        for at in 0..count {
            let ray = bundle.paths.ray(at);
            let hit = bvh.closest_with::<W>(geometry, &ray, f32::INFINITY, stack);
            bundle.met.set(at, hit);
        }
    }

    /// Adds the light of those shadow rays that meet nothing.
    #[inline(always)]
    fn ask<W: Wide>(&self, bundle: &mut Bundle, stack: &mut Stack) {
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let shadows = &bundle.shadows;
        for at in 0..shadows.count {
            let ray = Ray { o: shadows.o.get(at).into(), d: shadows.d.get(at).into() };
            if !bvh.occluded_with::<W>(geometry, &ray, shadows.t_max.0[at], stack) {
                let light = shadows.light.get(at);
                let sum = &mut bundle.radiance[shadows.slot.0[at] as usize];
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
    }
}
