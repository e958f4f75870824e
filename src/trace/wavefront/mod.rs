//! The path tracer that runs: hundreds of paths side by side.
//!
//! A batch of paths goes through one scattering event after the other, all of them in the same
//! stage: trace, fetch what was hit, shade, trace towards the lights. Shading is written over lanes,
//! as many paths at a time as a register holds; paths that end make room for those that go on, so
//! that no lane is idle but in the last register. What a path finds by itself depends on its own
//! numbers alone, never on who else is in the batch; what it is given by [others](reuse), on its
//! group.

mod emitter_splitting;
mod first_hit_cache;
mod hits;
mod light_contexts;
mod rays;
mod reuse;
mod shade;
mod state;

use super::{Contribution, DEPTH_CAP, PixelBatch, RayCounts, Scratch, Stage, Tracer, Watch};
use crate::brdf::Microfacet;
use crate::geometry::{NO_SURFACE, Stack};
use crate::math::simd::{Bits, Kernel, Simd8, SimdWide, dispatch, first_lanes};
use crate::math::soa::{BATCH, Soa};
use crate::math::sobol::{PassKey, Slot, Stream, pair};
use crate::math::{Rgb, V3};
use crate::scene::Material;
use emitter_splitting::{SplitRays, TraceSplitRays};
pub use first_hit_cache::FirstHits;
use hits::{Hits, MaterialTable};
use reuse::{PrimaryVertices, ReuseVertices};
use state::{RayQueue, ShadowQueue};
use std::marker::PhantomData;

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

/// Memory for one batch.
#[derive(Clone, Debug, Default)]
pub(super) struct PathBatch {
    paths: Box<RayQueue>,
    /// Of the passes that the paths belong to, by place in the batch.
    salts: Soa<u32>,
    hits: Hits,
    shadows: ShadowQueue,
    split_rays: SplitRays,
    /// Of the shadow rays that nothing is in the way of: a register's worth of bits each.
    visible: Vec<u32>,
    primary: PrimaryVertices,
    reuse: ReuseVertices,
    /// By place in the batch.
    radiance: Vec<[f32; 3]>,
    /// Where groups of places end that share; nothing where none do.
    ends: Vec<u32>,
    shares: bool,
    contribution: Contribution,
    /// Paths that were ended for their throughput.
    capped: u64,
}

/// Which samples of some pixels.
#[derive(Clone, Copy, Debug)]
pub struct BatchOptions<'a> {
    /// Of which pass, from 0, where the [`PixelBatch`] does not say.
    pub pass: u64,
    /// Side of the blocks that are traced as one pixel, in pixels.
    pub block: u32,
    /// What their camera rays hit, if it is kept.
    pub first_hits: Option<&'a FirstHits>,
    /// Whether emitters are looked for by split rays, which is the lesser error for a picture; without them
    /// every sample is the reference tracer's.
    pub split: bool,
}

impl BatchOptions<'_> {
    /// One sample a pixel, of which nothing is kept.
    pub fn of(pass: u64) -> BatchOptions<'static> {
        BatchOptions { pass, block: 1, first_hits: None, split: true }
    }
}

/// Light samples at the primary vertex of a path whose reuse vertex is shared; there is room for four.
const LIGHT_SAMPLES: u32 = 4;

impl Tracer {
    /// Radiance of one sample of each pixel, in their order: pass `pass` (from 0) of the pixels in
    /// these columns and rows from the top, as [`Tracer::sample`] finds it. The same pixel gets the same bits whichever
    /// pixels are traced with it and on any number of threads; they may differ from one instruction set to another.
    pub fn sample_each(
        &self,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        scratch: &mut Scratch,
        each: &mut dyn FnMut(Rgb),
    ) {
        if !self.is_the_engines() {
            return self.one_by_one(pixels, pass, 1, scratch, each);
        }
        let mut some = PixelBatch::default();
        loop {
            some.pixels.clear();
            some.pixels.extend((&mut *pixels).take(BATCH));
            if some.pixels.is_empty() {
                return;
            }
            let round = BatchOptions { split: false, ..BatchOptions::of(pass) };
            self.together(&some, round, scratch, &mut |_, _| {});
            for &radiance in &scratch.batch.radiance {
                each(radiance.into());
            }
        }
    }

    /// The same for the pixels of a [`PixelBatch`], which share as it says, and for what a [`BatchOptions`] has
    /// besides: a picture's samples. Not for more than a batch's pixels.
    pub fn sample_batch(
        &self,
        pixel_batch: &PixelBatch,
        round: BatchOptions,
        scratch: &mut Scratch,
        each: &mut dyn FnMut([u32; 2], Rgb),
    ) {
        if !self.is_the_engines() {
            let mut pixels = pixel_batch.pixels.iter();
            let each = &mut |found| each(*pixels.next().expect("one a pixel"), found);
            for (places, pass) in pixel_batch.passes(round.pass) {
                let pixels = &mut pixel_batch.pixels[places].iter().copied();
                self.one_by_one(pixels, pass, round.block, scratch, each);
            }
            return;
        }
        scratch.batch.contribution = pixel_batch.contribution;
        self.together(pixel_batch, round, scratch, &mut |_, _| {});
        scratch.batch.contribution = Contribution::Whole;
        for (&pixel, &radiance) in pixel_batch.pixels.iter().zip(&scratch.batch.radiance) {
            each(pixel, radiance.into());
        }
    }

