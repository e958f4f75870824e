use super::*;

fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
    points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect()
}

/// The same polygon from another first corner.
fn from_corner(corners: &[DVec3], first: usize) -> Vec<DVec3> {
    let mut corners = corners.to_vec();
    corners.rotate_left(first);
    corners
}

fn area_and_normal(corners: &[DVec3], triangles: &Triangles) -> (f64, DVec3) {
    let mut sum = DVec3::ZERO;
    let mut area = 0.0;
    for t in &triangles.indices {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        let n = 0.5 * (b - a).cross(c - a);
        sum += n;
        area += n.length();
    }
    (area, sum)
}

/// Area of a simple polygon, from every first corner, both ways round, turned and scaled.
fn check(points: &[[f64; 2]], area: f64) {
    let turned = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
    for (scale, offset) in [(1.0, 0.0), (1e-200, 0.0), (1e200, 0.0), (3.0, 1e4)] {
        for first in 0..points.len() {
            let mut corners: Vec<DVec3> = from_corner(&flat(points), first)
                .iter()
                .map(|&p| turned * p * scale + DVec3::splat(offset))
                .collect();
            for sign in [1.0, -1.0] {
                let cut = triangulate(&corners);
                assert!(!cut.self_crossing, "{points:?} from {first} at {scale}");
                let unit: Vec<DVec3> = corners.iter().map(|&p| p / scale).collect();
                let (found, normal) = area_and_normal(&unit, &cut);
                assert!((found - area).abs() < 1e-9 * area, "{points:?} from {first}: {found}");
                let along = normal.dot(turned * DVec3::Z);
                assert!((along - sign * area).abs() < 1e-9 * area, "{along}");
                corners.reverse();
            }
        }
    }
}

const L: [[f64; 2]; 6] = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];

#[test]
fn concave_polygons_have_their_area_from_every_first_corner() {
    check(&L, 3.0);
    // A dart, an arrow, a U, a plus, a comb.
    check(&[[0., 0.], [2., 2.], [0., 1.], [-2., 2.]], 2.0);
    check(&[[0., 0.], [4., 0.], [4., 3.], [3., 3.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]], 8.0);
    let plus = [[1., 0.], [2., 0.], [2., 1.], [3., 1.], [3., 2.], [2., 2.]];
    let rest = [[2., 3.], [1., 3.], [1., 2.], [0., 2.], [0., 1.], [1., 1.]];
    check(&[plus, rest].concat(), 5.0);
    let mut comb = vec![[0.0, 0.0], [40.0, 0.0]];
    for tooth in (0..20).rev() {
        let x = 2.0 * f64::from(tooth);
        comb.extend([[x + 1.0, 9.0], [x + 1.0, 1.0], [x, 1.0]]);
    }
    let area: f64 = comb
        .iter()
        .zip(comb.iter().cycle().skip(1))
        .map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0]))
        .sum();
    check(&comb, area);
}

#[test]
fn convex_polygons_keep_the_fan_around_their_first_corner() {
    for n in 3..200 {
        let corner = |i: usize| DVec2::from_angle(i as f64 / n as f64 * TAU).to_array();
        let corners = flat(&(0..n).map(corner).collect::<Vec<_>>());
        assert_eq!(triangulate(&corners).indices, fan(n, 0));
    }
}

/// Corners on a straight edge belong to triangles with area: their neighbours' corners are there.
#[test]
fn corners_on_straight_edges_stay() {
    let square = [[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]];
    check(&square, 4.0);
    for first in 0..square.len() {
        let corners = from_corner(&flat(&square), first);
        let cut = triangulate(&corners);
        assert_eq!(cut.indices.len(), 6);
        for t in &cut.indices {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            assert!((b - a).cross(c - a).z > 0.1, "{t:?}");
        }
    }
    check(&[[0., 0.], [1., 0.], [3., 0.], [0., 3.]], 4.5);
    // Corners twice in one place.
    check(&[[0., 0.], [3., 0.], [3., 0.], [0., 3.]], 4.5);
    check(&[L.as_slice(), &[[0., 2.], [0., 1.]]].concat(), 3.0);
}

