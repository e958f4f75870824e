//! Many rays through the tree together.
//!
//! A ray alone waits: for memory, for the test of the box that says where to go next, for branches
//! that no one can foretell. So a few rays are on their way at a time, each with its own stack, and
//! take steps in turn: first all those at a node, then all those at triangles. While the ones are
//! tested, memory fetches what the others need. Which list a ray goes to next is arithmetic, not a
//! branch. The tests are those of a single ray, so the hits are the same bits.

use super::bvh::{Bvh, Child, child};
use super::traverse::{Slabs, Stack, is_traceable, quadric, take_nearer, take_nearest};
use super::triangle::{self, Sheared};
use super::{Geometry, Hit, Ray};
use crate::math::lanes::{Kernel, Packet, Wide, dispatch};

/// A ray and how far it goes.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// Largest distance of a hit, in units of the ray's direction.
    pub t_max: f32,
}

/// Rays on their way at a time.
const RAYS: usize = 16;
/// In place of a child: there is nothing left to visit.
const DONE: u32 = (1 << 31) - 1;
/// No hit.
const NOTHING: u32 = u32::MAX;

/// A ray on its way.
#[derive(Clone, Copy, Debug, Default)]
struct Traveller {
    slabs: Slabs,
    sheared: Sheared,
    best: Hit,
    /// Which query it is.
    query: u32,
    /// What it stands before.
    word: u32,
    /// Places of its stack that are taken.
    top: usize,
}

/// Memory for rays on their way.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    travellers: Box<[Traveller; RAYS]>,
    /// Places of one stack.
    room: usize,
    /// Entry distances, with the last four bits of no meaning.
    enter: Box<[u32]>,
    words: Box<[u32]>,
}

impl Streams {
    pub(super) fn new(depth: usize) -> Streams {
        // What says that nothing is left, what each level leaves behind, and eight places that may
        // be written beyond the top.
        let room = 1 + 7 * depth + 1 + 8;
        Streams {
            travellers: Box::new([Traveller::default(); RAYS]),
            room,
            enter: vec![0; RAYS * room].into(),
            words: vec![0; RAYS * room].into(),
        }
    }
}

/// Travellers by what they stand before.
#[derive(Default)]
struct Lists {
    nodes: List,
    packs: List,
    /// Quadrics and the end.
    others: List,
}

#[derive(Default)]
struct List {
    who: [u8; 2 * RAYS],
    len: usize,
}

impl List {
    #[inline(always)]
    fn push_if(&mut self, is: bool, who: usize) {
        self.who[self.len % (2 * RAYS)] = who as u8;
        self.len += is as usize;
    }
}

impl Lists {
    #[inline(always)]
    fn push(&mut self, who: usize, word: u32) {
        self.nodes.push_if(word >> 30 == 0, who);
        self.packs.push_if(word >> 30 >= 2, who);
        self.others.push_if(word >> 30 == 1, who);
    }
}

