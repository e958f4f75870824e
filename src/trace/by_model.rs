//! The work that is compiled once for each microfacet model, chosen by the tracer's own.
//!
//! Only here does code outside the tracer hit what is generic over the model, so that whoever uses
//! the library does not compile it again.

use super::wavefront::BatchOptions;
use super::{PixelBatch, Scratch, Tracer, Watch};
use crate::brdf::{Microfacet, ModelVisitor};
use crate::math::Rgb;

/// Paths side by side.
struct Together<'a, 'b> {
    tracer: &'a Tracer,
    pixel_batch: &'a PixelBatch,
    round: BatchOptions<'a>,
    scratch: &'a mut Scratch,
    watch: Watch<'b>,
}

impl ModelVisitor for Together<'_, '_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let Together { tracer, pixel_batch, round, scratch, watch } = self;
        tracer.sample_together::<M>(pixel_batch, round, scratch, watch);
    }
}

/// One path after the other.
struct OneByOne<'a> {
    tracer: &'a Tracer,
    pixels: &'a mut dyn Iterator<Item = [u32; 2]>,
    pass: u64,
    block: u32,
    scratch: &'a mut Scratch,
    each: &'a mut dyn FnMut(Rgb),
}

impl ModelVisitor for OneByOne<'_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let OneByOne { tracer, pixels, pass, block, scratch, each } = self;
        tracer.sample_pixels::<M>(pixels, pass, block, scratch, each);
    }
}

impl Tracer {
    pub(super) fn together(
        &self,
        pixel_batch: &PixelBatch,
        round: BatchOptions,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        self.model.visit(Together { tracer: self, pixel_batch, round, scratch, watch });
    }

    /// [`Tracer::sample`] of one pixel after the other, or of blocks of pixels.
    pub(super) fn one_by_one(
        &self,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        block: u32,
        scratch: &mut Scratch,
        each: &mut dyn FnMut(Rgb),
    ) {
        self.model.visit(OneByOne { tracer: self, pixels, pass, block, scratch, each });
    }
}