/// Outlines of random regions of squares, with a corner at every unit: their area, and no corner of
/// a straight edge left out.
#[test]
fn random_outlines_keep_all_their_corners() {
    let mut state = 7u64;
    let mut below = |n: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    const SIDE: usize = 14;
    for _ in 0..300 {
        let mut full = [[false; SIDE]; SIDE];
        full[SIDE / 2][SIDE / 2] = true;
        let mut cells = 1;
        let wanted = 2 + below(70);
        for _ in 0..20_000 {
            if cells == wanted {
                break;
            }
            let (x, y) = (1 + below(SIDE - 2), 1 + below(SIDE - 2));
            // The eight neighbours in order: one run of full ones that has a side in common keeps
            // the region in one piece, without holes, and touching itself nowhere.
            let ring = [(2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0), (1, 0), (2, 0)];
            let near = ring.map(|(i, j): (usize, usize)| full[x + i - 1][y + j - 1]);
            let runs = (0..8).filter(|&i| near[i] && !near[(i + 1) % 8]).count();
            if !full[x][y] && runs == 1 && [0, 2, 4, 6].iter().any(|&i| near[i]) {
                full[x][y] = true;
                cells += 1;
            }
        }
        // Edges with the region on their left, each from its start.
        let mut next = std::collections::HashMap::new();
        for x in 1..SIDE - 1 {
            for y in 1..SIDE - 1 {
                let sides = [
                    (full[x][y - 1], (x, y), (x + 1, y)),
                    (full[x + 1][y], (x + 1, y), (x + 1, y + 1)),
                    (full[x][y + 1], (x + 1, y + 1), (x, y + 1)),
                    (full[x - 1][y], (x, y + 1), (x, y)),
                ];
                for (outside, from, to) in sides {
                    if full[x][y] && !outside {
                        assert!(next.insert(from, to).is_none());
                    }
                }
            }
        }
        let start = *next.keys().min().unwrap();
        let mut points = vec![start];
        while next[points.last().unwrap()] != start {
            points.push(next[points.last().unwrap()]);
        }
        assert_eq!(points.len(), next.len());
        let first = below(points.len());
        points.rotate_left(first);
        let corners: Vec<DVec3> =
            points.iter().map(|&(x, y)| DVec3::new(x as f64, 0.0, y as f64)).collect();
        let cut = triangulate(&corners);
        let (area, _) = area_and_normal(&corners, &cut);
        assert!(!cut.self_crossing && (area - cells as f64).abs() < 1e-9, "{points:?}: {area}");
        assert_eq!(cut.indices.len(), corners.len() - 2, "{points:?}");
    }
}

/// An outline that leads to a hole and back touches itself and does not cross.
#[test]
fn a_hole_with_a_bridge_stays_open() {
    let outer = [[0., 0.], [4., 0.], [4., 4.], [0., 4.], [0., 0.]];
    let hole = [[1., 1.], [1., 3.], [3., 3.], [3., 1.], [1., 1.]];
    check(&[outer.as_slice(), &hole].concat(), 12.0);
}

#[test]
fn polygons_that_are_not_plane_are_cut_by_their_mean_plane() {
    for first in 0..6 {
        let mut corners = flat(&L);
        for (i, corner) in corners.iter_mut().enumerate() {
            corner.z = 0.1 * ((i * 7 % 5) as f64 - 2.0);
        }
        let corners = from_corner(&corners, first);
        let cut = triangulate(&corners);
        assert!(!cut.self_crossing);
        let seen: Vec<DVec3> = corners.iter().map(|p| p.with_z(0.0)).collect();
        let (area, normal) = area_and_normal(&seen, &cut);
        assert!((area - 3.0).abs() < 1e-12 && (normal.z - 3.0).abs() < 1e-12, "{first}: {area}");
    }
}

