//! The binary tree, from its leaves up: what lies near each other along a curve through space is
//! paired, each with the one that makes the smallest box with it, round by round.
//!
//! This is parallel locally-ordered clustering (Meister and Bittner, 2018), as obvhs has it, which
//! cannot be taken from there: where boxes are equal, or grow along the curve, each of a run wants
//! the same neighbour, a round makes one pair, and the build takes time by the square of the run.
//! Here equals are paired at once, and after a round of few pairs all neighbours are paired, so that
//! [no input](pair_up) takes more rounds than the logarithm of its length explains.

use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH};
use obvhs::ploc::morton::morton_encode_u64_unorm;
use rayon::prelude::*;

/// In the first rounds, which have most to look at, only the next neighbours are compared.
const QUICK_ROUNDS: usize = 3;
/// How far along the curve partners are looked for from then on.
const REACH: usize = 14;
/// A round that pairs fewer than one in `FEW` is followed by one that pairs all.
const FEW: usize = 32;
/// Number of boxes that one thread compares.
const SHARE: usize = 2048;

/// A tree with one box a leaf; there must be one at least. Each round but every other leaves at most
/// 31 in 32 of those before, and each of the others half.
pub(super) fn pair_up(bounds: &[Aabb]) -> Bvh2 {
    let count = bounds.len();
    let leaf = |&i: &u32| Bvh2Node::new(bounds[i as usize], 1, i);
    let mut current: Vec<Bvh2Node> = along_a_curve(bounds).par_iter().map(leaf).collect();
    let mut next: Vec<Bvh2Node> = Vec::with_capacity(count.div_ceil(2));
    let mut bvh = Bvh2::zeroed(count);
    bvh.primitive_indices = (0..count as u32).collect();
    let mut partners = vec![0u32; count];
    // Children come after their parents: places are given from the end.
    let (mut free, mut rounds, mut all) = (bvh.nodes.len(), 0, false);
    while current.len() > 1 {
        let partners = &mut partners[..current.len()];
        let last = current.len() as u32 - 1;
        if all {
            // The last of an odd number stays alone.
            (0..).zip(partners.iter_mut()).for_each(|(i, partner)| *partner = (i ^ 1).min(last));
        } else {
            choose(&current, if rounds < QUICK_ROUNDS { 1 } else { REACH }, partners);
        }
        next.clear();
        for (i, (node, &partner)) in current.iter().zip(&*partners).enumerate() {
            let other = partner as usize;
            if other == i || partners[other] as usize != i {
                next.push(*node);
            } else if i < other {
                free -= 2;
                bvh.nodes[free] = *node;
                bvh.nodes[free + 1] = current[other];
                let both = node.aabb().union(current[other].aabb());
                next.push(Bvh2Node::new(both, 0, free as u32));
            }
        }
        all = !all && (current.len() - next.len()) * FEW < current.len();
        std::mem::swap(&mut current, &mut next);
        rounds += 1;
    }
    bvh.nodes[0] = current[0];
    bvh.max_depth = DEFAULT_MAX_STACK_DEPTH.max(rounds + 1);
    bvh.children_are_ordered_after_parents = true;
    bvh
}

/// Moves branches to where they are hit less often, with obvhs's settings for a build of medium
/// quality; for each that is moved, the search for its place visits up to as many nodes as a ray
/// hits. Where boxes lie in each other by the thousand that is nearly all of them, and no place is
/// better than another: such a tree stays as it is.
pub(super) fn improve(bvh: &mut Bvh2) {
    /// Of a million triangles of a bumpy ball it is 58, of a full grid of 100,000 spheres 165.
    const MET: f64 = 512.0;
    /// What few boxes may come to all the same, in all.
    const VISITS: f64 = (1u32 << 28) as f64;
    let area = |node: &Bvh2Node| f64::from(node.aabb().half_area());
    let inner = bvh.nodes.iter().filter(|node| !node.is_leaf());
    let met = inner.map(area).sum::<f64>() / bvh.nodes.first().map_or(0.0, area);
    // Without an area there is no number.
    if met <= MET + VISITS / bvh.nodes.len() as f64 {
        let mut optimizer = ReinsertionOptimizer::default();
        optimizer.run(bvh, 0.05, None);
        optimizer.run(bvh, 0.1, None);
    }
}

