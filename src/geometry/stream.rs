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
use crate::math::lanes::{Bits, Kernel, Lane, Mask, Packet, Wide, dispatch};

/// A ray and how far it goes.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// Largest distance of a hit, in units of the ray's direction.
    pub t_max: f32,
}

/// Rays of a group; there are two, and while one is tested, memory fetches what the other needs.
const GROUP: usize = 16;
/// In place of a child: there is nothing left to visit.
const DONE: u32 = (1 << 31) - 1;
/// No hit.
const NOTHING: u32 = u32::MAX;
/// Places of a stack below the first that is used: they say that nothing is left.
const FLOOR: usize = 8;

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
    /// Places of its stack that are taken, the floor's among them.
    top: usize,
}

/// Memory for rays on their way.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    travellers: Box<[Traveller; 2 * GROUP]>,
    /// Places of one stack.
    room: usize,
    /// Entry distances, with the last four bits of no meaning.
    enter: Box<[f32]>,
    words: Box<[u32]>,
}

impl Streams {
    pub(super) fn new(depth: usize) -> Streams {
        // The floor, what each level leaves behind, and eight places that may be written beyond.
        let room = (FLOOR + 7 * depth + 1 + 8).next_multiple_of(8);
        Streams {
            travellers: Box::new([Traveller::default(); 2 * GROUP]),
            room,
            enter: vec![0.0; 2 * GROUP * room].into(),
            words: vec![DONE; 2 * GROUP * room].into(),
        }
    }
}

/// Travellers of a group by what they stand before.
#[derive(Clone, Copy, Default)]
struct Lists {
    nodes: List,
    packs: List,
    /// Quadrics and the end.
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
        let Streams { travellers, room, enter: distances, words } = &mut stack.1;
        let room = *room;
        let mut next = 0;
        let mut groups = [Lists::default(); 2];
        let mut active = [0; 2];
        for who in 0..2 * GROUP {
            let Some(traveller) = self.set_out::<W>(queries, &mut next, plates, hits) else { break };
            travellers[who] = traveller;
            groups[who / GROUP].push(who, traveller.word);
            active[who / GROUP] += 1;
        }
        while active[0] + active[1] > 0 {
            for (group, lists) in groups.iter_mut().enumerate() {
                let (mut quadrics, mut moved) = (List::default(), List::default());
                for who in lists.nodes.iter() {
                    let traveller = &mut travellers[who];
                    let node = &self.nodes[traveller.word as usize];
                    let (enter, mask) = traveller.slabs.test::<W>(node, traveller.best.t);
                    let top = who * room + traveller.top;
                    let (Ok(distances), Ok(words)) = (
                        (&mut distances[top..top + 8]).try_into(),
                        (&mut words[top..top + 8]).try_into(),
                    ) else {
                        return;
                    };
                    traveller.top += enter.far_first(mask, &node.child, distances, words);
                }
                for who in lists.packs.iter() {
                    let traveller = &mut travellers[who];
                    let Child::Pack(index) = child(traveller.word) else { return };
                    take_nearest::<W>(&mut traveller.best, &self.packs[index], &traveller.sheared);
                }
                for who in lists.others.iter() {
                    let traveller = &mut travellers[who];
                    if let Child::Quadric(primitive) = child(traveller.word)
                        && traveller.word != DONE
                    {
                        let ray = &queries[traveller.query as usize].ray;
                        if let Some(t) = quadric(geometry, primitive, ray, traveller.best.t) {
                            take_nearer(&mut traveller.best, t, primitive, [0.0; 2]);
                        }
                        quadrics.push_if(true, who);
                        continue;
                    }
                    let best = traveller.best;
                    hits[traveller.query as usize] = (best.primitive != NOTHING).then_some(best);
                    if let Some(traveller) = self.set_out::<W>(queries, &mut next, plates, hits) {
                        travellers[who] = traveller;
                        moved.push_if(true, who);
                    } else {
                        active[group] -= 1;
                        travellers[who].query = NOTHING;
                    }
                }
                let mut after = Lists::default();
                for who in moved.iter() {
                    after.push(who, travellers[who].word);
                }
                for old in [&lists.nodes, &lists.packs, &quadrics] {
                    for who in old.iter() {
                        let traveller = &mut travellers[who];
                        traveller.pop::<W>(
                            &distances[who * room..(who + 1) * room],
                            &words[who * room..(who + 1) * room],
                        );
                        after.push(who, traveller.word);
                    }
                }
                for who in after.nodes.iter() {
                    W::prefetch(&self.nodes[travellers[who].word as usize]);
                }
                for who in after.packs.iter() {
                    if let Child::Pack(index) = child(travellers[who].word) {
                        W::prefetch(&self.packs[index]);
                    }
                }
                *lists = after;
            }
        }
    }

    /// Puts the next query on its way, if there is one.
    #[inline(always)]
    fn set_out<W: Wide>(
        &self,
        queries: &[Query],
        next: &mut usize,
        plates: bool,
        hits: &mut [Option<Hit>],
    ) -> Option<Traveller> {
        while let Some(Query { ray, t_max }) = queries.get(*next) {
            let query = *next;
            *next += 1;
            if !is_traceable(ray) || !(*t_max > 0.0) {
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
            return Some(Traveller {
                slabs: Slabs::new(ray),
                sheared,
                best,
                query: query as u32,
                word: root,
                top: FLOOR,
            });
        }
        None
    }
}

impl Traveller {
    /// Goes on to what was put aside last and does not lie beyond the best hit by now.
    #[inline(always)]
    fn pop<W: Wide>(&mut self, distances: &[f32], words: &[u32]) {
        loop {
            let Some(Ok(last)) = distances.get(self.top - 8..self.top).map(|d| d.try_into()) else {
                return;
            };
            let known = W::from_bits(W::load(last).to_bits() & W::Bits::splat(!15));
            let mask = known.le(W::splat(self.best.t)).bits();
            if mask != 0 {
                let place = self.top - 8 + (31 - mask.leading_zeros() as usize);
                self.word = words[place];
                self.top = place.max(FLOOR);
                return;
            }
            self.top -= 8;
        }
    }
}
