//! Many lights: a binary tree by which one is chosen in as many steps as it is deep (Conty Estevez
//! and Kulla, "Importance sampling of many lights with adaptive tree splitting", 2018).
//!
//! At each node the two sides are taken in proportion to what may come from them, and what is left
//! of the random number goes on to the next. Boxes, cones of normals and powers are as in the paper;
//! a light emits on both sides, so that cones join whichever way round is nearer.

use super::importance::{LightBounds, LightSampleContext};
use super::{ALMOST_ONE, LightChoice};
use crate::math::V3;
use crate::math::gather_table::GatherTable;
use crate::math::record::{RecordField, gather_record};
use crate::math::simd::{Bits, MAX_WIDTH, Mask, SimdWide, U32};
use std::f32::consts::{FRAC_PI_2, PI};

/// A link with this bit names a light.
pub(super) const LEAF: u32 = 1 << 31;
/// The least share of a side that may give any light at all: what is in between is not known.
const LEAST: f32 = 1.0 / 256.0;
/// Planes tried along each axis.
const BINS: usize = 12;
/// Below this depth lights are halved by number, so that no path is longer than 64 steps.
const CAREFUL: u32 = 32;

gather_record! {
    /// A node of the tree.
    struct LightNode {
        sides: [LightBounds; 2],
        /// The nodes below by their place, or lights with the bit [`LEAF`].
        links: [u32; 2],
    }
}

/// Bytes of a node.
pub(super) const NODE_BYTES: usize = size_of::<[f32; LightNode::NUMBERS]>();

/// Lights below their nodes.
#[derive(Debug)]
pub(super) struct LightBvh {
    nodes: GatherTable<LightNode, { LightNode::NUMBERS }>,
    /// For each light the branch that it is on, and the way from there: bit k says that step k goes
    /// to the second side.
    ways: Vec<(u32, u64)>,
}

/// A part of the tree: one light or many.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub(super) bound: LightBounds,
    pub(super) link: u32,
    depth: u32,
}

impl Branch {
    /// How much may go wrong where it is taken for one light; nothing if it is one.
    fn error(&self) -> f32 {
        let b = &self.bound;
        if self.link >= LEAF { -1.0 } else { b.luminance * b.area * b.radius * b.radius }
    }
}

impl LightBvh {
    /// The tree over some lights, at least two, with the branches at which to enter it, at most
    /// `most`.
    pub(super) fn new(bounds: &[LightBounds], most: usize) -> (LightBvh, Vec<Branch>) {
        let mut order: Vec<u32> = (0..bounds.len() as u32).collect();
        let ways = vec![(0, 0); bounds.len()];
        let mut builder = Builder { bounds, nodes: Vec::with_capacity(bounds.len()), ways };
        let (bound, link) = builder.build(&mut order, 0, 0);
        let Builder { nodes, mut ways, .. } = builder;
        let mut branches = vec![Branch { bound, link, depth: 0 }];
        while branches.len() < most {
            let errors = branches.iter().map(Branch::error).enumerate();
            let Some((i, _)) = errors.filter(|e| e.1 >= 0.0).max_by(|a, b| a.1.total_cmp(&b.1))
            else {
                break;
            };
            let Branch { link, depth, .. } = branches[i];
            let node = &nodes[link as usize];
            let side = |side: usize| Branch {
                bound: node.sides[side],
                link: node.links[side].0,
                depth: depth + 1,
            };
            branches[i] = side(0);
            branches.push(side(1));
        }
        for (i, branch) in (0..).zip(&branches) {
            let mut open = vec![branch.link];
            while let Some(link) = open.pop() {
                if link >= LEAF {
                    let (on, ray) = &mut ways[(link & !LEAF) as usize];
                    (*on, *ray) = (i, *ray >> branch.depth);
                } else {
                    open.extend(nodes[link as usize].links.map(|link| link.0));
                }
            }
        }
        (LightBvh { nodes: GatherTable::new(nodes), ways }, branches)
    }

    /// The branches that lights are on.
    #[inline(always)]
    pub(super) fn branches_of<P: SimdWide>(&self, lights: P::Bits) -> P::Bits {
        P::load_bits(&self.ways_to::<P>(lights).map(|(branch, _)| branch))
    }

    /// The ways to lights, by lane.
    #[inline(always)]
    fn ways_to<P: SimdWide>(&self, lights: P::Bits) -> [(u32, u64); MAX_WIDTH] {
        let mut which = [0; MAX_WIDTH];
        P::store_bits(lights, &mut which);
        which.map(|light| self.ways[light as usize])
    }

