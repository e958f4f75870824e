//! Many rays through the tree together.
//!
//! A ray alone waits: for memory, for the test of the box that says where to go next, for branches
//! that no one can foretell. So a few rays are on their way at a time, each with its own stack, and
//! take steps in turn: first all those at a node, then all those at triangles. While the ones are
//! tested, memory fetches what the others need. Which list a ray goes to next is arithmetic, not a
//! branch. The tests are those of a single ray, so the hits are the same bits.

use super::bvh::Bvh;
use super::in_flight::{GROUP, InFlightRay, NOTHING, Streams};
use super::leaf::{hit_analytic, take_nearer, take_nearest};
use super::node::{ANALYTIC, END, PACK};
use super::ray::{Query, is_traceable};
use super::slabs::Slabs;
use super::stack::Stack;
use crate::geometry::triangle::{self, ShearedRay};
use crate::geometry::{Geometry, Hit, Ray};
use crate::math::simd::{Kernel, Simd8, SimdWide, dispatch};
use std::marker::PhantomData;

/// There is a hit, no matter where; nothing lies this side of it.
const FOUND: Hit = Hit { t: f32::NEG_INFINITY, primitive: 0, b: [0.0; 2] };

/// Rays of a group by what they stand before.
#[derive(Clone, Copy, Default)]
struct Lists {
    nodes: List,
    packs: List,
    /// Analytic shapes and the end.
    others: List,
}

#[derive(Clone, Copy, Default)]
struct List {
    who: [u8; 2 * GROUP],
    len: usize,
}

impl List {
    #[inline(always)]
    fn push_if(&mut self, is: bool, who: usize) {
        self.who[self.len % (2 * GROUP)] = who as u8;
        self.len += is as usize;
    }
    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = usize> + use<'_> {
        self.who[..self.len].iter().map(|&who| who as usize % (2 * GROUP))
    }
}

impl Lists {
    #[inline(always)]
    fn push(&mut self, who: usize, word: u32) {
        let kind = word & END;
        self.nodes.push_if(kind == 0, who);
        self.packs.push_if(kind == PACK, who);
        self.others.push_if(kind & ANALYTIC != 0, who);
    }
}

/// What is asked about a ray.
trait Goal {
    type Answer: Copy;
    const NONE: Self::Answer;
    /// Whether one hit, wherever, ends the search.
    const ANY: bool;
    fn answer(best: Hit) -> Self::Answer;
    /// The answer where surfaces coincide.
    fn settled(bvh: &Bvh, geometry: &Geometry, ray: &Ray, answer: Self::Answer) -> Self::Answer;
    /// The answer for a ray alone whose best hit so far is this.
    fn alone<W: Simd8>(each: &mut Each<'_, Self>, ray: &Ray, ready: &Ready) -> Self::Answer
    where
        Self: Sized;
}

/// A ray made ready for triangles, and its best hit among those outside the tree.
struct Ready {
    sheared: ShearedRay,
    best: Hit,
}

struct Nearest;

impl Goal for Nearest {
    type Answer = Option<Hit>;
    const NONE: Option<Hit> = None;
    const ANY: bool = false;
    #[inline(always)]
    fn answer(best: Hit) -> Option<Hit> {
        (best.primitive != NOTHING).then_some(best)
    }
    #[inline(always)]
    fn settled(bvh: &Bvh, geometry: &Geometry, ray: &Ray, answer: Option<Hit>) -> Option<Hit> {
        bvh.in_front(geometry, ray, answer)
    }
    #[inline(always)]
    fn alone<W: Simd8>(each: &mut Each<'_, Nearest>, ray: &Ray, ready: &Ready) -> Option<Hit> {
        let Ready { sheared, best } = ready;
        each.bvh.closest_in_tree::<W>(each.geometry, ray, sheared, *best, each.stack)
    }
}

struct Any;

impl Goal for Any {
    type Answer = bool;
    const NONE: bool = false;
    const ANY: bool = true;
    #[inline(always)]
    fn answer(best: Hit) -> bool {
        best.primitive != NOTHING
    }
    #[inline(always)]
    fn settled(_: &Bvh, _: &Geometry, _: &Ray, answer: bool) -> bool {
        answer
    }
    #[inline(always)]
    fn alone<W: Simd8>(each: &mut Each<'_, Any>, ray: &Ray, ready: &Ready) -> bool {
        let Ready { sheared, best } = ready;
        let found = Any::answer(*best);
        found || each.bvh.occluded_in_tree::<W>(each.geometry, ray, sheared, best.t, each.stack)
    }
}

impl Bvh {
    /// [`Bvh::closest`] of many rays, which is faster than one after the other: 500 at a time are
    /// enough. The answers are in the order of the rays.
    pub fn closest_each(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        stack: &mut Stack,
        hits: &mut Vec<Option<Hit>>,
    ) {
        let (outside, answers) = (true, hits);
        dispatch(
            stack.isa,
            Each::<Nearest> { bvh: self, geometry, queries, outside, stack, answers },
        );
    }

