//! The pixels of a hand, traced by the model that the parameters name.

use super::Params;
use crate::brdf::{Microfacet, ModelVisitor};
use crate::math::Rgb;
use crate::trace::{Hand, Scratch, Tracer};

/// Traces one pass of a hand's pixels, or of blocks of pixels that are `block` on a side, and puts
/// down each sample.
pub(super) fn trace(
    params: &Params,
    tracer: &Tracer,
    hand: &Hand,
    pass: u64,
    block: u32,
    scratch: &mut Scratch,
    put: &mut dyn FnMut([u32; 2], Rgb),
) {
    params.model.visit(Pass { tracer, hand, pass, block, scratch, put });
}

/// The samples of one pass, in the order of the hand's pixels.
pub(super) fn samples(
    params: &Params,
    tracer: &Tracer,
    hand: &Hand,
    pass: u64,
    scratch: &mut Scratch,
) -> Vec<Rgb> {
    let mut found = Vec::with_capacity(hand.pixels.len());
    trace(params, tracer, hand, pass, 1, scratch, &mut |_, sample| found.push(sample));
    found
}

struct Pass<'a> {
    tracer: &'a Tracer,
    hand: &'a Hand,
    pass: u64,
    block: u32,
    scratch: &'a mut Scratch,
    put: &'a mut dyn FnMut([u32; 2], Rgb),
}

impl ModelVisitor for Pass<'_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let Pass { tracer, hand, pass, block, scratch, put } = self;
        tracer.sample_hand::<M>(hand, pass, block, scratch, put);
    }
}
