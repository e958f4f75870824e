//! How the time of a path grows with triangles, lights, pixels and threads, in scenes made for it.
//!
//! A ball with hills stands in a closed room under emitters, all diffuse, so that every path goes on
//! and meets the ball now and then. Seconds are those of tracing alone.

use super::speed::{Fit, Spread};
use crate::geometry::Bvh;
use crate::progressive::{Params, ParamsError, render};
use crate::scene::{Camera, Material, MaterialError, Mesh, Scene, SceneBuilder, ShapeError};
use crate::trace::ReuseGroup;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Instant;
use thiserror::Error;

/// What is to be measured.
#[derive(Clone, Copy, Debug)]
pub struct Scaling {
    /// Most triangles, at least 1000. Lights go up to a thousandth, pixels to a fifth of it.
    pub largest: u32,
    /// How often each is measured; every repeat measures all sizes before the next begins.
    pub repeats: u32,
    /// Of the first repeat; the others have the next ones.
    pub seed: u64,
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// What one size cost.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Triangles, lights, pixels or threads.
    pub n: usize,
    /// Nanoseconds for each path, all workers together.
    pub path: Spread,
    /// What the scene cost before.
    pub scene: SceneCost,
}

/// What it costs to hold a scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneCost {
    /// Triangles in it, those of emitters and walls too.
    pub triangles: usize,
    /// Seconds from shapes in memory to a scene that can be rendered.
    pub build: f64,
    /// Seconds of that for the tree.
    pub tree: f64,
    /// Of geometry and tree, for each triangle.
    pub bytes: f64,
}

impl Row {
    /// The time over what a law proportional to the logarithm of n would give that has the first
    /// row's: at most 1 where time grows at most with the logarithm.
    pub fn over_logarithm(&self, first: &Row) -> f64 {
        (self.path.median / first.path.median) / (self.n as f64).log(first.n as f64)
    }
}

/// How a time grows.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// The power of n that fits best: slope of ln t over ln n.
    pub exponent: Option<Fit>,
    /// Nanoseconds more for each doubling of n: slope of t over log2 n.
    pub doubling: Option<Fit>,
}

impl Growth {
    /// Of the medians of these rows.
    pub fn of(rows: &[Row]) -> Growth {
        let fit = |x: fn(f64) -> f64, y: fn(f64) -> f64| {
            Fit::line(rows.iter().map(|row| [x(row.n as f64), y(row.path.median)]))
        };
        Growth { exponent: fit(f64::ln, f64::ln), doubling: fit(f64::log2, |t| t) }
    }
}

/// Why nothing was measured.
#[derive(Debug, Error)]
pub enum ScalingError {
    /// A render failed.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// A shape was refused.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A material was refused.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

/// Pixels of the pictures, but where pixels are what grows.
const SIZE: [u32; 2] = [256, 192];
/// Triangles of the ball, but where triangles are what grows.
const TRIANGLES: u32 = 10_000;
/// A measurement lasts about so long, in seconds, or is one pass.
const LONG: f64 = 0.25;
/// Most passes of one measurement.
const PASSES: u64 = 64;

impl Scaling {
    /// Against the number of triangles: decades from 1000 on.
    pub fn triangles(&self) -> Result<Vec<Row>, ScalingError> {
        let sizes = decades(1000, self.largest);
        let scenes = sizes.iter().map(|&n| build(n, 1)).collect::<Result<Vec<_>, _>>()?;
        let jobs = scenes.iter().map(|(scene, cost)| Job::new(cost.triangles, scene, *cost));
        self.measure(jobs.collect())
    }

    /// Against the number of lights: decades from 1 on.
    pub fn lights(&self) -> Result<Vec<Row>, ScalingError> {
        let sizes = decades(1, self.largest / 1000);
        let ball = TRIANGLES.min(self.largest);
        let scenes = sizes.iter().map(|&n| build(ball, n)).collect::<Result<Vec<_>, _>>()?;
        let jobs = sizes.iter().zip(&scenes).map(|(n, (s, cost))| Job::new(*n as usize, s, *cost));
        self.measure(jobs.collect())
    }

    /// Against the number of pixels, in steps of 4.
    pub fn pixels(&self) -> Result<Vec<Row>, ScalingError> {
        let (scene, cost) = build(TRIANGLES.min(self.largest), 1)?;
        let most = (self.largest / 5).max(768);
        let sizes = (0..).map(|step| [32 << step, 24 << step]);
        let sizes = sizes.take_while(|[w, h]| w * h <= most && *w <= Params::MAX_SIDE);
        let jobs = sizes.map(|size: [u32; 2]| Job {
            n: (size[0] * size[1]) as usize,
            size,
            ..Job::new(0, &scene, cost)
        });
        self.measure(jobs.collect())
    }

