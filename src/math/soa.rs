//! Arrays of numbers in memory, one array a component, so that a SIMD type loads neighbours.

use super::simd::{MAX_WIDTH, SimdWide};
use super::{Rgb, V3};

/// Most members of a batch.
pub(crate) const BATCH: usize = 512;
/// Whole registers may be written from any member's place.
const ROOM: usize = BATCH + MAX_WIDTH;
/// The same for four numbers a member.
pub(crate) const FOURFOLD: usize = 4 * BATCH + MAX_WIDTH;

/// One number of each member.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Soa<T, const N: usize = ROOM>(pub(crate) [T; N]);

impl<T: Copy + Default, const N: usize> Default for Soa<T, N> {
    fn default() -> Soa<T, N> {
        Soa([T::default(); N])
    }
}

impl<const N: usize> Soa<f32, N> {
    /// Those from member `at` on.
    #[inline(always)]
    pub(crate) fn load<P: SimdWide>(&self, at: usize) -> P {
        P::load(&self.0[at..])
    }
    /// Into the members from `at` on.
    #[inline(always)]
    pub(crate) fn store<P: SimdWide>(&mut self, at: usize, x: P) {
        x.store(&mut self.0[at..]);
    }
    /// Those lanes that the mask has, into the members from `at` on.
    #[inline(always)]
    pub(crate) fn push<P: SimdWide>(&mut self, at: usize, mask: P::Mask, x: P) {
        x.compress(mask, &mut self.0[at..]);
    }
}

impl<const N: usize> Soa<u32, N> {
    /// Those from member `at` on.
    #[inline(always)]
    pub(crate) fn load<P: SimdWide>(&self, at: usize) -> P::Bits {
        P::load_bits(&self.0[at..])
    }
    /// Into the members from `at` on.
    #[inline(always)]
    pub(crate) fn store<P: SimdWide>(&mut self, at: usize, x: P::Bits) {
        P::store_bits(x, &mut self.0[at..]);
    }
    /// Those lanes that the mask has, into the members from `at` on.
    #[inline(always)]
    pub(crate) fn push<P: SimdWide>(&mut self, at: usize, mask: P::Mask, x: P::Bits) {
        P::compress_bits(x, mask, &mut self.0[at..]);
    }
}

/// One vector or colour of each member.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soa3<const N: usize = ROOM>(pub(crate) [Soa<f32, N>; 3]);

impl<const N: usize> Soa3<N> {
    /// One member's.
    #[inline(always)]
    pub(crate) fn get(&self, at: usize) -> [f32; 3] {
        [self.0[0].0[at], self.0[1].0[at], self.0[2].0[at]]
    }
    /// Sets one member's.
    #[inline(always)]
    pub(crate) fn set(&mut self, at: usize, v: impl Into<[f32; 3]>) {
        let v = v.into();
        for (column, x) in self.0.iter_mut().zip(v) {
            column.0[at] = x;
        }
    }
    /// Vectors of the members from `at` on.
    #[inline(always)]
    pub(crate) fn load<P: SimdWide>(&self, at: usize) -> V3<P> {
        V3::new(self.0[0].load(at), self.0[1].load(at), self.0[2].load(at))
    }
    /// Colours of the members from `at` on.
    #[inline(always)]
    pub(crate) fn load_rgb<P: SimdWide>(&self, at: usize) -> Rgb<P> {
        Rgb::new(self.0[0].load(at), self.0[1].load(at), self.0[2].load(at))
    }
    /// Into the members from `at` on.
    #[inline(always)]
    pub(crate) fn store<P: SimdWide>(&mut self, at: usize, v: V3<P>) {
        for (column, x) in self.0.iter_mut().zip([v.x, v.y, v.z]) {
            column.store(at, x);
        }
    }
    /// Those lanes that the mask has, into the members from `at` on.
    #[inline(always)]
    pub(crate) fn push<P: SimdWide>(&mut self, at: usize, mask: P::Mask, v: V3<P>) {
        for (column, x) in self.0.iter_mut().zip([v.x, v.y, v.z]) {
            column.push(at, mask, x);
        }
    }
    /// The same for colours.
    #[inline(always)]
    pub(crate) fn push_rgb<P: SimdWide>(&mut self, at: usize, mask: P::Mask, c: Rgb<P>) {
        self.push(at, mask, V3::new(c.r, c.g, c.b));
    }
}
