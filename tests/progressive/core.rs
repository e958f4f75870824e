//! The progressive core: determinism, epochs, limits, pauses.

use burnish::brdf::{Model, Roughness};
use burnish::progressive::{
    Experiment, Options, Params, Session, Snapshot, State, TileImage, render,
};
use burnish::scene::{Camera, Material, Scene, SceneBuilder};
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

fn small_room() -> Arc<Scene> {
    let mut b = SceneBuilder::new("small room");
    let wall = Material::reflecting("wall", [0.6, 0.5, 0.4], [0.04; 3], 100.0).unwrap();
    let wall = b.material(wall);
    let metal = b.material(Material::reflecting("metal", [0.0; 3], [0.9; 3], 500.0).unwrap());
    let emitter = b.material(Material::light("lamp", [5.0, 5.0, 4.0]).unwrap());
    b.cuboid(DVec3::splat(-2.0), DVec3::splat(4.0), wall).unwrap();
    b.sphere(DVec3::new(0.5, 0.3, -1.2), 0.8, metal).unwrap();
    b.cylinder(DVec3::new(-0.9, 0.4, -2.0), DVec3::new(0.2, 0.0, 1.5), 0.3, metal).unwrap();
    b.sphere(DVec3::new(-0.5, 0.5, 1.2), 0.4, emitter).unwrap();
    b.camera =
        Some(Camera::look_at(DVec3::new(0.2, -1.9, 0.1), DVec3::new(0.0, 1.0, -0.3), 0.8).unwrap());
    b.screen = [70, 50];
    Arc::new(b.build())
}

fn finished(session: &Session, epoch: u64) -> Snapshot {
    let over = |s: &Snapshot| s.epoch == epoch && s.state == State::Done;
    session.snapshots().iter().find(over).unwrap()
}

/// What the workers have by now.
fn kept(session: &Session) -> Experiment {
    let (tell, told) = std::sync::mpsc::channel();
    session.visit_experiment(move |experiment| tell.send(experiment.clone()).unwrap());
    told.recv().unwrap()
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    for model in Model::ALL {
        let params = Params { model, ..Params::new(small_room()) };
        // Once all pixels have the same number of samples, once they do not.
        let passes = if model == Model::Ggx { 75 } else { 11 };
        let one = render(params.clone(), passes, 1).unwrap();
        assert_eq!(one.counts.nonfinite, 0);
        assert!(passes > 16 || one.counts.paths == 70 * 50 * passes);
        for threads in [2, 7, 16] {
            let many = render(params.clone(), passes, threads).unwrap();
            assert_eq!(one.mean(), many.mean());
            assert_eq!(one.samples(), many.samples());
            assert_eq!(one.standard_error(), many.standard_error());
            assert_eq!(one.counts, many.counts);
            assert_eq!(one.error, many.error);
        }
    }
}

#[test]
fn windowed_as_headless_after_pauses_limits_and_other_epochs() {
    let params = Params::new(small_room());
    let plain = render(params.clone(), 9, 2).unwrap();
    let session = Session::start(params.clone(), 2, 2, || {}).unwrap();
    // Wander off, come back, stop and go on: from one that was seen, from one that hardly began.
    for (alpha, is_seen) in [(0.9, true), (0.5, false), (0.1, true)] {
        let rough = Roughness::from_alpha(alpha).unwrap();
        let epoch = session.set(params.clone().with_roughness(rough)).unwrap();
        if is_seen {
            session.snapshots().iter().find(|s| s.epoch == epoch).unwrap();
        }
    }
    let epoch = session.set(params.clone()).unwrap();
    assert_eq!(session.set(params).unwrap(), epoch, "no change, no new epoch");
    assert_eq!(finished(&session, epoch).passes, 2);
    session.pause();
    session.set_limit(9);
    assert_eq!(kept(&session).passes(), 2, "paused workers still trace");
    session.resume();
    let over = |s: &Snapshot| s.epoch == epoch && s.passes == 9;
    let end = session.snapshots().iter().find(over).unwrap();
    assert_eq!(end.mean(), plain.mean());
    assert_eq!(end.error, plain.error);
}

#[test]
fn a_pause_stops_the_work_and_loses_nothing() {
    let params = Params::new(small_room());
    let session = Session::start(params.clone(), 1 << 32, 2, || {}).unwrap();
    session.snapshots().iter().find(|s| s.passes > 0).unwrap();
    session.pause();
    let paused = session.snapshots().iter().find(|s| s.state == State::Paused).unwrap();
    // An order that is no news is followed by nothing; a wish is heard by whoever still works.
    assert_eq!(kept(&session).picture().0, paused.mean(), "paused workers still trace");
    assert!(session.latest().is_none(), "paused workers still send");
    session.resume();
    let next = session.snapshots().recv().unwrap();
    assert_eq!(next.epoch, paused.epoch);
    assert!(next.counts.paths > paused.counts.paths);
    // Every tile holds at least what it held.
    for (a, b) in paused.tiles.iter().zip(&next.tiles) {
        let passes = |t: &Option<Arc<TileImage>>| t.as_ref().map_or(0, |t| t.passes);
        assert!(passes(b) >= passes(a));
    }
}