    /// [`Tracer::sample_batch`] into a list, in the order of the batch's pixels.
    pub fn samples_of(
        &self,
        pixel_batch: &PixelBatch,
        pass: u64,
        scratch: &mut Scratch,
    ) -> Vec<Rgb> {
        let mut found = Vec::with_capacity(pixel_batch.pixels.len());
        self.sample_batch(pixel_batch, BatchOptions::of(pass), scratch, &mut |_, sample| {
            found.push(sample)
        });
        found
    }

    /// [`Tracer::sample_batch`] for someone who wants to know what is being done, not what comes of
    /// it. Nothing is done where the engine does not work.
    pub fn watch_batch(
        &self,
        pixel_batch: &PixelBatch,
        pass: u64,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        if self.is_the_engines() {
            self.together(pixel_batch, BatchOptions::of(pass), scratch, watch);
        }
    }

    pub(super) fn sample_together<M: Microfacet>(
        &self,
        pixel_batch: &PixelBatch,
        round: BatchOptions,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        // Columns and rows lie where the slots and keys will be.
        let PathBatch { paths, salts, ends, .. } = &mut *scratch.batch;
        for ((x, y), pixel) in
            paths.slot.0.iter_mut().zip(&mut paths.key.0).zip(&pixel_batch.pixels)
        {
            [*x, *y] = *pixel;
        }
        for (places, pass) in pixel_batch.passes(round.pass) {
            let places = places.start.min(BATCH)..places.end.min(BATCH);
            let PassKey { salt, index } = PassKey::new(self.seed, pass);
            salts.0[places.clone()].fill(salt);
            paths.index.0[places].fill(index);
        }
        ends.clear();
        ends.extend_from_slice(&pixel_batch.ends);
        self.follow::<M>(pixel_batch.pixels.len().min(BATCH), round, scratch, watch);
    }

    /// The paths of the batch, from the camera to their ends.
    fn follow<M: Microfacet>(
        &self,
        mut count: usize,
        BatchOptions { block, first_hits, split, .. }: BatchOptions,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        let isa = self.scene.bvh().isa();
        let Scratch { stack, batch, rays, capped, counts } = scratch;
        batch.radiance.clear();
        batch.radiance.resize(count, [0.0; 3]);
        batch.shares = self.max_depth > 1 && !batch.ends.is_empty();
        if batch.shares {
            batch.primary.there.0.fill(0);
            batch.reuse.clear(count);
        }
        batch.split_rays.begin(split && batch.contribution != Contribution::Shared);
        dispatch(isa, GenerateCameraRays { tracer: self, batch, count, block });
        watch(Stage::Start, count);
        let model = PhantomData::<M>;
        let look = TraceSplitRays { tracer: self, batch, event: 0, stack, model };
        look.run(rays, counts, watch);
        for event in 0.. {
            let kept = first_hits.filter(|_| event == 0);
            let known = kept.is_some_and(|kept| kept.recall(&mut batch.hits, count));
            counts.tree_rays +=
                dispatch(isa, TraceRays { tracer: self, batch, count, known, stack });
            if !known {
                *rays += count as u64;
                counts.nearest += count as u64;
                if let Some(kept) = kept {
                    kept.keep(&batch.hits, count);
                }
            }
            watch(Stage::Trace, count);
            let last = event >= self.max_depth || event >= DEPTH_CAP;
            let shade = ShadeHits { tracer: self, batch, count, event, last, model };
            let going = dispatch(isa, shade);
            watch(Stage::Shade, count);
            if event >= DEPTH_CAP && event < self.max_depth {
                *capped += going as u64;
            }
            if last {
                break;
            }
            *rays += batch.shadows.count as u64;
            counts.shadow_rays += batch.shadows.count as u64;
            counts.tree_rays += dispatch(isa, TraceShadowRays { tracer: self, batch, stack });
            watch(Stage::Shadow, batch.shadows.count);
            if event == 0 {
                let look = TraceSplitRays { tracer: self, batch, event: 1, stack, model };
                look.run(rays, counts, watch);
            }
            if going == 0 {
                break;
            }
            count = going;
        }
        *capped += std::mem::take(&mut batch.capped);
        match batch.contribution {
            Contribution::Shared if batch.shares => batch.radiance.fill([0.0; 3]),
            Contribution::Own => return,
            _ => {}
        }
        if batch.shares {
            batch.reuse.sort();
            let found = dispatch(isa, FindVisibility { tracer: self, batch, stack });
            counts.pairs += found.pairs;
            counts.visibility_rays += found.visibility_rays;
            counts.visibility_tests += found.visibility_tests;
            counts.pair_rays += found.pair_rays;
            counts.tree_rays += found.tree_rays;
            *rays += found.visibility_rays;
            watch(Stage::Visibility, batch.reuse.count);
            counts.glossy +=
                dispatch(isa, GatherLight { tracer: self, batch, model: PhantomData::<M> });
            watch(Stage::Gather, batch.reuse.count);
        }
    }
}