#[test]
fn outlines_that_cross_themselves_are_told() {
    let star: Vec<[f64; 2]> =
        (0..5).map(|i| DVec2::from_angle(f64::from(2 * i) / 5.0 * TAU).to_array()).collect();
    let round: Vec<[f64; 2]> =
        (0..1000).map(|i| DVec2::from_angle(f64::from(3 * i) / 1000.0 * TAU).to_array()).collect();
    for points in [
        // Bow ties, of equal halves and not.
        vec![[0., 0.], [1., 1.], [1., 0.], [0., 1.]],
        vec![[0., 0.], [2., 2.], [2., 0.], [0., 1.]],
        // An eight through one corner.
        vec![[0., 0.], [1., 1.], [2., 2.], [3., 1.], [1., 1.], [0., 2.]],
        star,
        round,
    ] {
        for first in 0..points.len().min(8) {
            let corners = from_corner(&flat(&points), first);
            let cut = triangulate(&corners);
            assert!(cut.self_crossing, "{points:?} from {first}");
            assert!(!cut.indices.is_empty());
        }
    }
}

#[test]
fn hopeless_corners_give_a_fan() {
    for corners in [
        vec![DVec3::ZERO; 6],
        vec![DVec3::NAN; 6],
        vec![DVec3::ZERO, DVec3::X, DVec3::INFINITY, DVec3::Y],
        vec![DVec3::splat(-1e308), DVec3::splat(1e308), DVec3::X, DVec3::Y * 1e308],
        (0..9).map(|i| DVec3::X * f64::from(i)).collect(),
    ] {
        let cut = triangulate(&corners);
        assert_eq!(cut.indices, fan(corners.len(), 0), "{corners:?}");
    }
    for count in 0..3 {
        assert!(triangulate(&vec![DVec3::ZERO; count]).indices.is_empty());
    }
}

/// Thousands of corners take a moment, whether the outline is a gear, spikes, a comb or crosses
/// itself everywhere.
#[test]
fn many_corners_take_no_quadratic_time() {
    const N: usize = 20_000;
    let at = |i: usize, r: f64| DVec2::from_angle(i as f64 / N as f64 * TAU) * r;
    let gear: Vec<[f64; 2]> = (0..N).map(|i| at(i, [1.0, 0.5][i % 2]).to_array()).collect();
    let spikes: Vec<[f64; 2]> = (0..N).map(|i| at(i, [1.0, 1e-3][i % 2]).to_array()).collect();
    let comb: Vec<[f64; 2]> = (0..N)
        .map(|i| [i as f64, if i == 0 || i == N - 1 { -1.0 } else { 9.0 * (i % 2) as f64 }])
        .collect();
    // A square with slits, to each of which the outline leads there and back.
    let slits: Vec<[f64; 2]> = (0..N / 3)
        .flat_map(|i| {
            let x = (i + 1) as f64 / (N / 3 + 1) as f64;
            [[x, 0.0], [x, 0.9], [x, 0.0]]
        })
        .chain([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
        .collect();
    for (name, points) in [("gear", gear), ("spikes", spikes), ("comb", comb), ("slits", slits)] {
        let corners = flat(&points);
        let cut = triangulate(&corners);
        assert!(!cut.self_crossing, "{name}");
        let area: f64 = points
            .iter()
            .zip(points.iter().cycle().skip(1))
            .map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0]))
            .sum();
        let (found, _) = area_and_normal(&corners, &cut);
        assert!((found - area.abs()).abs() < 1e-9 * area.abs(), "{found} {area}");
    }
    let mut state = 1u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64
    };
    let tangle: Vec<[f64; 2]> = (0..N).map(|_| [number(), number()]).collect();
    let few: Vec<[f64; 2]> = tangle.iter().map(|p| p.map(|x| x % 3.0)).collect();
    let round_and_round: Vec<[f64; 2]> = (0..N).map(|i| L[i % 6]).collect();
    let there: Vec<[f64; 2]> = (0..N / 2).map(|i| [i as f64, 5.0 * (i % 2) as f64]).collect();
    let back: Vec<[f64; 2]> = there[1..N / 2 - 1].iter().rev().copied().collect();
    for points in [tangle, few, round_and_round, [there, back].concat()] {
        assert!(triangulate(&flat(&points)).self_crossing);
    }
}
