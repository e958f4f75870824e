//! Normals of a mesh's vertices: as given, or made from its faces.
//!
//! Where a file says nothing, normals are smooth over edges whose faces meet below 45 degrees. Around
//! a vertex such edges join faces into fans, and each fan has a normal of its own: the mean of its
//! faces', each weighted by its angle at the vertex (Thürmer and Wüthrich, "Computing vertex normals
//! from polygonal facets", Journal of Graphics Tools 3:1, 1998). A vertex of several fans becomes as
//! many.
//!
//! **Which way round.** Surfaces are two-sided, so files do not take care that neighbouring faces go
//! round the same way. Two faces that pass through their common edge in opposite directions do; where
//! both pass in the same one, one of them counts turned over, both for the angle and for the mean.
//! Each face then gets the normal on its own side, lest the three that are blended cancel.
//!
//! **Edges of many faces.** Of up to eight faces on an edge each pair is looked at. On an edge of more
//! nothing tells which one goes on in which: it is sharp.

use super::mesh::{Mesh, Smooth};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// Faces that meet at less than this are smooth: 45 degrees less a hundredth, so that rounding does
/// not decide about the sides of an octagon.
const LEAST_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2 + 1e-4;

/// Normals that differ by less than the root of this are those of one plane.
const PLANAR: f64 = 1e-10;

/// Most faces on an edge that are paired with each other.
const MOST_FACES: usize = 8;

/// Vertices that are looked at together.
const CHUNK: usize = 4096;

/// By which rule the triangles of meshes came by their normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NormalCounts {
    /// The file gives them.
    pub given: usize,
    /// Smooth over edges below 45 degrees.
    pub by_angle: usize,
    /// Smooth within a smoothing group.
    pub by_group: usize,
    /// Flat, as the file asks.
    pub flat: usize,
}

impl NormalCounts {
    /// Counts triangles whose normals are made by these rules.
    pub(super) fn made(rules: &[Smooth]) -> NormalCounts {
        let mut counts = NormalCounts::default();
        for rule in rules {
            match rule {
                Smooth::Unsaid => counts.by_angle += 1,
                Smooth::Flat => counts.flat += 1,
                Smooth::Group(_) => counts.by_group += 1,
            }
        }
        counts
    }

    /// Adds others.
    pub(super) fn add(&mut self, more: NormalCounts) {
        self.given += more.given;
        self.by_angle += more.by_angle;
        self.by_group += more.by_group;
        self.flat += more.flat;
    }

    /// One sentence; `None` without meshes.
    pub(super) fn note(&self) -> Option<String> {
        let parts: Vec<String> = [
            (self.given, "given for"),
            (self.by_angle, "smooth over edges below 45 degrees for"),
            (self.by_group, "smooth within groups (`s N`) for"),
            (self.flat, "flat (`s off`) for"),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(n, rule)| format!("{rule} {n} triangle{}", if n == 1 { "" } else { "s" }))
        .collect();
        (!parts.is_empty()).then(|| format!("normals: {}", parts.join(", ")))
    }
}

/// Unit normal; `None` for a triangle without area at the precision of its coordinates.
pub(super) fn face_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let (e, f) = (b - a, c - a);
    let n = e.cross(f);
    let size = e.length().max(f.length());
    if n.length() > 1e-14 * size * size { n.try_normalize() } else { None }
}

/// The normals that a mesh gives, and how many of them are zero or not finite.
pub(super) fn given(mesh: &Mesh, placement: DAffine3) -> (Vec<[f32; 3]>, usize) {
    let inverse_transpose = placement.matrix3.inverse().transpose();
    let mut bad = 0;
    let normals = mesh.normals.iter().map(|&n| match (inverse_transpose * n).try_normalize() {
        Some(n) => n.as_vec3().to_array(),
        None => {
            bad += 1;
            [0.0; 3]
        }
    });
    (normals.collect(), bad)
}