impl Bvh {
    /// [`Bvh::closest`] of many rays, which is faster than one after the other.
    pub fn closest_each(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        stack: &mut Stack,
        hits: &mut Vec<Option<Hit>>,
    ) {
        struct Closest<'a>(
            &'a Bvh,
            &'a Geometry,
            &'a [Query],
            &'a mut Stack,
            &'a mut Vec<Option<Hit>>,
        );
        impl Kernel for Closest<'_> {
            type Output = ();
            #[inline(always)]
            fn run<W: Wide, P: Packet>(self) {
                self.0.closest_each_with::<W>(self.1, self.2, true, self.3, self.4);
            }
        }
        dispatch(self.isa, Closest(self, geometry, queries, stack, hits));
    }

    #[inline(always)]
    pub(crate) fn closest_each_with<W: Wide>(
        &self,
        geometry: &Geometry,
        queries: &[Query],
        plates: bool,
        stack: &mut Stack,
        hits: &mut Vec<Option<Hit>>,
    ) {
        hits.clear();
        hits.resize(queries.len(), None);
        let streams = &mut stack.1;
        let room = streams.room;
        let mut next = 0;
        let mut lists = Lists::default();
        for who in 0..RAYS {
            self.set_out::<W>(
                &mut streams.travellers[who],
                queries,
                &mut next,
                plates,
                hits,
                &mut lists,
                who,
            );
            streams.words[who * room] = DONE;
        }
        loop {
            if lists.nodes.len + lists.packs.len + lists.others.len == 0 {
                return;
            }
            for &who in &lists.packs.who[..lists.packs.len] {
                if let Child::Pack(index) = child(streams.travellers[who as usize % RAYS].word) {
                    W::prefetch(&self.packs[index]);
                }
            }
            let (at_nodes, at_packs) =
                (std::mem::take(&mut lists.nodes), std::mem::take(&mut lists.packs));
            for &who in &at_nodes.who[..at_nodes.len] {
                let who = who as usize % RAYS;
                let traveller = &mut streams.travellers[who];
                let node = &self.nodes[traveller.word as usize];
                let (enter, mask) = traveller.slabs.test::<W>(node, traveller.best.t);
                let top = who * room + traveller.top + 1;
                let (numbers, words) =
                    (&mut streams.enter[top..top + 8], &mut streams.words[top..top + 8]);
                let (Ok(numbers), Ok(words)) = (numbers.try_into(), words.try_into()) else {
                    return;
                };
                traveller.top += enter.far_first(mask, &node.child, numbers, words);
                traveller.pop(
                    &streams.enter[who * room..(who + 1) * room],
                    &streams.words[who * room..(who + 1) * room],
                );
                lists.push(who, traveller.word);
            }
            for &who in &lists.nodes.who[..lists.nodes.len] {
                W::prefetch(&self.nodes[streams.travellers[who as usize % RAYS].word as usize]);
            }
            for &who in &at_packs.who[..at_packs.len] {
                let who = who as usize % RAYS;
                let traveller = &mut streams.travellers[who];
                let Child::Pack(index) = child(traveller.word) else { return };
                take_nearest::<W>(&mut traveller.best, &self.packs[index], &traveller.sheared);
                traveller.pop(
                    &streams.enter[who * room..(who + 1) * room],
                    &streams.words[who * room..(who + 1) * room],
                );
                lists.push(who, traveller.word);
            }
            let others = std::mem::take(&mut lists.others);
            for &who in &others.who[..others.len] {
                let who = who as usize % RAYS;
                let traveller = &mut streams.travellers[who];
                if traveller.word == DONE {
                    let best = traveller.best;
                    hits[traveller.query as usize] = (best.primitive != NOTHING).then_some(best);
                    self.set_out::<W>(traveller, queries, &mut next, plates, hits, &mut lists, who);
                    continue;
                }
                if let Child::Quadric(primitive) = child(traveller.word) {
                    let ray = &queries[traveller.query as usize].ray;
                    if let Some(t) = quadric(geometry, primitive, ray, traveller.best.t) {
                        take_nearer(&mut traveller.best, t, primitive, [0.0; 2]);
                    }
                }
                traveller.pop(
                    &streams.enter[who * room..(who + 1) * room],
                    &streams.words[who * room..(who + 1) * room],
                );
                lists.push(who, traveller.word);
            }
        }
    }

    /// Puts the next query on its way, if there is one.
    #[inline(always)]
    fn set_out<W: Wide>(
        &self,
        traveller: &mut Traveller,
        queries: &[Query],
        next: &mut usize,
        plates: bool,
        hits: &mut [Option<Hit>],
        lists: &mut Lists,
        who: usize,
    ) {
        while let Some(Query { ray, t_max }) = queries.get(*next) {
            let query = *next;
            *next += 1;
            if !is_traceable(ray) {
                continue;
            }
            let sheared = Sheared::new(ray.o, ray.d);
            let mut best = Hit { t: *t_max, primitive: NOTHING, b: [0.0; 2] };
            if plates {
                for pack in &self.large {
                    take_nearest::<W>(&mut best, pack, &sheared);
                }
            }
            let Some(root) = self.root else {
                hits[query] = (best.primitive != NOTHING).then_some(best);
                continue;
            };
            *traveller = Traveller {
                slabs: Slabs::new(ray),
                sheared,
                best,
                query: query as u32,
                word: root,
                top: 0,
            };
            lists.push(who, root);
            return;
        }
    }
}

impl Traveller {
    /// Goes on to what was put aside last and does not lie beyond the best hit by now.
    #[inline(always)]
    fn pop(&mut self, enter: &[u32], words: &[u32]) {
        while self.top > 0 && f32::from_bits(enter[self.top] & !15) > self.best.t {
            self.top -= 1;
        }
        self.word = words[self.top];
        self.top = self.top.saturating_sub(1);
    }
}
