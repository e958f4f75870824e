//! The error bar, against many independent renders: the quick form of `burnish check --full`.

use burnish::measure::calibrate::Renders;
use burnish::progressive::{Options, Params, Session, State, StopRule, Strategy, render};
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Material, SceneBuilder};
use std::sync::Arc;

fn params(name: &str, size: [u32; 2]) -> Params {
    let (builder, _) = Example::named(name).unwrap().read().unwrap();
    Params { size, ..Params::new(Arc::new(builder.build())) }
}

/// Twelve renders of two scenes. Coverage over some 60,000 values of which touching ones share
/// their standard error; what the bounds leave is ten times what seeds change it by.
#[test]
fn intervals_hold_the_truth_and_the_estimate_is_the_error() {
    for name in ["shell", "cornell"] {
        let renders =
            Renders::new(&params(name, [80, 60]), &[32, 128], 12, 0, &mut |_| {}).unwrap();
        for c in renders.calibrations() {
            assert!((0.92..0.97).contains(&c.coverage), "{name}: {c:?}");
            assert!((0.75..1.35).contains(&c.rmse_ratio), "{name}: {c:?}");
            assert!((0.8..1.25).contains(&c.relative_ratio), "{name}: {c:?}");
            assert!(c.reliable > 0.9 && c.below_limit > 0.8, "{name}: {c:?}");
        }
        // The error falls at least with the square root of the passes.
        let [few, many] = renders.calibrations().try_into().unwrap();
        assert!(many.relative < 0.55 * few.relative, "{name}: {few:?} {many:?}");
    }
}

/// So small a picture of four small lamps that one of their corners owns a third of the error: some
/// renders have hardly met it, and look better than they are. That a fifth of the thirty or more that
/// call theirs reliable exceed their upper limit has a probability of 1 % if each does with 7 %.
#[test]
fn the_limit_holds_where_a_lamps_corner_owns_the_error() {
    let plates = params("plates", [64, 48]);
    let renders = Renders::new(&plates, &[64, 256], 40, 0, &mut |_| {}).unwrap();
    for c in renders.calibrations() {
        assert!(c.below_limit > 0.8 && c.reliable > 0.5, "{c:?}");
    }
}

/// Twelve renders stop at the error asked for. That three or more of them are truly above it has
/// a probability below 2 % if each is with 5 %; the seeds are fixed.
#[test]
fn a_wanted_error_is_kept() {
    let renders = Renders::new(&params("shell", [48, 36]), &[128], 12, 0, &mut |_| {}).unwrap();
    let stopped = renders.stopped(0.17, 12, 0, &mut |_| {}).unwrap();
    assert!(stopped.kept > 0.8, "{stopped:?}");
    assert!((StopRule::FIRST as f64..300.0).contains(&stopped.passes), "{stopped:?}");
}

/// A small lamp that is only met by chance, by one path in some ten thousand: the few pixels that
/// met it own the error, and it is said so. With the lamp asked for, the same passes suffice.
#[test]
fn an_error_that_a_few_pixels_own_is_not_called_reliable() {
    let mut b = SceneBuilder::new("a small lamp");
    let floor = b.material(Material::reflecting("floor", [0.5; 3], [0.0; 3], 10.0).unwrap());
    let emitter = b.material(Material::light("lamp", [1e4; 3]).unwrap());
    b.cuboid([-2.0, -2.0, 0.0].into(), [4.0, 4.0, 0.0].into(), floor).unwrap();
    b.sphere([0.0, 0.0, 2.0].into(), 0.02, emitter).unwrap();
    let eye = [0.0, -3.0, 1.0].into();
    b.camera = Some(Camera::look_at(eye, [0.0; 3].into(), 0.1).unwrap());
    b.screen = [32, 24];
    let scene = Arc::new(b.build());
    let reliable = |strategy| {
        let s = render(Params { strategy, ..Params::new(scene.clone()) }, 32, 0).unwrap();
        s.error.unwrap().reliable
    };
    assert!(!reliable(Strategy::BsdfOnly));
    assert!(reliable(Strategy::Mis));
}

/// Resuming goes on with the same sequence: stopped at 24 passes and gone on to 64, every bit is
/// that of 64 passes at once, the errors too.
#[test]
fn resuming_continues_the_same_sequence() {
    let params = params("shell", [40, 30]);
    let once = render(params.clone(), 64, 2).unwrap();
    let session = Session::with_options(params, 24, Options::headless(1), || {}).unwrap();
    let done = |passes: u64| {
        let over =
            |s: &burnish::progressive::Snapshot| s.state == State::Done && s.passes == passes;
        session.snapshots().iter().find(over).unwrap()
    };
    assert_eq!(done(24).passes, 24);
    session.set_limit(64);
    let later = done(64);
    assert_eq!(later.mean(), once.mean());
    assert_eq!(later.standard_error(), once.standard_error());
    assert_eq!(later.error, once.error);
}