/// Makes normals by these rules, one a triangle; vertices with several are repeated at the end. A
/// zero one stands for the face's.
pub(super) fn make(
    positions: &mut Vec<DVec3>,
    triangles: &mut [[u32; 3]],
    rules: &[Smooth],
) -> Vec<[f32; 3]> {
    let faces: Vec<DVec3> = triangles
        .par_iter()
        .map(|t| face_normal(t.map(|i| positions[i as usize])).unwrap_or_default())
        .collect();
    let (starts, corners) = corners_of_vertices(positions.len(), triangles);
    let around = Around { positions, triangles, faces: &faces, rules };
    let count = positions.len();
    let chunks: Vec<Fans> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut fans = Fans::default();
            let mut scratch = NormalsScratch::default();
            for v in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                around.vertex(&corners[starts[v]..starts[v + 1]], &mut scratch, &mut fans);
            }
            fans
        })
        .collect();
    let mut normals = vec![[0.0; 3]; count];
    let mut planar = vec![true; count];
    let mut at = 0;
    for (chunk, fans) in chunks.iter().enumerate() {
        let mut next = 0;
        for (v, &fans_here) in (chunk * CHUNK..).zip(&fans.counts) {
            let here = next..next + fans_here as usize;
            next = here.end;
            let first_copy = positions.len();
            for (i, fan) in fans.fans[here].iter().enumerate() {
                if i == 0 {
                    (normals[v], planar[v]) = (fan.normal, fan.planar);
                } else {
                    positions.push(positions[v]);
                    normals.push(fan.normal);
                    planar.push(fan.planar);
                }
            }
            for corner in &corners[starts[v]..starts[v + 1]] {
                let fan = fans.of_corners[at - starts[chunk * CHUNK]];
                if fan > 0 {
                    let copy = (first_copy + fan as usize - 1) as u32;
                    triangles[(corner / 3) as usize][(corner % 3) as usize] = copy;
                }
                at += 1;
            }
        }
    }
    flatten(&mut normals, &planar, triangles);
    normals
}

/// Takes the normals from vertices all of whose triangles lie in one plane with what they are joined
/// to: blended from one plane's they are the face's, which is what no normal means.
fn flatten(normals: &mut [[f32; 3]], planar: &[bool], triangles: &[[u32; 3]]) {
    let mut curved = vec![false; normals.len()];
    for triangle in triangles.iter().filter(|t| t.iter().any(|&i| !planar[i as usize])) {
        for &i in triangle {
            curved[i as usize] = true;
        }
    }
    for (normal, _) in normals.iter_mut().zip(&curved).filter(|(_, curved)| !**curved) {
        *normal = [0.0; 3];
    }
}

/// The corners of triangles, numbered through, by the vertices that they are at: where each vertex's
/// begin, and the corners in the order of the triangles.
fn corners_of_vertices(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; vertices + 1];
    for &i in triangles.iter().flatten() {
        starts[i as usize + 1] += 1;
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut corners = vec![0; 3 * triangles.len()];
    for (corner, &i) in (0..).zip(triangles.iter().flatten()) {
        let place = &mut next[i as usize];
        corners[*place] = corner;
        *place += 1;
    }
    (starts, corners)
}

/// The fans of some vertices.
#[derive(Default)]
struct Fans {
    /// How many each vertex has.
    counts: Vec<u32>,
    fans: Vec<Fan>,
    /// Which of its vertex's fans each corner is in.
    of_corners: Vec<u32>,
}

struct Fan {
    normal: [f32; 3],
    planar: bool,
}

/// What is known of a mesh.
struct Around<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    faces: &'a [DVec3],
    rules: &'a [Smooth],
}

/// Memory that vertices use in turn; a place a corner, but for the edges.
#[derive(Default)]
struct NormalsScratch {
    /// The edges' other vertices, with the corner and whether its face leaves the vertex by the edge.
    edges: Vec<(u32, u32, bool)>,
    sets: Sets,
    /// Corners by smoothing group.
    groups: Vec<(u32, u32)>,
    sums: Vec<DVec3>,
    first: Vec<DVec3>,
    planar: Vec<bool>,
    /// The fan of either side of the set with this root.
    fans: Vec<[u32; 2]>,
}

const NONE: u32 = u32::MAX;

