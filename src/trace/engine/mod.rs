//! The path tracer that runs: hundreds of paths side by side.
//!
//! A bundle of paths goes through one scattering event after the other, all of them in the same
//! stage: trace, fetch what was met, shade, trace towards the lights. Shading is written over lanes,
//! as many paths at a time as a register holds; paths that end make room for those that go on, so
//! that no lane is idle but in the last register. What a path finds by itself depends on its own
//! numbers alone, never on who else is in the bundle; what it is given by [others](reuse), on its
//! group.

mod further;
mod kept;
mod paths;
mod rays;
mod receivers;
mod reuse;
mod shade;
mod surface;

use super::{DEPTH_CAP, Effort, Hand, Part, Scratch, Stage, Tracer, Watch};
use crate::brdf::Microfacet;
use crate::geometry::{NO_PLATE, Stack};
use crate::math::columns::{BUNDLE, Column};
use crate::math::lanes::{Bits, Kernel, Packet, Wide, dispatch};
use crate::math::sequence::{PassKey, Slot, Stream, pair};
use crate::math::{Rgb, V3};
use crate::scene::Material;
use further::{Further, Look};
pub use kept::FirstHits;
use paths::{Paths, Shadows};
use rays::Asked;
use reuse::{Firsts, Seconds};
use std::marker::PhantomData;
use surface::{MaterialTable, Met};

/// What the engine looks up.
#[derive(Debug)]
pub(super) struct Tables {
    materials: MaterialTable,
}

impl Tables {
    pub(super) fn new(materials: &[Material]) -> Tables {
        Tables { materials: MaterialTable::new(materials) }
    }
}

/// Memory for one bundle.
#[derive(Clone, Debug, Default)]
pub(super) struct Bundle {
    paths: Box<Paths>,
    /// Of the passes that the paths belong to, by place in the bundle.
    salts: Column<u32>,
    met: Met,
    shadows: Shadows,
    further: Further,
    asked: Asked,
    firsts: Firsts,
    seconds: Seconds,
    /// By place in the bundle.
    radiance: Vec<[f32; 3]>,
    /// Where groups of places end that share; nothing where none do.
    ends: Vec<u32>,
    shares: bool,
    part: Part,
    /// Paths that were ended for their throughput.
    capped: u64,
}

/// Which samples of some pixels.
#[derive(Clone, Copy, Debug)]
pub struct Round<'a> {
    /// Of which pass, from 0, where the [`Hand`] does not say.
    pub pass: u64,
    /// For blocks of so many pixels a side instead of pixels.
    pub block: u32,
    /// What their camera rays met, if it is kept.
    pub first_hits: Option<&'a FirstHits>,
    /// Whether further rays look for lamps, which is the lesser error for a picture; without them
    /// every sample is the reference tracer's.
    pub looks: bool,
}

impl Round<'_> {
    /// One sample a pixel, of which nothing is kept.
    pub fn of(pass: u64) -> Round<'static> {
        Round { pass, block: 1, first_hits: None, looks: true }
    }
}

/// Lights asked at the first point of a path that shares its second one; room is for four.
const LIGHTS_ASKED: u32 = 4;

impl Tracer {
    /// Radiance of one sample of each pixel, in their order: pass `pass` (from 0) of the pixels in
    /// these columns and rows from the top, as [`Tracer::sample`] finds it. The same pixel gets the same bits whichever
    /// pixels are traced with it and on any number of threads; they may differ from one instruction set to another.
    pub fn sample_each(
        &self,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        scratch: &mut Scratch,
        each: &mut dyn FnMut(Rgb),
    ) {
        if !self.is_the_engines() {
            return self.one_by_one(pixels, pass, 1, scratch, each);
        }
        let mut some = Hand::default();
        loop {
            some.pixels.clear();
            some.pixels.extend((&mut *pixels).take(BUNDLE));
            if some.pixels.is_empty() {
                return;
            }
            let round = Round { looks: false, ..Round::of(pass) };
            self.together(&some, round, scratch, &mut |_, _| {});
            for &radiance in &scratch.bundle.radiance {
                each(radiance.into());
            }
        }
    }

    /// The same for the pixels of a [`Hand`], which share as it says, and for what a [`Round`] has
    /// besides: a picture's samples. Not for more than a hand's pixels.
    pub fn sample_hand(
        &self,
        hand: &Hand,
        round: Round,
        scratch: &mut Scratch,
        each: &mut dyn FnMut([u32; 2], Rgb),
    ) {
        if !self.is_the_engines() {
            let mut pixels = hand.pixels.iter();
            let each = &mut |found| each(*pixels.next().expect("one a pixel"), found);
            for (places, pass) in hand.passes(round.pass) {
                let pixels = &mut hand.pixels[places].iter().copied();
                self.one_by_one(pixels, pass, round.block, scratch, each);
            }
            return;
        }
        scratch.bundle.part = hand.part;
        self.together(hand, round, scratch, &mut |_, _| {});
        scratch.bundle.part = Part::Whole;
        for (&pixel, &radiance) in hand.pixels.iter().zip(&scratch.bundle.radiance) {
            each(pixel, radiance.into());
        }
    }

