//! Interruptions at every band, without a clock: how long a wave is and when it pauses is for the
//! tests to say.

use super::*;
use crate::brdf::Model;
use crate::film::ErrorEstimate;
use crate::progressive::accumulator::Accumulator;
use crate::progressive::driver::Start;
use crate::progressive::turn::Turn;
use crate::progressive::{Experiment, Snapshot, render};
use crate::scene::{Camera, Material, SceneBuilder};
use crossbeam_channel::bounded;
use glam::DVec3;

const PASSES: u64 = 40;
/// A row of tiles is more than the shortest wave of one worker.
const SIZE: [u32; 2] = [160, 200];

/// Seven rows of tiles: half of the picture an emitter, the other half clay or, without clay, a sky that
/// is no number.
fn params(clay: bool) -> Params {
    let mut b = SceneBuilder::new("a lamp and a wall");
    let emitter = b.material(Material::light("lamp", [2.0; 3]).unwrap());
    b.cuboid(DVec3::new(-50.0, 1.0, -50.0), DVec3::new(50.0, 0.0, 100.0), emitter).unwrap();
    if clay {
        let wall = Material::reflecting("clay", [0.6, 0.4, 0.3], [0.1; 3], 40.0).unwrap();
        let wall = b.material(wall);
        b.cuboid(DVec3::new(0.0, 2.0, -50.0), DVec3::new(50.0, 1.0, 100.0), wall).unwrap();
        b.cuboid(DVec3::new(1.0, -9.0, -50.0), DVec3::new(1.0, 18.0, 100.0), wall).unwrap();
    }
    b.environment = if clay { [0.5, 0.7, 1.0] } else { [f32::NAN; 3] };
    b.camera = Some(Camera::look_at(DVec3::ZERO, DVec3::Y, 0.8).unwrap());
    b.screen = SIZE;
    Params { group: Some(ReuseGroup::Sixteen), ..Params::new(Arc::new(b.build())) }
}

/// An empty one of the picture that is shown.
fn accumulator(params: Params, threads: usize) -> Accumulator {
    let turn = Turn { role: Role::Shown, epoch: 1, orders: 0 };
    Accumulator::new(Epoch::new(turn, params, threads), Vec::new())
}

/// Outlets that nobody listens to.
fn quiet() -> [Mailbox; 2] {
    [(); 2].map(|()| {
        let (sender, receiver) = bounded(1);
        Mailbox::new(sender, receiver, Box::new(|| ()))
    })
}

/// Rendered with a pause at every snapshot, which with this interval is after every band of tiles.
/// Waves are as short as they can be, so that a pause leaves the upper rows with more passes than the
/// others, and as long as they can be, so that many passes are traced at once, in turn. Every so often
/// the process ends there, and another goes on with what is in its file.
fn interrupted(params: &Params, threads: usize) -> Snapshot {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { threads, preview: false, interval: Duration::ZERO, keep: 0 };
    let shared = Arc::new(Shared::new(params.clone(), PASSES, options));
    let outlets = [(); 2].map(|()| {
        let (sender, receiver) = bounded(1);
        let pausing = shared.clone();
        Mailbox::new(sender, receiver, Box::new(move || pausing.pause(true)))
    });
    let workers = Workers::new(options, shared.clone(), outlets).unwrap();
    let Accumulator { mut epoch, mut films } = accumulator(params.clone(), threads);
    let mut store = Store::default();
    let (mut uneven, mut filed) = (0, 0);
    for turn in 0.. {
        workers.wave.store([0, u64::MAX][turn % 2], Ordering::Relaxed);
        shared.pause(false);
        workers.run(&epoch, &mut films, &mut store, u64::MAX);
        let least = whole_passes(&films);
        if least == PASSES {
            break;
        }
        let most = films.iter().map(Film::passes).max().unwrap_or(0);
        uneven += u64::from(least > 1 && most > least);
        if turn % 7 == 3 {
            filed += u64::from(least > 1 && most > least);
            workers.settle(&mut films);
            let group = epoch.group.get().copied();
            let kept = Experiment::of(params, group, epoch.counts(), std::mem::take(&mut films));
            let path = folder.path().join("e.exr");
            kept.save(&path).unwrap();
            let read = Experiment::read(&path).unwrap();
            assert!(read == kept && read.params(params.scene.clone()).unwrap() == *params);
            epoch = accumulator(params.clone(), threads).epoch;
            Accumulator { epoch, films } = Start::of(read).begin(epoch, &workers);
        }
    }
    assert!(uneven > 2 && filed > 0, "no pause has come within a pass: the test tests nothing");
    epoch.snapshot(State::Done, PASSES)
}

