use super::*;

/// Corners of a cube, and its faces as triangles that share them.
fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| {
        let side = |axis: u32| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(side(0), side(1), side(2))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

/// A strip of squares around the z axis, whose faces meet at `2 pi / sides`, open at both ends.
fn prism(sides: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let at = |i: u32, z: f64| {
        let a = std::f64::consts::TAU * f64::from(i) / f64::from(sides);
        DVec3::new(a.cos(), a.sin(), z)
    };
    let positions = (0..2 * sides).map(|i| at(i / 2, f64::from(i % 2))).collect();
    let n = 2 * sides;
    let side = |i: u32| {
        let [a, b, c, d] = [2 * i, (2 * i + 2) % n, (2 * i + 3) % n, 2 * i + 1];
        [[a, b, c], [a, c, d]]
    };
    (positions, (0..sides).flat_map(side).collect())
}

/// Numbers from 0 to 1, the same each time.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

type Made = (Vec<DVec3>, Vec<[u32; 3]>, Vec<[f32; 3]>);

fn made((mut positions, mut triangles): (Vec<DVec3>, Vec<[u32; 3]>), rules: &[Smooth]) -> Made {
    let before: Vec<_> = triangles.iter().flatten().map(|&i| positions[i as usize]).collect();
    let normals = make(&mut positions, &mut triangles, rules);
    let after: Vec<_> = triangles.iter().flatten().map(|&i| positions[i as usize]).collect();
    assert!(before == after && normals.len() == positions.len(), "corners stay where they were");
    (positions, triangles, normals)
}

/// The normal at each corner of each triangle, or the face's.
fn at_corners((positions, triangles, normals): &Made) -> Vec<[DVec3; 3]> {
    let corners = |t: &[u32; 3]| {
        let n = t.map(|i| DVec3::from_array(normals[i as usize].map(f64::from)));
        let face = face_normal(t.map(|i| positions[i as usize])).unwrap_or_default();
        if n.contains(&DVec3::ZERO) { [face; 3] } else { n }
    };
    triangles.iter().map(corners).collect()
}

#[test]
fn a_cube_of_shared_corners_is_flat_when_nothing_is_said_or_flat_is() {
    for rule in [Smooth::Unsaid, Smooth::Flat] {
        let (_, _, normals) = made(cube(), &[rule; 12]);
        assert!(normals.iter().all(|n| *n == [0.0; 3]), "{rule:?}");
    }
    // In one group its corners are blended from three faces.
    let of_group = made(cube(), &[Smooth::Group(7); 12]);
    assert_eq!(of_group.0.len(), 8);
    for (p, n) in of_group.0.iter().zip(&of_group.2) {
        assert!(
            DVec3::from_array(n.map(f64::from)).dot(p.normalize()) > 1.0 - 1e-6,
            "{n:?} at {p}"
        );
    }
}

/// Six sides or more with an angle below 45 degrees are round, eight are a nut.
#[test]
fn prisms_are_smooth_below_45_degrees() {
    for sides in 3..40 {
        let found = made(prism(sides), &vec![Smooth::Unsaid; 2 * sides as usize]);
        let faces = at_corners(&found);
        for (t, normals) in found.1.iter().zip(faces) {
            let p = t.map(|i| found.0[i as usize]);
            let face = face_normal(p).unwrap();
            for (p, n) in p.into_iter().zip(normals) {
                // The two triangles of a side weigh differently at its ends.
                let round = DVec3::new(p.x, p.y, 0.0);
                let (wanted, least) = if sides > 8 { (round, 0.99) } else { (face, 1.0 - 1e-9) };
                assert!(n.dot(wanted) > least, "{sides}: {n} at {p}");
            }
        }
    }
}

#[test]
fn groups_and_flat_faces_do_not_blend_with_others() {
    let sides = 24;
    let rules: Vec<Smooth> = (0..2 * sides)
        .map(|t| match t / 12 {
            0 => Smooth::Flat,
            1 => Smooth::Group(1),
            2 => Smooth::Group(2),
            _ => Smooth::Unsaid,
        })
        .collect();
    let found = made(prism(sides), &rules);
    let corners = at_corners(&found);
    let face = |t: usize| face_normal(found.1[t].map(|i| found.0[i as usize])).unwrap();
    for (t, (normals, rule)) in corners.iter().zip(&rules).enumerate() {
        let [first, last] = [t % 12 < 2, t % 12 >= 10];
        for (k, n) in normals.iter().enumerate() {
            // The lower edge goes from corner 0 to 1 of the first triangle, the upper from 2 to 1 of
            // the second.
            let at_start = (t % 2 == 0 && k == 0) || (t % 2 == 1 && (k == 0 || k == 2));
            let edge = (at_start && first) || (!at_start && last);
            let is_face = n.dot(face(t)) > 1.0 - 1e-9;
            assert_eq!(is_face, edge || *rule == Smooth::Flat, "{t} {k}");
        }
    }
}

/// Whichever way its faces go round, and in whichever order they come, a ball has the same normals up
/// to their sign, and all three of a face are on the face's own side.
#[test]
fn faces_the_wrong_way_round_change_nothing_but_the_sign() {
    let (positions, triangles) = rough_ball(5);
    let rules = vec![Smooth::Unsaid; triangles.len()];
    let plain = at_corners(&made((positions.clone(), triangles.clone()), &rules));
    for seed in 0..10 {
        let mut random = random(seed);
        let turned: Vec<[u32; 3]> = triangles
            .iter()
            .map(|&[a, b, c]| if random() < 0.5 { [a, c, b] } else { [a, b, c] })
            .collect();
        let found = at_corners(&made((positions.clone(), turned.clone()), &rules));
        for (((before, after), was), now) in plain.iter().zip(&found).zip(&triangles).zip(&turned) {
            let face = face_normal(now.map(|i| positions[i as usize])).unwrap();
            for (n, i) in after.iter().zip(now) {
                let k = was.iter().position(|j| j == i).unwrap();
                let sign = if was == now { 1.0 } else { -1.0 };
                assert!((before[k] * sign - *n).length() < 1e-6, "{seed}");
                assert!(n.dot(face) > 0.0);
            }
        }
    }
}

/// A mesh that has each face on either side is as smooth as one that has it once.
#[test]
fn faces_on_both_sides_are_as_smooth_as_on_one() {
    let (positions, mut triangles) = rough_ball(4);
    let once = at_corners(&made((positions.clone(), triangles.clone()), &[Smooth::Unsaid; 512]));
    let count = triangles.len();
    triangles.extend(triangles.clone().iter().map(|&[a, b, c]| [c, b, a]));
    let rules = vec![Smooth::Unsaid; triangles.len()];
    let twice = at_corners(&made((positions, triangles), &rules));
    for (a, [b, c]) in
        once.iter().zip(twice.iter().take(count).zip(&twice[count..]).map(|(b, c)| [b, c]))
    {
        for k in 0..3 {
            assert!((a[k] - b[k]).length() < 1e-6 && (a[k] + c[2 - k]).length() < 1e-6);
        }
    }
}

/// The naive way to the same normals: for each corner, the faces that can be reached from its own
/// over edges at the vertex that are smooth.
#[test]
fn fans_are_those_that_a_walk_finds() {
    for seed in 0..40 {
        let mut random = random(seed);
        let (mut positions, triangles) = rough_ball(3);
        // From nearly smooth to thorny.
        let size = 0.9 * random();
        positions.iter_mut().for_each(|p| *p *= 1.0 - size * random());
        let rules: Vec<Smooth> = triangles
            .iter()
            .map(|_| match (random() * 8.0) as u32 {
                0 => Smooth::Flat,
                1 | 2 => Smooth::Group(1),
                _ => Smooth::Unsaid,
            })
            .collect();
        let face = |t: usize| face_normal(triangles[t].map(|i| positions[i as usize])).unwrap();
        let found = at_corners(&made((positions.clone(), triangles.clone()), &rules));
        let smooth = |s: usize, t: usize| match (rules[s], rules[t]) {
            (Smooth::Unsaid, Smooth::Unsaid) => {
                let shared = triangles[s].iter().filter(|i| triangles[t].contains(i)).count();
                shared == 2 && face(s).dot(face(t)) > LEAST_COSINE
            }
            (a, b) => a == b && a != Smooth::Flat,
        };
        for (t, triangle) in triangles.iter().enumerate() {
            for (k, v) in triangle.iter().enumerate() {
                let here: Vec<usize> =
                    (0..triangles.len()).filter(|&s| triangles[s].contains(v)).collect();
                let mut fan = vec![t];
                while let Some(more) =
                    here.iter().find(|&&s| !fan.contains(&s) && fan.iter().any(|&f| smooth(f, s)))
                {
                    fan.push(*more);
                }
                let mut sum = DVec3::ZERO;
                for &s in &fan {
                    let at = triangles[s].iter().position(|i| i == v).unwrap();
                    let p = triangles[s].map(|i| positions[i as usize]);
                    let angle = (p[(at + 1) % 3] - p[at]).angle_between(p[(at + 2) % 3] - p[at]);
                    sum += face(s) * angle;
                }
                let off = (found[t][k] - sum.normalize()).length();
                assert!(off < 1e-6, "{seed}: {t} {k}: {off}");
            }
        }
    }
}

/// An octahedron whose faces are cut into `2^levels` parts an edge, blown up.
fn rough_ball(levels: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut positions: Vec<DVec3> =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|p| [p, -p]).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for i in 0..8u32 {
        let [a, b, c] = [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1)];
        triangles.push(if i.count_ones() % 2 == 0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 1..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32, positions: &mut Vec<DVec3>| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(i, j)| middle(i, j, &mut positions));
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    (positions, triangles)
}

/// A hundred thousand faces on one edge, and as many around one vertex.
#[test]
fn many_faces_in_one_place_take_no_time() {
    let at = |i: u32| {
        let a = f64::from(i) * 6e-5;
        DVec3::new(a.cos(), a.sin(), 0.3 * (9.0 * a).sin())
    };
    let mut positions = vec![DVec3::ZERO, DVec3::Z];
    positions.extend((0..100_001).map(at));
    for first in [[0, 1], [0, 0]] {
        let fan = |i: u32| if first[1] == 1 { [0, 1, i] } else { [0, i, i + 1] };
        let triangles: Vec<[u32; 3]> = (2..100_002).map(fan).collect();
        let rules = vec![Smooth::Unsaid; triangles.len()];
        let (_, _, normals) = made((positions.clone(), triangles), &rules);
        assert_eq!(normals.iter().all(|n| *n == [0.0; 3]), first[1] == 1);
    }
}
