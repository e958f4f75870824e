//! The path tracer that runs: hundreds of paths side by side.
//!
//! A batch of paths goes through one scattering event after the other, all of them in the same
//! stage: trace, fetch what was hit, shade, trace towards the lights. Shading is written over lanes,
//! as many paths at a time as a register holds; paths that end make room for those that go on, so
//! that no lane is idle but in the last register. What a path finds by itself depends on its own
//! numbers alone, never on who else is in the batch; what it is given by [others](reuse), on its
//! group.

mod camera;
mod direct_light;
mod emission;
mod emitter_splitting;
mod first_hit_cache;
mod hits;
mod light_contexts;
mod light_sums;
mod rays;
mod reuse;
mod scatter;
mod shade;
mod state;
mod vertex;

use super::{Contribution, DEPTH_CAP, PixelBatch, Scratch, Stage, Tracer, Watch};
use crate::brdf::Microfacet;
use crate::math::Rgb;
use crate::math::simd::dispatch;
use crate::math::soa::{BATCH, Soa};
use crate::math::sobol::PassKey;
use crate::scene::Material;
use camera::GenerateCameraRays;
use direct_light::TraceShadowRays;
use emission::AddEmission;
use emitter_splitting::{SplitRays, TraceSplitRays};
pub use first_hit_cache::FirstHits;
use hits::{Hits, MaterialTable};
use rays::TraceRays;
use reuse::{FindVisibility, GatherLight, PrimaryVertices, ReuseVertices};
use shade::ShadeHits;
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
    /// Columns and rows, by place in the batch.
    pixels: [Soa<u32>; 2],
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
    primary_light_samples: u32,
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
    /// Whether emitters are looked for by split rays, and, of direct light alone, by several light samples,
    /// which is the lesser error for a picture; without them every sample is the reference tracer's.
    pub split: bool,
}

impl BatchOptions<'_> {
    /// One sample a pixel, of which nothing is kept.
    pub fn of(pass: u64) -> BatchOptions<'static> {
        BatchOptions { pass, block: 1, first_hits: None, split: true }
    }
}

/// Light samples at the primary vertex of a path whose reuse vertex is shared, or that ends there; there is
/// room for four. Where paths share, with three the built-in scene was 1.05 times as efficient, the plates 0.92
/// times and the rest within 2 %. Veach's plates by direct light alone are 1, 1.25, 1.24 and 1.32 times as
/// efficient with one to four. Paths that go on without sharing are not: 0.63 to 0.88 times with four.
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
        self.together(pixel_batch, round, scratch, &mut |_, _| {});
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
        let PathBatch { pixels: [columns, rows], paths, salts, ends, .. } = &mut *scratch.batch;
        for ((x, y), pixel) in columns.0.iter_mut().zip(&mut rows.0).zip(&pixel_batch.pixels) {
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
        let (count, contribution) = (pixel_batch.pixels.len().min(BATCH), pixel_batch.contribution);
        self.follow::<M>(count, contribution, round, scratch, watch);
    }

    /// The paths of the batch, from the camera to their ends.
    fn follow<M: Microfacet>(
        &self,
        mut count: usize,
        contribution: Contribution,
        BatchOptions { block, first_hits, split, .. }: BatchOptions,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        let isa = self.scene.isa();
        let Scratch { stack, batch, rays, capped, counts } = scratch;
        batch.radiance.clear();
        batch.radiance.resize(count, [0.0; 3]);
        batch.shares = self.max_depth > 1 && !batch.ends.is_empty();
        if batch.shares {
            batch.primary.there.0.fill(0);
            batch.reuse.clear(count);
        }
        let several = batch.shares || (split && self.max_depth == 1);
        batch.primary_light_samples = if several { LIGHT_SAMPLES } else { 1 };
        batch.split_rays.begin(split && contribution != Contribution::Shared);
        dispatch(isa, GenerateCameraRays { tracer: self, batch, count, block });
        watch(Stage::Start, count);
        let model = PhantomData::<M>;
        TraceSplitRays { tracer: self, batch, event: 0, stack }.run(rays, counts, watch);
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
            let going = if last {
                dispatch(isa, AddEmission { tracer: self, batch, count, event })
            } else {
                dispatch(isa, ShadeHits { tracer: self, batch, count, event, model })
            };
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
                TraceSplitRays { tracer: self, batch, event: 1, stack }.run(rays, counts, watch);
            }
            if going == 0 {
                break;
            }
            count = going;
        }
        *capped += std::mem::take(&mut batch.capped);
        match contribution {
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
            counts.glossy += dispatch(isa, GatherLight { tracer: self, batch, model });
            watch(Stage::Gather, batch.reuse.count);
        }
    }
}

impl PathBatch {
    /// Number of light samples at this event. What is shared costs more than a light, so that a
    /// few more of those pay where nobody shares.
    #[inline(always)]
    fn light_samples(&self, event: u32) -> u32 {
        if event == 0 { self.primary_light_samples } else { 1 }
    }
}