/// Of each the partner that makes the smallest box with it, up to `reach` places away. Of equal boxes
/// it is the one whose place differs in the lowest digits alone, which is so from either side.
fn choose(nodes: &[Bvh2Node], reach: usize, partners: &mut [u32]) {
    partners.par_chunks_mut(SHARE).enumerate().for_each(|(share, partners)| {
        let start = share * SHARE;
        let end = start + partners.len();
        let mut costs = [f32::INFINITY; SHARE];
        for (i, partner) in (start..).zip(partners.iter_mut()) {
            *partner = i as u32;
        }
        let mut offer = |own: usize, other: usize, cost: f32| {
            let (least, partner) = (&mut costs[own - start], &mut partners[own - start]);
            let nearer = || (own ^ other) < (own ^ *partner as usize) || *partner as usize == own;
            if cost < *least || (cost == *least && nearer()) {
                (*least, *partner) = (cost, other as u32);
            }
        };
        for i in start.saturating_sub(reach)..end {
            let bounds = *nodes[i].aabb();
            let after = nodes[i + 1..nodes.len().min(i + 1 + reach)].iter();
            for (other, node) in (i + 1..).zip(after) {
                let cost = bounds.union(node.aabb()).half_area();
                if i >= start {
                    offer(i, other, cost);
                }
                if (start..end).contains(&other) {
                    offer(other, i, cost);
                }
            }
        }
    });
}

/// The boxes in the order of their centres along Morton's curve; those at one place of it as they
/// come.
fn along_a_curve(bounds: &[Aabb]) -> Vec<u32> {
    let whole = bounds.par_iter().copied().reduce(Aabb::empty, |a, b| a.union(&b));
    let (low, size) = (whole.min.as_dvec3(), (whole.max - whole.min).as_dvec3());
    // Along an axis without extent all are at 0.
    let scale = size.to_array().map(|x| if x > 0.0 { 1.0 / x } else { 0.0 });
    let scale = DVec3::from_array(scale);
    let place = |(i, bounds): (usize, &Aabb)| {
        let centre = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        (morton_encode_u64_unorm((centre - low) * scale), i as u32)
    };
    let mut places: Vec<(u64, u32)> = bounds.par_iter().enumerate().map(place).collect();
    places.par_sort_unstable();
    places.into_par_iter().map(|(_, i)| i).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    /// Kinds of boxes by which the builder of obvhs makes one pair a round.
    fn kinds(count: usize) -> Vec<(&'static str, Vec<Aabb>)> {
        let cube = |centre: f32, half: f32| {
            Aabb::new(Vec3A::splat(centre - half), Vec3A::splat(centre + half))
        };
        let part = |i: usize| i as f32 / count as f32;
        let all = |of: &dyn Fn(usize) -> Aabb| (0..count).map(of).collect::<Vec<_>>();
        let along = |i: usize| {
            let at = Vec3A::new(i as f32, 0.0, 0.0);
            Aabb::new(at, at + Vec3A::ONE)
        };
        vec![
            ("equal", all(&|_| cube(0.5, 1.0))),
            ("points", all(&|_| cube(0.5, 0.0))),
            ("nested", all(&|i| cube(0.0, 1.0 + part(i)))),
            ("nested from outside", all(&|i| cube(0.0, 2.0 - part(i)))),
            ("in a row", all(&along)),
            ("ever larger", all(&|i| cube(1.003f32.powi(i as i32), 1.003f32.powi(i as i32) * 0.3))),
            ("shifted", all(&|i| cube(part(i) * 1e-3, 1.0))),
        ]
    }

    /// Every leaf once, every box around its children, and the depth that the next steps count on.
    fn depth(bvh: &Bvh2, count: usize) -> usize {
        let mut seen = vec![false; count];
        let (mut open, mut deepest) = (vec![(0, 1)], 0);
        while let Some((at, depth)) = open.pop() {
            deepest = depth.max(deepest);
            let node: &Bvh2Node = &bvh.nodes[at];
            let first = node.first_index as usize;
            if node.is_leaf() {
                let id = bvh.primitive_indices[first] as usize;
                assert!(!std::mem::replace(&mut seen[id], true), "{id} twice");
                continue;
            }
            for child in [first, first + 1] {
                let inside = bvh.nodes[child].aabb();
                assert_eq!(node.aabb().union(inside), *node.aabb());
                open.push((child, depth + 1));
            }
        }
        assert!(seen.iter().all(|&s| s));
        deepest
    }

    /// What would make one pair a round makes as many rounds as the logarithm asks for: the depth
    /// tells, without a clock. A tree of one pair a round is as deep as it has leaves.
    #[test]
    fn no_boxes_make_a_deep_tree() {
        for count in [1, 2, 3, 31, 1000, 20_000] {
            for (kind, bounds) in kinds(count) {
                let mut bvh = pair_up(&bounds);
                let paired = depth(&bvh, count);
                let most = 2 + 8 * count.ilog2() as usize;
                assert!(paired <= most, "{count} {kind}: {paired} levels, at most {most}");
                assert!(paired <= bvh.max_depth, "{count} {kind}");
                improve(&mut bvh);
                depth(&bvh, count);
            }
        }
    }
}