    /// [`Tracer::sample_hand`] into a list, in the order of the hand's pixels.
    pub fn samples_of(&self, hand: &Hand, pass: u64, scratch: &mut Scratch) -> Vec<Rgb> {
        let mut found = Vec::with_capacity(hand.pixels.len());
        self.sample_hand(hand, Round::of(pass), scratch, &mut |_, sample| found.push(sample));
        found
    }

    /// [`Tracer::sample_hand`] for someone who wants to know what is being done, not what comes of
    /// it. Nothing is done where the engine does not work.
    pub fn watch_hand(&self, hand: &Hand, pass: u64, scratch: &mut Scratch, watch: Watch) {
        if self.is_the_engines() {
            self.together(hand, Round::of(pass), scratch, watch);
        }
    }

    pub(super) fn sample_together<M: Microfacet>(
        &self,
        hand: &Hand,
        round: Round,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        // Columns and rows lie where the slots and keys will be.
        let Bundle { paths, salts, ends, .. } = &mut *scratch.bundle;
        for ((x, y), pixel) in paths.slot.0.iter_mut().zip(&mut paths.key.0).zip(&hand.pixels) {
            [*x, *y] = *pixel;
        }
        for (places, pass) in hand.passes(round.pass) {
            let places = places.start.min(BUNDLE)..places.end.min(BUNDLE);
            let PassKey { salt, index } = PassKey::new(self.seed, pass);
            salts.0[places.clone()].fill(salt);
            paths.index.0[places].fill(index);
        }
        ends.clear();
        ends.extend_from_slice(&hand.ends);
        self.follow::<M>(hand.pixels.len().min(BUNDLE), round, scratch, watch);
    }

    /// The paths of the bundle, from the camera to their ends.
    fn follow<M: Microfacet>(
        &self,
        mut count: usize,
        Round { block, first_hits, looks, .. }: Round,
        scratch: &mut Scratch,
        watch: Watch,
    ) {
        let isa = self.scene.bvh().isa();
        let Scratch { stack, bundle, rays, capped, effort } = scratch;
        bundle.radiance.clear();
        bundle.radiance.resize(count, [0.0; 3]);
        bundle.shares = self.max_depth > 1 && !bundle.ends.is_empty();
        if bundle.shares {
            bundle.firsts.there.0.fill(0);
            bundle.seconds.clear(count);
        }
        bundle.further.begin(looks && bundle.part != Part::Shared);
        dispatch(isa, Start { tracer: self, bundle, count, block });
        watch(Stage::Start, count);
        let model = PhantomData::<M>;
        let look = Look { tracer: self, bundle, event: 0, stack, model };
        look.run(rays, effort, watch);
        for event in 0.. {
            let kept = first_hits.filter(|_| event == 0);
            let known = kept.is_some_and(|kept| kept.recall(&mut bundle.met, count));
            effort.alone += dispatch(isa, Trace { tracer: self, bundle, count, known, stack });
            if !known {
                *rays += count as u64;
                effort.nearest += count as u64;
                if let Some(kept) = kept {
                    kept.keep(&bundle.met, count);
                }
            }
            watch(Stage::Trace, count);
            let last = event >= self.max_depth || event >= DEPTH_CAP;
            let shade = Shade { tracer: self, bundle, count, event, last, model };
            let going = dispatch(isa, shade);
            watch(Stage::Shade, count);
            if event >= DEPTH_CAP && event < self.max_depth {
                *capped += going as u64;
            }
            if last {
                break;
            }
            *rays += bundle.shadows.count as u64;
            effort.asked += bundle.shadows.count as u64;
            effort.alone += dispatch(isa, Ask { tracer: self, bundle, stack });
            watch(Stage::Ask, bundle.shadows.count);
            if event == 0 {
                let look = Look { tracer: self, bundle, event: 1, stack, model };
                look.run(rays, effort, watch);
            }
            if going == 0 {
                break;
            }
            count = going;
        }
        *capped += std::mem::take(&mut bundle.capped);
        match bundle.part {
            Part::Shared if bundle.shares => bundle.radiance.fill([0.0; 3]),
            Part::Own => return,
            _ => {}
        }
        if bundle.shares {
            bundle.seconds.sort();
            let joined = dispatch(isa, Join { tracer: self, bundle, stack });
            effort.pairs += joined.pairs;
            effort.joined += joined.joined;
            effort.held += joined.held;
            effort.between += joined.between;
            effort.alone += joined.alone;
            *rays += joined.joined;
            watch(Stage::Join, bundle.seconds.count);
            effort.glossy += dispatch(isa, Share { tracer: self, bundle, model: PhantomData::<M> });
            watch(Stage::Share, bundle.seconds.count);
        }
    }
}

