//! Vertices that a file repeats, triangle by triangle, are kept once: that halves the memory of such
//! a mesh and what rays wait for.

use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Positions and normals of vertices.
pub(super) type Vertices = (Vec<DVec3>, Vec<[f32; 3]>);

/// Keeps of vertices with the same bits the first, and none that no triangle has. Meshes of which
/// most vertices are shared already stay as they are.
pub(super) fn weld((positions, normals): Vertices, triangles: &mut [[u32; 3]]) -> Vertices {
    if positions.len() <= triangles.len() {
        return (positions, normals);
    }
    let key = |i: u32| {
        let (p, n) = (positions[i as usize].to_array(), normals[i as usize]);
        let (p, n) = (p.map(f64::to_bits), n.map(|x| u64::from(x.to_bits())));
        [p[0], p[1], p[2], n[0], n[1], n[2]]
    };
    let hash = |i: u32| {
        let mix = |h: u64, x: &u64| (h ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        key(i).iter().fold(0, mix)
    };
    let count = positions.len() as u32;
    let mut order: Vec<(u64, u32)> = (0..count).into_par_iter().map(|i| (hash(i), i)).collect();
    // Equal vertices come together, the first of them first.
    order.par_sort_unstable_by(|a, b| match a.0.cmp(&b.0) {
        Ordering::Equal => (key(a.1), a.1).cmp(&(key(b.1), b.1)),
        unequal => unequal,
    });
    let mut first: Vec<u32> = (0..count).collect();
    for run in order.chunk_by(|a, b| a.0 == b.0 && key(a.1) == key(b.1)) {
        for (_, i) in run {
            first[*i as usize] = run[0].1;
        }
    }
    // Numbered as the triangles come to them.
    const UNSEEN: u32 = u32::MAX;
    let mut place = vec![UNSEEN; positions.len()];
    let mut kept: Vertices = (Vec::new(), Vec::new());
    for i in triangles.iter_mut().flatten() {
        let from = first[*i as usize] as usize;
        if place[from] == UNSEEN {
            place[from] = kept.0.len() as u32;
            kept.0.push(positions[from]);
            kept.1.push(normals[from]);
        }
        *i = place[from];
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of squares, each triangle with vertices of its own.
    fn loose(squares: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner = |x: u32, y: u32| DVec3::new(x as f64, y as f64, 0.0);
        let positions: Vec<DVec3> = (0..squares)
            .flat_map(|x| {
                let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| corner(x + i, j));
                [a, b, c, a, c, d]
            })
            .collect();
        let triangles = (0..2 * squares).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        (positions, triangles)
    }

    #[test]
    fn repeated_vertices_are_kept_once_and_corners_stay() {
        let (positions, mut triangles) = loose(50);
        let corners = |p: &[DVec3], t: &[[u32; 3]]| -> Vec<DVec3> {
            t.iter().flatten().map(|&i| p[i as usize]).collect()
        };
        let before = corners(&positions, &triangles);
        let normals = vec![[0.0; 3]; positions.len()];
        let (kept, normals) = weld((positions, normals), &mut triangles);
        assert_eq!((kept.len(), normals.len()), (102, 102));
        assert_eq!(corners(&kept, &triangles), before);
    }

    #[test]
    fn vertices_with_other_normals_stay_apart() {
        let (positions, mut triangles) = loose(1);
        let mut normals = vec![[0.0, 0.0, 1.0]; 6];
        normals[3] = [0.0, 1.0, 0.0];
        let (kept, kept_normals) = weld((positions, normals), &mut triangles);
        // Of the diagonal's two ends, one is shared.
        assert_eq!(kept.len(), 5);
        assert_eq!(kept_normals[triangles[1][0] as usize], [0.0, 1.0, 0.0]);
    }
}
