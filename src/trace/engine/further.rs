//! Further rays that look for lamps and for nothing else.
//!
//! At the edge of a lamp, seen or mirrored, one ray a pixel is mostly chance, and nothing that comes
//! later in the path makes up for it. So the camera's ray has company where a lamp may be in the
//! pixel, and the ray from a first point with a sharp lobe has where it may meet one. What they find is
//! averaged, and weighed against asking as one of them would be: so the variance of what is found by
//! asking stays, and that of what is met falls. The path goes on by its own ray alone.

use super::paths::{Leaving, Paths};
use super::shade::is_black;
use super::{Bundle, Shade, Trace};
use crate::brdf::{Lobes, Microfacet, View};
use crate::geometry::{Extent, NO_PLATE, Passing, Stack, SurfacePoint, offset_origin};
use crate::math::lanes::{Bits, Mask, Packet, dispatch};
use crate::math::sequence::{Slot, Stream, pair, unit};
use crate::math::{Frame, Rgb, V3};
use crate::trace::lights::Receiver;
use crate::trace::{Effort, Stage, Tracer, Watch};
use std::marker::PhantomData;
use std::mem::{swap, take};

/// How many rays look, the path's own among them: a power of 2, so that as many equal parts are the
/// whole to the last digit.
const LOOKS: usize = 4;
/// How many of them are further ones.
const FURTHER: usize = LOOKS - 1;

/// Roughness alpha from which on asking for lamps does as well.
const SHARP: f32 = 0.15;

/// The further rays of a bundle, in rounds of at most one a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Further {
    /// Whether any are wanted.
    pub(super) wanted: bool,
    rounds: [Box<Paths>; FURTHER],
    counts: [usize; FURTHER],
}

/// The first points of a register's worth of paths.
pub(super) struct FirstPoints<'a, P: Packet> {
    pub(super) point: &'a SurfacePoint<P>,
    pub(super) frame: &'a Frame<P>,
    pub(super) view: &'a View<P>,
    pub(super) receiver: &'a Receiver<P>,
    pub(super) plate: P::Bits,
    pub(super) slot: P::Bits,
    pub(super) stream: &'a Stream<P::Bits>,
}

impl Tracer {
    /// Where lamps may be in pixels `block` times the picture's.
    pub(super) fn sights(&self, block: u32) -> Vec<Extent> {
        let radius = self.camera.pixel_radius() * block as f32;
        let eye = self.camera.eye();
        let grown = |extent: &Extent| {
            let reach = (extent.centre - eye).length() + extent.half.length();
            let half = extent.half + V3::splat(reach * radius);
            Extent { half, ..*extent }
        };
        // One that is all around would be in every pixel.
        let apart = |extent: &Extent| {
            let (away, half) = ((extent.centre - eye).abs(), extent.half);
            away.x > half.x || away.y > half.y || away.z > half.z
        };
        self.lights.lamps_apart().iter().map(grown).filter(apart).collect()
    }

    /// Adds the camera's further rays for the pixels in columns `x` and rows `y`, `side` times the
    /// picture's, whose paths have these slots. Returns the part that counts of the light that a ray
    /// meets there.
    #[inline(always)]
    pub(super) fn look_from_camera<P: Packet>(
        &self,
        further: &mut Further,
        sights: &[Extent],
        live: P::Mask,
        [x, y]: [P; 2],
        side: P,
        (slot, stream): (P::Bits, &Stream<P::Bits>),
    ) -> P {
        let one = P::splat(1.0);
        let (eye, half) = (self.camera.eye().splat_lanes::<P>(), P::splat(0.5));
        let middle = self.camera.direction((x + half) * side, (y + half) * side);
        let passing = Passing::new(eye, middle);
        let mut near = P::mask(0);
        for sight in sights {
            near = near | passing.meet(sight, P::splat(f32::INFINITY));
        }
        let near = near & live;
        if !near.any() {
            return one;
        }
        let part = P::select(near, P::splat(1.0 / LOOKS as f32), one);
        for which in 0..FURTHER {
            let stream = stream.one_of(FURTHER as u32, which as u32);
            let [dx, dy] = pair::<P>(&stream, Slot::LOOK_CAMERA);
            let d = self.camera.direction((x + dx) * side, (y + dy) * side);
            let (rays, end) = (&mut further.rounds[which], further.counts[which]);
            rays.o.push::<P>(end, near, eye);
            rays.d.push::<P>(end, near, d);
            rays.beta.push::<P>(end, near, V3::splat(one));
            rays.part.push::<P>(end, near, part);
            rays.plate.push::<P>(end, near, P::Bits::splat(NO_PLATE));
            rays.slot.push::<P>(end, near, slot);
            rays.lead.push::<P>(end, near, P::Bits::splat(0));
            further.counts[which] += near.bits().count_ones() as usize;
        }
        part
    }