impl Bundle {
    /// How many lights are asked at this event. What is shared costs more than a light, so that a
    /// few more of those pay where nobody shares.
    #[inline(always)]
    fn lights_asked(&self, event: u32) -> u32 {
        if self.shares && event == 0 { LIGHTS_ASKED } else { 1 }
    }
}

/// What light is added to: what the path itself found; what arrives at its second point from the light
/// that was asked; what arrives there from the direction sampled, by reflection.
const RADIANCE: u32 = 0;
const ASKED: u32 = 1;
const REFLECTED: u32 = 2;

/// Camera rays of the pixels whose columns and rows lie where the slots and keys will be.
struct Start<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    count: usize,
    block: u32,
}

impl Kernel for Start<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        let Start { tracer, bundle, count, block } = self;
        let Bundle { paths, salts, further, .. } = bundle;
        let sights = if further.wanted { tracer.sights(block) } else { Vec::new() };
        let side = P::splat(block as f32);
        let eye = tracer.camera.eye().splat_lanes::<P>();
        for at in (0..count).step_by(P::WIDTH) {
            let (x, y) = (paths.slot.load::<P>(at), paths.key.load::<P>(at));
            let (salt, index) = (salts.load::<P>(at), paths.index.load::<P>(at));
            let stream = Stream::of_pixels(x, y, salt, index);
            let [dx, dy] = pair::<P>(&stream, Slot::CAMERA);
            let d = tracer
                .camera
                .direction((P::from_small(x) + dx) * side, (P::from_small(y) + dy) * side);
            paths.o.store(at, eye);
            paths.d.store(at, d);
            paths.beta.store(at, V3::splat(P::splat(1.0)));
            let mut part = P::splat(1.0);
            if !sights.is_empty() {
                let live = P::mask(lowest(count - at));
                let place = [P::from_small(x), P::from_small(y)];
                let slots: [u32; 16] = std::array::from_fn(|lane| (at + lane) as u32);
                let path = (P::load_bits(&slots), &stream);
                part = tracer.look_from_camera(further, &sights, live, place, side, path);
            }
            paths.part.store(at, part);
            paths.plate.store::<P>(at, P::Bits::splat(NO_PLATE));
            paths.key.store::<P>(at, stream.key());
            paths.lead.store::<P>(at, P::Bits::splat(0));
        }
        for (slot, place) in paths.slot.0.iter_mut().zip(0..count as u32) {
            *slot = place;
        }
    }
}

/// Finds what the rays meet: plates by the register, the rest one by one.
struct Trace<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    count: usize,
    /// Whether all was met before.
    known: bool,
    stack: &'a mut Stack,
}

impl Kernel for Trace<'_> {
    /// How many went through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> u64 {
        let Trace { tracer, bundle, count, known, stack } = self;
        let alone = if known { 0 } else { tracer.trace::<W, P>(bundle, count, stack) };
        bundle.met.fetch::<W>(tracer.scene.geometry(), &bundle.paths, count);
        if !known {
            bundle.met.resolve::<P>(&bundle.paths, count);
        }
        alone
    }
}

/// [`Tracer::shade`]
struct Shade<'a, M> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    count: usize,
    event: u32,
    last: bool,
    model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for Shade<'_, M> {
    type Output = usize;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> usize {
        let Shade { tracer, bundle, count, event, last, .. } = self;
        tracer.shade::<P, M>(bundle, count, event, last)
    }
}

/// Adds the light of those shadow rays that meet nothing.
struct Ask<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    stack: &'a mut Stack,
}

impl Kernel for Ask<'_> {
    /// How many went through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> u64 {
        self.tracer.ask::<W, P>(self.bundle, self.stack)
    }
}

/// [`Tracer::join`]
struct Join<'a> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    stack: &'a mut Stack,
}

impl Kernel for Join<'_> {
    type Output = Effort;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> Effort {
        self.tracer.join::<W, P>(self.bundle, self.stack)
    }
}

/// [`Tracer::share`]
struct Share<'a, M> {
    tracer: &'a Tracer,
    bundle: &'a mut Bundle,
    model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for Share<'_, M> {
    /// How often a specular lobe was evaluated.
    type Output = u64;
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) -> u64 {
        self.tracer.share::<P, M>(self.bundle)
    }
}

/// So many lowest bits, at most all.
fn lowest(count: usize) -> u32 {
    if count >= 32 { u32::MAX } else { (1 << count) - 1 }
}