/// Wherever it is stopped, by a pause or by its limit, and however often.
#[test]
fn many_stops_leave_no_trace() {
    const PASSES: u64 = 40;
    let params = Params { size: [120, 200], ..Params::new(small_room()) };
    let plain = render(params.clone(), PASSES, 2).unwrap();
    let options = Options { threads: 2, preview: true, interval: Duration::ZERO, keep: 0 };
    let session = Session::with_options(params, 1, options, || {}).unwrap();
    let mut stops = 0;
    let end = loop {
        let seen = session.snapshots().recv().unwrap();
        if seen.state == State::Done {
            if seen.passes == PASSES {
                break seen;
            }
            session.set_limit((seen.passes + 1 + stops % 7).min(PASSES));
        } else if stops < 30 {
            session.pause();
            let stopped = |s: &Snapshot| s.state != State::Running;
            let stopped = session.snapshots().iter().find(stopped).unwrap();
            session.set_limit((stopped.passes + 1 + stops % 7).min(PASSES));
            session.resume();
            stops += 1;
        }
    };
    assert!(end.mean() == plain.mean() && end.standard_error() == plain.standard_error());
    assert_eq!(end.counts.paths, plain.counts.paths);
    // On the mean a sample a pixel and pass.
    let mean = end.counts.paths as f64 / f64::from(120 * 200) / PASSES as f64;
    assert!((mean - 1.0).abs() < 0.02 && stops > 1, "{mean}, {stops} stops");
}

#[test]
fn snapshots_are_of_one_epoch_and_name_what_changed() {
    let base = Params::new(small_room());
    let session = Session::start(base.clone(), 1 << 32, 2, || {}).unwrap();
    let mut last = 0;
    let mut picture: Vec<Option<Arc<TileImage>>> = Vec::new();
    let mut seen = 0;
    for k in 0..200 {
        let alpha = Roughness::from_alpha(0.05 + 0.004 * k as f64).unwrap();
        let epoch = session.set(base.clone().with_roughness(alpha)).unwrap();
        while let Ok(s) = session.snapshots().recv() {
            assert!(s.epoch >= last, "an older epoch after a newer one");
            last = s.epoch;
            if picture.len() != s.tiles.len() {
                picture = vec![None; s.tiles.len()];
            }
            for &i in &s.dirty {
                picture[i as usize] = s.tiles[i as usize].clone();
            }
            seen += 1;
            if s.epoch == epoch {
                // What was patched tile by tile is the whole picture.
                for (a, b) in picture.iter().zip(&s.tiles) {
                    assert!(match (a, b) {
                        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                        _ => b.is_none(),
                    });
                }
                break;
            }
        }
        assert_eq!(last, epoch, "no snapshot of the new epoch");
    }
    assert!(seen >= 200);
}

#[test]
fn a_reader_that_never_reads_stops_nothing() {
    let params = Params::new(small_room());
    let sent = Arc::new(AtomicUsize::new(0));
    let count = sent.clone();
    let notify = move || {
        count.fetch_add(1, Ordering::SeqCst);
    };
    let options = Options { threads: 2, preview: true, interval: Duration::ZERO, keep: 0 };
    let session = Session::with_options(params.clone(), 40, options, notify).unwrap();
    while sent.load(Ordering::SeqCst) < 20 {
        std::thread::yield_now();
    }
    let first = session.snapshots().recv().unwrap();
    let shown = first.tiles.iter().flatten().count();
    assert_eq!(first.dirty.len(), shown, "all tiles are new to this reader");
    let end = if first.state == State::Done { first } else { finished(&session, 1) };
    assert_eq!(end.mean(), render(params, 40, 1).unwrap().mean());
}

#[test]
fn parameters_that_make_no_picture_are_refused() {
    let good = Params::new(small_room());
    for size in [[0, 10], [10, 0], [40_000, 10]] {
        assert!(render(Params { size, ..good.clone() }, 1, 1).is_err());
    }
    assert!(render(Params { max_depth: Some(0), ..good.clone() }, 1, 1).is_err());
    assert!(render(Params { materials: Arc::new(vec![]), ..good.clone() }, 1, 1).is_err());
    for size in [[1, 1], [1, 77], [33, 1]] {
        let s = render(Params { size, ..good.clone() }, 2, 3).unwrap();
        assert_eq!(s.counts.paths, 2 * size[0] as u64 * size[1] as u64);
    }
}