impl PathBatch {
    /// Number of light samples at this event. What is shared costs more than a light, so that a
    /// few more of those pay where nobody shares.
    #[inline(always)]
    fn light_samples(&self, event: u32) -> u32 {
        if self.shares && event == 0 { LIGHT_SAMPLES } else { 1 }
    }
}

/// What light is added to: what the path itself found; what arrives at its reuse vertex from the light
/// that was asked; what arrives there from the direction sampled, by reflection.
const RADIANCE: u32 = 0;
const FROM_LIGHT: u32 = 1;
const REFLECTED: u32 = 2;

/// Camera rays of the pixels whose columns and rows lie where the slots and keys will be.
struct GenerateCameraRays<'a> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    count: usize,
    block: u32,
}

impl Kernel for GenerateCameraRays<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        let GenerateCameraRays { tracer, batch, count, block } = self;
        let PathBatch { paths, salts, split_rays, .. } = batch;
        let emitter_boxes =
            if split_rays.wanted { tracer.emitter_boxes(block) } else { Vec::new() };
        let side = P::splat(block as f32);
        let eye = tracer.camera.eye().splat_lanes::<P>();
        for at in (0..count).step_by(P::WIDTH) {
            let (x, y) = (paths.slot.load::<P>(at), paths.key.load::<P>(at));
            let (salt, index) = (salts.load::<P>(at), paths.index.load::<P>(at));
            let stream = Stream::of_pixels(x, y, salt, index);
            let [dx, dy] = pair::<P>(&stream, Slot::CAMERA);
            let d = tracer
                .camera
                .direction((P::from_small(x) + dx) * side, (P::from_small(y) + dy) * side);
            paths.o.store(at, eye);
            paths.d.store(at, d);
            paths.beta.store(at, V3::splat(P::splat(1.0)));
            let mut mis_fraction = P::splat(1.0);
            if !emitter_boxes.is_empty() {
                let live = P::mask(first_lanes(count - at));
                let place = [P::from_small(x), P::from_small(y)];
                let slots: [u32; 16] = std::array::from_fn(|lane| (at + lane) as u32);
                let path = (P::load_bits(&slots), &stream);
                mis_fraction =
                    tracer.split_camera_rays(split_rays, &emitter_boxes, live, place, side, path);
            }
            paths.mis_fraction.store(at, mis_fraction);
            paths.surface_id.store::<P>(at, P::Bits::splat(NO_SURFACE));
            paths.key.store::<P>(at, stream.key());
            paths.lead.store::<P>(at, P::Bits::splat(0));
        }
        for (slot, place) in paths.slot.0.iter_mut().zip(0..count as u32) {
            *slot = place;
        }
    }
}

/// Finds what the rays hit: large quads by the register, the rest one by one.
struct TraceRays<'a> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    count: usize,
    /// Whether all was hit before.
    known: bool,
    stack: &'a mut Stack,
}

impl Kernel for TraceRays<'_> {
    /// How many went through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        let TraceRays { tracer, batch, count, known, stack } = self;
        let tree_rays = if known { 0 } else { tracer.trace::<W, P>(batch, count, stack) };
        batch.hits.fetch::<W>(tracer.scene.geometry(), &batch.paths, count);
        if !known {
            batch.hits.resolve::<P>(&batch.paths, count);
        }
        tree_rays
    }
}

/// [`Tracer::shade`]
struct ShadeHits<'a, M> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    count: usize,
    event: u32,
    last: bool,
    model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for ShadeHits<'_, M> {
    type Output = usize;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> usize {
        let ShadeHits { tracer, batch, count, event, last, .. } = self;
        tracer.shade::<P, M>(batch, count, event, last)
    }
}

/// Adds the light of those shadow rays that hit nothing.
struct TraceShadowRays<'a> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    stack: &'a mut Stack,
}

impl Kernel for TraceShadowRays<'_> {
    /// How many went through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        self.tracer.trace_shadow_rays::<W, P>(self.batch, self.stack)
    }
}

/// [`Tracer::find_visibility`]
struct FindVisibility<'a> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    stack: &'a mut Stack,
}

impl Kernel for FindVisibility<'_> {
    type Output = RayCounts;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> RayCounts {
        self.tracer.find_visibility::<W, P>(self.batch, self.stack)
    }
}

/// [`Tracer::gather_light`]
struct GatherLight<'a, M> {
    tracer: &'a Tracer,
    batch: &'a mut PathBatch,
    model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for GatherLight<'_, M> {
    /// How often a specular lobe was evaluated.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        self.tracer.gather_light::<P, M>(self.batch)
    }
}