    /// Against the number of threads: 1, 2, 4 and so on up to all.
    pub fn threads(&self) -> Result<Vec<Row>, ScalingError> {
        let (scene, cost) = build(TRIANGLES.min(self.largest), 1)?;
        let all = match self.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            threads => threads,
        };
        let doubled = (0..).map(|step| 1usize << step).take_while(|&n| n < all);
        let jobs =
            doubled.chain([all]).map(|n| Job { threads: Some(n), ..Job::new(n, &scene, cost) });
        self.measure(jobs.collect())
    }

    fn measure(&self, jobs: Vec<Job<'_>>) -> Result<Vec<Row>, ScalingError> {
        let mut passes = Vec::new();
        for job in &jobs {
            // The first pass also finds memory for all that follows.
            job.nanoseconds(self, 1, 0)?;
            let pass = 1e-9 * job.nanoseconds(self, 1, 0)? * job.pixels();
            passes.push(((LONG / pass.max(1e-9)) as u64).clamp(1, PASSES));
        }
        let mut times = vec![Vec::new(); jobs.len()];
        for repeat in 0..self.repeats {
            for ((job, &passes), times) in jobs.iter().zip(&passes).zip(&mut times) {
                times.push(job.nanoseconds(self, passes, repeat)?);
            }
        }
        let row = |(job, times): (&Job<'_>, Vec<f64>)| Row {
            n: job.n,
            path: Spread::of(times),
            scene: job.cost,
        };
        Ok(jobs.iter().zip(times).map(row).collect())
    }
}

/// One size of something.
struct Job<'a> {
    n: usize,
    scene: &'a Arc<Scene>,
    cost: SceneCost,
    size: [u32; 2],
    /// Those of the plan without it.
    threads: Option<usize>,
}