/// Within a pass, of the four thousand million that were wished for. It is told of after every row of tiles; some
/// passes may go by before this thread has its turn to drop it, where a machine has other work.
#[test]
fn dropping_a_session_ends_its_work_at_once() {
    let params = Params { size: [1600, 1200], ..Params::new(small_room()) };
    let rows = 1200_u32.div_ceil(burnish::progressive::TILE) as usize;
    let told = Arc::new(AtomicUsize::new(0));
    let count = told.clone();
    let notify = move || {
        count.fetch_add(1, Ordering::SeqCst);
    };
    let options = Options { threads: 2, preview: false, interval: Duration::ZERO, keep: 0 };
    let session = Session::with_options(params, 1 << 32, options, notify).unwrap();
    while told.load(Ordering::SeqCst) == 0 {
        std::thread::yield_now();
    }
    let before = told.load(Ordering::SeqCst);
    drop(session);
    let after = told.load(Ordering::SeqCst);
    assert!(after - before < 16 * rows, "{} rows, of {rows} a pass", after - before);
    // Whoever could still tell of work would hold what tells of it.
    assert_eq!(Arc::strong_count(&told), 1, "it goes on");
}

#[test]
fn headless_options_skip_the_preview() {
    let params = Params::new(small_room());
    let session = Session::with_options(params, 1, Options::headless(1), || {}).unwrap();
    for s in session.snapshots().iter() {
        assert!(s.tiles.iter().flatten().all(|t| t.block == 1));
        if s.state == State::Done {
            return;
        }
    }
}

/// A worker that panics is told with all that it takes to repeat it, and the next change of
/// parameters is rendered as if nothing had been.
#[test]
fn a_worker_that_fails_is_told_and_the_next_change_goes_on() {
    let params = Params { size: [96, 96], ..Params::new(small_room()) };
    let trap = Arc::new(AtomicBool::new(true));
    let sprung = trap.clone();
    // It is the workers that notify.
    let notify = move || assert!(!sprung.swap(false, Ordering::SeqCst), "a trap of the test");
    let options = Options { threads: 2, preview: false, interval: Duration::ZERO, keep: 0 };
    let session = Session::with_options(params.clone(), 3, options, notify).unwrap();
    let failed = |s: &Snapshot| matches!(s.state, State::Failed(_));
    let Some(Snapshot { state: State::Failed(why), .. }) = session.snapshots().iter().find(failed)
    else {
        panic!("no snapshot tells of the failure")
    };
    for part in ["a trap of the test", "small room", "ggx", "seed 0", "96x96"] {
        assert!(why.contains(part), "{part} in {why}");
    }
    let next = Params { seed: 1, ..params };
    let epoch = session.set(next.clone()).unwrap();
    assert_eq!(finished(&session, epoch).mean(), render(next, 3, 1).unwrap().mean());
}

/// A sky of infinite radiance: the samples that met it are counted and kept out of the sums, the
/// others stay what they are.
#[test]
fn samples_that_are_no_numbers_are_counted_and_left_out() {
    for sky in [f32::INFINITY, f32::NAN] {
        let mut b = SceneBuilder::new("half a sky");
        let emitter = b.material(Material::light("lamp", [2.0; 3]).unwrap());
        b.cuboid(DVec3::new(-50.0, 1.0, -50.0), DVec3::new(50.0, 0.0, 100.0), emitter).unwrap();
        b.environment = [sky; 3];
        b.camera = Some(Camera::look_at(DVec3::ZERO, DVec3::Y, 0.8).unwrap());
        b.screen = [8, 6];
        let s = render(Params::new(Arc::new(b.build())), 10, 2).unwrap();
        // The left half of the picture is the lamp, the right half the sky.
        assert_eq!((s.counts.nonfinite, s.counts.paths), (8 * 6 * 10 / 2, 8 * 6 * 10));
        for (i, pixel) in s.mean().pixels.iter().enumerate() {
            assert_eq!(*pixel, if i % 8 < 4 { [2.0; 3] } else { [0.0; 3] }, "{sky} {i}");
        }
    }
}

#[test]
fn the_time_between_snapshots_can_be_changed_while_it_runs() {
    let told = Arc::new(AtomicUsize::new(0));
    let count = told.clone();
    let hour = Duration::from_secs(3600);
    let options = Options { threads: 1, preview: false, interval: hour, keep: 0 };
    let notify = move || {
        count.fetch_add(1, Ordering::SeqCst);
    };
    let params = Params::new(small_room());
    let tiles = params.size.map(|s| s.div_ceil(burnish::progressive::TILE)).iter().product::<u32>();
    let session = Session::with_options(params, 8, options, notify).unwrap();
    finished(&session, 1);
    // The first whole pass and the end, whatever the interval. A snapshot is there before it is told.
    while told.load(Ordering::SeqCst) < 2 {
        std::thread::yield_now();
    }
    assert_eq!(told.swap(0, Ordering::SeqCst), 2);
    session.set_interval(Duration::ZERO);
    session.set_limit(12);
    while session.snapshots().recv().unwrap().passes < 12 {}
    assert!(told.load(Ordering::SeqCst) >= tiles as usize, "one a tile");
}
