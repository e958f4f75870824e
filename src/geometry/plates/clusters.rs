//! Plates that lie together: passed over together by rays that miss the box around them.

use crate::math::V3;
use crate::math::lanes::Packet;
use std::array::from_fn;

/// What looking at a box costs, in units of a plate.
const BOX_COST: f64 = 0.5;
/// So many rays that have nothing to do with each other are as good as a register of those that do
/// have: any of them in the box, and its plates are looked at.
const TOGETHER: i32 = 8;

/// A box and the plates in it.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    centre: V3,
    /// Half its size.
    half: V3,
    pub(super) plates: Vec<u32>,
}

/// Lowest and highest corner.
pub(super) type Bounds = [V3; 2];

/// Puts plates with these bounds together, in a scene of this surface: those for which a box saves
/// more than it costs, and the rest.
pub(super) fn gather(plates: &[(u32, Bounds)], scene: Bounds) -> (Vec<Cluster>, Vec<u32>) {
    let whole = surface(scene).max(f64::MIN_POSITIVE);
    let cost = |bounds: Bounds, count: usize| {
        let met = (surface(bounds) / whole).min(1.0);
        let any = 1.0 - (1.0 - met).powi(TOGETHER);
        BOX_COST + any * count as f64
    };
    let mut parts: Vec<(Bounds, Vec<u32>)> =
        plates.iter().map(|&(at, bounds)| (bounds, vec![at])).collect();
    let alone = |(bounds, plates): &(Bounds, Vec<u32>)| {
        cost(*bounds, plates.len()).min(plates.len() as f64)
    };
    loop {
        let mut best = (-1e-9, None);
        for i in 0..parts.len() {
            for j in i + 1..parts.len() {
                let (a, b) = (&parts[i], &parts[j]);
                let both = cost(around(a.0, b.0), a.1.len() + b.1.len());
                let change = both - alone(a) - alone(b);
                if change < best.0 {
                    best = (change, Some((i, j)));
                }
            }
        }
        let Some((i, j)) = best.1 else { break };
        let (bounds, mut others) = parts.swap_remove(j);
        parts[i].0 = around(parts[i].0, bounds);
        parts[i].1.append(&mut others);
    }
    let (mut clusters, mut rest) = (Vec::new(), Vec::new());
    for (bounds, mut plates) in parts {
        plates.sort_unstable();
        if cost(bounds, plates.len()) < plates.len() as f64 {
            let [low, high] = bounds;
            let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
            clusters.push(Cluster { centre, half, plates });
        } else {
            rest.append(&mut plates);
        }
    }
    (clusters, rest)
}

fn around([a, b]: Bounds, [c, d]: Bounds) -> Bounds {
    [a.min(c), b.max(d)]
}

fn surface([low, high]: Bounds) -> f64 {
    let size = high - low;
    let [x, y, z] = [size.x, size.y, size.z].map(|x| f64::from(x.max(0.0)));
    x * y + y * z + z * x
}

/// Rays made ready for boxes.
pub(super) struct Slabs<P> {
    inverse: [P; 3],
    /// Minus the origin times the inverse.
    shift: [P; 3],
    /// What boxes are taken to be larger by, for roundings.
    clearance: P,
}

impl<P: Packet> Slabs<P> {
    #[inline(always)]
    pub(super) fn new(o: V3<P>, d: V3<P>, clearance: P) -> Slabs<P> {
        let inverse = [d.x.recip(), d.y.recip(), d.z.recip()];
        let o = [o.x, o.y, o.z];
        let shift = from_fn(|axis| -(o[axis] * inverse[axis]));
        Slabs { inverse, shift, clearance }
    }

    /// The rays that may be in the box before `t_max`; of those that are not, none is.
    #[inline(always)]
    pub(super) fn meet(&self, cluster: &Cluster, t_max: P) -> P::Mask {
        let Cluster { centre, half, .. } = cluster;
        let (centre, half) = ([centre.x, centre.y, centre.z], [half.x, half.y, half.z]);
        let (mut near, mut far) = (P::splat(0.0), t_max);
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let middle = inverse.mul_add(P::splat(centre[axis]), self.shift[axis]);
            let reach = inverse.abs() * (P::splat(half[axis]) + self.clearance);
            // Along a plane there is no number, and no bound by it.
            near = (middle - reach).max(near);
            far = (middle + reach).min(far);
        }
        !near.gt(far)
    }
}
