//! Scenes of 100,000 shapes where it is hardest to tell them apart: none takes quadratic time.
//!
//! `cargo test --release --test geometry building -- --nocapture` prints the seconds of each.

use crate::bounded::worked;
use burnish::scene::{Material, MaterialId, Mesh, Scene, SceneBuilder};
use glam::{DAffine3, DVec3};
use std::time::Instant;

const SHAPES: u32 = 100_000;
/// Seconds of one thread.
const MOST: f64 = 1.5;

/// How shapes lie to each other.
#[derive(Clone, Copy, Debug)]
enum Layout {
    /// The same shape again and again.
    Equal,
    /// Different triangles that fill the same box, and round bodies whose sizes differ by a rounding or two.
    OneBox,
    /// Each around the one before.
    Nested,
    /// 50 x 50 x 40 that touch.
    Grid,
    /// Along a line, each over its neighbours.
    Row,
    /// All through one point.
    OnePoint,
}

impl Layout {
    const ALL: [Layout; 6] = [
        Layout::Equal,
        Layout::OneBox,
        Layout::Nested,
        Layout::Grid,
        Layout::Row,
        Layout::OnePoint,
    ];

    /// Where the shape of this number is, and how large.
    fn place(self, i: u32) -> (DVec3, f64) {
        let x = f64::from(i);
        match self {
            Layout::Equal => (DVec3::ZERO, 1.0),
            Layout::OneBox => (DVec3::ZERO, 1.0 + 2.5e-7 * x),
            Layout::Nested => (DVec3::ZERO, 1.0 + 0.01 * x),
            Layout::Grid => {
                let [a, b, c] = [i % 50, i / 50 % 50, i / 2500].map(f64::from);
                (DVec3::new(a, b, c), 0.5)
            }
            Layout::Row => (DVec3::new(0.01 * x, 0.0, 0.0), 0.5),
            Layout::OnePoint => {
                let (direction, size) = (direction(i), 0.1 + fraction(i, 0.754_877_666));
                (size * direction, size)
            }
        }
    }
}

/// The i-th of a sequence that fills [0, 1) evenly.
fn fraction(i: u32, step: f64) -> f64 {
    (f64::from(i) * step).fract()
}

/// Unit vectors all around.
fn direction(i: u32) -> DVec3 {
    let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(SHAPES);
    let (sin, cos) = (std::f64::consts::TAU * fraction(i, 0.618_033_989)).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

/// A triangle that touches all six sides of its box, at a corner of which it begins.
fn corners(layout: Layout, i: u32) -> [DVec3; 3] {
    let (place, size) = layout.place(i);
    let (s, t) = (fraction(i, 0.754_877_666), fraction(i, 0.569_840_291));
    match layout {
        Layout::OneBox => [DVec3::ZERO, DVec3::ONE, DVec3::new(s, t, 0.25)],
        Layout::OnePoint => [DVec3::ZERO, direction(i), direction(SHAPES - 1 - i) + DVec3::X * s],
        _ => [DVec3::ZERO, DVec3::new(1.0, 0.3, 0.2), DVec3::new(0.3, 1.0, 0.6)]
            .map(|p| place + size * p),
    }
}

type Add = fn(&mut SceneBuilder, &[MaterialId], Layout);

/// The material of the shape of this number.
fn of(materials: &[MaterialId], i: u32) -> MaterialId {
    materials[i as usize % materials.len()]
}

fn spheres(b: &mut SceneBuilder, materials: &[MaterialId], layout: Layout) {
    for i in 0..SHAPES {
        let (centre, radius) = layout.place(i);
        b.sphere(centre, radius, of(materials, i)).unwrap();
    }
}

fn cylinders(b: &mut SceneBuilder, materials: &[MaterialId], layout: Layout) {
    for i in 0..SHAPES {
        let (base, size) = layout.place(i);
        let axis = match layout {
            Layout::OnePoint => -2.0 * base,
            _ => DVec3::new(0.3, 0.4, 1.2) * size,
        };
        b.cylinder(base, axis, 0.5 * size, of(materials, i)).unwrap();
    }
}

fn triangles(b: &mut SceneBuilder, materials: &[MaterialId], layout: Layout) {
    let mesh = Mesh {
        positions: (0..SHAPES).flat_map(|i| corners(layout, i)).collect(),
        triangles: (0..SHAPES).map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect(),
        ..Mesh::default()
    };
    b.mesh(&mesh, DAffine3::IDENTITY, of(materials, 0)).unwrap();
}

fn scene(add: Add, materials: u32, layout: Layout) -> Scene {
    let mut b = SceneBuilder::new("many");
    let material = |i| Material::reflecting(format!("m{i}"), [0.5; 3], [0.0; 3], 1.0).unwrap();
    let materials: Vec<MaterialId> = (0..materials).map(|i| b.material(material(i))).collect();
    add(&mut b, &materials, layout);
    b.build()
}

/// Seconds that this takes of the thread's processor, or of the clock where the system does not tell.
fn seconds<T>(act: impl FnOnce() -> T) -> (T, f64) {
    let (clock, before) = (Instant::now(), worked());
    let result = act();
    let own = worked().zip(before).map(|(after, before)| after.saturating_sub(before));
    (result, own.unwrap_or_else(|| clock.elapsed()).as_secs_f64())
}

#[test]
fn a_hundred_thousand_shapes_are_a_scene_in_a_second_and_a_half() {
    let kinds: [(&str, Add, u32); 4] = [
        ("spheres", spheres, 1),
        ("cylinders", cylinders, 1),
        ("triangles", triangles, 1),
        ("spheres of 50,000 materials", spheres, SHAPES / 2),
    ];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (kind, add, materials) in kinds {
        for layout in Layout::ALL {
            let case = format!("{kind}, {layout:?}");
            // Again where others had the caches: what is quadratic is slow each time.
            let mut least = f64::INFINITY;
            for _ in 0..4 {
                let (scene, took) = pool.install(|| seconds(|| scene(add, materials, layout)));
                let counts = scene.counts();
                let all = counts.spheres + counts.cylinders + counts.triangles;
                let wanted = if matches!(layout, Layout::Equal) { 1 } else { SHAPES as usize };
                assert_eq!(all, wanted, "{case}");
                least = least.min(took);
                if least < MOST {
                    break;
                }
            }
            println!("{case:40} {least:.2} s");
            assert!(least < MOST, "{case}: {least} s");
        }
    }
}