impl Around<'_> {
    /// Finds the fans of the vertex that these are all corners at.
    fn vertex(&self, corners: &[u32], scratch: &mut NormalsScratch, found: &mut Fans) {
        let NormalsScratch { edges, sets, groups, sums, first, planar, fans } = scratch;
        let count = corners.len();
        sets.reset(count);
        if count > 1 {
            self.join(corners, edges, sets, groups);
        }
        for (list, nothing) in [(&mut *sums, DVec3::ZERO), (first, DVec3::ZERO)] {
            list.clear();
            list.resize(count, nothing);
        }
        planar.clear();
        planar.resize(count, true);
        for (i, &corner) in corners.iter().enumerate() {
            let (root, turned) = sets.find(i as u32);
            let n = self.faces[(corner / 3) as usize];
            let n = if turned { -n } else { n };
            let root = root as usize;
            sums[root] += n * self.angle(corner);
            if first[root] == DVec3::ZERO {
                first[root] = n;
            }
            planar[root] &= first[root].distance_squared(n) < PLANAR;
        }
        fans.clear();
        fans.resize(count, [NONE; 2]);
        let mut flat = NONE;
        let before = found.fans.len();
        for (i, &corner) in corners.iter().enumerate() {
            let (root, turned) = sets.find(i as u32);
            let is_flat = self.rules[(corner / 3) as usize] == Smooth::Flat;
            let root = root as usize;
            let fan = if is_flat { &mut flat } else { &mut fans[root][usize::from(turned)] };
            if *fan == NONE {
                *fan = (found.fans.len() - before) as u32;
                let sum = if turned { -sums[root] } else { sums[root] };
                let normal = sum.try_normalize().filter(|_| !is_flat).unwrap_or_default();
                let normal = normal.as_vec3().to_array();
                found.fans.push(Fan { normal, planar: is_flat || planar[root] });
            }
            found.of_corners.push(*fan);
        }
        found.counts.push((found.fans.len() - before) as u32);
    }

    /// The face's angle at a corner.
    fn angle(&self, corner: u32) -> f64 {
        let p = self.triangles[(corner / 3) as usize].map(|i| self.positions[i as usize]);
        let k = (corner % 3) as usize;
        (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k])
    }

    /// Joins the corners whose faces are smooth together.
    fn join(
        &self,
        corners: &[u32],
        edges: &mut Vec<(u32, u32, bool)>,
        sets: &mut Sets,
        groups: &mut Vec<(u32, u32)>,
    ) {
        edges.clear();
        groups.clear();
        for (i, &corner) in (0..).zip(corners) {
            let (t, k) = ((corner / 3) as usize, (corner % 3) as usize);
            match self.rules[t] {
                Smooth::Flat => continue,
                Smooth::Group(group) => groups.push((group, i)),
                Smooth::Unsaid => {}
            }
            let triangle = self.triangles[t];
            edges.push((triangle[(k + 1) % 3], i, true));
            edges.push((triangle[(k + 2) % 3], i, false));
        }
        edges.sort_unstable();
        for run in edges.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() <= MOST_FACES) {
            for (n, &(_, i, leaves)) in run.iter().enumerate() {
                for &(_, j, leaves_too) in &run[..n] {
                    let [a, b] = [i, j].map(|i| (corners[i as usize] / 3) as usize);
                    let turned = leaves == leaves_too;
                    let cosine = self.faces[a].dot(self.faces[b]);
                    let cosine = if turned { -cosine } else { cosine };
                    let smooth = match (self.rules[a], self.rules[b]) {
                        (Smooth::Unsaid, Smooth::Unsaid) => cosine > LEAST_COSINE,
                        (Smooth::Group(a), Smooth::Group(b)) => a == b,
                        _ => false,
                    };
                    if smooth {
                        sets.join(i, j, turned);
                    }
                }
            }
        }
        // A group is smooth over shared vertices, whether or not its faces have edges in common.
        groups.sort_unstable();
        for pair in groups.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            sets.join(pair[0].1, pair[1].1, false);
        }
    }
}

/// Disjoint sets whose members are each one way round or the other, relative to their root.
#[derive(Default)]
struct Sets(Vec<(u32, bool)>);

impl Sets {
    /// As many sets of one.
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend((0..count as u32).map(|i| (i, false)));
    }

    /// The root of a member's set, and whether the member is the other way round.
    fn find(&mut self, member: u32) -> (u32, bool) {
        let (mut root, mut turned) = (member, false);
        while self.0[root as usize].0 != root {
            let (parent, turns) = self.0[root as usize];
            (root, turned) = (parent, turned ^ turns);
        }
        // All on the way are put right below the root.
        let (mut at, mut left) = (member, turned);
        while at != root {
            let (parent, turns) = self.0[at as usize];
            self.0[at as usize] = (root, left);
            (at, left) = (parent, left ^ turns);
        }
        (root, turned)
    }

    /// Makes two sets one; the smaller root stays.
    fn join(&mut self, a: u32, b: u32, turned: bool) {
        let ((a, a_turned), (b, b_turned)) = (self.find(a), self.find(b));
        let turned = turned ^ a_turned ^ b_turned;
        if a != b {
            self.0[a.max(b) as usize] = (a.min(b), turned);
        }
    }
}

#[cfg(test)]
mod tests;
