//! Rays on their way, one array a component.

use super::light_contexts::LightSampleContexts;
#[cfg(doc)]
use super::light_sums::LightSum;
use crate::geometry::Ray;
use crate::math::simd::{Mask, SimdWide};
use crate::math::soa::{FOURFOLD, Soa, Soa3};
use crate::math::sobol::Stream;
use crate::math::{Rgb, V3};
use crate::trace::lights::{LightSampleContext, Lights};

/// Rays on their way, each with its path's past.
#[derive(Clone, Debug, Default)]
pub(super) struct RayQueue {
    pub(super) o: Soa3,
    pub(super) d: Soa3,
    pub(super) beta: Soa3,
    /// Density of the direction, in 1/sr.
    pub(super) pdf: Soa<f32>,
    /// What light that it hits counts, where split rays are its company; for rays to the first two points
    /// alone.
    pub(super) mis_fraction: Soa<f32>,
    /// Of the direction to the shading normal that it left from.
    pub(super) cos: Soa<f32>,
    /// Where it left from, as the lights see it.
    pub(super) from: LightSampleContexts,
    /// The surface that it left from.
    pub(super) surface_id: Soa<u32>,
    /// Place in the batch.
    pub(super) slot: Soa<u32>,
    /// How many mirrors the path has hit before its first other surface.
    pub(super) lead: Soa<u32>,
    /// Of the path's random numbers: its key and which point of the sequence.
    pub(super) key: Soa<u32>,
    pub(super) index: Soa<u32>,
}

/// A register's worth of rays that leave surfaces, as [`RayQueue`] keeps them.
pub(super) struct RayBatch<'a, P: SimdWide> {
    pub(super) o: V3<P>,
    pub(super) d: V3<P>,
    pub(super) beta: Rgb<P>,
    pub(super) pdf: P,
    pub(super) mis_fraction: P,
    pub(super) cos: P,
    pub(super) context: &'a LightSampleContext<P>,
    pub(super) surface_id: P::Bits,
    pub(super) slot: P::Bits,
    pub(super) lead: P::Bits,
    pub(super) stream: &'a Stream<P::Bits>,
}

/// Rays towards lights, with what arrives if nothing is in between.
#[derive(Clone, Debug, Default)]
pub(super) struct ShadowQueue {
    pub(super) count: usize,
    pub(super) o: Soa3<FOURFOLD>,
    pub(super) d: Soa3<FOURFOLD>,
    pub(super) t_max: Soa<f32, FOURFOLD>,
    pub(super) light: Soa3<FOURFOLD>,
    /// The surfaces where they begin and end.
    pub(super) surface_ids: [Soa<u32, FOURFOLD>; 2],
    /// Place in the batch, and which sum of it the light belongs to: [`LightSum::of`] takes them apart.
    pub(super) tagged_slot: Soa<u32, FOURFOLD>,
}

impl RayQueue {
    /// Those of the mask, into the members from `at` on, which left at `event`; their number.
    #[inline(always)]
    pub(super) fn push<P: SimdWide>(
        &mut self,
        at: usize,
        which: P::Mask,
        ray: &RayBatch<P>,
        lights: &Lights,
        event: u32,
    ) -> usize {
        self.o.push::<P>(at, which, ray.o);
        self.d.push::<P>(at, which, ray.d);
        self.beta.push_rgb::<P>(at, which, ray.beta);
        self.pdf.push::<P>(at, which, ray.pdf);
        if event == 0 {
            self.mis_fraction.push::<P>(at, which, ray.mis_fraction);
        }
        self.cos.push::<P>(at, which, ray.cos);
        self.from.push::<P>(at, which, ray.context, lights, event);
        self.surface_id.push::<P>(at, which, ray.surface_id);
        self.slot.push::<P>(at, which, ray.slot);
        self.lead.push::<P>(at, which, ray.lead);
        self.key.push::<P>(at, which, ray.stream.key());
        self.index.push::<P>(at, which, ray.stream.index());
        which.bits().count_ones() as usize
    }

    #[inline(always)]
    pub(super) fn ray(&self, at: usize) -> Ray {
        Ray { o: self.o.get(at).into(), d: self.d.get(at).into() }
    }
}