    /// The light that a choice among the branches leads to, their links being in `index`.
    #[inline(always)]
    pub(super) fn choose<P: SimdWide>(
        &self,
        to: &LightSampleContext<P>,
        mut choice: LightChoice<P>,
    ) -> LightChoice<P> {
        let (zero, one) = (P::splat(0.0), P::splat(1.0));
        let leaf = P::Bits::splat(LEAF);
        let mut link = choice.index;
        let mut on_the_way = P::less_bits(link, leaf);
        while on_the_way.any() {
            let node = self.nodes.get_some::<P>(link, on_the_way.bits());
            let (share, any) = first_share(&node, to);
            let first = choice.rest.lt(share);
            let roughness = P::select(first, share, one - share);
            let within = P::select(first, choice.rest, choice.rest - share) / roughness;
            let rest = within.max(zero).min(P::splat(ALMOST_ONE));
            choice.rest = P::select(on_the_way, rest, choice.rest);
            let probability = (choice.probability * roughness).or_zero(any);
            choice.probability = P::select(on_the_way, probability, choice.probability);
            let [a, b] = node.links;
            link = P::select_bits(on_the_way, P::select_bits(first, a, b), link);
            on_the_way = P::less_bits(link, leaf);
        }
        choice.index = link & P::Bits::splat(!LEAF);
        choice
    }

    /// The probabilities with which [`LightBvh::choose`] takes lights of the branches with these links.
    #[inline(always)]
    pub(super) fn probability<P: SimdWide>(
        &self,
        to: &LightSampleContext<P>,
        mut link: P::Bits,
        lights: P::Bits,
    ) -> P {
        let (one, leaf) = (P::splat(1.0), P::Bits::splat(LEAF));
        let mut ways = self.ways_to::<P>(lights);
        let mut probability = one;
        let mut on_the_way = P::less_bits(link, leaf);
        while on_the_way.any() {
            let node = self.nodes.get_some::<P>(link, on_the_way.bits());
            let (share, any) = first_share(&node, to);
            let mut second = 0;
            for (lane, (_, way)) in ways.iter_mut().enumerate() {
                second |= ((*way & 1) as u32) << lane;
                *way >>= 1;
            }
            let second = P::mask(second);
            let step = P::select(second, one - share, share).or_zero(any);
            probability = P::select(on_the_way, probability * step, probability);
            let [a, b] = node.links;
            link = P::select_bits(on_the_way, P::select_bits(second, b, a), link);
            on_the_way = P::less_bits(link, leaf);
        }
        probability
    }
}

/// The share of a node's first side, and whether there is anything to share.
#[inline(always)]
fn first_share<P: SimdWide>(node: &LightNode<P>, to: &LightSampleContext<P>) -> (P, P::Mask) {
    let zero = P::splat(0.0);
    let (a, b) = (node.sides[0].estimate(to), node.sides[1].estimate(to));
    let sum = a + b;
    let kept = (a / sum).max(P::splat(LEAST)).min(P::splat(1.0 - LEAST));
    let share = P::select(a.gt(zero), kept, zero);
    (P::select(b.gt(zero), share, P::splat(1.0)), sum.gt(zero))
}

struct Builder<'a> {
    bounds: &'a [LightBounds],
    nodes: Vec<LightNode>,
    ways: Vec<(u32, u64)>,
}

impl Builder<'_> {
    /// The tree of some lights, at most 2^31, with its bound.
    fn build(&mut self, lights: &mut [u32], depth: u32, ray: u64) -> (LightBounds, u32) {
        if let [light] = *lights {
            self.ways[light as usize].1 = ray;
            return (self.bounds[light as usize], LEAF | light);
        }
        let middle = self.split(lights, depth);
        let (first, second) = lights.split_at_mut(middle);
        let at = self.nodes.len();
        // Nodes stand before those below them.
        self.nodes.push(LightNode { sides: [self.bounds[0]; 2], links: [U32(LEAF); 2] });
        let (a, first) = self.build(first, depth + 1, ray);
        let (b, second) = self.build(second, depth + 1, ray | 1 << depth);
        self.nodes[at] = LightNode { sides: [a, b], links: [U32(first), U32(second)] };
        let mut cluster = LightCluster::of(&a);
        cluster.add(&LightCluster::of(&b));
        (cluster.bound(), at as u32)
    }

    /// Orders the lights so that those before the place returned and those from it on make two good
    /// nodes. Both parts have some.
    fn split(&self, lights: &mut [u32], depth: u32) -> usize {
        let half = lights.len() / 2;
        let centre =
            |light: u32, axis: usize| <[f32; 3]>::from(self.bounds[light as usize].centre)[axis];
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for &light in lights.iter() {
            for axis in 0..3 {
                let x = centre(light, axis);
                (low[axis], high[axis]) = (low[axis].min(x), high[axis].max(x));
            }
        }
        let widths = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        if depth >= CAREFUL {
            let axis = (0..3).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).unwrap_or(0);
            lights.select_nth_unstable_by(half, |&a, &b| {
                centre(a, axis).total_cmp(&centre(b, axis)).then(a.cmp(&b))
            });
            return half;
        }
        let bin = |light: u32, axis: usize| {
            let at = (centre(light, axis) - low[axis]) / widths[axis] * BINS as f32;
            (at as usize).min(BINS - 1)
        };
        let mut best = (f32::INFINITY, 0, 0);
        for axis in (0..3).filter(|&axis| widths[axis] > 0.0) {
            let mut bins: [Option<LightCluster>; BINS] = [None; BINS];
            for &light in lights.iter() {
                let own = LightCluster::of(&self.bounds[light as usize]);
                join(&mut bins[bin(light, axis)], &Some(own));
            }
            let mut after = [0.0; BINS];
            let mut sum = None;
            for i in (1..BINS).rev() {
                join(&mut sum, &bins[i]);
                after[i] = cost(&sum);
            }
            let mut sum = None;
            for i in 1..BINS {
                join(&mut sum, &bins[i - 1]);
                let both = (cost(&sum) + after[i]) / widths[axis];
                if both < best.0 {
                    best = (both, axis, i);
                }
            }
        }
        let (_, axis, plane) = best;
        if plane == 0 {
            return half;
        }
        // In place, the order within the parts without meaning.
        let mut middle = 0;
        for i in 0..lights.len() {
            if bin(lights[i], axis) < plane {
                lights.swap(i, middle);
                middle += 1;
            }
        }
        if middle == 0 || middle == lights.len() { half } else { middle }
    }
}