impl<'a> Job<'a> {
    fn new(n: usize, scene: &'a Arc<Scene>, cost: SceneCost) -> Job<'a> {
        Job { n, scene, cost, size: SIZE, threads: None }
    }

    fn pixels(&self) -> f64 {
        self.size.map(f64::from).iter().product()
    }

    /// For each path of the passes.
    fn nanoseconds(&self, plan: &Scaling, passes: u64, repeat: u32) -> Result<f64, ParamsError> {
        let seed = plan.seed.wrapping_add(repeat.into());
        // What a path costs by itself; sharing adds what the selection of its group decides.
        let group = Some(ReuseGroup::None);
        let params = Params { size: self.size, seed, group, ..Params::new(self.scene.clone()) };
        let snapshot = render(params, passes, self.threads.unwrap_or(plan.threads))?;
        Ok(1e9 * snapshot.seconds / (self.pixels() * passes as f64))
    }
}

/// `first`, ten times that and so on, as far as `last`.
fn decades(first: u32, last: u32) -> Vec<u32> {
    let times_ten = |n: &u32| n.checked_mul(10);
    std::iter::successors(Some(first), times_ten).take_while(|&n| n <= last.max(first)).collect()
}

/// A ball of about `triangles` triangles in a room with `emitters` emitters.
fn build(triangles: u32, emitters: u32) -> Result<(Arc<Scene>, SceneCost), ScalingError> {
    let builder = room(triangles, emitters)?;
    let start = Instant::now();
    let scene = builder.build();
    let build = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let bytes = Bvh::build(scene.geometry()).bytes() + scene.geometry().bytes();
    let tree = start.elapsed().as_secs_f64();
    let triangles = scene.counts().triangles;
    let bytes = bytes as f64 / triangles as f64;
    Ok((Arc::new(scene), SceneCost { triangles, build, tree, bytes }))
}

fn room(triangles: u32, emitters: u32) -> Result<SceneBuilder, ScalingError> {
    let mut builder = SceneBuilder::new("a ball with hills in a room");
    let grey = builder.material(Material::reflecting("grey", [0.6; 3], [0.0; 3], 1.0)?);
    // However many emitters there are, they give the same light.
    let emitter = builder.material(Material::light("lamp", [20.0; 3])?);
    builder.cuboid(DVec3::splat(-1.0), DVec3::splat(2.0), grey)?;
    let place = DAffine3::IDENTITY;
    builder.mesh(&ball(((triangles as f64 / 12.0).sqrt().round() as u32).max(1)), place, grey)?;
    let side = (emitters as f64).sqrt().ceil() as u32;
    for n in 0..emitters {
        let at = |i: u32| 0.5 * ((2 * i + 1) as f64 / side as f64 - 1.0);
        let centre = DVec3::new(at(n % side), at(n / side), 0.99);
        builder.mesh(&lamp_of(centre, 0.2 / (emitters as f64).sqrt()), place, emitter)?;
    }
    builder.camera = Camera::look_at(DVec3::new(0.1, -0.95, 0.3), DVec3::ZERO, 0.8).ok();
    Ok(builder)
}

/// A square that shines downwards, of this half side.
fn lamp_of(centre: DVec3, half: f64) -> Mesh {
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    let corner = |(x, y)| centre + half * DVec3::new(x, y, 0.0);
    Mesh {
        positions: corners.map(corner).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A cube's faces, each of `steps` squared squares, blown up to a ball with hills: 12 `steps`
/// squared triangles.
fn ball(steps: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for face in 0..6 {
        let first = mesh.positions.len() as u32;
        let (axis, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        for i in 0..=steps {
            for j in 0..=steps {
                // Equal angles, so that squares are of nearly one size.
                let along = |i: u32| (0.25 * PI * (2.0 * i as f64 / steps as f64 - 1.0)).tan();
                let mut p = DVec3::ZERO;
                p[axis] = sign;
                p[(axis + 1) % 3] = along(i) * sign;
                p[(axis + 2) % 3] = along(j);
                mesh.positions.push(on_hills(p.normalize()));
            }
        }
        for i in 0..steps {
            for j in 0..steps {
                let a = first + i * (steps + 1) + j;
                let (b, c, d) = (a + steps + 1, a + steps + 2, a + 1);
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh
}

/// Hills on hills, six times, each half as wide as the one before.
fn on_hills(p: DVec3) -> DVec3 {
    let (mut height, mut q) = (0.0, 5.0 * p);
    for k in 0..6 {
        let wave = (q.x + 0.7).sin() * (q.y + 1.3).sin() + q.y.sin() * (q.z + 2.1).cos();
        height += 0.07 * wave / (1 << k) as f64;
        q = 2.0 * DVec3::new(q.y, q.z, q.x) + 0.3;
    }
    p * 0.55 * (1.0 + height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_that_of_the_law() {
        let row = |n: usize, t: f64| Row {
            n,
            path: Spread { median: t, min: t, max: t },
            scene: SceneCost { triangles: 0, build: 0.0, tree: 0.0, bytes: 0.0 },
        };
        let power: Vec<Row> = [10, 100, 1000].map(|n| row(n, 3.0 * (n as f64).powf(0.5))).to_vec();
        assert!((Growth::of(&power).exponent.unwrap().slope - 0.5).abs() < 1e-9);
        let log: Vec<Row> = [8, 64, 1024].map(|n| row(n, 5.0 + 7.0 * (n as f64).log2())).to_vec();
        assert!((Growth::of(&log).doubling.unwrap().slope - 7.0).abs() < 1e-9);
        assert!(Growth::of(&log[..1]).exponent.is_none());
        // Twice the logarithm, and less than twice the time.
        let over = log[1].over_logarithm(&log[0]);
        assert!((over - (5.0 + 7.0 * 6.0) / (5.0 + 7.0 * 3.0) / 2.0).abs() < 1e-9 && over < 1.0);
        assert!(power[1].over_logarithm(&power[0]) > 1.5);
    }

    #[test]
    fn balls_have_the_triangles_asked_for_and_no_seam() {
        for n in [1000, 10_000] {
            let (scene, cost) = build(n, 100).unwrap();
            let triangles = scene.counts().triangles;
            assert!(triangles.abs_diff(n as usize + 12 + 200) < n as usize / 20, "{triangles}");
            assert!((20.0..200.0).contains(&cost.bytes), "{cost:?}");
        }
        // Every point but those of the seams is there once, those at least twice.
        let mesh = ball(4);
        let near = |p: DVec3| mesh.positions.iter().filter(|q| q.distance(p) < 1e-9).count();
        let counts: Vec<usize> = mesh.positions.iter().map(|&p| near(p)).collect();
        assert_eq!(counts.iter().filter(|&&c| c == 1).count(), 6 * 9);
        assert_eq!(counts.iter().filter(|&&c| c == 3).count(), 8 * 3);
    }

    #[test]
    fn sizes_go_up_to_the_largest() {
        assert_eq!(decades(1000, 10_000_000), [1000, 10_000, 100_000, 1_000_000, 10_000_000]);
        assert_eq!(decades(1, 0), [1]);
        assert_eq!(decades(1, 99), [1, 10]);
    }
}