    /// [`Bvh::occluded`] of many rays, as [`Bvh::closest_each`].
    pub fn occluded_each(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        stack: &mut Stack,
        occluded: &mut Vec<bool>,
    ) {
        let (outside, answers) = (true, occluded);
        dispatch(stack.isa, Each::<Any> { bvh: self, geometry, queries, outside, stack, answers });
    }

    /// [`Bvh::closest_each`] among what the tree holds, for callers that run under an instruction
    /// set already.
    #[inline(always)]
    pub(super) fn closest_each_in_tree<W: Simd8>(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        stack: &mut Stack,
        hits: &mut Vec<Option<Hit>>,
    ) {
        let (outside, answers) = (false, hits);
        Each::<Nearest> { bvh: self, geometry, queries, outside, stack, answers }.answer::<W>();
    }

    /// [`Bvh::occluded_each`] by what the tree holds, for callers that run under an instruction set
    /// already.
    #[inline(always)]
    pub(super) fn occluded_each_in_tree<W: Simd8>(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        stack: &mut Stack,
        occluded: &mut Vec<bool>,
    ) {
        let (outside, answers) = (false, occluded);
        Each::<Any> { bvh: self, geometry, queries, outside, stack, answers }.answer::<W>();
    }
}

/// Rays to be traced, and where the answers go.
struct Each<'a, G: Goal> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    queries: &'a [Query],
    /// Whether what is not in the tree counts.
    outside: bool,
    stack: &'a mut Stack,
    answers: &'a mut Vec<G::Answer>,
}

impl<G: Goal> Kernel for Each<'_, G> {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        self.answer::<W>();
    }
}