/// Some lights together.
#[derive(Clone, Copy, Debug)]
struct LightCluster {
    low: V3,
    high: V3,
    axis: V3,
    /// Half angle of the cone of normals.
    angle: f32,
    area: f32,
    power: f32,
    /// Around the box's centre, of a single light; 0 for more.
    radius: f32,
    slack: f32,
}

impl LightCluster {
    fn of(b: &LightBounds) -> LightCluster {
        LightCluster {
            low: b.centre - b.half,
            high: b.centre + b.half,
            axis: b.axis,
            angle: b.sin.atan2(b.cos),
            area: b.area,
            power: b.luminance * b.area,
            radius: b.radius,
            slack: b.slack,
        }
    }

    fn add(&mut self, other: &LightCluster) {
        let each =
            |a: V3, b: V3, f: fn(f32, f32) -> f32| V3::new(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
        self.low = each(self.low, other.low, f32::min);
        self.high = each(self.high, other.high, f32::max);
        (self.axis, self.angle) = joint_cone((self.axis, self.angle), (other.axis, other.angle));
        self.area += other.area;
        self.power += other.power;
        self.radius = 0.5 * (self.high - self.low).length() * (1.0 + f32::EPSILON);
        self.slack = self.radius;
    }

    fn bound(&self) -> LightBounds {
        let (sin, cos) = self.angle.sin_cos();
        let all = self.angle >= FRAC_PI_2;
        LightBounds {
            centre: (self.low + self.high) * 0.5,
            half: (self.high - self.low) * 0.5,
            radius: self.radius,
            axis: self.axis,
            cos: if all { 0.0 } else { cos },
            sin: if all { 1.0 } else { sin },
            slack: self.slack,
            area: self.area,
            luminance: self.power / self.area,
        }
    }
}

/// The narrowest cone about two, either of which may be turned round. A right angle is everything.
fn joint_cone((a, wide): (V3, f32), (b, other): (V3, f32)) -> (V3, f32) {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let (a, wide, b, narrow) = if wide < other { (b, other, a, wide) } else { (a, wide, b, other) };
    let apart = (a - b).length().atan2((a + b).length()) * 2.0;
    if apart + narrow <= wide {
        return (a, wide.min(FRAC_PI_2));
    }
    let angle = 0.5 * (wide + apart + narrow);
    let across = b - a * a.dot(b);
    if angle >= FRAC_PI_2 || across.length2() < 1e-12 {
        return (a, FRAC_PI_2.min(wide + apart + narrow));
    }
    // From the wider one's axis towards the other's.
    let (sin, cos) = (angle - wide).sin_cos();
    ((a * cos + across.normalize() * sin).normalize(), angle)
}

fn join(sum: &mut Option<LightCluster>, other: &Option<LightCluster>) {
    match (sum.as_mut(), other) {
        (Some(sum), Some(other)) => sum.add(other),
        (None, Some(_)) => *sum = *other,
        (_, None) => {}
    }
}

/// Power times the measures of extent and of directions.
fn cost(cluster: &Option<LightCluster>) -> f32 {
    let Some(c) = cluster else { return 0.0 };
    let size = c.high - c.low;
    let aabb = size.x * size.y + size.y * size.z + size.z * size.x;
    let (t, widest) = (c.angle, (c.angle + FRAC_PI_2).min(PI));
    let directions = 2.0 * PI * (1.0 - t.cos())
        + FRAC_PI_2
            * (2.0 * widest * t.sin() - (t - 2.0 * widest).cos() - 2.0 * t * t.sin() + t.cos());
    c.power * (aabb + 1e-6) * directions
}
