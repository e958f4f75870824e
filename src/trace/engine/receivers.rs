//! What the choice of a light depended on where paths left from, kept until they meet a light.

use crate::math::columns::Column;
use crate::math::lanes::Packet;
use crate::trace::lights::{Lights, Receiver};

/// One column a number of [`Receiver::numbers`].
#[derive(Clone, Debug, Default)]
pub(super) struct Receivers([Column<f32>; Receiver::<f32>::NUMBERS]);

/// How many of the numbers are needed.
#[inline(always)]
fn needed(lights: &Lights, event: u32) -> usize {
    match (lights.choose_by_place(), event) {
        (false, _) => Receiver::<f32>::POINT,
        (true, 0) => Receiver::<f32>::NUMBERS,
        (true, _) => Receiver::<f32>::SURFACE,
    }
}

impl Receivers {
    /// Those that the mask has, which leave at `event`, into the members from `at` on.
    #[inline(always)]
    pub(super) fn push<P: Packet>(
        &mut self,
        at: usize,
        mask: P::Mask,
        to: &Receiver<P>,
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
    pub(super) fn load<P: Packet>(&self, at: usize, lights: &Lights, event: u32) -> Receiver<P> {
        let mut numbers = [P::splat(0.0); Receiver::<f32>::NUMBERS];
        for (x, column) in numbers.iter_mut().zip(&self.0).take(needed(lights, event)) {
            *x = column.load(at);
        }
        Receiver::from_numbers(&numbers, event == 0)
    }

    /// One that left at `event`.
    pub(super) fn get(&self, at: usize, lights: &Lights, event: u32) -> Receiver {
        let mut numbers = [0.0; Receiver::<f32>::NUMBERS];
        for (x, column) in numbers.iter_mut().zip(&self.0).take(needed(lights, event)) {
            *x = column.0[at];
        }
        Receiver::from_numbers(&numbers, event == 0)
    }
}