impl<G: Goal> Each<'_, G> {
    #[inline(always)]
    fn answer<W: Simd8>(mut self) {
        self.answers.clear();
        self.answers.resize(self.queries.len(), G::NONE);
        if W::INTERLEAVED {
            self.interleaved::<W>();
        } else {
            self.one_by_one::<W>();
        }
        let Each { bvh, geometry, queries, answers, .. } = self;
        if !bvh.coincident.is_empty() {
            for (answer, Query { ray, .. }) in answers.iter_mut().zip(queries) {
                *answer = G::settled(bvh, geometry, ray, *answer);
            }
        }
    }

    #[inline(always)]
    fn one_by_one<W: Simd8>(&mut self) {
        for (at, Query { ray, t_max }) in self.queries.iter().enumerate() {
            let ready = self.bvh.make_ready::<W>(self.geometry, ray, *t_max, self.outside);
            if let Some(ready) = ready {
                self.answers[at] = G::alone::<W>(self, ray, &ready);
            }
        }
    }

    #[inline(always)]
    fn interleaved<W: Simd8>(&mut self) {
        let Each { bvh, geometry, queries, outside, stack, answers } = self;
        let (bvh, geometry, queries, outside) = (*bvh, *geometry, *queries, *outside);
        let (nodes, packs) = (&bvh.nodes[..], &bvh.packs[..]);
        let Streams { flights, enter: distances, words } = &mut stack.streams;
        let mut source =
            QuerySource::<G> { bvh, geometry, queries, outside, next: 0, goal: PhantomData };
        let mut groups = [Lists::default(); 2];
        let mut active = 0;
        for (who, flight) in flights.iter_mut().enumerate() {
            if !source.send::<W>(flight, answers) {
                break;
            }
            groups[who / GROUP].push(who, flight.word);
            active += 1;
        }
        while active > 0 {
            for lists in &mut groups {
                let (mut analytic, mut sent) = (List::default(), List::default());
                for who in lists.nodes.iter() {
                    let flight = &mut flights[who];
                    let node = &nodes[flight.word as usize];
                    let (enter, mask) = flight.slabs.test::<W>(node, flight.best.t);
                    let top = flight.top;
                    let (Some(distances), Some(words)) = (
                        distances.get_mut(top..).and_then(|free| free.first_chunk_mut()),
                        words.get_mut(top..).and_then(|free| free.first_chunk_mut()),
                    ) else {
                        return;
                    };
                    flight.top += if G::ANY {
                        W::pick(mask, &node.child, words)
                    } else {
                        enter.sort_far_to_near(mask, &node.child, distances, words)
                    };
                }
                for who in lists.packs.iter() {
                    let InFlightRay { word, best, sheared, .. } = &mut flights[who];
                    let pack = &packs[(*word & !PACK) as usize];
                    if !G::ANY {
                        take_nearest::<W>(best, pack, sheared);
                    } else if triangle::intersect::<W>(pack, sheared, best.t).is_some() {
                        *best = FOUND;
                    }
                }
                for who in lists.others.iter() {
                    let flight = &mut flights[who];
                    if flight.word == END {
                        answers[flight.query as usize] = G::answer(flight.best);
                        let another = source.send::<W>(flight, answers);
                        sent.push_if(another, who);
                        active -= !another as usize;
                        continue;
                    }
                    let primitive = flight.word & !ANALYTIC;
                    let ray = &queries[flight.query as usize].ray;
                    if let Some(t) = hit_analytic(geometry, primitive, ray, flight.best.t) {
                        if G::ANY {
                            flight.best = FOUND;
                        } else {
                            take_nearer(&mut flight.best, t, primitive, [0.0; 2]);
                        }
                    }
                    analytic.push_if(true, who);
                }
                let mut after = Lists::default();
                for who in sent.iter() {
                    after.push(who, flights[who].word);
                }
                for moved in [&lists.nodes, &lists.packs, &analytic] {
                    for who in moved.iter() {
                        let flight = &mut flights[who];
                        if G::ANY {
                            flight.pop_any(words);
                        } else {
                            flight.pop::<W>(distances, words);
                        }
                        after.push(who, flight.word);
                    }
                }
                for who in after.nodes.iter() {
                    W::prefetch(&nodes[flights[who].word as usize]);
                }
                for who in after.packs.iter() {
                    W::prefetch(&packs[(flights[who].word & !PACK) as usize]);
                }
                *lists = after;
            }
        }
    }
}

impl Bvh {
    /// `None` for rays that hit nothing.
    #[inline(always)]
    fn make_ready<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        outside: bool,
    ) -> Option<Ready> {
        // No hit is at a distance below 0, and comparing with NaN would find no end.
        if !is_traceable(ray) || t_max.is_nan() || t_max <= 0.0 {
            return None;
        }
        let sheared = ShearedRay::new(ray.o, ray.d);
        let mut best = Hit { t: t_max, primitive: NOTHING, b: [0.0; 2] };
        if outside {
            self.take_outside::<W>(geometry, ray, &sheared, &mut best);
        }
        Some(Ready { sheared, best })
    }
}

/// Queries not yet on their way.
struct QuerySource<'a, G> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    queries: &'a [Query],
    outside: bool,
    next: usize,
    goal: PhantomData<G>,
}

impl<G: Goal> QuerySource<'_, G> {
    /// Sends the next query on its way; false if there is none. What needs no way is answered.
    #[inline(always)]
    fn send<W: Simd8>(&mut self, flight: &mut InFlightRay, answers: &mut [G::Answer]) -> bool {
        while let Some(Query { ray, t_max }) = self.queries.get(self.next) {
            let query = self.next;
            self.next += 1;
            let ready = self.bvh.make_ready::<W>(self.geometry, ray, *t_max, self.outside);
            let Some(Ready { sheared, best }) = ready else { continue };
            let Some(word) = self.bvh.root.filter(|_| !G::ANY || best.primitive == NOTHING) else {
                answers[query] = G::answer(best);
                continue;
            };
            let slabs = Slabs::new(ray);
            let floor = flight.floor;
            let query = query as u32;
            *flight = InFlightRay { slabs, sheared, best, query, word, floor, top: floor };
            return true;
        }
        false
    }
}
