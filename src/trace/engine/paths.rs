//! Rays on their way, one array a component.

use super::receivers::Receivers;
use crate::geometry::Ray;
use crate::math::columns::{Column, Columns3, FOURFOLD};
use crate::math::lanes::{Mask, Packet};
use crate::math::sequence::Stream;
use crate::math::{Rgb, V3};
use crate::trace::lights::{Lights, Receiver};

/// Rays on their way, each with its path's past.
#[derive(Clone, Debug, Default)]
pub(super) struct Paths {
    pub(super) o: Columns3,
    pub(super) d: Columns3,
    pub(super) beta: Columns3,
    /// Density of the direction, in 1/sr.
    pub(super) pdf: Column<f32>,
    /// The part that counts of light met, where others look as well; for rays to the first two points
    /// alone.
    pub(super) part: Column<f32>,
    /// Of the direction to the shading normal that it left from.
    pub(super) cos: Column<f32>,
    /// Where it left from, as the lights see it.
    pub(super) from: Receivers,
    /// The plate that it left from.
    pub(super) plate: Column<u32>,
    /// Place in the bundle.
    pub(super) slot: Column<u32>,
    /// How many mirrors the path has met before its first other surface.
    pub(super) lead: Column<u32>,
    /// Of the path's random numbers: its key and which point of the sequence.
    pub(super) key: Column<u32>,
    pub(super) index: Column<u32>,
}

/// A register's worth of rays that leave surfaces, as [`Paths`] keeps them.
pub(super) struct Leaving<'a, P: Packet> {
    pub(super) o: V3<P>,
    pub(super) d: V3<P>,
    pub(super) beta: Rgb<P>,
    pub(super) pdf: P,
    pub(super) part: P,
    pub(super) cos: P,
    pub(super) receiver: &'a Receiver<P>,
    pub(super) plate: P::Bits,
    pub(super) slot: P::Bits,
    pub(super) lead: P::Bits,
    pub(super) stream: &'a Stream<P::Bits>,
}

/// Rays towards lights, with what arrives if nothing is in between.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadows {
    pub(super) count: usize,
    pub(super) o: Columns3<FOURFOLD>,
    pub(super) d: Columns3<FOURFOLD>,
    pub(super) t_max: Column<f32, FOURFOLD>,
    pub(super) light: Columns3<FOURFOLD>,
    /// The plates where they begin and end.
    pub(super) plates: [Column<u32, FOURFOLD>; 2],
    /// Place in the bundle, and which sum the light belongs to: `slot + (sum << 16)`.
    pub(super) slot: Column<u32, FOURFOLD>,
}

impl Paths {
    /// Those of the mask, into the members from `at` on, which left at `event`; their number.
    #[inline(always)]
    pub(super) fn push<P: Packet>(
        &mut self,
        at: usize,
        which: P::Mask,
        way: &Leaving<P>,
        lights: &Lights,
        event: u32,
    ) -> usize {
        self.o.push::<P>(at, which, way.o);
        self.d.push::<P>(at, which, way.d);
        self.beta.push_rgb::<P>(at, which, way.beta);
        self.pdf.push::<P>(at, which, way.pdf);
        if event == 0 {
            self.part.push::<P>(at, which, way.part);
        }
        self.cos.push::<P>(at, which, way.cos);
        self.from.push::<P>(at, which, way.receiver, lights, event);
        self.plate.push::<P>(at, which, way.plate);
        self.slot.push::<P>(at, which, way.slot);
        self.lead.push::<P>(at, which, way.lead);
        self.key.push::<P>(at, which, way.stream.key());
        self.index.push::<P>(at, which, way.stream.index());
        which.bits().count_ones() as usize
    }

    #[inline(always)]
    pub(super) fn ray(&self, at: usize) -> Ray {
        Ray { o: self.o.get(at).into(), d: self.d.get(at).into() }
    }
}
