//! Shapes that lie together: passed over together by rays that miss the box around them.

use crate::geometry::aabb::Aabb;
use crate::math::V3;

/// What looking at a box costs, in units of a shape.
const BOX_COST: f64 = 0.5;
/// Number of unrelated rays that a register of related ones is equal to: any of them in the box, and its shapes are looked at.
const TOGETHER: i32 = 8;

/// A box and the shapes in it, by number.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    pub(super) aabb: Aabb,
    pub(super) members: Vec<u32>,
}

/// Lowest and highest corner.
pub(super) type Bounds = [V3; 2];

/// Puts shapes with these numbers and bounds together, in a scene with these: those for which a box
/// saves more than it costs, and the rest.
pub(super) fn gather(shapes: &[(u32, Bounds)], scene: Bounds) -> (Vec<Cluster>, Vec<u32>) {
    let whole = surface(scene).max(f64::MIN_POSITIVE);
    let cost = |bounds: Bounds, count: usize| {
        if count == 1 {
            return 1.0;
        }
        let met = (surface(bounds) / whole).min(1.0);
        let any = 1.0 - (1.0 - met).powi(TOGETHER);
        BOX_COST + any * count as f64
    };
    let mut parts: Vec<(Bounds, Vec<u32>)> =
        shapes.iter().map(|&(at, bounds)| (bounds, vec![at])).collect();
    let alone = |(bounds, members): &(Bounds, Vec<u32>)| {
        cost(*bounds, members.len()).min(members.len() as f64)
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
    for (bounds, mut members) in parts {
        members.sort_unstable();
        if cost(bounds, members.len()) < members.len() as f64 {
            clusters.push(Cluster { aabb: Aabb::from_corners(bounds), members });
        } else {
            rest.append(&mut members);
        }
    }
    (clusters, rest)
}

pub(super) fn around([a, b]: Bounds, [c, d]: Bounds) -> Bounds {
    [a.min(c), b.max(d)]
}

/// Half the surface of a box.
pub(super) fn surface([low, high]: Bounds) -> f64 {
    let size = high - low;
    let [x, y, z] = [size.x, size.y, size.z].map(|x| f64::from(x.max(0.0)));
    x * y + y * z + z * x
}
