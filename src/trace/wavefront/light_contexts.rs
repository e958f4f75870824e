//! What the choice of a light depended on where paths left from, kept until they hit a light.

use crate::math::simd::SimdWide;
use crate::math::soa::Soa;
use crate::trace::lights::{LightSampleContext, Lights};

/// One column a number of [`LightSampleContext::numbers`].
#[derive(Clone, Debug, Default)]
pub(super) struct LightSampleContexts([Soa<f32>; LightSampleContext::<f32>::NUMBERS]);

/// How many of the numbers are needed.
#[inline(always)]
fn needed(lights: &Lights, event: u32) -> usize {
    match (lights.choose_by_place(), event) {
        (false, _) => LightSampleContext::<f32>::POINT,
        (true, 0) => LightSampleContext::<f32>::NUMBERS,
        (true, _) => LightSampleContext::<f32>::SURFACE,
    }
}

impl LightSampleContexts {
    /// Those that the mask has, which leave at `event`, into the members from `at` on.
    #[inline(always)]
    pub(super) fn push<P: SimdWide>(
        &mut self,
        at: usize,
        mask: P::Mask,
        to: &LightSampleContext<P>,
        lights: &Lights,
        event: u32,
    ) {
        let count = needed(lights, event);
        for (column, x) in self.0.iter_mut().zip(to.numbers()).take(count) {
            column.push::<P>(at, mask, x);
        }
    }

    /// Those that left at `event`, of the members from `at` on.
    #[inline(always)]
    pub(super) fn load<P: SimdWide>(
        &self,
        at: usize,
        lights: &Lights,
        event: u32,
    ) -> LightSampleContext<P> {
        let mut numbers = [P::splat(0.0); LightSampleContext::<f32>::NUMBERS];
        for (x, column) in numbers.iter_mut().zip(&self.0).take(needed(lights, event)) {
            *x = column.load(at);
        }
        LightSampleContext::from_numbers(&numbers, event == 0)
    }
}
