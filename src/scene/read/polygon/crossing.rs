//! Whether an outline crosses itself.

use glam::DVec2;

/// What is closer than this, in a polygon of unit size, touches.
const TOUCH: f64 = 1e-12;

/// So few edges are tested pair by pair.
const FEW: usize = 12;

/// Steps that may be taken for each corner. A polygon of two thousand corners needs no more to be
/// tested pair by pair.
const STEPS: usize = 1000;

type Edge = [DVec2; 2];

/// True when two edges of this closed outline cross, or go the same way over each other; edges and
/// corners that touch otherwise do not, so that an outline may lead to a hole and back. Ends with "no" where tens of thousands of long edges
/// lie so close that the search would take more time than their number explains.
pub(super) fn crosses(outline: &[DVec2]) -> bool {
    let next = outline.iter().skip(1).chain(outline.first());
    let edges: Vec<Edge> = outline.iter().zip(next).map(|(a, b)| [*a, *b]).collect();
    let pieces = edges.iter().enumerate().map(|(i, edge)| (i, *edge)).collect();
    let depth = 8 + 2 * edges.len().ilog2();
    let mut left = STEPS.saturating_mul(edges.len());
    found(&edges, pieces, depth, &mut left)
}

/// Halves the room that these pieces of edges are in until few are together.
fn found(edges: &[Edge], pieces: Vec<(usize, Edge)>, depth: u32, left: &mut usize) -> bool {
    if pieces.len() <= FEW || depth == 0 {
        for (i, (first, _)) in pieces.iter().enumerate() {
            *left = left.saturating_sub(i);
            let mut others = pieces[..i].iter();
            if *left == 0 || others.any(|(second, _)| cross(edges[*first], edges[*second])) {
                return *left > 0;
            }
        }
        return false;
    }
    let low = pieces.iter().flat_map(|(_, e)| e).fold(DVec2::INFINITY, |a, &b| a.min(b));
    let high = pieces.iter().flat_map(|(_, e)| e).fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
    let size = high - low;
    let across = usize::from(size.y > size.x);
    let middle = 0.5 * (low[across] + high[across]);
    let mut halves = [Vec::new(), Vec::new()];
    for (number, [a, b]) in pieces {
        let (a, b) = if a[across] <= b[across] { (a, b) } else { (b, a) };
        if b[across] < middle {
            halves[0].push((number, [a, b]));
        } else if a[across] > middle {
            halves[1].push((number, [a, b]));
        } else {
            let length = b[across] - a[across];
            let at = if length > 0.0 { (middle - a[across]) / length } else { 0.5 };
            let cut = a.lerp(b, at);
            // One that lies in the middle line belongs to both halves as a whole.
            let (end, start) = if length > 0.0 { (cut, cut) } else { (b, a) };
            halves[0].push((number, [a, end]));
            halves[1].push((number, [start, b]));
        }
    }
    let spent = halves[0].len() + halves[1].len();
    *left = left.saturating_sub(spent);
    *left > 0 && halves.into_iter().any(|half| found(edges, half, depth - 1, left))
}

/// True when each edge has the ends of the other on both sides, or both lie in one line, go the same
/// way and have more than an end in common.
fn cross([a, b]: Edge, [c, d]: Edge) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| {
        let area = (q - p).perp_dot(r - p);
        if area.abs() <= TOUCH * (q - p).length() { 0.0 } else { area }
    };
    let [of_c, of_d, of_a, of_b] = [side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)];
    if [of_c, of_d, of_a, of_b] == [0.0; 4] {
        let along = b - a;
        let (length, from, to) = (along.length(), along.dot(c - a), along.dot(d - a));
        let common = to.min(length * length) - from.max(0.0);
        return from < to && common > TOUCH * length;
    }
    of_c * of_d < 0.0 && of_a * of_b < 0.0
}
