//! The pixels of a hand, traced by the model that the parameters name.

use super::Params;
use crate::brdf::{Microfacet, ModelVisitor};
use crate::math::Rgb;
use crate::trace::{Hand, Round, Scratch, Tracer};

/// Traces the samples of a hand's pixels and puts down each.
pub(super) fn trace(
    params: &Params,
    tracer: &Tracer,
    hand: &Hand,
    round: Round,
    scratch: &mut Scratch,
    put: &mut dyn FnMut([u32; 2], Rgb),
) {
    params.model.visit(Pass { tracer, hand, round, scratch, put });
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
    let round = Round::of(pass);
    trace(params, tracer, hand, round, scratch, &mut |_, sample| found.push(sample));
    found
}

struct Pass<'a> {
    tracer: &'a Tracer,
    hand: &'a Hand,
    round: Round<'a>,
    scratch: &'a mut Scratch,
    put: &'a mut dyn FnMut([u32; 2], Rgb),
}

impl ModelVisitor for Pass<'_> {
    type Output = ();
    fn visit<M: Microfacet>(self) {
        let Pass { tracer, hand, round, scratch, put } = self;
        tracer.sample_hand::<M>(hand, round, scratch, put);
    }
}