    /// How many look from first points: more than one where they have a sharp lobe and lamps are all
    /// that shines.
    #[inline(always)]
    pub(super) fn lookers<P: Packet>(&self, further: &Further, lobes: &Lobes<P>) -> P {
        let one = P::splat(1.0);
        if !further.wanted || !self.lights.are_lamps() || self.lights.lamps_apart().is_empty() {
            return one;
        }
        let sharp = lobes.width.alpha.lt(P::splat(SHARP)) & !is_black(lobes.ks);
        P::select(sharp, P::splat(LOOKS as f32), one)
    }

    /// Adds the further rays of first points, which `beta` arrives at.
    #[inline(always)]
    pub(super) fn look_from_points<P: Packet, M: Microfacet>(
        &self,
        further: &mut Further,
        which_points: P::Mask,
        from: &FirstPoints<P>,
        beta: Rgb<P>,
    ) {
        let FirstPoints { point, frame, view, receiver, plate, slot, stream } = *from;
        let part = P::splat(1.0 / LOOKS as f32);
        for which in 0..FURTHER {
            let stream = stream.one_of(FURTHER as u32, which as u32);
            let [lobe_choice, _] = stream.pair_bits(Slot::LOOK_CHOICE);
            let u = pair::<P>(&stream, Slot::LOOK_DIRECTION);
            let next = view.sample::<M>(unit::<P>(lobe_choice), u);
            let d = frame.to_world(next.wi);
            let cos = M::cosine(next.wi.z);
            let beta = beta * next.f * (cos / next.pdf);
            let zero = P::splat(0.0);
            let leaves = next.pdf.gt(zero) & M::cosine(point.ng.dot(d)).gt(zero);
            let goes = which_points & leaves & !is_black(beta);
            let o = offset_origin(point.p, point.error, point.ng, d);
            let goes = goes & self.lights.may_be_met(o, d);
            let pdf = next.pdf;
            let stream = from.stream;
            let lead = P::Bits::splat(0);
            let way = Leaving { o, d, beta, pdf, part, cos, receiver, plate, slot, lead, stream };
            let (rays, end) = (&mut further.rounds[which], further.counts[which]);
            further.counts[which] += rays.push::<P>(end, goes, &way, &self.lights, 0);
        }
    }
}

impl Further {
    /// Forgets all rays.
    pub(super) fn begin(&mut self, wanted: bool) {
        self.wanted = wanted;
        self.counts = [0; FURTHER];
    }
}

/// Sends the further rays on, to the lamps that they meet.
pub(super) struct Look<'a, M> {
    pub(super) tracer: &'a Tracer,
    pub(super) bundle: &'a mut Bundle,
    /// What they arrive at.
    pub(super) event: u32,
    pub(super) stack: &'a mut Stack,
    pub(super) model: PhantomData<M>,
}

impl<M: Microfacet> Look<'_, M> {
    pub(super) fn run(self, rays: &mut u64, effort: &mut Effort, watch: Watch) {
        let Look { tracer, bundle, event, stack, model } = self;
        let isa = tracer.scene.bvh().isa();
        for round in 0..FURTHER {
            let count = take(&mut bundle.further.counts[round]);
            if count == 0 {
                continue;
            }
            swap(&mut bundle.paths, &mut bundle.further.rounds[round]);
            effort.alone += dispatch(isa, Trace { tracer, bundle, count, known: false, stack });
            *rays += count as u64;
            effort.nearest += count as u64;
            watch(Stage::Trace, count);
            dispatch(isa, Shade { tracer, bundle, count, event, last: true, model });
            watch(Stage::Shade, count);
            swap(&mut bundle.paths, &mut bundle.further.rounds[round]);
        }
    }
}