/// What upper rows of tiles have more than lower ones when they go on counts once; where samples are
/// planned, what some tiles have more than others.
#[test]
fn a_pause_within_a_pass_leaves_no_trace() {
    for (clay, uniform) in [(true, true), (false, true), (true, false), (false, false)] {
        let params = Params { uniform, ..params(clay) };
        let plain = render(params.clone(), PASSES, 1).unwrap();
        for threads in [1, 3] {
            let paused = interrupted(&params, threads);
            assert!(paused.tiles.iter().flatten().all(|tile| tile.passes == PASSES));
            assert!(paused.mean() == plain.mean(), "clay {clay}, {threads} threads");
            assert!(paused.standard_error() == plain.standard_error());
            let error = |s: &Snapshot| s.error.map(|e: ErrorEstimate| e.relative);
            assert_eq!(error(&paused), error(&plain));
            let counts = |s: &Snapshot| [s.counts.paths, s.counts.nonfinite];
            assert_eq!(counts(&paused), counts(&plain));
            assert_eq!(paused.samples(), plain.samples());
            let pixels = u64::from(SIZE[0] * SIZE[1]) * PASSES;
            if uniform {
                assert_eq!(counts(&plain), [pixels, if clay { 0 } else { pixels / 2 }]);
                assert!(plain.samples().iter().all(|&n| n == PASSES));
            } else {
                let all: u64 = plain.samples().iter().sum();
                assert_eq!(counts(&plain)[0], all);
                assert!((all as f64 / pixels as f64 - 1.0).abs() < 0.03, "{all} of {pixels}");
            }
        }
    }
}

/// What camera rays met is met again after an edit that is not about where surfaces are: the picture
/// is that of a fresh start, and the rays of the first pass are not traced twice.
#[test]
fn first_hits_are_kept_from_edit_to_edit() {
    let options =
        Options { threads: 2, preview: true, interval: Duration::from_millis(50), keep: 0 };
    let start = params(true);
    let edits: [&dyn Fn(&mut Params); 5] = [
        &|_| (),
        &|p| p.model = Model::Phong,
        &|p| Arc::make_mut(&mut p.materials)[1].kd = [0.1, 0.2, 0.3],
        &|p| p.camera = Camera::look_at(DVec3::ZERO, DVec3::new(0.1, 1.0, 0.0), 0.8).unwrap(),
        &|p| p.seed = 7,
    ];
    let shared = Arc::new(Shared::new(start.clone(), 1, options));
    let workers = Workers::new(options, shared, quiet()).unwrap();
    let (mut store, mut params) = (Store { preview_paths: 1000, ..Store::default() }, start);
    let mut traced = Vec::new();
    for edit in edits {
        edit(&mut params);
        let Accumulator { epoch, mut films } = accumulator(params.clone(), 2);
        workers.run(&epoch, &mut films, &mut store, u64::MAX);
        let edited = epoch.snapshot(State::Done, 1);
        let fresh = render(params.clone(), 1, 1).unwrap();
        assert!(edited.mean() == fresh.mean());
        traced.push(fresh.counts.rays - edited.counts.rays);
    }
    let all = u64::from(SIZE[0] * SIZE[1]);
    assert_eq!(traced, [0, all, all, 0, 0]);
}

/// However seldom snapshots are due, no row of tiles is shown much older than it is.
#[test]
fn no_row_is_left_behind_while_others_are_shown() {
    let hour = Duration::from_secs(3600);
    let options = Options { threads: 1, preview: true, interval: hour, keep: 0 };
    let shared = Arc::new(Shared::new(params(true), 100, options));
    let workers = Workers::new(options, shared, quiet()).unwrap();
    let Accumulator { epoch, mut films } = accumulator(params(true), 1);
    let mut store = Store::default();
    for pass in 0..30 {
        workers.passes(&epoch, &mut films, &mut store, pass..pass + 1, ReuseGroup::None);
        let shown = epoch.snapshot(State::Running, pass + 1);
        for tile in shown.tiles.iter().flatten() {
            assert!(tile.passes + tile.passes / 8 > pass, "{} of {}", tile.passes, pass + 1);
        }
        assert_eq!(shown.tiles.iter().flatten().count(), epoch.grid.len());
    }
}
