//! Which sum of a path the light belongs to that is found at one of its points.
//!
//! A path has three sums: what it finds by itself, and, at its reuse vertex, what arrives there from the
//! light sampled and by reflection, which a group shares afterwards. Light that the reuse vertex receives
//! by emission is kept apart, with its density. By the point where the light is found:
//!
//! | point | emission there | light sampled there |
//! | --- | --- | --- |
//! | up to the primary vertex | [`LightSum::Radiance`] | [`LightSum::Radiance`] |
//! | the reuse vertex | [`LightSum::Radiance`] | [`LightSum::FromLight`] |
//! | the one after it | kept with the density of light sampling | [`LightSum::Reflected`] |
//! | later ones | [`LightSum::Reflected`] | [`LightSum::Reflected`] |
//!
//! Where nothing is shared all light is [`LightSum::Radiance`].

use crate::math::simd::{Bits, SimdWide};

/// A sum that light is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum LightSum {
    /// What the path itself found.
    Radiance,
    /// What arrives at its reuse vertex from the light sampled.
    FromLight,
    /// What arrives there from the direction sampled, by reflection.
    Reflected,
}

/// Places in a batch have this many bits.
const PLACE_BITS: u32 = 16;

impl LightSum {
    /// To be added to a place in the batch; [`LightSum::of`] takes the two apart.
    #[inline(always)]
    fn tag<P: SimdWide>(self) -> P::Bits {
        P::Bits::splat((self as u32) << PLACE_BITS)
    }

    /// The sum of emission found at a point that is a later one for these `later` lanes, in this lane.
    #[inline(always)]
    pub(super) fn of_emission(later: u32, lane: usize) -> LightSum {
        if later >> lane & 1 != 0 { LightSum::Reflected } else { LightSum::Radiance }
    }

    /// The sum and the place in the batch of a tagged place.
    #[inline(always)]
    pub(super) fn of(tagged: u32) -> (LightSum, usize) {
        let sum = match tagged >> PLACE_BITS {
            0 => LightSum::Radiance,
            1 => LightSum::FromLight,
            _ => LightSum::Reflected,
        };
        (sum, (tagged & ((1 << PLACE_BITS) - 1)) as usize)
    }
}

/// What a point is to each of a register's worth of paths, where paths share.
pub(super) struct ReuseRole<P: SimdWide> {
    /// Whether it is the primary vertex, the reuse vertex, the point after it, or a later one.
    pub(super) primary: P::Mask,
    pub(super) reuse: P::Mask,
    pub(super) after: P::Mask,
    pub(super) later: P::Mask,
    /// Number of mirrors before the primary vertex, this point included.
    pub(super) lead: P::Bits,
}

/// Most mirrors that a path goes through before the point that is its primary vertex.
const MOST_MIRRORS: u32 = 2;

impl<P: SimdWide> ReuseRole<P> {
    /// That of the points where `event` takes place, of paths with these numbers of mirrors before.
    #[inline(always)]
    pub(super) fn of(shares: bool, lead: P::Bits, event: u32, mirror: P::Mask) -> ReuseRole<P> {
        if !shares {
            let none = P::mask(0);
            return ReuseRole { primary: none, reuse: none, after: none, later: none, lead };
        }
        let at_front = P::equal_bits(lead, P::Bits::splat(event));
        let passes = at_front & mirror & P::mask(if event < MOST_MIRRORS { u32::MAX } else { 0 });
        // No path has a lead of all ones, which these are where there is no such event.
        let reuse = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(1)));
        let after = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(2)));
        ReuseRole {
            primary: at_front & !passes,
            reuse,
            after,
            later: !(at_front | reuse | after),
            lead: P::select_bits(passes, lead + P::Bits::splat(1), lead),
        }
    }

    /// The tag of the sum that light sampled here belongs to.
    #[inline(always)]
    pub(super) fn sampled_light_tag(&self) -> P::Bits {
        let reflected = LightSum::Reflected.tag::<P>();
        let behind =
            P::select_bits(self.after | self.later, reflected, LightSum::Radiance.tag::<P>());
        P::select_bits(self.reuse, LightSum::FromLight.tag::<P>(), behind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::{Mask, U32};

    /// The module's table, by the number of points from the primary vertex on: the sum of emission,
    /// unless it is kept, and that of light sampled.
    fn table(points: Option<u32>) -> (Option<LightSum>, LightSum) {
        match points {
            None | Some(0) => (Some(LightSum::Radiance), LightSum::Radiance),
            Some(1) => (Some(LightSum::Radiance), LightSum::FromLight),
            Some(2) => (None, LightSum::Reflected),
            Some(_) => (Some(LightSum::Reflected), LightSum::Reflected),
        }
    }

    fn sums(role: &ReuseRole<f32>, place: u32) -> (Option<LightSum>, LightSum) {
        let emission = LightSum::of_emission(role.later.bits(), 0);
        let (sampled, at) = LightSum::of(place + role.sampled_light_tag().0);
        assert_eq!(at, place as usize);
        ((!role.after.any()).then_some(emission), sampled)
    }

    #[test]
    fn light_goes_where_the_table_says_behind_any_number_of_mirrors() {
        for mirrors in 0..5 {
            let mut lead = U32(0);
            let passed = mirrors.min(MOST_MIRRORS);
            for event in 0..12 {
                let mirror = f32::mask(if event < mirrors { u32::MAX } else { 0 });
                let role = ReuseRole::<f32>::of(true, lead, event, mirror);
                lead = role.lead;
                let points = event.checked_sub(passed);
                assert_eq!(role.primary.any(), points == Some(0), "{mirrors} {event}");
                assert_eq!(role.reuse.any(), points == Some(1), "{mirrors} {event}");
                for place in [0, 1, 255, 511] {
                    assert_eq!(sums(&role, place), table(points), "{mirrors} {event}");
                }
                let alone = ReuseRole::<f32>::of(false, U32(0), event, mirror);
                assert_eq!(sums(&alone, 7), table(None), "{mirrors} {event}");
            }
        }
    }
}
