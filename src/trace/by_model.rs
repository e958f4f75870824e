//! The one place where the tracer's model becomes a type.
//!
//! Whatever is compiled once for each microfacet model is [`ModelWork`], so that whoever uses the library
//! neither names a model's type nor compiles the work again.

use super::wavefront::BatchOptions;
use super::{PixelBatch, Scratch, Tracer, Watch};
use crate::brdf::{Microfacet, ModelVisitor};
use crate::math::Rgb;

/// What a tracer does for a model.
enum ModelWork<'a, 'b> {
    /// Paths side by side.
    Batch { pixels: &'a PixelBatch, options: BatchOptions<'a>, watch: Watch<'b> },
    /// The reference tracer's samples of one pixel after the other, or of blocks of pixels.
    Pixels {
        pixels: &'a mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        block: u32,
        each: &'a mut dyn FnMut(Rgb),
    },
}

struct ByModel<'t, 'a, 'b> {
    tracer: &'t Tracer,
    work: ModelWork<'a, 'b>,
    scratch: &'t mut Scratch,
}

impl ModelVisitor for ByModel<'_, '_, '_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let ByModel { tracer, work, scratch } = self;
        match work {
            ModelWork::Batch { pixels, options, watch } => {
                tracer.sample_together::<M>(pixels, options, scratch, watch);
            }
            ModelWork::Pixels { pixels, pass, block, each } => {
                tracer.sample_pixels::<M>(pixels, pass, block, scratch, each);
            }
        }
    }
}

impl Tracer {
    fn run(&self, work: ModelWork, scratch: &mut Scratch) {
        self.model.visit(ByModel { tracer: self, work, scratch });
    }

    /// Samples of a batch's pixels, side by side.
    pub(super) fn together(
        &self,
        pixels: &PixelBatch,
        options: BatchOptions,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        self.run(ModelWork::Batch { pixels, options, watch }, scratch);
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
        self.run(ModelWork::Pixels { pixels, pass, block, each }, scratch);
    }
}
