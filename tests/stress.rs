//! Thousands of changes while workers are at work: a script of a seed, not a person's patience.

mod support;

use burnish::brdf::{Erratum, Model, Normals, Roughness};
use burnish::progressive::{Params, Session, Snapshot, State, Strategy, render};
use burnish::scene::builtin::Example;
use burnish::scene::{Camera, Scene};
use glam::DVec3;
use peak_alloc::PeakAlloc;
use std::sync::Arc;
use support::Random;

/// What is in use, whatever the system holds in reserve for it.
#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

fn scenes() -> [Arc<Scene>; 2] {
    ["cornell", "plates"]
        .map(|name| Arc::new(Example::named(name).unwrap().read().unwrap().0.build()))
}

/// One change of everything that a user or a program can change.
fn change(r: &mut Random, scenes: &[Arc<Scene>], params: &mut Params) {
    let mut below = |n: u32| r.bits() % n;
    match below(10) {
        0 => params.model = Model::ALL[below(3) as usize],
        1 => params.size = [1 + below(90), 1 + below(90)],
        2 => params.seed = u64::from(below(1000)),
        3 => params.max_depth = [None, Some(1), Some(4)][below(3) as usize],
        4 => params.strategy = Strategy::ALL[below(3) as usize],
        5 => params.normals = [Normals::Visible, Normals::Distribution][below(2) as usize],
        6 => params.erratum = Erratum::ALL.get(below(40) as usize).copied(),
        7 => {
            let [low, high] = params.scene.bounds();
            let at = |x: u32| low + (high - low) * (f64::from(x) / 100.0);
            let (eye, ry) = (at(below(100)), 0.1 + f64::from(below(20)) / 10.0);
            params.camera = Camera::look_at(eye, at(50) + DVec3::X, ry).unwrap();
        }
        8 if below(4) == 0 => {
            let scene = scenes[below(2) as usize].clone();
            *params = Params { size: params.size, ..Params::new(scene) };
        }
        _ => {
            let alpha = 10f64.powf(-4.0 * f64::from(below(1000)) / 1000.0);
            *params = params.clone().with_roughness(Roughness::from_alpha(alpha).unwrap());
        }
    }
}

/// Bytes of memory that are in use once the picture of these is done.
fn held(session: &Session, params: &Params) -> usize {
    session.resume();
    session.set_limit(2);
    let epoch = session.set(params.clone()).unwrap();
    let over = |s: &Snapshot| s.epoch == epoch && s.state == State::Done;
    session.snapshots().iter().find(over).unwrap();
    MEMORY.current_usage()
}

/// Changes of parameters, pauses, limits, restarts and glances in random order, mostly faster than
/// a pass: nothing locks up, no memory is lost, and what stands in the end is the picture of the
/// last parameters, to the bit.
#[test]
fn five_thousand_changes_end_in_the_picture_of_the_last() {
    let (scenes, mut r) = (scenes(), Random::new(20_261_122));
    let start = Params { size: [64, 48], ..Params::new(scenes[0].clone()) };
    let session = Session::start(start.clone(), 1 << 32, 2, || {}).unwrap();
    let reference = Params { seed: 1 << 40, ..start.clone() };
    let (mut params, mut epoch, mut before) = (start, 1, 0);
    for step in 0..5000 {
        match r.bits() % 12 {
            0 => session.pause(),
            1 => session.resume(),
            2 => session.set_limit(u64::from(1 + r.bits() % 20)),
            3 => epoch = session.restart(),
            4 => drop(session.latest()),
            _ => {
                change(&mut r, &scenes, &mut params);
                let next = session.set(params.clone()).unwrap();
                assert!(next >= epoch, "epochs go on");
                epoch = next;
            }
        }
        // Now and then the workers get as far as a picture.
        if step % 50 == 0 {
            session.resume();
            session.set_limit(1 << 32);
            let seen = session.snapshots().iter().find(|s| s.epoch >= epoch).unwrap();
            assert_eq!((seen.epoch, seen.grid.size), (epoch, params.size));
            assert!(!matches!(seen.state, State::Failed(_)), "{:?}", seen.state);
        }
        if step == 1500 {
            before = held(&session, &reference);
            (params, epoch) = (reference.clone(), session.epoch());
        }
    }
    let after = held(&session, &reference);
    assert!(after <= before + before / 8, "{before} bytes became {after}");
    session.set_limit(5);
    params.seed += 1;
    let epoch = session.set(params.clone()).unwrap();
    let over = |s: &Snapshot| s.epoch == epoch && s.state == State::Done;
    let last = session.snapshots().iter().find(over).unwrap();
    let fresh = render(params, 5, 1).unwrap();
    assert_eq!(last.mean(), fresh.mean());
    assert_eq!((last.counts, last.error), (fresh.counts, fresh.error));
}
