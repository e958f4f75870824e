//! Shapes in the same place: one of them is kept, and the loss of another material is told.
//!
//! Of surfaces that coincide the emitter is in front, or else the one that comes first in the file. By
//! the tie rule of the traversal the others could never be hit, and thousands of them make trees deep.
//! Places are compared as the tracer has them: in f32, in the scene's local units.

use super::{MaterialId, Placement};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Where a shape comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Origin {
    pub(super) material: MaterialId,
    /// The line that asks for it, where the reader knows.
    pub(super) line: Option<usize>,
}

/// Numbers that tell a place from any other.
pub(super) type Key = [u64; 9];

/// Shapes that are left out because another is in the same place.
#[derive(Clone, Debug, Default)]
pub(super) struct Doubles {
    pub(super) count: usize,
    lost: Vec<Lost>,
    index: HashMap<(MaterialId, MaterialId), usize>,
}

/// Shapes of one material that are left out for some of another.
#[derive(Clone, Debug)]
pub(super) struct Lost {
    /// The first that is left out, and what is in front of it.
    pub(super) first: Origin,
    pub(super) front: Origin,
    /// Triangles, spheres, cylinders.
    pub(super) counts: [usize; 3],
}

impl Doubles {
    /// Finds the shapes among `count` of one `kind` that are to be left out.
    pub(super) fn find(
        &mut self,
        kind: usize,
        count: usize,
        key: impl Fn(usize) -> Key + Sync,
        origin: impl Fn(usize) -> Origin,
        emits: impl Fn(MaterialId) -> bool,
    ) -> Vec<bool> {
        let hash = |i: usize| {
            let mix = |h: u64, x: &u64| (h ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
            key(i).iter().fold(0, mix)
        };
        let mut order: Vec<(u64, u32)> =
            (0..count).into_par_iter().map(|i| (hash(i), i as u32)).collect();
        order.par_sort_unstable();
        let mut drop = vec![false; count];
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for run in order.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
            let mut places: HashMap<Key, usize> = HashMap::new();
            let members = || run.iter().map(|&(_, i)| i as usize);
            for i in members() {
                let front = places.entry(key(i)).or_insert(i);
                if !emits(origin(*front).material) && emits(origin(i).material) {
                    *front = i;
                }
            }
            for i in members() {
                let front = places.get(&key(i)).copied().unwrap_or(i);
                if front != i {
                    drop[i] = true;
                    pairs.push((i, front));
                }
            }
        }
        self.count += pairs.len();
        pairs.sort_unstable();
        for (lost, front) in pairs {
            self.tell(kind, origin(lost), origin(front));
        }
        drop
    }

    fn tell(&mut self, kind: usize, first: Origin, front: Origin) {
        if first.material == front.material {
            return;
        }
        let place = (first.material, front.material);
        let index = *self.index.entry(place).or_insert_with(|| {
            self.lost.push(Lost { first, front, counts: [0; 3] });
            self.lost.len() - 1
        });
        if let Some(lost) = self.lost.get_mut(index) {
            lost.counts[kind] += 1;
        }
    }

    /// Those of other materials than what is in front of them.
    pub(super) fn lost(&self) -> &[Lost] {
        &self.lost
    }
}

impl Lost {
    /// One sentence; `name` is what a material is called, and whether it emits.
    pub(super) fn sentence(&self, name: impl Fn(MaterialId) -> (String, bool)) -> String {
        let some = |(n, what): (&usize, &str)| {
            (*n > 0).then(|| format!("{n} {what}{}", if *n == 1 { "" } else { "s" }))
        };
        let whats = ["triangle", "sphere", "cylinder"];
        let what: Vec<String> = self.counts.iter().zip(whats).filter_map(some).collect();
        let line = |o: Origin| o.line.map_or(String::new(), |line| format!(" (line {line})"));
        let ((lost, _), (front, emits)) = (name(self.first.material), name(self.front.material));
        let why =
            if emits { "what emits is in front" } else { "the first in the file is in front" };
        format!(
            "{} of `{lost}`{} in the same place as of `{front}`{}: left out, for {why}",
            what.join(", "),
            line(self.first),
            line(self.front)
        )
    }
}

/// Where places are compared.
pub(super) struct FirstPlaces(pub(super) Placement);

impl FirstPlaces {
    /// Three components; the zeros are one.
    fn point(&self, p: DVec3) -> [u64; 3] {
        self.0.to_local(p).as_vec3().to_array().map(|x| u64::from((x + 0.0).to_bits()))
    }

    fn length(&self, x: f64) -> u64 {
        u64::from(((x * self.0.scale()) as f32).to_bits())
    }

    /// The corners in any order. Where rounding leaves fewer than three, they are told apart by what
    /// they were before.
    pub(super) fn triangle(&self, corners: [DVec3; 3]) -> Key {
        let mut sorted = corners.map(|p| self.point(p));
        sorted.sort_unstable();
        if sorted[0] == sorted[1] || sorted[1] == sorted[2] {
            sorted = corners.map(|p| p.to_array().map(|x| (x + 0.0).to_bits()));
            sorted.sort_unstable();
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = sorted;
        [a, b, c, d, e, f, g, h, i]
    }

    pub(super) fn sphere(&self, centre: DVec3, radius: f64) -> Key {
        let [x, y, z] = self.point(centre);
        [x, y, z, self.length(radius), 0, 0, 0, 0, 0]
    }

    /// From either end.
    pub(super) fn cylinder(&self, base: DVec3, axis: DVec3, radius: f64) -> Key {
        let mut ends = [self.point(base), self.point(base + axis)];
        ends.sort_unstable();
        let [[a, b, c], [d, e, f]] = ends;
        [a, b, c, d, e, f, self.length(radius), 0, 0]
    }
}
